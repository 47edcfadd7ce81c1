//! The grids: which runs of the solver a table of the paper needs.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::Result;
use l4d_data::layout::SceneDir;
use l4d_data::{Name, Rig, Workspace};
use l4d_ground::oracle::CORRELATIONS;
use l4d_score::{Exam, QuerySet};
use l4d_solve::consensus::settings::Undecided;
use l4d_solve::scene::how_scenes_are_made;

use crate::cli::solver::{AblateArgs, GridArg, GrounderArg, MethodArgs, QuerySetArg};
use crate::out::refusal;
use crate::solver;

/// The rows of the ablation of consensus, as the paper calls them.
pub(super) const WITHOUT: &str = "w/o MVSC";
pub(super) const WITH: &str = "with MVSC";
/// Consensus that gives no answer where its votes decide nothing.
pub(super) const ABSTAINING: &str = "with MVSC, abstaining";

/// One run of the solver.
#[derive(Debug)]
pub(super) struct Variant {
    /// Of the method and its folders.
    pub(super) name: Name,
    /// The row.
    pub(super) setting: String,
    pub(super) method: MethodArgs,
}

/// Runs that differ in consensus alone: indices of variants.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub(super) without: usize,
    pub(super) with: usize,
    /// The row with consensus, as the table calls it.
    pub(super) row: &'static str,
    /// Of the errors of the views, where they are made up.
    pub(super) correlation: Option<f64>,
}

/// What is run.
#[derive(Debug, Default)]
pub(super) struct Grid {
    pub(super) variants: Vec<Variant>,
    pub(super) pairs: Vec<Pair>,
    /// What the paper has and this does not, with the reason.
    pub(super) left_out: Vec<String>,
}

/// A made-up correlation, and where the noise with it stands.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    pub(super) correlation: f64,
    pub(super) path: PathBuf,
}

impl GridArg {
    /// File of numbers of the paper, and stem of ours.
    pub(super) fn table(self) -> &'static str {
        match self {
            Self::Mvsc => "mvsc",
            Self::Views => "views",
            Self::Vlm => "vlm",
            Self::Composites => "composites",
            Self::Scales => "scales",
        }
    }

    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Mvsc => "Multi-view semantic consensus",
            Self::Views => "Number of views",
            Self::Vlm => "Vision-language models",
            Self::Composites => "Queries of two categories",
            Self::Scales => "Spatial scales",
        }
    }

    pub(super) fn set(self) -> QuerySet {
        if self == Self::Composites { QuerySet::Composites } else { QuerySet::Queries }
    }

    pub(super) fn asked(self) -> QuerySetArg {
        if self == Self::Composites { QuerySetArg::Composites } else { QuerySetArg::Queries }
    }
}

/// Correlations of the errors of views that a grid goes through; none where no errors are made up.
pub(super) fn correlations(args: &AblateArgs) -> Result<Vec<f64>> {
    let has_any = args.grid == GridArg::Mvsc && args.method.grounder == GrounderArg::Oracle;
    if !has_any {
        return match (args.correlations.is_empty(), args.calibrate) {
            (true, false) => Ok(Vec::new()),
            (_, is_calibrated) => Err(refusal(
                format!(
                    "--{} makes up errors of views",
                    if is_calibrated { "calibrate" } else { "correlations" }
                ),
                "use it with the grid mvsc and --grounder oracle, or leave it out",
            )),
        };
    }
    if let Some(rho) = args.correlations.iter().find(|rho| !(0.0..=1.0).contains(*rho)) {
        return Err(refusal(
            format!("{rho} is no correlation"),
            "give numbers from 0 to 1, for example 0,0.3,0.6,0.9",
        ));
    }
    let mut wanted = args.correlations.clone();
    if wanted.is_empty() {
        wanted = CORRELATIONS.to_vec();
    }
    wanted.sort_by(f64::total_cmp);
    wanted.dedup();
    Ok(wanted)
}

/// The runs of a grid. `noises` are those of the oracle, one a correlation.
pub(super) fn grid(args: &AblateArgs, exam: &Exam, noises: &[Noise]) -> Result<Grid> {
    if !args.grounder_files.is_empty() && args.grid != GridArg::Vlm {
        return Err(refusal(
            "--grounder-files are rows of the grid vlm",
            "name that grid, or use --grounder-file",
        ));
    }
    match args.grid {
        GridArg::Mvsc => mvsc(args, noises),
        GridArg::Views => views(args, exam),
        GridArg::Vlm => models(args),
        GridArg::Composites | GridArg::Scales => {
            let variant = variant("solver", "PanopticQuery", args.method.clone())?;
            Ok(Grid { variants: vec![variant], ..Grid::default() })
        }
    }
}

