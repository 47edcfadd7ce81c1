//! A round as an annotator may see it: `round.toml` and `items.jsonl`. The key is read elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use l4d_data::error::inert;
use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name, Profile, json};
use serde::{Deserialize, Serialize};

use crate::item::{Item, ItemId};
use crate::order;
use crate::rule::{FrameRule, Rule};

/// Schema tag of `round.toml`.
pub const SCHEMA: &str = "l4d/round/1";

/// `annotation/rounds/<round>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoundDir(PathBuf);

impl RoundDir {
    /// The folder of a round.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self(root.into())
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.0
    }

    /// `round.toml`: what the round is.
    pub fn settings(&self) -> PathBuf {
        self.0.join("round.toml")
    }

    /// `items.jsonl`: what is asked.
    pub fn items(&self) -> PathBuf {
        self.0.join("items.jsonl")
    }

    /// `key.jsonl`: what stands behind the items. No annotator's process opens it.
    pub fn key(&self) -> PathBuf {
        self.0.join("key.jsonl")
    }

    /// `votes`: the logs.
    pub fn votes(&self) -> PathBuf {
        self.0.join("votes")
    }

    /// `votes/<annotator>.jsonl`.
    pub fn ballot(&self, annotator: &Name) -> PathBuf {
        self.votes().join(format!("{annotator}.jsonl"))
    }

    /// `verdicts.csv`.
    pub fn verdicts(&self) -> PathBuf {
        self.0.join("verdicts.csv")
    }

    /// `agreement.json`.
    pub fn agreement(&self) -> PathBuf {
        self.0.join("agreement.json")
    }

    /// `refine.jsonl`: rejected prompts with what people said about them.
    pub fn refine(&self) -> PathBuf {
        self.0.join("refine.jsonl")
    }

    /// `rejected.png`: contact sheet of the rejected prompts.
    pub fn rejected(&self) -> PathBuf {
        self.0.join("rejected.png")
    }
}

/// Control items that are mixed in, unmarked.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Gold {
    /// Sentences that nothing in the scene satisfies; right is "none".
    pub absent: usize,
    /// Prompts that only name the category of look-alikes; right is "ambiguous", or all of them.
    pub vague: usize,
    /// An annotator with a smaller share of right answers on them is reported.
    pub flag_below: f64,
}

impl Default for Gold {
    fn default() -> Self {
        Self { absent: 0, vague: 0, flag_below: 0.75 }
    }
}

/// `round.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    pub(crate) schema: String,
    pub(crate) name: Name,
    pub(crate) title: String,
    pub(crate) profile: Profile,
    pub(crate) seed: u64,
    pub(crate) annotators: Vec<Name>,
    pub(crate) rule: Rule,
    #[serde(default)]
    pub(crate) frames: FrameRule,
    #[serde(default)]
    pub(crate) simulated: bool,
    pub(crate) views: usize,
    #[serde(default)]
    pub(crate) repeats: usize,
    #[serde(default)]
    pub(crate) gold: Gold,
}

/// A round, without what stands behind its items.
#[derive(Debug, Clone, PartialEq)]
pub struct Round {
    /// Name of its folder.
    pub name: Name,
    /// One line for people.
    pub title: String,
    /// Which rendering is looked at.
    pub profile: Profile,
    /// Seed of ids, control items and orders.
    pub seed: u64,
    /// Who votes.
    pub annotators: Vec<Name>,
    /// How many have to be right.
    pub rule: Rule,
    /// How well the frames have to fit.
    pub frames: FrameRule,
    /// Whether the annotators are programs. Such a round never counts as verification by people.
    pub simulated: bool,
    /// How many views annotators may look at.
    pub views: usize,
    /// How many prompts were wanted twice.
    pub repeats: usize,
    /// How many control items were wanted.
    pub gold: Gold,
    /// What is asked, by id.
    pub items: Vec<Item>,
    dir: RoundDir,
    places: BTreeMap<ItemId, usize>,
}

impl Round {
    /// Reads and checks `round.toml` and `items.jsonl`.
    pub fn open(dir: &RoundDir) -> Result<Self, DataError> {
        let path = dir.settings();
        if !path.exists() {
            return Err(DataError::invalid(
                &path,
                "file",
                "there is no such round",
                known_rounds(dir).unwrap_or_else(|| "open a round with `l4d open-round`".to_owned()),
            ));
        }
        let bytes = read_bounded(&path, 1 << 20)?;
        let settings: Settings = std::str::from_utf8(&bytes)
            .map_err(|error| error.to_string())
            .and_then(|text| toml::from_str(text).map_err(|error| error.to_string()))
            .map_err(|message| DataError::Format {
                path: path.clone(),
                location: "settings".to_owned(),
                message: inert(&message),
            })?;
        let items: Vec<Item> = json::read_lines(&dir.items())?.into_iter().map(|(_, item)| item).collect();
        let folder = dir.root().file_name().and_then(|name| name.to_str());
        if let Some(folder) = folder.filter(|folder| *folder != settings.name.as_str()) {
            return Err(DataError::invalid(
                &path,
                "field `name`",
                format!("is `{}`, but the folder is `{folder}`: votes are bound to the name", settings.name),
                "give the folder the name of its round",
            ));
        }
        if let Some((field, message, remedy)) = settings_problem(&settings) {
            return Err(DataError::invalid(&path, format!("field `{field}`"), message, remedy));
        }
        if let Some((place, message)) = items_problem(&items) {
            let remedy = "restore the file that `l4d open-round` wrote";
            return Err(DataError::invalid(&dir.items(), place, message, remedy));
        }
        Ok(Self::new(dir, settings, items))
    }

