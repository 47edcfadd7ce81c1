//! Queries: a sentence, what it refers to, and when.

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::digest::sha256_hex;
use crate::error::{DataError, is_line};
use crate::json;
use crate::name::Name;
use crate::timeline::Interval;

/// Bytes of a sentence or a note.
pub const LONGEST_TEXT: usize = 500;
/// Bytes of a predicate in its canonical form.
const LONGEST_PREDICATE: usize = 8000;

/// The kind of reasoning that tells the referent from its look-alikes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Category {
    Attribute,
    /// A verb with one role.
    Action,
    /// A geometric relation.
    Spatial,
    /// A verb with two roles.
    Interaction,
}

impl Category {
    /// All categories in the paper's table order.
    pub const ALL: [Self; 4] = [Self::Attribute, Self::Action, Self::Spatial, Self::Interaction];

    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Attribute => "attribute",
            Self::Action => "action",
            Self::Spatial => "spatial",
            Self::Interaction => "interaction",
        }
    }
}

/// Which sentences are asked.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum QuerySet {
    /// The queries that count: the only headline.
    #[default]
    Queries,
    /// Queries of two categories, for a table of their own.
    Composites,
    /// Sentences that nothing satisfies: they have no truth to hit, so that they are judged only beside queries that have.
    Absents,
    /// The queries that count together with the sentences that nothing satisfies.
    WithAbsents,
}

impl QuerySet {
    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Queries => "queries",
            Self::Composites => "composites",
            Self::Absents => "absents",
            Self::WithAbsents => "with-absents",
        }
    }
}

/// `<scene>/<nnn>`, with `nnn` of three or more digits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct QueryId {
    pub scene: Name,
    /// The number as written, also the stem of the mask file.
    pub number: Name,
}

/// Why a string is no [`QueryId`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{}` is not a query id: write `<scene>/<nnn>`, for example `room_living_cats/003`", .0.escape_debug())]
pub struct QueryIdError(String);

impl FromStr for QueryId {
    type Err = QueryIdError;

    fn from_str(text: &str) -> Result<Self, QueryIdError> {
        let refuse = || QueryIdError(text.chars().take(120).collect());
        let (scene, number) = text.split_once('/').ok_or_else(refuse)?;
        let digits = (3..=6).contains(&number.len()) && number.bytes().all(|byte| byte.is_ascii_digit());
        match (Name::new(scene), Name::new(number)) {
            (Ok(scene), Ok(number)) if digits => Ok(Self { scene, number }),
            _ => Err(refuse()),
        }
    }
}

impl TryFrom<String> for QueryId {
    type Error = QueryIdError;

    fn try_from(text: String) -> Result<Self, QueryIdError> {
        text.parse()
    }
}

impl From<QueryId> for String {
    fn from(id: QueryId) -> Self {
        id.to_string()
    }
}

impl fmt::Display for QueryId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.scene, self.number)
    }
}

/// How the sentence binds time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Temporal {
    /// Names an identity: the referent counts in the whole clip ("the pear that tips over").
    Whole,
    /// Gated: the referent counts only while the predicate holds ("the pear while it tips").
    While,
}

/// How far a query is in annotation. Set by `l4d verdict` alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Proved by machine, not yet voted on by people.
    Candidate,
    /// All annotators agreed.
    Verified,
    /// Annotators disagreed; not scored.
    Rejected,
}

impl Status {
    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Candidate => "candidate",
            Self::Verified => "verified",
            Self::Rejected => "rejected",
        }
    }
}

/// Where a query comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// A person of this project.
    Author,
    /// A model that proposed it.
    Model,
    /// Annotations of others.
    Import,
    /// Enumerated from the tracks of a composed scene, proved, and put into words by rule.
    Composed,
}

impl Source {
    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Author => "author",
            Self::Model => "model",
            Self::Import => "import",
            Self::Composed => "composed",
        }
    }
}

