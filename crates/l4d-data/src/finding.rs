//! Findings: what a check reports. A check collects every problem instead of stopping at the first. Knows no codes but
//! its own: those are where the problems are found.

use std::path::Path;

use serde::Serialize;

use crate::error::{DataError, inert};

/// More findings than this are counted and not kept: no one reads them, and untrusted files must not fill the
/// memory with them.
pub const MAX_FINDINGS: usize = 10_000;

/// Code of the finding that says how many were not kept.
pub const NOT_LISTED: &str = "L4D001";

/// How bad a finding is. Errors make a check fail, warnings do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The check fails.
    Error,
    /// The check passes; a person should look at it.
    Warning,
}

/// One problem, with a stable code that scripts may rely on (`docs/findings.md` lists them).
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Finding {
    /// File or folder.
    pub path: String,
    /// Field, line, view, frame or entry inside it.
    #[serde(rename = "where")]
    pub location: String,
    /// Stable code, `L4D` and three digits.
    pub code: &'static str,
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub hint: String,
}

/// All findings of a check.
#[derive(Debug, Default, Clone)]
pub struct Report {
    findings: Vec<Finding>,
    /// Number of findings beyond [`MAX_FINDINGS`].
    unlisted: usize,
    /// Whether one of those was an error.
    has_unlisted_error: bool,
}

impl Report {
    /// Adds an error.
    pub fn error(
        &mut self,
        code: &'static str,
        path: &Path,
        location: impl Into<String>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) {
        self.push(Severity::Error, code, path, location.into(), message.into(), hint.into());
    }

    /// Adds a warning.
    pub fn warning(
        &mut self,
        code: &'static str,
        path: &Path,
        location: impl Into<String>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) {
        self.push(Severity::Warning, code, path, location.into(), message.into(), hint.into());
    }

    /// Adds an error with which reading a file failed.
    pub fn data_error(&mut self, code: &'static str, error: &DataError) {
        let (location, message) = error.place_and_message();
        self.push(Severity::Error, code, error.path(), location, message, error.hint().to_owned());
    }

    /// Adds the findings of another report, and its count of those that were not kept.
    pub fn extend(&mut self, other: Report) {
        self.unlisted += other.unlisted;
        self.has_unlisted_error |= other.has_unlisted_error;
        other.findings.into_iter().for_each(|finding| self.add(finding));
    }

    /// Adds a finding; beyond [`MAX_FINDINGS`] it is counted only.
    pub fn add(&mut self, finding: Finding) {
        if self.findings.len() < MAX_FINDINGS {
            self.findings.push(finding);
        } else {
            self.unlisted += 1;
            self.has_unlisted_error |= finding.severity == Severity::Error;
        }
    }

    /// The findings, sorted by path, then location. If some were not kept, a last finding says how many.
    pub fn into_sorted(mut self) -> Vec<Finding> {
        self.findings.sort();
        if self.unlisted > 0 {
            self.findings.push(Finding {
                path: String::new(),
                location: "findings".to_owned(),
                code: NOT_LISTED,
                severity: if self.has_unlisted_error { Severity::Error } else { Severity::Warning },
                message: format!("{} more are not listed", self.unlisted),
                hint: "mend those above and look again".to_owned(),
            });
        }
        self.findings
    }

    /// Whether at least one finding is an error.
    pub fn has_errors(&self) -> bool {
        self.has_unlisted_error || self.findings.iter().any(|finding| finding.severity == Severity::Error)
    }

    /// Number of findings of any severity.
    pub fn len(&self) -> usize {
        self.findings.len() + self.unlisted
    }

    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.findings.is_empty()
    }

    fn push(
        &mut self,
        severity: Severity,
        code: &'static str,
        path: &Path,
        location: String,
        message: String,
        hint: String,
    ) {
        // Names come from untrusted files: their control characters must not reach a terminal, and their line breaks
        // must not begin what looks like another finding.
        self.add(Finding {
            path: inert(&path.display().to_string()),
            location: inert(&location),
            code,
            severity,
            message: inert(&message),
            hint: inert(&hint),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::is_hidden;

    #[test]
    fn findings_beyond_the_bound_are_counted_and_still_fail() {
        let mut report = Report::default();
        (0..MAX_FINDINGS).for_each(|_| report.warning("L4D999", Path::new("x"), "", "odd", ""));
        assert!(!report.has_errors());
        let mut other = Report::default();
        (0..3).for_each(|_| other.error("L4D998", Path::new("x"), "", "bad", ""));
        report.extend(other);
        assert!(report.has_errors());
        assert_eq!(report.len(), MAX_FINDINGS + 3);
        let found = report.into_sorted();
        let last = found.last().unwrap();
        assert_eq!((found.len(), last.code, last.severity), (MAX_FINDINGS + 1, NOT_LISTED, Severity::Error));
        assert!(last.message.starts_with("3 more"), "{last:?}");
    }

    #[test]
    fn control_characters_in_names_do_not_reach_a_terminal() {
        let mut report = Report::default();
        let name = Path::new("a\u{1b}]0;gotcha\u{7}\n0 findings");
        report.error("L4D998", name, "frame \u{9b}2J\nb", "bad \u{1b}[2J", "mend \u{202e}[2J");
        let found = report.into_sorted().remove(0);
        assert!(found.path.contains("gotcha"), "{found:?}");
        for text in [found.path, found.location, found.message, found.hint] {
            assert!(!text.contains(is_hidden), "{text:?}");
        }
    }
}
