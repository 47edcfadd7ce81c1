//! `checkpoint.json`.

use std::collections::BTreeMap;

use l4d_data::{Name, Profile};
use serde::{Deserialize, Serialize};

use super::{KIND, REMEDY, Sampling};
use l4d_formats::Fault;
use l4d_formats::fault::quoted;
use l4d_formats::tensor_file::TensorFile;

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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) sampling: Option<Sampling>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) saw_depth: Option<bool>,
    pub(super) iteration: u64,
    pub(super) gaussians: usize,
    pub(super) dynamic: usize,
    pub(super) sh_degree: u8,
    pub(super) deformation: Option<DeformConfig>,
    pub(super) tensors: TensorFile,
    pub(super) inputs: BTreeMap<String, String>,
    pub(super) training: serde_json::Map<String, serde_json::Value>,
}

impl Card {
    /// Whether depth was looked at. Models of before there was the field follow from how they were trained: rendered
    /// scenes have depth, which only `sweep` left unread.
    pub(super) fn saw_depth(&self) -> Option<bool> {
        let derived = || {
            let init = self.training.get("origin")?.get("init")?.as_str()?;
            Some(self.profile?.is_rendered() && init != "sweep")
        };
        self.saw_depth.or_else(derived)
    }

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
        KIND.check(&self.tensors)?;
        ShDegree::new(self.sh_degree).ok_or_else(|| {
            Fault::new("field `sh_degree`", format!("is {}, but degrees end at 3", self.sh_degree), REMEDY)
        })
    }
}
