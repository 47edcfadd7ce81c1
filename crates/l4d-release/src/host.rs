//! The forms in which platforms host a benchmark: what Codabench and the Hugging Face Hub take.
//!
//! A form is a list of files, made in memory: reference data are the benchmark's own files, the scoring program
//! (`host/score.py`) calls the Python package l4d.

mod codabench;
mod huggingface;
mod zip;

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::benchmark::SetSplit;
use l4d_data::results::{MaskFile, MethodCard, Track, Used};
use l4d_data::store::{Claim, FolderLock, folder_of, write_atomic};
use l4d_data::truth::Truth;
use l4d_data::truth::frame_key;
use l4d_data::{DataError, Name, Profile, Query, Status};
use serde::Serialize;
use serde_json::{Value, json};

pub use self::codabench::codabench;
pub use self::huggingface::{Entry, huggingface};
use crate::contents::Publication;
use crate::day::Day;
use crate::documents::{licence_url, split};
use crate::gather::{Gathered, SceneFacts};
use crate::inspect::files_below;
use crate::version::MANIFEST;
use crate::words::{Statuses, is_public};

/// The mark of the project.
const LOGO: &[u8] = include_bytes!("../host/logo.png");

/// Path in a folder -> bytes.
pub type Files = BTreeMap<String, Vec<u8>>;

/// What is hosted.
#[derive(Debug)]
pub struct Hosted<'a> {
    pub gathered: &'a Gathered,
    /// Whose truth counts.
    pub profile: Profile,
    /// [`l4d_data::Benchmark::truth_digest`] of that profile.
    pub truth_digest: &'a str,
}

/// When and where a platform takes submissions.
#[derive(Debug)]
pub struct Competition {
    /// First day, page of the data set, who made it.
    pub publication: Publication,
    /// Last day; none: it doesn't end.
    pub until: Option<Day>,
    /// Whose methods compete: platforms rank all that they take with each other.
    pub track: Track,
}

impl Hosted<'_> {
    /// The scenes that have truth of the profile.
    fn scenes(&self) -> impl Iterator<Item = (&SceneFacts, &Truth)> {
        self.gathered.scenes.iter().filter_map(|scene| Some((scene, scene.truths.get(&self.profile)?)))
    }

    /// What templates speak of.
    fn values(&self) -> Value {
        let manifest = &self.gathered.manifest;
        let statuses = Statuses::of(self.scenes().flat_map(|(scene, _)| &scene.queries));
        json!({
            "name": manifest.name,
            "version": manifest.version,
            "licence": manifest.licence,
            "licence_url": licence_url(&manifest.licence),
            "profile": self.profile,
            "truth_digest": self.truth_digest,
            "split": split(self.gathered),
            "is_public": is_public(self.gathered),
            "is_dev": manifest.split == SetSplit::Dev,
            "scenes": self.scenes().count(),
            "judged": statuses.judged(),
            "verified": statuses.verified,
            "columns": COLUMNS,
        })
    }

    /// The same with what a platform has to know of the competition.
    fn values_of(&self, competition: &Competition) -> Value {
        let mut values = self.values();
        values["publication"] = json!(competition.publication);
        values["until"] = json!(competition.until);
        values["track"] = competition.track.as_str().into();
        values["track_title"] = competition.track.title().into();
        values["takes_depth"] = (competition.track == Track::ColourDepth).into();
        values
    }

    /// Reference data: `benchmark/` with what scoring needs, and `competition.json`.
    fn reference(&self, track: Track) -> Result<Files, DataError> {
        let competition = json!({ "profile": self.profile, "track": track });
        let mut files =
            Files::from([("competition.json".to_owned(), format!("{competition:#}\n").into_bytes())]);
        let truth = format!("benchmark/truth/{}/", self.profile);
        let common = self.gathered.files.iter().filter(|source| source.name == MANIFEST);
        let judged = self.scenes().flat_map(|(scene, _)| {
            let queries = format!("benchmark/queries/{}.jsonl", scene.name);
            scene.files.iter().filter(move |source| source.name == queries)
        });
        let truths = self
            .scenes()
            .flat_map(|(scene, _)| &scene.files)
            .filter(|source| source.name.starts_with(&truth));
        for source in common.chain(judged).chain(truths) {
            files.insert(source.name.clone(), read(&source.path)?);
        }
        Ok(files)
    }

    /// A sound submission that finds nothing anywhere: the format by example.
    fn example(&self, track: Track) -> Result<Files, DataError> {
        let name = Name::new("absent-everywhere").map_err(|error| unwritable("method.json", &error))?;
        let version = &self.gathered.manifest.version;
        let used = Used { depth: track == Track::ColourDepth, ..Used::default() };
        let card =
            MethodCard { used, ..MethodCard::new(name, "1", version, self.truth_digest, self.profile) };
        let mut files = Files::from([("method.json".to_owned(), pretty("method.json", &card)?)]);
        for (scene, truth) in self.scenes() {
            let asked = |query: &&Query| query.status != Status::Rejected;
            for query in scene.queries.iter().filter(asked) {
                let frames = truth.frames.iter().map(|&frame| (frame_key(frame), None)).collect();
                let file = format!("masks/{}/{}.json", scene.name, query.id.number);
                let masks = MaskFile { size: [truth.height, truth.width], frames };
                files.insert(file.clone(), pretty(&file, &masks)?);
            }
        }
        Ok(files)
    }
}

