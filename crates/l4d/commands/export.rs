//! `l4d export`: a scene, rendered or captured, in the layout of another tool.

use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::layout::{BenchDir, CaptureDir, SceneDir};
use l4d_data::query::{Query, read_queries};
use l4d_data::store::read_bounded;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Benchmark, Name};
use l4d_frames::drawn::{RgbImage, decode_colour};
use l4d_frames::preview::{shrunk, shrunk_size};
use l4d_import::annotations::Judged;
use l4d_import::export::{Exported, Format, HeldOut, Order, Origin, export, picture_count};

use super::build_scenes::data_folder;
use crate::cli::interop::{ExportArgs, HeldOutArg};
use crate::moving_picture::{self, Clip, PNG_WIDTH_PX, Pages};
use crate::out::{ExitStatus, Printer, refusal};

/// No PNG of an export is larger, bytes.
const MAX_PNG_BYTES: u64 = 256 << 20;

pub(crate) fn run(args: &ExportArgs, out: &Printer) -> Result<ExitStatus> {
    if args.video && args.format != Format::Plain {
        return Err(refusal("moving pictures belong to the plain layout", "use `--format plain --video`"));
    }
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
    if args.video {
        write_videos(&args.out, &exported, out)?;
    }
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

/// The pictures of a camera, from their files.
struct Footage<'a> {
    pictures: &'a [PathBuf],
    size: (u32, u32),
    widest_px: u32,
}

impl Pages for Footage<'_> {
    fn size_px(&self) -> (u32, u32) {
        shrunk_size(self.size, self.widest_px)
    }

    fn page(&self, index: usize) -> Result<RgbImage> {
        let path = &self.pictures[index];
        let bytes = read_bounded(path, MAX_PNG_BYTES)?;
        let picture = decode_colour(&bytes, self.size.0, self.size.1).map_err(|error| {
            refusal(format!("{}: {error}", path.display()), "export the scene again into an empty folder")
        })?;
        Ok(shrunk(picture, self.widest_px))
    }
}

fn write_videos(root: &Path, exported: &Exported, out: &Printer) -> Result<()> {
    for camera in &exported.manifest.cameras {
        let path = |frame: &u32| root.join(&camera.called).join(format!("{}.png", frame_key(*frame)));
        // A view that did not see a moment has no picture of it.
        let pictures: Vec<PathBuf> =
            exported.manifest.frames.iter().map(path).filter(|path| path.is_file()).collect();
        if !pictures.is_empty() {
            let pages = |widest_px: u32| {
                // A video has the size of the pictures.
                let widest_px = if widest_px > PNG_WIDTH_PX { u32::MAX } else { widest_px };
                Ok(Footage { pictures: &pictures, size: exported.size_px, widest_px })
            };
            let clip = Clip { pages: pictures.len(), frames_per_second: exported.frames_per_second };
            let path = moving_picture::write(root, &camera.name, clip, pages, out)?;
            out.note(path.display());
        }
    }
    Ok(())
}
