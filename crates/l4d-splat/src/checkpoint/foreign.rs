//! Models of 4DGaussians and 4D LangSplat: what they save, and with which reader's pictures they were trained.
//!
//! ```text
//! <model>/cfg_args
//! <model>/point_cloud/{iteration_<N>,coarse_iteration_<N>,fine-lang_iteration_<N>,...}/
//!     point_cloud.ply  deformation.pth
//! <model>/chkpnt_{coarse,fine}_<N>.pth
//! ```

mod config;

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use l4d_data::reader::{EXPORT_CARD, Reader, Trained};
use l4d_data::store::list_folder;
use l4d_data::{DataError, Name, Profile, json};
use l4d_formats::fault::quoted;
use l4d_formats::{Fault, Tensor, pickle};
use serde::{Deserialize, Serialize};

use self::config::Options;
use super::{build_field, ply};
use crate::deform::{DeformConfig, DeformationField, PREFIX};
use crate::gaussians::{Gaussians, ShDegree};
use crate::language::{Language, is_language};

const HINT_FOLDER: &str =
    "give the folder that 4DGaussians trained into: it holds cfg_args and point_cloud/iteration_<N>";
const HINT_ONE_SAVE: &str = "take all files of the iteration folder from the same save";

/// Stage of training at which a model was saved, the later the larger. 4D LangSplat's have names of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Before time matters: drawn without the field.
    Coarse,
    /// The same, with language.
    CoarseLang,
    /// With the field.
    Fine,
    /// With the field, before language.
    FineBase,
    /// With the field and language.
    FineLang,
    /// With the field and language that changes between states.
    FineLangDiscrete,
}

impl Stage {
    const ALL: [(Self, &str); 6] = [
        (Self::Coarse, "coarse_"),
        (Self::CoarseLang, "coarse-lang_"),
        (Self::Fine, ""),
        (Self::FineBase, "fine-base_"),
        (Self::FineLang, "fine-lang_"),
        (Self::FineLangDiscrete, "fine-lang-discrete_"),
    ];

    fn prefix(self) -> &'static str {
        Self::ALL.iter().find(|(stage, _)| *stage == self).map_or("", |(_, prefix)| prefix)
    }
}

/// One save of a model. The newest is the largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Save {
    /// Stage of training.
    pub stage: Stage,
    /// Iteration within the stage.
    pub iteration: u32,
}

impl Save {
    fn parse(folder: &str) -> Option<Self> {
        let (prefix, number) = folder.rsplit_once("iteration_")?;
        let (stage, _) = *Stage::ALL.iter().find(|(_, known)| *known == prefix)?;
        let save = Self { stage, iteration: number.parse().ok()? };
        (save.to_string() == folder).then_some(save)
    }
}

/// The name of the folder.
impl fmt::Display for Save {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}iteration_{}", self.stage.prefix(), self.iteration)
    }
}

/// What a user says of a model that it does not say itself.
#[derive(Debug, Clone, Copy, Default)]
pub struct ReaderOptions {
    /// The reader that it was trained with.
    pub reader: Option<Reader>,
    /// Degree of the harmonics that are drawn.
    pub sh_degree: Option<ShDegree>,
    /// What is nearer than this is not drawn, units of its world.
    pub near_m: Option<f32>,
}

/// The moments that a model was trained on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Moments {
    /// It says nothing of them.
    Unknown,
    /// All those of a clip, as this reader counts them.
    Counted(Reader),
    /// Frames of the clip, and the time of each.
    Listed(Vec<u32>, Vec<f32>),
}

/// What the export says that a model was trained on.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Export {
    pub scene: Name,
    /// Profile of its pictures.
    pub profile: Profile,
    /// Whether any of it came from rendered depth.
    #[serde(default)]
    pub depth: bool,
    frames: Vec<u32>,
    #[serde(default)]
    trained: Option<Trained>,
}

