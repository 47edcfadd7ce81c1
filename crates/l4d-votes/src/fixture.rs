//! Small rounds for tests.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

use l4d_data::layout::BenchDir;
use l4d_data::{Benchmark, Category, Interval, Name, Profile};

use crate::event::Choice;
use crate::item::{Item, ItemId};
use crate::key::{Behind, Key, Meaning};
use crate::round::{Gold, Round, RoundDir, SCHEMA, Settings};
use crate::rule::{FrameRule, Rule};
use crate::sheet::{Sheet, Standing};

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

pub(crate) fn settings(annotators: &[&str]) -> Settings {
    Settings {
        schema: SCHEMA.to_owned(),
        name: name("r1"),
        title: "A test".to_owned(),
        profile: Profile::Tiny,
        seed: 7,
        annotators: annotators.iter().map(|annotator| name(annotator)).collect(),
        rule: Rule { needed: annotators.len(), annotators: annotators.len() },
        frames: FrameRule::Any,
        simulated: true,
        views: 3,
        repeats: 0,
        gold: Gold::default(),
    }
}

/// The round `r1` of these annotators, unanimous.
pub(crate) fn round_of(annotators: &[&str], items: Vec<Item>) -> Round {
    Round::new(&RoundDir::new("r1"), settings(annotators), items)
}

/// A clock that stands.
pub(crate) fn noon() -> SystemTime {
    SystemTime::UNIX_EPOCH + Duration::from_secs(1_700_000_000)
}

pub(crate) fn interval(first: u32, last: u32) -> Interval {
    Interval::new(first, last).unwrap()
}

pub(crate) fn objects(names: &[&str]) -> Choice {
    Choice::Objects(names.iter().map(|text| name(text)).collect())
}

/// A round of one query a scene, all sealed: what each means and what each annotator says to it. Scenes are `s1`
/// and on, categories take turns.
pub(crate) fn poll(annotators: &[&str], queries: &[(Meaning, Vec<Standing>)]) -> (Round, Key, Vec<Sheet>) {
    let mut asked = items("room", &vec!["The cat"; queries.len()]);
    let mut entries = BTreeMap::new();
    for (index, (item, (meaning, _))) in asked.iter_mut().zip(queries).enumerate() {
        item.scene = name(&format!("s{}", index + 1));
        item.digest = meaning.digest(&item.text);
        let query = format!("{}/001", item.scene).parse().unwrap();
        let categories = vec![Category::ALL[index % 4]];
        entries.insert(item.id.clone(), Behind::Query { query, categories, meaning: meaning.clone() });
    }
    let sheet = |(place, annotator): (usize, &&str)| {
        let said = asked.iter().zip(queries).map(|(item, (_, said))| (item.id.clone(), said[place].clone()));
        Sheet { annotator: name(annotator), sealed: true, items: said.collect() }
    };
    let sheets = annotators.iter().enumerate().map(sheet).collect();
    (round_of(annotators, asked), Key::new(entries), sheets)
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
