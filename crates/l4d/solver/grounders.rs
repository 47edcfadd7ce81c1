//! From `--grounder` to something that can be asked about a scene.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context as _, Result};
use l4d_data::Query;
use l4d_data::layout::SceneDir;
use l4d_data::workspace::SharedWork;
use l4d_ground::Grounder;
use l4d_ground::files::Files;
use l4d_ground::geometric::Geometric;
use l4d_ground::oracle::{NoisePreset, Oracle, Target, TrainingIds};
use l4d_ground::vlm::Vlm;
use l4d_solve::clips::Plan;
use l4d_solve::scene::SolveScene;

use super::model;
use crate::cli::solver::{GrounderArg, MethodArgs};
use crate::out::{Printer, refusal};

/// What finds things, before it is known where.
pub(crate) enum Grounders {
    /// One for all scenes.
    Shared(Arc<dyn Grounder + Send + Sync>),
    /// One for all scenes, which asks a model server.
    Vlm(Arc<Vlm>),
    /// The truth of a scene, with these errors.
    Oracle(NoisePreset),
    /// Masks in this folder.
    Files(PathBuf),
}

impl Grounders {
    /// `work` is the folder for what can be remade.
    pub(crate) fn open(args: &MethodArgs, work: &SharedWork, out: &Printer) -> Result<Self> {
        let strays = [
            ("--noise", args.noise.is_some(), GrounderArg::Oracle),
            ("--masks", args.masks.is_some(), GrounderArg::Files),
            ("--grounder-file", args.grounder_file.is_some(), GrounderArg::Model),
        ];
        for (flag, is_given, grounder) in strays {
            if is_given && args.grounder != grounder {
                return Err(refusal(
                    format!("{flag} says nothing to grounder {}", args.grounder.as_str()),
                    format!("add --grounder {}, or leave it out", grounder.as_str()),
                ));
            }
        }
        let lacking =
            |flag: &str| refusal(format!("grounder {} needs {flag}", args.grounder.as_str()), "add it");
        Ok(match args.grounder {
            GrounderArg::Geometric => Self::Shared(Arc::new(Geometric::default())),
            GrounderArg::Oracle => {
                let noise = args.noise.as_deref().map(NoisePreset::read).transpose()?;
                Self::Oracle(noise.unwrap_or_else(NoisePreset::none))
            }
            GrounderArg::Files => Self::Files(args.masks.clone().ok_or_else(|| lacking("--masks"))?),
            GrounderArg::Model => {
                let path = args.grounder_file.as_deref().ok_or_else(|| lacking("--grounder-file"))?;
                match model::open(path, &args.server, work, out)? {
                    model::Opened::Vlm(vlm) => Self::Vlm(vlm),
                    model::Opened::Text(segmenter) => Self::Shared(segmenter),
                }
            }
        })
    }

    /// The one that is the same for all scenes, if it is.
    pub(crate) fn of_any_scene(&self) -> Option<&dyn Grounder> {
        match self {
            Self::Shared(grounder) => Some(grounder.as_ref()),
            Self::Vlm(vlm) => Some(vlm.as_ref()),
            Self::Oracle(_) | Self::Files(_) => None,
        }
    }

    /// Whether it knows queries by their numbers, and so has nothing to say to any other sentence.
    pub(crate) fn answer_known_queries_alone(&self) -> bool {
        matches!(self, Self::Oracle(_) | Self::Files(_))
    }

    /// The one for a scene. Queries are what the oracle knows the meaning of; the others don't look at them.
    pub(crate) fn of_scene(
        &self,
        scene: &SolveScene,
        place: &SceneDir,
        queries: &[Query],
    ) -> Result<Arc<dyn Grounder + Send + Sync>> {
        let name = scene.name.clone();
        Ok(match self {
            Self::Shared(grounder) => Arc::clone(grounder),
            Self::Vlm(vlm) => Arc::clone(vlm) as _,
            Self::Files(root) => Arc::new(Files::open(root, name)?),
            Self::Oracle(noise) => {
                let Plan { size, camera_size, .. } = scene.plan;
                let ids = TrainingIds::open(place.clone(), scene.profile, size, camera_size)?;
                let instances = ids.instances();
                let target = |query: &Query| Ok((query.id.number.clone(), Target::of(instances, query)?));
                let targets = queries.iter().map(target).collect::<Result<BTreeMap<_, _>>>()?;
                Arc::new(Oracle::new(name, ids, targets, noise.clone()).context("--noise")?)
            }
        })
    }

    /// The one that asks a model server, if it is such a one.
    pub(crate) fn vlm(&self) -> Option<&Vlm> {
        match self {
            Self::Vlm(vlm) => Some(vlm),
            Self::Shared(_) | Self::Oracle(_) | Self::Files(_) => None,
        }
    }

    /// Model servers that are asked.
    pub(crate) fn endpoints(&self) -> Vec<String> {
        self.vlm().map(|vlm| vlm.endpoint().base_url.as_str().to_owned()).into_iter().collect()
    }
}
