use std::fs;

use l4d_data::Query;

use super::*;
use crate::draw::draw_round;
use crate::fixture::{copy_of_one_scene, interval, meaning, name, objects, settings, whole};
use crate::round::{Gold, RoundSettings};

const SCENE: &str = "room_living_cats";

struct Kit {
    _folder: tempfile::TempDir,
    bench: Benchmark,
    dir: RoundDir,
    round: Round,
    key: Key,
}

fn kit() -> Kit {
    let folder = tempfile::tempdir().unwrap();
    let bench = copy_of_one_scene(&folder.path().join("bench"), SCENE);
    let dir = RoundDir::new(folder.path().join("r1"));
    let gold = Gold { absent: 1, vague: 1 };
    let settings = RoundSettings { seed: 3, repeats: 2, gold, ..settings(&["ada"]) };
    let scene = name(SCENE);
    let all = [bench.queries(&scene).unwrap(), bench.composites(&scene).unwrap()].concat();
    let asked = all.into_iter().map(|query| query.id).collect();
    let (round, key) = draw_round(settings, &[scene], &asked, &bench).unwrap();
    round.write(&dir, &key).unwrap();
    let round = Round::open(&dir).unwrap();
    Kit { _folder: folder, bench, dir, round, key }
}

fn item_of(key: &Key, is_meant: impl Fn(&ItemSource) -> bool) -> ItemId {
    key.entries().iter().find(|(_, source)| is_meant(source)).unwrap().0.clone()
}

/// What of the round changed with an edit of a file.
fn changed(kit: &Kit, path: &std::path::Path, edit: impl Fn(&str) -> String) -> Vec<ItemId> {
    let before = fs::read_to_string(path).unwrap();
    let after = edit(&before);
    assert_ne!(before, after);
    fs::write(path, after).unwrap();
    let all = changes(&kit.round, &kit.key, &kit.bench).unwrap();
    fs::write(path, before).unwrap();
    all.into_iter().filter(|(_, change)| *change != Change::No).map(|(id, _)| id).collect()
}

#[test]
fn edits_of_text_referents_time_and_scene_change_the_digest_and_status_does_not() {
    let kit = kit();
    let path = kit.bench.dir.queries(SCENE);
    let first: QueryId = format!("{SCENE}/001").parse().unwrap();
    let asks_first =
        |source: &ItemSource| matches!(source, ItemSource::Query { query, .. } if *query == first);
    let mut expected = vec![item_of(&kit.key, asks_first)];
    let again = |source: &ItemSource| matches!(source, ItemSource::Repeat { of } if *of == expected[0]);
    let repeat = kit.key.entries().iter().find(|(_, source)| again(source)).map(|(id, _)| id.clone());
    expected.extend(repeat);

    let edit = |change: &dyn Fn(&mut Query)| {
        changed(&kit, &path, |text| {
            let line = text.lines().next().unwrap();
            let mut query: Query = serde_json::from_str(line).unwrap();
            change(&mut query);
            query.text_digest = l4d_data::query::text_digest(&query.text, query.predicate.as_ref());
            text.replacen(line, &serde_json::to_string(&query).unwrap(), 1)
        })
    };
    assert_eq!(edit(&|query| query.text = "The ginger cat".to_owned()), expected);
    assert_eq!(edit(&|query| query.referents = vec![name("cat_walker")]), expected);
    assert_eq!(edit(&|query| query.temporal = Temporal::While), expected);
    assert_eq!(edit(&|query| query.frames = vec![interval(0, 40)]), expected);
    assert_eq!(edit(&|query| query.id.number = name("099")), expected);
    assert_eq!(edit(&|query| query.status = l4d_data::Status::Rejected), []);
    assert_eq!(edit(&|query| query.provenance.note = "looked at twice".to_owned()), []);

    let tracks = kit.bench.dir.tracks(SCENE);
    let all: Vec<ItemId> = kit.round.items.iter().map(|item| item.id.clone()).collect();
    assert_eq!(
        changed(&kit, &tracks, |text| text.replacen("\"exposure\":1.12", "\"exposure\":1.13", 1)),
        all
    );
}

