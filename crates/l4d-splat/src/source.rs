//! A model on disk, whatever program wrote it.
//!
//! Owns the detection of the three families of files, and what a model says of its origin.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use l4d_data::digest::sha256_file;
use l4d_data::{DataError, Name, Profile};

use crate::checkpoint::own::Sampling;
use crate::checkpoint::{foreign, own, ply};
use crate::model::Model;

const REMEDY: &str =
    "give a checkpoint folder of `l4d train-splats`, a model folder of 4DGaussians, or a PLY of 3DGS";

/// Program that wrote a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// A folder with `checkpoint.json`.
    Own,
    /// A folder with `cfg_args` and `point_cloud`.
    FourDGaussians,
    /// One file: Gaussians that stand still.
    Ply,
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Own => "l4d",
            Self::FourDGaussians => "4dgaussians",
            Self::Ply => "ply",
        })
    }
}

/// A model and where it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// What can be drawn.
    pub model: Model,
    /// Program that wrote it.
    pub family: Family,
    /// Scene of the benchmark that it was trained on, where it says so.
    pub scene: Option<Name>,
    /// Profile of the pictures that it was trained on, where it says so.
    pub profile: Option<Profile>,
    /// Which pictures of a capture it was trained on, where it says so.
    pub sampling: Option<Sampling>,
    /// Whether it learned from rendered depth of the training views, where it says so.
    pub saw_depth: Option<bool>,
    /// What it was trained to show where nothing is, display colour, where it says so.
    pub background: Option<[f32; 3]>,
    /// SHA-256 of the files that say everything else, by their path within the model.
    pub inputs: BTreeMap<String, String>,
    /// What was ignored or assumed: for people, a sentence each.
    pub notes: Vec<String>,
}

impl Source {
    /// Reads the model at a path.
    ///
    /// # Errors
    /// A path that holds no model, and whatever is wrong with the model that it holds.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        if path.is_file() {
            return Self::open_ply(path);
        }
        if path.join(own::CARD).is_file() {
            return Self::open_own(path);
        }
        if path.join("cfg_args").is_file() || path.join("point_cloud").is_dir() {
            return Self::open_foreign(path);
        }
        let message = if path.is_dir() {
            format!("has neither `{}` nor `cfg_args`", own::CARD)
        } else {
            "there is nothing".to_owned()
        };
        Err(DataError::invalid(path, "model", message, REMEDY))
    }

    /// What [`Self::saw_depth`] is of the model at a path, without reading the model; none where there is no model of ours.
    ///
    /// # Errors
    /// A damaged `checkpoint.json`.
    pub fn saw_depth_of(path: &Path) -> Result<Option<bool>, DataError> {
        if path.join(own::CARD).is_file() { own::saw_depth(path) } else { Ok(None) }
    }

    fn open_own(folder: &Path) -> Result<Self, DataError> {
        let checkpoint = own::read(folder)?;
        Ok(Self {
            scene: checkpoint.scene.clone(),
            profile: checkpoint.profile,
            sampling: checkpoint.sampling,
            saw_depth: checkpoint.saw_depth,
            // The card names the tensors by their digest.
            ..Self::bare(checkpoint.model, Family::Own, digests(folder, &[own::CARD.to_owned()])?)
        })
    }

    fn open_foreign(folder: &Path) -> Result<Self, DataError> {
        let foreign = foreign::read(folder)?;
        let save = format!("point_cloud/{}", foreign.save);
        let mut files = vec!["cfg_args".to_owned(), format!("{save}/point_cloud.ply")];
        if foreign.drawn_field().is_some() {
            files.push(format!("{save}/deformation.pth"));
        }
        let background = foreign.background;
        let mut notes = foreign.notes.clone();
        notes.push(format!("drawn from {}", foreign.save));
        let bare = Self::bare(foreign.into(), Family::FourDGaussians, digests(folder, &files)?);
        Ok(Self { background, notes, ..bare })
    }

    fn open_ply(file: &Path) -> Result<Self, DataError> {
        let gaussians = ply::read(file)?;
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let model = Model { gaussians, ..Model::default() };
        let inputs = BTreeMap::from([(name, sha256_file(file)?)]);
        Ok(Self::bare(model, Family::Ply, inputs))
    }

    /// A model that says nothing of its origin.
    fn bare(model: Model, family: Family, inputs: BTreeMap<String, String>) -> Self {
        let (scene, profile, sampling, saw_depth, background) = (None, None, None, None, None);
        Self { model, family, scene, profile, sampling, saw_depth, background, inputs, notes: Vec::new() }
    }
}

fn digests(folder: &Path, files: &[String]) -> Result<BTreeMap<String, String>, DataError> {
    files.iter().map(|file| Ok((file.clone(), sha256_file(&folder.join(file))?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkpoint::own::Checkpoint;
    use crate::synthetic::Room;

    fn model() -> Model {
        Room { gaussians: 40, ..Room::small(3) }.model().unwrap()
    }

    #[test]
    fn each_family_is_told_by_its_files() {
        let folder = tempfile::tempdir().unwrap();
        let model = model();

        let own = folder.path().join("own");
        model.write(&own).unwrap();
        let source = Source::open(&own).unwrap();
        assert_eq!((source.family, &source.model), (Family::Own, &model));
        assert_eq!(source.inputs.keys().collect::<Vec<_>>(), ["checkpoint.json"]);
        assert_eq!(source.saw_depth, None, "it does not say how it was trained");

        let theirs = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/checkpoint/model");
        let source = Source::open(theirs.as_ref()).unwrap();
        assert_eq!(source.family, Family::FourDGaussians);
        assert_eq!(source.model.dynamic.len(), 5, "the original deforms them all");
        assert_eq!((source.inputs.len(), source.background), (3, Some([1.0; 3])));
        assert_eq!(source.notes.last().unwrap(), "drawn from iteration_7");

        let file = folder.path().join("bare.ply");
        ply::write(&file, &model.gaussians).unwrap();
        let source = Source::open(&file).unwrap();
        assert_eq!((source.family, source.model.field.is_some()), (Family::Ply, false));
        assert_eq!(source.model.gaussians, model.gaussians);
    }

    #[test]
    fn a_model_says_whether_it_saw_depth() {
        let folder = tempfile::tempdir().unwrap();
        for saw_depth in [None, Some(true), Some(false)] {
            let checkpoint = Checkpoint { saw_depth, model: model(), ..Checkpoint::default() };
            own::write(folder.path(), &checkpoint).unwrap();
            assert_eq!(Source::open(folder.path()).unwrap().saw_depth, saw_depth);
            assert_eq!(Source::saw_depth_of(folder.path()).unwrap(), saw_depth);
        }
        assert_eq!(Source::saw_depth_of(&folder.path().join("nowhere")).unwrap(), None);
    }

    #[test]
    fn what_is_no_model_is_told_with_what_would_be_one() {
        let folder = tempfile::tempdir().unwrap();
        let error = Source::open(folder.path()).unwrap_err();
        assert!(error.to_string().contains("neither `checkpoint.json` nor `cfg_args`"), "{error}");
        assert!(error.hint().unwrap().contains("train-splats"));
        let error = Source::open(&folder.path().join("nowhere")).unwrap_err();
        assert!(error.to_string().contains("there is nothing"), "{error}");
    }
}
