//! What the flags of a solver mean: settings, grounders, and the name that a method has by default.

mod grounders;
mod model;
mod segmenter;
mod stage;

use l4d_data::Interval;
use l4d_solve::consensus::Preset;
use l4d_solve::consensus::settings::Undecided;
use l4d_solve::lift::{ClosedSettings, DistilSettings, FieldSettings, LiftSettings};
use l4d_solve::scene::ClipSettings;
use l4d_solve::solve::SolveSettings;

pub(crate) use self::grounders::Grounders;
pub(crate) use self::stage::Stage;
use crate::cli::solver::{LiftArg, MethodArgs, PresetArg, QuerySetArg};
use crate::cli::splats::PixelSize;

/// Views that the presets look at (paper, section 5).
const USUAL_VIEWS: u32 = 8;

impl From<PresetArg> for Preset {
    fn from(preset: PresetArg) -> Self {
        match preset {
            PresetArg::Robust => Self::Robust,
            PresetArg::Paper => Self::Paper,
        }
    }
}

/// Consensus and lifting.
pub(crate) fn settings(args: &MethodArgs) -> SolveSettings {
    let preset = Preset::from(args.preset).solve_settings();
    let mut consensus = if args.no_consensus { Preset::Off.settings() } else { preset.consensus };
    if args.abstain {
        consensus.undecided = Undecided::Abstain;
    }
    SolveSettings { consensus, lift: args.lift.map_or(preset.lift, lift) }
}

fn lift(lift: LiftArg) -> LiftSettings {
    match lift {
        LiftArg::Closed => LiftSettings::Closed(ClosedSettings::robust()),
        LiftArg::Vote => LiftSettings::Closed(ClosedSettings::vote()),
        LiftArg::Sirt => LiftSettings::Closed(ClosedSettings::sirt()),
        LiftArg::Field => LiftSettings::Field(FieldSettings::paper()),
        LiftArg::Distil => LiftSettings::Distil(DistilSettings::usual()),
    }
}

/// Which clips are looked at.
pub(crate) fn clip_settings(args: &MethodArgs, range: Option<Interval>) -> ClipSettings {
    let usual = Preset::from(args.preset).clip_settings(args.views as usize, args.view_seed);
    ClipSettings { range, size: args.clip_size.map(|size| size.0), every: args.clip_every, ..usual }
}

/// `panopticquery-<grounder>`, what differs from the preset robust, and which sentences if not the queries: a folder
/// of results holds answers to one set.
pub(crate) fn default_name(args: &MethodArgs, set: QuerySetArg) -> String {
    let mut name = format!("panopticquery-{}", args.grounder.as_str());
    let mut add = |part: &str| {
        name.push('-');
        name.push_str(part);
    };
    if args.noise.is_some() {
        add("noise");
    }
    if args.preset == PresetArg::Paper {
        add("paper");
    }
    if args.views != USUAL_VIEWS {
        add(&format!("v{}", args.views));
    }
    if let Some(PixelSize([width, height])) = args.clip_size {
        add(&format!("{width}x{height}"));
    }
    if let Some(every) = args.clip_every {
        add(&format!("every-{every}"));
    }
    if args.no_consensus {
        add("no-mvsc");
    }
    if args.abstain {
        add("abstain");
    }
    match args.lift {
        Some(LiftArg::Closed) => add("closed"),
        Some(LiftArg::Vote) => add("vote"),
        Some(LiftArg::Sirt) => add("sirt"),
        Some(LiftArg::Field) => add("field"),
        Some(LiftArg::Distil) => add("distil"),
        None => {}
    }
    match set {
        QuerySetArg::Queries => {}
        QuerySetArg::Composites => add("composites"),
        QuerySetArg::Absents => add("absents"),
    }
    name
}
