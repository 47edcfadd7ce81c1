//! `release.json`: what a version consists of, so that the next one knows what changed.
//!
//! Meaning and bytes have digests of their own: a digest of what a file says, which a file written anew with other spaces keeps,
//! and a digest of its bytes.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::digest::sha256_hex;
use l4d_data::query::Query;
use l4d_data::{DataError, Name, Profile, QueryId, Status, json, sums};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::day::Day;
use crate::gather::{Gathered, SceneFacts, Source};
use crate::renders::Renders;
use crate::splats::Splats;
use crate::votes::{Round, Votes};

/// Schema tag of `release.json`.
pub const SCHEMA: &str = "l4d/release/1";
/// Its name in a release.
pub const FILE: &str = "release.json";
/// Name of the checksums of a release.
pub const SUMS: &str = "SHA256SUMS";

/// `release.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contents {
    /// [`SCHEMA`].
    pub schema: String,
    /// Name of the benchmark.
    pub name: String,
    /// Its version.
    pub version: String,
    /// SPDX name of its licence.
    pub licence: String,
    /// Who answers for it.
    pub publication: Publication,
    /// Scene -> what it means.
    pub scenes: BTreeMap<Name, SceneContents>,
    /// Rounds of people whose votes are in it.
    pub rounds: Vec<Round>,
    /// File in the archives -> SHA-256, pictures left out.
    pub files: BTreeMap<String, String>,
    /// Pictures; none if they are not in it.
    pub renders: Option<RenderContents>,
}

/// What cannot be read from the data.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Publication {
    /// Day of publication.
    pub date: Day,
    /// Page of the data set.
    pub url: String,
    /// Who made it.
    pub creators: Vec<String>,
}

/// What a scene means.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneContents {
    /// Digest of tracks, events and cameras; null for captures.
    pub world: Option<String>,
    /// Profile -> digest of the masks.
    pub truth: BTreeMap<Profile, String>,
    /// Single-category queries.
    pub queries: BTreeMap<QueryId, QueryContents>,
    /// Queries of two categories.
    pub composites: BTreeMap<QueryId, QueryContents>,
    /// Sentences that nothing satisfies.
    pub absents: BTreeMap<QueryId, QueryContents>,
}

/// What a query means.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QueryContents {
    /// Digest of sentence, categories, referents, time and predicate.
    pub meaning: String,
    /// Its state in annotation.
    pub status: Status,
}

/// Which pictures are in a release.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderContents {
    pub profile: Profile,
    /// Scene -> SHA-256 over the names and digests of its files.
    pub scenes: BTreeMap<Name, String>,
    /// Scene -> the same of its trained model, where there is one.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub splats: BTreeMap<Name, String>,
}

impl Contents {
    /// What a release made of these parts will consist of.
    pub(crate) fn of(
        gathered: &Gathered,
        votes: &Votes,
        renders: Option<(&Renders, &Splats)>,
        publication: &Publication,
    ) -> Self {
        let files = gathered.all_files().chain(&votes.files);
        Self {
            schema: SCHEMA.to_owned(),
            name: gathered.manifest.name.clone(),
            version: gathered.manifest.version.clone(),
            licence: gathered.manifest.licence.clone(),
            publication: publication.clone(),
            scenes: gathered
                .scenes
                .iter()
                .map(|scene| (scene.name.clone(), SceneContents::of(scene)))
                .collect(),
            rounds: votes.rounds.clone(),
            files: files.map(|file| (file.name.clone(), file.sha256.clone())).collect(),
            renders: renders.map(|(renders, splats)| RenderContents {
                profile: renders.profile,
                scenes: digests(renders.scenes.iter().map(|(name, rendered)| (name, &rendered.files))),
                splats: digests(splats),
            }),
        }
    }

    /// Reads the `release.json` of a release folder.
    ///
    /// # Errors
    /// If it cannot be read, is of another schema, or is not the one that `SHA256SUMS` lists.
    pub fn read(release: &Path) -> Result<Self, DataError> {
        let path = release.join(FILE);
        let contents: Self = json::read(&path)?;
        if contents.schema != SCHEMA {
            let message = format!("is `{}`, but this l4d reads `{SCHEMA}`", contents.schema);
            return Err(DataError::invalid(
                &path,
                "field `schema`",
                message,
                "use the l4d that made the release",
            ));
        }
        let listed = sums::read(&release.join(SUMS))?;
        if listed.get(FILE) != Some(&l4d_data::digest::sha256_file(&path)?) {
            let hint = "fetch the release again; `l4d release --check` lists all that is wrong with it";
            return Err(DataError::invalid(&path, "bytes", "are not those that SHA256SUMS lists", hint));
        }
        Ok(contents)
    }

    /// Name of the release's folder.
    pub fn folder(&self) -> String {
        format!("{}-{}", slug(&self.name), self.version)
    }
}

fn digests<'a>(files: impl IntoIterator<Item = (&'a Name, &'a Vec<Source>)>) -> BTreeMap<Name, String> {
    files.into_iter().map(|(name, files)| (name.clone(), digest_of(files))).collect()
}

/// A title as the name of a folder: small letters, digits, hyphens.
pub(crate) fn slug(title: &str) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '-' };
    let slug: String = title.chars().map(plain).collect();
    let parts: Vec<&str> = slug.split('-').filter(|part| !part.is_empty()).collect();
    if parts.is_empty() { "benchmark".to_owned() } else { parts.join("-") }
}

impl SceneContents {
    fn of(scene: &SceneFacts) -> Self {
        let queries = |queries: &[Query]| {
            queries.iter().map(|query| (query.id.clone(), QueryContents::of(query))).collect()
        };
        Self {
            world: scene.tracks.as_ref().map(|tracks| {
                // The story is for people: another wording changes no answer.
                digest(tracks, &["description"])
            }),
            truth: scene.truths.iter().map(|(&profile, truth)| (profile, digest(truth, &[]))).collect(),
            queries: queries(&scene.queries),
            composites: queries(&scene.composites),
            absents: queries(&scene.absents),
        }
    }

    /// Every query that is judged, whatever its set: those that people rejected are not.
    pub(crate) fn judged(&self) -> BTreeMap<&QueryId, &QueryContents> {
        let all = self.queries.iter().chain(&self.composites).chain(&self.absents);
        all.filter(|(_, query)| query.status != Status::Rejected).collect()
    }
}

impl QueryContents {
    fn of(query: &Query) -> Self {
        // The digest of the text follows from text and predicate; who wrote it and how it fared changes no answer.
        Self { meaning: digest(query, &["id", "text_digest", "provenance", "status"]), status: query.status }
    }
}

/// Digest of what a value says, some of its fields left out.
fn digest(value: &impl Serialize, without: &[&str]) -> String {
    let mut value = serde_json::to_value(value).unwrap_or(Value::Null);
    if let Value::Object(fields) = &mut value {
        without.iter().for_each(|field| drop(fields.shift_remove(*field)));
    }
    sha256_hex(json::canonical(&value).as_bytes())
}

/// Digest over the names and digests of files.
fn digest_of(files: &[Source]) -> String {
    let lines: BTreeMap<String, String> =
        files.iter().map(|file| (file.name.clone(), file.sha256.clone())).collect();
    sha256_hex(sums::to_text(&lines).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::slug;

    #[test]
    fn folders_have_plain_names() {
        assert_eq!(slug("Panoptic-L4D"), "panoptic-l4d");
        assert_eq!(slug(" ../Mine & yours/ "), "mine-yours");
        assert_eq!(slug("日本"), "benchmark");
    }
}
