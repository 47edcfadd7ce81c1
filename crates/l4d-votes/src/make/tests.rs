use l4d_data::query::text_digest;

use super::*;
use crate::fixture::{copy_of_one_scene, name};

/// The benchmark of the repository.
fn bench() -> Benchmark {
    Benchmark::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark")).unwrap()
}

fn plan(scenes: &[&str]) -> RoundPlan {
    RoundPlan {
        name: name("r1"),
        title: "A test".to_owned(),
        profile: Profile::Tiny,
        seed: 1,
        annotators: vec![name("ada"), name("ben")],
        rule: "unanimous:2".parse().unwrap(),
        frames: FrameRule::Any,
        simulated: true,
        views: 3,
        repeats: 4,
        gold: Gold { absent: 2, vague: 2, ..Gold::default() },
        scenes: scenes.iter().map(|scene| name(scene)).collect(),
        composites: false,
        only: None,
    }
}

fn count(key: &Key, is_meant: impl Fn(&Behind) -> bool) -> usize {
    key.entries().values().filter(|behind| is_meant(behind)).count()
}

#[test]
fn a_round_asks_every_candidate_and_what_was_wanted_beside() {
    let bench = bench();
    let scenes = ["room_living_cats", "tabletop_tea"];
    let candidates: usize = scenes
        .iter()
        .flat_map(|scene| bench.queries(&name(scene)).unwrap())
        .filter(|query| query.status == Status::Candidate)
        .count();
    let (round, key) = make_round(&plan(&scenes), &bench).unwrap();
    assert_eq!(round.items.len(), candidates + 2 + 2 + 4);
    assert_eq!(count(&key, |behind| matches!(behind, Behind::Query { .. })), candidates);
    assert_eq!(count(&key, |behind| matches!(behind, Behind::Absent { .. })), 2);
    assert_eq!(count(&key, |behind| matches!(behind, Behind::Vague { .. })), 2);
    assert_eq!(count(&key, |behind| matches!(behind, Behind::Repeat { .. })), 4);
}

