//! The files of a verdict: what `l4d verdict` writes, and whether what is there follows from the votes.
//!
//! The verdict of a round is pronounced once. Prompts are edited afterwards, that is what the list to refine is for;
//! so `verdicts.csv` remembers which of them had changed when the verdict was pronounced, and from the votes and
//! that memory the same bytes follow for good, however the benchmark goes on.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::{Claim, Earlier, read_bounded, write_atomic};
use l4d_data::{Benchmark, DataError, Name, Query, QueryId, Report, StageError, json};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::JudgedRound;
use super::statuses::{self, StatusChange};
use crate::agreement::{Agreement, measure};
use crate::item::ItemId;
use crate::key::Change;
use crate::round::Round;
use crate::verdict::{ItemVerdict, Outcome, Verdicts};

/// No derived file is larger.
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

/// The right to write the files of a verdict.
///
/// # Errors
/// Files that l4d did not write, unless `force`, and a round that another run writes into.
pub fn claim(judged: &JudgedRound, force: bool) -> Result<Claim, StageError> {
    let files = [judged.dir.verdicts(), judged.dir.agreement(), judged.dir.refine()];
    let earlier = Earlier { file: "agreement.json", says: "l4d/agreement/" };
    Ok(judged.dir.claim(&files, earlier, force)?)
}

/// Writes `agreement.json` and `refine.jsonl`. The verdicts come last ([`pronounce`]): with them the verdict counts.
///
/// # Errors
/// Queries that cannot be read, or what the disk refuses.
pub fn write(judged: &JudgedRound, agreement: &Agreement, bench: &Benchmark) -> Result<(), StageError> {
    let texts = current_texts(judged, bench)?;
    let open = judged.verdicts.items.iter().filter(|verdict| verdict.outcome != Outcome::Valid);
    let refine: Vec<Value> = open.map(|verdict| refine(verdict, texts.get(&verdict.query))).collect();
    write_atomic(&judged.dir.agreement(), &agreement_bytes(agreement)?)?;
    Ok(json::write_lines(&judged.dir.refine(), &refine)?)
}

/// Writes `verdicts.csv`.
///
/// # Errors
/// What the disk refuses.
pub fn pronounce(judged: &JudgedRound) -> Result<(), StageError> {
    Ok(write_atomic(&judged.dir.verdicts(), &verdict_bytes(judged)?)?)
}

/// `l4d verdict --check`: L4D530 where a file differs from what the votes give, L4D531 where a status does.
///
/// # Errors
/// Files that cannot be read.
pub fn check(judged: &JudgedRound, rounds: &Path, bench: &Benchmark) -> Result<Report, StageError> {
    let mut report = Report::default();
    judged.findings().into_iter().for_each(|finding| report.add(finding));
    let agreement = measure(&judged.round, &judged.key, &judged.responses);
    let hint = format!("run `l4d verdict {}`", judged.round.name);
    for (path, bytes) in [
        (judged.dir.verdicts(), verdict_bytes(judged)?),
        (judged.dir.agreement(), agreement_bytes(&agreement)?),
    ] {
        if !path.exists() {
            report.error("L4D530", &path, "file", "is missing", &hint);
        } else if read_bounded(&path, MAX_BYTES)? != bytes {
            report.error("L4D530", &path, "bytes", "are not what the votes give", &hint);
        }
    }
    for StatusChange { query, file, from, to } in statuses::changes(judged, rounds, bench)? {
        let (from, to) = (from.as_str(), to.as_str());
        let message = format!("is {from}, but by the votes of people it is {to}");
        let place = format!("query {query}, field `status`");
        report.error("L4D531", &file, place, message, format!("{hint}: nothing else sets it"));
    }
    Ok(report)
}

/// What `l4d verdict --json` prints.
pub fn document(judged: &JudgedRound, agreement: &Agreement, changes: &[StatusChange]) -> Value {
    let JudgedRound { round, verdicts, .. } = judged;
    let verdict = |verdict: &ItemVerdict| {
        json!({
            "item": verdict.item,
            "query": verdict.query,
            "outcome": verdict.outcome,
            "pattern": verdict.pattern(),
            "right": verdict.right(),
            "counted": verdict.counted(),
            "reasons": verdict.reasons,
        })
    };
    let change =
        |change: &StatusChange| json!({ "query": change.query, "from": change.from, "to": change.to });
    let counts: BTreeMap<&str, usize> =
        Outcome::ALL.into_iter().map(|outcome| (outcome.as_str(), verdicts.count(outcome))).collect();
    json!({
        "round": round.name,
        "simulated": round.simulated,
        "final": verdicts.is_final,
        "queries": verdicts.items.len(),
        "outcomes": counts,
        "verdicts": verdicts.items.iter().map(verdict).collect::<Vec<_>>(),
        "agreement": agreement,
        "status": changes.iter().map(change).collect::<Vec<_>>(),
        "findings": judged.findings(),
    })
}

