//! What people drew on pictures with other tools, and the truth of l4d for the evaluators of others.
//!
//! Owns the files of COCO, 4D LangSplat and LERF-OVS, and how polygons become pixels there. Does not know which scene a
//! picture belongs to.

pub mod coco;
pub mod fill;
pub mod four_d_langsplat;
pub(crate) mod lerf_ovs;
mod outline;
mod prompts;

use l4d_masks::Mask;

pub use prompts::QueriesWithTruth;
pub(crate) use prompts::base_object;

/// A picture with what was drawn on it.
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
    /// Category or prompt.
    pub label: String,
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