#[test]
fn a_scene_that_left_the_benchmark_is_gone() {
    let Kit { mut bench, round, key, _folder, .. } = kit();
    bench.manifest.scenes.clear();
    assert!(changes(&round, &key, &bench).unwrap().values().all(|change| *change == Change::Gone));
}

#[test]
fn a_key_that_was_edited_does_not_fit() {
    let Kit { dir, round, key, _folder, .. } = kit();
    let good = fs::read_to_string(dir.key()).unwrap();
    assert_eq!(Key::read(&dir, &round).unwrap(), key);
    let first = good.lines().next().unwrap();
    let query = good.lines().find(|line| line.contains("\"kind\":\"query\"")).unwrap();
    let repeat = good.lines().find(|line| line.contains("\"kind\":\"repeat\"")).unwrap();
    let of = format!("\"of\":\"{}\"", round.items[0].id);
    let other: String = repeat[..repeat.find("\"of\"").unwrap()].to_owned() + &of + "}";
    for (bad, expected) in [
        (good.replacen("\"whole\"", "\"while\"", 1), "does not fit the digest"),
        (good.replace("[[0,96]]", "[[0,95]]"), "does not fit the digest"),
        (good.replacen("\"cat_player\"", "\"cat_walker\"", 1), "does not fit the digest"),
        (good.replacen(first, "", 1), "is missing"),
        (format!("{good}{first}\n"), "is listed twice"),
        (good.replacen("\"q0001\"", "\"q0999\"", 1), "q0999: the round does not ask it"),
        (good.replacen("\"kind\":\"query\"", "\"kind\":\"guess\"", 1), "line"),
        (good.replacen(query, &query.replace(&format!("{SCENE}/"), "room_gym/"), 1), "another scene"),
        (good.replacen(repeat, &other, 1), "is no repeat of q0001"),
        (good.replacen(query, "{\"item\":", 1), "line"),
    ] {
        assert_ne!(bad, good, "{expected}");
        fs::write(dir.key(), &bad).unwrap();
        let error = Key::read(&dir, &round).unwrap_err();
        assert!(error.to_string().contains(expected), "{error} instead of {expected}");
    }
}

#[test]
fn only_a_sentence_that_is_bound_to_a_time_asks_for_frames() {
    let mut meaning = meaning(&["a", "b"], Temporal::While, interval(0, 12));
    meaning.frames.push(interval(50, 80));
    let answer = |names: &[&str], frames| Answer { choice: objects(names), frames };
    let mark = |meaning: &Meaning, names, frames| meaning.mark(&answer(names, frames));
    for (frames, expected) in [
        (interval(70, 96), Mark::Right),
        (interval(12, 49), Mark::Right),
        (interval(0, 96), Mark::Right),
        (interval(13, 49), Mark::OtherFrames),
        (interval(81, u32::MAX), Mark::OtherFrames),
    ] {
        assert_eq!(mark(&meaning, &["b", "a"], frames), expected);
    }
    assert_eq!(mark(&meaning, &["a"], Interval::WHOLE), Mark::OtherObjects);
    meaning.temporal = Temporal::Whole;
    assert_eq!(mark(&meaning, &["a", "b"], interval(13, 49)), Mark::Right);
}

#[test]
fn controls_know_their_right_answers() {
    let Kit { key, .. } = kit();
    let ambiguous = || whole(Choice::Ambiguous { reason: "three".to_owned() });
    for source in key.entries().values() {
        match source {
            ItemSource::Absent { .. } => {
                assert_eq!(source.gold(&whole(Choice::None)), Some(true));
                assert_eq!(source.gold(&ambiguous()), Some(false));
                assert_eq!(source.gold(&whole(objects(&["cat_player"]))), Some(false));
            }
            ItemSource::Vague { meaning, .. } => {
                assert_eq!(source.gold(&ambiguous()), Some(true));
                assert_eq!(source.gold(&whole(Choice::Objects(meaning.referents.clone()))), Some(true));
                assert_eq!(source.gold(&whole(Choice::None)), Some(false));
                assert_eq!(source.gold(&whole(objects(&["cat_player"]))), Some(false));
            }
            ItemSource::Query { .. } | ItemSource::Repeat { .. } => {
                assert_eq!(source.gold(&ambiguous()), None);
            }
        }
    }
}
