//! The loop of annotation: open a round, vote, judge, edit what was rejected, ask again; and everything that must
//! not count. Votes are cast through the library that the annotator's application uses.

mod shipped;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use l4d_data::query::text_digest;
use l4d_data::{Benchmark, Interval, Name, QueryId, Status, json};
use l4d_votes::key::ItemSource;
use l4d_votes::{Answer, Ballot, Choice, Event, ItemId, Key, Round, RoundDir, ShownFrames};
use serde_json::{Value, json};

use crate::support::{Dir, Run};

const SCENES: [&str; 2] = ["room_living_cats", "tabletop_mouse_cups"];
const PANEL: [&str; 5] = ["ada", "ben", "cyd", "dee", "eve"];

/// Opens the round `pilot` in [`bench`].
pub(crate) const OPEN: &str = "open-round pilot --profile tiny --annotators ada,ben,cyd,dee,eve";

/// A folder in which everybody has voted in the round `pilot`, one of them otherwise than the rest on a query.
pub(crate) fn voted() -> Dir {
    let dir = bench();
    let (_, _, key) = opened(&dir, "pilot", "");
    let wrong = BTreeMap::from([(queries(&key)[3].0.clone(), choose(Choice::None))]);
    panel_votes(&dir, "pilot", "cyd", &wrong);
    dir
}

/// A folder with a benchmark of two shipped scenes.
pub(crate) fn bench() -> Dir {
    let files = [
        "scenes/{}.json",
        "queries/{}.jsonl",
        "queries/{}.composite.jsonl",
        "queries/{}.absent.jsonl",
        "truth/tiny/{}.json",
    ];
    Dir::with_shipped("Two", &SCENES, &files)
}

fn open_round(dir: &Dir, name: &str, more: &str) -> Run {
    dir.run(format!("open-round {name} --profile tiny --annotators {} {more}", PANEL.join(",")))
}

pub(crate) fn opened(dir: &Dir, name: &str, more: &str) -> (RoundDir, Round, Key) {
    open_round(dir, name, more).says(0, &[]);
    read_round(dir, name)
}

fn read_round(dir: &Dir, name: &str) -> (RoundDir, Round, Key) {
    let folder = RoundDir::new(dir.path(format!("annotation/rounds/{name}")));
    let round = Round::open(&folder).unwrap();
    let key = Key::read(&folder, &round).unwrap();
    (folder, round, key)
}

/// The right answer to an item.
fn right(key: &Key, item: &ItemId) -> Choice {
    match key.source(item).unwrap() {
        ItemSource::Query { meaning, .. } => Choice::Objects(meaning.referents.clone()),
        ItemSource::Absent { .. } => Choice::None,
        ItemSource::Vague { .. } => Choice::Ambiguous { reason: "which of them?".to_owned() },
        ItemSource::Repeat { of } => right(key, of),
    }
}

/// Somebody answers everything, rightly but for some items, and seals.
fn vote(dir: &Dir, round: &str, annotator: &str, otherwise: &BTreeMap<ItemId, Event>) {
    let (folder, round, key) = read_round(dir, round);
    let (mut ballot, notices) = Ballot::open(&folder, &round, &Name::new(annotator).unwrap()).unwrap();
    assert!(notices.is_empty(), "{notices:?}");
    for item in ballot.order().to_vec() {
        let event = otherwise.get(&item).cloned().unwrap_or_else(|| choose(right(&key, &item)));
        ballot.record(&item, event, ShownFrames::default(), Duration::from_secs(5)).unwrap();
    }
    ballot.seal().unwrap();
}

fn choose(choice: Choice) -> Event {
    Event::Choose(Answer { choice, frames: Interval::WHOLE })
}

/// The panel votes; one of them otherwise on some items.
pub(crate) fn panel_votes(dir: &Dir, round: &str, who: &str, otherwise: &BTreeMap<ItemId, Event>) {
    for annotator in PANEL {
        let nothing = BTreeMap::new();
        vote(dir, round, annotator, if annotator == who { otherwise } else { &nothing });
    }
}

/// Items that ask queries, with the queries.
fn queries(key: &Key) -> Vec<(ItemId, QueryId)> {
    let query = |(item, source): (&ItemId, &ItemSource)| match source {
        ItemSource::Query { query, .. } => Some((item.clone(), query.clone())),
        _ => None,
    };
    key.entries().iter().filter_map(query).collect()
}

fn statuses(dir: &Dir) -> BTreeMap<QueryId, Status> {
    let bench = Benchmark::open(dir.path("benchmark")).unwrap();
    let scenes = bench.manifest.scenes.clone();
    let all = scenes.iter().flat_map(|scene| bench.queries(scene).unwrap());
    all.map(|query| (query.id, query.status)).collect()
}

