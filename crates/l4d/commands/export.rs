//! `l4d export`: a scene, rendered or captured, in the layout of another tool.

use std::path::Path;

use anyhow::Result;
use l4d_data::layout::{BenchDir, CaptureDir, SceneDir};
use l4d_data::query::{Query, read_queries};
use l4d_data::truth::Truth;
use l4d_data::{Benchmark, Name};
use l4d_import::annotations::Judged;
use l4d_import::export::{HeldOut, Order, Origin, export, picture_count};

use super::build_scenes::data_folder;
use crate::cli::interop::{ExportArgs, HeldOutArg};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &ExportArgs, out: &Printer) -> Result<ExitStatus> {
    let name = Name::new(&args.scene)?;
    let (rendering, capture) = (rendering(args, &name), capture(args, &name));
    let origin = match args.profile.is_rendered() {
        true => Origin::Rendered(&rendering),
        false => Origin::Captured(&capture),
    };
    let answers = if args.format.needs_truth() { Some(answers(args, &name)?) } else { None };
    let bench = BenchDir::new(&args.bench);
    let judged = answers
        .as_ref()
        .map(|(truth, queries)| Judged::new(&bench.truth(args.profile, &name), truth, queries))
        .transpose()?;
    let order = Order {
        origin,
        format: args.format,
        out: &args.out,
        frames: &args.frames,
        held_out: args.held_out.into(),
        points: args.points,
        points_from: args.points_from.as_deref(),
        judged: judged.as_ref(),
    };
    let bar = out.bar(picture_count(&order)?, "exporting");
    let exported = export(order, &|| bar.inc(1))?;
    bar.finish_and_clear();
    exported.manifest.notes.iter().for_each(|note| out.note(note));
    match args.json {
        true => out.json(&exported.manifest)?,
        false => out.data(exported.path.display())?,
    }
    Ok(ExitStatus::Success)
}

fn rendering(args: &ExportArgs, name: &Name) -> SceneDir {
    let draw = Benchmark::open(&args.bench).map(|bench| bench.manifest.draw()).unwrap_or_default();
    SceneDir::new(&data_folder(args.data.as_deref(), args.profile, draw), name)
}

fn capture(args: &ExportArgs, name: &Name) -> CaptureDir {
    CaptureDir::new(args.data.as_deref().unwrap_or(Path::new("data/captures")), name)
}

fn answers(args: &ExportArgs, name: &Name) -> Result<(Truth, Vec<Query>)> {
    let bench = BenchDir::new(&args.bench);
    Ok((Truth::read(&bench.truth(args.profile, name))?, read_queries(&bench.queries(name), name)?))
}

impl From<HeldOutArg> for HeldOut {
    fn from(held_out: HeldOutArg) -> Self {
        match held_out {
            HeldOutArg::Nothing => Self::Nothing,
            HeldOutArg::Pose => Self::Pose,
            HeldOutArg::Pictures => Self::Pictures,
        }
    }
}
