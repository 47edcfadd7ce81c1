//! What a person or a script sees: stdout is data, stderr is talk; errors end with a `hint:`.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Display;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use l4d_data::error::{inert, inert_lines};
use l4d_data::{DataError, Finding, Progress, Report, StageError};
use l4d_endpoint::EndpointError;
use l4d_frames::exr::FrameError;
use serde::Serialize;
use serde_json::{Value, json};

use crate::cli::given::Given;

/// How a verb ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ExitStatus {
    /// Everything went well: exit code 0.
    Success,
    /// A check found problems: exit code 1.
    Findings,
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        match status {
            ExitStatus::Success => Self::SUCCESS,
            ExitStatus::Findings => Self::from(1),
        }
    }
}

/// An `anyhow` error with a hint; `hint:` prints it.
pub(crate) fn refusal(message: impl Into<String>, hint: impl Into<String>) -> anyhow::Error {
    StageError::new(message, hint).into()
}

/// What a verb says whose feature was left out of this build.
#[cfg_attr(
    all(feature = "board", feature = "gpu", feature = "annotate"),
    expect(dead_code, reason = "everything is built in")
)]
pub(crate) fn not_built_in(what: &str, feature: &str) -> anyhow::Error {
    refusal(
        format!("this l4d was built without {what}"),
        format!("build it with `cargo build --release --features {feature}`; all features are on by default"),
    )
}

/// The one place that writes to the terminal, and nothing that steers it.
#[derive(Debug)]
pub(crate) struct Printer {
    quiet: bool,
    given: Given,
    bar: Mutex<ProgressBar>,
    /// When a line of progress was last written into a log.
    logged: Mutex<Instant>,
}

impl Printer {
    /// Hints name the folders that were given.
    pub(crate) fn new(quiet: bool, given: Given) -> Self {
        Self { quiet, given, bar: Mutex::new(ProgressBar::hidden()), logged: Mutex::new(Instant::now()) }
    }

    /// One line of data.
    pub(crate) fn data(&self, line: impl Display) -> Result<(), DataError> {
        let written = writeln!(io::stdout().lock(), "{}", inert_lines(&line.to_string()));
        written.map_err(|source| DataError::io(Path::new("standard output"), "write", source))
    }

    /// One JSON document as data.
    pub(crate) fn json(&self, value: &impl Serialize) -> anyhow::Result<()> {
        self.data(serde_json::to_string_pretty(value)?)?;
        Ok(())
    }

    /// One line of talk.
    pub(crate) fn note(&self, line: impl Display) {
        if !self.quiet {
            self.talk(inert_lines(&self.given.complete(&line.to_string())));
        }
    }

    /// A warning; shown even when quiet.
    pub(crate) fn warn(&self, line: impl Display) {
        self.talk(inert(&self.given.complete(&format!("warning: {line}"))));
    }

    fn talk(&self, line: impl Display) {
        self.bar().suspend(|| writeln!(io::stderr().lock(), "{line}").ok());
    }

    /// How far it is, now and then: a log has no bar.
    fn log(&self, bar: &ProgressBar) {
        let mut logged = self.logged.lock().unwrap_or_else(PoisonError::into_inner);
        if logged.elapsed() >= BETWEEN_LINES_OF_A_LOG {
            *logged = Instant::now();
            self.talk(format!("{} {}/{}", bar.prefix(), bar.position(), bar.length().unwrap_or_default()));
        }
    }

