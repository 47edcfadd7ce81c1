//! `l4d export`: a scene, rendered or captured, in the layout of another tool; its trained model for another viewer.

mod splats;

use anyhow::Result;
use l4d_data::Name;
use l4d_data::Progress as _;
use l4d_data::layout::BenchDir;
use l4d_data::query::{Query, read_queries};
use l4d_data::truth::Truth;
use l4d_import::annotations::QueriesWithTruth;
use l4d_import::export::{ExportRequest, Origin, export, picture_count};

use crate::cli::interop::{ExportArgs, ExportFormat};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &ExportArgs, out: &Printer) -> Result<ExitStatus> {
    let name = Name::new(&args.scene)?;
    let space = args.work.space(args.profile);
    let format = match args.format {
        ExportFormat::Splats(format) => return splats::run(args, &name, format, out),
        ExportFormat::Scene(format) => format,
    };
    let (rendering, capture) = (space.scene(&name), space.capture(&name));
    let origin = match args.profile.is_rendered() {
        true => Origin::Rendered(&rendering),
        false => Origin::Captured(&capture),
    };
    let answers = if format.needs_truth() { Some(answers(args, &name)?) } else { None };
    let bench = BenchDir::new(&args.bench);
    let judged = answers
        .as_ref()
        .map(|(truth, queries)| QueriesWithTruth::new(&bench.truth(args.profile, &name), truth, queries))
        .transpose()?;
    let request = ExportRequest {
        origin,
        format,
        out: &args.out,
        frames: &args.frames,
        held_out: args.held_out,
        points: args.points,
        points_from: args.points_from.as_deref(),
        judged: judged.as_ref(),
    };
    out.start("exporting", picture_count(&request)?);
    let exported = export(request, &|| out.advance(1))?;
    out.finish();
    exported.manifest.notes.iter().for_each(|note| out.note(note));
    match args.json {
        true => out.json(&exported.manifest)?,
        false => out.data(exported.path.display())?,
    }
    Ok(ExitStatus::Success)
}

fn answers(args: &ExportArgs, name: &Name) -> Result<(Truth, Vec<Query>)> {
    let bench = BenchDir::new(&args.bench);
    Ok((Truth::read(&bench.truth(args.profile, name))?, read_queries(&bench.queries(name), name)?))
}