    pub(crate) fn new(dir: &RoundDir, settings: Settings, items: Vec<Item>) -> Self {
        let places = items.iter().enumerate().map(|(place, item)| (item.id.clone(), place)).collect();
        let Settings {
            schema: _,
            name,
            title,
            profile,
            seed,
            annotators,
            rule,
            frames,
            simulated,
            views,
            repeats,
            gold,
        } = settings;
        Self {
            name,
            title,
            profile,
            seed,
            annotators,
            rule,
            frames,
            simulated,
            views,
            repeats,
            gold,
            items,
            dir: dir.clone(),
            places,
        }
    }

    pub(crate) fn settings(&self) -> Settings {
        Settings {
            schema: SCHEMA.to_owned(),
            name: self.name.clone(),
            title: self.title.clone(),
            profile: self.profile,
            seed: self.seed,
            annotators: self.annotators.clone(),
            rule: self.rule,
            frames: self.frames,
            simulated: self.simulated,
            views: self.views,
            repeats: self.repeats,
            gold: self.gold,
        }
    }

    /// Where its files stand.
    pub fn dir(&self) -> &RoundDir {
        &self.dir
    }

    /// Refuses somebody whom the round does not name.
    pub fn require_annotator(&self, name: &str) -> Result<(), DataError> {
        if self.annotators.iter().any(|annotator| annotator.as_str() == name) {
            return Ok(());
        }
        Err(DataError::invalid(
            &self.dir.settings(),
            "field `annotators`",
            format!("does not name `{}`", name.escape_debug()),
            format!("vote as one of {}", names(&self.annotators)),
        ))
    }

    /// The item of that id.
    pub fn item(&self, id: &ItemId) -> Option<&Item> {
        self.places.get(id).map(|&place| &self.items[place])
    }

    /// The order in which an annotator is asked: a shuffle of the annotator's own, with a prompt that is asked
    /// twice at least half the round away from itself.
    pub fn order(&self, annotator: &Name) -> Vec<ItemId> {
        order::order(self, annotator)
    }
}

pub(crate) fn settings_problem(settings: &Settings) -> Option<(&'static str, String, &'static str)> {
    let Settings { schema, annotators, rule, seed, views, title, gold, .. } = settings;
    if schema != SCHEMA {
        return Some((
            "schema",
            format!("is `{}`, but this l4d reads `{SCHEMA}`", schema.escape_debug()),
            "use the l4d that opened the round",
        ));
    }
    if title.chars().any(char::is_control) || title.len() > 500 {
        return Some(("title", "must be one line of at most 500 bytes".into(), "shorten it"));
    }
    // Logs are files, and some disks take `Ada` and `ada` for one.
    let distinct: BTreeSet<String> = annotators.iter().map(|name| name.to_ascii_lowercase()).collect();
    if distinct.len() != annotators.len() {
        return Some((
            "annotators",
            "names somebody twice, capitals aside".into(),
            "give everybody a name of their own",
        ));
    }
    if annotators.len() != rule.annotators {
        return Some((
            "annotators",
            format!("are {}, but the rule `{rule}` is about {}", annotators.len(), rule.annotators),
            "name as many annotators as the rule counts",
        ));
    }
    if *seed > i64::MAX as u64 {
        return Some(("seed", "is 2^63 or more, which TOML does not know".into(), "choose a smaller one"));
    }
    if *views == 0 {
        return Some(("views", "is 0: nobody would see anything".into(), "write 1 or more"));
    }
    if !(0.0..=1.0).contains(&gold.flag_below) {
        return Some(("gold.flag_below", "is no share".into(), "write a number from 0 to 1"));
    }
    None
}

pub(crate) fn items_problem(items: &[Item]) -> Option<(String, String)> {
    if items.is_empty() {
        return Some(("file".to_owned(), "asks nothing".to_owned()));
    }
    let mut last: Option<&ItemId> = None;
    let mut prompts: BTreeMap<(&Name, &str), usize> = BTreeMap::new();
    for item in items {
        let place = format!("item {}", item.id);
        if last.is_some_and(|last| *last >= item.id) {
            return Some((place, "stands there twice or out of order".to_owned()));
        }
        last = Some(&item.id);
        let is_line = !item.text.chars().any(char::is_control);
        if item.text.trim().is_empty() || item.text.len() > 500 || !is_line {
            return Some((place, "field `text` must be one line of 1 to 500 bytes".to_owned()));
        }
        if item.digest.len() != 64 || !item.digest.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return Some((place, "field `digest` must be 64 hex digits".to_owned()));
        }
        let times = prompts.entry((&item.scene, &item.text)).or_default();
        *times += 1;
        if *times > 2 {
            return Some((place, "asks the same for the third time".to_owned()));
        }
    }
    None
}

fn known_rounds(dir: &RoundDir) -> Option<String> {
    let rounds = dir.root().parent()?;
    let mut names = l4d_data::store::list_folder(rounds).ok()?;
    names.retain(|name| RoundDir::new(rounds.join(name)).settings().exists());
    (!names.is_empty()).then(|| format!("choose among {}", names.join(", ")))
}

fn names(names: &[Name]) -> String {
    names.iter().map(Name::as_str).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests;
