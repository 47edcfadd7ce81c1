//! The held-out pictures of a scene, and which of them a number in a file name is.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name, Profile, Report, json};
use serde::Deserialize;

use super::super::template::Hit;
use super::{Request, parse};

/// No list of frames is larger.
const MAX_BYTES: u64 = 64 << 20;

/// Which frame the n-th picture of a render shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FrameOrder {
    /// The n-th frame of the clip.
    Clip,
    /// As a list says; none where a picture is of another camera or not asked for.
    Listed(Vec<Option<u32>>),
}

impl FrameOrder {
    /// Reads a list: a line a picture, in the order in which they were rendered, each a frame's number or `-`.
    ///
    /// # Errors
    /// Files that cannot be read, and lines that are neither.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let bytes = read_bounded(path, MAX_BYTES)?;
        let text = String::from_utf8_lossy(&bytes);
        let entry = |(index, line): (usize, &str)| {
            match line.trim() {
            "-" => Ok(None),
            number => number.parse().map(Some).map_err(|_number| {
                let message = format!("`{}` is neither a frame nor `-`", l4d_data::error::inert(number));
                let hint = "write one line a rendered picture: the number of its frame, or - for pictures of other cameras";
                DataError::invalid(path, format!("line {}", index + 1), message, hint)
            }),
        }
        };
        Ok(Self::Listed(text.lines().enumerate().map(entry).collect::<Result<_, _>>()?))
    }

    /// Pictures that a render has under this order.
    pub fn pictures(&self, clip: &[u32]) -> usize {
        match self {
            Self::Clip => clip.len(),
            Self::Listed(frames) => frames.len(),
        }
    }

    /// The frame of a picture; none if it is not asked for.
    ///
    /// # Errors
    /// The number of pictures, if there is no such one.
    pub fn frame(&self, position: usize, clip: &[u32]) -> Result<Option<u32>, usize> {
        match self {
            Self::Clip => clip.get(position).map(|&frame| Some(frame)).ok_or(clip.len()),
            Self::Listed(frames) => frames.get(position).copied().ok_or(frames.len()),
        }
    }
}

impl fmt::Display for FrameOrder {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Clip => "the n-th picture shows the n-th frame of the profile",
            Self::Listed(_) => "the n-th picture shows the frame in the n-th line of a list",
        })
    }
}

/// Which picture an image of a COCO file is: 4D LangSplat names folders after image ids.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Images {
    path: PathBuf,
    positions: BTreeMap<u64, u32>,
}

#[derive(Deserialize)]
struct CocoImages {
    images: Vec<CocoImage>,
}

#[derive(Deserialize)]
struct CocoImage {
    id: u64,
    file_name: String,
}

impl Images {
    /// Reads `_annotations.coco.json`. `first` is the number that the first image's name begins with: 1 in HyperNeRF,
    /// 0 in Neu3D.
    ///
    /// # Errors
    /// Files that cannot be read, and names that begin with no such number.
    pub fn read(path: &Path, first: u32) -> Result<Self, DataError> {
        let file: CocoImages = json::parse(path, None, &read_bounded(path, MAX_BYTES)?)?;
        let position = |image: &CocoImage| {
            let digits: String = image.file_name.chars().take_while(char::is_ascii_digit).collect();
            let position = digits.parse::<u32>().ok().and_then(|number| number.checked_sub(first));
            position.map(|position| (image.id, position)).ok_or_else(|| {
                let message = format!(
                    "`{}` begins with no number from {first}",
                    l4d_data::error::inert(&image.file_name)
                );
                DataError::invalid(path, format!("image {}", image.id), message, "check --images-first")
            })
        };
        let positions = file.images.iter().map(position).collect::<Result<_, _>>()?;
        Ok(Self { path: path.to_owned(), positions })
    }

