//! Model folders of 4DGaussians.
//!
//! ```text
//! <model>/cfg_args
//! <model>/point_cloud/{iteration_<N>,coarse_iteration_<N>}/
//!     point_cloud.ply  deformation.pth
//! ```

mod config;

use std::fmt;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::list_folder;
use l4d_formats::fault::quoted;
use l4d_formats::{Fault, pickle};

use self::config::Options;
use super::{build_field, ply};
use crate::deform::{DeformConfig, DeformationField, PREFIX};
use crate::gaussians::Gaussians;

const REMEDY_FOLDER: &str =
    "give the folder that 4DGaussians trained into: it holds cfg_args and point_cloud/iteration_<N>";
const REMEDY_ONE_SAVE: &str = "take all files of the iteration folder from the same save";

/// Stage of training at which a model was saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Before time matters: drawn without the field.
    Coarse,
    /// With the field.
    Fine,
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
        let (stage, number) = match folder.strip_prefix("coarse_iteration_") {
            Some(number) => (Stage::Coarse, number),
            None => (Stage::Fine, folder.strip_prefix("iteration_")?),
        };
        let save = Self { stage, iteration: number.parse().ok()? };
        (save.to_string() == folder).then_some(save)
    }
}

/// The name of the folder.
impl fmt::Display for Save {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stage = if self.stage == Stage::Coarse { "coarse_" } else { "" };
        write!(f, "{stage}iteration_{}", self.iteration)
    }
}

/// A model as 4DGaussians stores it.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignModel {
    /// Which save.
    pub save: Save,
    /// The canonical Gaussians.
    pub gaussians: Gaussians,
    /// The field.
    pub field: DeformationField,
    /// What it was trained to show where nothing is, display colour, where the options say so.
    pub background: Option<[f32; 3]>,
    /// What was ignored or assumed: for people, a sentence each.
    pub notes: Vec<String>,
}

impl ForeignModel {
    /// The field with which the original draws this save: none at the coarse stage.
    pub fn drawn_field(&self) -> Option<&DeformationField> {
        (self.save.stage == Stage::Fine).then_some(&self.field)
    }
}

/// Reads the newest save of a model: the last fine one, or the last coarse one where none is fine.
///
/// # Errors
/// Files that are missing, damaged or do not belong together, and options that change what the field computes.
pub fn read(model: &Path) -> Result<ForeignModel, DataError> {
    let folder = model.join("point_cloud");
    let missing = |message| DataError::invalid(model, "folder `point_cloud`", message, REMEDY_FOLDER);
    if !folder.is_dir() {
        return Err(missing("is missing"));
    }
    let saves = list_folder(&folder)?;
    let save = saves.iter().filter_map(|name| Save::parse(name)).max();
    let save = save.ok_or_else(|| missing("holds no save"))?;
    let folder = folder.join(save.to_string());
    let options = Options::read(&model.join("cfg_args"))?;
    let gaussians = ply::read(&folder.join("point_cloud.ply"))?;
    let mut notes = Vec::new();
    let mut tensors = pickle::read_state_dict(&folder.join("deformation.pth"))?;
    let config = config::derive(&options, &tensors).map_err(|fault| fault.at(model))?;
    check_harmonics(&gaussians, &config).map_err(|fault| fault.at(model))?;
    let field = build_field(config, &tensors).map_err(|fault| fault.at(model))?;
    tensors.retain(|name, _| !name.starts_with(PREFIX) && !is_unused(name));
    if !tensors.is_empty() {
        let names: Vec<String> = tensors.keys().take(8).map(|name| quoted(name)).collect();
        notes.push(format!("deformation.pth has parameters that 4DGaussians does not: {}", names.join(", ")));
    }
    Ok(ForeignModel { save, gaussians, field, background: options.background(), notes })
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
        return Err(Fault::new("parameter `deformation_net.shs_deform.3.bias`", message, REMEDY_ONE_SAVE));
    }
    Ok(())
}