fn variant(name: &str, setting: &str, method: MethodArgs) -> Result<Variant> {
    Ok(Variant { name: Name::new(name)?, setting: setting.to_owned(), method })
}

fn mvsc(args: &AblateArgs, noises: &[Noise]) -> Result<Grid> {
    if args.method.no_consensus {
        return Err(refusal("--no-consensus is one of the rows of the grid mvsc", "leave it out"));
    }
    let has_fallback = solver::settings(&args.method).consensus.undecided == Undecided::AllCandidates;
    let mut grid = Grid::default();
    let mut pair = |correlation: Option<f64>, noise: Option<PathBuf>| -> Result<()> {
        let suffix = correlation.map(|rho| format!("-rho-{rho}")).unwrap_or_default();
        let row = correlation.map(|rho| format!(", rho {rho}")).unwrap_or_default();
        let with = MethodArgs { noise, ..args.method.clone() };
        let without = MethodArgs { no_consensus: true, ..with.clone() };
        let first = grid.variants.len();
        grid.variants.push(variant(&format!("without-mvsc{suffix}"), &format!("{WITHOUT}{row}"), without)?);
        grid.variants.push(variant(&format!("with-mvsc{suffix}"), &format!("{WITH}{row}"), with.clone())?);
        grid.pairs.push(Pair { without: first, with: first + 1, row: WITH, correlation });
        if has_fallback {
            let abstaining = MethodArgs { abstain: true, ..with };
            let name = format!("with-mvsc-abstaining{suffix}");
            grid.variants.push(variant(&name, &format!("{ABSTAINING}{row}"), abstaining)?);
            grid.pairs.push(Pair { without: first, with: first + 2, row: ABSTAINING, correlation });
        }
        Ok(())
    };
    if noises.is_empty() {
        pair(None, args.method.noise.clone())?;
    }
    for Noise { correlation, path } in noises {
        pair(Some(*correlation), Some(path.clone()))?;
    }
    Ok(grid)
}

fn views(args: &AblateArgs, exam: &Exam) -> Result<Grid> {
    let (available, scene) = fewest_views(args, exam)?;
    let wanted: BTreeSet<u32> = args.view_counts.iter().copied().collect();
    let (possible, others): (Vec<u32>, Vec<u32>) =
        wanted.into_iter().partition(|&views| views as usize <= available);
    if possible.is_empty() {
        return Err(refusal(
            format!("{scene} has {available} training views, fewer than any of --view-counts"),
            "ask for fewer views, or choose a larger --profile",
        ));
    }
    let row = |views: u32| {
        variant(&format!("views-{views}"), &views.to_string(), MethodArgs { views, ..args.method.clone() })
    };
    let left_out = others.iter().map(|views| {
        format!("{views} views: profile {} has {available} training views (in {scene})", exam.profile)
    });
    Ok(Grid {
        left_out: left_out.collect(),
        variants: possible.into_iter().map(row).collect::<Result<_>>()?,
        pairs: Vec::new(),
    })
}

/// Training views of the scene that has fewest.
fn fewest_views(args: &AblateArgs, exam: &Exam) -> Result<(usize, Name)> {
    let data = Workspace::new(exam.profile, exam.bench.manifest.draw())
        .with_data(args.work.data.as_deref())
        .data()
        .to_owned();
    let mut fewest: Option<(usize, Name)> = None;
    for scene in &exam.scenes {
        let path = SceneDir::new(&data, &scene.name).rig(exam.profile);
        if !path.exists() {
            return Err(refusal(
                format!("{}: no scene stands there", path.display()),
                format!("{}, or choose another --data", how_scenes_are_made(&scene.name, exam.profile)),
            ));
        }
        let count = Rig::read(&path)?.training().len();
        if fewest.as_ref().is_none_or(|(least, _)| count < *least) {
            fewest = Some((count, scene.name.clone()));
        }
    }
    fewest.ok_or_else(|| refusal("there is no scene", "choose other --scenes"))
}

fn models(args: &AblateArgs) -> Result<Grid> {
    if args.grounder_files.is_empty() {
        return Err(refusal(
            "the grid vlm has a row for each of --grounder-files, and there are none",
            "name files as for --grounder-file, comma-separated (docs/panopticquery.md)",
        ));
    }
    let mut variants: Vec<Variant> = Vec::new();
    for path in &args.grounder_files {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let method = MethodArgs {
            grounder: GrounderArg::Model,
            grounder_file: Some(path.clone()),
            ..args.method.clone()
        };
        let variant = variant(&stem, &stem, method)?;
        if variants.iter().any(|other| other.name == variant.name) {
            return Err(refusal(
                format!("two of --grounder-files are called `{stem}`"),
                "rename one: rows are called as files",
            ));
        }
        variants.push(variant);
    }
    Ok(Grid { variants, ..Grid::default() })
}