    fn bar(&self) -> ProgressBar {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// How a check ends that found this.
    pub(crate) fn status(report: &Report) -> ExitStatus {
        if report.has_errors() { ExitStatus::Findings } else { ExitStatus::Success }
    }

    /// A JSON document with the findings in it, and how a check ends that found them.
    pub(crate) fn document(&self, mut document: Value, report: Report) -> anyhow::Result<ExitStatus> {
        let status = Self::status(&report);
        document["findings"] = json!(self.sorted(report));
        self.json(&document)?;
        Ok(status)
    }

    /// Prints findings, if there are any, and tells the exit status.
    pub(crate) fn any_findings(&self, report: Report) -> anyhow::Result<ExitStatus> {
        if report.is_empty() { Ok(ExitStatus::Success) } else { self.findings(report, false) }
    }

    /// Prints findings as warnings, and tells the exit status.
    pub(crate) fn warnings(&self, report: Report) -> ExitStatus {
        let status = Self::status(&report);
        for finding in self.sorted(report) {
            self.warn(format!("{}: {}; {}", finding.path, finding.message, finding.hint));
        }
        status
    }

    /// Prints findings, one per line or as JSON, and tells the exit status.
    pub(crate) fn findings(&self, report: Report, as_json: bool) -> anyhow::Result<ExitStatus> {
        let status = Self::status(&report);
        let findings = self.sorted(report);
        if as_json {
            self.json(&json!({ "findings": findings }))?;
            return Ok(status);
        }
        for finding in &findings {
            self.data(format!("{}: {}: {}", place(finding), kind(finding), finding.message))?;
            self.hint(&finding.hint)?;
        }
        self.count(findings.len());
        Ok(status)
    }

    /// Prints findings by cause, one that many files share once, with the first of them; `hint` says how to see all.
    pub(crate) fn causes(&self, report: Report, hint: &str) -> anyhow::Result<ExitStatus> {
        let status = Self::status(&report);
        let (findings, hint) = (self.sorted(report), self.given.complete(hint));
        let of = |finding: &Finding| (finding.code, finding.message.clone(), finding.hint.clone());
        let mut by_cause: BTreeMap<_, Vec<&Finding>> = BTreeMap::new();
        findings.iter().for_each(|finding| by_cause.entry(of(finding)).or_default().push(finding));
        for first in &findings {
            let Some(alike) = by_cause.remove(&of(first)) else { continue };
            if alike.len() <= FIRST_OF_CAUSE {
                for finding in alike {
                    self.data(format!("{}: {}: {}", place(finding), kind(finding), finding.message))?;
                    self.hint(&finding.hint)?;
                }
                continue;
            }
            self.data(format!("{}: {} times: {}", kind(first), alike.len(), first.message))?;
            alike
                .iter()
                .take(FIRST_OF_CAUSE)
                .try_for_each(|finding| self.data(format!("    {}", place(finding))))?;
            self.data(format!("    and {} more; {hint}", alike.len() - FIRST_OF_CAUSE))?;
            self.hint(&first.hint)?;
        }
        self.count(findings.len());
        Ok(status)
    }

    fn sorted(&self, report: Report) -> Vec<Finding> {
        let complete = |finding: Finding| Finding { hint: self.given.complete(&finding.hint), ..finding };
        report.into_sorted().into_iter().map(complete).collect()
    }

    fn hint(&self, hint: &str) -> Result<(), DataError> {
        if hint.is_empty() { Ok(()) } else { self.data(format!("    hint: {hint}")) }
    }

    fn count(&self, findings: usize) {
        self.note(format!("{findings} finding{}", if findings == 1 { "" } else { "s" }));
    }

    /// The error chain on one line, then the hint.
    pub(crate) fn failure(&self, error: &anyhow::Error) {
        let mut stderr = io::stderr().lock();
        writeln!(stderr, "error: {}", inert_lines(&format!("{error:#}"))).ok();
        if let Some(hint) = hint_of(error) {
            writeln!(stderr, "\nhint: {}", inert_lines(&self.given.complete(&hint))).ok();
        }
    }
}

const BETWEEN_LINES_OF_A_LOG: Duration = Duration::from_secs(30);
/// Findings of one cause that are shown.
const FIRST_OF_CAUSE: usize = 3;

/// The file, and where in it.
fn place(finding: &Finding) -> String {
    let Finding { path, location, .. } = finding;
    if location.is_empty() { path.clone() } else { format!("{path}: {location}") }
}

fn kind(finding: &Finding) -> String {
    let severity = match finding.severity {
        l4d_data::Severity::Error => "error",
        l4d_data::Severity::Warning => "warning",
    };
    format!("{severity}[{}]", finding.code)
}

/// A bar with elapsed time and ETA on a terminal, a line every half minute elsewhere, unless quiet; lines of talk go above
/// the bar.
impl Progress for Printer {
    fn start(&self, what: &'static str, total: u64) {
        let hidden = self.quiet || !io::stderr().is_terminal();
        let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(total), target);
        let template = "{spinner} {prefix:>10} [{bar:20}] {pos}/{len} {elapsed} eta {eta} {wide_msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_prefix(what);
        bar.enable_steady_tick(Duration::from_millis(250));
        *self.bar.lock().unwrap_or_else(PoisonError::into_inner) = bar;
    }

