//! Ids of a capture: what people drew on pictures of its training views.

use std::collections::BTreeMap;
use std::path::PathBuf;

use l4d_data::capture::{Capture, MASKS, MaskSet, MaskedInstance};
use l4d_data::digest::sha256_file;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Instance, Role};
use l4d_data::truth::frame_key;
use l4d_data::{DataError, Name, Split};
use l4d_masks::Mask;
use l4d_masks::mask::nearest;
use serde_json::{Value, json};

use super::IdSource;

/// Masks on the training views of one capture.
#[derive(Debug)]
pub(super) struct DrawnIds {
    path: PathBuf,
    set: MaskSet,
    set_sha256: String,
    instances: Vec<Instance>,
    training: Vec<Name>,
    /// Width and height of clips, pixels.
    size: [u32; 2],
    /// What clips show of the pictures, from their upper left corner, pixels.
    of: [u32; 2],
}

impl DrawnIds {
    /// Opens the masks of a capture, for clips of `size` that show `of` of its pictures; an error if there are none on a
    /// training view.
    pub(super) fn open(dir: SceneDir, size: [u32; 2], of: [u32; 2]) -> Result<Self, DataError> {
        let path = dir.root().join(MASKS);
        let hint = "draw on pictures of training views and run `l4d import-scene ... --masks-only`, or choose another grounder";
        if !path.exists() {
            let message = "the capture has no drawn masks, and the oracle knows nothing else";
            return Err(DataError::invalid(&path, "file", message, hint));
        }
        let capture = Capture::read(dir.root())?;
        let set = MaskSet::read(dir.root())?;
        let training: Vec<Name> = capture
            .cameras
            .into_iter()
            .filter(|camera| camera.split == Split::Train)
            .map(|camera| camera.name)
            .collect();
        let is_drawn = |one: &MaskedInstance| one.masks.keys().any(|view| training.contains(view));
        if !set.instances.iter().any(is_drawn) {
            let message = "nothing is drawn on a training view, and the oracle looks at no other";
            return Err(DataError::invalid(&path, "views", message, hint));
        }
        let instance = |one: &MaskedInstance| Instance {
            id: one.id,
            name: one.name.clone(),
            role: Role::Object,
            category: one.category(),
            attributes: BTreeMap::new(),
            front: None,
        };
        let instances = set.instances.iter().map(instance).collect();
        let set_sha256 = sha256_file(&path)?;
        Ok(Self { path, set_sha256, instances, training, set, size, of })
    }

    /// A mask of a picture as clips show it: a pixel is what is at its centre.
    fn shown(&self, mask: &Mask) -> Mask {
        let from = |place: u32, axis: usize| nearest(place, self.of[axis], self.size[axis]);
        let [width, height] = self.size;
        Mask::from_fn(width, height, |column, row| mask.get(from(column, 0), from(row, 1)))
    }
}

impl IdSource for DrawnIds {
    fn identity(&self) -> Value {
        json!({ "masks_json_sha256": self.set_sha256 })
    }

    fn instances(&self) -> &[Instance] {
        &self.instances
    }

    fn pixels_of(&self, view: &Name, frame: u32, ids: &[u32]) -> Result<Mask, DataError> {
        let refuse = |message: String, hint: &str| {
            Err(DataError::invalid(&self.path, format!("view {view}, frame {frame}"), message, hint))
        };
        if !self.training.contains(view) {
            let hint = "ask about training views: what is held out is for the judge alone";
            return refuse("is no picture of a training view".to_owned(), hint);
        }
        let key = frame_key(frame);
        let is_drawn =
            |one: &MaskedInstance| one.masks.get(view).is_some_and(|frames| frames.contains_key(&key));
        if !self.set.instances.iter().any(is_drawn) {
            let hint = "draw on it, or ask about fewer frames with --clip-every";
            return refuse("no mask is drawn on this picture".to_owned(), hint);
        }
        let mut pixels = Mask::empty(self.set.width, self.set.height);
        for one in self.set.instances.iter().filter(|one| ids.contains(&one.id)) {
            let Some(mask) = one.mask(view, frame) else { continue };
            pixels.union_with(&Mask::from_rle(mask, self.set.width, self.set.height));
        }
        Ok(self.shown(&pixels))
    }
}

