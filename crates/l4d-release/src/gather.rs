//! What a benchmark folder holds for a release: its scenes as values, its files with their digests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::benchmark::Manifest;
use l4d_data::digest::sha256_file;
use l4d_data::query::Query;
use l4d_data::scene::Scale;
use l4d_data::store::list_folder;
use l4d_data::tracks::Tracks;
use l4d_data::truth::Truth;
use l4d_data::{Benchmark, DataError, Name, Profile, Report};

use crate::codes;
use crate::words::Statuses;

/// A file that goes into a release.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Path in the archive, with `/`.
    pub name: String,
    /// Where it is now.
    pub path: PathBuf,
    /// SHA-256 that it has to have.
    pub sha256: String,
    /// Its size.
    pub bytes: u64,
}

impl Source {
    /// A file as it is now.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(name: String, path: PathBuf) -> Result<Self, DataError> {
        let sha256 = sha256_file(&path)?;
        Self::with_digest(name, path, sha256)
    }

    /// A file whose digest is known.
    ///
    /// # Errors
    /// If it cannot be found.
    pub fn with_digest(name: String, path: PathBuf, sha256: String) -> Result<Self, DataError> {
        let bytes = size_of(&path)?;
        Ok(Self { name, path, sha256, bytes })
    }
}

/// Bytes of a file.
pub(crate) fn size_of(path: &Path) -> Result<u64, DataError> {
    std::fs::metadata(path).map(|file| file.len()).map_err(|source| DataError::io(path, "read", source))
}

/// One scene of the benchmark.
#[derive(Debug, Clone)]
pub struct SceneFacts {
    pub name: Name,
    /// Its spatial scale.
    pub scale: Scale,
    /// Where everything is; none for captures.
    pub tracks: Option<Tracks>,
    /// Single-category queries.
    pub queries: Vec<Query>,
    /// Queries of two categories.
    pub composites: Vec<Query>,
    /// Sentences that nothing satisfies.
    pub absents: Vec<Query>,
    /// What the held-out view sees.
    pub truths: BTreeMap<Profile, Truth>,
    pub files: Vec<Source>,
}

/// A benchmark folder as a release takes it.
#[derive(Debug, Clone)]
pub struct Gathered {
    /// What it says of itself.
    pub manifest: Manifest,
    /// Its scenes, in table order.
    pub scenes: Vec<SceneFacts>,
    /// Profiles of which there is truth.
    pub profiles: Vec<Profile>,
    /// Files that belong to no scene.
    pub files: Vec<Source>,
}

impl Gathered {
    pub fn all_files(&self) -> impl Iterator<Item = &Source> {
        self.files.iter().chain(self.scenes.iter().flat_map(|scene| &scene.files))
    }

    /// How many scored queries have which status.
    pub(crate) fn statuses(&self) -> Statuses {
        Statuses::of(self.scenes.iter().flat_map(|scene| &scene.queries))
    }
}

/// Reads a benchmark folder; what is missing or unreadable becomes findings, and the scene is left out.
///
/// # Errors
/// If the folder cannot be listed.
pub fn gather(bench: &Benchmark, report: &mut Report) -> Result<Gathered, DataError> {
    let profiles = profiles(bench);
    let mut scenes = Vec::new();
    for name in &bench.manifest.scenes {
        match read_scene(bench, name, &profiles) {
            Ok(scene) => scenes.push(scene),
            Err(error) => report.data_error(codes::BENCHMARK, &error),
        }
    }
    if profiles.is_empty() {
        let path = bench.root().join("truth");
        let hint = "run `l4d build-scenes`, which writes it";
        report.error(codes::BENCHMARK, &path, "folder", "holds no truth of any scene", hint);
    }
    Ok(Gathered { manifest: bench.manifest.clone(), scenes, profiles, files: common_files(bench.root())? })
}

fn profiles(bench: &Benchmark) -> Vec<Profile> {
    let has_truth = |profile: &Profile| {
        bench.manifest.scenes.iter().any(|scene| bench.dir.truth(*profile, scene).exists())
    };
    Profile::ALL.into_iter().chain([Profile::Real]).filter(has_truth).collect()
}

fn read_scene(bench: &Benchmark, name: &Name, profiles: &[Profile]) -> Result<SceneFacts, DataError> {
    let dir = &bench.dir;
    // A capture has no tracks; every rendered scene has.
    let is_capture = !dir.tracks(name).exists() && dir.truth(Profile::Real, name).exists();
    let (scale, tracks) = if is_capture {
        (bench.truth(Profile::Real, name)?.scale, None)
    } else {
        let tracks = bench.tracks(name)?;
        (tracks.scale, Some(tracks))
    };
    let mut truths = BTreeMap::new();
    for &profile in profiles.iter().filter(|profile| profile.is_rendered() != is_capture) {
        truths.insert(profile, bench.truth(profile, name)?);
    }
    let mut paths = vec![dir.queries(name)];
    let others = [dir.composites(name), dir.absents(name), dir.tracks(name), dir.composition(name)];
    paths.extend(others.into_iter().filter(|path| path.exists()));
    paths.extend(truths.keys().map(|&profile| dir.truth(profile, name)));
    Ok(SceneFacts {
        scale,
        tracks,
        queries: bench.queries(name)?,
        composites: bench.composites(name)?,
        absents: bench.absents(name)?,
        truths,
        files: paths.into_iter().map(|path| source(bench.root(), path)).collect::<Result<_, _>>()?,
        name: name.clone(),
    })
}

/// Manifest, licence, vocabulary, published tables: those that exist.
fn common_files(root: &Path) -> Result<Vec<Source>, DataError> {
    let mut paths: Vec<PathBuf> =
        ["LICENSE", "panoptic-l4d.toml", "vocabulary.txt"].map(|name| root.join(name)).into();
    let published = root.join("published");
    if published.is_dir() {
        paths.extend(list_folder(&published)?.into_iter().map(|name| published.join(name)));
    }
    paths.retain(|path| path.is_file());
    paths.into_iter().map(|path| source(root, path)).collect()
}

/// In archives the folder is called `benchmark`, whatever it is called here: that is where the verbs look.
fn source(root: &Path, path: PathBuf) -> Result<Source, DataError> {
    let relative = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
    Source::read(format!("benchmark/{relative}"), path)
}
