//! What `--dry-run` prints: what a model server would be asked, and what that may cost.

use anyhow::Result;
use l4d_data::Report;
use l4d_endpoint::{Endpoint, Plan};
use serde_json::json;

use super::propose_prompts::about;
use crate::out::{ExitStatus, Printer};

/// Prints plans, one row each, called `what`.
pub(super) fn print(
    what: &'static str,
    plans: &[(String, Plan)],
    endpoint: &Endpoint,
    as_json: bool,
    report: Report,
    out: &Printer,
) -> Result<ExitStatus> {
    let mut total = Plan::default();
    plans.iter().for_each(|(_, plan)| total += *plan);
    if as_json {
        let failed = report.has_errors();
        let rows: Vec<_> = plans.iter().map(|(name, plan)| json!({ what: name, "plan": plan })).collect();
        out.json(&json!({
            "dry_run": true,
            "endpoint": about(endpoint),
            "plans": rows,
            "total": total,
            "findings": report.into_sorted(),
        }))?;
        return Ok(if failed { ExitStatus::Findings } else { ExitStatus::Success });
    }
    let width = plans.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max(what.len());
    out.data(format!(
        "{what:width$}{:>11}{:>10}{:>10}{:>12}{:>16}{:>16}{:>12}",
        "questions", "kept", "pictures", "bytes", "question tokens", "answer tokens", "cost up to"
    ))?;
    let row = |name: &str, plan: &Plan| {
        let cost = plan.cost.map_or_else(|| "?".to_owned(), |cost| format!("{cost:.4}"));
        let Plan { questions, kept, images, bytes, tokens, .. } = plan;
        let (prompt, completion) = (tokens.prompt, tokens.completion);
        out.data(format!(
            "{name:width$}{questions:>11}{kept:>10}{images:>10}{bytes:>12}{prompt:>16}{completion:>16}{cost:>12}"
        ))
    };
    plans.iter().try_for_each(|(name, plan)| row(name, plan))?;
    row("all", &total)?;
    out.note("nothing was sent; tokens are estimates, those of answers the most that they may have");
    match report.is_empty() {
        true => Ok(ExitStatus::Success),
        false => out.findings(report, false),
    }
}
