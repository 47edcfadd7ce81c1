//! `l4d bench lift`: seconds against mIoU of every lift.

use anyhow::Result;
use l4d_board::{TradePoint, Tradeoff, publish_tradeoff};
use l4d_data::{Benchmark, Report};
use l4d_experiments::lift::{Benched, Order, Row, bench, text};
use l4d_ground::oracle::NoisePreset;
use l4d_score::{Exam, QuerySet};
use serde_json::json;

use crate::cli::solver::BenchLiftArgs;
use crate::out::{ExitStatus, Printer};
use crate::rasterizer;

pub(crate) fn run(args: &BenchLiftArgs, out: &Printer) -> Result<ExitStatus> {
    let opened = rasterizer::open(&args.adapter.adapter)?;
    let bench_folder = Benchmark::open(&args.bench)?;
    let space = args.work.space(args.profile, bench_folder.manifest.draw());
    let exam =
        Exam::open(bench_folder, args.profile, QuerySet::Queries, &args.scenes, &mut Report::default())?;
    let folder = args.out.clone().unwrap_or_else(|| space.shared().bench("lift"));
    let order = Order {
        exam: &exam,
        space: &space,
        noise: args.noise.as_deref().map(NoisePreset::read).transpose()?,
        views: args.views as usize,
        queries: args.queries as usize,
        is_quick: args.quick,
        folder: &folder,
        rasterizer: opened.rasterizer.as_ref(),
        adapter: opened.adapter.clone(),
    };
    let benched = bench(&order, out)?;
    let figures = publish_tradeoff(&figure(&benched, &opened.rasterizer.name()), &folder)?;
    match args.json {
        true => out.json(&json!({ "about": benched.about, "rows": benched.rows }))?,
        false => out.data(text(&benched.rows))?,
    }
    out.note(benched.about);
    for path in std::iter::once(&folder.join("lift.csv")).chain(&figures) {
        out.note(path.display());
    }
    Ok(ExitStatus::Success)
}

fn figure(benched: &Benched, machine: &str) -> Tradeoff {
    let point = |row: &Row| TradePoint {
        series: row.series.clone(),
        label: row.setting.clone(),
        cost: row.lift_seconds.max(1e-3),
        gain: row.miou,
        is_base: row.is_base(),
    };
    Tradeoff {
        name: "lift",
        title: "Lifting an answer: speed against error".to_owned(),
        notes: vec![
            format!("{}.", benched.about),
            format!("{machine}."),
            "Evidence is what training views truly show: this measures lifting alone. Ring: the default. Grey: what nothing \
             beats."
                .to_owned(),
        ],
        cost: "seconds a lift".to_owned(),
        gain: "mIoU of the held-out view, percent".to_owned(),
        points: benched.rows.iter().map(point).collect(),
    }
}
