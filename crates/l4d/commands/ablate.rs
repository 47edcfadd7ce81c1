//! `l4d ablate`: the grids of the paper's ablations, each row answered by `solve` and judged by `score`, beside the
//! numbers that the paper prints.
//!
//! Everything of a grid stands in a folder of its own. What the truth was used for is marked wherever it is shown.

mod calibrate;
mod gain;
mod grid;
mod markdown;
mod measure;
mod table;
mod trend;

use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_board::publish_trend;
use l4d_data::published::Published;
use l4d_data::store::write_atomic;
use l4d_data::{Benchmark, Report};
use l4d_ground::oracle::NoisePreset;
use l4d_score::Exam;
use l4d_solve::consensus::Preset;
use serde_json::json;

use self::calibrate::{noises_as_given, noises_as_in_paper};
use self::gain::{Gain, gains, losing_scenes};
use self::grid::{Noise, correlations, grid};
use self::markdown::Page;
use self::measure::{Measured, measure};
use self::table::{Cell, cells, columns, csv_of};
use self::trend::trend_of_views;
use crate::cli::solver::{AblateArgs, GridArg, GrounderArg};
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &AblateArgs, out: &Printer) -> Result<ExitStatus> {
    if args.method.noise.is_some() && args.method.grounder != GrounderArg::Oracle {
        return Err(refusal("--noise belongs to the oracle", "add --grounder oracle, or leave it out"));
    }
    let table = args.grid.table();
    let bench = Benchmark::open(&args.bench.bench)?;
    let printed = bench.dir.published(table);
    // Sets of the user's own come without the paper's numbers.
    let published = printed.exists().then(|| Published::read(&printed)).transpose()?;
    let published = published.as_ref();
    let mut report = Report::default();
    let exam = Exam::open(bench, args.bench.profile, args.grid.set(), &args.bench.scenes, &mut report)?;
    for finding in report.into_sorted() {
        out.warn(format!("{} {}", finding.path, finding.message));
    }
    let profile = args.bench.profile.as_str();
    let default = || args.work.work.join(profile).join("ablations").join(table);
    let folder = args.out.clone().unwrap_or_else(default);

    let noises = noises(args, &exam, published, &folder, out)?;
    let grid = grid(args, &exam, &noises)?;
    grid.left_out.iter().for_each(|missing| out.note(format!("left out: {missing}")));
    let rows: Vec<Measured> = grid
        .variants
        .iter()
        .map(|variant| measure(variant, args, &exam, &folder, out))
        .collect::<Result<_>>()?;

    let columns = columns(published, &rows);
    let cells = cells(args.grid, &rows, &columns, published, args.seed);
    let gains = gains(&grid.pairs, &rows, &columns, published, args.seed);
    let differences: Vec<Cell> = gains.iter().map(Gain::cell).collect();
    let about = about(args, &exam, &noises);
    let page = Page {
        title: args.grid.title(),
        about: &about,
        columns: &columns,
        cells: &cells,
        gains: &gains,
        losing_scenes: &losing_scenes(&grid.pairs, &rows),
        left_out: &grid.left_out,
    };
    let text = page.text();
    let all: Vec<&Cell> = cells.iter().chain(&differences).collect();
    let files = [
        (folder.join(format!("{table}.csv")), csv_of(all.iter().copied())?),
        (folder.join(format!("{table}.md")), text.clone().into_bytes()),
    ];
    for (path, bytes) in &files {
        write_atomic(path, bytes)?;
    }
    let mut paths: Vec<PathBuf> = files.into_iter().map(|(path, _)| path).collect();
    let trend = (args.grid == GridArg::Views).then(|| trend_of_views(&columns, &cells, &about)).flatten();
    if let Some(trend) = trend {
        paths.extend(publish_trend(&trend, &folder)?);
    }
    if args.json {
        out.json(&json!({ "grid": table, "about": about, "left_out": grid.left_out, "rows": all }))?;
    } else {
        out.data(text)?;
    }
    paths.iter().for_each(|path| out.note(path.display()));
    Ok(ExitStatus::Success)
}

/// What errs how in the rows of the oracle.
fn noises(
    args: &AblateArgs,
    exam: &Exam,
    published: Option<&Published>,
    folder: &Path,
    out: &Printer,
) -> Result<Vec<Noise>> {
    let correlations = correlations(args)?;
    if correlations.is_empty() {
        return Ok(Vec::new());
    }
    let given = args.method.noise.as_deref().map(NoisePreset::read).transpose()?;
    if given.is_none() && !args.calibrate {
        return Err(refusal(
            "an oracle without errors has nothing to agree on",
            "say how it errs with --noise, or let --calibrate find out",
        ));
    }
    let preset = given.unwrap_or_else(NoisePreset::none);
    if !args.calibrate {
        return noises_as_given(&preset, &correlations, folder);
    }
    let published = published.ok_or_else(|| {
        let path = exam.bench.dir.published(args.grid.table());
        refusal(
            format!("{}: there are no numbers to come close to", path.display()),
            "copy the file from the release",
        )
    })?;
    noises_as_in_paper(args, &preset, &correlations, exam, published, folder, out)
}

/// What was run, a sentence each.
fn about(args: &AblateArgs, exam: &Exam, noises: &[Noise]) -> Vec<String> {
    let queries: usize = exam.scenes.iter().map(|scene| scene.queries.len()).sum();
    let mut about = vec![format!(
        "{} {}, profile {}, set {}; scenes: {}, queries: {queries}.",
        exam.bench.manifest.name,
        exam.bench.manifest.version,
        exam.profile,
        exam.set.as_str(),
        exam.scenes.len()
    )];
    let method = &args.method;
    let preset = Preset::from(method.preset).word();
    about.push(format!(
        "PanopticQuery {}, preset {preset}, grounder {}, up to {} views where the grid does not say otherwise.",
        env!("CARGO_PKG_VERSION"),
        method.grounder.as_str(),
        method.views
    ));
    if args.calibrate {
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
