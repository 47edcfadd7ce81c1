//! Small rounds for tests.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

use l4d_data::layout::BenchDir;
use l4d_data::{Benchmark, Category, Interval, Name, Profile, Temporal, json};

use crate::item::{Item, ItemId};
use crate::key::{ItemSource, Key, Meaning};
use crate::responses::Responses;
use crate::round::{Gold, Round, RoundSettings, SCHEMA};
use crate::round_dir::RoundDir;
use crate::vote::{Answer, Choice, Response};

pub(crate) fn name(text: &str) -> Name {
    Name::new(text).unwrap()
}

/// Items `q0001` and on about one scene.
pub(crate) fn items(scene: &str, prompts: &[&str]) -> Vec<Item> {
    let item = |(index, text): (usize, &&str)| Item {
        id: ItemId::numbered(index + 1, prompts.len()),
        scene: name(scene),
        text: (*text).to_owned(),
        digest: format!("{:064x}", index + 1),
    };
    prompts.iter().enumerate().map(item).collect()
}

pub(crate) fn settings(annotators: &[&str]) -> RoundSettings {
    RoundSettings {
        schema: SCHEMA.to_owned(),
        name: name("r1"),
        profile: Profile::Tiny,
        seed: 7,
        annotators: annotators.iter().map(|annotator| name(annotator)).collect(),
        simulated: true,
        views: 3,
        repeats: 0,
        gold: Gold::default(),
    }
}

/// The round `r1` of these annotators.
pub(crate) fn round_of(annotators: &[&str], items: Vec<Item>) -> Round {
    Round::new(&RoundDir::new("r1"), settings(annotators), items, "mend the test").unwrap()
}

/// A clock that stands still.
pub(crate) fn noon() -> SystemTime {
    SystemTime::UNIX_EPOCH + Duration::from_secs(1_700_000_000)
}

pub(crate) fn interval(first: u32, last: u32) -> Interval {
    Interval::new(first, last).unwrap()
}

pub(crate) fn objects(names: &[&str]) -> Choice {
    Choice::Objects(names.iter().map(|text| name(text)).collect())
}

pub(crate) fn whole(choice: Choice) -> Answer {
    Answer { choice, frames: Interval::WHOLE }
}

pub(crate) fn meaning(referents: &[&str], temporal: Temporal, frames: Interval) -> Meaning {
    let referents = referents.iter().map(|text| name(text)).collect();
    Meaning { referents, temporal, frames: vec![frames], tracks: "0".repeat(64) }
}

/// What an annotator says to a query that means `tabby` while frames 40 to 60: `+` right, `x` and `X` other objects, `0`
/// none, `?` ambiguous, `t` other frames, `s` skipped, `~` an answer to an earlier wording, `.` nothing.
pub(crate) fn response(letter: char) -> Response {
    let choice = match letter {
        '+' | 't' | '~' => objects(&["tabby"]),
        'x' => objects(&["ginger"]),
        'X' => objects(&["ginger", "tabby"]),
        '0' => Choice::None,
        '?' => Choice::Ambiguous { reason: "two sit".to_owned() },
        letter => return Response { skipped: letter == 's', ..Response::default() },
    };
    let frames = if letter == 't' { interval(61, 96) } else { Interval::WHOLE };
    let answer = Some(Answer { choice, frames });
    match letter {
        '~' => Response { stale: answer, ..Response::default() },
        _ => Response { answer, ..Response::default() },
    }
}

/// The round `r1` that asks these queries, with its key: scene, text and meaning; categories take turns.
pub(crate) fn round_and_key(annotators: &[&str], queries: Vec<(String, String, Meaning)>) -> (Round, Key) {
    let (mut items, mut entries) = (Vec::new(), BTreeMap::new());
    let count = queries.len();
    for (index, (scene, text, meaning)) in queries.into_iter().enumerate() {
        let id = ItemId::numbered(index + 1, count);
        items.push(Item { id: id.clone(), scene: name(&scene), digest: meaning.digest(&text), text });
        let query = format!("{scene}/{:03}", index + 1).parse().unwrap();
        let categories = vec![Category::ALL[index % 4]];
        entries.insert(id, ItemSource::Query { query, categories, meaning });
    }
    (round_of(annotators, items), Key::new(entries))
}

/// A round of one query per scene, all sealed: what each means and what each annotator says to it.
pub(crate) fn poll(
    annotators: &[&str],
    queries: &[(Meaning, Vec<Response>)],
) -> (Round, Key, Vec<Responses>) {
    poll_in(queries.len(), annotators, queries)
}

/// The same with so many scenes in turn.
pub(crate) fn poll_in(
    scenes: usize,
    annotators: &[&str],
    queries: &[(Meaning, Vec<Response>)],
) -> (Round, Key, Vec<Responses>) {
    let asked = queries.iter().enumerate().map(|(index, (meaning, _))| {
        (format!("s{}", index % scenes + 1), format!("The cat number {index}"), meaning.clone())
    });
    let (round, key) = round_and_key(annotators, asked.collect());
    let given = |(place, annotator): (usize, &&str)| {
        let said =
            round.items.iter().zip(queries).map(|(item, (_, said))| (item.id.clone(), said[place].clone()));
        Responses { annotator: name(annotator), sealed: true, items: said.collect() }
    };
    let given = annotators.iter().enumerate().map(given).collect();
    (round, key, given)
}

/// A folder in memory where there is one: some tests sync often.
pub(crate) fn folder() -> (tempfile::TempDir, RoundDir) {
    let memory = Path::new("/dev/shm");
    let made = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    let made = made.unwrap();
    let dir = RoundDir::new(made.path().join("r1"));
    (made, dir)
}

/// Writes the three files of a round over those of an earlier one.
pub(crate) fn save(dir: &RoundDir, round: &Round, key: &Key) {
    fs::create_dir_all(dir.root()).unwrap();
    fs::write(dir.settings(), toml::to_string(&round.settings).unwrap()).unwrap();
    json::write_lines(&dir.items(), &round.items).unwrap();
    key.write(dir).unwrap();
}

/// One scene of the repository's benchmark in a folder of its own, to be edited.
pub(crate) fn copy_of_one_scene(folder: &Path, scene: &str) -> Benchmark {
    let from = BenchDir::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark"));
    let to = BenchDir::new(folder);
    fs::create_dir_all(folder.join("queries")).unwrap();
    fs::create_dir_all(folder.join("scenes")).unwrap();
    for path in [BenchDir::tracks, BenchDir::queries, BenchDir::composites, BenchDir::absents] {
        fs::copy(path(&from, scene), path(&to, scene)).unwrap();
    }
    let manifest =
        format!("name = \"P\"\nversion = \"1.0.0\"\nlicence = \"CC-BY-4.0\"\nscenes = [\"{scene}\"]\n");
    fs::write(to.manifest(), manifest).unwrap();
    Benchmark::open(folder).unwrap()
}
