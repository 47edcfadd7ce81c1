//! `l4d render-splats` and `l4d bench splats` on a made-up room.

use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use glam::UVec2;
use half::f16;
use l4d_data::{Camera, json};
use l4d_frames::drawn::{decode_colour, decode_depth_png, picture_of};
use l4d_frames::exr::{decode_depth, write_frame};
use l4d_frames::{Frame, frame::Surfaces};
use l4d_splat::checkpoint::ply;
use l4d_splat::model::{Model, time_of_frame};
use l4d_splat::raster::{Cpu, Drawing, RasterSettings, Rasterizer as _};
use l4d_splat::synthetic::Room;
use l4d_splat::view::View;
use serde_json::json;

use crate::support::{Dir, Run};

const SIZE: [u32; 2] = [128, 96];
const CLIPS: &str = "work/tiny/room/clips";

fn model() -> Model {
    Room::small(4).model().unwrap()
}

/// Cameras for pictures of profile tiny.
fn cameras() -> Vec<Camera> {
    let halved = |camera: Camera| Camera {
        fx: camera.fx / 2.0,
        fy: camera.fy / 2.0,
        cx: camera.cx / 2.0,
        cy: camera.cy / 2.0,
        ..camera
    };
    Room::small(4).cameras().unwrap().into_iter().map(halved).collect()
}

/// A folder with the scene `room` in profile tiny and its checkpoint.
fn folder() -> Dir {
    let dir = Dir::new();
    let scene = l4d_testing::scene("room", cameras(), Vec::new());
    json::write(&dir.path("data/tiny/room/scene.json"), &scene).unwrap();
    model().write(&dir.path("work/tiny/room/splats")).unwrap();
    dir
}

fn render(dir: &Dir, more: &str) -> Run {
    dir.run(format!("render-splats room --profile tiny {more}"))
}

fn draw(camera: usize, frame: u32) -> Drawing {
    let splats = model().at(time_of_frame(frame)).unwrap();
    let view = View::of_camera(&cameras()[camera], frame, SIZE, SIZE).unwrap();
    Cpu::new().prepare(&splats, &view, &RasterSettings::default()).unwrap().draw().unwrap()
}

#[test]
fn clips_hold_what_the_model_shows() {
    let dir = folder();
    let run = render(&dir, "--views cam00,cam05 --frames 0,48");
    assert_eq!((run.code, run.stdout.trim()), (0, format!("{CLIPS}/manifest.json").as_str()), "{run}");
    for (camera, frame) in [(0, 0), (0, 48), (5, 0), (5, 48)] {
        let stem = format!("{CLIPS}/cam0{camera}/{frame:04}");
        let drawing = draw(camera, frame);
        let colour = decode_colour(&dir.bytes(&format!("{stem}.png")), SIZE[0], SIZE[1]).unwrap();
        assert_eq!(colour, picture_of(SIZE[0], SIZE[1], &drawing.colour), "{stem}");
        let file = dir.bytes(&format!("{stem}.exr"));
        let depth = decode_depth(Path::new(&stem), &file, UVec2::from_array(SIZE)).unwrap();
        let quantiles = drawing.quantiles.unwrap();
        assert_eq!(depth.depth_m, quantiles.median_m, "{stem}");
        let half = |list: &[f32]| list.iter().map(|&value| f16::from_f32(value)).collect::<Vec<_>>();
        assert_eq!(depth.alpha, half(&drawing.alpha));
        assert_eq!((depth.near_m, depth.far_m), (half(&quantiles.near_m), half(&quantiles.far_m)));
    }
    let manifest = dir.value(&format!("{CLIPS}/manifest.json"));
    assert_eq!(manifest["schema"], "l4d/clips/1");
    assert_eq!(manifest["drawn"]["model"]["dynamic"], 100);
    assert_eq!(manifest["drawn"]["depth"], json!({ "kind": "median", "format": "exr", "unit_m": 1.0 }));
    let view = &manifest["views"]["cam05"];
    assert_eq!((&view["camera"]["fx"], &view["pictures"]["0048"]["time"]), (&json!(100.0), &json!(0.5)));
    let digest = l4d_data::digest::sha256_hex(&dir.bytes(&format!("{CLIPS}/cam05/0048.png")));
    assert_eq!(view["pictures"]["0048"]["colour"], digest);
}