fn count(dir: &Dir, status: Status) -> usize {
    statuses(dir).values().filter(|&&found| found == status).count()
}

/// The files of the queries.
fn query_files(dir: &Dir) -> [String; 2] {
    SCENES.map(|scene| dir.read(&format!("benchmark/queries/{scene}.jsonl")))
}

fn file_of(query: &QueryId) -> String {
    format!("benchmark/queries/{}.jsonl", query.scene)
}

/// Writes another text, and the digest that belongs to it.
fn edit_text(dir: &Dir, query: &QueryId, text: &str) {
    let mut lines = dir.lines(&file_of(query));
    let value = lines.iter_mut().find(|value| value["id"] == query.to_string()).unwrap();
    value["text"] = text.into();
    value["text_digest"] = text_digest(text, Some(&value["predicate"])).into();
    json::write_lines(&dir.path(file_of(query)), &lines).unwrap();
}

/// The queries that a new round asks about.
fn asked_next(dir: &Dir, name: &str, more: &str) -> BTreeSet<QueryId> {
    let (_, _, key) = opened(dir, name, more);
    queries(&key).into_iter().map(|(_, query)| query).collect()
}

fn verdict(dir: &Dir, round: &str) -> Value {
    dir.json(format!("verdict {round}"))
}

/// `verdict --check` of a round.
fn check(dir: &Dir, round: &str) -> Run {
    dir.run(format!("verdict {round} --check"))
}

#[test]
fn what_five_people_agree_on_is_verified_and_the_rest_is_asked_again_once_edited() {
    let dir = bench();
    let (_, round, key) = opened(&dir, "pilot", "");
    let asked = queries(&key);
    let total = asked.len();
    assert!(total > 20 && round.items.len() > total, "{total} of {} items", round.items.len());
    let (wrong, unclear) = (asked[3].clone(), asked[7].clone());
    let nothing = choose(Choice::None);
    let ambiguous = choose(Choice::Ambiguous { reason: "either could be meant".to_owned() });
    let otherwise = BTreeMap::from([(wrong.0.clone(), nothing), (unclear.0.clone(), ambiguous)]);
    panel_votes(&dir, "pilot", "cyd", &otherwise);

    let before = query_files(&dir);
    let document = verdict(&dir, "pilot");
    assert_eq!(document["outcomes"], json!({"valid": total - 2, "rejected": 2, "incomplete": 0, "stale": 0}));
    assert_eq!(document["status"].as_array().unwrap().len(), total);
    assert_eq!((count(&dir, Status::Verified), count(&dir, Status::Rejected)), (total - 2, 2));
    let rejected: BTreeSet<QueryId> = [wrong.1.clone(), unclear.1.clone()].into();
    for (query, status) in statuses(&dir) {
        assert_eq!(status == Status::Rejected, rejected.contains(&query), "{query}");
    }
    // Nothing but the one word changed in the files.
    let without_word = |text: &String| text.replace("verified", "candidate").replace("rejected", "candidate");
    assert_eq!(before.each_ref().map(without_word), query_files(&dir).each_ref().map(without_word));

    // What was left behind says who said what.
    let table = dir.read("annotation/rounds/pilot/verdicts.csv");
    assert_eq!(table.lines().count(), total + 1);
    assert!(table.contains(",rejected,++?++,4,5,no,"), "{table}");
    let refine = dir.read("annotation/rounds/pilot/refine.jsonl");
    assert_eq!(refine.lines().count(), 2);
    assert!(refine.contains("cyd called it ambiguous: either could be meant"), "{refine}");
    let agreement = dir.value("annotation/rounds/pilot/agreement.json");
    let ceiling = agreement["overall"]["ceiling"]["value"].as_f64().unwrap();
    assert!((ceiling - (5 * total - 2) as f64 / (5 * total) as f64).abs() < 1e-9, "{ceiling}");
    check(&dir, "pilot").says(0, &[]);
    assert_eq!(verdict(&dir, "pilot")["status"], json!([]), "the second time nothing is left to change");

    // The scored set and every count follow.
    dir.succeed("baseline oracle --profile tiny");
    let scores = dir.json("score --profile tiny");
    let oracle = &scores["methods"][0];
    let counts = ["asked_queries", "verified_queries", "rejected_queries"].map(|count| &oracle[count]);
    assert_eq!(counts, [total - 2, total - 2, 2]);
    let left_out = "Left out: 2 prompts that people rejected.";
    dir.run("score --profile tiny --verified-only").says(0, &[left_out]);
    let set = dir.json("check-queries --profile tiny");
    let scored: u64 = set["queries"].as_object().unwrap().values().map(|count| count.as_u64().unwrap()).sum();
    assert_eq!((scored, set["rejected"].as_u64()), (total as u64 - 2, Some(2)));

    // The same words are not asked again, edited ones are.
    let ids: Vec<String> = rejected.iter().map(QueryId::to_string).collect();
    open_round(&dir, "second", "--from pilot").says(2, &[&ids[0], &ids[1]]);
    edit_text(&dir, &wrong.1, "The one that is really meant here");
    let refused = open_round(&dir, "second", "--from pilot");
    assert!(refused.code == 2 && !refused.stderr.contains(&wrong.1.to_string()), "{refused}");
    let asked = asked_next(&dir, "second", "--from pilot --edited-only --gold 0 --repeats 0");
    assert!(asked.iter().eq([&wrong.1]), "{asked:?}");
    panel_votes(&dir, "second", "", &BTreeMap::new());
    let document = verdict(&dir, "second");
    assert_eq!(document["status"], json!([{"query": wrong.1, "from": "rejected", "to": "verified"}]));
    assert_eq!((count(&dir, Status::Verified), count(&dir, Status::Rejected)), (total - 1, 1));

    // The first verdict stays what it was, and still follows from its votes.
    check(&dir, "pilot").says(0, &[]);
    assert_eq!(verdict(&dir, "pilot")["status"], json!([]));
    assert_eq!(dir.read("annotation/rounds/pilot/verdicts.csv"), table);
}

