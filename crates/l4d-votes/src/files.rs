//! What a verdict leaves behind: `verdicts.csv`, `agreement.json` and `refine.jsonl`, as bytes.
//!
//! The verdict of a round is pronounced once. Prompts are edited afterwards, that is what the list to refine is for;
//! so `verdicts.csv` remembers which of them had changed when the verdict was pronounced, and from the votes and
//! that memory the same bytes follow for good, however the benchmark goes on.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::{DataError, Interval, Name, QueryId, Temporal};
use serde::{Deserialize, Serialize};

use crate::agreement::Agreement;
use crate::item::ItemId;
use crate::key::Change;
use crate::round::Round;
use crate::verdict::{ItemVerdict, Outcome, Verdicts};

/// No table of verdicts is larger.
const MAX_BYTES: u64 = 64 << 20;

/// A line of `verdicts.csv`.
#[derive(Debug, Serialize)]
struct Row<'a> {
    item: &'a ItemId,
    query: String,
    categories: String,
    outcome: Outcome,
    pattern: String,
    right: usize,
    counted: usize,
    change: Change,
    digest: &'a str,
    text: &'a str,
    reasons: String,
}

/// What matters of a line that is read back.
#[derive(Debug, Deserialize)]
struct Remembered {
    item: ItemId,
    change: Change,
}

/// `verdicts.csv`: one row per query, by item.
///
/// # Errors
/// A row cannot be written as CSV.
pub fn verdicts_csv(
    round: &Round,
    verdicts: &Verdicts,
    changes: &BTreeMap<ItemId, Change>,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for verdict in &verdicts.items {
        let categories: Vec<&str> = verdict.categories.iter().map(|category| category.as_str()).collect();
        writer.serialize(Row {
            item: &verdict.item,
            query: verdict.query.to_string(),
            categories: categories.join("+"),
            outcome: verdict.outcome,
            pattern: verdict.pattern(),
            right: verdict.right(),
            counted: verdict.counted(),
            change: changes.get(&verdict.item).copied().unwrap_or(Change::No),
            digest: round.item(&verdict.item).map_or("", |item| &item.digest),
            text: &verdict.text,
            reasons: verdict.reasons.join("; "),
        })?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}

/// What `verdicts.csv` remembers of changes before the verdict; none where no verdict was pronounced yet.
///
/// # Errors
/// The file cannot be read, or a line of it is not what was written.
pub fn remembered(path: &Path) -> Result<Option<BTreeMap<ItemId, Change>>, DataError> {
    if !path.exists() {
        return Ok(None);
    }
    let bytes = read_bounded(path, MAX_BYTES)?;
    let rows: Result<Vec<Remembered>, csv::Error> =
        csv::Reader::from_reader(bytes.as_slice()).deserialize().collect();
    let rows = rows.map_err(|error| {
        let line = error.position().map_or(0, csv::Position::line);
        let remedy = "restore the file, or remove it and run `l4d verdict` again";
        DataError::invalid(path, format!("line {line}"), error.to_string(), remedy)
    })?;
    Ok(Some(rows.into_iter().map(|row| (row.item, row.change)).collect()))
}

/// `agreement.json`.
///
/// # Errors
/// A number cannot be written as JSON.
pub fn agreement_json(agreement: &Agreement) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = serde_json::to_vec_pretty(agreement)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// A line of `refine.jsonl`: a prompt that people did not understand as it is meant, with all that helps to mend it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Refine {
    /// The query.
    pub query: QueryId,
    /// The item that asked it.
    pub item: ItemId,
    /// What became of it.
    pub outcome: Outcome,
    /// One letter per annotator, in the order of `round.toml`.
    pub pattern: String,
    /// The prompt as it reads now; null where it was removed.
    pub text: Option<String>,
    /// The prompt as it was asked.
    pub asked: String,
    /// What it meant then.
    pub referents: Vec<Name>,
    /// How it bound time.
    pub temporal: Temporal,
    /// When it held.
    pub frames: Vec<Interval>,
    /// Why it is not valid, one sentence each.
    pub reasons: Vec<String>,
    /// Remarks, by annotator.
    pub comments: BTreeMap<Name, Vec<String>>,
}

