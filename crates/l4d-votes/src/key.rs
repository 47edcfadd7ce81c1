//! What the items were drawn from: `key.jsonl`. Only a verdict opens it.
//!
//! The key keeps what each prompt meant when the round was opened, so that votes can be read against it for good.
//! The digest of an item covers its prompt and this meaning: a key that was edited doesn't fit its items, and a
//! benchmark that was edited doesn't fit the round.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::digest::sha256_hex;
use l4d_data::{Benchmark, Category, DataError, Interval, Name, QueryId, Temporal, json};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::item::{Item, ItemId};
use crate::round::Round;
use crate::round_dir::RoundDir;
use crate::scene::SceneNow;
use crate::verdict::Mark;
use crate::vote::{Answer, Choice};

/// What a prompt means, and in which version of its scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Meaning {
    pub referents: BTreeSet<Name>,
    /// How the sentence binds time.
    pub temporal: Temporal,
    /// When it holds, ascending.
    pub frames: Vec<Interval>,
    /// SHA-256 of the scene's tracks, or of the truth of a real one.
    pub tracks: String,
}

impl Meaning {
    /// Ties a prompt to this meaning: what a vote is bound to. The status of a query is no part of it.
    pub fn digest(&self, text: &str) -> String {
        let Self { referents, temporal, frames, tracks } = self;
        let document = json!({
            "frames": frames,
            "referents": referents,
            "temporal": temporal,
            "text": text,
            "tracks": tracks,
        });
        sha256_hex(json::canonical(&document).as_bytes())
    }

    /// An answer to a query against this meaning. A sentence that is bound to a time needs a frame in common; one that
    /// names an identity takes any.
    pub fn mark(&self, answer: &Answer) -> Mark {
        match &answer.choice {
            Choice::None => Mark::SaidNone,
            Choice::Ambiguous { .. } => Mark::SaidAmbiguous,
            Choice::Objects(objects) if *objects != self.referents => Mark::OtherObjects,
            Choice::Objects(_) if self.temporal == Temporal::Whole => Mark::Right,
            Choice::Objects(_) if self.frames.iter().any(|holds| overlap(*holds, answer.frames)) => {
                Mark::Right
            }
            Choice::Objects(_) => Mark::OtherFrames,
        }
    }
}

fn overlap(a: Interval, b: Interval) -> bool {
    a.first() <= b.last() && b.first() <= a.last()
}

/// What an item was drawn from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum ItemSource {
    /// A query that is voted on.
    Query {
        query: QueryId,
        categories: Vec<Category>,
        /// The right answer.
        meaning: Meaning,
    },
    /// Control: a sentence that nothing satisfies.
    Absent {
        query: QueryId,
        /// Nothing, in which scene.
        meaning: Meaning,
    },
    /// Control: the bare category of look-alikes.
    Vague {
        category: String,
        /// All of them.
        meaning: Meaning,
    },
    /// Control: a prompt that is asked a second time.
    Repeat {
        /// The item that asks it first.
        of: ItemId,
    },
}

impl ItemSource {
    /// What the prompt means; a repeat means what its original does.
    pub fn meaning(&self) -> Option<&Meaning> {
        match self {
            Self::Query { meaning, .. } | Self::Absent { meaning, .. } | Self::Vague { meaning, .. } => {
                Some(meaning)
            }
            Self::Repeat { .. } => None,
        }
    }

    /// Whether an answer to this control item is right; none where it has no right answer of its own.
    pub fn gold(&self, answer: &Answer) -> Option<bool> {
        match (self, &answer.choice) {
            (Self::Absent { .. }, choice) => Some(*choice == Choice::None),
            (Self::Vague { .. }, Choice::Ambiguous { .. }) => Some(true),
            (Self::Vague { .. }, Choice::None) => Some(false),
            (Self::Vague { meaning, .. }, Choice::Objects(objects)) => Some(*objects == meaning.referents),
            (Self::Query { .. } | Self::Repeat { .. }, _) => None,
        }
    }
}

/// One line of `key.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct KeyLine {
    item: ItemId,
    #[serde(flatten)]
    source: ItemSource,
}

/// `key.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Key {
    entries: BTreeMap<ItemId, ItemSource>,
}

impl Key {
    /// Reads the key and checks it against the items.
    ///
    /// # Errors
    /// The file cannot be read, or does not fit the items of the round.
    pub fn read(dir: &RoundDir, round: &Round) -> Result<Self, DataError> {
        let path = dir.key();
        let hint = "restore the key.jsonl that `l4d open-round` wrote";
        let mut entries = BTreeMap::new();
        for (line, KeyLine { item, source }) in json::read_lines::<KeyLine>(&path)? {
            let place = format!("line {line}, item {item}");
            if entries.insert(item, source).is_some() {
                return Err(DataError::invalid(&path, place, "is listed twice", hint));
            }
        }
        let key = Self { entries };
        match key.problem(round) {
            None => Ok(key),
            Some((item, message)) => Err(DataError::invalid(&path, format!("item {item}"), message, hint)),
        }
    }

