//! What was answered and what it took, for people and scripts.

use std::collections::BTreeMap;

use l4d_data::{Name, Progress, Query};
use serde_json::{Value, json};

use crate::account::{Account, Entry, Stage, word};
use crate::solve::Record;

/// In the order of the work.
const STAGES: [Stage; 5] = [Stage::Clips, Stage::Grounding, Stage::Consensus, Stage::Lifting, Stage::Masks];

/// What a run answered, or found answered.
#[derive(Debug, Default)]
pub struct Ledger {
    entries: Vec<Entry>,
    decisions: BTreeMap<String, usize>,
    outcomes: BTreeMap<String, usize>,
    queries: usize,
    incomplete: Vec<String>,
}

impl Ledger {
    pub(super) fn add_scene(&mut self, account: Account) {
        self.entries.extend(account.0);
    }

    pub(super) fn add(&mut self, query: &Query, record: Record) {
        self.queries += 1;
        *self.decisions.entry(word(record.decision)).or_default() += 1;
        for outcome in record.outcomes.into_values() {
            *self.outcomes.entry(outcome).or_default() += 1;
        }
        if !record.is_complete {
            self.incomplete.push(query.id.to_string());
        }
        self.entries.extend(record.account.0);
    }

    /// Wall time of everything, seconds.
    pub fn seconds(&self) -> f64 {
        self.entries.iter().map(|entry| entry.seconds).sum()
    }

    /// Time and memory per stage, for a terminal.
    pub fn table(&self) -> String {
        let mut lines =
            vec![format!("{:<12} {:>9} {:>12} {:>12}", "stage", "seconds", "s per query", "peak MB")];
        for stage in STAGES {
            let (seconds, peak) = self.of_stage(stage);
            let each = seconds / self.queries.max(1) as f64;
            let peak = peak.map_or_else(|| "-".to_owned(), |bytes| format!("{:.0}", bytes as f64 * 1e-6));
            lines.push(format!("{:<12} {seconds:>9.1} {each:>12.3} {peak:>12}", word(stage)));
        }
        lines.join("\n")
    }

    /// What was decided, and what is left to do.
    pub fn tell(&self, progress: &dyn Progress) {
        progress.note(&format_args!("{} queries: {}", self.queries, listed(&self.decisions)));
        progress.note(&format_args!("views: {}", listed(&self.outcomes)));
        if let Some(first) = self.incomplete.first() {
            progress.warn(&format_args!(
                "{} queries have views that did not answer, {first} for one; run the command again to ask them again",
                self.incomplete.len()
            ));
        }
    }

    /// The same as JSON.
    pub fn document(&self, name: &Name) -> Value {
        let stage = |stage: &Stage| {
            let (seconds, peak_memory_bytes) = self.of_stage(*stage);
            (word(stage), json!({ "seconds": seconds, "peak_memory_bytes": peak_memory_bytes }))
        };
        json!({
            "method": name,
            "queries": self.queries,
            "decisions": self.decisions,
            "views": self.outcomes,
            "incomplete": self.incomplete,
            "stages": STAGES.iter().map(stage).collect::<serde_json::Map<_, _>>(),
        })
    }

    fn of_stage(&self, stage: Stage) -> (f64, Option<u64>) {
        let of_it = || self.entries.iter().filter(|entry| entry.stage == stage);
        (of_it().map(|entry| entry.seconds).sum(), of_it().filter_map(|entry| entry.peak_memory_bytes).max())
    }
}

fn listed(counts: &BTreeMap<String, usize>) -> String {
    let parts: Vec<String> =
        counts.iter().map(|(word, count)| format!("{count} {}", word.replace('_', " "))).collect();
    if parts.is_empty() { "none".to_owned() } else { parts.join(", ") }
}
