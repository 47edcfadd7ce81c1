//! Whether a release folder is what it was when it was made.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_file;
use l4d_data::{DataError, Report, sums};
use rayon::prelude::*;

use crate::codes;
use crate::contents::{Contents, SUMS};
use crate::gather::size_of;
use crate::parts::{home, parts};

const FETCH: &str = "fetch the file again";

/// Compares each folder of a release with its `SHA256SUMS`; gives what it says of itself, if that can be read.
/// `progress` gets bytes.
pub fn inspect(release: &Path, progress: &(dyn Fn(u64) + Sync), report: &mut Report) -> Option<Contents> {
    for part in parts(release) {
        inspect_folder(&release.join(part), progress, report)?;
    }
    match Contents::read(&home(release)) {
        Ok(contents) => Some(contents),
        // Other bytes were reported already.
        Err(_) if report.has_errors() => None,
        Err(error) => {
            report.data_error(codes::LIST, &error);
            None
        }
    }
}

/// Compares a folder with its `SHA256SUMS`; none if that cannot be read.
fn inspect_folder(folder: &Path, progress: &(dyn Fn(u64) + Sync), report: &mut Report) -> Option<()> {
    let path = folder.join(SUMS);
    let read = sums::read(&path).and_then(|listed| Ok((listed, files_below(folder, report)?)));
    let (listed, there) = match read {
        Ok(read) => read,
        Err(error) => {
            report.data_error(codes::LIST, &error);
            return None;
        }
    };
    for file in there.iter().filter(|file| *file != SUMS && !listed.contains_key(*file)) {
        let hint = "remove it: a reader of the release cannot know where it comes from";
        report.error(codes::EXTRA, &folder.join(file), "file", "is not listed in SHA256SUMS", hint);
    }
    for file in listed.keys().filter(|file| !there.contains(*file)) {
        let message = "is listed in SHA256SUMS, but missing";
        report.error(codes::MISSING, &folder.join(file), "file", message, FETCH);
    }
    let present: Vec<(&String, &String)> = listed.iter().filter(|(file, _)| there.contains(*file)).collect();
    let compared: Vec<Report> =
        present.into_par_iter().map(|(file, digest)| compare(&folder.join(file), digest, progress)).collect();
    compared.into_iter().for_each(|found| report.extend(found));
    Some(())
}

fn compare(path: &Path, digest: &str, progress: &(dyn Fn(u64) + Sync)) -> Report {
    let mut report = Report::default();
    match sha256_file(path) {
        Ok(found) if found == digest => {}
        Ok(_) => {
            let message = "has other bytes than when the release was made";
            report.error(codes::ALTERED, path, "bytes", message, FETCH);
        }
        Err(error) => report.data_error(codes::ALTERED, &error),
    }
    progress(fs::metadata(path).map_or(0, |metadata| metadata.len()));
    report
}

/// Relative paths of all files, with `/`; links are findings, and not followed.
pub(crate) fn files_below(root: &Path, report: &mut Report) -> Result<BTreeSet<String>, DataError> {
    let mut files = BTreeSet::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(folder) = folders.pop() {
        let here = root.join(&folder);
        let refuse = |source| DataError::io(&here, "list the folder", source);
        for entry in fs::read_dir(&here).map_err(refuse)? {
            let entry = entry.map_err(refuse)?;
            let relative = folder.join(entry.file_name());
            let kind = entry.file_type().map_err(refuse)?;
            if kind.is_dir() {
                folders.push(relative);
            } else if kind.is_file() {
                files.insert(relative.to_string_lossy().replace('\\', "/"));
            } else {
                let message = "is a link or a special file";
                report.error(codes::EXTRA, &root.join(relative), "file", message, "put a real file there");
            }
        }
    }
    Ok(files)
}

/// Sizes and digests of all files below a folder, in parallel; `progress` gets bytes.
pub(crate) fn digest_all(
    root: &Path,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<BTreeMap<String, (String, u64)>, DataError> {
    let files: Vec<String> = files_below(root, &mut Report::default())?.into_iter().collect();
    let digest = |file: String| {
        let path = root.join(&file);
        let sha256 = sha256_file(&path)?;
        let bytes = size_of(&path)?;
        progress(bytes);
        Ok((file, (sha256, bytes)))
    };
    files.into_par_iter().map(digest).collect()
}
