//! A round as an annotator may see it: `round.toml` and `items.jsonl`. The key is read elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Deref;

use l4d_data::error::is_line;
use l4d_data::query::LONGEST_TEXT;
use l4d_data::store::{list_folder, write_atomic};
use l4d_data::{DataError, Name, Profile, json, toml_file};
use serde::{Deserialize, Serialize};

use crate::item::{Item, ItemId};
use crate::key::Key;
use crate::order;
use crate::round_dir::RoundDir;

/// Schema tag of `round.toml`.
pub const SCHEMA: &str = "l4d/round/1";

/// Control items that are mixed in, unmarked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Gold {
    /// Sentences that nothing in the scene satisfies; right is "none".
    pub absent: usize,
    /// Prompts that only name the category of look-alikes; right is "ambiguous", or all of them.
    pub vague: usize,
}

/// `round.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoundSettings {
    /// [`SCHEMA`].
    pub schema: String,
    /// Name of its folder.
    pub name: Name,
    /// Which rendering is looked at.
    pub profile: Profile,
    /// Seed of ids, control items and orders.
    pub seed: u64,
    /// Who votes; all of them have to be right.
    pub annotators: Vec<Name>,
    /// Whether the annotators are programs. Such a round never counts as verification by people.
    #[serde(default)]
    pub simulated: bool,
    /// How many views annotators may look at.
    pub views: usize,
    /// How many prompts are asked twice, at most.
    #[serde(default)]
    pub repeats: usize,
    /// How many control items are asked, at most.
    #[serde(default)]
    pub gold: Gold,
}

/// A round without its key.
#[derive(Debug, Clone, PartialEq)]
pub struct Round {
    /// `round.toml`; its fields are also fields of the round.
    pub settings: RoundSettings,
    /// What is asked, by id.
    pub items: Vec<Item>,
    dir: RoundDir,
}

impl Deref for Round {
    type Target = RoundSettings;

    fn deref(&self) -> &RoundSettings {
        &self.settings
    }
}

impl Round {
    /// Reads and checks `round.toml` and `items.jsonl`.
    ///
    /// # Errors
    /// A file is missing, cannot be read, or says what cannot be.
    pub fn open(dir: &RoundDir) -> Result<Self, DataError> {
        let path = dir.settings();
        if !path.exists() {
            let hint = known_rounds(dir).unwrap_or_else(|| "open a round with `l4d open-round`".to_owned());
            return Err(DataError::invalid(&path, "file", "there is no such round", hint));
        }
        let settings: RoundSettings =
            toml_file::read(&path, "see docs/annotation.md for the fields of a round")?;
        let folder = dir.root().file_name().and_then(|name| name.to_str());
        if let Some(folder) = folder.filter(|folder| *folder != settings.name.as_str()) {
            return Err(DataError::invalid(
                &path,
                "field `name`",
                format!("is `{}`, but the folder is `{folder}`: votes are bound to the name", settings.name),
                "give the folder the name of its round",
            ));
        }
        let items = json::read_lines(&dir.items())?.into_iter().map(|(_, item)| item).collect();
        Self::new(dir, settings, items, "restore the file that `l4d open-round` wrote")
    }

    /// Checks settings and items; `hint` is for items that cannot be.
    pub(crate) fn new(
        dir: &RoundDir,
        settings: RoundSettings,
        items: Vec<Item>,
        hint: &str,
    ) -> Result<Self, DataError> {
        if let Some((field, message, hint)) = settings_problem(&settings) {
            return Err(DataError::invalid(&dir.settings(), format!("field `{field}`"), message, hint));
        }
        if let Some((place, message)) = items_problem(&items) {
            return Err(DataError::invalid(&dir.items(), place, message, hint));
        }
        Ok(Self { settings, items, dir: dir.clone() })
    }

