//! `l4d render-splats` and `l4d bench splats` on a made-up room.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use glam::UVec2;
use half::f16;
use l4d_data::{Camera, json};
use l4d_frames::drawn::{decode_colour, decode_depth_png, picture_of};
use l4d_frames::exr::{decode_depth, write_frame};
use l4d_frames::{Frame, frame::Surfaces};
use l4d_splat::checkpoint::ply;
use l4d_splat::model::time_of_frame;
use l4d_splat::raster::{Cpu, Drawing, RasterSettings, Rasterizer as _};
use l4d_splat::synthetic::Room;
use l4d_splat::view::View;
use serde_json::{Value, json};

use crate::support::{Dir, Run};

const SIZE: [u32; 2] = [128, 96];

fn room() -> Room {
    Room::small(4)
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
    room().cameras().unwrap().into_iter().map(halved).collect()
}

/// A folder with the scene `room` in profile tiny and its checkpoint.
fn folder() -> Dir {
    let dir = Dir::new();
    let scene = l4d_testing::scene("room", cameras(), Vec::new());
    json::write(&dir.path("data/tiny/room/scene.json"), &scene).unwrap();
    room().model().unwrap().write(&dir.path("work/tiny/room/splats")).unwrap();
    dir
}

fn render(dir: &Dir, more: &[&str]) -> Run {
    dir.run(&[&["render-splats", "room", "--profile", "tiny"], more].concat())
}

fn draw(camera: usize, frame: u32) -> Drawing {
    let splats = room().model().unwrap().at(time_of_frame(frame)).unwrap();
    let view = View::of_camera(&cameras()[camera], frame, SIZE, SIZE).unwrap();
    Cpu::new().prepare(&splats, &view, &RasterSettings::default()).unwrap().draw().unwrap()
}

fn bytes(dir: &Dir, relative: &str) -> Vec<u8> {
    std::fs::read(dir.path(relative)).unwrap_or_else(|error| panic!("{relative}: {error}"))
}

fn manifest(dir: &Dir, clips: &str) -> Value {
    serde_json::from_str(&dir.read(&format!("{clips}/manifest.json"))).unwrap()
}

/// Everything but times on stderr goes through here: exit code 2, and what has to be said.
fn refused(run: &Run, said: &[&str]) {
    assert_eq!(run.code, 2, "{}{}", run.stdout, run.stderr);
    for words in said {
        assert!(run.stderr.contains(words), "`{words}` is not in: {}", run.stderr);
    }
}

const CLIPS: &str = "work/tiny/room/clips";

