//! Why a proposal was not taken: like a finding, but of a proposal, which is in no file of the benchmark.

use l4d_data::{Finding, Report, Severity};
use serde::Serialize;

/// One reason, with the stable code of a finding (`docs/findings.md`).
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// Stable code.
    pub code: &'static str,
    /// Which part of the proposal.
    pub field: String,
    /// What is wrong.
    pub message: String,
    /// What a person can do about it.
    pub hint: String,
}

impl Reason {
    /// A reason.
    pub fn new(
        code: &'static str,
        field: impl Into<String>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self { code, field: field.into(), message: message.into(), hint: hint.into() }
    }
}

/// The errors of a check of one query as reasons.
pub(crate) fn reasons_of(report: Report) -> Vec<Reason> {
    let errors = report.into_sorted().into_iter().filter(|finding| finding.severity == Severity::Error);
    errors
        .map(|Finding { code, message, hint, .. }| Reason::new(code, field_of(code), message, hint))
        .collect()
}

/// The part of a query that a finding of `check-queries` speaks of.
fn field_of(code: &str) -> &'static str {
    match code {
        "L4D202" | "L4D210" => "referents",
        "L4D206" => "frames",
        "L4D207" => "category",
        "L4D213" | "L4D214" | "L4D215" | "L4D216" => "text",
        _ => "predicate",
    }
}
