//! Readers of files that others write, each as a function of bytes. `cargo fuzz` searches for bytes that make them
//! panic, hang or allocate without bound; `tests/corpus.rs` replays what it found worth keeping. They may refuse
//! anything, and what they take they must give back where there is a writer.
#![expect(clippy::unwrap_used, reason = "a fault here is what is looked for")]

use std::fs;
use std::path::{Path, PathBuf};

use glam::UVec2;
use l4d_data::Benchmark;
use l4d_data::query::read_queries;
use l4d_formats::{arrays, colmap, pickle};
use l4d_frames::{drawn, exr, photo};
use l4d_ground::GrounderFile;
use l4d_masks::{Mask, ids, png};
use l4d_splat::checkpoint::{foreign, ply};
use l4d_splat::source::ReaderOptions;
use tempfile::TempDir;

/// Size of the pictures that are expected, pixels.
pub const SIZE: [u32; 2] = [8, 6];

/// A name, and what takes bytes in under that name.
pub type Target = (&'static str, fn(&[u8]));

/// All targets, by name.
pub const TARGETS: [Target; 10] = [
    ("cfg_args", cfg_args),
    ("colmap", colmap_model),
    ("exr", exr_frame),
    ("jsonl", queries),
    ("npy", array),
    ("pickle", state_dict),
    ("ply", gaussians),
    ("png", pictures),
    ("rle", run_lengths),
    ("toml", settings),
];

/// Runs the target of that name.
pub fn run(name: &str, bytes: &[u8]) {
    let (_, target) = TARGETS.iter().find(|(known, _)| *known == name).unwrap();
    target(bytes);
}

/// The options of a 4DGaussians run, beside a sound save.
fn cfg_args(bytes: &[u8]) {
    on_disk(&[("cfg_args", bytes)], |folder| {
        let save = "point_cloud/iteration_7";
        let shipped =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/l4d-splat/tests/fixtures/checkpoint/model");
        fs::create_dir_all(folder.join(save)).unwrap();
        for file in ["point_cloud.ply", "deformation.pth"] {
            let to = folder.join(save).join(file);
            if !to.exists() {
                fs::copy(shipped.join(save).join(file), to).unwrap();
            }
        }
        drop(foreign::read(folder, ReaderOptions::default()));
    });
}

/// A COLMAP model: the first byte says whether as text or binary, the next two how long cameras and images are.
fn colmap_model(bytes: &[u8]) {
    let [form, cameras, images, rest @ ..] = bytes else { return };
    let end = if form.is_multiple_of(2) { "bin" } else { "txt" };
    let (cameras, rest) = rest.split_at(rest.len().min(usize::from(*cameras)));
    let (images, points) = rest.split_at(rest.len().min(usize::from(*images)));
    let names = ["cameras", "images", "points3D"].map(|stem| format!("{stem}.{end}"));
    let files = [(&*names[0], cameras), (&*names[1], images), (&*names[2], points)];
    on_disk(&files, |folder| {
        if let Ok(model) = colmap::Model::read(folder) {
            model.write(folder).unwrap();
        }
        // The next model may be text, which is read only where no binary one is.
        for stem in ["cameras", "images", "points3D"] {
            drop(fs::remove_file(folder.join(format!("{stem}.bin"))));
        }
    });
}

/// A frame of a scene.
fn exr_frame(bytes: &[u8]) {
    let (path, size) = (Path::new("frame.exr"), UVec2::from(SIZE));
    drop(exr::decode_surfaces(path, bytes, size));
    drop(exr::decode_seen(path, bytes, size));
    drop(exr::decode_depth(path, bytes, size));
}

/// Queries of a scene.
fn queries(bytes: &[u8]) {
    on_disk(&[("room_playroom.jsonl", bytes)], |folder| {
        drop(read_queries(&folder.join("room_playroom.jsonl"), "room_playroom"));
    });
}

/// An array, or an archive of arrays.
fn array(bytes: &[u8]) {
    let name = if bytes.starts_with(b"PK") { "array.npz" } else { "array.npy" };
    on_disk(&[(name, bytes)], |folder| drop(arrays::read(&folder.join(name), None)));
}

/// What torch saves: the pickle alone, and the archive around it.
fn state_dict(bytes: &[u8]) {
    drop(pickle::decode(bytes));
    on_disk(&[("state.pth", bytes)], |folder| drop(pickle::read_state_dict(&folder.join("state.pth"))));
}

/// Gaussians.
fn gaussians(bytes: &[u8]) {
    drop(ply::decode(bytes));
}

/// Masks, ids, depth and photographs.
fn pictures(bytes: &[u8]) {
    let [width, height] = SIZE;
    if let Ok(mask) = png::decode_any(bytes) {
        assert!(png::decode_any(&png::encode(&mask)).unwrap() == mask);
    }
    drop(png::decode(bytes, width, height));
    drop(ids::decode(bytes));
    drop(drawn::decode_depth_png(bytes, width, height));
    drop(photo::decode(bytes));
}

/// Run lengths of a mask: what is taken comes back.
fn run_lengths(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let [width, height] = SIZE;
    if let Ok(mask) = Mask::decode(text, width, height) {
        assert!(Mask::decode(&mask.to_rle().counts(), width, height).unwrap() == mask);
    }
}

/// Settings that people write.
fn settings(bytes: &[u8]) {
    on_disk(&[("panoptic-l4d.toml", bytes)], |folder| {
        drop(Benchmark::open(folder));
        drop(GrounderFile::read(&folder.join("panoptic-l4d.toml")));
    });
}

thread_local! {
    static FOLDER: TempDir = l4d_testing::folder();
}

/// Writes files into a folder that is used again and again, and reads it.
fn on_disk(files: &[(&str, &[u8])], read: impl FnOnce(&Path)) {
    FOLDER.with(|folder| {
        let path: PathBuf = folder.path().to_owned();
        for (name, bytes) in files {
            fs::write(path.join(name), bytes).unwrap();
        }
        read(&path);
    });
}