#[test]
fn by_default_all_training_views_are_drawn_at_all_frames_of_the_profile() {
    let dir = folder();
    render(&dir, "--depth sum --depth-format png").says(0, &[]);
    let manifest = dir.value(&format!("{CLIPS}/manifest.json"));
    let views = manifest["views"].as_object().unwrap();
    assert_eq!(views.len(), 8);
    assert!(!views.contains_key("cam08"), "the held-out view is drawn only if it is named");
    assert!(views.values().all(|view| view["pictures"].as_object().unwrap().len() == 9));
    let file = dir.bytes(&format!("{CLIPS}/cam02/0024.depth.png"));
    let depth_m = decode_depth_png(&file, SIZE[0], SIZE[1]).unwrap();
    for (read, drawn) in depth_m.iter().zip(draw(2, 24).depth_sum_m) {
        assert!((read - drawn).abs() <= 0.0005 + 1e-6, "{read} and {drawn}");
    }
}

#[test]
fn what_is_there_stays_and_what_is_missing_or_torn_is_drawn_again() {
    let dir = folder();
    let choice = "--views cam00,cam01 --frames 0,96";
    render(&dir, choice);
    let before = dir.tree(CLIPS);
    let torn = format!("{CLIPS}/cam00/0096.exr");
    let kept = dir.path(format!("{CLIPS}/cam01/0096.png"));
    let modified = || kept.metadata().unwrap().modified().unwrap();

    dir.remove(&format!("{CLIPS}/cam00/0000.png"));
    dir.write(&torn, &dir.bytes(&torn)[..100]);
    let untouched = modified();
    render(&dir, choice).says(0, &["2 pictures", "2 more were there"]);
    assert!(dir.tree(CLIPS) == before && modified() == untouched);

    // More of the same is added; the manifest knows all of it.
    render(&dir, "--views cam01,cam08 --frames 48").says(0, &[]);
    let views = dir.value(&format!("{CLIPS}/manifest.json"))["views"].clone();
    for (view, frames) in
        [("cam00", &["0000", "0096"][..]), ("cam01", &["0000", "0048", "0096"]), ("cam08", &["0048"])]
    {
        assert!(views[view]["pictures"].as_object().unwrap().keys().eq(frames), "{view}: {views}");
    }
}

#[test]
fn clips_of_something_else_are_never_mixed_in() {
    let dir = folder();
    let choice = "--views cam00 --frames 0";
    render(&dir, choice);
    for (more, parts) in [
        ("--depth expected", &["another depth", "hint: choose another --out"][..]),
        ("--size 64x48", &["another size"]),
        ("--background white", &["another background"]),
    ] {
        render(&dir, &format!("{choice} {more}")).refused(parts);
    }
    let file = format!("{CLIPS}/cam00/0000.png");
    let before = dir.bytes(&file);
    let mut other = model();
    other.gaussians.sh[0] = [1.0; 3];
    other.write(&dir.path("work/tiny/room/splats")).unwrap();
    render(&dir, choice).refused(&["another model"]);
    assert_eq!(dir.bytes(&file), before);

    // Replacing sweeps all old pictures away, also those that are not drawn anew.
    other.gaussians.sh.fill([0.5; 3]);
    other.write(&dir.path("work/tiny/room/splats")).unwrap();
    render(&dir, "--views cam01 --frames 0 --overwrite").says(0, &[]);
    assert!(!dir.path(&file).exists());
    // Files of unknown origin are not taken for our own.
    dir.write("elsewhere/cam00/0000.png", b"a picture of somebody else");
    let unknown = "cam00/0000.png: file: no manifest says what this file is";
    render(&dir, &format!("{choice} --out elsewhere")).refused(&[unknown]);
}