impl Export {
    /// That of the data in `source_path` of a model, or a copy beside its `cfg_args`.
    ///
    /// The path is the one that was typed: if it is relative, then to the folder in which training was started, which
    /// is above the model unless that was moved.
    fn find(model: &Path, source_path: Option<&str>) -> Result<Option<(PathBuf, Self)>, DataError> {
        let model = std::path::absolute(model).map_err(|source| DataError::io(model, "find", source))?;
        let data =
            source_path.into_iter().flat_map(|data| model.ancestors().map(move |above| above.join(data)));
        let places = std::iter::once(model.clone()).chain(data).map(|folder| folder.join(EXPORT_CARD));
        let Some(path) = places.into_iter().find(|path| path.is_file()) else { return Ok(None) };
        let export: Self = json::read(&path)?;
        let Self { frames, trained, .. } = &export;
        let is_sound = |trained: &Trained| {
            trained.times.len() == frames.len() && trained.times.iter().all(|time| (0.0..=1.0).contains(time))
        };
        if !frames.is_sorted_by(|a, b| a < b) || !trained.as_ref().is_none_or(is_sound) {
            let message = "has not one time from 0 to 1 for each of `frames`, which ascend";
            return Err(DataError::invalid(&path, "field `trained`", message, "export the scene again"));
        }
        Ok(Some((path, export)))
    }
}

/// A model as 4DGaussians stores it.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignModel {
    pub save: Save,
    /// The canonical Gaussians.
    pub gaussians: Gaussians,
    pub field: DeformationField,
    /// What its Gaussians mean, of stages with language.
    pub language: Option<Language>,
    /// The moments that it was trained on.
    pub moments: Moments,
    /// What it was trained to show where nothing is, display colour, where that is known.
    pub background: Option<[f32; 3]>,
    /// What it was trained on, and where that is said.
    pub export: Option<(PathBuf, Export)>,
    /// What was ignored or assumed: for people, a sentence each.
    pub notes: Vec<String>,
}

impl ForeignModel {
    /// The field with which the original draws this save: none at the coarse stage.
    pub fn drawn_field(&self) -> Option<&DeformationField> {
        (self.save.stage >= Stage::Fine).then_some(&self.field)
    }
}

/// Reads the newest save of a model: the last fine one, or the last coarse one where none is fine.
///
/// # Errors
/// Files that are missing, damaged or do not belong together, and options that change what the field computes.
pub fn read(model: &Path, reader_options: ReaderOptions) -> Result<ForeignModel, DataError> {
    let folder = model.join("point_cloud");
    let missing = |message| DataError::invalid(model, "folder `point_cloud`", message, HINT_FOLDER);
    if !folder.is_dir() {
        return Err(missing("is missing"));
    }
    let saves = list_folder(&folder)?;
    let save = saves.iter().filter_map(|name| Save::parse(name)).max();
    let save = save.ok_or_else(|| missing("holds no save"))?;
    let folder = folder.join(save.to_string());
    let cloud = folder.join("point_cloud.ply");
    let gaussians = ply::read(&cloud)?;
    let tensors = pickle::read_state_dict(&folder.join("deformation.pth"))?;
    let latents = match save.stage {
        Stage::FineLang | Stage::FineLangDiscrete => Some(ply::read_language(&cloud)?),
        _ => None,
    };
    assemble(model, save, (gaussians, None), tensors, latents, reader_options)
}

/// What a model was trained on, where that is known, and which file says so.
///
/// # Errors
/// Files that are damaged.
pub fn export_of(model: &Path) -> Result<Option<(PathBuf, Export)>, DataError> {
    Export::find(model, Options::read(&model.join("cfg_args"))?.text("source_path"))
}

