//! What has been measured so far, one file a query and lift, so that a run that was killed goes on where it was.
//! A run that ends throws the folder away: times are only worth comparing within one run.

use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_hex;
use l4d_data::{Query, json};
use l4d_ground::Grounder;
use l4d_solve::lift::ModelDigest;
use l4d_splat::raster::Rasterizer;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::variants::Variant;
use crate::Result;
use crate::judged_scene::JudgedScene;

/// One answer in one reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sample {
    pub(super) lift_seconds: f64,
    pub(super) mask_seconds: f64,
    /// 0 to 1; none if the target is never present.
    pub(super) miou: Option<f64>,
    pub(super) tube_iou: Option<f64>,
    /// Percent.
    pub(super) flicker: Option<f64>,
}

/// The samples of a scene.
pub(super) struct Samples {
    folder: PathBuf,
    /// What all of them depend on.
    about: Value,
}

impl Samples {
    pub(super) fn of_scene(
        folder: &Path,
        judged: &JudgedScene<'_>,
        grounder: &dyn Grounder,
        rasterizer: &dyn Rasterizer,
    ) -> Self {
        let scene = &judged.scene;
        let about = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": scene.name,
            "profile": scene.profile,
            "model": ModelDigest::of(&scene.source.model),
            "clips": scene.clip_digests,
            "grounder": grounder.identity(),
            "rasterizer": rasterizer.name(),
            "threads": rayon::current_num_threads(),
        });
        Self { folder: folder.to_owned(), about }
    }

    pub(super) fn read(&self, query: &Query, variant: &Variant) -> Result<Option<Vec<Sample>>> {
        let path = self.path(query, variant);
        Ok(if path.exists() { Some(json::read(&path)?) } else { None })
    }

    pub(super) fn write(&self, query: &Query, variant: &Variant, samples: &[Sample]) -> Result<()> {
        Ok(json::write(&self.path(query, variant), &samples)?)
    }

    fn path(&self, query: &Query, variant: &Variant) -> PathBuf {
        let key = json!({
            "about": self.about, "query": query, "lift": variant.lift, "read_outs": variant.read_outs,
        });
        self.folder.join(format!("{}.json", sha256_hex(json::canonical(&key).as_bytes())))
    }
}