#[test]
fn other_programs_models_are_drawn_from_any_cameras_at_any_times() {
    let dir = folder();
    // Five Gaussians about the origin, metres wide: only from afar does the background show how they move.
    let theirs = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/l4d-splat/tests/fixtures/checkpoint/model");
    ply::write(&dir.path("bare.ply"), &model().gaussians).unwrap();
    let mut cameras =
        json!({ "width": 128, "height": 96, "note": "from elsewhere", "cameras": &cameras()[..2] });
    for camera in cameras["cameras"].as_array_mut().unwrap() {
        for entry in [3, 7, 11] {
            let coordinate = &mut camera["world_from_camera"][0][entry];
            *coordinate = json!(10.0 * coordinate.as_f64().unwrap());
        }
    }
    dir.write("cameras.json", cameras.to_string());

    for (path, family, dynamic) in [(theirs, "4dgaussians", 5), ("bare.ply", "ply", 0)] {
        let common = "--cameras cameras.json --times 0.25,0.5 --size 64x48";
        dir.succeed(format!("render-splats --model {path} --out {family} {common}"));
        let manifest = dir.value(&format!("{family}/manifest.json"));
        let model = &manifest["drawn"]["model"];
        assert_eq!((&model["family"], &model["dynamic"]), (&json!(family), &json!(dynamic)));
        let view = &manifest["views"]["cam01"];
        assert_eq!(view["camera"]["cx"], 32.0);
        assert_eq!(view["pictures"]["t0.250000"]["time"], 0.25);
        let [first, second] =
            ["t0.250000", "t0.500000"].map(|key| dir.bytes(&format!("{family}/cam01/{key}.png")));
        decode_colour(&second, 64, 48).unwrap();
        assert_eq!(first != second, dynamic > 0, "a bare PLY is static, the model of 4DGaussians moves");
    }
}

#[test]
fn what_cannot_be_drawn_is_refused_before_anything_is_written() {
    let dir = folder();
    let mut moving = cameras()[0].clone();
    moving.world_from_camera = vec![moving.world_from_camera[0]; 97];
    let mut blind = moving.clone();
    blind.fx = 0.0;
    for (name, camera) in [("moving.json", &moving), ("blind.json", &blind)] {
        dir.write(name, json!({ "width": 128, "height": 96, "cameras": [camera] }).to_string());
    }
    dir.write("torn.json", "{\"width\": 128");
    for (more, parts) in [
        ("--views cam99", &["no view `cam99`", "hint: choose among cam00, cam01"][..]),
        ("--frames 97", &["frame 97 is beyond the clip"]),
        ("--model nowhere", &["nowhere: model: there is nothing", "hint:"]),
        ("--adapter 'no such adapter'", &["no graphics adapter is named like"]),
        ("--background 2,0,0", &["three numbers from 0 to 1"]),
        ("--cameras blind.json", &["camera cam00: field `fx` is 0", "hint: mend"]),
        ("--cameras moving.json --times 0.5", &["camera cam00 moves", "hint: choose frames"]),
        ("--cameras torn.json", &["torn.json"]),
    ] {
        render(&dir, more).says(2, parts);
    }
    dir.run("render-splats").says(2, &["<SCENE>"]);
    dir.run("render-splats unknown --profile tiny").says(2, &["scene.json: cannot open"]);
    assert!(!dir.path(CLIPS).exists());
    render(&dir, "--cameras moving.json --frames 12,24").says(0, &[]);
}

#[test]
fn a_preview_is_a_video_where_ffmpeg_is_and_an_animated_png_elsewhere() {
    let dir = folder();
    std::fs::create_dir(dir.path("bin")).unwrap();
    let preview = || -> Run {
        let choice = "--views cam00,cam01,cam02 --frames 0,48,96 --preview";
        let mut command = dir.command(format!("render-splats room --profile tiny {choice}"));
        command.env("PATH", dir.path("bin")).output().unwrap().into()
    };
    preview().says(0, &["ffmpeg is not on the PATH"]);
    let animation = dir.bytes(&format!("{CLIPS}/preview.png"));
    assert!(animation.windows(4).any(|tag| tag == b"acTL"), "no animation");

    // Takes the place of ffmpeg: keeps its arguments and its input.
    let script = "#!/bin/sh\nfor last; do :; done\necho \"$@\" > arguments\n/bin/cat > \"$last\"\n";
    dir.write("bin/ffmpeg", script);
    let executable = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(dir.path("bin/ffmpeg"), executable).unwrap();
    preview().says(0, &["preview.mp4"]);
    let arguments = dir.read("arguments");
    let size = arguments.split("-s ").nth(1).unwrap().split(' ').next().unwrap();
    let (width, height) = size.split_once('x').unwrap();
    let pixels = width.parse::<usize>().unwrap() * height.parse::<usize>().unwrap();
    let video = dir.bytes(&format!("{CLIPS}/preview.mp4"));
    assert_eq!(video.len(), 3 * 3 * pixels, "three pages of {size}");
    assert!(arguments.contains("-r 1.000"), "two steps of two seconds each: {arguments}");

    dir.write("bin/ffmpeg", "#!/bin/sh\necho 'no such codec' >&2\nexit 1\n");
    preview().says(0, &["warning: ffmpeg failed (no such codec)"]);
}