impl Refine {
    /// What is to be done about a verdict; `text` is the prompt as it reads now.
    pub fn of(verdict: &ItemVerdict, text: Option<String>) -> Self {
        let spoken = verdict.votes.iter().filter(|vote| !vote.comments.is_empty());
        Self {
            query: verdict.query.clone(),
            item: verdict.item.clone(),
            outcome: verdict.outcome,
            pattern: verdict.pattern(),
            text,
            asked: verdict.text.clone(),
            referents: verdict.meaning.referents.iter().cloned().collect(),
            temporal: verdict.meaning.temporal,
            frames: verdict.meaning.frames.clone(),
            reasons: verdict.reasons.clone(),
            comments: spoken.map(|vote| (vote.annotator.clone(), vote.comments.clone())).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{items, meaning, round_of};
    use crate::verdict::{Mark, Vote};

    fn verdict(round: &Round, place: usize, outcome: Outcome) -> ItemVerdict {
        let item = &round.items[place];
        let vote = |(annotator, mark): (&Name, Mark)| Vote {
            annotator: annotator.clone(),
            mark,
            answer: None,
            comments: if mark == Mark::Right { Vec::new() } else { vec!["which, \"one\"?".to_owned()] },
        };
        ItemVerdict {
            item: item.id.clone(),
            query: format!("s/{:03}", place + 1).parse().unwrap(),
            categories: vec![l4d_data::Category::Action, l4d_data::Category::Spatial],
            text: item.text.clone(),
            meaning: meaning(&["cup_a"], Temporal::Whole, Interval::WHOLE),
            outcome,
            votes: round.annotators.iter().zip([Mark::Right, Mark::SaidAmbiguous]).map(vote).collect(),
            reasons: vec!["ben called it ambiguous: which, \"one\"?".to_owned()],
        }
    }

    #[test]
    fn the_table_reads_as_written_by_hand() {
        let round = round_of(&["ada", "ben"], items("s", &["the cup", "the cup, the red one"]));
        let verdicts = Verdicts {
            is_final: true,
            items: vec![verdict(&round, 0, Outcome::Rejected), verdict(&round, 1, Outcome::Stale)],
            findings: Vec::new(),
        };
        let mut changes = BTreeMap::new();
        changes.insert(round.items[1].id.clone(), Change::Edited);
        let csv = String::from_utf8(verdicts_csv(&round, &verdicts, &changes).unwrap()).unwrap();
        let (first, second) = (&round.items[0].digest, &round.items[1].digest);
        let expected = format!(
            "item,query,categories,outcome,pattern,right,counted,change,digest,text,reasons\n\
             q0001,s/001,action+spatial,rejected,+?,1,2,no,{first},the cup,\"ben called it ambiguous: which, \"\"one\"\"?\"\n\
             q0002,s/002,action+spatial,stale,+?,1,2,edited,{second},\"the cup, the red one\",\"ben called it ambiguous: which, \"\"one\"\"?\"\n"
        );
        assert_eq!(csv, expected);
    }

    #[test]
    fn what_had_changed_is_remembered() {
        let round = round_of(&["ada", "ben"], items("s", &["one", "two", "three"]));
        let ids = round.items.iter().map(|item| item.id.clone());
        let changes = ids.zip([Change::No, Change::Edited, Change::Gone]).collect();
        let verdicts = Verdicts {
            items: (0..3).map(|place| verdict(&round, place, Outcome::Stale)).collect(),
            ..Verdicts::default()
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts.csv");
        assert_eq!(remembered(&path).unwrap(), None);
        std::fs::write(&path, verdicts_csv(&round, &verdicts, &changes).unwrap()).unwrap();
        assert_eq!(remembered(&path).unwrap(), Some(changes));
    }

    #[test]
    fn a_damaged_table_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts.csv");
        std::fs::write(&path, "item,change\nq0001,no\nq0002,perhaps\n").unwrap();
        let error = remembered(&path).unwrap_err();
        assert!(error.to_string().contains("line 3") && error.hint().is_some(), "{error}");
    }

    #[test]
    fn the_list_to_refine_names_who_said_what() {
        let round = round_of(&["ada", "ben"], items("s", &["the cup"]));
        let line = Refine::of(&verdict(&round, 0, Outcome::Rejected), Some("the blue cup".to_owned()));
        assert_eq!(
            serde_json::to_string(&line).unwrap(),
            r#"{"query":"s/001","item":"q0001","outcome":"rejected","pattern":"+?","text":"the blue cup","asked":"the cup","referents":["cup_a"],"temporal":"whole","frames":[[0,96]],"reasons":["ben called it ambiguous: which, \"one\"?"],"comments":{"ben":["which, \"one\"?"]}}"#
        );
    }
}
