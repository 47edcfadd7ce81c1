//! The benchmark folder as a whole: version, scenes, queries, truth.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::digest::{sha256_file, sha256_hex};
use crate::error::DataError;
use crate::layout::BenchDir;
use crate::name::{Name, choose_among};
use crate::query::{Query, QuerySet, read_absents, read_queries};
use crate::timeline::Profile;
use crate::toml_file;
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
    /// What it may be used for.
    #[serde(default)]
    pub split: SetSplit,
    /// Always 0: recipes have one draw.
    #[serde(default)]
    pub variant: u32,
    /// Seed of everything random in its scenes; 0 is the benchmark.
    #[serde(default)]
    pub seed: u64,
    /// Scenes in table order.
    pub scenes: Vec<Name>,
}

/// What a set of scenes and queries may be used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SetSplit {
    /// Reported scores; nothing is tuned on it.
    #[default]
    Test,
    Train,
    /// Tuning of thresholds.
    Dev,
    /// Somebody's own draw.
    Private,
}

/// What a scene says of the draw that it is: 0 and 0 for recipes in Python, 0 and its seed for a composed one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Draw {
    /// Always 0.
    pub variant: u32,
    /// Seed of everything random.
    pub seed: u64,
}

impl Manifest {
    /// Which draw of the recipes its scenes are.
    pub fn draw(&self) -> Draw {
        Draw { variant: self.variant, seed: self.seed }
    }

    /// The manifest as a file; `heading` is its comment.
    ///
    /// # Errors
    /// A manifest that TOML cannot write.
    pub fn to_toml(&self, heading: &str) -> Result<String, toml::ser::Error> {
        Ok(format!("# {heading}\n{}", toml::to_string(self)?))
    }
}

/// An opened benchmark folder.
#[derive(Debug, Clone)]
pub struct Benchmark {
    /// Where its files are.
    pub dir: BenchDir,
    /// What it says of itself.
    pub manifest: Manifest,
}

impl Benchmark {
    /// Opens a benchmark folder.
    ///
    /// # Errors
    /// A manifest that is missing or damaged.
    pub fn open(root: impl Into<PathBuf>) -> Result<Self, DataError> {
        let dir = BenchDir::new(root);
        let manifest = toml_file::read(&dir.manifest(), "see docs/formats.md for the fields of a benchmark")?;
        Ok(Self { dir, manifest })
    }

    /// Refuses a scene that the benchmark does not have.
    ///
    /// # Errors
    /// A name that is no scene of the benchmark.
    pub fn scene(&self, name: &str) -> Result<&Name, DataError> {
        self.manifest.scenes.iter().find(|scene| scene.as_str() == name).ok_or_else(|| {
            let known: Vec<&str> = self.manifest.scenes.iter().map(Name::as_str).collect();
            DataError::invalid(
                &self.dir.manifest(),
                "field `scenes`",
                format!("has no scene `{name}`"),
                choose_among(name, &known),
            )
        })
    }

    /// The scenes of a selection, in table order; an empty selection means all.
    ///
    /// # Errors
    /// A name that is no scene of the benchmark.
    pub fn select(&self, wanted: &[String]) -> Result<Vec<Name>, DataError> {
        for name in wanted {
            self.scene(name)?;
        }
        let chosen = |scene: &&Name| wanted.is_empty() || wanted.iter().any(|name| name == scene.as_str());
        Ok(self.manifest.scenes.iter().filter(chosen).cloned().collect())
    }

    /// Single-category queries of a scene.
    ///
    /// # Errors
    /// A file of queries that is missing or damaged.
    pub fn queries(&self, scene: &Name) -> Result<Vec<Query>, DataError> {
        read_queries(&self.dir.queries(scene), scene)
    }

    /// Queries of two categories of a scene; none where there is no such file.
    ///
    /// # Errors
    /// A file of queries that is damaged.
    pub fn composites(&self, scene: &Name) -> Result<Vec<Query>, DataError> {
        let path = self.dir.composites(scene);
        if path.exists() { read_queries(&path, scene) } else { Ok(Vec::new()) }
    }

    /// Sentences that nothing in a scene satisfies; none where there is no such file.
    ///
    /// # Errors
    /// A file of queries that is damaged.
    pub fn absents(&self, scene: &Name) -> Result<Vec<Query>, DataError> {
        let path = self.dir.absents(scene);
        if path.exists() { read_absents(&path, scene) } else { Ok(Vec::new()) }
    }

