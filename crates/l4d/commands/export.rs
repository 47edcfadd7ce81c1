//! `l4d export`: a rendered scene in the layout of another tool.

use std::path::Path;

use anyhow::Result;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::query::{Query, read_queries};
use l4d_data::store::read_bounded;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Benchmark, Name, Timeline};
use l4d_frames::drawn::{RgbImage, decode_colour};
use l4d_import::annotations::Judged;
use l4d_import::export::{Exported, Format, HeldOut, Order, export, picture_count};
use l4d_solve::clips::Instant;

use super::build_scenes::data_folder;
use crate::cli::interop::{ExportArgs, HeldOutArg};
use crate::moving_picture::{self, Pages};
use crate::out::{ExitStatus, Printer, refusal};

/// No PNG of an export is larger, bytes.
const MAX_PNG_BYTES: u64 = 64 << 20;

pub(crate) fn run(args: &ExportArgs, out: &Printer) -> Result<ExitStatus> {
    if args.video && args.format != Format::Plain {
        return Err(refusal("moving pictures belong to the plain layout", "use `--format plain --video`"));
    }
    let name = Name::new(&args.scene)?;
    let draw = Benchmark::open(&args.bench).map(|bench| bench.manifest.draw()).unwrap_or_default();
    let scene = SceneDir::new(&data_folder(args.data.as_deref(), args.profile, draw), &name);
    let answers = if args.format.needs_truth() { Some(answers(args, &name)?) } else { None };
    let bench = BenchDir::new(&args.bench);
    let judged = answers
        .as_ref()
        .map(|(truth, queries)| Judged::new(&bench.truth(args.profile, &name), truth, queries))
        .transpose()?;
    let order = Order {
        scene: &scene,
        format: args.format,
        out: &args.out,
        frames: &args.frames,
        held_out: args.held_out.into(),
        points: args.points,
        judged: judged.as_ref(),
    };
    let bar = out.bar(picture_count(&order)?, "exporting");
    let exported = export(order, &|| bar.inc(1))?;
    bar.finish_and_clear();
    exported.manifest.notes.iter().for_each(|note| out.note(note));
    if args.video {
        write_videos(&args.out, &exported, (args.profile.width(), args.profile.height()), out)?;
    }
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

impl From<HeldOutArg> for HeldOut {
    fn from(held_out: HeldOutArg) -> Self {
        match held_out {
            HeldOutArg::Nothing => Self::Nothing,
            HeldOutArg::Pose => Self::Pose,
            HeldOutArg::Pictures => Self::Pictures,
        }
    }
}

/// The pictures of a camera, from their files.
struct Footage<'a> {
    folder: &'a Path,
    frames: &'a [u32],
    size: (u32, u32),
}

impl Pages for Footage<'_> {
    fn size_px(&self) -> (u32, u32) {
        self.size
    }

    fn page(&self, index: usize) -> Result<RgbImage> {
        let path = self.folder.join(format!("{}.png", frame_key(self.frames[index])));
        let bytes = read_bounded(&path, MAX_PNG_BYTES)?;
        decode_colour(&bytes, self.size.0, self.size.1).map_err(|error| {
            refusal(format!("{}: {error}", path.display()), "export the scene again into an empty folder")
        })
    }
}

fn write_videos(root: &Path, exported: &Exported, size: (u32, u32), out: &Printer) -> Result<()> {
    let frames = &exported.manifest.frames;
    let instants: Vec<Instant> =
        frames.iter().map(|&frame| Instant::at_frame(frame, Timeline::CANONICAL)).collect();
    for camera in &exported.manifest.cameras {
        let folder = root.join(&camera.called);
        if folder.is_dir() {
            let pages = |_: u32| Ok(Footage { folder: &folder, frames, size });
            let path =
                moving_picture::write(root, &camera.name, (&instants, Timeline::CANONICAL), pages, out)?;
            out.note(path.display());
        }
    }
    Ok(())
}