#[cfg(test)]
mod tests {
    use l4d_data::capture::{CAPTURE, Depth, MASKS_SCHEMA, SCHEMA};
    use l4d_data::{Camera, json};

    use super::*;

    const SIZE: [u32; 2] = [10, 7];

    /// A capture with a square on one picture of a training view and of the held-out one.
    fn write(folder: &std::path::Path, drawn: &[&str]) -> SceneDir {
        let name = |text: &str| Name::new(text).unwrap();
        let camera = |view: &str, split| Camera {
            name: name(view),
            split,
            fx: 9.0,
            fy: 9.0,
            cx: 5.0,
            cy: 3.5,
            world_from_camera: vec![[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]],
        };
        let capture = Capture {
            schema: SCHEMA.to_owned(),
            name: name("table"),
            source: "made up".to_owned(),
            width: SIZE[0],
            height: SIZE[1],
            cameras: vec![camera("cam00", Split::Test), camera("cam01", Split::Train)],
            frames: vec![0, 1],
            frames_per_second: None,
            depth: Depth::Absent,
            points: 0,
            is_metric: false,
            unseen: BTreeMap::new(),
            substituted: Vec::new(),
            inputs: BTreeMap::new(),
            notes: Vec::new(),
        };
        let dir = SceneDir::new(folder, "table");
        json::write(&dir.root().join(CAPTURE), &capture).unwrap();
        let square = Mask::from_fn(SIZE[0], SIZE[1], |column, row| (2..6).contains(&column) && row < 4);
        let frames = BTreeMap::from([(frame_key(0), Some(square.to_rle()))]);
        let masks = drawn.iter().map(|view| (name(view), frames.clone())).collect();
        let one = MaskedInstance { id: 1, name: name("cup"), label: "cup: red".to_owned(), masks };
        let set = MaskSet {
            schema: MASKS_SCHEMA.to_owned(),
            scene: name("table"),
            width: SIZE[0],
            height: SIZE[1],
            instances: vec![one],
            notes: Vec::new(),
        };
        set.write(dir.root(), false).unwrap();
        dir
    }

    #[test]
    fn what_was_drawn_on_training_views_is_seen_at_the_size_of_clips() {
        let folder = tempfile::tempdir().unwrap();
        let dir = write(folder.path(), &["cam00", "cam01"]);
        let ids = DrawnIds::open(dir, [5, 3], [10, 6]).unwrap();
        assert_eq!(ids.instances()[0].category, "cup");
        let view = Name::new("cam01").unwrap();
        let expected = Mask::from_fn(5, 3, |column, row| (1..3).contains(&column) && row < 2);
        assert_eq!(ids.pixels_of(&view, 0, &[1]).unwrap(), expected);
        assert!(ids.pixels_of(&view, 0, &[2]).unwrap().is_empty());
        let said = |view: &str, frame| {
            ids.pixels_of(&Name::new(view).unwrap(), frame, &[1]).unwrap_err().to_string()
        };
        assert!(said("cam01", 1).contains("view cam01, frame 1: no mask is drawn"));
        assert!(said("cam00", 0).contains("no picture of a training view"));
    }

    #[test]
    fn a_capture_that_nobody_drew_on_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let dir = write(folder.path(), &["cam00"]);
        let error = DrawnIds::open(dir.clone(), SIZE, SIZE).unwrap_err();
        assert!(error.to_string().contains("nothing is drawn on a training view"), "{error}");
        assert!(error.hint().contains("--masks-only"));
        std::fs::remove_file(dir.root().join(MASKS)).unwrap();
        let error = DrawnIds::open(dir, SIZE, SIZE).unwrap_err();
        assert!(error.to_string().contains("has no drawn masks"), "{error}");
    }
}
