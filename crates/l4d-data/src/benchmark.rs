//! The benchmark folder as a whole: version, scenes, queries, truth.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::digest::{sha256_file, sha256_hex};
use crate::error::DataError;
use crate::layout::BenchDir;
use crate::name::Name;
use crate::query::{Query, read_queries};
use crate::store::read_bounded;
use crate::timeline::Profile;
use crate::tracks::Tracks;
use crate::truth::Truth;

/// `panoptic-l4d.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Title of the benchmark.
    pub name: String,
    /// Semantic version: major = changed answers, minor = additions, patch = re-serialised.
    pub version: String,
    /// Licence of the data.
    pub licence: String,
    /// Scenes in table order.
    pub scenes: Vec<Name>,
}

/// An opened benchmark folder.
#[derive(Debug, Clone)]
pub struct Benchmark {
    /// Where its files stand.
    pub dir: BenchDir,
    /// What it says of itself.
    pub manifest: Manifest,
}

impl Benchmark {
    /// Opens a benchmark folder.
    pub fn open(root: impl Into<PathBuf>) -> Result<Self, DataError> {
        let dir = BenchDir::new(root);
        let path = dir.manifest();
        let bytes = read_bounded(&path, 1 << 20)?;
        let manifest: Manifest = std::str::from_utf8(&bytes)
            .map_err(|error| error.to_string())
            .and_then(|text| toml::from_str(text).map_err(|error| error.to_string()))
            .map_err(|message| DataError::Format { path, location: "manifest".to_owned(), message })?;
        Ok(Self { dir, manifest })
    }

    /// Refuses a scene that the benchmark does not have.
    pub fn scene(&self, name: &str) -> Result<&Name, DataError> {
        self.manifest.scenes.iter().find(|scene| scene.as_str() == name).ok_or_else(|| {
            let known: Vec<&str> = self.manifest.scenes.iter().map(Name::as_str).collect();
            DataError::invalid(
                &self.dir.manifest(),
                "field `scenes`",
                format!("has no scene `{name}`"),
                format!("choose among {}", known.join(", ")),
            )
        })
    }

    /// The scenes of a selection, in table order; an empty selection means all.
    pub fn select(&self, wanted: &[String]) -> Result<Vec<Name>, DataError> {
        for name in wanted {
            self.scene(name)?;
        }
        let chosen = |scene: &&Name| wanted.is_empty() || wanted.iter().any(|name| name == scene.as_str());
        Ok(self.manifest.scenes.iter().filter(chosen).cloned().collect())
    }

    /// Single-category queries of a scene.
    pub fn queries(&self, scene: &Name) -> Result<Vec<Query>, DataError> {
        read_queries(&self.dir.queries(scene), scene)
    }

    /// Truth of a scene.
    pub fn truth(&self, profile: Profile, scene: &Name) -> Result<Truth, DataError> {
        let path = self.dir.truth(profile, scene);
        if !path.exists() {
            return Err(DataError::invalid(
                &path,
                "file",
                format!("there is no truth of profile {profile} for {scene}"),
                format!(
                    "choose another --profile, or run `l4d build-scenes --profile {profile} --scenes {scene}`"
                ),
            ));
        }
        Truth::read(&path)
    }

    /// Tracks of a scene.
    pub fn tracks(&self, scene: &Name) -> Result<Tracks, DataError> {
        Tracks::read(&self.dir.tracks(scene))
    }

    /// SHA-256 over the names and digests of the truth files of a profile that exist, in table order. Results
    /// carry it, so that masks of another rendering or version are refused.
    pub fn truth_digest(&self, profile: Profile) -> Result<String, DataError> {
        let mut lines = String::new();
        for scene in &self.manifest.scenes {
            let path = self.dir.truth(profile, scene);
            if path.exists() {
                lines.push_str(&format!("{}  {scene}.json\n", sha256_file(&path)?));
            }
        }
        if lines.is_empty() {
            return Err(DataError::invalid(
                &self.dir.root().join("truth").join(profile.as_str()),
                "folder",
                format!("holds no truth of profile {profile}"),
                format!("choose another --profile, or run `l4d build-scenes --profile {profile}`"),
            ));
        }
        Ok(sha256_hex(lines.as_bytes()))
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        self.dir.root()
    }
}
