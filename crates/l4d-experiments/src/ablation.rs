//! The grids of the paper's ablations: each row answered by the solver and judged, beside the numbers that the paper
//! prints. Everything of a grid is in a folder of its own; what the truth was used for is marked wherever it is shown.

mod calibrate;
mod gain;
mod grid;
mod markdown;
mod measure;
mod table;

use std::path::{Path, PathBuf};

use l4d_data::published::Published;
use l4d_data::store::write_atomic;
use l4d_data::{Progress, StageError, Workspace};
use l4d_ground::oracle::NoisePreset;
use l4d_score::EvalSet;
use l4d_solve::grounders::Grounders;
use l4d_solve::method::MethodChoice;
use l4d_splat::raster::Rasterizer;
use serde_json::Value;

use self::calibrate::{noises_as_given, noises_as_in_paper};
use self::gain::{Gain, gains};
pub use self::grid::Grid;
use self::grid::{correlations, runs};
use self::markdown::Page;
use self::measure::{Measured, measure};
pub use self::table::{Cell, Column, Metric, Source};
use self::table::{cells, columns};
use crate::Result;
use crate::csv_file::csv_of;

/// What is measured, and with what.
pub struct Ablation<'a> {
    /// Which table of the paper.
    pub grid: Grid,
    /// Scenes, queries and truth; its set is [`Grid::set`].
    pub eval_set: &'a EvalSet,
    /// Profile and folders.
    pub space: &'a Workspace,
    /// Receives tables, results, scores and answers.
    pub folder: &'a Path,
    /// Word of the grounder, for messages.
    pub grounder: &'a str,
    /// The errors of the oracle, if it is the grounder: inner none for no errors.
    pub oracle: Option<Option<NoisePreset>>,
    /// Opens the grounder, or that of a file of the grid `vlm`.
    pub open_grounders: &'a dyn Fn(Option<&Path>) -> Result<Grounders>,
    /// The rest of the method.
    pub method: MethodChoice,
    /// Correlations between the errors of views; empty for the usual ones.
    pub correlations: Vec<f64>,
    /// Search the share of swapped views at which the row without consensus has the paper's mIoU.
    pub calibrate: bool,
    /// Numbers of views of the grid `views`.
    pub view_counts: Vec<u32>,
    /// Rows of the grid `vlm`.
    pub grounder_files: Vec<PathBuf>,
    /// Of the intervals.
    pub seed: u64,
    /// Queries at once.
    pub jobs: usize,
    /// Answer again what was answered with other settings.
    pub overwrite: bool,
    pub rasterizer: &'a dyn Rasterizer,
    /// What it draws on, for manifests; none for the processor.
    pub adapter: Option<Value>,
}

/// A finished table.
#[derive(Debug)]
pub struct Ablated {
    /// What was run: a sentence each.
    pub about: Vec<String>,
    /// What the paper has and this does not, with the reason.
    pub left_out: Vec<String>,
    /// Kinds of queries, in the order of the table.
    pub columns: Vec<Column>,
    /// Measured rows, then published ones.
    pub cells: Vec<Cell>,
    /// Differences between rows with and without consensus.
    pub differences: Vec<Cell>,
    /// The table and its notes, as Markdown.
    pub text: String,
    /// Files that were written.
    pub paths: Vec<PathBuf>,
}

/// Runs a grid: answers what is not answered yet, scores it, and writes `<table>.csv` and `<table>.md`.
///
/// # Errors
/// Settings that say nothing to the grid, and whatever answering and judging meet.
pub fn ablate(order: &Ablation<'_>, progress: &dyn Progress) -> Result<Ablated> {
    let table = order.grid.table();
    let printed = order.eval_set.bench.dir.published(table);
    // Sets of the user's own come without the paper's numbers.
    let published = printed.exists().then(|| Published::read(&printed)).transpose()?;
    let published = published.as_ref();
    let noises = noises(order, published, progress)?;
    let runs = runs(order, &noises)?;
    runs.left_out.iter().for_each(|missing| progress.note(&format_args!("left out: {missing}")));
    let rows: Vec<Measured> =
        runs.variants.iter().map(|variant| measure(variant, order, progress)).collect::<Result<_>>()?;

    let columns = columns(published, &rows);
    let cells = cells(order.grid, &rows, &columns, published, order.seed);
    let gains = gains(&runs.pairs, &rows, &columns, published, order.seed);
    let differences: Vec<Cell> = gains.iter().flat_map(Gain::cells).collect();
    let about = about(order, &noises);
    let page = Page {
        title: order.grid.title(),
        about: &about,
        columns: &columns,
        cells: &cells,
        gains: &gains,
        left_out: &runs.left_out,
    };
    let text = page.text();
    let files = [
        (order.folder.join(format!("{table}.csv")), csv_of(cells.iter().chain(&differences))?),
        (order.folder.join(format!("{table}.md")), text.clone().into_bytes()),
    ];
    files.iter().try_for_each(|(path, bytes)| write_atomic(path, bytes))?;
    let paths = files.into_iter().map(|(path, _)| path).collect();
    Ok(Ablated { about, left_out: runs.left_out, columns, cells, differences, text, paths })
}

/// What errs how in the rows of the oracle, for each correlation.
fn noises(
    order: &Ablation<'_>,
    published: Option<&Published>,
    progress: &dyn Progress,
) -> Result<Vec<NoisePreset>> {
    let correlations = correlations(order)?;
    if correlations.is_empty() {
        return Ok(Vec::new());
    }
    let given = order.oracle.clone().flatten();
    if !order.calibrate {
        let preset = given.ok_or_else(|| {
            StageError::new(
                "an oracle without errors has nothing to agree on",
                "say how it errs with --noise, or let --calibrate find out",
            )
        })?;
        return noises_as_given(&preset, &correlations, order.folder);
    }
    let published = published.ok_or_else(|| {
        let path = order.eval_set.bench.dir.published(order.grid.table());
        StageError::new(
            format!("{}: there are no numbers to come close to", path.display()),
            "copy the file from the release",
        )
    })?;
    noises_as_in_paper(order, &given.unwrap_or_else(NoisePreset::none), &correlations, published, progress)
}

/// What was run, a sentence each.
fn about(order: &Ablation<'_>, noises: &[NoisePreset]) -> Vec<String> {
    let eval_set = order.eval_set;
    let queries: usize = eval_set.scenes.iter().map(|scene| scene.queries.len()).sum();
    let mut about = vec![format!(
        "{} {}, profile {}, set {}; scenes: {}, queries: {queries}.",
        eval_set.bench.manifest.name,
        eval_set.bench.manifest.version,
        eval_set.profile,
        eval_set.set.as_str(),
        eval_set.scenes.len()
    )];
    about.push(format!(
        "PanopticQuery {}, preset {}, grounder {}, up to {} views where the grid does not say otherwise.",
        env!("CARGO_PKG_VERSION"),
        order.method.preset.word(),
        order.grounder,
        order.method.views
    ));
    if order.calibrate {
        about.push(
            "The share of swapped views was searched, for each rho and category, so that the row without consensus comes as \
             close to the paper's mIoU as it can (`noise/`, `calibration.csv`); the other rows follow."
                .to_owned(),
        );
    } else if !noises.is_empty() {
        about
            .push("The errors of the views were given, but for their correlation rho (`noise/`).".to_owned());
    }
    about
}
