//! Videos as pictures, through ffmpeg: l4d decodes no video itself.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use l4d_data::DataError;
use l4d_data::error::inert;
use l4d_data::store::{list_folder, make_folder};

/// Extracts the pictures of a video into a folder; gives them in order.
pub(super) fn extract(ffmpeg: &Path, video: &Path, folder: &Path) -> Result<Vec<PathBuf>, DataError> {
    make_folder(folder)?;
    let output = Command::new(ffmpeg)
        .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-i"])
        .arg(video)
        .args(["-vsync", "passthrough", "-start_number", "0"])
        .arg(folder.join("%06d.png"))
        .stdin(Stdio::null())
        .output();
    let refuse = |message: String, remedy: &str| Err(DataError::invalid(video, "video", message, remedy));
    match output {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return refuse(
                format!("needs the program `{}`, which is not there", ffmpeg.display()),
                "install ffmpeg, or put the pictures into <camera>/images/0000.png, 0001.png, ...",
            );
        }
        Err(error) => return Err(DataError::io(ffmpeg, "run", error)),
        Ok(output) if !output.status.success() => {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().last().unwrap_or("it says nothing");
            return refuse(format!("ffmpeg failed: {}", inert(last)), "check that the video plays");
        }
        Ok(_) => {}
    }
    let pictures: Vec<PathBuf> = list_folder(folder)?.into_iter().map(|name| folder.join(name)).collect();
    if pictures.is_empty() {
        return refuse("holds no picture".to_owned(), "check that the video plays");
    }
    Ok(pictures)
}