    /// Those of a scene where the method keeps them; none if they are not there, or in several places.
    fn find(request: &Request<'_>, scene: &Name) -> Result<Option<Self>, DataError> {
        let Some(preset) = &request.preset.images else { return Ok(None) };
        let bound = [("scene".to_owned(), scene.to_string())].into_iter().chain(request.choices.clone());
        let template = parse(&preset.template, &request.root)?;
        let hits = template.find(&request.root, &bound.collect(), &mut Report::default())?;
        let [hit] = hits.as_slice() else { return Ok(None) };
        let first = hit.text("dataset").and_then(|kind| preset.first.get(kind));
        first.map(|&first| Self::read(&hit.path, first)).transpose()
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The picture of an image.
    pub fn position(&self, id: u64) -> Option<usize> {
        self.positions.get(&id).map(|&position| position as usize)
    }
}

/// What masks of a scene must fit.
#[derive(Debug, Clone)]
pub(super) struct Pictures {
    /// Frames of the clip, ascending: the n-th picture of a render shows the n-th of them.
    pub(super) clip: Vec<u32>,
    /// Those that no one annotated, ascending: answers for them are left out, since nothing judges them.
    pub(super) unannotated: Vec<u32>,
    /// Columns and rows.
    pub(super) size: (u32, u32),
    /// Which picture an image of a COCO file is.
    pub(super) images: Option<Images>,
    profile: Profile,
}

impl Pictures {
    pub(super) fn read(request: &Request<'_>, scene: &Name) -> Result<Self, DataError> {
        let profile = request.profile;
        let images = match &request.images {
            Some(given) => Some(given.clone()),
            None => Images::find(request, scene)?,
        };
        let (clip, unannotated, size) = if profile.is_rendered() {
            (profile.frames().collect(), Vec::new(), (profile.width(), profile.height()))
        } else {
            let truth = request.bench.truth(profile, scene)?;
            (truth.clip(), truth.unannotated, (truth.width, truth.height))
        };
        Ok(Self { clip, unannotated, size, images, profile })
    }

    /// Leaves out pictures that repeat the last frame of the clip, since the export for the method had to have more; says
    /// so in words. Only a full set is known to be such: fewer pictures, or more, are another list of cameras.
    pub(super) fn leave_out_padding(&self, request: &Request<'_>, hits: &mut Vec<Hit>) -> Option<String> {
        let all = request.preset.padded_to.filter(|all| *all > self.clip.len())? as u64;
        let positions: BTreeSet<Option<u64>> = hits.iter().map(|hit| hit.number("position")).collect();
        if request.order != FrameOrder::Clip || !positions.into_iter().eq((0..all).map(Some)) {
            return None;
        }
        hits.retain(|hit| hit.number("position").is_some_and(|position| position < self.clip.len() as u64));
        Some(format!("{} to {} repeat the last frame and are left out", self.clip.len(), all - 1))
    }

    /// Whether an answer for a frame of the clip is judged.
    pub(super) fn is_asked(&self, frame: u32) -> bool {
        self.unannotated.binary_search(&frame).is_err()
    }

    /// Frames that have to be answered, ascending.
    pub(super) fn asked(&self) -> impl Iterator<Item = u32> {
        self.clip.iter().copied().filter(|frame| self.is_asked(*frame))
    }

    /// What frames there are, in words.
    pub(super) fn frames_in_words(&self) -> String {
        match (self.profile.is_rendered(), self.clip.as_slice()) {
            (false, [first, .., last]) => format!("no frame of the capture ({first} to {last})"),
            _ => format!("no frame of profile {} (every {}th from 0)", self.profile, self.profile.stride()),
        }
    }

    /// Whose pictures they are, in words.
    pub(super) fn owner(&self) -> String {
        if self.profile.is_rendered() {
            format!("profile {}", self.profile)
        } else {
            "the capture".to_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_says_which_pictures_count() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frames.txt");
        std::fs::write(&path, "-\n0\n12\n").unwrap();
        let order = FrameOrder::read(&path).unwrap();
        assert_eq!([0, 1, 2].map(|n| order.frame(n, &[0, 12]).unwrap()), [None, Some(0), Some(12)]);
        assert_eq!(order.frame(3, &[0, 12]), Err(3));
        std::fs::write(&path, "0\nx\n").unwrap();
        assert!(FrameOrder::read(&path).unwrap_err().to_string().contains("line 2"));
    }

    #[test]
    fn images_count_from_what_their_dataset_counts_from() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("_annotations.coco.json");
        std::fs::write(
            &path,
            r#"{"images": [{"id": 7, "file_name": "000003_png.rf.x.jpg"}], "annotations": []}"#,
        )
        .unwrap();
        assert_eq!(Images::read(&path, 1).unwrap().position(7), Some(2));
        assert_eq!(Images::read(&path, 0).unwrap().position(7), Some(3));
        assert!(Images::read(&path, 4).is_err());
    }
}
