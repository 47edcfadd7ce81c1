//! What the logs of a round say, read without a lock and without changing them.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::{list_folder, read_bounded};
use l4d_data::{DataError, Name, Report};

use crate::ballot::Notice;
use crate::codes;
use crate::event::Answer;
use crate::item::{Item, ItemId};
use crate::ledger::Ledger;
use crate::replay::replay;
use crate::round::{Round, RoundDir};

/// No log is larger.
pub(crate) const MAX_BYTES: u64 = 64 << 20;

/// What one annotator says about one item.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Standing {
    /// The answer that counts.
    pub answer: Option<Answer>,
    /// Whether the item was skipped.
    pub skipped: bool,
    /// The latest answer to an earlier wording or scene, where neither an answer nor a skip counts.
    pub stale: Option<Answer>,
    /// Comments that were not taken back, oldest first.
    pub comments: Vec<String>,
}

/// One annotator's say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sheet {
    /// Whose.
    pub annotator: Name,
    /// Whether a seal ends it and fits it.
    pub sealed: bool,
    /// By item; items without an entry were never touched.
    pub items: BTreeMap<ItemId, Standing>,
}

impl Sheet {
    /// What it says about an item.
    pub fn standing(&self, item: &ItemId) -> Option<&Standing> {
        self.items.get(item)
    }

    /// The answer to an item that counts.
    pub fn answer(&self, item: &ItemId) -> Option<&Answer> {
        self.items.get(item)?.answer.as_ref()
    }

    /// Reads the bytes of a log. `path` only serves messages.
    pub fn from_bytes(path: &Path, bytes: &[u8], round: &Round, annotator: &Name) -> (Self, Report) {
        let mut replay = replay(path, bytes, round, annotator);
        let asked = replay.ledger.items().filter_map(|id| round.item(id));
        let items: BTreeMap<ItemId, Standing> =
            asked.map(|item| (item.id.clone(), standing(&replay.ledger, item))).collect();
        let stale = items.values().filter(|standing| standing.stale.is_some()).count();
        if stale > 0 {
            replay.report.warning(
                codes::STALE_VOTES,
                path,
                "answers",
                format!("{stale} belong to an earlier wording or scene and do not count"),
                "let the annotator answer these items again",
            );
        }
        (Self { annotator: annotator.clone(), sealed: replay.sealed, items }, replay.report)
    }
}

pub(crate) fn standing(ledger: &Ledger, item: &Item) -> Standing {
    let Item { id, digest, .. } = item;
    let answer = ledger.answer(id, digest).cloned();
    let skipped = ledger.is_skipped(id, digest);
    let stale = if answer.is_none() && !skipped { ledger.stale_answer(id, digest).cloned() } else { None };
    let comments = ledger.comments(id, digest).into_iter().map(str::to_owned).collect();
    Standing { answer, skipped, stale, comments }
}

/// Reads the logs of all annotators of a round, in the order of `round.toml`. An annotator without a log has an
/// empty sheet.
pub fn read_all(dir: &RoundDir, round: &Round) -> Result<(Vec<Sheet>, Vec<Notice>), DataError> {
    let mut report = Report::default();
    let mut sheets = Vec::new();
    for annotator in &round.annotators {
        let path = dir.ballot(annotator);
        let bytes = if path.exists() {
            read_bounded(&path, MAX_BYTES)?
        } else {
            let hint =
                format!("let {annotator} vote: `l4d verify-prompts --round {} --as {annotator}`", round.name);
            report.warning(
                codes::NO_BALLOT,
                &path,
                "file",
                "there is none: this annotator has not begun",
                hint,
            );
            Vec::new()
        };
        let (sheet, findings) = Sheet::from_bytes(&path, &bytes, round, annotator);
        report.extend(findings);
        sheets.push(sheet);
    }
    report_strangers(dir, round, &mut report)?;
    Ok((sheets, report.into_sorted()))
}

fn report_strangers(dir: &RoundDir, round: &Round, report: &mut Report) -> Result<(), DataError> {
    let folder = dir.votes();
    if !folder.exists() {
        return Ok(());
    }
    for entry in list_folder(&folder)? {
        let is_known = round.annotators.iter().any(|name| entry == format!("{name}.jsonl"));
        if !is_known {
            report.warning(
                codes::STRANGER,
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
    use crate::event::{Choice, Event, Seen};
    use crate::fixture::{items, name, round_of};

    fn codes(notices: &[Notice]) -> Vec<(&'static str, String)> {
        let file = |path: &str| path.rsplit('/').next().unwrap_or_default().to_owned();
        notices.iter().map(|notice| (notice.code, file(&notice.path))).collect()
    }

    #[test]
    fn reading_needs_no_lock_and_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let dir = RoundDir::new(folder.path());
        let mut round = round_of(&["ada", "ben"], items("room", &["The cat", "The dog"]));
        let (mut ballot, _) = Ballot::open(&dir, &round, &name("ada")).unwrap();
        let answer = Answer { choice: Choice::None, frames: Interval::WHOLE };
        for item in ballot.order().to_vec() {
            ballot.record(&item, Event::Choose(answer.clone()), Seen::default(), Duration::ZERO).unwrap();
        }
        let torn = [&fs::read(dir.ballot(&name("ada"))).unwrap()[..], b"{\"v\":1"].concat();
        fs::write(dir.ballot(&name("ada")), &torn).unwrap();
        fs::write(dir.votes().join("eve.jsonl"), "").unwrap();
        round.items[1].digest = "f".repeat(64);

        let (sheets, notices) = read_all(&dir, &round).unwrap();
        assert_eq!(sheets.iter().map(|sheet| sheet.annotator.as_str()).collect::<Vec<_>>(), ["ada", "ben"]);
        let standing = |index: usize| sheets[0].standing(&round.items[index].id).unwrap();
        assert_eq!((&standing(0).answer, &standing(0).stale), (&Some(answer.clone()), &None));
        assert_eq!((&standing(1).answer, &standing(1).stale), (&None, &Some(answer)));
        assert!(sheets[1].items.is_empty() && !sheets[0].sealed);
        let expected = [
            (codes::STALE_VOTES, "ada.jsonl"),
            (codes::TORN_LINE, "ada.jsonl"),
            (codes::NO_BALLOT, "ben.jsonl"),
            (codes::STRANGER, "eve.jsonl"),
        ];
        assert_eq!(codes(&notices), expected.map(|(code, file)| (code, file.to_owned())));
        assert_eq!(fs::read(dir.ballot(&name("ada"))).unwrap(), torn);
    }

    #[test]
    fn a_skip_counts_and_leaves_nothing_stale() {
        let mut ledger = Ledger::default();
        let item = items("room", &["The cat"]).remove(0);
        let answer = Answer { choice: Choice::None, frames: Interval::WHOLE };
        ledger.apply(0, &item.id, "earlier", Event::Choose(answer)).unwrap();
        assert!(standing(&ledger, &item).stale.is_some());
        ledger.apply(1, &item.id, &item.digest, Event::Skip).unwrap();
        assert_eq!(standing(&ledger, &item), Standing { skipped: true, ..Standing::default() });
    }

    #[test]
    fn a_log_that_is_no_file_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let dir = RoundDir::new(folder.path());
        let round = round_of(&["ada"], items("room", &["The cat"]));
        fs::create_dir_all(dir.ballot(&name("ada"))).unwrap();
        assert!(read_all(&dir, &round).unwrap_err().to_string().contains("ada.jsonl"));
    }
}