    /// Writes `key.jsonl`, `items.jsonl` and `round.toml`. Votes are bound to these: the caller has made sure that there
    /// are none.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &RoundDir, key: &Key) -> Result<(), DataError> {
        let path = dir.settings();
        let settings =
            toml::to_string(&self.settings).map_err(|error| DataError::format(&path, "settings", error))?;
        key.write(dir)?;
        json::write_lines(&dir.items(), &self.items)?;
        // Last: a folder with a round.toml is a whole round.
        let heading = "# A round of annotation. Votes are bound to its name, items and seed: open another one to change them.";
        write_atomic(&path, format!("{heading}\n{settings}").as_bytes())
    }

    pub fn dir(&self) -> &RoundDir {
        &self.dir
    }

    /// Refuses an annotator whom the round does not name.
    ///
    /// # Errors
    /// The round does not name them; the hint lists who may vote.
    pub fn require_annotator(&self, name: &str) -> Result<(), DataError> {
        if self.annotators.iter().any(|annotator| annotator.as_str() == name) {
            return Ok(());
        }
        let names: Vec<&str> = self.annotators.iter().map(Name::as_str).collect();
        Err(DataError::invalid(
            &self.dir.settings(),
            "field `annotators`",
            format!("does not name `{}`", name.escape_debug()),
            format!("vote as one of {}", names.join(", ")),
        ))
    }

    /// The item of that id.
    pub fn item(&self, id: &ItemId) -> Option<&Item> {
        self.items.binary_search_by(|item| item.id.cmp(id)).ok().map(|place| &self.items[place])
    }

    /// The order in which an annotator is asked: a shuffle of the annotator's own, with a prompt that is asked
    /// twice at least half the round away from itself.
    pub fn order(&self, annotator: &Name) -> Vec<ItemId> {
        order::order(self, annotator)
    }
}

fn settings_problem(settings: &RoundSettings) -> Option<(&'static str, String, &'static str)> {
    let RoundSettings { schema, annotators, views, .. } = settings;
    if schema != SCHEMA {
        return Some((
            "schema",
            format!("is `{}`, but this l4d reads `{SCHEMA}`", schema.escape_debug()),
            "use the l4d that opened the round",
        ));
    }
    // Logs are files, and some disks take `Ada` and `ada` for one.
    let distinct: BTreeSet<String> = annotators.iter().map(|name| name.to_ascii_lowercase()).collect();
    if distinct.len() != annotators.len() {
        return Some((
            "annotators",
            "names one annotator twice, capitals aside".into(),
            "give every annotator a name of their own",
        ));
    }
    if annotators.is_empty() {
        return Some(("annotators", "names no one".into(), "name those who vote"));
    }
    if *views == 0 {
        return Some(("views", "is 0: annotators would see nothing".into(), "write 1 or more"));
    }
    None
}

fn items_problem(items: &[Item]) -> Option<(String, String)> {
    if items.is_empty() {
        return Some(("file".to_owned(), "asks nothing".to_owned()));
    }
    let mut last: Option<&ItemId> = None;
    let mut prompts: BTreeMap<(&Name, &str), usize> = BTreeMap::new();
    for item in items {
        let problem = |message: &str| Some((format!("item {}", item.id), message.to_owned()));
        if last.is_some_and(|last| *last >= item.id) {
            return problem("is listed twice or out of order");
        }
        last = Some(&item.id);
        if !is_line(&item.text, LONGEST_TEXT) {
            return problem("field `text` must be one line of 1 to 500 bytes");
        }
        if item.digest.len() != 64 || !item.digest.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return problem("field `digest` must be 64 hex digits");
        }
        let times = prompts.entry((&item.scene, &item.text)).or_default();
        *times += 1;
        if *times > 2 {
            return problem("asks the same for the third time");
        }
    }
    None
}

fn known_rounds(dir: &RoundDir) -> Option<String> {
    let rounds = dir.root().parent()?;
    let mut names = list_folder(rounds).ok()?;
    names.retain(|name| RoundDir::new(rounds.join(name)).settings().exists());
    (!names.is_empty()).then(|| format!("choose among {}", names.join(", ")))
}

#[cfg(test)]
mod tests;
