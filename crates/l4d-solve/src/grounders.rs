//! From the choice of a grounder to one that can be asked about a scene.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use l4d_data::layout::SceneDir;
use l4d_data::tracks::Tracks;
use l4d_data::{Query, StageError};
use l4d_ground::Grounder;
use l4d_ground::files::Files;
use l4d_ground::oracle::{NoisePreset, Oracle, Target, open_ids};
use l4d_ground::panoptic::{Fused, Given, Panoptic, Part};
use l4d_ground::vlm::Vlm;

use l4d_splat::raster::Rasterizer;

use crate::clips::Plan;
use crate::scene::SolveScene;

/// What finds things, before the scene is known.
pub enum Grounders {
    /// One for all scenes.
    Shared(Arc<dyn Grounder + Send + Sync>),
    /// What looks at all views of a scene before it answers.
    Fused {
        /// What sees and reads.
        panoptic: Arc<Panoptic>,
        /// What is taken from the truth.
        given: BTreeSet<Part>,
    },
    /// One for all scenes, which asks a model server.
    Vlm(Arc<Vlm>),
    /// The truth of a scene, with these errors.
    Oracle(NoisePreset),
    /// Masks in this folder.
    Files(PathBuf),
}

impl Grounders {
    /// The one that reads sentences before a scene is known, if there is one.
    pub fn of_any_scene(&self) -> Option<&dyn Grounder> {
        match self {
            Self::Shared(grounder) => Some(grounder.as_ref()),
            Self::Fused { panoptic, .. } => Some(panoptic.as_ref()),
            Self::Vlm(vlm) => Some(vlm.as_ref()),
            Self::Oracle(_) | Self::Files(_) => None,
        }
    }

    /// The one for a scene. Queries are what the oracle knows the meaning of; the others don't look at them.
    ///
    /// # Errors
    /// Masks or ids that are not there, noise that cannot be drawn.
    pub fn of_scene(
        &self,
        scene: &SolveScene,
        rasterizer: &dyn Rasterizer,
        place: &SceneDir,
        queries: &[Query],
    ) -> Result<Arc<dyn Grounder + Send + Sync>, StageError> {
        Ok(match self {
            Self::Shared(grounder) => Arc::clone(grounder),
            Self::Fused { panoptic, given } => {
                let given =
                    (!given.is_empty()).then(|| truth_of(scene, place, queries, given)).transpose()?;
                Arc::new(Fused::new(Arc::clone(panoptic), &scene.clips, &scene.rendered(rasterizer), given)?)
            }
            Self::Vlm(vlm) => Arc::clone(vlm) as _,
            Self::Files(root) => Arc::new(Files::open(root, scene.name.clone())?),
            Self::Oracle(noise) => {
                let Plan { size, camera_size, .. } = scene.plan;
                let ids = open_ids(place.clone(), scene.profile, size, camera_size)?;
                let instances = ids.instances();
                let target = |query: &Query| {
                    let target = Target::of(instances, query).map_err(|error| {
                        StageError::of(&error, "correct the query: `l4d check-queries` says more")
                    })?;
                    Ok((query.id.number.clone(), target))
                };
                let targets = queries.iter().map(target).collect::<Result<BTreeMap<_, _>, StageError>>()?;
                Arc::new(Oracle::new(scene.name.clone(), Arc::clone(&ids), targets, noise.clone()))
            }
        })
    }

    /// The one that asks a model server, if there is one.
    pub fn vlm(&self) -> Option<&Vlm> {
        match self {
            Self::Vlm(vlm) => Some(vlm),
            Self::Shared(_) | Self::Fused { .. } | Self::Oracle(_) | Self::Files(_) => None,
        }
    }

    /// Model servers that are asked.
    pub fn endpoints(&self) -> Vec<String> {
        self.vlm().map(|vlm| vlm.endpoint().base_url.to_string()).into_iter().collect()
    }

    /// Whether the truth of training views is looked at.
    pub fn sees_truth(&self) -> bool {
        match self {
            Self::Oracle(_) => true,
            Self::Fused { given, .. } => !given.is_empty(),
            Self::Shared(_) | Self::Vlm(_) | Self::Files(_) => false,
        }
    }

    /// Whether it knows queries by their numbers, and so has nothing to say to any other sentence.
    pub fn knows_queries_alone(&self) -> bool {
        matches!(self, Self::Oracle(_) | Self::Files(_))
    }
}

/// The truth, for the parts of a grounder that take it.
fn truth_of(
    scene: &SolveScene,
    place: &SceneDir,
    queries: &[Query],
    parts: &BTreeSet<Part>,
) -> Result<Given, StageError> {
    let Plan { size, camera_size, .. } = scene.plan;
    let ids = open_ids(place.clone(), scene.profile, size, camera_size)?;
    let tracks = Tracks::read(&place.tracks())?;
    Given::new(parts.clone(), tracks, ids, queries).map_err(|error| {
        StageError::new(error.to_string(), "correct the queries: `l4d check-queries` says more")
    })
}
