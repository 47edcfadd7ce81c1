//! The cameras of a scene and the size of their pictures: the part of `scene.json` that a method may know.
//!
//! Whatever else stands in the file (instances, events) is skipped unread, so that nothing that works from a rig can
//! depend on it.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Deserialize;

use crate::camera::{Camera, Split};
use crate::error::DataError;
use crate::json;

/// Cameras that look at one scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Rig {
    /// Columns of the pictures, pixels.
    pub width: u32,
    /// Rows of the pictures, pixels.
    pub height: u32,
    /// From where.
    pub cameras: Vec<Camera>,
}

impl Rig {
    /// Reads the cameras of a `scene.json`, or of any JSON file with these three fields.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let rig: Self = json::read(path)?;
        let wrong = |place: String, message: String| {
            DataError::invalid(path, place, message, "mend the camera, or take it out of the file")
        };
        if rig.cameras.is_empty() {
            return Err(wrong("field `cameras`".to_owned(), "is empty".to_owned()));
        }
        let mut names = BTreeSet::new();
        for camera in &rig.cameras {
            let problem = camera
                .problem()
                .or_else(|| (!names.insert(&camera.name)).then(|| "the name stands there twice".to_owned()));
            if let Some(problem) = problem {
                return Err(wrong(format!("camera {}", camera.name), problem));
            }
        }
        Ok(rig)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
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
    fn cameras_that_cannot_be_are_named() {
        let said = |cameras: &str| read(cameras).unwrap_err().to_string();
        assert!(said("").contains("is empty"));
        assert!(said(&camera("a", "train", 0.0)).contains("camera a: field `fx`"));
        let twice = [camera("a", "train", 9.0), camera("a", "test", 9.0)].join(",");
        assert!(said(&twice).contains("twice"));
    }
}
