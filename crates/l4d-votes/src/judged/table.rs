//! A verdict as aligned text, at most 100 columns wide but for what people wrote.

use std::collections::BTreeSet;

use l4d_data::{Category, Status};

use super::JudgedRound;
use super::statuses::StatusChange;
use crate::agreement::{Agreement, Annotator, Coefficients, Group};
use crate::control::Consistency;
use crate::verdict::{ItemVerdict, Outcome};

const NAME_WIDTH: usize = 14;
const LEGEND: &str =
    "a letter each: + right, x other objects, 0 none, ? ambiguous, t other frames, s skipped";

/// Per category, per annotator, and what was rejected.
pub fn render(judged: &JudgedRound, agreement: &Agreement) -> String {
    let of = |category: &Category| {
        let all = judged.verdicts.items.iter();
        all.filter(|verdict| verdict.categories.contains(category)).collect::<Vec<&ItemVerdict>>()
    };
    let mut groups: Vec<(&str, Vec<&ItemVerdict>, &Group)> = agreement
        .categories
        .iter()
        .map(|(category, group)| (category.as_str(), of(category), group))
        .collect();
    groups.push(("all", judged.verdicts.items.iter().collect(), &agreement.overall));
    let mut lines = heading(judged);
    lines.push(String::new());
    lines.push(format!(
        "{:NAME_WIDTH$}{:>8}{:>8}{:>10}{:>12}{:>8}",
        "verdicts", "items", "valid", "rejected", "incomplete", "stale"
    ));
    for (name, verdicts, _) in &groups {
        let count = |outcome| verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
        let [valid, rejected, incomplete, stale] = Outcome::ALL.map(count);
        let items = verdicts.len();
        lines.push(format!("{name:NAME_WIDTH$}{items:>8}{valid:>8}{rejected:>10}{incomplete:>12}{stale:>8}"));
    }
    lines.push(String::new());
    lines.push(format!("{:NAME_WIDTH$}{:>22}{:>22}{:>22}", "agreement", "raw", "alpha", "AC1"));
    for (name, _, group) in &groups {
        let Coefficients { raw, alpha, ac1, .. } = &group.right;
        lines.push(format!("{name:NAME_WIDTH$}{raw:>22}{alpha:>22}{ac1:>22}"));
    }
    lines.push(String::new());
    lines.extend(readings(agreement));
    lines.push(String::new());
    lines.push(format!(
        "{:NAME_WIDTH$}{:>8}{:>10}{:>9}{:>9}{:>9}{:>9}",
        "annotator", "sealed", "answered", "skipped", "right", "gold", "repeats"
    ));
    lines.extend(agreement.annotators.iter().map(annotator_line));
    lines.extend(rejected_lines(judged));
    lines.join("\n")
}

fn heading(judged: &JudgedRound) -> Vec<String> {
    let JudgedRound { round, verdicts, .. } = judged;
    let mut lines = Vec::new();
    if round.simulated {
        lines.push("SIMULATED: programs voted, or people who were trying the tool.".to_owned());
    }
    if !verdicts.is_final {
        lines.push("Only a look: not everybody has sealed.".to_owned());
    }
    lines.push(format!(
        "Round {}: {} queries, {} annotators",
        round.name,
        verdicts.items.len(),
        round.annotators.len()
    ));
    lines
}

/// What the numbers are about.
fn readings(agreement: &Agreement) -> Vec<String> {
    let overall = &agreement.overall;
    let mut lines = vec![
        "agreement on whether answers are right, before filtering; 95 % intervals over scenes".to_owned(),
        format!("two answers are the same choice: {}", overall.choice.raw),
        format!("a single answer is right (human ceiling): {}", overall.ceiling),
    ];
    let groups = std::iter::once(overall).chain(agreement.categories.values());
    let reasons = groups
        .flat_map(|group| [&group.right.alpha, &group.right.ac1])
        .filter_map(|estimate| estimate.undefined.as_deref());
    let reasons: BTreeSet<&str> = reasons.collect();
    if !reasons.is_empty() {
        let reasons: Vec<&str> = reasons.into_iter().collect();
        lines.push(format!("undefined, or without an interval: {}", reasons.join("; ")));
    }
    lines
}

fn annotator_line(annotator: &Annotator) -> String {
    let Annotator { name, sealed, answered, skipped, right, gold, repeats } = annotator;
    let share = if *answered == 0 {
        "-".to_owned()
    } else {
        format!("{:.1} %", 100.0 * *right as f64 / *answered as f64)
    };
    format!(
        "{name:NAME_WIDTH$}{:>8}{answered:>10}{skipped:>9}{share:>9}{:>9}{:>9}",
        if *sealed { "yes" } else { "no" },
        kept(gold),
        kept(repeats)
    )
}

fn kept(consistency: &Consistency) -> String {
    if consistency.answered == 0 {
        "-".to_owned()
    } else {
        format!("{}/{}", consistency.kept, consistency.answered)
    }
}

fn rejected_lines(judged: &JudgedRound) -> Vec<String> {
    let rejected = judged.verdicts.items.iter().filter(|verdict| verdict.outcome == Outcome::Rejected);
    let mut lines = Vec::new();
    for verdict in rejected {
        if lines.is_empty() {
            lines.push(format!("\nrejected ({LEGEND})"));
        }
        lines.push(format!("  {} {} \"{}\"", verdict.query, verdict.pattern(), verdict.text));
        lines.extend(verdict.reasons.iter().map(|reason| format!("      {reason}")));
        let comments =
            verdict.votes.iter().flat_map(|vote| vote.comments.iter().map(move |text| (vote, text)));
        lines.extend(comments.map(|(vote, text)| format!("      {} remarks: {text}", vote.annotator)));
    }
    lines
}

/// What became of the status of the queries.
pub fn status_line(judged: &JudgedRound, changes: &[StatusChange]) -> String {
    if judged.round.simulated {
        return "simulated round: no query has another status for it".to_owned();
    }
    let became = [Status::Verified, Status::Rejected, Status::Candidate].map(|status| {
        let count = changes.iter().filter(|change| change.to == status).count();
        (count > 0).then(|| format!("{count} now {}", status.as_str()))
    });
    let became: Vec<String> = became.into_iter().flatten().collect();
    let became = if became.is_empty() { "as the votes say already".to_owned() } else { became.join(", ") };
    format!("status of the queries: {became}")
}
