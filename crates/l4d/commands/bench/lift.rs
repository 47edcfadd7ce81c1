//! `l4d bench lift`: what each lift and its settings make of the same evidence, and how long that takes.
//!
//! Evidence is what the training views truly show, with the errors that are asked for, after consensus. Masks of the
//! held-out view are judged as `l4d score` judges them, in memory. Measures lifting alone: no result of a method.

mod flicker;
mod measure;
mod samples;
mod table;
mod ways;

use anyhow::{Context as _, Result};
use l4d_board::publish_tradeoff;
use l4d_data::Progress as _;
use l4d_data::store::write_atomic;
use l4d_data::{Benchmark, Report, Workspace};
use l4d_ground::oracle::NoisePreset;
use l4d_score::{Exam, QuerySet};
use l4d_solve::consensus::Preset;
use serde_json::json;

use self::measure::{Measurement, Sums};
use self::table::{Row, csv_of, figure, text};
use self::ways::{Way, ways};
use crate::cli::solver::BenchLiftArgs;
use crate::out::{ExitStatus, Printer};
use crate::rasterizer;
use crate::solver::{Grounders, Stage};

pub(crate) fn run(args: &BenchLiftArgs, out: &Printer) -> Result<ExitStatus> {
    let folder = args.out.clone().unwrap_or_else(|| args.work.work.join("bench").join("lift"));
    let noise = args.noise.as_deref().map(NoisePreset::read).transpose()?;
    let is_exact = noise.is_none();
    let grounders = Grounders::Oracle(noise.unwrap_or_else(NoisePreset::none));
    let opened = rasterizer::open(&args.adapter.adapter)?;
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench)?;
    let exam = Exam::open(bench, args.profile, QuerySet::Queries, &args.scenes, &mut report)?;
    let ways = ways(args.quick);

    let data = Workspace::new(args.profile, exam.bench.manifest.draw())
        .with_data(args.work.data.as_deref())
        .data()
        .to_owned();
    let clips = Preset::Robust.clip_settings(args.views as usize, 0);
    let samples = folder.join("samples");
    let measurement = Measurement {
        grounders: &grounders,
        opened: &opened,
        ways: &ways,
        queries: args.queries as usize,
        samples: &samples,
    };
    let mut sums: Vec<Sums> = ways.iter().flat_map(|way| way.rows()).map(|_| Sums::default()).collect();
    out.start("lifting", (exam.scenes.len() * args.queries as usize * ways.len()) as u64);
    for scene in &exam.scenes {
        out.item(&scene.name);
        let stage = Stage::open(&exam, scene, &data, &args.work.work, &clips, &opened)?;
        measurement.add_scene(&stage, &mut sums, &|| out.advance(1))?;
    }
    out.finish();
    let named = ways.iter().flat_map(Way::rows);
    let rows: Vec<Row> =
        named.zip(&sums).filter_map(|((series, name), sums)| Row::new(series, name, sums)).collect();

    let queries = rows.iter().map(|row| row.queries).max().unwrap_or_default();
    let names: Vec<&str> = exam.scenes.iter().map(|scene| scene.name.as_str()).collect();
    let about = format!(
        "{queries} {} of {} at profile {}, {} views; the oracle {}",
        if queries == 1 { "query" } else { "queries" },
        names.join(", "),
        args.profile,
        args.views,
        if is_exact { "makes no errors" } else { "errs as it was told" }
    );
    let table = folder.join("lift.csv");
    write_atomic(&table, &csv_of(&rows)?)?;
    if samples.exists() {
        std::fs::remove_dir_all(&samples).with_context(|| samples.display().to_string())?;
    }
    let machine = opened.rasterizer.name();
    let figures = publish_tradeoff(&figure(&about, &machine, &rows), &folder)?;
    if args.json {
        out.json(&json!({ "about": about, "rows": rows }))?;
    } else {
        out.data(text(&rows))?;
    }
    out.note(about);
    for path in std::iter::once(&table).chain(&figures) {
        out.note(path.display());
    }
    Ok(ExitStatus::Success)
}