/// What the original draws of Gaussians and parameters that were saved together, harmonics up to the active degree.
pub(crate) fn assemble(
    model: &Path,
    save: Save,
    (gaussians, active): (Gaussians, Option<ShDegree>),
    mut tensors: BTreeMap<String, Tensor>,
    latents: Option<(Vec<f32>, usize)>,
    reader_options: ReaderOptions,
) -> Result<ForeignModel, DataError> {
    let options = Options::read(&model.join("cfg_args"))?;
    let export = Export::find(model, options.text("source_path"))?;
    let listed = export.as_ref().and_then(|(_, export)| Some((export, export.trained.as_ref()?)));
    let reader = reader_options.reader.or(listed.map(|(_, trained)| trained.reader));
    let moments = match (reader_options.reader, listed, &export) {
        (None, Some((export, trained)), _) => Moments::Listed(export.frames.clone(), trained.times.clone()),
        (Some(reader), _, Some((_, export))) => {
            Moments::Listed(export.frames.clone(), reader.trained(export.frames.len()).times)
        }
        (Some(reader), _, None) => Moments::Counted(reader),
        (None, None, _) => Moments::Unknown,
    };
    let trained = match (reader_options.reader, listed) {
        (None, Some((_, trained))) => Some(trained.clone()),
        (reader, _) => reader.map(|reader| reader.trained(0)),
    };
    let by_reader = trained.as_ref().and_then(|trained| ShDegree::new(trained.sh_degree?));
    let mut notes = Vec::new();
    let mut config = config::derive(&options, &tensors).map_err(|fault| fault.at(model))?;
    check_harmonics(&gaussians, &config).map_err(|fault| fault.at(model))?;
    if trained.is_none() && !config.no_dshs && has_constant_colours(&gaussians) {
        notes.push(
            "no colour depends on direction, as after training with the reader PanopticSports, which draws at degree 0 over \
             black: say --reader panoptic if it was that one"
                .to_owned(),
        );
    }
    let gaussians = match reader_options.sh_degree.or(by_reader).or(active) {
        Some(degree) => gaussians.up_to(degree),
        None => gaussians,
    };
    if gaussians.sh_degree.coefficients() < config.sh_coefficients {
        config.sh_coefficients = gaussians.sh_degree.coefficients();
        cut_harmonics(&mut tensors, config.sh_coefficients);
    }
    let language = match latents {
        Some((latents, total)) if save.stage == Stage::FineLangDiscrete => Some(
            Language::between_states(latents, total, &config, &tensors).map_err(|fault| fault.at(model))?,
        ),
        Some((latents, width)) if width > 0 && options.is_zero("no_dlang") => {
            Some(Language::drifting(latents, width, &tensors).map_err(|fault| fault.at(model))?)
        }
        Some((latents, width)) if width > 0 => Some(Language::constant(latents, width)),
        _ => None,
    };
    tensors.retain(|name, _| !is_language(name));
    let field = build_field(config, &tensors).map_err(|fault| fault.at(model))?;
    tensors.retain(|name, _| !name.starts_with(PREFIX) && !is_unused(name));
    if !tensors.is_empty() {
        let names: Vec<String> = tensors.keys().take(8).map(|name| quoted(name)).collect();
        notes.push(format!("deformation.pth has parameters that 4DGaussians does not: {}", names.join(", ")));
    }
    let by_reader = trained.and_then(|trained| trained.background);
    if let (Some(reader), Some(drawn), Some(said)) = (reader, by_reader, options.background())
        && drawn != said
    {
        notes.push(format!(
            "cfg_args says another background than the reader {} draws over, and that is shown",
            reader.as_str()
        ));
    }
    let background = by_reader.or(options.background());
    Ok(ForeignModel { save, gaussians, field, language, moments, background, export, notes })
}

/// Whether all harmonics of the Gaussians are zero but the constant one, and there are others.
fn has_constant_colours(gaussians: &Gaussians) -> bool {
    let count = gaussians.sh_degree.coefficients();
    count > 1 && gaussians.sh.chunks(count).all(|sh| sh[1..].as_flattened().iter().all(|value| *value == 0.0))
}

/// Leaves the head that changes harmonics its rows for the first coefficients: three for each.
fn cut_harmonics(tensors: &mut BTreeMap<String, Tensor>, coefficients: usize) {
    for list in ["weight", "bias"] {
        let Some(Tensor { shape, data }) = tensors.get_mut(&format!("{PREFIX}shs_deform.3.{list}")) else {
            continue;
        };
        if let Some(rows) = shape.first_mut().filter(|rows| **rows > 3 * coefficients) {
            data.truncate(data.len() / *rows * 3 * coefficients);
            *rows = 3 * coefficients;
        }
    }
}

/// Parameters that the original saves and nothing computes with: tables of powers of two, and a network for time.
fn is_unused(name: &str) -> bool {
    let tables = ["time_poc", "pos_poc", "rotation_scaling_poc", "opacity_poc"];
    name.starts_with("timenet.") || tables.contains(&name)
}

/// The degree is in the number of `f_rest_*` and in the head that changes colours.
fn check_harmonics(gaussians: &Gaussians, config: &DeformConfig) -> Result<(), Fault> {
    let (head, stored) = (config.sh_coefficients, gaussians.sh_degree.coefficients());
    if !config.no_dshs && head != stored {
        let message = format!("changes {head} coefficients a channel, but point_cloud.ply has {stored}");
        return Err(Fault::new("parameter `deformation_net.shs_deform.3.bias`", message, HINT_ONE_SAVE));
    }
    Ok(())
}
