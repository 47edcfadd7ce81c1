//! Rounds on disk, written by hand as the format says.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use l4d_data::{Interval, Name, Temporal};
use l4d_votes::key::Meaning;
use l4d_votes::{Answer, Choice, Key, Round, RoundDir};
use serde_json::json;

/// One query that a round asks.
pub(crate) struct Asked {
    pub(crate) scene: String,
    pub(crate) text: String,
    pub(crate) category: &'static str,
    pub(crate) meaning: Meaning,
}

impl Asked {
    pub(crate) fn digest(&self) -> String {
        self.meaning.digest(&self.text)
    }
}

pub(crate) fn name(text: &str) -> Name {
    Name::new(text).unwrap()
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
    let referents: BTreeSet<Name> = referents.iter().map(|text| name(text)).collect();
    Meaning { referents, temporal, frames: vec![frames], tracks: "0".repeat(64) }
}

/// A folder in memory where there is one: these tests sync thousands of times.
pub(crate) fn folder() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    let made = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    made.unwrap()
}

/// Writes the three files of the round `r1` over what stands there.
pub(crate) fn write(dir: &RoundDir, annotators: &[&str], rule: &str, frames: &str, asked: &[Asked]) {
    fs::create_dir_all(dir.root()).unwrap();
    let settings = format!(
        "schema = \"l4d/round/1\"\nname = \"r1\"\ntitle = \"A test\"\nprofile = \"tiny\"\nseed = 1\n\
         annotators = {annotators:?}\nrule = \"{rule}\"\nframes = \"{frames}\"\nsimulated = true\nviews = 3\n"
    );
    fs::write(dir.settings(), settings).unwrap();
    let mut items = String::new();
    let mut key = String::new();
    for (index, asked) in asked.iter().enumerate() {
        let item = format!("q{:04}", index + 1);
        let Asked { scene, text, category, meaning } = asked;
        let query = format!("{scene}/{:03}", index + 1);
        let line = json!({ "item": item, "scene": scene, "text": text, "digest": asked.digest() });
        items.push_str(&format!("{line}\n"));
        let line = json!({
            "item": item, "kind": "query", "query": query, "categories": [category], "meaning": meaning,
        });
        key.push_str(&format!("{line}\n"));
    }
    fs::write(dir.items(), items).unwrap();
    fs::write(dir.key(), key).unwrap();
}

pub(crate) fn open(dir: &RoundDir) -> (Round, Key) {
    let round = Round::open(dir).unwrap();
    let key = Key::read(dir, &round).unwrap();
    (round, key)
}