#[test]
fn clips_hold_what_the_model_shows() {
    let dir = folder();
    let run = render(&dir, &["--views", "cam00,cam05", "--frames", "0,48"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(run.stdout.trim(), format!("{CLIPS}/manifest.json"));
    for (camera, frame) in [(0, 0), (0, 48), (5, 0), (5, 48)] {
        let stem = format!("{CLIPS}/cam0{camera}/{frame:04}");
        let drawing = draw(camera, frame);
        let colour = decode_colour(&bytes(&dir, &format!("{stem}.png")), SIZE[0], SIZE[1]).unwrap();
        assert_eq!(colour, picture_of(SIZE[0], SIZE[1], &drawing.colour), "{stem}");
        let file = bytes(&dir, &format!("{stem}.exr"));
        let depth = decode_depth(Path::new(&stem), &file, UVec2::from_array(SIZE)).unwrap();
        let quantiles = drawing.quantiles.unwrap();
        assert_eq!(depth.depth_m, quantiles.median_m, "{stem}");
        let half = |list: &[f32]| list.iter().map(|&value| f16::from_f32(value)).collect::<Vec<_>>();
        assert_eq!(depth.alpha, half(&drawing.alpha));
        assert_eq!((depth.near_m, depth.far_m), (half(&quantiles.near_m), half(&quantiles.far_m)));
    }
    let manifest = manifest(&dir, CLIPS);
    assert_eq!(manifest["schema"], "l4d/clips/1");
    assert_eq!(manifest["drawn"]["model"]["dynamic"], 100);
    assert_eq!(manifest["drawn"]["depth"], json!({ "kind": "median", "format": "exr", "unit_m": 1.0 }));
    let view = &manifest["views"]["cam05"];
    assert_eq!(view["camera"]["fx"], 100.0);
    assert_eq!(view["pictures"]["0048"]["time"], 0.5);
    let digest = l4d_data::digest::sha256_hex(&bytes(&dir, &format!("{CLIPS}/cam05/0048.png")));
    assert_eq!(view["pictures"]["0048"]["colour"], digest);
}

#[test]
fn by_default_all_training_views_are_drawn_at_all_frames_of_the_profile() {
    let dir = folder();
    assert_eq!(render(&dir, &["--depth", "sum", "--depth-format", "png"]).code, 0);
    let manifest = manifest(&dir, CLIPS);
    let views = manifest["views"].as_object().unwrap();
    assert_eq!(views.len(), 8);
    assert!(!views.contains_key("cam08"), "the held-out view is drawn only if it is named");
    assert!(views.values().all(|view| view["pictures"].as_object().unwrap().len() == 9));
    let file = bytes(&dir, &format!("{CLIPS}/cam02/0024.depth.png"));
    let depth_m = decode_depth_png(&file, SIZE[0], SIZE[1]).unwrap();
    for (read, drawn) in depth_m.iter().zip(draw(2, 24).depth_sum_m) {
        assert!((read - drawn).abs() <= 0.0005 + 1e-6, "{read} and {drawn}");
    }
}

#[test]
fn what_is_there_stays_and_what_is_missing_or_torn_is_drawn_again() {
    let dir = folder();
    let choice = ["--views", "cam00,cam01", "--frames", "0,96"];
    render(&dir, &choice);
    let files = ["manifest.json", "cam00/0000.png", "cam00/0096.exr", "cam01/0096.png"];
    let files = files.map(|file| format!("{CLIPS}/{file}"));
    let before: Vec<Vec<u8>> = files.iter().map(|file| bytes(&dir, file)).collect();

    std::fs::remove_file(dir.path(&files[1])).unwrap();
    dir.write(&files[2], &before[2][..before[2].len() / 2]);
    let untouched = std::fs::metadata(dir.path(&files[3])).unwrap().modified().unwrap();
    let run = render(&dir, &choice);
    assert!(run.stderr.contains("2 pictures") && run.stderr.contains("2 more were there"), "{}", run.stderr);
    assert_eq!(files.each_ref().map(|file| bytes(&dir, file)).to_vec(), before);
    assert_eq!(std::fs::metadata(dir.path(&files[3])).unwrap().modified().unwrap(), untouched);

    // More of the same is added; the manifest knows all of it.
    assert_eq!(render(&dir, &["--views", "cam01,cam08", "--frames", "48"]).code, 0);
    let manifest = manifest(&dir, CLIPS);
    let keys =
        |view: &str| manifest["views"][view]["pictures"].as_object().unwrap().keys().cloned().collect();
    let (first, second, third): (Vec<String>, Vec<String>, Vec<String>) =
        (keys("cam00"), keys("cam01"), keys("cam08"));
    assert_eq!(
        (first.len(), second, third.len()),
        (2, ["0000", "0048", "0096"].map(str::to_owned).to_vec(), 1)
    );
}

#[test]
fn clips_of_something_else_are_never_mixed_in() {
    let dir = folder();
    let choice = ["--views", "cam00", "--frames", "0"];
    render(&dir, &choice);
    let with = |more: &[&str]| render(&dir, &[&choice[..], more].concat());
    refused(&with(&["--depth", "expected"]), &["another depth", "hint: choose another --out"]);
    refused(&with(&["--size", "64x48"]), &["another size"]);
    refused(&with(&["--background", "white"]), &["another background"]);
    let file = format!("{CLIPS}/cam00/0000.png");
    let before = bytes(&dir, &file);
    let mut other = room().model().unwrap();
    other.gaussians.sh[0] = [1.0; 3];
    other.write(&dir.path("work/tiny/room/splats")).unwrap();
    refused(&with(&[]), &["another model"]);
    assert_eq!(bytes(&dir, &file), before);

    // Replacing sweeps all old pictures away, also those that are not drawn anew.
    other.gaussians.sh.fill([0.5; 3]);
    other.write(&dir.path("work/tiny/room/splats")).unwrap();
    let run = render(&dir, &["--views", "cam01", "--frames", "0", "--overwrite"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(!dir.path(&file).exists());
    // Files of unknown origin are not taken for our own.
    dir.write("elsewhere/cam00/0000.png", b"a picture of somebody else");
    let run = with(&["--out", "elsewhere"]);
    refused(&run, &["cam00/0000.png: file: no manifest says what this file is"]);
}

#[test]
fn other_programs_models_are_drawn_from_any_cameras_at_any_times() {
    let dir = folder();
    let model = room().model().unwrap();
    // Five Gaussians about the origin, metres wide: only from afar does the background show how they move.
    let theirs = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/l4d-splat/tests/fixtures/checkpoint/model");
    ply::write(&dir.path("bare.ply"), &model.gaussians).unwrap();
    let mut cameras =
        json!({ "width": 128, "height": 96, "note": "from elsewhere", "cameras": &cameras()[..2] });
    for camera in cameras["cameras"].as_array_mut().unwrap() {
        for entry in [3, 7, 11] {
            let coordinate = &mut camera["world_from_camera"][0][entry];
            *coordinate = json!(10.0 * coordinate.as_f64().unwrap());
        }
    }
    dir.write("cameras.json", cameras.to_string());

    let common = ["--cameras", "cameras.json", "--times", "0.25,0.5", "--size", "64x48"];
    for (path, out) in [(theirs, "a"), ("bare.ply", "b")] {
        let run = dir.run(&[&["render-splats", "--model", path, "--out", out], &common[..]].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        let manifest = manifest(&dir, out);
        assert_eq!(manifest["views"]["cam01"]["camera"]["cx"], 32.0);
        assert_eq!(manifest["views"]["cam01"]["pictures"]["t0.250000"]["time"], 0.25);
        let [width, height] = [64, 48];
        decode_colour(&bytes(&dir, &format!("{out}/cam01/t0.500000.png")), width, height).unwrap();
    }
    let [theirs, bare] = ["a", "b"].map(|out| manifest(&dir, out)["drawn"]["model"].clone());
    assert_eq!((&theirs["family"], &theirs["dynamic"]), (&json!("4dgaussians"), &json!(5)));
    assert_eq!((&bare["family"], &bare["dynamic"]), (&json!("ply"), &json!(0)));
    let same = |out: &str| {
        bytes(&dir, &format!("{out}/cam01/t0.250000.png"))
            == bytes(&dir, &format!("{out}/cam01/t0.500000.png"))
    };
    assert!(same("b") && !same("a"), "a bare PLY is static, the model of 4DGaussians moves");
}

#[test]
fn what_cannot_be_drawn_is_refused_before_anything_is_written() {
    let dir = folder();
    refused(&render(&dir, &["--views", "cam99"]), &["no view `cam99`", "hint: choose among cam00, cam01"]);
    refused(&render(&dir, &["--frames", "97"]), &["frame 97 is beyond the clip"]);
    refused(&render(&dir, &["--times", "1.5"]), &["time 1.5 is outside the clip"]);
    refused(&render(&dir, &["--model", "nowhere"]), &["nowhere: model: there is nothing", "hint:"]);
    refused(&render(&dir, &["--adapter", "no such adapter"]), &["no graphics adapter is named like"]);
    refused(&render(&dir, &["--background", "2,0,0"]), &["three numbers from 0 to 1"]);
    refused(&dir.run(&["render-splats"]), &["<SCENE>"]);
    refused(&dir.run(&["render-splats", "unknown", "--profile", "tiny"]), &["scene.json: cannot open"]);

    let mut moving = cameras()[0].clone();
    moving.world_from_camera = vec![moving.world_from_camera[0]; 97];
    let mut blind = moving.clone();
    blind.fx = 0.0;
    for (name, camera) in [("moving.json", &moving), ("blind.json", &blind)] {
        dir.write(name, json!({ "width": 128, "height": 96, "cameras": [camera] }).to_string());
    }
    refused(&render(&dir, &["--cameras", "blind.json"]), &["camera cam00: field `fx` is 0", "hint: mend"]);
    let run = render(&dir, &["--cameras", "moving.json", "--times", "0.5"]);
    refused(&run, &["camera cam00 moves", "hint: choose --frames"]);
    dir.write("torn.json", "{\"width\": 128");
    refused(&render(&dir, &["--cameras", "torn.json"]), &["torn.json"]);
    assert!(!dir.path(CLIPS).exists());
    assert_eq!(render(&dir, &["--cameras", "moving.json", "--frames", "12,24"]).code, 0);
}

#[test]
fn a_preview_is_a_video_where_ffmpeg_is_and_an_animated_png_elsewhere() {
    let dir = folder();
    std::fs::create_dir(dir.path("bin")).unwrap();
    let preview = || -> Run {
        let mut command = Command::new(env!("CARGO_BIN_EXE_l4d"));
        command.current_dir(dir.path("")).env("PATH", dir.path("bin"));
        let choice = ["--views", "cam00,cam01,cam02", "--frames", "0,48,96", "--preview"];
        command.args([&["render-splats", "room", "--profile", "tiny"], &choice[..]].concat());
        command.output().unwrap().into()
    };
    let run = preview();
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("ffmpeg is not on the PATH"), "{}", run.stderr);
    let animation = bytes(&dir, &format!("{CLIPS}/preview.png"));
    assert!(animation.windows(4).any(|tag| tag == b"acTL"), "no animation");

    // Takes the place of ffmpeg: keeps its arguments and its input.
    let script = "#!/bin/sh\nfor last; do :; done\necho \"$@\" > arguments\n/bin/cat > \"$last\"\n";
    dir.write("bin/ffmpeg", script);
    executable(&dir.path("bin/ffmpeg"));
    let run = preview();
    assert!(run.stdout.contains("preview.mp4"), "{}{}", run.stdout, run.stderr);
    let arguments = dir.read("arguments");
    let size = arguments.split("-s ").nth(1).unwrap().split(' ').next().unwrap();
    let (width, height) = size.split_once('x').unwrap();
    let pixels = width.parse::<usize>().unwrap() * height.parse::<usize>().unwrap();
    assert_eq!(bytes(&dir, &format!("{CLIPS}/preview.mp4")).len(), 3 * 3 * pixels, "three pages of {size}");
    assert!(arguments.contains("-r 1.000"), "two steps of two seconds each: {arguments}");

    dir.write("bin/ffmpeg", "#!/bin/sh\necho 'no such codec' >&2\nexit 1\n");
    let run = preview();
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("warning: ffmpeg failed (no such codec)"), "{}", run.stderr);
}

fn executable(path: &Path) {
    use std::os::unix::fs::PermissionsExt as _;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// Rows of the table, without what the clock says.
fn rows(dir: &Dir, out: &str) -> Vec<BTreeMap<String, String>> {
    let table = dir.read(&format!("{out}/splats.csv"));
    let mut lines = table.lines().map(csv_fields);
    let head = lines.next().unwrap();
    let timed = head.iter().filter(|name| name.ends_with("_ms")).count();
    assert_eq!(timed, 3, "{head:?}");
    let row = |fields: Vec<String>| {
        let row: BTreeMap<String, String> = head.iter().cloned().zip(fields).collect();
        assert!(row["picture_ms"].parse::<f64>().unwrap() > 0.0);
        row.into_iter().filter(|(name, _)| !name.ends_with("_ms")).collect()
    };
    lines.map(row).collect()
}

/// Fields of a line in which commas may be between quotes.
fn csv_fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut is_quoted = false;
    for letter in line.chars() {
        match letter {
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => fields.push(String::new()),
            letter => fields.last_mut().unwrap().push(letter),
        }
    }
    fields
}

fn number(row: &BTreeMap<String, String>, field: &str) -> f64 {
    row[field].parse().unwrap_or_else(|_| panic!("{field} is `{}`", row[field]))
}

const QUICK: [&str; 10] =
    ["--gaussians", "300", "--size", "48x36", "--views", "2", "--times", "2", "--repeats", "1"];

#[test]
fn the_bench_of_a_made_up_room_says_the_same_twice_but_for_times() {
    let dir = Dir::new();
    let bench = |out: &str| dir.succeed(&[&["bench", "splats", "--out", out], &QUICK[..]].concat());
    bench("a");
    bench("b");
    let table = rows(&dir, "a");
    assert_eq!(table, rows(&dir, "b"));
    for file in ["splats.svg", "splats.png"] {
        assert!(bytes(&dir, &format!("a/{file}")).len() > 5000, "{file}");
    }
    let of = |sweep: &str| table.iter().filter(|row| row["sweep"] == sweep).collect::<Vec<_>>();

    // The fast path is close to the reference in f64; every reduction of a kind costs more than the one before.
    assert!(
        number(&table[0], "error_max") < 0.02 && number(&table[0], "error_mean") < 1e-5,
        "{:?}",
        table[0]
    );
    for sweep in ["fewer Gaussians", "smaller pictures"] {
        let errors: Vec<f64> = of(sweep).iter().map(|row| number(row, "error_mean")).collect();
        assert!(errors.len() > 2 && errors.is_sorted(), "{sweep}: {errors:?}");
        assert!(errors[errors.len() - 1] > number(&table[0], "error_mean"), "{sweep}");
    }
    let counts: Vec<f64> = of("fewer Gaussians").iter().map(|row| number(row, "gaussians")).collect();
    assert_eq!(counts, [270.0, 225.0, 180.0, 135.0, 90.0, 45.0]);
    let sizes: Vec<f64> = of("fewer Gaussians").iter().map(|row| number(row, "megabytes")).collect();
    assert!(sizes.windows(2).all(|pair| pair[1] < pair[0]), "{sizes:?}");
    // Other instructions round differently; one thread does not.
    let machines = of("other machinery");
    assert_eq!(machines[1]["error_mean"], table[0]["error_mean"], "one thread");
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
    let arguments = ["--profile", "tiny", "--times", "2", "--repeats", "1", "--sweeps", "resolution"];
    let run = dir.json(&[&["bench", "splats", "room"], &arguments[..]].concat());
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

    std::fs::remove_file(dir.path("data/tiny/room/frames/cam08/0096.exr")).unwrap();
    refused(&dir.run(&[&["bench", "splats", "room"], &arguments[..]].concat()), &["0096.exr: cannot open"]);
    refused(&dir.run(&["bench", "splats", "--model", "x"]), &["<SCENE>"]);
}
