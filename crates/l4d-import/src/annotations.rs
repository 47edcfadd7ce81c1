//! What people drew on pictures with other tools, and the truth of l4d for the evaluators of others.
//!
//! Owns the files of labelme, ISAT, CVAT, COCO and 4D LangSplat, and how polygons become pixels there. Refuses to know
//! which scene a picture belongs to and what a label means.

pub mod coco;
pub mod cvat;
pub mod fill;
pub mod four_d_langsplat;
pub mod isat;
pub mod labelme;
pub mod lerf_ovs;
pub mod outline;
mod prompts;

use l4d_data::DataError;
use l4d_frames::Mask;
use std::path::Path;

pub use prompts::{Judged, Prompt};

/// A picture with what somebody drew on it.
#[derive(Debug, Clone, PartialEq)]
pub struct AnnotatedPicture {
    /// File name as the annotation gives it.
    pub file_name: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// What was drawn, in the order of the file.
    pub objects: Vec<AnnotatedObject>,
}

/// One thing on it.
#[derive(Debug, Clone, PartialEq)]
pub struct AnnotatedObject {
    /// Category, prompt or name: what the tool calls it.
    pub label: String,
    /// Which of several things of that label, where the tool says so.
    pub group: Option<u64>,
    /// Its pixels.
    pub mask: Mask,
}

impl AnnotatedPicture {
    /// Labels that occur, sorted.
    pub fn labels(&self) -> Vec<&str> {
        let mut labels: Vec<&str> = self.objects.iter().map(|object| object.label.as_str()).collect();
        labels.sort_unstable();
        labels.dedup();
        labels
    }

    /// All pixels of a label.
    pub fn union_of(&self, label: &str) -> Mask {
        let mut union = Mask::empty(self.width, self.height);
        self.objects
            .iter()
            .filter(|object| object.label == label)
            .for_each(|object| union.union_with(&object.mask));
        union
    }
}

/// Pictures of an annotation and what was not understood of it, a sentence each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Annotations {
    /// In the order of the file.
    pub pictures: Vec<AnnotatedPicture>,
    /// What was left out or assumed.
    pub notes: Vec<String>,
}

/// Refuses sizes that no picture has.
fn check_size(path: &Path, place: &str, width: u32, height: u32) -> Result<(), DataError> {
    if Mask::is_sane_size(width, height) {
        return Ok(());
    }
    let message =
        format!("the picture is {width}x{height}, but each side has 1 to {} pixels", Mask::MAX_SIDE);
    Err(DataError::invalid(path, place, message, "annotate pictures of a sane size"))
}

/// Reads a JSON file of some annotation tool; they add fields as they like.
fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, DataError> {
    l4d_data::json::read(path)
}
