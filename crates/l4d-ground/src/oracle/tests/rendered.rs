//! Ids of pictures on disk.

use half::f16;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Generator, SCHEMA};
use l4d_data::{Camera, Profile, Scale, Scene, Split};
use l4d_frames::exr::write_frame;
use l4d_frames::{Frame, Surfaces};

use super::super::ids::RenderedIds;
use super::*;

/// A scene of two training views and the held-out one, of which a picture each was rendered: a stripe of id 1
/// in the first columns, as many as the number of the view and one.
fn write_scene(folder: &std::path::Path) -> SceneDir {
    let dir = SceneDir::new(folder, "yard");
    let (width, height) = (Profile::Tiny.width(), Profile::Tiny.height());
    let camera = |index: u32| Camera {
        split: if index == 2 { Split::Test } else { Split::Train },
        ..blank_clip(&format!("cam0{index}"), width, height, &[0]).camera
    };
    let scene = Scene {
        schema: SCHEMA.to_owned(),
        name: name("yard"),
        scale: Scale::Room,
        variant: 0,
        seed: 0,
        profile: Profile::Tiny,
        stride: Profile::Tiny.stride(),
        width,
        height,
        exposure: 1.0,
        generator: Generator { bpy: "none".to_owned(), scripts_sha256: "0".repeat(64) },
        cameras: (0..3).map(camera).collect(),
        instances: Vec::new(),
        events: Vec::new(),
        digests: BTreeMap::new(),
    };
    l4d_data::json::write(&dir.scene(), &scene).unwrap();
    for (index, camera) in scene.cameras.iter().enumerate() {
        let mut surfaces = Surfaces::empty(width, height);
        for row in 0..height {
            for column in 0..=index as u32 {
                let pixel = surfaces.index(column, row);
                surfaces.id[pixel] = 1;
                surfaces.depth_m[pixel] = 2.0;
            }
        }
        let rgb = vec![[f16::ZERO; 3]; surfaces.id.len()];
        write_frame(&dir.frame(&camera.name, 0), &Frame { surfaces, rgb }).unwrap();
    }
    dir
}

#[test]
fn ids_come_from_the_pictures_of_training_views_alone() {
    let folder = tempfile::tempdir().unwrap();
    let ids = RenderedIds::open(write_scene(folder.path())).unwrap();
    let area = |view: &str, wanted: &[u32]| ids.pixels_of(&name(view), 0, wanted).map(|mask| mask.area());
    assert_eq!((area("cam00", &[1]).unwrap(), area("cam01", &[1, 5]).unwrap()), (96, 192));
    assert_eq!(area("cam00", &[2]).unwrap(), 0);
    assert!(area("cam02", &[1]).unwrap_err().to_string().contains("holds view `cam02` out"));
    assert!(area("cam09", &[1]).unwrap_err().to_string().contains("no view `cam09`"));
    // A picture that was read is not read again; one that is not there is an error.
    std::fs::remove_file(SceneDir::new(folder.path(), "yard").frame("cam00", 0)).unwrap();
    assert_eq!(area("cam00", &[1]).unwrap(), 96);
    assert!(ids.pixels_of(&name("cam00"), 12, &[1]).is_err());
}

#[test]
fn a_picture_that_is_not_there_is_the_error_of_its_view() {
    let folder = tempfile::tempdir().unwrap();
    let ids = RenderedIds::open(write_scene(folder.path())).unwrap();
    let targets = BTreeMap::from([(name("001"), target())]);
    let oracle = Oracle::new(name("yard"), Arc::new(ids), targets, NoisePreset::none());
    let answer = oracle.ground(&blank_clip("cam01", 128, 96, &[0]), &question("yard", "001"));
    assert_eq!((answer.outcome, answer.masks[&0].area()), (Outcome::Found, 192));
    let later = oracle.ground(&blank_clip("cam01", 128, 96, &[0, 12]), &question("yard", "001"));
    assert!(matches!(&later.outcome, Outcome::Error(why) if why.contains("cam01/0012.exr")), "{later:?}");
    assert!(later.masks.is_empty());
}
