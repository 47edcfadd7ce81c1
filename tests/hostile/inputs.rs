//! Models, benchmarks and settings that somebody sends to do harm: each is refused with its file and a hint.

use std::fs::File;
use std::os::unix::fs::symlink;

use l4d_data::{Split, json};
use l4d_splat::checkpoint::{own, ply};
use l4d_splat::gaussians::Gaussians;
use l4d_splat::synthetic::Room;
use l4d_testing::{camera, scene};
use serde_json::{Value, json};

use super::{bounded, pipe};
use crate::support::{Dir, Run};

const SCENE: &str = "tabletop_mouse_cups";
const TRACKS: &str = "benchmark/scenes/tabletop_mouse_cups.json";
const TRUTH: &str = "benchmark/truth/tiny/tabletop_mouse_cups.json";
const QUERIES: &str = "benchmark/queries/tabletop_mouse_cups.jsonl";
/// Letters that turn the direction of the text around them.
const TURNED: &str = "\u{202e}txet\u{2066}";

fn sparse(dir: &Dir, relative: &str) {
    File::options().write(true).open(dir.path(relative)).unwrap().set_len(6 << 30).unwrap();
}

/// A folder with cameras, in which a model is drawn.
fn with_cameras() -> Dir {
    let dir = Dir::new();
    json::write(&dir.path("cameras.json"), &scene("room", vec![camera("cam", Split::Test)], Vec::new()))
        .unwrap();
    dir
}

fn draw(dir: &Dir, model: &str) -> Run {
    bounded(dir, &format!("render-splats --splats {model} --cameras cameras.json --times 0 --out clips"))
}

/// Some Gaussians of a room.
fn gaussians() -> Gaussians {
    Room { gaussians: 10, ..Room::small(3) }.model().unwrap().gaussians
}

/// A model as 4DGaussians leaves it, as far as this goes.
fn foreign(dir: &Dir, options: &str) {
    dir.write("theirs/cfg_args", options);
    ply::write(&dir.path("theirs/point_cloud/iteration_7000/point_cloud.ply"), &gaussians()).unwrap();
    dir.write("theirs/point_cloud/iteration_7000/deformation.pth", "");
}

#[test]
fn models_of_six_gigabytes() {
    let dir = with_cameras();
    dir.write("model.ply", "");
    sparse(&dir, "model.ply");
    draw(&dir, "model.ply").refused(&["model.ply", "end_header"]);
    // Gaussians of 56 bytes each, all zero.
    let names = "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    let columns: String = names.split(' ').map(|name| format!("property float {name}\n")).collect();
    let header = |format: &str, count: u64| {
        format!("ply\nformat {format} 1.0\nelement vertex {count}\n{columns}end_header\n")
    };
    let start = |count| header("binary_little_endian", count);
    let mut head = start(115_000_000);
    let count = ((6_u64 << 30) - head.len() as u64) / 56;
    head = start(count);
    dir.write("model.ply", &head);
    let length = head.len() as u64 + 56 * count;
    File::options().write(true).open(dir.path("model.ply")).unwrap().set_len(length).unwrap();
    draw(&dir, "model.ply").refused(&["model.ply", "Gaussians do not fit into memory"]);
    dir.write("model.ply", header("ascii", 1));
    sparse(&dir, "model.ply");
    draw(&dir, "model.ply").refused(&["model.ply", "longer than"]);

    foreign(&dir, "Namespace(sh_degree=3)");
    let weights = "theirs/point_cloud/iteration_7000/deformation.pth";
    sparse(&dir, weights);
    draw(&dir, "theirs").refused(&["deformation.pth", "is no whole zip"]);
    dir.write(weights, "PK\u{3}\u{4}");
    sparse(&dir, weights);
    draw(&dir, "theirs").refused(&["deformation.pth", "memory"]);

    Room { gaussians: 10, ..Room::small(3) }.model().unwrap().write(&dir.path("ours")).unwrap();
    let tensors = dir.value("ours/checkpoint.json")["tensors"]["file"].as_str().unwrap().to_owned();
    sparse(&dir, &format!("ours/{tensors}"));
    draw(&dir, "ours").refused(&[&tensors, own::CARD]);
}

/// A benchmark of one shipped scene.
fn one_scene() -> Dir {
    Dir::with_shipped("One", &[SCENE], &["scenes/{}.json", "queries/{}.jsonl", "truth/tiny/{}.json"])
}

