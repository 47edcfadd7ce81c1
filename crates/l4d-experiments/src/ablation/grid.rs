//! The grids: which runs of the solver a table of the paper needs.

use std::collections::BTreeSet;
use std::path::PathBuf;

use l4d_data::workspace::how_scenes_are_made;
use l4d_data::{Name, Rig, StageError};
use l4d_ground::oracle::{CORRELATIONS, NoisePreset};
use l4d_score::QuerySet;
use l4d_solve::consensus::settings::Undecided;
use l4d_solve::method::MethodChoice;
use serde::Deserialize;

use super::Ablation;
use crate::{Result, plain};

/// A table of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Grid {
    /// With and without consensus; with the oracle once for each correlation of its errors.
    Mvsc,
    /// Numbers of views, as far as there are so many training views.
    Views,
    /// Models and couplings, one row per file of a grounder.
    Vlm,
    /// Queries of two categories.
    Composites,
    /// Outdoor, room, tabletop.
    Scales,
}

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
    pub(super) method: MethodChoice,
    /// Errors of the oracle, where they are made up.
    pub(super) noise: Option<NoisePreset>,
    /// Which grounder, if not that of the other rows.
    pub(super) grounder_file: Option<PathBuf>,
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
pub(super) struct Runs {
    pub(super) variants: Vec<Variant>,
    pub(super) pairs: Vec<Pair>,
    /// What the paper has and this does not, with the reason.
    pub(super) left_out: Vec<String>,
}

impl Grid {
    /// File of numbers of the paper, and stem of ours.
    pub fn table(self) -> &'static str {
        match self {
            Self::Mvsc => "mvsc",
            Self::Views => "views",
            Self::Vlm => "vlm",
            Self::Composites => "composites",
            Self::Scales => "scales",
        }
    }

    /// Heading of the page.
    pub fn title(self) -> &'static str {
        match self {
            Self::Mvsc => "Multi-view semantic consensus",
            Self::Views => "Number of views",
            Self::Vlm => "Vision-language models",
            Self::Composites => "Queries of two categories",
            Self::Scales => "Spatial scales",
        }
    }

    /// Which sentences are asked.
    pub fn set(self) -> QuerySet {
        if self == Self::Composites { QuerySet::Composites } else { QuerySet::Queries }
    }
}

/// Correlations of the errors of views that a grid goes through; none where no errors are made up.
pub(super) fn correlations(order: &Ablation<'_>) -> Result<Vec<f64>> {
    let has_any = order.grid == Grid::Mvsc && order.oracle.is_some();
    if !has_any {
        return match (order.correlations.is_empty(), order.calibrate) {
            (true, false) => Ok(Vec::new()),
            (_, is_calibrated) => Err(StageError::new(
                format!(
                    "--{} makes up errors of views",
                    if is_calibrated { "calibrate" } else { "correlations" }
                ),
                "use it with the grid mvsc and --grounder oracle, or leave it out",
            )),
        };
    }
    let mut wanted = order.correlations.clone();
    if wanted.is_empty() {
        wanted = CORRELATIONS.to_vec();
    }
    wanted.sort_by(f64::total_cmp);
    wanted.dedup();
    Ok(wanted)
}

/// The runs of a grid. `noises` are those of the oracle, one per correlation.
pub(super) fn runs(order: &Ablation<'_>, noises: &[NoisePreset]) -> Result<Runs> {
    if !order.grounder_files.is_empty() && order.grid != Grid::Vlm {
        return Err(StageError::new(
            "--grounder-files are rows of the grid vlm",
            "name that grid, or use --grounder-file",
        ));
    }
    match order.grid {
        Grid::Mvsc => mvsc(order, noises),
        Grid::Views => views(order),
        Grid::Vlm => models(order),
        Grid::Composites | Grid::Scales => {
            let variant = variant("solver", "PanopticQuery", order.method.clone())?;
            Ok(Runs { variants: vec![variant], ..Runs::default() })
        }
    }
}

fn variant(name: &str, setting: &str, method: MethodChoice) -> Result<Variant> {
    let name = Name::new(name).map_err(plain)?;
    Ok(Variant { name, setting: setting.to_owned(), method, noise: None, grounder_file: None })
}

