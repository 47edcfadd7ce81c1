//! Pictures as shards: tar files in the layout of WebDataset, one sample a picture, a scene and split apart.
//!
//! The key of a sample is `<scene>/<view>/<frame>`: the path of its files up to the first dot of their name. Which
//! picture is in which shard follows from the size of the pictures alone, so that each shard can be made by itself. How a
//! picture becomes the members of a sample is for the caller to say.

use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::truth::frame_key;
use l4d_data::{Camera, DataError, Profile, Scene, Split};
use rayon::prelude::*;

use crate::archive::{Archive as Writer, changed};
use crate::gather::Source;

/// No shard is larger.
pub const MOST_BYTES: u64 = 1_000_000_000;
/// Folder of all shards in a release.
pub(crate) const FOLDER: &str = "shards";
/// What a pixel takes at most in all members: 3 bytes of colour, 2 of depth, 4 of what depth leaves out, 2 of ids, and
/// what compression adds to what it cannot shrink.
const PIXEL_BYTES: u64 = 12;
/// The card of a sample, and the headers and padding of its members.
const SAMPLE_BYTES: u64 = 64 << 10;
/// So many samples are in memory at a time.
const AT_ONCE: usize = 16;

/// Makes the members of a sample from the bytes of a frame: the suffix of each and its bytes, sorted.
pub type Encode<'a> = &'a (
        dyn Fn(&Scene, &Camera, u32, &Path, &[u8]) -> Result<Vec<(&'static str, Vec<u8>)>, DataError> + Sync
    );

/// One picture of a shard.
#[derive(Debug, Clone)]
struct Picture {
    camera: Camera,
    frame: u32,
    source: Source,
}

/// One file of pictures.
#[derive(Debug, Clone)]
pub struct Shard {
    /// Path in the release.
    pub path: String,
    scene: Scene,
    pictures: Vec<Picture>,
}

/// `shards/<profile>/<scene>-<split>-`, then a number.
pub(crate) fn stem(profile: Profile, scene: &str, split: Split) -> String {
    let split = match split {
        Split::Train => "train",
        Split::Test => "test",
    };
    format!("{FOLDER}/{profile}/{scene}-{split}-")
}

/// The shards of a scene; `source` gives the file of a picture.
pub fn shards(scene: &Scene, most_bytes: u64, source: impl Fn(&Camera, u32) -> Option<Source>) -> Vec<Shard> {
    let sample_bytes = u64::from(scene.width) * u64::from(scene.height) * PIXEL_BYTES + SAMPLE_BYTES;
    let most = (most_bytes / sample_bytes).max(1) as usize;
    let mut all = Vec::new();
    for split in [Split::Test, Split::Train] {
        let mut cameras: Vec<&Camera> = scene.cameras.iter().filter(|camera| camera.split == split).collect();
        cameras.sort_by(|a, b| a.name.cmp(&b.name));
        let pictures: Vec<Picture> = cameras
            .into_iter()
            .flat_map(|camera| scene.profile.frames().map(move |frame| (camera, frame)))
            .filter_map(|(camera, frame)| {
                Some(Picture { camera: camera.clone(), frame, source: source(camera, frame)? })
            })
            .collect();
        all.extend(pictures.chunks(most).enumerate().map(|(number, pictures)| Shard {
            path: format!("{}{number:03}.tar", stem(scene.profile, &scene.name, split)),
            scene: scene.clone(),
            pictures: pictures.to_vec(),
        }));
    }
    all
}

impl Shard {
    /// Bytes of the pictures that it is made of.
    pub(crate) fn source_bytes(&self) -> u64 {
        self.pictures.iter().map(|picture| picture.source.bytes).sum()
    }

    /// How many samples it has.
    pub(crate) fn len(&self) -> usize {
        self.pictures.len()
    }

    /// Writes it; it appears when it is whole. Pictures whose bytes are not those of their digest are refused.
    ///
    /// # Errors
    /// A picture that cannot be read, changed meanwhile or is no frame, and what the disk refuses.
    pub fn write(
        &self,
        path: &Path,
        encode: Encode<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(), DataError> {
        let mut writer = Writer::create(path)?;
        for pictures in self.pictures.chunks(AT_ONCE) {
            let encoded = pictures.par_iter().map(|picture| self.encode(picture, encode, progress));
            for (picture, members) in pictures.iter().zip(encoded.collect::<Result<Vec<_>, _>>()?) {
                let key = format!("{}/{}/{}", self.scene.name, picture.camera.name, frame_key(picture.frame));
                for (suffix, bytes) in members {
                    writer.add(&format!("{key}.{suffix}"), &bytes)?;
                }
            }
        }
        writer.commit()
    }

    fn encode(
        &self,
        picture: &Picture,
        encode: Encode<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Vec<(&'static str, Vec<u8>)>, DataError> {
        let Source { path, bytes, sha256, .. } = &picture.source;
        let found = read_bounded(path, *bytes).map_err(|_larger| changed(path))?;
        if l4d_data::digest::sha256_hex(&found) != *sha256 {
            return Err(changed(path));
        }
        progress(*bytes);
        encode(&self.scene, &picture.camera, picture.frame, path, &found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_a_split_fill_shards_up_to_their_size() {
        let scene = l4d_testing::Dataset::new().scene;
        let source = |camera: &Camera, frame: u32| {
            Some(Source {
                name: format!("{}/{frame}", camera.name),
                path: "x".into(),
                sha256: String::new(),
                bytes: 1,
            })
        };
        let (frames, views) = (scene.profile.frames().count(), scene.cameras.len());
        let paths = |most_bytes: u64| -> Vec<(String, usize)> {
            shards(&scene, most_bytes, source).iter().map(|shard| (shard.path.clone(), shard.len())).collect()
        };
        let whole = [
            ("shards/tiny/yard-test-000.tar".to_owned(), frames),
            ("shards/tiny/yard-train-000.tar".to_owned(), frames * (views - 1)),
        ];
        assert_eq!(paths(MOST_BYTES), whole);
        let one_each = paths(1);
        assert_eq!(one_each.len(), frames * views);
        assert_eq!(one_each[frames + 10].0, "shards/tiny/yard-train-010.tar");
        let sample_bytes = 128 * 96 * PIXEL_BYTES + SAMPLE_BYTES;
        assert_eq!(paths(sample_bytes * 10)[1].1, 10);
    }
}
