//! What a set of composed scenes says of itself: manifest, `SHA256SUMS`, and the digest of its secret.
//!
//! Finds what was changed since it was written. Refuses to know how scenes are made.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use l4d_data::benchmark::{Manifest, SetSplit};
use l4d_data::composition::Composition;
use l4d_data::digest::sha256_file;
use l4d_data::layout::BenchDir;
use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::tracks::Tracks;
use l4d_data::{Benchmark, DataError, Name, Progress, StageError, json, sums};

use crate::wish::called;
use crate::{Composed, write};

/// More files than a person wants to read are counted.
const SHOWN: usize = 8;

/// A set that is being composed.
#[derive(Debug)]
pub(crate) struct Ledger<'o> {
    out: &'o BenchDir,
    manifest: Manifest,
    /// Relative path -> digest.
    sums: BTreeMap<String, String>,
}

impl<'o> Ledger<'o> {
    /// The set in a folder, or a new one.
    ///
    /// # Errors
    /// A folder that holds something else, or a private set of another secret.
    pub(crate) fn open(
        out: &'o BenchDir,
        split: SetSplit,
        secret_digest: Option<&str>,
    ) -> Result<Self, StageError> {
        let refuse = |what: String| {
            let message = format!("{} holds {what}", out.root().display());
            Err(StageError::new(message, "choose another --out"))
        };
        let manifest = match out.manifest().exists() {
            true => Benchmark::open(out.root())?.manifest,
            false => empty(split),
        };
        if let Some(scene) = manifest.scenes.iter().find(|scene| !out.composition(scene).exists()) {
            return refuse(format!("`{scene}`, which is no composed scene"));
        }
        if manifest.split != split {
            return refuse(format!("a set of split {}", called(manifest.split)));
        }
        let kept = secret_file(out);
        let standing = kept.exists().then(|| read_bounded(&kept, 1000)).transpose()?;
        let standing = standing.map(|bytes| String::from_utf8_lossy(&bytes).trim().to_owned());
        match (standing.as_deref(), secret_digest) {
            (None, Some(_)) if !manifest.scenes.is_empty() => {
                return refuse("scenes of a secret of which nothing is known".to_owned());
            }
            (None, Some(digest)) => write_atomic(&kept, format!("{digest}\n").as_bytes())?,
            (Some(_), None) => return refuse("a private set".to_owned()),
            (Some(standing), Some(digest)) if standing != digest => {
                return refuse("a private set of another secret".to_owned());
            }
            _ => {}
        }
        let path = sums_file(out);
        let sums = if path.exists() { sums::read(&path)? } else { BTreeMap::new() };
        Ok(Self { out, manifest, sums })
    }

    /// The wished scenes that have to be made: what is missing of the set, and with `force` what was changed in it.
    ///
    /// # Errors
    /// Files that were changed since they were written, or that are missing of scenes that no one wishes.
    pub(crate) fn missing(
        &self,
        wishes: &[Composition],
        force: bool,
        progress: &dyn Progress,
    ) -> Result<BTreeSet<Name>, StageError> {
        let wished: BTreeSet<&Name> = wishes.iter().map(|wish| &wish.scene).collect();
        let known: BTreeSet<&Name> = self.manifest.scenes.iter().chain(wished.iter().copied()).collect();
        let mut missing = BTreeSet::new();
        let mut differing = Vec::new();
        let mut is_mendable = true;
        for scene in known {
            for path in files(self.out, scene) {
                let name = self.relative(&path);
                let is_wished = wished.contains(scene);
                let why = match (path.exists(), self.sums.get(&name)) {
                    (true, Some(digest)) if sha256_file(&path)? == *digest => continue,
                    (true, Some(_)) => "",
                    (true, None) => " (in no SHA256SUMS)",
                    (false, _) if is_wished => {
                        missing.insert(scene.clone());
                        continue;
                    }
                    (false, _) => " (missing)",
                };
                differing.push(format!("{name}{why}"));
                is_mendable &= is_wished;
                missing.insert(scene.clone());
            }
        }
        let count = differing.len();
        if count > SHOWN {
            differing.truncate(SHOWN);
            differing.push(format!("and {} more", count - SHOWN));
        }
        let message = || {
            let list = differing.join(", ");
            format!("{} is not as it was composed: {list}", self.out.root().display())
        };
        match (count, force && is_mendable) {
            (0, _) => Ok(missing),
            (_, true) => {
                progress.warn(&format_args!("{}; composed anew", message()));
                Ok(missing)
            }
            (_, false) => Err(StageError::new(
                message(),
                "restore these files, or compose their scenes again with the same options and --force, which replaces them",
            )),
        }
    }

    /// Writes a scene, and that the set has it. Digests are first and the manifest is last: whenever a run is killed,
    /// what is there is known.
    pub(crate) fn add(
        &mut self,
        composition: &Composition,
        tracks: &Tracks,
        asked: &Composed,
        drafts: &BenchDir,
        progress: &dyn Progress,
    ) -> Result<(), StageError> {
        let scene = &composition.scene;
        put(drafts, composition, tracks, asked)?;
        for (draft, path) in files(drafts, scene).iter().zip(files(self.out, scene)) {
            let (name, digest) = (self.relative(&path), sha256_file(draft)?);
            let before = self.sums.insert(name.clone(), digest.clone());
            if before.is_some_and(|before| before != digest) {
                progress.warn(&format_args!("{name} is another than before: scripts or l4d have changed"));
            }
        }
        write_atomic(&sums_file(self.out), sums::to_text(&self.sums).as_bytes())?;
        put(self.out, composition, tracks, asked)?;
        self.list(scene)
    }

    /// Puts a scene that is complete into the manifest, which stays as it is in all else.
    pub(crate) fn list(&mut self, scene: &Name) -> Result<(), StageError> {
        if self.manifest.scenes.contains(scene) {
            return Ok(());
        }
        self.manifest.scenes.push(scene.clone());
        self.manifest.scenes.sort();
        let heading = "Composed by `l4d compose`; recipes/ says from which seeds.";
        Ok(write_atomic(&self.out.manifest(), self.manifest.to_toml(heading)?.as_bytes())?)
    }

    fn relative(&self, path: &Path) -> String {
        path.strip_prefix(self.out.root()).unwrap_or(path).display().to_string()
    }
}

fn empty(split: SetSplit) -> Manifest {
    Manifest {
        name: "Panoptic-L4D composed".to_owned(),
        version: "1.0.0".to_owned(),
        licence: "CC-BY-4.0".to_owned(),
        split,
        variant: 0,
        seed: 0,
        scenes: Vec::new(),
    }
}

/// The files of a scene that the set answers for.
fn files(out: &BenchDir, scene: &Name) -> [PathBuf; 5] {
    [out.composition(scene), out.tracks(scene), out.queries(scene), out.composites(scene), out.absents(scene)]
}

fn put(
    out: &BenchDir,
    composition: &Composition,
    tracks: &Tracks,
    asked: &Composed,
) -> Result<(), DataError> {
    let scene = &composition.scene;
    json::write(&out.composition(scene), composition)?;
    json::write_compact(&out.tracks(scene), tracks)?;
    write(out, scene, asked)
}

fn sums_file(out: &BenchDir) -> PathBuf {
    out.root().join("SHA256SUMS")
}

fn secret_file(out: &BenchDir) -> PathBuf {
    out.root().join("secret.sha256")
}
