//! `l4d bench splats`: what makes drawing a model faster, and what that costs.
//!
//! Everything is measured on the same pictures in one run: times as medians, errors against the unreduced model drawn
//! in f64, and against pictures of the held-out view where there are some.

mod measure;
mod stage;
mod table;
mod variants;

use anyhow::Result;
use l4d_board::publish_tradeoff;
use l4d_data::Progress as _;
use l4d_data::store::write_atomic;
use l4d_data::workspace::SharedWork;
use serde_json::json;

use self::measure::{Truth, measure};
use self::stage::Stage;
use self::table::{Row, csv_of, figure, text};
use self::variants::{Backends, variants};
use crate::cli::splats::BenchSplatsArgs;
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &BenchSplatsArgs, out: &Printer) -> Result<ExitStatus> {
    let folder = args.out.clone().unwrap_or_else(|| SharedWork::new(&args.work).bench("splats"));
    let backends = Backends::open(&args.adapters)?;
    let stage = Stage::set(args)?;
    let variants = variants(&stage, &args.sweeps, &backends)?;
    out.note(format!("{}: {} variants", stage.about, variants.len()));

    let truth = Truth::draw(&stage)?;
    out.start("measuring", variants.len() as u64 * (u64::from(args.repeats) + 1));
    let measured = measure(&stage, &truth, &variants, &backends, args.repeats, || out.advance(1))?;
    out.finish();
    let row = |(variant, measured)| Row::new(variant, &backends, measured);
    let rows: Vec<Row> = variants.iter().zip(&measured).map(row).collect();

    let table = folder.join("splats.csv");
    write_atomic(&table, &csv_of(&rows)?)?;
    let figures = publish_tradeoff(&figure(&stage, &rows), &folder)?;
    if args.json {
        out.json(&json!({ "about": stage.about, "rows": rows }))?;
    } else {
        out.data(text(&rows))?;
    }
    for path in std::iter::once(&table).chain(&figures) {
        out.note(path.display());
    }
    Ok(ExitStatus::Success)
}
