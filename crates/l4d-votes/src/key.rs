//! What stands behind the items: `key.jsonl`. Only a verdict opens it.
//!
//! The key keeps what each prompt meant when the round was opened, so that votes can be read against it for good.
//! The digest of an item covers its prompt and this meaning: a key that was edited doesn't fit its items, and a
//! benchmark that was edited doesn't fit the round.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::digest::sha256_hex;
use l4d_data::query::Query;
use l4d_data::{Benchmark, Category, DataError, Interval, Name, Profile, QueryId, Temporal, json};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::cast::Cast;
use crate::event::{Answer, Choice};
use crate::item::{Item, ItemId};
use crate::round::{Round, RoundDir};
use crate::rule::FrameRule;
use crate::verdict::Mark;

/// What a prompt means, and in which version of its scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Meaning {
    /// Instances meant.
    pub referents: BTreeSet<Name>,
    /// How the sentence binds time.
    pub temporal: Temporal,
    /// When it holds, ascending.
    pub frames: Vec<Interval>,
    /// SHA-256 of the scene's tracks, or of the truth of a real one.
    pub tracks: String,
}

impl Meaning {
    /// The meaning of a query in a scene whose tracks have this digest.
    pub fn of_query(query: &Query, tracks: &str) -> Self {
        Self {
            referents: query.referents.iter().cloned().collect(),
            temporal: query.temporal,
            frames: query.frames.clone(),
            tracks: tracks.to_owned(),
        }
    }

    /// The meaning of a bare category: all of its objects, always.
    pub(crate) fn of_category(category: &str, cast: &Cast) -> Self {
        Self {
            referents: cast.of_category(category),
            temporal: Temporal::Whole,
            frames: vec![cast.whole],
            tracks: cast.digest.clone(),
        }
    }

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

    /// An answer to a query against this meaning. Any frames fit a sentence that names an identity.
    pub fn mark(&self, answer: &Answer, rule: FrameRule) -> Mark {
        match &answer.choice {
            Choice::None => Mark::SaidNone,
            Choice::Ambiguous { .. } => Mark::SaidAmbiguous,
            Choice::Objects(objects) if *objects != self.referents => Mark::OtherObjects,
            Choice::Objects(_) if self.temporal == Temporal::Whole => Mark::Right,
            Choice::Objects(_) if rule.accepts(answer.frames, &self.frames) => Mark::Right,
            Choice::Objects(_) => Mark::OtherFrames,
        }
    }
}

/// What an item was drawn from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Behind {
    /// A query that is voted on.
    Query {
        /// Which.
        query: QueryId,
        /// Its categories.
        categories: Vec<Category>,
        /// The right answer.
        meaning: Meaning,
    },
    /// Control: a sentence that nothing satisfies.
    Absent {
        /// Which.
        query: QueryId,
        /// Nothing, in which scene.
        meaning: Meaning,
    },
    /// Control: the bare category of look-alikes.
    Vague {
        /// The category.
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

impl Behind {
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
pub(crate) struct KeyLine {
    pub(crate) item: ItemId,
    #[serde(flatten)]
    pub(crate) behind: Behind,
}

/// `key.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Key {
    entries: BTreeMap<ItemId, Behind>,
}

impl Key {
    /// Reads the key and checks it against the items.
    pub fn read(dir: &RoundDir, round: &Round) -> Result<Self, DataError> {
        let path = dir.key();
        let remedy = "restore the key.jsonl that `l4d open-round` wrote";
        let mut entries = BTreeMap::new();
        for (line, KeyLine { item, behind }) in json::read_lines::<KeyLine>(&path)? {
            let place = format!("line {line}, item {item}");
            if entries.insert(item, behind).is_some() {
                return Err(DataError::invalid(&path, place, "stands there twice", remedy));
            }
        }
        let key = Self { entries };
        match key.problem(round) {
            None => Ok(key),
            Some((item, message)) => Err(DataError::invalid(&path, format!("item {item}"), message, remedy)),
        }
    }

    pub(crate) fn new(entries: BTreeMap<ItemId, Behind>) -> Self {
        Self { entries }
    }

    /// What stands behind an item.
    pub fn behind(&self, item: &ItemId) -> Option<&Behind> {
        self.entries.get(item)
    }

    /// All entries by item.
    pub fn entries(&self) -> &BTreeMap<ItemId, Behind> {
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
        let Some(behind) = self.entries.get(&item.id) else {
            return Some("is missing".to_owned());
        };
        if let Behind::Repeat { of } = behind {
            let is_original = matches!(self.entries.get(of), Some(Behind::Query { .. }));
            let fits = round.item(of).is_some_and(|original| {
                (&original.scene, &original.text, &original.digest) == (&item.scene, &item.text, &item.digest)
            });
            return (!is_original || !fits || *of >= item.id)
                .then(|| format!("is no repeat of {of}: it must ask the same query, with a larger id"));
        }
        let fits = behind.meaning().is_some_and(|meaning| meaning.digest(&item.text) == item.digest);
        let scene = match behind {
            Behind::Query { query, .. } | Behind::Absent { query, .. } => Some(&query.scene),
            Behind::Vague { .. } | Behind::Repeat { .. } => None,
        };
        if scene.is_some_and(|scene| *scene != item.scene) {
            return Some("is a query of another scene".to_owned());
        }
        (!fits).then(|| "does not fit the digest of the item: text, meaning or scene was edited".to_owned())
    }
}

/// The digest that each item would have if the round were opened now; none where its query is gone.
pub fn current_digests(
    round: &Round,
    key: &Key,
    bench: &Benchmark,
) -> Result<BTreeMap<ItemId, String>, DataError> {
    let mut scenes: BTreeMap<&Name, Vec<&Item>> = BTreeMap::new();
    for item in &round.items {
        scenes.entry(&item.scene).or_default().push(item);
    }
    let mut digests = BTreeMap::new();
    for (scene, items) in scenes {
        if bench.manifest.scenes.contains(scene) {
            let now = SceneNow::read(bench, round.profile, scene)?;
            let found = items.into_iter().filter_map(|item| Some((item.id.clone(), now.digest(key, item)?)));
            digests.extend(found);
        }
    }
    Ok(digests)
}

/// A scene as the benchmark has it now.
struct SceneNow {
    queries: BTreeMap<QueryId, Query>,
    cast: Cast,
}

impl SceneNow {
    fn read(bench: &Benchmark, profile: Profile, scene: &Name) -> Result<Self, DataError> {
        let mut queries = bench.queries(scene)?;
        queries.extend(bench.composites(scene)?);
        queries.extend(bench.absents(scene)?);
        Ok(Self {
            queries: queries.into_iter().map(|query| (query.id.clone(), query)).collect(),
            cast: Cast::read(bench, profile, scene)?,
        })
    }

    fn digest(&self, key: &Key, item: &Item) -> Option<String> {
        let behind = match key.behind(&item.id)? {
            Behind::Repeat { of } => key.behind(of)?,
            behind => behind,
        };
        match behind {
            Behind::Query { query, .. } | Behind::Absent { query, .. } => {
                let query = self.queries.get(query)?;
                Some(Meaning::of_query(query, &self.cast.digest).digest(&query.text))
            }
            Behind::Vague { category, .. } => {
                Some(Meaning::of_category(category, &self.cast).digest(&item.text))
            }
            Behind::Repeat { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests;