    fn item(&self, name: &dyn Display) {
        self.bar().set_message(inert(&name.to_string()));
    }

    fn advance(&self, steps: u64) {
        let bar = self.bar();
        let is_resumed = bar.position() == 0 && steps > 1;
        bar.inc(steps);
        if is_resumed {
            // What an earlier run did says nothing of how fast this one is.
            bar.reset_eta();
        }
        if !self.quiet && !io::stderr().is_terminal() {
            self.log(&bar);
        }
    }

    fn finish(&self) {
        self.bar().finish_and_clear();
    }

    fn note(&self, line: &dyn Display) {
        Self::note(self, line);
    }

    fn warn(&self, line: &dyn Display) {
        Self::warn(self, line);
    }
}

/// Sends `tracing` to stderr; `RUST_LOG` overrides the level.
pub(crate) fn init_logging(verbose: bool) {
    let default = if verbose { "l4d=debug,info" } else { "warn" };
    let filter = tracing_subscriber::EnvFilter::try_from_default_env()
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new(default));
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(io::stderr).without_time().init();
}

/// Rows of a table, the first of them its head, in columns as wide as they need; columns of numbers end at the right.
pub(crate) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let cells = |column: usize| rows.iter().map(move |row| row[column].as_str());
    let width = |column| cells(column).map(|cell| cell.chars().count()).max().unwrap_or(0);
    let is_number =
        |cell: &str| cell.starts_with(|first: char| first.is_ascii_digit() || "+-?".contains(first));
    let layout: Vec<(usize, bool)> =
        (0..columns).map(|column| (width(column), cells(column).skip(1).all(is_number))).collect();
    let line = |row: &Vec<String>| {
        let padded = row.iter().zip(&layout).map(|(cell, &(width, to_right))| {
            // Widths of format strings end at 65 535.
            let space = " ".repeat(width - cell.chars().count());
            if to_right { space + cell } else { cell.clone() + &space }
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// Whether the reader of our output went away (`l4d ... | head`).
pub(crate) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
    })
}

/// What the user can do about an error.
pub(crate) fn hint_of(error: &anyhow::Error) -> Option<String> {
    error.chain().find_map(|cause| {
        let refusal = cause.downcast_ref::<StageError>().map(|error| error.hint().to_owned());
        let data = || cause.downcast_ref::<DataError>().map(|error| error.hint().to_owned());
        let frame = || Some(cause.downcast_ref::<FrameError>()?.data_error().hint().to_owned());
        let endpoint = || cause.downcast_ref::<EndpointError>().map(|error| error.hint().to_owned());
        let board = || hint_of_board(cause);
        let system = || {
            let kind = cause.downcast_ref::<io::Error>()?.kind();
            Some(DataError::io(Path::new(""), "", kind.into()).hint().to_owned())
        };
        refusal.or_else(data).or_else(frame).or_else(endpoint).or_else(board).or_else(system)
    })
}

#[cfg(feature = "board")]
fn hint_of_board(cause: &(dyn Error + 'static)) -> Option<String> {
    match cause.downcast_ref()? {
        l4d_board::BoardError::Data(error) => Some(error.hint().to_owned()),
        _ => None,
    }
}

#[cfg(not(feature = "board"))]
fn hint_of_board(_: &(dyn Error + 'static)) -> Option<String> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_of_any_length_is_laid_out() {
        let long = "ä".repeat(70_000);
        let row = |first: &str, second: &str| vec![first.to_owned(), second.to_owned()];
        let text = table(&[row("sentence", "n"), row(&long, "7"), row("short", "12")]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], format!("{long}   7"));
        assert_eq!(lines[2], format!("short{}12", " ".repeat(70_000 - 5 + 2)));
    }
}