/// A column of a leaderboard.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct LeaderboardColumn {
    /// Key of `scores.json`.
    key: &'static str,
    title: &'static str,
    about: &'static str,
    is_lower_better: bool,
}

const fn shown(key: &'static str, title: &'static str, about: &'static str) -> LeaderboardColumn {
    LeaderboardColumn { key, title, about, is_lower_better: false }
}

/// What leaderboards show, the headline first; percent.
const COLUMNS: [LeaderboardColumn; 11] = [
    shown("miou", "mIoU", "mean over queries of the mean IoU over frames that show the target"),
    shown("tube_iou", "tube IoU", "intersections over unions, summed over all frames, so that time matters"),
    shown("select", "select", "share of queries whose most-overlapped instance is the referent"),
    shown("macc", "mAcc", "share of those frames with any overlap"),
    shown("acc25", "Acc@0.25", "share of those frames with IoU above 0.25"),
    shown("acc50", "Acc@0.5", "share of those frames with IoU above 0.5"),
    LeaderboardColumn {
        is_lower_better: true,
        ..shown("fpr", "false positives", "share of frames without a target in which something was marked")
    },
    shown("miou_attribute", "attribute", "mIoU of attribute queries"),
    shown("miou_action", "action", "mIoU of action queries"),
    shown("miou_spatial", "spatial", "mIoU of spatial queries"),
    shown("miou_interaction", "interaction", "mIoU of interaction queries"),
];

/// Writes a form into a folder of its own. A folder that holds anything else is refused: a platform would take it in.
/// For the same reason the list of what was written is beside it.
///
/// # Errors
/// If the folder holds other files, or, unless `force`, files that l4d did not write; if another run writes into it, or it
/// cannot be written.
pub fn write(folder: &Path, files: &Files, force: bool) -> Result<(), DataError> {
    let _lock = FolderLock::take(folder)?;
    let there = files_below(folder, &mut l4d_data::Report::default())?;
    if let Some(other) = there.iter().find(|name| !files.contains_key(*name)) {
        let message = format!("holds {other}, which is no part of it");
        return Err(DataError::invalid(folder, "folder", message, "empty it, or choose another --out"));
    }
    let place = folder.canonicalize().map_err(|source| DataError::io(folder, "open the folder", source))?;
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    let names = files.keys().map(|file| format!("{name}/{file}")).collect();
    let _claim = Claim::take(folder_of(&place), names, None, force)?;
    files.iter().try_for_each(|(name, bytes)| write_atomic(&folder.join(name), bytes))
}

fn read(path: &Path) -> Result<Vec<u8>, DataError> {
    std::fs::read(path).map_err(|error| DataError::io(path, "read", error))
}

fn pretty(name: &str, value: &impl Serialize) -> Result<Vec<u8>, DataError> {
    let text = serde_json::to_string_pretty(value).map_err(|error| unwritable(name, &error))?;
    Ok(format!("{text}\n").into_bytes())
}

fn unwritable(name: &str, error: &dyn std::fmt::Display) -> DataError {
    DataError::format(Path::new(name), "document", error)
}

/// The files with a folder before each name.
fn below(folder: &str, files: Files) -> impl Iterator<Item = (String, Vec<u8>)> {
    files.into_iter().map(move |(name, bytes)| (format!("{folder}/{name}"), bytes))
}

#[cfg(test)]
mod tests {
    use l4d_data::{Benchmark, Report};

    use super::*;
    use crate::documents::render;
    use crate::gather::gather;

    #[test]
    fn what_is_private_is_not_called_public() {
        let bench = Benchmark::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark/dev")).unwrap();
        let mut report = Report::default();
        let mut gathered = gather(&bench, &mut report).unwrap();
        assert!(report.is_empty());
        let publication = Publication {
            date: "2026-11-22".parse().unwrap(),
            url: "https://example.org".to_owned(),
            creators: vec!["A".to_owned()],
        };
        let competition = Competition { publication, until: None, track: Track::Colour };
        let mut says_public = |split: SetSplit| {
            gathered.manifest.split = split;
            let hosted = Hosted { gathered: &gathered, profile: Profile::Tiny, truth_digest: "0" };
            let page = include_str!("../templates/codabench/evaluation.md");
            render("evaluation.md", page, &hosted.values_of(&competition))
                .unwrap()
                .contains("The truth is public")
        };
        assert!(says_public(SetSplit::Test));
        assert!(!says_public(SetSplit::Private));
    }
}
