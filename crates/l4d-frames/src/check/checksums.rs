//! `SHA256SUMS` of a scene against the files beside it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::Report;
use l4d_data::digest::sha256_file;
use l4d_data::layout::SceneDir;
use l4d_data::store::read_bounded;
use l4d_data::sums;

/// The listed digests of the pictures; all other listed files have been checked while reading.
pub(super) struct Checksums {
    path: PathBuf,
    /// `None` if the list itself could not be read, which is a finding of its own.
    pictures: Option<BTreeMap<String, String>>,
}

impl Checksums {
    pub(super) fn read(dir: &SceneDir, report: &mut Report) -> Self {
        let path = dir.checksums();
        let text = match read_bounded(&path, sums::MAX_BYTES) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) => {
                report.data_error("L4D110", &error);
                return Self { path, pictures: None };
            }
        };
        let mut pictures = BTreeMap::new();
        for (index, line) in text.lines().enumerate() {
            let Some((digest, file)) = sums::parse_line(line) else {
                let message = "is not `<sha256>  <relative path>`";
                report.error(
                    "L4D110",
                    &path,
                    format!("line {}", index + 1),
                    message,
                    "build the scene again",
                );
                continue;
            };
            if file.ends_with(".exr") {
                pictures.insert(file.to_owned(), digest.to_owned());
            } else {
                check_file(dir.root(), &path, file, digest, report);
            }
        }
        Self { path, pictures: Some(pictures) }
    }

    /// Compares the digest of a picture's bytes.
    pub(super) fn check_picture(&self, root: &Path, picture: &Path, found: &str, report: &mut Report) {
        let Some(pictures) = &self.pictures else { return };
        let relative = picture.strip_prefix(root).unwrap_or(picture).to_string_lossy().replace('\\', "/");
        match pictures.get(&relative) {
            None => report.error("L4D110", &self.path, relative, "is not listed", "build the scene again"),
            Some(listed) if listed != found => report_change(&self.path, &relative, report),
            Some(_) => {}
        }
    }
}

fn check_file(root: &Path, list: &Path, file: &str, listed: &str, report: &mut Report) {
    match sha256_file(&root.join(file)) {
        Ok(found) if found == listed => {}
        Ok(_) => report_change(list, file, report),
        Err(error) => report.data_error("L4D110", &error),
    }
}

fn report_change(list: &Path, file: &str, report: &mut Report) {
    let hint = "fetch the file again, or delete it and run `l4d build-scenes`";
    report.error("L4D110", list, file, "has other bytes than when the list was written", hint);
}
