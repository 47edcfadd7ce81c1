//! A moving picture of a clip for people: MP4 through ffmpeg where it is at hand, else an animated PNG.

use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::Result;
use l4d_data::DataError;
use l4d_data::store::write_atomic;
use l4d_data::timeline::{FPS, LAST_FRAME};
use l4d_frames::preview::{Cell, Page, animated_png};

use super::folder::ClipsFolder;
use super::plan::{Plan, Shot};
use crate::out::Printer;

/// Widest page of a video, and of an animated PNG, which takes many times the room, pixels.
const VIDEO_WIDTH_PX: u32 = 1440;
const PNG_WIDTH_PX: u32 = 640;

/// Writes `preview.mp4` or `preview.png`; gives its path.
pub(super) fn write(folder: &ClipsFolder, plan: &Plan, out: &Printer) -> Result<PathBuf> {
    match video(folder, plan)? {
        Video::Written(path) => return Ok(path),
        Video::NoProgram => {
            out.note("ffmpeg is not on the PATH: the preview is an animated PNG instead of an MP4");
        }
        Video::Failed(message) => {
            out.warn(format!("ffmpeg failed ({message}): the preview is an animated PNG instead of an MP4"));
        }
    }
    let page = page(folder, plan, PNG_WIDTH_PX)?;
    let pages = (0..plan.instants.len())
        .map(|instant| Ok(page.draw(&cells(folder, plan, instant)?)))
        .collect::<Result<Vec<_>>>()?;
    let path = folder.root().join("preview.png");
    let bytes = animated_png(&pages, frames_per_second(plan)).unwrap_or_default();
    write_atomic(&path, &bytes)?;
    Ok(path)
}

enum Video {
    Written(PathBuf),
    NoProgram,
    Failed(String),
}

fn video(folder: &ClipsFolder, plan: &Plan) -> Result<Video> {
    let path = folder.root().join("preview.mp4");
    let unfinished = folder.root().join(".preview.tmp.mp4");
    let page = page(folder, plan, VIDEO_WIDTH_PX)?;
    let (width, height) = page.size_px();
    let mut command = Command::new("ffmpeg");
    command
        .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"])
        .args(["-s", &format!("{width}x{height}"), "-r", &format!("{:.3}", frames_per_second(plan))])
        .args(["-i", "-", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact"])
        .arg(&unfinished)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Video::NoProgram),
        Err(error) => return Ok(Video::Failed(error.to_string())),
    };
    if let Some(mut pipe) = child.stdin.take() {
        for instant in 0..plan.instants.len() {
            let picture = page.draw(&cells(folder, plan, instant)?);
            // A child that closed its end says why below.
            if pipe.write_all(picture.as_raw()).is_err() {
                break;
            }
        }
    }
    let output = child.wait_with_output().map_err(|source| DataError::io(&path, "write", source))?;
    if !output.status.success() {
        std::fs::remove_file(&unfinished).ok();
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.lines().last().unwrap_or("it says nothing").to_owned();
        return Ok(Video::Failed(l4d_data::error::inert(&last)));
    }
    std::fs::rename(&unfinished, &path).map_err(|source| DataError::io(&path, "write", source))?;
    Ok(Video::Written(path))
}

/// The layout, with greys for the depths of the first moment.
fn page(folder: &ClipsFolder, plan: &Plan, width_px: u32) -> Result<Page> {
    let names = plan.cameras.iter().map(|camera| camera.name.to_string()).collect();
    let depths: Vec<f32> = cells(folder, plan, 0)?.into_iter().flat_map(|cell| cell.depth_m).collect();
    Ok(Page::new(names, (plan.size[0], plan.size[1]), width_px, depths))
}

fn cells(folder: &ClipsFolder, plan: &Plan, instant: usize) -> Result<Vec<Cell>> {
    (0..plan.cameras.len()).map(|view| folder.read(plan, Shot { view, instant })).collect()
}

/// So that the clip lasts as long as what it shows.
fn frames_per_second(plan: &Plan) -> f64 {
    let (Some(first), Some(last)) = (plan.instants.first(), plan.instants.last()) else { return 1.0 };
    let seconds = f64::from(last.time - first.time) * f64::from(LAST_FRAME) / FPS;
    let steps = plan.instants.len() as f64 - 1.0;
    if seconds > 0.0 { (steps / seconds).clamp(1.0, 60.0) } else { 1.0 }
}