/// Rows of the table, without what the clock says.
fn rows(dir: &Dir, out: &str) -> Vec<BTreeMap<String, String>> {
    let mut table = dir.table(&format!("{out}/splats.csv"));
    for row in &mut table {
        assert!(number(row, "picture_ms") > 0.0);
        let columns = row.len();
        row.retain(|name, _| !name.ends_with("_ms"));
        assert_eq!(row.len(), columns - 3, "{row:?}");
    }
    table
}

fn number(row: &BTreeMap<String, String>, field: &str) -> f64 {
    row[field].parse().unwrap_or_else(|_| panic!("{field} is `{}`", row[field]))
}

#[test]
fn the_bench_of_a_made_up_room_says_the_same_twice_but_for_times() {
    let dir = Dir::new();
    let quick = "bench splats --gaussians 300 --size 48x36 --views 2 --times 2 --repeats 1";
    for out in ["a", "b"] {
        dir.succeed(format!("{quick} --out {out}"));
    }
    let table = rows(&dir, "a");
    assert_eq!(table, rows(&dir, "b"));
    for file in ["splats.svg", "splats.png"] {
        assert!(dir.bytes(&format!("a/{file}")).len() > 5000, "{file}");
    }
    let of = |sweep: &str| table.iter().filter(|row| row["sweep"] == sweep).collect::<Vec<_>>();

    // The fast path is close to the reference in f64; every reduction of a kind costs more than the one before.
    let base = &table[0];
    assert!(number(base, "error_max") < 0.02 && number(base, "error_mean") < 1e-5, "{base:?}");
    for sweep in ["fewer Gaussians", "smaller pictures"] {
        let errors: Vec<f64> = of(sweep).iter().map(|row| number(row, "error_mean")).collect();
        assert!(errors.len() > 2 && errors.is_sorted(), "{sweep}: {errors:?}");
        assert!(errors[errors.len() - 1] > number(base, "error_mean"), "{sweep}");
    }
    let counts: Vec<f64> = of("fewer Gaussians").iter().map(|row| number(row, "gaussians")).collect();
    assert_eq!(counts, [270.0, 225.0, 180.0, 135.0, 90.0, 45.0]);
    let sizes: Vec<f64> = of("fewer Gaussians").iter().map(|row| number(row, "megabytes")).collect();
    assert!(sizes.windows(2).all(|pair| pair[1] < pair[0]), "{sizes:?}");
    // Other instructions round differently; one thread does not.
    let machines = of("other machinery");
    assert_eq!(machines[1]["error_mean"], base["error_mean"], "one thread");
    assert!(table.iter().all(|row| row["psnr_db"].is_empty()), "no picture of the room exists");
}

#[test]
fn the_bench_of_a_scene_compares_with_its_held_out_pictures() {
    let dir = folder();
    // A quarter of the light shows as 255 (1.055 * 0.25^(1 / 2.4) - 0.055) = 137.
    let frame = Frame {
        surfaces: Surfaces::empty(SIZE[0], SIZE[1]),
        rgb: vec![[f16::from_f32(0.25); 3]; (SIZE[0] * SIZE[1]) as usize],
    };
    for number in [0, 96] {
        let path = format!("data/tiny/room/frames/cam08/{number:04}.exr");
        write_frame(&dir.path(path), &frame).unwrap();
    }
    let bench = "bench splats room --profile tiny --times 2 --repeats 1 --sweeps resolution";
    let run = dir.json(bench);
    let rows = run["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 5, "the model as it is, and four sizes");
    let error = |camera: usize, frame: u32| {
        let drawing = draw(camera, frame);
        let values = drawing.colour.as_flattened();
        let squares: f64 =
            values.iter().map(|value| f64::from(value.clamp(0.0, 1.0) - 137.0 / 255.0).powi(2)).sum();
        -10.0 * (squares / values.len() as f64).log10()
    };
    let expected = (error(8, 0) + error(8, 96)) / 2.0;
    assert!((rows[0]["psnr_db"].as_f64().unwrap() - expected).abs() < 2e-3, "{} and {expected}", rows[0]);
    assert!(dir.path("work/bench/splats/splats.png").exists());

    dir.remove("data/tiny/room/frames/cam08/0096.exr");
    dir.run(bench).says(2, &["0096.exr: cannot open"]);
    dir.run("bench splats --model x").says(2, &["<SCENE>"]);
}