fn mvsc(order: &Ablation<'_>, noises: &[NoisePreset]) -> Result<Runs> {
    if !order.method.consensus {
        return Err(StageError::new("--no-consensus is one of the rows of the grid mvsc", "leave it out"));
    }
    let with = &order.method;
    let mut rows = vec![
        ("without-mvsc", WITHOUT, MethodChoice { consensus: false, ..with.clone() }),
        ("with-mvsc", WITH, with.clone()),
    ];
    if with.solve_settings().consensus.undecided == Undecided::AllCandidates {
        let abstaining = MethodChoice { abstain: true, ..with.clone() };
        rows.push(("with-mvsc-abstaining", ABSTAINING, abstaining));
    }
    // Once where no errors are made up.
    let noises = if noises.is_empty() { vec![None] } else { noises.iter().map(Some).collect() };
    let mut runs = Runs::default();
    for noise in noises {
        let correlation = noise.map(|noise| noise.noise.swap.correlation);
        let without = runs.variants.len();
        for (place, (name, row, method)) in rows.iter().enumerate() {
            let (name, setting) = match correlation {
                Some(rho) => (format!("{name}-rho-{rho}"), format!("{row}, rho {rho}")),
                None => ((*name).to_owned(), (*row).to_owned()),
            };
            let variant = variant(&name, &setting, method.clone())?;
            runs.variants.push(Variant { noise: noise.cloned(), ..variant });
            if place > 0 {
                runs.pairs.push(Pair { without, with: without + place, row, correlation });
            }
        }
    }
    Ok(runs)
}

fn views(order: &Ablation<'_>) -> Result<Runs> {
    let (available, scene) = fewest_views(order)?;
    let wanted: BTreeSet<u32> = order.view_counts.iter().copied().collect();
    let (possible, others): (Vec<u32>, Vec<u32>) =
        wanted.into_iter().partition(|&views| views as usize <= available);
    if possible.is_empty() {
        return Err(StageError::new(
            format!("{scene} has {available} training views, fewer than any of --view-counts"),
            "ask for fewer views, or choose a larger --profile",
        ));
    }
    let row = |views: u32| {
        let method = MethodChoice { views: views as usize, ..order.method.clone() };
        variant(&format!("views-{views}"), &views.to_string(), method)
    };
    let left_out = others.iter().map(|views| {
        let profile = order.eval_set.profile;
        format!("{views} views: profile {profile} has {available} training views (in {scene})")
    });
    Ok(Runs {
        left_out: left_out.collect(),
        variants: possible.into_iter().map(row).collect::<Result<_>>()?,
        pairs: Vec::new(),
    })
}

/// Training views of the scene that has fewest.
fn fewest_views(order: &Ablation<'_>) -> Result<(usize, Name)> {
    let eval_set = order.eval_set;
    let mut fewest: Option<(usize, Name)> = None;
    for scene in &eval_set.scenes {
        let path = order.space.scene(&scene.name).rig(eval_set.profile);
        if !path.exists() {
            return Err(StageError::new(
                format!("{}: there is no scene", path.display()),
                format!(
                    "{}, or choose another --data",
                    how_scenes_are_made(&scene.name, eval_set.profile, order.space.scene(&scene.name).root())
                ),
            ));
        }
        let count = Rig::read(&path)?.training().len();
        if fewest.as_ref().is_none_or(|(least, _)| count < *least) {
            fewest = Some((count, scene.name.clone()));
        }
    }
    fewest.ok_or_else(|| StageError::new("there is no scene", "choose other --scenes"))
}

fn models(order: &Ablation<'_>) -> Result<Runs> {
    if order.grounder_files.is_empty() {
        return Err(StageError::new(
            "the grid vlm has a row for each of --grounder-files, and there are none",
            "name files as for --grounder-file, comma-separated (docs/panopticquery.md)",
        ));
    }
    let mut variants: Vec<Variant> = Vec::new();
    for path in &order.grounder_files {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let variant =
            Variant { grounder_file: Some(path.clone()), ..variant(&stem, &stem, order.method.clone())? };
        if variants.iter().any(|other| other.name == variant.name) {
            return Err(StageError::new(
                format!("two of --grounder-files are called `{stem}`"),
                "rename one: rows are called as files",
            ));
        }
        variants.push(variant);
    }
    Ok(Runs { variants, ..Runs::default() })
}
