//! From a capture with masks to a scene that can be asked about: its truth, in a benchmark folder of real scenes.
//!
//! What people drew on the held-out view is the truth; frames on which no one drew are not judged. Real and rendered
//! scenes never share a folder: a score over both would mean nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use l4d_data::benchmark::{Manifest, SetSplit};
use l4d_data::capture::{Capture, MASKS, MaskSet, MaskedInstance};
use l4d_data::layout::BenchDir;
use l4d_data::scene::{OBJECT_IDS, Role};
use l4d_data::store::{write_atomic, write_unless_held};
use l4d_data::truth::{InstanceTruth, SCHEMA, Truth, frame_key};
use l4d_data::{Benchmark, Camera, DataError, Name, Profile, Scale, json};
use l4d_masks::Rle;

/// Heading of a manifest that is made here.
const HEADING: &str = "Real scenes. Their pictures stay where they came from; queries and truth are here.";

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Published {
    pub truth: PathBuf,
    /// Where the queries are, or are to be written.
    pub queries: PathBuf,
    /// Frames that are judged.
    pub annotated: usize,
    /// All frames of the held-out view.
    pub frames: usize,
}

/// Writes the truth of a capture into a benchmark folder, and the folder itself where there is none. Queries
/// that are there stay, and so does other truth unless `force`.
///
/// # Errors
/// No or several held-out views with masks, more objects than there are ids, a folder of rendered scenes, other truth
/// that is there, and damaged masks.
pub fn publish(
    capture: &Capture,
    set: &MaskSet,
    scale: Scale,
    bench: &Path,
    force: bool,
) -> Result<Published, DataError> {
    let truth = truth_of(capture, set, scale)?;
    let dir = BenchDir::new(bench);
    let manifest = manifest(&dir, &capture.name)?;
    let path = dir.truth(Profile::Real, &capture.name);
    let hint = "give another --bench or --name, or replace it with --force";
    write_unless_held(&path, &json::compact(&path, &truth)?, force, hint)?;
    let queries = dir.queries(&capture.name);
    if !queries.exists() {
        write_atomic(&queries, b"")?;
    }
    if let Some(manifest) = manifest {
        let text = manifest.to_toml(HEADING);
        let text = text.map_err(|error| DataError::format(&dir.manifest(), "manifest", error))?;
        write_atomic(&dir.manifest(), text.as_bytes())?;
    }
    // What was written must be what will be read.
    Truth::read(&path)?;
    Ok(Published { queries, annotated: truth.frames.len(), frames: truth.clip().len(), truth: path })
}

/// The manifest with the scene among its scenes; none where it is among them already.
fn manifest(dir: &BenchDir, scene: &Name) -> Result<Option<Manifest>, DataError> {
    if !dir.manifest().exists() {
        return Ok(Some(Manifest {
            name: "Real scenes".to_owned(),
            version: "0.1.0".to_owned(),
            licence: "as the source of each capture".to_owned(),
            split: SetSplit::Test,
            variant: 0,
            seed: 0,
            scenes: vec![scene.clone()],
        }));
    }
    let mut manifest = Benchmark::open(dir.root())?.manifest;
    if let Some(rendered) = manifest.scenes.iter().find(|scene| dir.tracks(scene).exists()) {
        let message = format!("holds the rendered scene {rendered}");
        let hint = "give real scenes a folder of their own with --bench";
        return Err(DataError::invalid(dir.root(), "folder", message, hint));
    }
    if manifest.scenes.contains(scene) {
        return Ok(None);
    }
    manifest.scenes.push(scene.clone());
    Ok(Some(manifest))
}

fn truth_of(capture: &Capture, set: &MaskSet, scale: Scale) -> Result<Truth, DataError> {
    let view = judged_view(capture, set)?;
    if set.instances.len() > *OBJECT_IDS.end() as usize {
        let message =
            format!("{} objects are drawn, but ids end at {}", set.instances.len(), OBJECT_IDS.end());
        return Err(DataError::invalid(Path::new(MASKS), "instances", message, "draw fewer kinds of things"));
    }
    let keys: BTreeSet<&String> =
        set.instances.iter().filter_map(|one| one.masks.get(&view.name)).flat_map(BTreeMap::keys).collect();
    let is_annotated = |frame: &u32| keys.contains(&frame_key(*frame));
    let seen = capture.frames.iter().copied().filter(|frame| capture.saw(&view.name, *frame));
    let (frames, unannotated): (Vec<u32>, Vec<u32>) = seen.partition(is_annotated);
    // Pixels of an instance at each frame.
    let areas = |one: &MaskedInstance| {
        let area = |frame: &u32| one.mask(&view.name, *frame).map_or(0, Rle::area);
        frames.iter().map(|frame| u32::try_from(area(frame)).unwrap_or(u32::MAX)).collect()
    };
    let visible = set.instances.iter().map(|one| (one.name.clone(), areas(one))).collect();
    Ok(Truth {
        schema: SCHEMA.to_owned(),
        scene: capture.name.clone(),
        scale,
        variant: 0,
        profile: Profile::Real,
        width: capture.width,
        height: capture.height,
        test_view: view.name.clone(),
        instances: set.instances.iter().map(|one| instance_truth(one, &view.name, &frames)).collect(),
        frames,
        unannotated,
        visible: BTreeMap::from([(view.name.clone(), visible)]),
    })
}

/// The one held-out view on which someone drew.
fn judged_view<'a>(capture: &'a Capture, set: &MaskSet) -> Result<&'a Camera, DataError> {
    let is_drawn = |camera: &&Camera| set.instances.iter().any(|one| one.masks.contains_key(&camera.name));
    let drawn: Vec<&Camera> = capture.held_out().filter(is_drawn).collect();
    match drawn.as_slice() {
        [camera] => Ok(camera),
        [] => {
            let hint = "hold a view out (--held-out) and draw on its pictures";
            Err(DataError::invalid(Path::new(MASKS), "views", "nothing is drawn on a held-out view", hint))
        }
        several => {
            let names: Vec<&str> = several.iter().map(|camera| camera.name.as_str()).collect();
            let message = format!("several held-out views have masks: {}", names.join(", "));
            let hint = "hold out the one that is judged (--held-out)";
            Err(DataError::invalid(Path::new(MASKS), "views", message, hint))
        }
    }
}

fn instance_truth(instance: &MaskedInstance, view: &Name, frames: &[u32]) -> InstanceTruth {
    let mask = |frame: &u32| Some((frame_key(*frame), instance.mask(view, *frame)?.clone()));
    InstanceTruth {
        name: instance.name.clone(),
        id: instance.id,
        role: Role::Object,
        category: instance.category(),
        masks: frames.iter().filter_map(mask).collect(),
    }
}
