//! Model folders of 4DGaussians, read and written.
//!
//! ```text
//! <model>/cfg_args
//! <model>/point_cloud/{iteration_<N>,coarse_iteration_<N>}/
//!     point_cloud.ply  deformation.pth  deformation_table.pth  deformation_accum.pth
//! ```

mod config;
pub mod keys;
mod time_axis;

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::{list_folder, write_atomic};

use super::cfg_args::{CfgArgs, Literal};
use super::fault::quoted;
use super::pickle::{self, Numbers};
use super::{Fault, build_field, ply};
use crate::deform::{DeformConfig, DeformationField};
use crate::gaussians::Gaussians;
use crate::tensor::Tensor;

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
    /// What the state dict holds beside the field, which nothing computes with: see [`keys::ballast`].
    pub beside: BTreeMap<String, Tensor>,
    /// Which Gaussians the original meant to deform. **It draws as if all were true**: its renderer reads the list and
    /// does not use it.
    pub table: Vec<bool>,
    /// Statistics that the original keeps for densification, a row a Gaussian; nothing draws with them.
    pub accumulated: Vec<[f32; 3]>,
    /// The options of the run.
    pub args: CfgArgs,
    /// What was ignored or assumed: for people, a sentence each.
    pub notes: Vec<String>,
}

impl ForeignModel {
    /// A model that another program trained, with the options that the original needs to draw it. `dynamic` names the
    /// Gaussians that go through the field; numbers beyond the last Gaussian are left out.
    pub fn new(save: Save, gaussians: Gaussians, field: DeformationField, dynamic: &[u32]) -> Self {
        let mut table = vec![false; gaussians.len()];
        for &index in dynamic {
            if let Some(moves) = table.get_mut(index as usize) {
                *moves = true;
            }
        }
        let accumulated = vec![[0.0; 3]; gaussians.len()];
        let args = config::fresh_args(gaussians.sh_degree.get());
        Self { save, gaussians, field, beside: BTreeMap::new(), table, accumulated, args, notes: Vec::new() }
    }

    /// The field with which the original draws this save: none at the coarse stage.
    pub fn drawn_field(&self) -> Option<&DeformationField> {
        (self.save.stage == Stage::Fine).then_some(&self.field)
    }
}

/// All saves in a model folder, the oldest first.
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
    tensors.retain(|name, _| !name.starts_with(keys::PREFIX));
    let beside = tensors;
    notes.extend(unknown_keys(&args, &beside));

    let count = gaussians.len();
    let table = match optional(&folder.join("deformation_table.pth"))? {
        Some((path, tensor)) => table_of(tensor, count).map_err(|fault| fault.at(&path))?,
        None => vec![true; count],
    };
    if table.contains(&false) {
        notes.push(
            "deformation_table.pth leaves Gaussians out; the original draws as if it did not".to_owned(),
        );
    }
    let accumulated = match optional(&folder.join("deformation_accum.pth"))? {
        Some((path, tensor)) => rows_of(tensor, count).map_err(|fault| fault.at(&path))?,
        None => vec![[0.0; 3]; count],
    };
    Ok(ForeignModel { save, gaussians, field, beside, table, accumulated, args, notes })
}

/// Writes a save into a model folder, beside others that stand there; the options of the folder become this model's.
///
/// A field that uses its whole time axis becomes the same field on the half axis that the original reads. Returns what
/// the format cannot say, a sentence each.
pub fn write(model: &Path, content: &ForeignModel) -> Result<Vec<String>, DataError> {
    let folder = model.join("point_cloud").join(content.save.to_string());
    let count = content.gaussians.len();
    let in_model = |fault: Fault| fault.at(model);
    for (field, rows) in [("table", content.table.len()), ("accumulated", content.accumulated.len())] {
        if rows != count {
            let message = format!("has {rows} rows for {count} Gaussians");
            return Err(in_model(Fault::new(format!("field `{field}`"), message, REMEDY_ONE_SAVE)));
        }
    }
    let (config, mut tensors) = time_axis::on_half(content.field.config(), content.field.tensors());
    let mut args = content.args.clone();
    args.set("sh_degree", Literal::Int(content.gaussians.sh_degree.get().into()));
    config::describe(&config, &mut args);
    check_harmonics(&args, &content.gaussians, &config).map_err(in_model)?;
    tensors.extend(keys::ballast(&args));
    tensors.extend(content.beside.iter().map(|(name, tensor)| (name.clone(), tensor.clone())));
    let pth = |stem: &str, encoded: Result<Vec<u8>, Fault>| {
        let path = folder.join(format!("{stem}.pth"));
        write_atomic(&path, &encoded.map_err(|fault| fault.at(&path))?)
    };
    pth("deformation", pickle::encode_state_dict("deformation", &tensors))?;
    let table = Numbers::Bool(&content.table);
    pth("deformation_table", pickle::encode_tensor("deformation_table", &[count], table))?;
    let accumulated = Numbers::F32(content.accumulated.as_flattened());
    pth("deformation_accum", pickle::encode_tensor("deformation_accum", &[count, 3], accumulated))?;
    ply::write(&folder.join("point_cloud.ply"), &content.gaussians)?;
    write_atomic(&model.join("cfg_args"), args.to_string().as_bytes())?;

    let frozen = content.table.iter().filter(|&&moves| !moves).count();
    let note = format!("{frozen} static Gaussians: 4DGaussians will deform them too, it ignores its table");
    Ok((frozen > 0).then_some(note).into_iter().collect())
}

/// The degree stands in the options, in the number of `f_rest_*`, and in the head that changes colours.
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

fn unknown_keys(args: &CfgArgs, beside: &BTreeMap<String, Tensor>) -> Option<String> {
    let ballast = keys::ballast(args);
    let known = |name: &String| ballast.iter().any(|(known, _)| known == name);
    let names: Vec<String> =
        beside.keys().filter(|name| !known(name)).take(8).map(|name| quoted(name)).collect();
    (!names.is_empty())
        .then(|| format!("deformation.pth has parameters that 4DGaussians does not: {}", names.join(", ")))
}

/// A file that the original can do without.
fn optional(path: &Path) -> Result<Option<(std::path::PathBuf, Tensor)>, DataError> {
    if !path.exists() {
        return Ok(None);
    }
    Ok(Some((path.to_owned(), pickle::read_tensor(path)?)))
}

fn table_of(tensor: Tensor, count: usize) -> Result<Vec<bool>, Fault> {
    if tensor.shape != [count] {
        return Err(wrong_rows(&tensor, format!("[{count}]")));
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

fn rows_of(tensor: Tensor, count: usize) -> Result<Vec<[f32; 3]>, Fault> {
    if tensor.shape != [count, 3] {
        return Err(wrong_rows(&tensor, format!("[{count}, 3]")));
    }
    Ok(tensor.data.as_chunks::<3>().0.to_vec())
}

fn wrong_rows(tensor: &Tensor, expected: String) -> Fault {
    let message =
        format!("has the shape {:?}, but the Gaussians of point_cloud.ply need {expected}", tensor.shape);
    Fault::new("tensor", message, REMEDY_ONE_SAVE)
}
