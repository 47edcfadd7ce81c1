//! The page of `l4d view` in a real browser: its Gaussians against the CPU rasterizer, and what a person can do.

use std::time::Duration;

use l4d_frames::drawn::picture_of;
use l4d_splat::raster::{Cpu, RasterSettings, Rasterizer as _};
use l4d_splat::synthetic::Room;
use l4d_splat::view::View;
use l4d_testing::Dataset;
use serde_json::{Value, json};

use super::browser::Browser;
use crate::support::Dir;

const PAGE: &str = "work/tiny/yard/view.html";
/// Of 255.
const MOST_DIFFERENCE: f64 = 0.5;

/// The yard of `l4d-testing` with a made-up room as its model, and its page.
fn viewed(more: &str) -> Dir {
    let dir = Dir::new();
    let fake = Dataset::new();
    crate::support::copy(&fake.data(), &dir.path("data/tiny"));
    crate::support::copy(fake.bench().root(), &dir.path("benchmark"));
    let query = l4d_testing::query("yard/001", "The ball that rolls", &["ball_red"], [24, 60]);
    dir.write("benchmark/queries/yard.jsonl", format!("{}\n", serde_json::to_string(&query).unwrap()));
    Room::small(4).model().unwrap().write(&dir.path("work/tiny/yard/splats")).unwrap();
    dir.succeed(format!("view yard --profile tiny {more}"));
    dir
}

fn open(dir: &Dir) -> Browser {
    let mut browser = Browser::start(1280, 900);
    browser.open_file(&dir.path(PAGE));
    browser
}

/// What the page holds.
fn document(dir: &Dir) -> Value {
    let html = dir.read(PAGE);
    let (_, after) = html.split_once("id=\"document\">").unwrap();
    serde_json::from_str(after.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn gaussians_look_as_the_cpu_rasterizer_draws_them() {
    let dir = viewed("");
    let mut browser = open(&dir);
    let scene = l4d_data::Scene::read(&dir.path("data/tiny/yard/scene.json")).unwrap();
    let model = Room::small(4).model().unwrap();
    let size = [scene.width, scene.height];
    for (camera, frame) in [("cam00", 0), ("cam02", 48), ("cam04", 50)] {
        let splats = model.at(l4d_splat::model::time_of_frame(frame)).unwrap();
        let view = View::of_camera(scene.camera(camera).unwrap(), frame, size, size).unwrap();
        let drawn = Cpu::new().prepare(&splats, &view, &RasterSettings::default()).unwrap().draw().unwrap();
        let expected = picture_of(size[0], size[1], &drawn.colour).into_raw();
        let light = expected.iter().map(|byte| f64::from(*byte)).sum::<f64>() / expected.len() as f64;
        assert!(light > 10.0, "{camera} at {frame} shows something: {light}");
        for means in ["webgl", "software"] {
            let [width, height] = size;
            let script = format!("l4dView.picture({camera:?}, {frame}, [{width}, {height}], {means:?})");
            let shown: Vec<u8> = serde_json::from_value(browser.evaluate(&script)).unwrap();
            assert_eq!(shown.len(), expected.len());
            let differences = shown.iter().zip(&expected).map(|(a, b)| f64::from(a.abs_diff(*b)));
            let mean = differences.sum::<f64>() / expected.len() as f64;
            assert!(mean < MOST_DIFFERENCE, "{camera} at {frame} by {means}: {mean} of 255 on average");
        }
    }
}

#[test]
fn keys_play_step_and_change_what_is_shown() {
    let dir = viewed("");
    let mut browser = open(&dir);
    let key = |browser: &mut Browser, key: &str| {
        let event = format!("new KeyboardEvent('keydown', {{ key: {key:?}, bubbles: true }})");
        browser.evaluate(&format!("document.body.dispatchEvent({event})"));
    };
    key(&mut browser, "ArrowRight");
    assert_eq!(browser.evaluate("l4dView.state.frame"), 12, "the next frame that has a picture");
    key(&mut browser, " ");
    std::thread::sleep(Duration::from_millis(300));
    browser.until("l4dView.state.frame !== 12");
    key(&mut browser, " ");
    assert_eq!(browser.evaluate("l4dView.state.playing"), false);
    key(&mut browser, "3");
    assert_eq!(browser.evaluate("[l4dView.state.layer, l4dView.state.camera]"), json!(["picture", "cam02"]));
    key(&mut browser, "b");
    assert_eq!(browser.evaluate("l4dView.state.boxes"), true);
    key(&mut browser, "d");
    assert_eq!(browser.evaluate("[l4dView.state.layer, l4dView.state.camera]"), json!(["gaussians", ""]));
}

#[test]
fn a_sentence_shows_its_masks_in_the_held_out_view() {
    let dir = viewed("");
    assert_eq!(document(&dir)["sentences"][0]["text"], "The ball that rolls");
    let mut browser = open(&dir);
    browser.evaluate("document.querySelector('#sentences button').click()");
    assert_eq!(browser.evaluate("l4dView.state.camera"), "cam02");
    browser.until("document.querySelectorAll('#rows .truth i').length > 0");
    let holds = browser.text("document.querySelector('#rows .lane.now i').title");
    assert_eq!(holds, "holds: frames 24 to 60");
}

#[test]
fn nothing_is_wider_than_a_phone() {
    let dir = viewed("");
    let mut browser = open(&dir);
    for width in [375, 1280] {
        browser.resize(width, 800);
        browser.until(&format!("document.documentElement.scrollWidth <= {width}"));
    }
}

#[test]
fn what_is_not_there_is_refused_or_left_out() {
    let dir = viewed("--no-pictures");
    assert_eq!(document(&dir)["pictures"], Value::Null);
    let view = "view yard --profile tiny";
    dir.refuses(format!("{view} --methods mine"), &["results/mine", "method.json"]);
    dir.refuses(format!("{view} --methods a,b,c,d"), &["4 methods", "at most 3"]);
    dir.write(PAGE, "mine");
    dir.refuses(view, &["view.html", "was not written by l4d", "--force"]);
    dir.succeed(format!("{view} --force"));
    dir.remove("work/tiny/yard/splats");
    dir.refuses(view, &["splats"]);
}
