//! Moving pictures for people: MP4 through ffmpeg where it is at hand, else an animated PNG.

use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use l4d_data::store::write_atomic;
use l4d_data::{DataError, Progress, StageError};

use crate::drawn::RgbImage;
use crate::preview::animated_png;

/// Widest page of a video, pixels.
const VIDEO_WIDTH_PX: u32 = 1440;
/// Widest page of an animated PNG, which takes many times the room, pixels.
pub const PNG_WIDTH_PX: u32 = 640;

/// Video codecs want even numbers of pixels: a black column or row makes them so.
const EVEN: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2";

/// What is shown, all pages of one size.
pub trait Pages {
    /// Width and height, pixels.
    fn size_px(&self) -> (u32, u32);

    /// A page of that size.
    ///
    /// # Errors
    /// A picture that cannot be read or drawn.
    fn page(&self, index: usize) -> Result<RgbImage, StageError>;
}

/// How long a moving picture is, and how fast.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Pages in all.
    pub pages: usize,
    /// Pages a second.
    pub frames_per_second: f64,
}

impl Pace {
    /// As long as what it shows: `seconds` from the first page to the last.
    pub fn over(pages: usize, seconds: f64) -> Self {
        let steps = pages as f64 - 1.0;
        Self {
            pages,
            frames_per_second: if seconds > 0.0 { (steps / seconds).clamp(1.0, 60.0) } else { 1.0 },
        }
    }
}

/// Writes `<stem>.mp4` or `<stem>.png` into a folder; gives its path. `lay_out` makes pages that are about so many
/// pixels wide at most.
///
/// # Errors
/// A page that cannot be drawn, a file that cannot be written. A failing ffmpeg is a warning.
pub fn write<P: Pages>(
    folder: &Path,
    stem: &str,
    clip: Pace,
    lay_out: impl Fn(u32) -> Result<P, StageError>,
    progress: &dyn Progress,
) -> Result<PathBuf, StageError> {
    match video(folder, stem, clip, &lay_out(VIDEO_WIDTH_PX)?)? {
        Video::Written(path) => return Ok(path),
        Video::NoProgram => {
            progress.note(&format_args!(
                "ffmpeg is not on the PATH: {stem} is an animated PNG instead of an MP4"
            ));
        }
        Video::Failed(message) => {
            progress.warn(&format_args!(
                "ffmpeg failed ({message}): {stem} is an animated PNG instead of an MP4"
            ));
        }
    }
    let pages = lay_out(PNG_WIDTH_PX)?;
    let drawn = (0..clip.pages).map(|index| pages.page(index)).collect::<Result<Vec<_>, StageError>>()?;
    let path = folder.join(format!("{stem}.png"));
    write_atomic(&path, &animated_png(&drawn, clip.frames_per_second).unwrap_or_default())?;
    Ok(path)
}

enum Video {
    Written(PathBuf),
    NoProgram,
    Failed(String),
}

fn video(folder: &Path, stem: &str, clip: Pace, pages: &impl Pages) -> Result<Video, StageError> {
    let path = folder.join(format!("{stem}.mp4"));
    let unfinished = folder.join(format!(".{stem}.tmp.mp4"));
    let (width, height) = pages.size_px();
    let mut command = Command::new("ffmpeg");
    command
        .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"])
        .args(["-s", &format!("{width}x{height}"), "-r", &format!("{:.3}", clip.frames_per_second)])
        .args(["-i", "-"])
        .args(if width % 2 + height % 2 > 0 { &["-vf", EVEN][..] } else { &[] })
        .args(["-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact"])
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
        for index in 0..clip.pages {
            let picture = pages.page(index)?;
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
        return Ok(Video::Failed(last));
    }
    std::fs::rename(&unfinished, &path).map_err(|source| DataError::io(&path, "write", source))?;
    Ok(Video::Written(path))
}
