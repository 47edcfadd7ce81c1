//! What the flags of a solver mean: grounders, and the rest of a method.

mod model;

use std::sync::Arc;

use anyhow::Result;
use l4d_data::workspace::SharedWork;
use l4d_data::{Profile, Workspace};
use l4d_ground::oracle::NoisePreset;
use l4d_ground::panoptic::Panoptic;
use l4d_solve::grounders::Grounders;
use l4d_solve::method::MethodChoice;

use crate::cli::solver::{GrounderArg, MethodArgs, WorkArgs};
use crate::out::{Printer, refusal};

impl MethodArgs {
    /// Everything about the method but its grounder.
    pub(crate) fn choice(&self) -> MethodChoice {
        MethodChoice {
            preset: self.preset,
            views: self.view_count as usize,
            view_seed: self.view_seed,
            clip_size: self.clip_size.map(|size| size.0),
            clip_every: self.clip_every,
            consensus: !self.no_consensus,
            abstain: self.abstain,
            lift: self.lift,
        }
    }
}

impl WorkArgs {
    pub(crate) fn space(&self, profile: Profile) -> Workspace {
        Workspace::new(profile).with_data(self.data.as_deref()).with_work(&self.work)
    }
}

/// What `--grounder` names.
pub(crate) fn open_grounders(args: &MethodArgs, work: &SharedWork, out: &Printer) -> Result<Grounders> {
    if let Some(path) = &args.grounder_file {
        model::require_use_of(&args.server, path)?;
    }
    open_one_of(args, work, out)
}

/// The same where options of a model server may be for other grounders of the run.
pub(crate) fn open_one_of(args: &MethodArgs, work: &SharedWork, out: &Printer) -> Result<Grounders> {
    let panoptic = || args.weights.as_deref().map_or_else(Panoptic::shipped, Panoptic::open).map(Arc::new);
    let lacking = |flag: &str| refusal(format!("grounder {} needs {flag}", args.grounder.as_str()), "add it");
    Ok(match args.grounder {
        GrounderArg::Panoptic => Grounders::Shared(panoptic()?),
        GrounderArg::PanopticFused => {
            let given = args.given.iter().copied().collect();
            Grounders::Fused { panoptic: panoptic()?, given }
        }
        GrounderArg::Oracle => {
            let noise = args.noise.as_deref().map(NoisePreset::read).transpose()?;
            Grounders::Oracle(noise.unwrap_or_else(NoisePreset::none))
        }
        GrounderArg::Files => Grounders::Files(args.masks.clone().ok_or_else(|| lacking("--masks"))?),
        GrounderArg::Model => {
            let path = args.grounder_file.as_deref().ok_or_else(|| lacking("--grounder-file"))?;
            model::open(path, &args.server, work, out)?
        }
    })
}