#[test]
fn a_round_comes_back_from_its_files_and_is_never_replaced() {
    let (round, key) = make_round(&plan(&["room_living_cats"]), &bench()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let dir = RoundDir::new(folder.path().join("r1"));
    write_round(&dir, &round, &key).unwrap();
    let read = Round::open(&dir).unwrap();
    assert_eq!((&read.items, read.settings()), (&round.items, round.settings()));
    assert_eq!(Key::read(&dir, &read).unwrap(), key);
    let error = write_round(&dir, &round, &key).unwrap_err();
    assert!(error.to_string().contains("already"), "{error}");
}

#[test]
fn items_and_ids_give_nothing_away() {
    let (round, key) =
        make_round(&plan(&["room_living_cats", "tabletop_tea", "room_gym"]), &bench()).unwrap();
    let lines: Vec<String> = round.items.iter().map(|item| serde_json::to_string(item).unwrap()).collect();
    for line in &lines {
        let fields: Vec<String> =
            serde_json::from_str::<serde_json::Map<_, _>>(line).unwrap().keys().cloned().collect();
        assert_eq!(fields, ["item", "scene", "text", "digest"]);
    }
    // Neither controls nor repeats nor scenes stand together: the ids were dealt to a shuffled pile.
    let kinds: Vec<bool> =
        key.entries().values().map(|behind| matches!(behind, Behind::Query { .. })).collect();
    assert!(!kinds.is_sorted() && !kinds.iter().rev().is_sorted(), "{kinds:?}");
    let scenes: Vec<&Name> = round.items.iter().map(|item| &item.scene).collect();
    let changes = scenes.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(changes > scenes.len() / 3, "{changes} changes among {} items", scenes.len());
}

#[test]
fn a_repeat_has_the_words_and_the_digest_of_its_original_and_a_larger_id() {
    let (round, key) = make_round(&RoundPlan { repeats: 99, ..plan(&["tabletop_tea"]) }, &bench()).unwrap();
    let queries = count(&key, |behind| matches!(behind, Behind::Query { .. }));
    assert_eq!(count(&key, |behind| matches!(behind, Behind::Repeat { .. })), queries);
    for (id, behind) in key.entries() {
        if let Behind::Repeat { of } = behind {
            let (original, again) = (round.item(of).unwrap(), round.item(id).unwrap());
            assert_eq!((&original.text, &original.digest), (&again.text, &again.digest));
            assert!(of < id);
        }
    }
}

#[test]
fn a_seed_draws_the_same_round_and_another_seed_another() {
    let draw = |seed| make_round(&RoundPlan { seed, ..plan(&["room_gym"]) }, &bench()).unwrap();
    assert_eq!(draw(5), draw(5));
    assert_ne!(draw(5).0.items, draw(6).0.items);
}

#[test]
fn exactly_the_listed_queries_are_asked_composites_too() {
    let only: BTreeSet<QueryId> =
        ["room_living_cats/002", "room_living_cats/501"].map(|id| id.parse().unwrap()).into();
    let (_, key) =
        make_round(&RoundPlan { only: Some(only.clone()), ..plan(&["room_living_cats"]) }, &bench()).unwrap();
    let asked: BTreeSet<QueryId> = key
        .entries()
        .values()
        .filter_map(
            |behind| if let Behind::Query { query, .. } = behind { Some(query.clone()) } else { None },
        )
        .collect();
    assert_eq!(asked, only);
}

#[test]
fn control_items_come_from_scenes_that_are_asked_about() {
    let only = Some(BTreeSet::from(["room_gym/001".parse().unwrap()]));
    let wide = RoundPlan {
        only,
        gold: Gold { absent: 99, vague: 99, ..Gold::default() },
        ..plan(&["room_gym", "tabletop_tea"])
    };
    let (round, key) = make_round(&wide, &bench()).unwrap();
    assert!(round.items.iter().all(|item| item.scene.as_str() == "room_gym"));
    // Dumbbells and athletes.
    assert_eq!(count(&key, |behind| matches!(behind, Behind::Vague { .. })), 2);
}

#[test]
fn the_bare_category_means_all_of_its_objects() {
    let (round, key) = make_round(&plan(&["room_living_cats"]), &bench()).unwrap();
    for (id, behind) in key.entries() {
        if let Behind::Vague { category, meaning } = behind {
            assert_eq!(round.item(id).unwrap().text, format!("The {category}"));
            assert_eq!(meaning.referents.len(), 3);
        }
    }
}

#[test]
fn what_is_not_there_is_not_asked() {
    let bench = bench();
    let error = |plan: RoundPlan| make_round(&plan, &bench).unwrap_err().to_string();
    assert!(error(plan(&["room_nowhere"])).contains("has no scene `room_nowhere`"));
    let other = Some(BTreeSet::from(["tabletop_tea/001".parse().unwrap()]));
    assert!(
        error(RoundPlan { only: other, ..plan(&["room_gym"]) })
            .contains("no `tabletop_tea/001` in the chosen")
    );
    let nothing = Some(BTreeSet::new());
    assert!(error(RoundPlan { only: nothing, ..plan(&["room_gym"]) }).contains("nothing is left to ask"));
    let alone = RoundPlan { annotators: vec![name("ada")], ..plan(&["room_gym"]) };
    assert!(error(alone).contains("field `annotators`"));
    assert!(error(RoundPlan { seed: u64::MAX, ..plan(&["room_gym"]) }).contains("field `seed`"));
}

#[test]
fn a_control_item_never_has_the_words_of_a_query() {
    let folder = tempfile::tempdir().unwrap();
    let bench = copy_of_one_scene(folder.path(), "room_living_cats");
    let scene = name("room_living_cats");
    let reword = |path: std::path::PathBuf, mut query: Query, text: &str| {
        query.text = text.to_owned();
        query.text_digest = text_digest(text, query.predicate.as_ref());
        json::write_lines(&path, &[query]).unwrap();
    };
    let query = bench.queries(&scene).unwrap().remove(0);
    reword(bench.dir.queries(&scene), query, "The cat");
    let absent = bench.absents(&scene).unwrap().remove(0);
    reword(bench.dir.absents(&scene), absent, "The cat");
    let gold = Gold { absent: 9, vague: 9, ..Gold::default() };
    let (round, _) =
        make_round(&RoundPlan { gold, repeats: 0, ..plan(&["room_living_cats"]) }, &bench).unwrap();
    let mut texts: Vec<&str> = round.items.iter().map(|item| item.text.as_str()).collect();
    texts.sort_unstable();
    assert_eq!(texts, ["The cat", "The toy"]);
}
