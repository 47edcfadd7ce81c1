//! Archives and shards into files, each of which appears whole; nothing that is here with other content is replaced.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

use l4d_data::digest::sha256_hex;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::store::write_unless_held;
use l4d_data::{DataError, Name};
use rayon::prelude::*;
use tar::Archive;

use super::Decode;

const HINT: &str = "move it away, or name other folders with --data, --work and --bench";
const DAMAGED: &str = "ask the publisher of the release";
/// So many samples are in memory at a time.
const AT_ONCE: usize = 16;

/// Unpacks the files of an archive whose names begin with `prefix`; gives them below the target with their digests.
pub(super) fn unpack(
    archive: &Path,
    prefix: &str,
    target: &Path,
) -> Result<BTreeMap<String, String>, DataError> {
    let mut written = BTreeMap::new();
    for_each(archive, |name, bytes| {
        let refuse =
            || DataError::invalid(archive, format!("entry {name}"), "does not belong there", DAMAGED);
        let file = name.strip_prefix(prefix).ok_or_else(refuse)?;
        let stays_inside = Path::new(file).components().all(|part| matches!(part, Component::Normal(_)));
        if file.is_empty() || !stays_inside {
            return Err(refuse());
        }
        write_unless_held(&target.join(file), &bytes, false, HINT)?;
        written.insert(file.to_owned(), sha256_hex(&bytes));
        Ok(())
    })?;
    Ok(written)
}

/// Pictures of a scene on their way into its folder.
pub(super) struct Frames<'a> {
    pub(super) scene: &'a Name,
    pub(super) target: &'a Path,
    pub(super) with_ids: bool,
    pub(super) decode: Decode<'a>,
}

/// Suffix of a member -> its bytes.
type Members = BTreeMap<String, Vec<u8>>;

impl Frames<'_> {
    /// Makes the frames of a shard; gives them below the target with their digests.
    pub(super) fn unpack(&self, shard: &Path) -> Result<BTreeMap<String, String>, DataError> {
        let scene = Scene::read(&self.target.join("scene.json"))?;
        let mut written = BTreeMap::new();
        let mut samples: Vec<(String, Members)> = Vec::new();
        let mut write = |samples: &mut Vec<(String, Members)>| {
            let made = samples.par_iter().map(|(key, members)| self.write(shard, &scene, key, members));
            written.extend(made.collect::<Result<Vec<_>, DataError>>()?);
            samples.clear();
            Ok::<(), DataError>(())
        };
        for_each(shard, |name, bytes| {
            let file = name.rfind('/').map_or(0, |slash| slash + 1);
            let dot = name[file..].find('.').map_or(name.len(), |dot| file + dot);
            let (key, suffix) = (&name[..dot], name[dot..].trim_start_matches('.'));
            if samples.last().is_none_or(|(last, _)| last != key) {
                if samples.len() == AT_ONCE {
                    write(&mut samples)?;
                }
                samples.push((key.to_owned(), Members::new()));
            }
            if let Some((_, members)) =
                samples.last_mut().filter(|_| self.with_ids || !suffix.starts_with("ids."))
            {
                members.insert(suffix.to_owned(), bytes);
            }
            Ok(())
        })?;
        write(&mut samples)?;
        Ok(written)
    }

    fn write(
        &self,
        shard: &Path,
        scene: &Scene,
        key: &str,
        members: &Members,
    ) -> Result<(String, String), DataError> {
        let sample = shard.join(key);
        let parts: Vec<&str> = key.split('/').collect();
        let place = match parts.as_slice() {
            [name, view, frame] if *name == self.scene.as_str() => scene
                .camera(view)
                .zip(frame.parse().ok().filter(|frame| scene.profile.frames().any(|one| one == *frame))),
            _ => None,
        };
        let Some((camera, frame)) = place else {
            let message = format!("is no picture of {}", self.scene);
            return Err(DataError::invalid(&sample, "sample", message, DAMAGED));
        };
        let bytes = (self.decode)(&sample, members)?;
        let folder = SceneDir::new(Path::new(""), "");
        let file = folder.frame(&camera.name, frame).to_string_lossy().replace('\\', "/");
        write_unless_held(&self.target.join(&file), &bytes, false, HINT)?;
        Ok((file, sha256_hex(&bytes)))
    }
}

/// Hands on name and bytes of each file of an archive; anything but files is refused.
fn for_each(
    path: &Path,
    mut each: impl FnMut(&str, Vec<u8>) -> Result<(), DataError>,
) -> Result<(), DataError> {
    let refuse = |source: io::Error| DataError::io(path, "read", source);
    let mut archive = Archive::new(File::open(path).map_err(refuse)?);
    for entry in archive.entries().map_err(refuse)? {
        let mut entry = entry.map_err(refuse)?;
        let name: PathBuf = entry.path().map_err(refuse)?.into_owned();
        let name = name.to_string_lossy().replace('\\', "/");
        if !entry.header().entry_type().is_file() {
            return Err(DataError::invalid(path, format!("entry {name}"), "is no file", DAMAGED));
        }
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(refuse)?;
        each(&name, bytes)?;
    }
    Ok(())
}
