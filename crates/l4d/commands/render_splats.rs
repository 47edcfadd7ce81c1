//! `l4d render-splats`: clips of colour and depth of a model, from any cameras at any times.

use std::time::Instant;

use anyhow::Result;
use l4d_data::store::Claim;
use l4d_data::{Name, Progress as _, Timeline, counted};
use l4d_frames::moving_picture::{self, Pace};
use l4d_solve::clips::{
    self, ClipsFolder, ClipsRequest, DepthEntry, Flight, Look, Overwrite, Preview, Wanted,
};

use crate::cli::splats::RenderSplatsArgs;
use crate::out::{ExitStatus, Printer, refusal};
use crate::rasterizer;

pub(crate) fn run(args: &RenderSplatsArgs, out: &Printer) -> Result<ExitStatus> {
    let scene = args.scene.as_deref().map(Name::new).transpose()?;
    let space = args.work.space(args.profile);
    let wanted = Wanted {
        scene: scene.as_ref(),
        space: &space,
        model: args.splats.as_deref(),
        reader_options: args.reader.options(),
        cameras: args.cameras.as_deref(),
        views: &args.views,
        flight: flight(args),
        frames: &args.frames,
        times: &args.times,
        size: args.size.map(|size| size.0),
        out: args.out.as_deref(),
    };
    let ClipsRequest { model, source, out: root, plan, timeline } = ClipsRequest::of(&wanted)?;
    let language = match &source.language {
        None if args.language => {
            return Err(refusal(
                format!("{}: the model has no language features", model.display()),
                "leave out --language: the stages fine-lang and fine-lang-discrete of 4D LangSplat alone have some",
            ));
        }
        language => language.as_ref().filter(|_| args.language),
    };
    source.notes.iter().for_each(|note| out.note(format!("{}: {note}", model.display())));
    let opened = rasterizer::open(&args.adapter.adapter)?;
    let look = Look {
        model: (&source).into(),
        rasterizer: opened.rasterizer.name(),
        adapter: opened.adapter,
        width: plan.size[0],
        height: plan.size[1],
        background: args.background.map(|colour| colour.0).or(source.background).unwrap_or_default(),
        depth: DepthEntry::new(args.depth, args.depth_format),
    };
    let overwrite = if args.force { Overwrite::Always } else { Overwrite::Never };
    let folder = ClipsFolder::claim(root, look, &plan, overwrite)?;

    let names = ["language/", "preview.mp4", "preview.png"].map(str::to_owned).to_vec();
    let _claim = Claim::take(folder.root(), names, None, args.force)?;
    let total = plan.pictures().count();
    out.start("drawing", total as u64);
    let start = Instant::now();
    let there =
        clips::complete(&folder, &plan, &source.model, opened.rasterizer.as_ref(), &|| out.advance(1))?;
    out.finish();
    out.note(format!(
        "{} ({}, {}) in {:.1} s, {there} more were there",
        counted(total - there, "picture"),
        counted(plan.cameras.len(), "view"),
        counted(plan.instants.len(), "time"),
        start.elapsed().as_secs_f64(),
    ));
    out.data(folder.manifest_path().display())?;
    if let Some(language) = language {
        let folder = folder.root().join("language");
        clips::write_language(&folder, &plan, (&source, language), opened.rasterizer.as_ref())?;
        out.data(folder.display())?;
    }
    if args.preview {
        let lay_out = |widest_px| Ok(Preview::new(&folder, &plan, widest_px)?);
        let path =
            moving_picture::write(folder.root(), "preview", pace(&plan.instants, timeline), lay_out, out)?;
        out.data(path.display())?;
    }
    Ok(ExitStatus::Success)
}

fn flight(args: &RenderSplatsArgs) -> Option<Flight> {
    match args.path.as_slice() {
        [] => args.orbit.then_some(Flight::Orbit),
        stops => Some(Flight::Path(stops.to_vec())),
    }
}

fn pace(instants: &[clips::DrawnTime], timeline: Timeline) -> Pace {
    let share = instants.first().zip(instants.last()).map_or(0.0, |(first, last)| last.time - first.time);
    Pace::over(instants.len(), f64::from(share) * timeline.duration_s())
}
