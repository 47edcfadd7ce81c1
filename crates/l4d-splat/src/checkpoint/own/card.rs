//! `checkpoint.json`.

use std::collections::BTreeMap;

use l4d_data::{Name, Profile};
use serde::{Deserialize, Serialize};

use super::{REMEDY, is_tensors_name};
use crate::checkpoint::fault::{Fault, quoted};
use crate::deform::DeformConfig;
use crate::gaussians::ShDegree;

/// Schema tag of a checkpoint.
pub const SCHEMA: &str = "l4d/splats/1";

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Card {
    pub(super) schema: String,
    pub(super) scene: Option<Name>,
    pub(super) profile: Option<Profile>,
    pub(super) iteration: u64,
    pub(super) gaussians: usize,
    pub(super) dynamic: usize,
    pub(super) sh_degree: u8,
    pub(super) deformation: Option<DeformConfig>,
    pub(super) tensors: TensorsFile,
    pub(super) inputs: BTreeMap<String, String>,
    pub(super) training: serde_json::Map<String, serde_json::Value>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TensorsFile {
    pub(super) file: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
}

impl Card {
    /// Refuses what no checkpoint says; gives the degree of the harmonics.
    pub(super) fn check(&self) -> Result<ShDegree, Fault> {
        if self.schema != SCHEMA {
            let message = format!("is {}, but this l4d reads `{SCHEMA}`", quoted(&self.schema));
            return Err(Fault::new(
                "field `schema`",
                message,
                "read the checkpoint with the l4d that wrote it",
            ));
        }
        if !is_tensors_name(&self.tensors.file) {
            let message =
                format!("is {}, but `splats-<digest>.safetensors` belongs there", quoted(&self.tensors.file));
            return Err(Fault::new("field `tensors.file`", message, REMEDY));
        }
        ShDegree::new(self.sh_degree).ok_or_else(|| {
            Fault::new("field `sh_degree`", format!("is {}, but degrees end at 3", self.sh_degree), REMEDY)
        })
    }
}