#[test]
fn a_verdict_waits_until_all_have_sealed() {
    let dir = bench();
    let (folder, round, key) = opened(&dir, "pilot", "--sample 8");
    let untouched = statuses(&dir);
    for annotator in &PANEL[..4] {
        vote(&dir, "pilot", annotator, &BTreeMap::new());
    }
    let (mut ballot, _) = Ballot::open(&folder, &round, &Name::new("eve").unwrap()).unwrap();
    let first = ballot.order()[0].clone();
    ballot.record(&first, choose(right(&key, &first)), ShownFrames::default(), Duration::ZERO).unwrap();
    drop(ballot);

    dir.refuses("verdict pilot", &["not sealed yet: eve"]);
    let look = dir.succeed("verdict pilot --unsealed");
    let fits = look.stdout.lines().all(|line| line.chars().count() <= 100);
    assert!(look.stdout.starts_with("Only a look") && fits, "{look}");
    for file in ["verdicts.csv", "agreement.json", "refine.jsonl"] {
        assert!(!dir.path(format!("annotation/rounds/pilot/{file}")).exists(), "{file}");
    }
    assert_eq!(statuses(&dir), untouched);
}

#[test]
fn votes_on_words_that_were_edited_do_not_count() {
    let dir = bench();
    let (_, _, key) = opened(&dir, "pilot", "--sample 8");
    let asked = queries(&key);
    edit_text(&dir, &asked[0].1, "Something else altogether");
    panel_votes(&dir, "pilot", "", &BTreeMap::new());
    let document = verdict(&dir, "pilot");
    assert_eq!(document["outcomes"], json!({"valid": 7, "rejected": 0, "incomplete": 0, "stale": 1}));
    assert_eq!(statuses(&dir)[&asked[0].1], Status::Candidate);
    assert_eq!(document["findings"][0]["code"], "L4D521");

    // A verified prompt that is edited is a candidate again; so is one that somebody calls verified by hand.
    edit_text(&dir, &asked[1].1, "Yet another thing");
    check(&dir, "pilot").says(1, &["L4D531"]);
    let changes = verdict(&dir, "pilot")["status"].clone();
    assert_eq!(changes, json!([{"query": asked[1].1, "from": "verified", "to": "candidate"}]));
    check(&dir, "pilot").says(0, &[]);
    // The next round asks both, and no option says which.
    let again = asked_next(&dir, "second", "--from pilot");
    assert_eq!(again, [&asked[0], &asked[1]].map(|(_, query)| query.clone()).into());
}

#[test]
fn no_second_panel_overrules_a_rejection_of_the_same_words() {
    let dir = bench();
    // Both rounds are open before either is judged.
    let (_, _, key) = opened(&dir, "first", "--sample 6");
    opened(&dir, "second", "--sample 6");
    let (item, query) = queries(&key)[0].clone();
    panel_votes(&dir, "first", "ada", &BTreeMap::from([(item, choose(Choice::None))]));
    panel_votes(&dir, "second", "", &BTreeMap::new());
    for _ in 0..2 {
        for round in ["first", "second"] {
            dir.succeed(format!("verdict {round}"));
            assert_eq!(statuses(&dir)[&query], Status::Rejected, "after {round}");
        }
    }
    open_round(&dir, "third", "--queries rejected").says(2, &["in round first"]);
}