#[test]
fn nothing_is_proved_on_tracks_and_truth_that_cannot_be() {
    let sound = one_scene();
    let check = |dir: &Dir| dir.json("check-queries --profile tiny");
    assert_eq!(
        check(&sound)["findings"].as_array().unwrap().iter().find(|one| one["code"] == "L4D201"),
        None
    );
    let long = "x".repeat(200_000);
    let nines = json!([[9, 9, 9, 9, 9, 9, 9, 9, 9]]);
    let list = json!([1, 2, 3]);
    let cases: [(&str, &str, Value, &str); 17] = [
        (TRACKS, "/instances/0/track/axes", nines, "rotation"),
        (TRACKS, "/instances/0/track/extents", json!([[1e300, -5, 0]]), "extents"),
        (TRACKS, "/instances/0/track/centre", json!([[1e300, 0, 0]]), "centre"),
        (TRACKS, "/instances/0/category", json!(long), "category"),
        (TRACKS, "/instances/0/front", json!("forward"), "front"),
        (TRACKS, "/events/0/verb", json!(long), "verb"),
        (TRACKS, "/description", json!(long), "description"),
        (TRACKS, "/fps", json!(0), "fps"),
        (TRACKS, "/exposure", json!(-1), "exposure"),
        (TRACKS, "/pair_reach_m", json!(-1), "pair_reach_m"),
        (TRACKS, "/cameras/0/world_from_camera", json!([vec![0; 16]]), "rigid"),
        (TRACKS, "/cameras/0/focal_over_width", json!(0), "focal length"),
        (TRUTH, "/test_view", json!("cam99"), "test_view"),
        (TRUTH, "/instances/0/masks", json!({ "../../etc/passwd": "0" }), "frame"),
        (TRUTH, "/instances/0/id", json!(1000), "id 1000"),
        (TRUTH, "/visible/cam00", json!({ "ghost": list }), "no instance"),
        (TRUTH, "/visible/cam00/FIRST", list.clone(), "3 counts"),
    ];
    for (file, place, value, said) in cases {
        let dir = sound.copy();
        dir.change(file, |document| {
            let first = document["instances"][0]["name"].as_str().unwrap_or_default().to_owned();
            let place = place.replace("FIRST", &first);
            *document.pointer_mut(&place).unwrap_or_else(|| panic!("no {place}")) = value;
        });
        let found = check(&dir);
        let all = found["findings"].as_array().unwrap();
        let is_it = |one: &&Value| one["code"] == "L4D201" && one.to_string().contains(said);
        let one = all.iter().find(is_it).unwrap_or_else(|| panic!("{place}: {found:#}"));
        assert!(one["path"].as_str().unwrap().ends_with(file), "{one}");
        assert!(one.to_string().len() < 2000, "{place}: a long finding");
    }
    // A truth of another scene than the tracks.
    let dir = sound.copy();
    dir.change(TRUTH, |truth| truth["test_view"] = "cam00".into());
    assert!(check(&dir).to_string().contains("the tracks hold out"));
    for (field, value, said) in [
        ("/provenance/source", json!("elvis"), "elvis"),
        ("/provenance/note", json!(long), "provenance.note"),
        ("/text", json!(long), "text"),
        ("/predicate", json!({ "category": long }), "predicate"),
    ] {
        let dir = sound.copy();
        let mut lines = dir.lines(QUERIES);
        *match field {
            "/provenance/note" => &mut lines[0]["provenance"]["note"],
            field => lines[0].pointer_mut(field).unwrap(),
        } = value;
        dir.write(QUERIES, lines.iter().map(|line| format!("{line}\n")).collect::<String>());
        let found = check(&dir).to_string();
        assert!(found.contains("L4D201") && found.contains(said) && found.len() < 10_000, "{field}");
    }
}

#[test]
fn truth_that_is_a_pipe_or_a_device() {
    let truth = "benchmark/truth/tiny/room_discs.json";
    for device in [None, Some("/dev/zero")] {
        let dir = Dir::with_oracle();
        dir.remove(truth);
        match device {
            None => pipe(&dir.path(truth)),
            Some(device) => symlink(device, dir.path(truth)).unwrap(),
        }
        bounded(&dir, "score").refused(&["room_discs.json", "is not a regular file"]);
    }
}

