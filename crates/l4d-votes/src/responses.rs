//! Reads what annotators answered from the logs of a round, without a lock and without changing them. Decides nothing
//! about queries: that is the verdict.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::{list_folder, read_bounded};
use l4d_data::{DataError, Finding, Name, Report};

use crate::item::ItemId;
use crate::replay::replay;
use crate::round::Round;
use crate::round_dir::RoundDir;
use crate::vote::{Answer, Response};

/// Largest log that is read.
pub(crate) const MAX_BYTES: u64 = 64 << 20;

/// The answers of one annotator to all items.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Responses {
    pub annotator: Name,
    /// Whether the log ends with a seal that matches it.
    pub sealed: bool,
    /// By item; items without an entry have no event in the log.
    pub items: BTreeMap<ItemId, Response>,
}

impl Responses {
    /// The answer to an item that counts.
    pub fn answer(&self, item: &ItemId) -> Option<&Answer> {
        self.items.get(item)?.answer.as_ref()
    }

    /// Reads the bytes of a log. `path` is for findings only.
    fn from_bytes(path: &Path, bytes: &[u8], round: &Round, annotator: &Name) -> (Self, Report) {
        let mut replay = replay(path, bytes, round, annotator);
        let asked = replay.history.items().filter_map(|id| round.item(id));
        let items: BTreeMap<ItemId, Response> =
            asked.map(|item| (item.id.clone(), replay.history.response(item))).collect();
        let stale = items.values().filter(|response| response.stale.is_some()).count();
        if stale > 0 {
            replay.report.warning(
                "L4D519",
                path,
                "answers",
                format!("{stale} belong to an earlier wording or scene and do not count"),
                "let the annotator answer these items again",
            );
        }
        (Self { annotator: annotator.clone(), sealed: replay.sealed, items }, replay.report)
    }
}

/// Reads the logs of all annotators of a round, in the order of `round.toml`. An annotator without a log has
/// no answers.
pub(crate) fn read_responses(
    dir: &RoundDir,
    round: &Round,
) -> Result<(Vec<Responses>, Vec<Finding>), DataError> {
    let mut report = Report::default();
    let mut all = Vec::new();
    for annotator in &round.annotators {
        let path = dir.ballot(annotator);
        let bytes = if path.exists() {
            read_bounded(&path, MAX_BYTES)?
        } else {
            let hint = format!("let {annotator} vote: `l4d verify-prompts {} --as {annotator}`", round.name);
            report.warning("L4D503", &path, "file", "there is none: this annotator has not begun", hint);
            Vec::new()
        };
        let (responses, findings) = Responses::from_bytes(&path, &bytes, round, annotator);
        report.extend(findings);
        all.push(responses);
    }
    report_unknown_files(dir, round, &mut report)?;
    Ok((all, report.into_sorted()))
}

/// Warns of files in the folder of votes that belong to no annotator of the round.
fn report_unknown_files(dir: &RoundDir, round: &Round, report: &mut Report) -> Result<(), DataError> {
    let folder = dir.votes();
    if !folder.exists() {
        return Ok(());
    }
    for entry in list_folder(&folder)? {
        let is_known = round.annotators.iter().any(|name| entry == format!("{name}.jsonl"));
        if !is_known {
            report.warning(
                "L4D504",
                &folder.join(&entry),
                "file",
                "is no log of an annotator that the round names, and does not count",
                "move it away, or open a round that names its annotator",
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::Duration;

    use l4d_data::Interval;

    use super::*;
    use crate::ballot::Ballot;
    use crate::fixture::{items, name, round_of};
    use crate::vote::{Choice, Event, ShownFrames};

    #[test]
    fn logs_are_read_while_locked_and_torn_and_stay_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let dir = RoundDir::new(folder.path());
        let mut round = round_of(&["ada", "ben"], items("room", &["The cat", "The dog"]));
        let (mut ballot, _) = Ballot::open(&dir, &round, &name("ada")).unwrap();
        let answer = Answer { choice: Choice::None, frames: Interval::WHOLE };
        for item in ballot.order().to_vec() {
            let event = Event::Choose(answer.clone());
            ballot.record(&item, event, ShownFrames::default(), Duration::ZERO).unwrap();
        }
        let torn = [&fs::read(dir.ballot(&name("ada"))).unwrap()[..], b"{\"v\":1"].concat();
        fs::write(dir.ballot(&name("ada")), &torn).unwrap();
        fs::write(dir.votes().join("eve.jsonl"), "").unwrap();
        round.items[1].digest = "f".repeat(64);

        let (all, findings) = read_responses(&dir, &round).unwrap();
        assert_eq!(all.iter().map(|one| one.annotator.as_str()).collect::<Vec<_>>(), ["ada", "ben"]);
        let response = |index: usize| all[0].items[&round.items[index].id].clone();
        assert_eq!(response(0), Response { answer: Some(answer.clone()), ..Response::default() });
        assert_eq!(response(1), Response { stale: Some(answer), ..Response::default() });
        assert!(all[1].items.is_empty() && !all[0].sealed);
        let found: Vec<String> = findings
            .iter()
            .map(|finding| {
                format!("{} {}", finding.code, finding.path.rsplit('/').next().unwrap_or_default())
            })
            .collect();
        let expected = [
            ("L4D519", "ada.jsonl"),
            ("L4D510", "ada.jsonl"),
            ("L4D503", "ben.jsonl"),
            ("L4D504", "eve.jsonl"),
        ];
        assert_eq!(found, expected.map(|(code, file)| format!("{code} {file}")));
        assert_eq!(fs::read(dir.ballot(&name("ada"))).unwrap(), torn);
    }
}
