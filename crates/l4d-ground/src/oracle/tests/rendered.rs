//! Ids of pictures on disk.

use l4d_data::layout::SceneDir;
use l4d_data::{Camera, Split};
use l4d_testing::{camera, flat, scene};

use super::super::ids::RenderedIds;
use super::*;

/// A scene of two training views and the held-out one, of which a picture each was rendered: a stripe of id 1
/// in the first columns, as many as the number of the view and one.
fn write_scene(folder: &std::path::Path) -> SceneDir {
    let views = [("cam00", Split::Train), ("cam01", Split::Train), ("cam02", Split::Test)];
    let cameras = views.map(|(view, split)| camera(view, split));
    let picture = |camera: &Camera, frame: u32| {
        let last: u32 = camera.name.as_str()[3..].parse().unwrap();
        (frame == 0).then(|| flat(|column, _| u32::from(column <= last)))
    };
    l4d_testing::write_scene(folder, scene("yard", cameras.into(), Vec::new()), picture);
    SceneDir::new(folder, "yard")
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