#[test]
fn files_behind_links_are_not_quoted() {
    let dir = with_cameras();
    dir.write("secret", "root:x:0:0:canary:/root\ncanary = [\n");
    foreign(&dir, "");
    for (link, line) in [
        ("theirs/cfg_args", "render-splats --splats theirs --cameras cameras.json --out clips"),
        ("benchmark/panoptic-l4d.toml", "check-queries"),
        ("annotation/rounds/one/round.toml", "verdict one"),
        ("noise.toml", "solve --grounder oracle --noise noise.toml"),
        ("preset.toml", "import preset.toml ."),
    ] {
        let dir = dir.copy();
        if dir.path(link).exists() {
            dir.remove(link);
        }
        dir.write(&format!("{link}.there"), "");
        symlink(dir.path("secret"), dir.path(link)).unwrap();
        let run = dir.run(line);
        run.refused(&[]);
        assert!(!run.to_string().contains("canary"), "{line}: {run}");
    }
}

#[test]
fn text_that_turns_its_direction() {
    let dir = one_scene();
    let name = format!("{TURNED}.json");
    dir.write(&name, "{}");
    dir.edit(TRACKS, "\"fps\"", &format!("\"{TURNED}\""));
    dir.edit("benchmark/panoptic-l4d.toml", "name =", &format!("\"{TURNED}\" = 1\nname ="));
    for line in [
        "check-queries --profile tiny".to_owned(),
        format!("render-splats --splats {name} --cameras {name} --out clips"),
        format!("score --profile tiny --bench {TURNED}"),
        "check-queries --profile tiny --bench fixed".to_owned(),
    ] {
        if line.ends_with("fixed") {
            dir.rename("benchmark", "fixed");
            dir.edit("fixed/panoptic-l4d.toml", &format!("\"{TURNED}\" = 1\n"), "");
        }
        let run = dir.run(&line);
        assert!(run.code > 0 && run.to_string().contains('\u{fffd}'), "{line}: {run}");
        assert!(!run.to_string().contains(['\u{202e}', '\u{2066}']), "{line}: {run}");
    }
}

#[test]
fn every_refusal_names_a_file_and_a_hint() {
    let dir = with_cameras();
    ply::write(&dir.path("good.ply"), &gaussians()).unwrap();
    for (text, said) in [
        ("[1]", "top level"),
        ("{\"width\": 128, \"height\": 96, \"cameras\": []}", "field `cameras`"),
        ("{\"width\": 128, \"height\": 96, \"cameras\": [{\"name\": \"a\"}]}", "cameras[0]"),
        ("{\"width\": 0, \"height\": 96, \"cameras\": [1]}", "cameras[0]"),
    ] {
        dir.write("bad.json", text);
        let line = "render-splats --splats good.ply --cameras bad.json --times 0 --out clips";
        dir.refuses(line, &["bad.json", said]);
    }
    dir.change("cameras.json", |cameras| cameras["width"] = 0.into());
    draw(&dir, "good.ply").refused(&["camera"]);

    symlink("loop", dir.path("loop")).unwrap();
    let long = "x".repeat(300);
    for bench in ["loop", &long, "good.ply"] {
        dir.refuses(format!("check-queries --bench {bench}"), &[bench]);
    }
    dir.refuses("render-splats --splats loop --cameras cameras.json --out clips", &["loop"]);

    dir.write("capture/cam00/images/0000.png", "");
    dir.refuses("import-scene neu3d capture --name a", &["poses_bounds.npy"]);

    let empty = one_scene();
    empty.write(QUERIES, "");
    empty.write("results/mine/method.json", "{}");
    let run = empty.run("score --profile tiny");
    run.refused(&["no query is left to score", "write queries"]);
    assert!(!run.stderr.contains("--verified-only"), "{run}");
}

#[test]
fn a_capture_without_frames() {
    let dir = Dir::new();
    let cameras = scene("a", vec![camera("cam", Split::Train)], Vec::new()).cameras;
    let capture = json!({
        "schema": "l4d/capture/1", "name": "a", "source": "made up", "width": 128, "height": 96,
        "cameras": cameras, "frames": [], "frames_per_second": null, "depth": "absent", "is_metric": false,
        "unseen": {}, "substituted": [], "inputs": {}, "notes": [],
    });
    dir.write("data/captures/a/capture.json", capture.to_string());
    dir.refuses("train-splats a --profile real", &["capture.json"]);
}