/// Who wrote a query.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Where it comes from.
    pub source: Source,
    /// Free text: model name, file, remark.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// One line of `benchmark/queries/<scene>.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Query {
    /// `<scene>/<nnn>`.
    pub id: QueryId,
    pub text: String,
    /// One category, or two for composites.
    pub categories: Vec<Category>,
    /// Names of the instances meant.
    pub referents: Vec<Name>,
    /// How the sentence binds time.
    pub temporal: Temporal,
    /// When it holds, canonical frames (`whole`: all).
    pub frames: Vec<Interval>,
    /// The machine-readable meaning; null only for real scenes. `l4d-query` owns the language.
    pub predicate: Option<Value>,
    /// [`text_digest`] of text and predicate: editing either invalidates it.
    pub text_digest: String,
    /// Who wrote it.
    pub provenance: Provenance,
    /// How far it is in annotation.
    pub status: Status,
}

impl Query {
    /// Whether there is anything to find at a frame: always for `whole`, while it holds for `while`.
    pub fn asks_at(&self, frame: u32) -> bool {
        self.temporal == Temporal::Whole || self.holds_at(frame)
    }

    /// Whether the referent counts at a canonical frame.
    pub fn holds_at(&self, frame: u32) -> bool {
        self.frames.iter().any(|interval| interval.contains(frame))
    }

    fn problem(&self, scene: &str, absent: bool) -> Option<(&'static str, String, &'static str)> {
        if self.id.scene.as_str() != scene {
            return Some((
                "id",
                format!("`{}` does not belong to scene `{scene}`", self.id),
                "move the line to its scene's file",
            ));
        }
        if !is_line(&self.text, LONGEST_TEXT) {
            let message = format!("must be one line of 1 to {LONGEST_TEXT} bytes");
            return Some(("text", message, "write the sentence"));
        }
        let note = &self.provenance.note;
        if !note.is_empty() && !is_line(note, LONGEST_TEXT) {
            let message = format!("must be one line of at most {LONGEST_TEXT} bytes");
            return Some(("provenance.note", message, "shorten the note"));
        }
        let predicate = self.predicate.as_ref().map_or(0, |predicate| json::canonical(predicate).len());
        if predicate > LONGEST_PREDICATE {
            let message = format!("has {predicate} bytes, but {LONGEST_PREDICATE} hold any");
            return Some(("predicate", message, "say it more shortly"));
        }
        if self.categories.is_empty() {
            return Some(("categories", "is empty".into(), "name one category, or two for a composite"));
        }
        if absent && !self.referents.is_empty() {
            return Some(("referents", "must be empty: nothing is meant".into(), "write []"));
        }
        let distinct = self.referents.iter().collect::<BTreeSet<_>>().len();
        if !absent && (self.referents.is_empty() || distinct != self.referents.len()) {
            return Some((
                "referents",
                "must name at least one instance, none twice".into(),
                "name the instances meant",
            ));
        }
        let ascending = self.frames.windows(2).all(|pair| pair[0].last() < pair[1].first());
        if self.frames.is_empty() || !ascending {
            return Some((
                "frames",
                "must be ascending intervals without overlap".into(),
                "write [[first, last], ...]",
            ));
        }
        let digest = text_digest(&self.text, self.predicate.as_ref());
        if self.text_digest != digest {
            let message = format!("is `{}`, but text and predicate give `{digest}`", self.text_digest);
            return Some((
                "text_digest",
                message,
                "check that the sentence still means the predicate, then write the new digest",
            ));
        }
        None
    }
}

/// Ties a sentence to its predicate: the first 16 hex digits of SHA-256 over both.
pub fn text_digest(text: &str, predicate: Option<&Value>) -> String {
    let predicate = predicate.map_or_else(|| "null".to_owned(), json::canonical);
    let mut digest = sha256_hex(format!("{text}\n{predicate}").as_bytes());
    digest.truncate(16);
    digest
}

