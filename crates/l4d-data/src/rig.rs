//! The cameras of a scene, the size of their pictures, and when those were taken: the part of `scene.json`, or of
//! `capture.json`, that a method may know.
//!
//! Whatever else is in the file (instances, events) is skipped unread, so that nothing that works from a rig can
//! depend on it.

use std::collections::BTreeMap;
use std::path::Path;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use crate::camera::{Camera, Split, cameras_problem};
use crate::error::DataError;
use crate::json;
use crate::name::Name;
use crate::timeline::{Interval, Profile, Timeline};

/// No moment has a larger number: cameras that move have a pose for each.
const MOST_FRAMES: u32 = 100_000;

/// Cameras that look at one scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Rig {
    /// Columns of the pictures, pixels.
    pub width: u32,
    /// Rows of the pictures, pixels.
    pub height: u32,
    pub cameras: Vec<Camera>,
    /// Numbers of the moments of a capture, ascending; none of a rendered scene, whose profile says them.
    #[serde(default, deserialize_with = "some_frames")]
    pub frames: Vec<u32>,
    /// Of a capture, where known.
    #[serde(default)]
    frames_per_second: Option<f64>,
    /// View -> moments that it did not see.
    #[serde(default)]
    unseen: BTreeMap<Name, Vec<u32>>,
}

fn some_frames<'de, D: Deserializer<'de>>(frames: D) -> Result<Vec<u32>, D::Error> {
    let frames = Vec::deserialize(frames)?;
    if frames.is_empty() { Err(D::Error::custom("is empty, but a clip has frames")) } else { Ok(frames) }
}

impl Rig {
    /// Reads the cameras of a `scene.json` or `capture.json`, or of any JSON file with the first three fields.
    ///
    /// # Errors
    /// A file that cannot be read, or cameras that cannot be.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let mut rig: Self = json::read(path)?;
        let wrong = |place: String, message: String| {
            DataError::invalid(path, place, message, "mend the camera, or take it out of the file")
        };
        if rig.cameras.is_empty() {
            return Err(wrong("field `cameras`".to_owned(), "is empty".to_owned()));
        }
        if let Some((place, problem)) = cameras_problem(&rig.cameras) {
            return Err(wrong(place, problem));
        }
        if let Some((field, message)) = rig.clip_problem() {
            let hint = "import the scene again";
            return Err(DataError::invalid(path, format!("field `{field}`"), message, hint));
        }
        rig.hold_poses();
        Ok(rig)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// When frames were.
    pub fn timeline(&self) -> Timeline {
        match (self.frames.first(), self.frames.last()) {
            (Some(&first), Some(&last)) => {
                let whole = Interval::new(first, last).unwrap_or(Interval::WHOLE);
                Timeline::new(whole, self.frames_per_second)
            }
            _ => Timeline::CANONICAL,
        }
    }

    /// The frames of the clip, ascending: those of the capture, or those that the profile renders.
    pub fn clip(&self, profile: Profile) -> Vec<u32> {
        if self.frames.is_empty() { profile.frames().collect() } else { self.frames.clone() }
    }

    /// Whether a view saw a moment.
    pub fn saw(&self, view: &str, frame: u32) -> bool {
        self.unseen.get(view).is_none_or(|frames| !frames.contains(&frame))
    }

    /// A camera that moved stays, after the last moment that it saw, where it was then.
    fn hold_poses(&mut self) {
        let Some(&last) = self.frames.last() else { return };
        for poses in self.cameras.iter_mut().map(|camera| &mut camera.world_from_camera) {
            if let Some(&pose) = poses.last().filter(|_| poses.len() > 1 && poses.len() <= last as usize) {
                poses.resize(last as usize + 1, pose);
            }
        }
    }

    /// What is wrong with the frames, as (field, message).
    fn clip_problem(&self) -> Option<(&'static str, String)> {
        if let Some(frame) = self.frames.last().filter(|frame| **frame > MOST_FRAMES) {
            return Some(("frames", format!("has {frame}, but numbers end at {MOST_FRAMES}")));
        }
        if let Some(pair) = self.frames.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Some(("frames", format!("has {} before {}, but the list ascends", pair[0], pair[1])));
        }
        let rate = self.frames_per_second.filter(|rate| !(rate.is_finite() && *rate > 0.0))?;
        Some(("frames_per_second", format!("is {rate}, but frames follow each other at some rate")))
    }

    /// Those that methods may train on.
    pub fn training(&self) -> Vec<Camera> {
        self.cameras.iter().filter(|camera| camera.split == Split::Train).cloned().collect()
    }

    /// The one that is held out, if there is one.
    pub fn held_out(&self) -> Option<&Camera> {
        self.cameras.iter().find(|camera| camera.split == Split::Test)
    }

    /// The camera of that name.
    pub fn camera(&self, name: &str) -> Option<&Camera> {
        self.cameras.iter().find(|camera| camera.name.as_str() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(cameras: &str) -> Result<Rig, DataError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.json");
        let text = format!(r#"{{"width":8,"height":6,"instances":"not ours","cameras":[{cameras}]}}"#);
        std::fs::write(&path, text).unwrap();
        Rig::read(&path)
    }

    fn camera(name: &str, split: &str, fx: f64) -> String {
        format!(
            r#"{{"name":"{name}","split":"{split}","fx":{fx},"fy":9,"cx":4,"cy":3,
            "world_from_camera":[[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]]}}"#
        )
    }

    #[test]
    fn what_is_no_business_of_methods_is_not_read() {
        let rig = read(&[camera("a", "train", 9.0), camera("b", "test", 9.0)].join(",")).unwrap();
        assert_eq!(rig.size(), [8, 6]);
        assert_eq!(rig.training().len(), 1);
        assert_eq!(rig.held_out().unwrap().name.as_str(), "b");
        assert!(rig.camera("c").is_none());
    }

    #[test]
    fn a_capture_has_frames_of_its_own() {
        let read = |more: &str| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("capture.json");
            let cameras = camera("a", "train", 9.0);
            std::fs::write(&path, format!(r#"{{"width":8,"height":6,"cameras":[{cameras}]{more}}}"#))
                .unwrap();
            Rig::read(&path)
        };
        let rig = read(r#","frames":[151,153,155],"frames_per_second":null,"unseen":{"a":[153]}"#).unwrap();
        assert_eq!(rig.clip(Profile::Real), [151, 153, 155]);
        assert_eq!((rig.timeline().time(153), rig.saw("a", 153), rig.saw("a", 155)), (0.5, false, true));
        let rendered = read("").unwrap();
        assert_eq!((rendered.timeline(), rendered.clip(Profile::Tiny).len()), (Timeline::CANONICAL, 9));
        let said = |more: &str| read(more).unwrap_err().to_string();
        assert!(said(r#","frames":[3,3]"#).contains("`frames`: has 3 before 3"));
        assert!(said(r#","frames":[3],"frames_per_second":0"#).contains("`frames_per_second`: is 0"));
    }

    #[test]
    fn cameras_that_cannot_be_are_named() {
        let said = |cameras: &str| read(cameras).unwrap_err().to_string();
        assert!(said("").contains("is empty"));
        assert!(said(&camera("a", "train", 0.0)).contains("camera a: field `fx`"));
        let twice = [camera("a", "train", 9.0), camera("a", "test", 9.0)].join(",");
        assert!(said(&twice).contains("twice"));
    }
}
