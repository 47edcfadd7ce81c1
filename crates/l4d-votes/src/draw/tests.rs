use l4d_data::query::text_digest;
use l4d_data::{Status, json};

use super::*;
use crate::fixture::{copy_of_one_scene, name, settings};
use crate::round::Gold;

/// The benchmark of the repository.
fn bench() -> Benchmark {
    Benchmark::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark")).unwrap()
}

/// Wanted beside the queries: two control items of each kind and four repeats.
fn wanted() -> RoundSettings {
    RoundSettings { seed: 1, repeats: 4, gold: Gold { absent: 2, vague: 2 }, ..settings(&["ada", "ben"]) }
}

/// All candidates of these scenes.
fn candidates(bench: &Benchmark, scenes: &[Name]) -> BTreeSet<QueryId> {
    let queries = scenes.iter().flat_map(|scene| bench.queries(scene).unwrap());
    queries.filter(|query| query.status == Status::Candidate).map(|query| query.id).collect()
}

fn draw(settings: RoundSettings, scenes: &[&str]) -> (Round, Key) {
    let (bench, scenes) = (bench(), names(scenes));
    draw_round(settings, &scenes, &candidates(&bench, &scenes), &bench).unwrap()
}

fn names(scenes: &[&str]) -> Vec<Name> {
    scenes.iter().map(|scene| name(scene)).collect()
}

fn ids<const N: usize>(ids: [&str; N]) -> BTreeSet<QueryId> {
    ids.map(|id| id.parse().unwrap()).into()
}

/// Queries, absent and vague control items, repeats.
fn kinds(key: &Key) -> [usize; 4] {
    let mut kinds = [0; 4];
    for source in key.entries().values() {
        kinds[match source {
            ItemSource::Query { .. } => 0,
            ItemSource::Absent { .. } => 1,
            ItemSource::Vague { .. } => 2,
            ItemSource::Repeat { .. } => 3,
        }] += 1;
    }
    kinds
}

#[test]
fn a_round_asks_every_candidate_and_what_was_wanted_beside() {
    let scenes = ["room_living_cats", "tabletop_tea"];
    let candidates = candidates(&bench(), &names(&scenes)).len();
    let (round, key) = draw(wanted(), &scenes);
    let expected = [candidates, 2, 2, 4];
    assert_eq!((kinds(&key), round.items.len()), (expected, expected.iter().sum()));
    for (id, source) in key.entries() {
        if let ItemSource::Repeat { of } = source {
            let (original, again) = (round.item(of).unwrap(), round.item(id).unwrap());
            assert_eq!((&original.text, &original.digest), (&again.text, &again.digest));
            assert!(of < id);
        }
    }
    // There are no more repeats than queries.
    let [queries, _, _, repeats] =
        kinds(&draw(RoundSettings { repeats: 99, ..wanted() }, &["tabletop_tea"]).1);
    assert_eq!(repeats, queries);
}

#[test]
fn a_round_comes_back_from_its_files() {
    let (round, key) = draw(wanted(), &["room_living_cats"]);
    let folder = tempfile::tempdir().unwrap();
    let dir = RoundDir::new(folder.path().join("r1"));
    round.write(&dir, &key).unwrap();
    let read = Round::open(&dir).unwrap();
    assert_eq!((&read.items, &read.settings), (&round.items, &round.settings));
    assert_eq!(Key::read(&dir, &read).unwrap(), key);
}

#[test]
fn a_seed_draws_the_same_round_and_another_seed_another() {
    let draw = |seed| draw(RoundSettings { seed, ..wanted() }, &["room_gym"]);
    assert_eq!(draw(5), draw(5));
    assert_ne!(draw(5).0.items, draw(6).0.items);
}

#[test]
fn exactly_the_listed_queries_are_asked_composites_too() {
    let only = ids(["room_living_cats/002", "room_living_cats/501"]);
    let (_, key) = draw_round(wanted(), &names(&["room_living_cats"]), &only, &bench()).unwrap();
    let query = |source: &ItemSource| match source {
        ItemSource::Query { query, .. } => Some(query.clone()),
        _ => None,
    };
    assert_eq!(key.entries().values().filter_map(query).collect::<BTreeSet<QueryId>>(), only);
}

#[test]
fn control_items_come_from_scenes_that_are_asked_about() {
    let wide = RoundSettings { gold: Gold { absent: 99, vague: 99 }, ..wanted() };
    let scenes = names(&["room_gym", "tabletop_tea"]);
    let (round, key) = draw_round(wide, &scenes, &ids(["room_gym/001"]), &bench()).unwrap();
    assert!(round.items.iter().all(|item| item.scene.as_str() == "room_gym"));
    // Dumbbells and athletes.
    assert_eq!(kinds(&key)[2], 2);
}

#[test]
fn the_bare_category_means_all_of_its_objects() {
    let (round, key) = draw(wanted(), &["room_living_cats"]);
    for (id, source) in key.entries() {
        if let ItemSource::Vague { category, meaning } = source {
            assert_eq!(round.item(id).unwrap().text, format!("The {category}"));
            assert_eq!(meaning.referents.len(), 3);
        }
    }
}

#[test]
fn what_is_not_there_is_not_asked() {
    let error = |settings: RoundSettings, scene: &str, asked: BTreeSet<QueryId>| {
        draw_round(settings, &names(&[scene]), &asked, &bench()).unwrap_err().to_string()
    };
    let first = || ids(["room_gym/001"]);
    assert!(error(wanted(), "room_nowhere", first()).contains("has no scene `room_nowhere`"));
    let other = error(wanted(), "room_gym", ids(["tabletop_tea/001"]));
    assert!(other.contains("no `tabletop_tea/001` in the chosen"), "{other}");
    assert!(error(wanted(), "room_gym", BTreeSet::new()).contains("nothing is left to ask"));
    let alone = RoundSettings { annotators: Vec::new(), ..wanted() };
    assert!(error(alone, "room_gym", first()).contains("field `annotators`"));
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
    let gold = Gold { absent: 9, vague: 9 };
    let settings = RoundSettings { gold, repeats: 0, ..wanted() };
    let scenes = [scene];
    let (round, _) = draw_round(settings, &scenes, &candidates(&bench, &scenes), &bench).unwrap();
    let mut texts: Vec<&str> = round.items.iter().map(|item| item.text.as_str()).collect();
    texts.sort_unstable();
    assert_eq!(texts, ["The cat", "The toy"]);
}
