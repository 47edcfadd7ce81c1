//! Findings: what a check reports. A check collects every problem instead of stopping at the first.

use std::path::Path;

use serde::Serialize;

use crate::error::DataError;

/// How bad a finding is. Errors make a check fail, warnings do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The check fails.
    Error,
    /// Worth a look.
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
    /// Error or warning.
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub hint: String,
}

/// All findings of a check.
#[derive(Debug, Default, Clone)]
pub struct Report {
    findings: Vec<Finding>,
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

    /// Adds what a reader refused.
    pub fn data_error(&mut self, code: &'static str, error: &DataError) {
        let (location, message) = match error {
            DataError::Io { action, source, .. } => (String::new(), format!("cannot {action}: {source}")),
            DataError::Format { location, message, .. } | DataError::Invalid { location, message, .. } => {
                (location.clone(), message.clone())
            }
        };
        let hint = error.hint().unwrap_or_default();
        self.push(Severity::Error, code, error.path(), location, message, hint);
    }

    /// Takes over the findings of another report.
    pub fn extend(&mut self, other: Report) {
        self.findings.extend(other.findings);
    }

    /// Takes over a finding of another check.
    pub fn add(&mut self, finding: Finding) {
        self.findings.push(finding);
    }

    /// The findings, sorted by path, then place.
    pub fn into_sorted(mut self) -> Vec<Finding> {
        self.findings.sort();
        self.findings
    }

    /// Whether at least one finding is an error.
    pub fn has_errors(&self) -> bool {
        self.findings.iter().any(|finding| finding.severity == Severity::Error)
    }

    /// Number of findings of any severity.
    pub fn len(&self) -> usize {
        self.findings.len()
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
        self.findings.push(Finding {
            path: path.display().to_string(),
            location,
            code,
            severity,
            message,
            hint,
        });
    }
}