#[test]
fn programs_verify_nothing() {
    let dir = bench();
    let (_, round, key) = opened(&dir, "play", "--sample 8 --simulated");
    assert!(round.simulated);
    let untouched = query_files(&dir);
    let (item, query) = queries(&key)[0].clone();
    panel_votes(&dir, "play", "ada", &BTreeMap::from([(item, choose(Choice::None))]));
    let run = dir.succeed("verdict play");
    assert!(run.stdout.starts_with("SIMULATED"), "{run}");
    run.says(0, &["no query has another status"]);
    assert!(dir.path("annotation/rounds/play/verdicts.csv").exists());
    assert_eq!(query_files(&dir), untouched);
    check(&dir, "play").says(0, &[]);
    // Their list is worked off like any other, but people may still be asked.
    open_round(&dir, "play2", "--from play --simulated").says(2, &[&query.to_string()]);
    assert!(asked_next(&dir, "people", "").contains(&query));
}

#[test]
fn derived_files_and_statuses_are_checked_to_the_byte() {
    let dir = bench();
    let (_, _, key) = opened(&dir, "pilot", "--sample 6");
    panel_votes(&dir, "pilot", "", &BTreeMap::new());
    check(&dir, "pilot").says(1, &["error[L4D530]"]);
    dir.succeed("verdict pilot");
    check(&dir, "pilot").says(0, &[]);

    let table = dir.read("annotation/rounds/pilot/verdicts.csv");
    dir.write("annotation/rounds/pilot/verdicts.csv", table.replacen(",5,5,", ",4,5,", 1));
    check(&dir, "pilot").says(1, &["are not what the votes give"]);
    dir.write("annotation/rounds/pilot/verdicts.csv", table);

    let query = &queries(&key)[0].1;
    let text = dir.read(&file_of(query));
    let line = text.lines().find(|line| line.contains(&query.to_string())).unwrap();
    dir.edit(&file_of(query), line, &line.replace("\"verified\"", "\"candidate\""));
    check(&dir, "pilot").says(1, &["L4D531"]);
}

#[test]
fn rounds_that_cannot_be_opened_say_why() {
    let dir = bench();
    for (more, message) in [
        ("--queries rejected", "no query to ask about"),
        ("--from nowhere", "there is no such round"),
        ("--scenes nowhere", "has no scene `nowhere`"),
    ] {
        open_round(&dir, "r", more).refused(&[message]);
    }
    dir.refuses("open-round r --annotators ada,ben", &["annotators"]);
    dir.refuses("verdict nowhere", &["there is no such round"]);
    open_round(&dir, "../r", "").says(2, &["is not a name"]);
    assert!(!dir.path("annotation").exists());

    opened(&dir, "r", "--sample 6");
    open_round(&dir, "r", "--sample 6").refused(&["there is such a round already"]);
    opened(&dir, "r", "--sample 7 --force");
    let (folder, round, _) = read_round(&dir, "r");
    let unknown = Ballot::open(&folder, &round, &Name::new("zoe").unwrap()).unwrap_err();
    assert!(unknown.to_string().contains("zoe") && unknown.hint().contains("ada"), "{unknown}");
    vote(&dir, "r", "ada", &BTreeMap::new());
    open_round(&dir, "r", "--force").refused(&["people have voted in this round"]);
    dir.refuses("verify-prompts nowhere --as ada", &["there is no such round"]);
    dir.refuses("verify-prompts r --as zoe", &["zoe"]);
}

#[test]
fn files_that_annotators_open_hold_no_answers() {
    let dir = bench();
    let (_, _, key) = opened(&dir, "pilot", "--composites");
    let shown =
        ["items.jsonl", "round.toml"].map(|file| dir.read(&format!("annotation/rounds/pilot/{file}")));
    let shown = shown.concat();
    for source in key.entries().values() {
        if let ItemSource::Query { query, meaning, .. } = source {
            assert!(!shown.contains(&query.to_string()));
            assert!(meaning.referents.iter().all(|name| !shown.contains(&format!("\"{name}\""))), "{query}");
        }
    }
    // Whether an item is a query, a control or a repeat does not show in its number.
    let kinds: Vec<bool> =
        key.entries().values().map(|source| matches!(source, ItemSource::Query { .. })).collect();
    let (first, second) = kinds.split_at(kinds.len() / 2);
    assert!(first.contains(&false) && second.contains(&false), "{kinds:?}");
}
