//! Finds the results of methods, reads their cards and looks through their folders, and reports every problem
//! instead of stopping at the first.
//!
//! Results are untrusted: names are compared with what is asked and never joined to a path otherwise, links
//! are refused, files have a largest size.

use std::fs;
use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::results::MethodCard;
pub use l4d_data::results::PROTOCOL;
use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name, Report};
use rayon::prelude::*;

use crate::codes;
use crate::eval_set::EvalSet;
use crate::folder::{Kind, entries, kind_of, list, report_link};
use crate::reading::{Holes, SceneReader, frame_list, printable};

/// No card is larger.
const MAX_CARD_BYTES: u64 = 1 << 20;
/// Unit of messages.
pub const MEGABYTE: u64 = 1_000_000;
/// Bytes of masks that one method may have unless the caller says otherwise. Noise in every frame of the profile full
/// takes a quarter of it as 1-bit PNG.
pub const MOST_BYTES: u64 = 4000 * MEGABYTE;

/// Finds the methods in a folder: the folder itself if it holds a card or masks, else each of its folders.
///
/// # Errors
/// A folder that cannot be listed.
pub(crate) fn find_methods(root: &Path, report: &mut Report) -> Result<Vec<ResultsDir>, DataError> {
    // `l4d score .` must know its name.
    let root = match root.file_name() {
        Some(_) => root.to_owned(),
        None => fs::canonicalize(root).map_err(|source| DataError::io(root, "open", source))?,
    };
    fs::read_dir(&root).map_err(|source| DataError::io(&root, "list the folder", source))?;
    // Asked by name: a method may be beside more than a list could hold.
    if ["method.json", "masks"].iter().any(|name| fs::symlink_metadata(root.join(name)).is_ok()) {
        return Ok(vec![ResultsDir::new(root)]);
    }
    let mut methods = Vec::new();
    for (name, kind) in list(&root, report) {
        let path = root.join(&name);
        match kind {
            Kind::Folder => methods.push(ResultsDir::new(path)),
            Kind::File => {}
            Kind::Link | Kind::Other => report_link(&path, report),
        }
    }
    if methods.is_empty() && report.is_empty() {
        let hint = "give a folder with one folder a method, or run `l4d baseline` to make some";
        report.error(codes::NO_RESULTS, &root, "folder", "holds no results of any method", hint);
    }
    Ok(methods)
}

/// Judges every method of a folder whose card fits and whose masks are not too much; gives what `judge` made of them.
/// `progress` gets the name of each method that was read.
pub(crate) fn each_method<T>(
    root: &Path,
    eval_set: &EvalSet,
    resize: bool,
    report: &mut Report,
    progress: impl Fn(&str),
    mut judge: impl FnMut(&ResultsDir, MethodCard, &mut Report) -> Result<Option<T>, DataError>,
) -> Result<Vec<T>, DataError> {
    let mut judged = Vec::new();
    for dir in find_methods(root, report)? {
        let mut found = Report::default();
        if let Some(card) = read_card(&dir, eval_set, resize, &mut found)
            && admit(&dir, eval_set, resize, &mut found)
        {
            judged.extend(judge(&dir, card, &mut found)?);
        }
        report.extend(found);
        progress(&dir.root().file_name().unwrap_or_default().to_string_lossy());
    }
    Ok(judged)
}

/// Reads `method.json` and checks that the masks were made for this evaluation set; none if they cannot be scored.
pub(crate) fn read_card(
    dir: &ResultsDir,
    eval_set: &EvalSet,
    resize: bool,
    report: &mut Report,
) -> Option<MethodCard> {
    let path = dir.card();
    match kind_of(&path) {
        Ok(Kind::File) => {}
        Ok(Kind::Link | Kind::Other) => {
            report_link(&path, report);
            return None;
        }
        Ok(Kind::Folder) | Err(_) => {
            let message = "is missing: the masks tell nothing of themselves";
            let hint = "write method.json as docs/formats.md says, or remove the folder";
            report.error(codes::BAD_CARD, &path, "file", message, hint);
            return None;
        }
    }
    let read = read_bounded(&path, MAX_CARD_BYTES).map_err(|error| vec![error]);
    let card = match read.and_then(|bytes| MethodCard::parse_all(&path, &bytes)) {
        Ok(card) => card,
        Err(errors) => {
            errors.iter().for_each(|error| report.data_error(codes::BAD_CARD, error));
            return None;
        }
    };
    let mismatches = mismatches(&card, eval_set, resize);
    for (field, message, hint) in &mismatches {
        report.error(codes::CARD_MISMATCH, &path, format!("field `{field}`"), message, hint);
    }
    mismatches.is_empty().then_some(card)
}

