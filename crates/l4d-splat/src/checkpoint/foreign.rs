//! Model folders of 4DGaussians.
//!
//! ```text
//! <model>/cfg_args
//! <model>/point_cloud/{iteration_<N>,coarse_iteration_<N>}/
//!     point_cloud.ply  deformation.pth  deformation_table.pth
//! ```

mod config;
pub mod keys;

use std::fmt;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::list_folder;
use l4d_formats::fault::quoted;
use l4d_formats::{Fault, Tensor, pickle};

use super::cfg_args::{CfgArgs, Literal};
use super::{build_field, ply};
use crate::deform::{DeformConfig, DeformationField};
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
    /// Which Gaussians the original meant to deform. **It draws as if all were true**: its renderer reads the list and
    /// does not use it.
    pub table: Vec<bool>,
    /// The options of the run.
    pub args: CfgArgs,
    /// What was ignored or assumed: for people, a sentence each.
    pub notes: Vec<String>,
}

impl ForeignModel {
    /// The field with which the original draws this save: none at the coarse stage.
    pub fn drawn_field(&self) -> Option<&DeformationField> {
        (self.save.stage == Stage::Fine).then_some(&self.field)
    }
}

/// All saves in a model folder, the oldest first.
///
/// # Errors
/// A folder without `point_cloud`.
pub fn saves(model: &Path) -> Result<Vec<Save>, DataError> {
    let folder = model.join("point_cloud");
    if !folder.is_dir() {
        return Err(DataError::invalid(model, "folder `point_cloud`", "is missing", REMEDY_FOLDER));
    }
    let mut saves: Vec<Save> = list_folder(&folder)?.iter().filter_map(|name| Save::parse(name)).collect();
    saves.sort_unstable();
    Ok(saves)
}

/// Reads a save of a model, or the newest: the last fine one, or the last coarse one where none is fine.
///
/// # Errors
/// Files that are missing, damaged or do not belong together, and options that change what the field computes.
pub fn read(model: &Path, save: Option<Save>) -> Result<ForeignModel, DataError> {
    let found = saves(model)?;
    let newest = found.last().copied();
    let save = save.or(newest).filter(|save| found.contains(save)).ok_or_else(|| {
        let names: Vec<String> = found.iter().map(Save::to_string).collect();
        let message = match save {
            Some(save) => format!(
                "has no {save}, only: {}",
                if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
            ),
            None => "holds no save".to_owned(),
        };
        DataError::invalid(model, "folder `point_cloud`", message, REMEDY_FOLDER)
    })?;
    let folder = model.join("point_cloud").join(save.to_string());
    let args = CfgArgs::read(&model.join("cfg_args"))?;
    let ply::Decoded { gaussians, mut notes } = ply::read(&folder.join("point_cloud.ply"))?;
    let mut tensors = pickle::read_state_dict(&folder.join("deformation.pth"))?;
    let config = config::derive(&args, &tensors).map_err(|fault| fault.at(model))?;
    check_harmonics(&args, &gaussians, &config).map_err(|fault| fault.at(model))?;
    let field = build_field(config, &tensors).map_err(|fault| fault.at(model))?;
    tensors.retain(|name, _| !name.starts_with(keys::PREFIX) && !keys::is_unused(name));
    if !tensors.is_empty() {
        let names: Vec<String> = tensors.keys().take(8).map(|name| quoted(name)).collect();
        notes.push(format!("deformation.pth has parameters that 4DGaussians does not: {}", names.join(", ")));
    }

    let count = gaussians.len();
    let table = folder.join("deformation_table.pth");
    let table = match table.exists() {
        true => table_of(pickle::read_tensor(&table)?, count).map_err(|fault| fault.at(&table))?,
        // The original can do without.
        false => vec![true; count],
    };
    if table.contains(&false) {
        notes.push(
            "deformation_table.pth leaves Gaussians out; the original draws as if it did not".to_owned(),
        );
    }
    Ok(ForeignModel { save, gaussians, field, table, args, notes })
}

/// The degree is in the options, in the number of `f_rest_*`, and in the head that changes colours.
fn check_harmonics(args: &CfgArgs, gaussians: &Gaussians, config: &DeformConfig) -> Result<(), Fault> {
    let degree = gaussians.sh_degree.get();
    if let Some(said) = args.get("sh_degree")
        && *said != Literal::Int(degree.into())
    {
        let message =
            format!("is {}, but point_cloud.ply has harmonics of degree {degree}", quoted(&said.to_string()));
        return Err(Fault::new("cfg_args, option `sh_degree`", message, REMEDY_ONE_SAVE));
    }
    let (head, stored) = (config.sh_coefficients, gaussians.sh_degree.coefficients());
    if !config.no_dshs && head != stored {
        let message = format!("changes {head} coefficients a channel, but point_cloud.ply has {stored}");
        return Err(Fault::new("parameter `deformation_net.shs_deform.3.bias`", message, REMEDY_ONE_SAVE));
    }
    Ok(())
}

fn table_of(tensor: Tensor, count: usize) -> Result<Vec<bool>, Fault> {
    if tensor.shape != [count] {
        let shape = &tensor.shape;
        let message = format!("has the shape {shape:?}, but the Gaussians of point_cloud.ply need [{count}]");
        return Err(Fault::new("tensor", message, REMEDY_ONE_SAVE));
    }
    match tensor.data.iter().find(|&&value| value != 0.0 && value != 1.0) {
        Some(value) => Err(Fault::new(
            "tensor",
            format!("has the value {value}, but truth values belong there"),
            REMEDY_ONE_SAVE,
        )),
        None => Ok(tensor.data.into_iter().map(|value| value == 1.0).collect()),
    }
}