    pub(crate) fn new(entries: BTreeMap<ItemId, ItemSource>) -> Self {
        Self { entries }
    }

    pub(crate) fn write(&self, dir: &RoundDir) -> Result<(), DataError> {
        let line =
            |(item, source): (&ItemId, &ItemSource)| KeyLine { item: item.clone(), source: source.clone() };
        json::write_lines(&dir.key(), &self.entries.iter().map(line).collect::<Vec<_>>())
    }

    /// What an item was drawn from.
    pub fn source(&self, item: &ItemId) -> Option<&ItemSource> {
        self.entries.get(item)
    }

    /// All entries by item.
    pub fn entries(&self) -> &BTreeMap<ItemId, ItemSource> {
        &self.entries
    }

    fn problem(&self, round: &Round) -> Option<(ItemId, String)> {
        let unasked = self.entries.keys().find(|item| round.item(item).is_none());
        if let Some(item) = unasked {
            return Some((item.clone(), "the round does not ask it".to_owned()));
        }
        round.items.iter().find_map(|item| Some((item.id.clone(), self.item_problem(round, item)?)))
    }

    fn item_problem(&self, round: &Round, item: &Item) -> Option<String> {
        let Some(source) = self.entries.get(&item.id) else {
            return Some("is missing".to_owned());
        };
        if let ItemSource::Repeat { of } = source {
            let is_original = matches!(self.entries.get(of), Some(ItemSource::Query { .. }));
            let fits = round.item(of).is_some_and(|original| {
                (&original.scene, &original.text, &original.digest) == (&item.scene, &item.text, &item.digest)
            });
            return (!is_original || !fits || *of >= item.id)
                .then(|| format!("is no repeat of {of}: it must ask the same query, with a larger id"));
        }
        let fits = source.meaning().is_some_and(|meaning| meaning.digest(&item.text) == item.digest);
        let scene = match source {
            ItemSource::Query { query, .. } | ItemSource::Absent { query, .. } => Some(&query.scene),
            ItemSource::Vague { .. } | ItemSource::Repeat { .. } => None,
        };
        if scene.is_some_and(|scene| *scene != item.scene) {
            return Some("is a query of another scene".to_owned());
        }
        (!fits).then(|| "does not fit the digest of the item: text, meaning or scene was edited".to_owned())
    }
}

/// What became of an item's query since the round was opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    No,
    /// Its text, its meaning or its scene was edited.
    Edited,
    /// It was removed.
    Gone,
}

/// What became of each item, by the digest that it would have if the round were opened now.
///
/// # Errors
/// A scene of the benchmark cannot be read.
pub fn changes(round: &Round, key: &Key, bench: &Benchmark) -> Result<BTreeMap<ItemId, Change>, DataError> {
    let mut scenes: BTreeMap<&Name, Option<SceneNow>> = BTreeMap::new();
    let mut changes = BTreeMap::new();
    for item in &round.items {
        let scene = match scenes.get(&item.scene) {
            Some(scene) => scene,
            None => {
                let is_there = bench.manifest.scenes.contains(&item.scene);
                let read = || SceneNow::read(bench, round.profile, &item.scene);
                let scene = is_there.then(read).transpose()?;
                scenes.entry(&item.scene).or_insert(scene)
            }
        };
        let change = match scene.as_ref().and_then(|scene| current_digest(scene, key, item)) {
            None => Change::Gone,
            Some(digest) if digest != item.digest => Change::Edited,
            Some(_) => Change::No,
        };
        changes.insert(item.id.clone(), change);
    }
    Ok(changes)
}

fn current_digest(scene: &SceneNow, key: &Key, item: &Item) -> Option<String> {
    let source = match key.source(&item.id)? {
        ItemSource::Repeat { of } => key.source(of)?,
        source => source,
    };
    match source {
        ItemSource::Query { query: id, .. } | ItemSource::Absent { query: id, .. } => {
            let query = scene.queries.iter().chain(&scene.absents).find(|query| query.id == *id)?;
            Some(scene.meaning(query).digest(&query.text))
        }
        ItemSource::Vague { category, .. } => Some(scene.meaning_of_category(category).digest(&item.text)),
        ItemSource::Repeat { .. } => None,
    }
}

#[cfg(test)]
mod tests;