fn mismatches(card: &MethodCard, eval_set: &EvalSet, resize: bool) -> Vec<(&'static str, String, String)> {
    let (version, profile, (width, height)) =
        (&eval_set.bench.manifest.version, eval_set.profile, eval_set.size());
    let again =
        "make the results again with this benchmark, or pass the benchmark that they were made for (--bench)";
    let digest = |text: &str| match text {
        "" => "no truth".to_owned(),
        text => printable(text),
    };
    // Digest, size and frames follow from the profile and would only repeat it.
    let of_profile = card.profile == profile;
    let checks = [
        (
            "protocol",
            card.protocol == PROTOCOL,
            format!("is `{}`, but `{PROTOCOL}` is scored here", printable(&card.protocol)),
            format!("write `{PROTOCOL}` if the masks answer the whole clip of the held-out view"),
        ),
        (
            "benchmark_version",
            card.benchmark_version == *version,
            format!("is {}, but the benchmark is {version}", printable(&card.benchmark_version)),
            again.to_owned(),
        ),
        (
            "profile",
            of_profile,
            format!("is {}, but {profile} is scored", card.profile),
            format!("pass --profile {}", card.profile),
        ),
        (
            "truth_digest",
            !of_profile || card.truth_digest == eval_set.truth_digest,
            format!("is {}, but the truth is {}", digest(&card.truth_digest), digest(&eval_set.truth_digest)),
            format!("{again}; `l4d init-results` writes a method.json for it"),
        ),
        (
            "width",
            !of_profile || resize || (card.width, card.height) == (width, height),
            format!(
                "width and height are {}x{}, but profile {profile} is {width}x{height}",
                card.width, card.height
            ),
            match (card.height, card.width) == (width, height) {
                true => {
                    format!("width and height are exchanged: write \"width\": {width}, \"height\": {height}")
                }
                false => "render masks at that size, or pass --resize".to_owned(),
            },
        ),
        (
            "frames",
            !of_profile || card.frames == eval_set.clip,
            format!("are not the {} frames of profile {profile}", eval_set.clip.len()),
            format!("answer the frames {}", frame_list(&eval_set.clip)),
        ),
    ];
    let wrong = checks.into_iter().filter(|(_, is_equal, ..)| !is_equal);
    wrong.map(|(field, _, message, hint)| (field, message, hint)).collect()
}

/// Looks through the folder of masks before any of them is read: reports folders for scenes that the benchmark does not
/// have and anything else that is out of place. False, and reported, if there are more bytes than are taken in.
pub(crate) fn admit(dir: &ResultsDir, eval_set: &EvalSet, resize: bool, report: &mut Report) -> bool {
    check_scenes(dir, &eval_set.bench.manifest.scenes, report);
    // What is wrong with the masks is for those to say who read them.
    let bytes_of =
        |scene| SceneReader::open(dir, scene, resize, Holes::Counted, &mut Report::default()).bytes();
    let bytes: u64 = eval_set.scenes.par_iter().map(bytes_of).sum();
    let is_admitted = bytes <= eval_set.most_bytes;
    if !is_admitted {
        let message = format!(
            "holds {} MB of masks, more than the {} MB that are taken in, so none of them was read",
            bytes.div_ceil(MEGABYTE),
            eval_set.most_bytes / MEGABYTE
        );
        let hint = "write run lengths or 1-bit PNG; who judges may raise --max-megabytes";
        report.error(codes::TOO_MUCH, &dir.masks(), "folder", message, hint);
    }
    is_admitted
}

fn check_scenes(dir: &ResultsDir, known: &[Name], report: &mut Report) {
    let masks = dir.masks();
    for (name, kind) in entries(&masks, report) {
        let path = masks.join(&name);
        match kind {
            Kind::Folder if known.iter().any(|scene| scene.as_str() == name) => {}
            Kind::Folder => {
                let scenes: Vec<&str> = known.iter().map(Name::as_str).collect();
                let hint = format!("rename or remove it; the scenes are {}", scenes.join(", "));
                report.error(codes::UNKNOWN_SCENE, &path, "folder", "is no scene of the benchmark", hint);
            }
            Kind::File => report_unknown(&path, report),
            Kind::Link | Kind::Other => report_link(&path, report),
        }
    }
}

pub(crate) fn report_unknown(path: &Path, report: &mut Report) {
    let hint =
        "masks are in masks/<scene>/<nnn>.json or masks/<scene>/<nnn>/<frame>.png; move or remove the file";
    report.error(codes::UNKNOWN_ENTRY, path, "name", "has no meaning here", hint);
}
