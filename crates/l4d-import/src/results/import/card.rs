//! What an import leaves: `method.json` with its assumptions and digests, and a file of masks a query.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use l4d_data::digest::{RunningDigest, sha256_file};
use l4d_data::layout::ResultsDir;
use l4d_data::results::{Import, MaskFile, MethodCard, Used};
use l4d_data::store::{FolderLock, list_folder, remove_folder, write_atomic};
use l4d_data::truth::frame_key;
use l4d_data::{DataError, Name, QueryId, json};

use super::super::codec;
use super::super::relevancy::Smoothing;
use super::super::template::Hit;
use super::{Imported, Request};

/// Beside the masks while an import writes them: what it left when it was killed is its own, and a later one replaces it.
const CLAIM: &str = ".l4d-import";

/// Who the results belong to.
#[derive(Debug, Clone)]
pub struct Identity {
    /// Name of the method, and of its folder.
    pub name: Name,
    /// Its version, as the user calls it.
    pub version: String,
    /// Whether the method saw pictures of the held-out view.
    pub test_view: bool,
    /// Whether it learned from rendered depth of the training views.
    pub depth: bool,
}

/// Writes results below a folder of methods, the card last; gives the folder of this one. What an import left that was
/// killed is replaced, and results that are there already are kept.
///
/// # Errors
/// A folder that holds results already, unless `force`, or that another run writes into, and whatever keeps files from
/// being written.
pub fn write(
    results: &Path,
    identity: &Identity,
    request: &Request<'_>,
    imported: &Imported,
    force: bool,
) -> Result<PathBuf, DataError> {
    let dir = ResultsDir::new(results.join(identity.name.as_str()));
    let _lock = FolderLock::take(dir.root())?;
    let claim = dir.root().join(CLAIM);
    let card = card(identity, request, imported)?;
    let is_taken = dir.masks().exists() || dir.card().exists();
    if is_taken && !force && !claim.exists() {
        if holds(&dir, &card, imported) {
            return Ok(dir.root().to_owned());
        }
        let hint = "give another --name, or replace what is there with --force";
        return Err(DataError::invalid(dir.root(), "folder", "holds results already", hint));
    }
    write_atomic(&claim, b"")?;
    // Old answers must not mix with new ones, nor an old card with either.
    remove_file(&dir.card())?;
    remove_folder(&dir.masks())?;
    for (query, file) in mask_files(imported) {
        json::write_compact(&dir.mask_file(query), &file)?;
    }
    json::write(&dir.card(), &card)?;
    remove_file(&claim)?;
    Ok(dir.root().to_owned())
}

fn card(identity: &Identity, request: &Request<'_>, imported: &Imported) -> Result<MethodCard, DataError> {
    let profile = request.profile;
    let digest = request.bench.truth_digest(profile)?;
    Ok(MethodCard {
        link: request.preset.link.clone(),
        used: Used { test_view: identity.test_view, depth: identity.depth, ..Used::default() },
        reported: imported.claimed.clone(),
        import: Some(Import {
            format: request.preset.name.clone(),
            assumptions: imported.assumptions.clone(),
            inputs: imported.inputs.clone(),
        }),
        ..MethodCard::new(
            identity.name.clone(),
            &identity.version,
            &request.bench.manifest.version,
            digest,
            profile,
        )
    })
}

fn mask_files(imported: &Imported) -> impl Iterator<Item = (&QueryId, MaskFile)> {
    imported.answers.iter().map(|(query, answers)| {
        let frames = answers.iter().map(|(&frame, mask)| (frame_key(frame), mask.clone())).collect();
        let (width, height) = imported.sizes.get(&query.scene).copied().unwrap_or_default();
        (query, MaskFile { size: [height, width], frames })
    })
}

/// Whether a folder holds these results already: the card, these masks and no other scene.
fn holds(dir: &ResultsDir, card: &MethodCard, imported: &Imported) -> bool {
    let scenes: BTreeSet<&str> = imported.answers.keys().map(|query| query.scene.as_str()).collect();
    json::read::<MethodCard>(&dir.card()).is_ok_and(|found| found == *card)
        && list_folder(&dir.masks()).is_ok_and(|found| found.iter().eq(scenes))
        && mask_files(imported).all(|(query, file)| {
            json::read::<MaskFile>(&dir.mask_file(query)).is_ok_and(|found| found == file)
        })
}

/// A file that is not there is no error.
fn remove_file(path: &Path) -> Result<(), DataError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(DataError::io(path, "remove", source)),
        _ => Ok(()),
    }
}

/// One digest of all files of a scene, by their paths below the root.
pub(super) fn digest(request: &Request<'_>, hits: &[Hit]) -> Result<String, DataError> {
    let mut digest = RunningDigest::default();
    for file in hits.iter().flat_map(|hit| codec::files(request.preset.codec, &hit.path)) {
        let path = file.strip_prefix(&request.root).unwrap_or(&file).display();
        digest.add(format!("{}  {path}\n", sha256_file(&file)?).as_bytes());
    }
    Ok(digest.hex())
}

/// What was taken for granted, in words.
pub(super) fn assumptions(request: &Request<'_>) -> BTreeMap<String, String> {
    let mut assumptions = BTreeMap::new();
    let mut say = |topic: &str, text: String| {
        assumptions.insert(topic.to_owned(), text);
    };
    say("template", request.preset.template.clone());
    say("frames", request.order.to_string());
    say("codec", request.preset.codec.to_string());
    if let Some(latents) = &request.preset.latents {
        let rules = latents.rules;
        let name = if rules.smoothing == Smoothing::Box30 { "box of 30 x 30" } else { "pool of 29 x 29" };
        say("smoothing", format!("{name}, then the majority of 7 x 7"));
        say("threshold", format!("above {:.3} of the range of its own map", (1.0 + rules.threshold) / 2.0));
        say("level", format!("of {:?}, the one with the highest smoothed relevancy", latents.levels));
        let is_gated = request.encoders.time_texts.is_some();
        let gate = if is_gated { "queries that hold at some times, by mean similarity" } else { "none" };
        say("time gate", gate.to_owned());
    } else {
        say("inside", request.reading.inside.to_string());
    }
    let resize = if request.resize { "nearest, predictions only, proportions within 1 %" } else { "refused" };
    say("other sizes", resize.to_owned());
    for (field, value) in &request.choices {
        say(&format!("field {field}"), value.clone());
    }
    assumptions
}