/// The prompts as they read now.
fn current_texts(judged: &JudgedRound, bench: &Benchmark) -> Result<BTreeMap<QueryId, String>, StageError> {
    let mut texts = BTreeMap::new();
    for scene in judged.scenes(bench) {
        let queries: Vec<Query> = [bench.queries(scene)?, bench.composites(scene)?].concat();
        texts.extend(queries.into_iter().map(|query| (query.id, query.text)));
    }
    Ok(texts)
}

fn agreement_bytes(agreement: &Agreement) -> Result<Vec<u8>, StageError> {
    Ok((serde_json::to_string_pretty(agreement)? + "\n").into_bytes())
}

fn verdict_bytes(judged: &JudgedRound) -> Result<Vec<u8>, StageError> {
    let JudgedRound { round, verdicts, changes, .. } = judged;
    verdicts_csv(round, verdicts, changes).map_err(|error| StageError::of(&error, "run `l4d verdict` again"))
}

/// `verdicts.csv`: one row per query, by item.
fn verdicts_csv(
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
pub(super) fn remembered(path: &Path) -> Result<Option<BTreeMap<ItemId, Change>>, DataError> {
    if !path.exists() {
        return Ok(None);
    }
    let bytes = read_bounded(path, MAX_BYTES)?;
    let rows: Result<Vec<Remembered>, csv::Error> =
        csv::Reader::from_reader(bytes.as_slice()).deserialize().collect();
    let rows = rows.map_err(|error| {
        let line = error.position().map_or(0, csv::Position::line);
        let hint = "restore the file, or remove it and run `l4d verdict` again";
        DataError::invalid(path, format!("line {line}"), error.to_string(), hint)
    })?;
    Ok(Some(rows.into_iter().map(|row| (row.item, row.change)).collect()))
}

/// A line of `refine.jsonl`: a prompt that people did not understand as it is meant, with all that helps to mend it;
/// `text` is the prompt as it reads now.
fn refine(verdict: &ItemVerdict, text: Option<&String>) -> Value {
    let spoken = verdict.votes.iter().filter(|vote| !vote.comments.is_empty());
    let comments: BTreeMap<&Name, &Vec<String>> =
        spoken.map(|vote| (&vote.annotator, &vote.comments)).collect();
    json!({
        "query": verdict.query,
        "item": verdict.item,
        "outcome": verdict.outcome,
        "pattern": verdict.pattern(),
        "text": text,
        "asked": verdict.text,
        "referents": verdict.meaning.referents,
        "temporal": verdict.meaning.temporal,
        "frames": verdict.meaning.frames,
        "reasons": verdict.reasons,
        "comments": comments,
    })
}

#[cfg(test)]
mod tests {
    use l4d_data::{Interval, Temporal};

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
    fn the_table_reads_as_written_by_hand_and_remembers_what_had_changed() {
        let round = round_of(&["ada", "ben"], items("s", &["the cup", "the cup, the red one", "it"]));
        let outcomes = [Outcome::Rejected, Outcome::Stale, Outcome::Stale];
        let items = (0..).zip(outcomes).map(|(place, outcome)| verdict(&round, place, outcome)).collect();
        let verdicts = Verdicts { items, ..Verdicts::default() };
        let ids = round.items.iter().map(|item| item.id.clone());
        let changes = ids.zip([Change::No, Change::Edited, Change::Gone]).collect();
        let csv = verdicts_csv(&round, &verdicts, &changes).unwrap();
        insta::assert_snapshot!(String::from_utf8_lossy(&csv), @r#"
        item,query,categories,outcome,pattern,right,counted,change,digest,text,reasons
        q0001,s/001,action+spatial,rejected,+?,1,2,no,0000000000000000000000000000000000000000000000000000000000000001,the cup,"ben called it ambiguous: which, ""one""?"
        q0002,s/002,action+spatial,stale,+?,1,2,edited,0000000000000000000000000000000000000000000000000000000000000002,"the cup, the red one","ben called it ambiguous: which, ""one""?"
        q0003,s/003,action+spatial,stale,+?,1,2,gone,0000000000000000000000000000000000000000000000000000000000000003,it,"ben called it ambiguous: which, ""one""?"
        "#);

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts.csv");
        assert_eq!(remembered(&path).unwrap(), None);
        std::fs::write(&path, csv).unwrap();
        assert_eq!(remembered(&path).unwrap(), Some(changes));
        std::fs::write(&path, "item,change\nq0001,no\nq0002,perhaps\n").unwrap();
        let error = remembered(&path).unwrap_err();
        assert!(error.to_string().contains("line 3") && !error.hint().is_empty(), "{error}");
    }

    #[test]
    fn the_list_to_refine_names_who_said_what() {
        let round = round_of(&["ada", "ben"], items("s", &["the cup"]));
        let line = refine(&verdict(&round, 0, Outcome::Rejected), Some(&"the blue cup".to_owned()));
        insta::assert_snapshot!(line, @r#"{"query":"s/001","item":"q0001","outcome":"rejected","pattern":"+?","text":"the blue cup","asked":"the cup","referents":["cup_a"],"temporal":"whole","frames":[[0,96]],"reasons":["ben called it ambiguous: which, \"one\"?"],"comments":{"ben":["which, \"one\"?"]}}"#);
    }
}
