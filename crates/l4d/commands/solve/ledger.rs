//! What was answered and what it took, for people and scripts.

use std::collections::BTreeMap;

use anyhow::Result;
use l4d_data::{Name, Query};
use l4d_solve::account::{Account, Entry, Stage};
use l4d_solve::consensus::Decision;
use l4d_solve::solve::Record;
use serde::Serialize;
use serde_json::{Value, json};

use crate::out::Printer;

/// Stages, in the order of the work, with what people call them.
const STAGES: [(Stage, &str); 5] = [
    (Stage::Clips, "clips"),
    (Stage::Grounding, "grounding"),
    (Stage::Consensus, "consensus"),
    (Stage::Lifting, "lifting"),
    (Stage::Masks, "masks"),
];

#[derive(Debug, Default)]
pub(super) struct Ledger {
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
    pub(super) fn seconds(&self) -> f64 {
        self.entries.iter().map(|entry| entry.seconds).sum()
    }

    pub(super) fn print(&self, name: &Name, as_json: bool, out: &Printer) -> Result<()> {
        if as_json {
            return out.json(&self.document(name));
        }
        out.data(format!("{:<12} {:>9} {:>12} {:>12}", "stage", "seconds", "s a query", "peak MB"))?;
        for (stage, word) in STAGES {
            let (seconds, peak) = self.of_stage(stage);
            let each = seconds / self.queries.max(1) as f64;
            let peak = peak.map_or_else(|| "-".to_owned(), |bytes| format!("{:.0}", bytes as f64 * 1e-6));
            out.data(format!("{word:<12} {seconds:>9.1} {each:>12.3} {peak:>12}"))?;
        }
        Ok(())
    }

    /// What was decided, and what is left to do.
    pub(super) fn talk(&self, out: &Printer) {
        out.note(format!("{} queries: {}", self.queries, listed(&self.decisions)));
        out.note(format!("views: {}", listed(&self.outcomes)));
        if let Some(first) = self.incomplete.first() {
            out.warn(format!(
                "{} queries have views that did not answer, {first} for one; run the command again to ask them again",
                self.incomplete.len()
            ));
        }
    }

    fn document(&self, name: &Name) -> Value {
        let stage = |(stage, word): &(Stage, &str)| {
            let (seconds, peak_memory_bytes) = self.of_stage(*stage);
            ((*word).to_owned(), json!({ "seconds": seconds, "peak_memory_bytes": peak_memory_bytes }))
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

/// A decision as files write it.
fn word(decision: Decision) -> String {
    #[derive(Serialize)]
    struct Wrapped(Decision);
    serde_json::to_value(Wrapped(decision))
        .ok()
        .and_then(|value| value.as_str().map(str::to_owned))
        .unwrap_or_default()
}

fn listed(counts: &BTreeMap<String, usize>) -> String {
    let parts: Vec<String> =
        counts.iter().map(|(word, count)| format!("{count} {}", word.replace('_', " "))).collect();
    if parts.is_empty() { "none".to_owned() } else { parts.join(", ") }
}
