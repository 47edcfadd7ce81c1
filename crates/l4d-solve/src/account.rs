//! What each stage of an answer took: seconds of wall time, and the most memory that the process had by its end.

use std::time::Instant;

use l4d_data::stage::peak_memory_bytes;
use serde::{Deserialize, Serialize};

/// A stage, in the order of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Stage {
    /// Drawing and reading of clips.
    Clips,
    /// The grounder, all views.
    Grounding,
    /// Multi-view semantic consensus.
    Consensus,
    /// 4D lifting.
    Lifting,
    /// Masks of the cameras that were asked for.
    Masks,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    pub(crate) stage: Stage,
    pub(crate) seconds: f64,
    /// The most memory of the process since it began; null where the system does not tell.
    pub(crate) peak_memory_bytes: Option<u64>,
}

/// The stages of one answer.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Account(pub(crate) Vec<Entry>);

impl Account {
    /// Does the work of a stage, and notes what it took.
    pub(crate) fn of<T>(&mut self, stage: Stage, work: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let result = work();
        let seconds = begin.elapsed().as_secs_f64();
        self.0.push(Entry { stage, seconds, peak_memory_bytes: peak_memory_bytes() });
        result
    }

    /// Seconds of all of it.
    pub(crate) fn seconds(&self) -> f64 {
        self.0.iter().map(|entry| entry.seconds).sum()
    }
}

/// A variant without fields, as files write it.
pub(crate) fn word(variant: impl Serialize) -> String {
    let value = serde_json::to_value(variant).unwrap_or_default();
    value.as_str().unwrap_or_default().to_owned()
}