/// Reads the queries of a scene; ids and texts are unique in the file.
///
/// # Errors
/// A file that cannot be read, or a line that is no sound query of the scene.
pub fn read_queries(path: &Path, scene: &str) -> Result<Vec<Query>, DataError> {
    read(path, scene, false)
}

/// Reads sentences that nothing in a scene satisfies: queries without a referent.
///
/// # Errors
/// A file that cannot be read, or a line that is no sound query of the scene.
pub fn read_absents(path: &Path, scene: &str) -> Result<Vec<Query>, DataError> {
    read(path, scene, true)
}

fn read(path: &Path, scene: &str, absent: bool) -> Result<Vec<Query>, DataError> {
    let mut ids = BTreeSet::new();
    let mut texts = BTreeSet::new();
    let mut queries = Vec::new();
    for (line, query) in json::read_lines::<Query>(path)? {
        let refuse = |field: &str, message: String, hint: &str| {
            Err(DataError::invalid(path, format!("line {line}, field `{field}`"), message, hint))
        };
        if let Some((field, message, hint)) = query.problem(scene, absent) {
            return refuse(field, message, hint);
        }
        if !ids.insert(query.id.clone()) {
            return refuse("id", format!("`{}` occurs twice", query.id), "give each query its own number");
        }
        if !texts.insert(query.text.clone()) {
            return refuse("text", "the same sentence occurs twice".into(), "keep one of them");
        }
        queries.push(query);
    }
    Ok(queries)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str, digest: Option<&str>) -> String {
        let predicate: Value = serde_json::from_str(r#"{"category":"bucket"}"#).unwrap();
        let digest = digest.map_or_else(|| text_digest(text, Some(&predicate)), str::to_owned);
        format!(
            r#"{{"id":"farm/001","text":"{text}","categories":["action"],"referents":["a"],"temporal":"while","frames":[[0,20],[40,60]],"predicate":{predicate},"text_digest":"{digest}","provenance":{{"source":"author"}},"status":"candidate"}}"#
        )
    }

    fn read(text: &str) -> Result<Vec<Query>, DataError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("farm.jsonl");
        std::fs::write(&path, text).unwrap();
        read_queries(&path, "farm")
    }

    #[test]
    fn a_query_round_trips_and_knows_its_time() {
        let query = read(&line("the bucket", None)).unwrap().remove(0);
        assert!(query.holds_at(20) && query.holds_at(40) && !query.holds_at(21));
        let again: Query = serde_json::from_str(&serde_json::to_string(&query).unwrap()).unwrap();
        assert_eq!(again, query);
    }

    #[test]
    fn an_edited_sentence_is_noticed() {
        let error = read(&line("the pail", Some("0123456789abcdef"))).unwrap_err().to_string();
        assert!(error.contains("line 1, field `text_digest`"), "{error}");
    }

    #[test]
    fn only_absent_sentences_go_without_a_referent() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("farm.absent.jsonl");
        let meant = line("the bucket", None);
        std::fs::write(&path, &meant).unwrap();
        assert!(read_absents(&path, "farm").unwrap_err().to_string().contains("must be empty"));
        let absent = meant.replace(r#"["a"]"#, "[]");
        std::fs::write(&path, &absent).unwrap();
        assert_eq!(read_absents(&path, "farm").unwrap().len(), 1);
        assert!(read(&absent).unwrap_err().to_string().contains("at least one instance"));
    }

    #[test]
    fn duplicates_and_foreign_ids_are_refused() {
        let twice = format!("{}\n{}", line("the bucket", None), line("the bucket", None));
        assert!(read(&twice).unwrap_err().to_string().contains("twice"));
        let foreign = line("the bucket", None).replace("farm/001", "../../etc/001");
        assert!(read(&foreign).unwrap_err().to_string().contains("not a query id"));
    }
}
