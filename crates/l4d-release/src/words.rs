//! What is said of the data, in sentences: the same in the data sheet and in the metadata for machines.
//!
//! The sentences are in `templates/words.json`; nothing is claimed that the files do not show.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::benchmark::SetSplit;
use l4d_data::{DataError, Profile, Query, Status};
use serde::Serialize;
use serde_json::{Value, json};

use crate::contents::Contents;
use crate::documents::render;
use crate::gather::Gathered;

/// What the data set is about.
pub(crate) const KEYWORDS: [&str; 6] = [
    "4D language grounding",
    "referring video segmentation",
    "dynamic scenes",
    "Gaussian splatting",
    "synthetic data",
    "benchmark",
];

/// How many queries have which status.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Statuses {
    pub(crate) candidate: usize,
    pub(crate) verified: usize,
    pub(crate) rejected: usize,
}

impl Statuses {
    pub(crate) fn of<'a>(queries: impl Iterator<Item = &'a Query>) -> Self {
        queries.fold(Self::default(), |mut counts, query| {
            match query.status {
                Status::Candidate => counts.candidate += 1,
                Status::Verified => counts.verified += 1,
                Status::Rejected => counts.rejected += 1,
            }
            counts
        })
    }

    pub(crate) fn judged(self) -> usize {
        self.candidate + self.verified
    }
}

/// Field of Croissant's vocabulary for responsible AI -> sentences about a release.
pub(crate) fn of(contents: &Contents, gathered: &Gathered) -> Result<Value, DataError> {
    const FILE: &str = "words.json";
    let statuses = gathered.statuses();
    let captures = gathered.scenes.iter().filter(|scene| scene.tracks.is_none()).count();
    let lacking = |profile: &Profile| !gathered.profiles.contains(profile);
    let annotators: BTreeSet<usize> = contents.rounds.iter().map(|round| round.annotators).collect();
    let values = json!({
        "captures": captures,
        "rendered": gathered.scenes.len() - captures,
        "renders": contents.renders.as_ref().map(|renders| renders.profile),
        "profiles": gathered.profiles,
        "lacking": Profile::ALL.into_iter().filter(lacking).collect::<Vec<_>>(),
        "lacks_full": lacking(&Profile::Full),
        "rounds": contents.rounds,
        "annotators": annotators,
        "statuses": statuses,
        "judged": statuses.judged(),
        "queries": statuses.judged() + statuses.rejected,
        "is_public": is_public(gathered),
    });
    let text = render(FILE, include_str!("../templates/words.json"), &values)?;
    serde_json::from_str(&text)
        .map_err(|error| DataError::format(Path::new(FILE), format!("line {}", error.line()), error))
}

/// Whether the truth is published with the benchmark.
pub(crate) fn is_public(gathered: &Gathered) -> bool {
    gathered.manifest.split != SetSplit::Private
}