    /// Which draw a scene is: that of its composition, or of the whole set.
    ///
    /// # Errors
    /// A composition that is damaged.
    pub fn draw_of(&self, scene: &Name) -> Result<Draw, DataError> {
        let composition = self.dir.read_composition(scene)?;
        Ok(composition.map_or(self.manifest.draw(), |composition| composition.draw()))
    }

    /// Queries of a set of a scene.
    ///
    /// # Errors
    /// A file of queries that is missing or damaged.
    pub fn asked(&self, set: QuerySet, scene: &Name) -> Result<Vec<Query>, DataError> {
        match set {
            QuerySet::Queries => self.queries(scene),
            QuerySet::Composites => self.composites(scene),
            QuerySet::Absents => self.absents(scene),
            QuerySet::WithAbsents => {
                let mut all = self.queries(scene)?;
                all.extend(self.absents(scene)?);
                Ok(all)
            }
        }
    }

    /// Truth of a scene.
    ///
    /// # Errors
    /// A truth file that is missing or damaged, or that is of another scene or profile.
    pub fn truth(&self, profile: Profile, scene: &Name) -> Result<Truth, DataError> {
        let path = self.dir.truth(profile, scene);
        if !path.exists() {
            return Err(DataError::invalid(
                &path,
                "file",
                format!("there is no truth of profile {profile} for {scene}"),
                format!("choose another --profile, or {}", how_truth_is_made(profile, scene)),
            ));
        }
        Truth::read(&path)
    }

    /// Tracks of a scene.
    ///
    /// # Errors
    /// Tracks that are missing or damaged.
    pub fn tracks(&self, scene: &Name) -> Result<Tracks, DataError> {
        Tracks::read(&self.dir.tracks(scene))
    }

    /// SHA-256 over the names and digests of the truth files of a profile that exist, in table order. Results
    /// carry it, so that masks of another rendering or version are refused.
    ///
    /// # Errors
    /// Truth that is missing or cannot be read.
    pub fn truth_digest(&self, profile: Profile) -> Result<String, DataError> {
        self.truth_digest_if_any(profile)?.ok_or_else(|| {
            DataError::invalid(
                &self.dir.root().join("truth").join(profile.as_str()),
                "folder",
                format!("holds no truth of profile {profile}"),
                match profile.is_rendered() {
                    true => {
                        format!("choose another --profile, or run `l4d build-scenes --profile {profile}`")
                    }
                    false => "choose another --profile, or run `l4d import-scene` with --masks and --bench"
                        .to_owned(),
                },
            )
        })
    }

    /// [`Self::truth_digest`], none where no scene has a truth: methods run without one.
    ///
    /// # Errors
    /// Truth that cannot be read.
    pub fn truth_digest_if_any(&self, profile: Profile) -> Result<Option<String>, DataError> {
        let mut lines = String::new();
        for scene in &self.manifest.scenes {
            let path = self.dir.truth(profile, scene);
            if path.exists() {
                lines.push_str(&format!("{}  {scene}.json\n", sha256_file(&path)?));
            }
        }
        Ok((!lines.is_empty()).then(|| sha256_hex(lines.as_bytes())))
    }

    pub fn root(&self) -> &Path {
        self.dir.root()
    }
}

/// What makes the truth of a scene.
pub fn how_truth_is_made(profile: Profile, scene: &str) -> String {
    match profile.is_rendered() {
        true => format!("run `l4d build-scenes --profile {profile} --scenes {scene}`"),
        false => format!("run `l4d import-scene ... --name {scene}` with --masks and --bench"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_says_which_draw_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = BenchDir::new(folder.path()).manifest();
        let plain = "name = \"P\"\nversion = \"1.0.0\"\nlicence = \"CC-BY-4.0\"\nscenes = [\"a\"]\n";
        std::fs::write(&path, plain).unwrap();
        let manifest = Benchmark::open(folder.path()).unwrap().manifest;
        assert_eq!((manifest.draw(), manifest.split), (Draw::default(), SetSplit::Test));
        let drawn = Manifest { variant: 7, seed: 3, split: SetSplit::Private, ..manifest };
        std::fs::write(&path, drawn.to_toml("Drawn.").unwrap()).unwrap();
        let read = Benchmark::open(folder.path()).unwrap().manifest;
        assert_eq!(read, drawn);
        assert_eq!(read.draw(), Draw { variant: 7, seed: 3 });
        std::fs::write(&path, format!("{plain}variant = -1\n")).unwrap();
        assert!(Benchmark::open(folder.path()).unwrap_err().to_string().contains("variant"));
    }
}
