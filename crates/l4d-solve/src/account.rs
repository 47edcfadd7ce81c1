//! What each stage of an answer took: seconds of wall time, and the most memory that the process had by its end.

use std::time::Instant;

use l4d_data::stage::peak_memory_bytes;
use serde::{Deserialize, Serialize};

/// A stage, in the order of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
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

impl Stage {
    /// As files write it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Clips => "clips",
            Self::Grounding => "grounding",
            Self::Consensus => "consensus",
            Self::Lifting => "lifting",
            Self::Masks => "masks",
        }
    }
}

/// One stage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Which.
    pub stage: Stage,
    /// Wall time.
    pub seconds: f64,
    /// The most memory of the process since it began; null where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
}

/// The stages of one answer.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Account(pub Vec<Entry>);

impl Account {
    /// Does the work of a stage, and notes what it took.
    pub fn of<T>(&mut self, stage: Stage, work: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let result = work();
        let seconds = begin.elapsed().as_secs_f64();
        self.0.push(Entry { stage, seconds, peak_memory_bytes: peak_memory_bytes() });
        result
    }

    /// All of it.
    pub fn seconds(&self) -> f64 {
        self.0.iter().map(|entry| entry.seconds).sum()
    }

    /// Seconds of one stage.
    pub fn seconds_of(&self, stage: Stage) -> f64 {
        self.0.iter().filter(|entry| entry.stage == stage).map(|entry| entry.seconds).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_told_apart_and_add_up() {
        let mut account = Account::default();
        let three = account.of(Stage::Grounding, || 3);
        account.of(Stage::Lifting, || std::thread::sleep(std::time::Duration::from_millis(20)));
        assert_eq!(three, 3);
        assert!(account.seconds_of(Stage::Lifting) >= 0.02);
        assert_eq!(account.seconds_of(Stage::Masks), 0.0);
        let sum = account.seconds_of(Stage::Grounding) + account.seconds_of(Stage::Lifting);
        assert!((account.seconds() - sum).abs() < 1e-9);
    }
}
