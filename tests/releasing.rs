//! Releases: self-contained folders, the same bytes every time, honest about votes and versions.

mod downloading;
mod metadata;
mod private;

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use half::f16;
use l4d_data::composition::Composition;
use l4d_data::digest::sha256_file;
use l4d_data::layout::SceneDir;
use l4d_data::query::text_digest;
use l4d_data::{Benchmark, Camera, Name, Profile, Scale, json, sums};
use l4d_frames::{Frame, Surfaces};
use serde_json::{Value, json};

use crate::annotation::{bench, opened, panel_votes};
use crate::support::{Dir, Run, codes};

pub(crate) const MAKE: &str = "release --date 2026-11-22 --url https://example.org/two";
const RELEASE: &str = "release/two-0.1.0";
const QUERIES: &str = "benchmark/queries/tabletop_mouse_cups.jsonl";

fn release(dir: &Dir, more: &str) -> Run {
    dir.run(format!("{MAKE} {more}"))
}

fn released(dir: &Dir, more: &str) -> Run {
    dir.succeed(format!("{MAKE} {more}"))
}

/// Demands findings with these codes and paths.
fn expect(run: &Run, found: &[(&str, &str)]) {
    let document = run.value();
    let findings = document["findings"].as_array().unwrap().iter();
    let pairs = findings.map(|one| (one["code"].as_str().unwrap(), one["path"].as_str().unwrap()));
    assert_eq!(pairs.collect::<Vec<_>>(), found, "{run}");
    assert_eq!(run.code, i32::from(!found.is_empty()), "{run}");
}

fn check(dir: &Dir) -> Run {
    dir.run(format!("release --check {RELEASE} --json"))
}

/// Writes what `build-scenes` leaves of the scenes at `tiny`, with pictures of slopes and stripes.
fn write_renders(dir: &Dir) {
    let bench = Benchmark::open(dir.path("benchmark")).unwrap();
    let data = dir.path("data/tiny");
    for name in &bench.manifest.scenes {
        let tracks = bench.tracks(name).unwrap();
        let scene_dir = SceneDir::new(&data, name);
        let scene = tracks.scene(Profile::Tiny, l4d_testing::generator());
        l4d_testing::write_scene(&data, scene, |camera, frame| Some(picture(camera, frame)));
        json::write_compact(&scene_dir.tracks(), &tracks).unwrap();
        std::fs::write(scene_dir.usd(), "usd").unwrap();
        let mut listed = sums::read(&scene_dir.checksums()).unwrap();
        for file in ["scene.usdc", "tracks.json"] {
            listed.insert(file.to_owned(), sha256_file(&scene_dir.root().join(file)).unwrap());
        }
        std::fs::write(scene_dir.checksums(), sums::to_text(&listed)).unwrap();
    }
}

/// Depths of many sizes, landmarks and objects, light of all strengths, some sky.
fn picture(camera: &Camera, frame: u32) -> Frame {
    let mut surfaces = Surfaces::empty(128, 96);
    let mut rgb = Vec::new();
    let shift = camera.name.bytes().map(u32::from).sum::<u32>() + frame;
    for (pixel, number) in (0_u32..).take(surfaces.id.len()).enumerate() {
        let (column, row) = (number % 128, number / 128);
        if row > 8 {
            surfaces.depth_m[pixel] = 40.0 / (row + shift % 7) as f32 + 0.003 * column as f32;
            surfaces.id[pixel] = [0, 1, 2, 1001][((column + shift) / 16 % 4) as usize];
        }
        let light = |by: u32| f16::from_f32((column * by + row + shift) as f32 / 300.0);
        rgb.push([light(1), light(2), f16::from_f32(0.002 * (row % 7) as f32)]);
    }
    Frame { surfaces, rgb }
}

/// A benchmark with its renders.
pub(crate) fn rendered() -> Dir {
    let dir = bench();
    write_renders(&dir);
    dir
}

/// A benchmark that was released with its renders, and a model of one scene.
pub(crate) fn published() -> Dir {
    let dir = rendered();
    for (file, content) in [("manifest.json", "{}"), ("splats-1.safetensors", "numbers")] {
        dir.write(&format!("work/tiny/room_living_cats/splats/{file}"), content);
    }
    released(&dir, "--profile tiny").says(0, &["renders of profile tiny, 1 trained model"]);
    dir
}

/// Unpacks all archives of a release into the folder `elsewhere`, by the tool that every system has.
fn unpack(dir: &Dir) {
    unpack_below(dir, RELEASE);
}

fn unpack_below(dir: &Dir, release: &str) {
    std::fs::create_dir_all(dir.path("elsewhere")).unwrap();
    for name in dir.tree(release).keys().filter(|name| name.ends_with(".tar")) {
        let mut tar = Command::new("tar");
        tar.arg("-xf").arg(dir.path(release).join(name)).current_dir(dir.path("elsewhere"));
        assert!(tar.status().unwrap().success(), "{name}");
    }
}

#[test]
fn a_release_is_self_contained() {
    let dir = rendered();
    let run = released(&dir, "--profile tiny");
    assert_eq!(run.stdout.trim(), RELEASE);
    run.says(0, &["0 of", "verified by people"]);
    let mut sums = Command::new("sha256sum");
    sums.args(["--check", "--quiet", "SHA256SUMS"]).current_dir(dir.path(RELEASE));
    assert!(sums.status().unwrap().success());
    expect(&check(&dir), &[]);

    // What comes out of the archives is what went in, and the verbs work on it.
    unpack(&dir);
    assert_eq!(dir.tree("elsewhere/benchmark"), dir.tree("benchmark"));
    let others = |name: &str| !name.ends_with(".exr") && !name.ends_with("SHA256SUMS");
    let built: BTreeMap<String, Vec<u8>> =
        dir.tree("data").into_iter().filter(|(name, _)| others(name)).collect();
    let unpacked: BTreeMap<String, Vec<u8>> = dir.tree("elsewhere/data");
    assert_eq!(unpacked, built);
    // Samples are what WebDataset makes of names: the key up to the first dot, then the member.
    let pictures = dir.tree("elsewhere/room_living_cats");
    let members: BTreeSet<&str> = pictures.keys().map(|name| name.split_once('.').unwrap().1).collect();
    assert_eq!(members, BTreeSet::from(["depth.png", "depth_rest.png", "ids.png", "json", "png"]));
    let keys: BTreeSet<&str> = pictures.keys().map(|name| name.split_once('.').unwrap().0).collect();
    assert_eq!(keys.len(), 5 * 9);
    let card = dir.value("elsewhere/room_living_cats/cam00/0048.json");
    assert_eq!((&card["schema"], &card["seconds"]), (&json!("l4d/sample/1"), &json!(2.0)));
    let checked = dir.json("check-queries --bench elsewhere/benchmark --profile tiny");
    assert_eq!(checked["scenes"], 2);
}

#[test]
fn tables_say_what_the_files_say() {
    let dir = bench();
    released(&dir, "");
    let rows = |table: &str| dir.lines(&format!("{RELEASE}/tables/{table}.jsonl"));
    let bench = Benchmark::open(dir.path("benchmark")).unwrap();
    let scenes = &bench.manifest.scenes;
    let queries: Vec<_> = scenes.iter().flat_map(|scene| bench.queries(scene).unwrap()).collect();
    let table = rows("queries");
    assert_eq!(table.len(), queries.len());
    for (row, query) in table.iter().zip(&queries) {
        assert_eq!([&row["id"], &row["text"]], [&query.id.to_string(), &query.text]);
        assert_eq!(row["frames"], serde_json::to_value(&query.frames).unwrap());
        let predicate: Value = serde_json::from_str(row["predicate"].as_str().unwrap()).unwrap();
        assert_eq!(Some(predicate), query.predicate);
    }
    let truths = scenes.iter().map(|scene| bench.truth(Profile::Tiny, scene).unwrap());
    let masks: usize = truths.flat_map(|truth| truth.instances).map(|instance| instance.masks.len()).sum();
    assert_eq!(rows("truth_tiny").len(), masks);
    assert_eq!(rows("scenes")[0]["scene"], "room_living_cats");
    assert!(rows("events").len() > 2 && rows("instances").len() > 8);
}

#[test]
fn the_same_bytes_every_time_and_whatever_a_killed_run_left() {
    let dir = rendered();
    released(&dir, "--profile tiny");
    let whole = dir.tree(RELEASE);
    released(&dir, "--profile tiny").says(0, &["nothing was written"]);

    // Torn by hand: some archives, half a file, metadata of a run that nearly ended.
    let torn = "torn/.two-0.1.0.partial";
    for (name, bytes) in whole.iter().filter(|(name, _)| !name.contains("mouse_cups")) {
        dir.write(&format!("{torn}/{name}"), bytes);
    }
    dir.write(&format!("{torn}/archives/scenes/.l4d-1-0.tmp"), "half");
    // Left by a run on other files: nothing of it may get in.
    let stale = "stale/.two-0.1.0.partial";
    dir.write(&format!("{stale}/archives/scenes/tabletop_mouse_cups.tar"), "other");
    dir.write(&format!("{stale}/release.json"), "{}");
    for out in ["torn", "stale"] {
        released(&dir, &format!("--profile tiny --out {out}"));
        assert_eq!(dir.tree(&format!("{out}/two-0.1.0")), whole);
    }
}

#[test]
fn what_was_published_stays() {
    let dir = bench();
    released(&dir, "");
    let before = dir.tree(RELEASE);
    edit_text(&dir);
    let run = release(&dir, "--json");
    expect(&run, &[("L4D605", RELEASE)]);
    run.says(1, &["asks something else"]);
    assert_eq!(dir.tree(RELEASE), before);
}

/// Rewords the first query of a scene.
fn edit_text(dir: &Dir) {
    let mut queries = dir.lines(QUERIES);
    queries[0]["text"] = "The mug in other words".into();
    queries[0]["text_digest"] = text_digest("The mug in other words", queries[0].get("predicate")).into();
    json::write_lines(&dir.path(QUERIES), &queries).unwrap();
}

#[test]
fn a_version_says_what_changed() {
    let dir = bench();
    released(&dir, "");
    let since = format!("--since {RELEASE}");
    let raise = |version: &str| {
        let manifest = dir.read("benchmark/panoptic-l4d.toml");
        let line = manifest.lines().find(|line| line.starts_with("version")).unwrap().to_owned();
        dir.edit("benchmark/panoptic-l4d.toml", &line, &format!("version = \"{version}\""));
    };
    let refused = |hint: &str| release(&dir, &since).says(1, &["error[L4D603]", hint]);
    // Other bytes, the same words.
    dir.write(QUERIES, dir.read(QUERIES).replace("\"candidate\"}", "\"candidate\" }"));
    raise("0.1.0-rc.1");
    refused("write 0.1.1 or higher");
    raise("0.1.1");
    released(&dir, &since).says(0, &["patch: files were written anew"]);

    edit_text(&dir);
    raise("0.9.0");
    refused("write 1.0.0 or higher");
    raise("1.0.0");
    assert_eq!(dir.json(format!("{MAKE} {since}"))["changes"][0]["step"], "major");

    raise("one");
    refused("major.minor.patch");
    // A release that somebody edited is no ground to compare with.
    raise("2.0.0");
    dir.edit(&format!("{RELEASE}/release.json"), "candidate", "verified");
    release(&dir, &since).refused(&["SHA256SUMS"]);
}

#[test]
fn only_votes_of_people_make_a_query_verified() {
    let dir = bench();
    dir.edit(QUERIES, "\"candidate\"", "\"verified\"");
    expect(&release(&dir, "--json"), &[("L4D602", QUERIES)]);
    assert!(!dir.path("release").exists(), "nothing may be written");
    dir.edit(QUERIES, "\"verified\"", "\"candidate\"");

    // Programs verify nothing, however well they vote.
    opened(&dir, "robots", "--simulated");
    panel_votes(&dir, "robots", "", &BTreeMap::new());
    dir.succeed("verdict robots");
    released(&dir, "");
    assert!(!dir.path(format!("{RELEASE}/archives/annotation.tar")).exists());
    let sheet = dir.read(&format!("{RELEASE}/DATASHEET.md"));
    assert!(sheet.contains("0 are verified by people") && sheet.contains("No one was recorded"), "{sheet}");

    // People do, once they have sealed and the verdict is pronounced.
    dir.remove("release");
    opened(&dir, "people", "");
    panel_votes(&dir, "people", "", &BTreeMap::new());
    release(&dir, "").says(1, &["by the votes of people it is verified"]);
    dir.succeed("verdict people");
    released(&dir, "").says(0, &["scored queries are verified by people, 0 were rejected"]);
    let rounds = dir.value(&format!("{RELEASE}/release.json"))["rounds"].clone();
    assert_eq!([&rounds[0]["rule"], &rounds[0]["annotators"]], [&json!("unanimous:5"), &json!(5)]);
    assert_eq!(rounds.as_array().unwrap().len(), 1, "the robots' round is no round of people");
    unpack(&dir);
    let votes = "annotation/rounds/people/votes/ada.jsonl";
    assert_eq!(dir.read(&format!("elsewhere/{votes}")), dir.read(votes));
    // Who unpacks it can count again.
    let at = "--bench elsewhere/benchmark --rounds elsewhere/annotation/rounds";
    dir.succeed(format!("verdict people --check {at}"));
}

#[test]
fn renders_are_complete_or_refused() {
    let dir = bench();
    let refused = |more: &str, code: i32, words: &[&str]| {
        release(&dir, &format!("--profile tiny {more}")).says(code, words);
        assert!(!dir.path(RELEASE).exists());
    };
    let missing = ["L4D604", "room_living_cats/scene.json", "tabletop_mouse_cups/scene.json", "build-scenes"];
    refused("", 1, &missing);
    write_renders(&dir);
    refused("--data elsewhere", 1, &["L4D604", "elsewhere/room_living_cats"]);
    let frames = "data/tiny/room_living_cats/frames";
    let name = dir.tree(frames).into_keys().find(|name| name.ends_with(".exr")).unwrap();
    let frame = format!("{frames}/{name}");
    let bytes = dir.bytes(&frame);
    dir.remove(&frame);
    refused("", 1, &["lacks 1 of 48 files", &name]);
    dir.write(&frame, bytes.to_ascii_uppercase());
    refused("", 2, &[&name, "are not those of its digest", "hint:"]);
    dir.write(&frame, &bytes);
    dir.edit("benchmark/panoptic-l4d.toml", "scenes", "variant = 3\nscenes");
    refused("--data data/tiny", 1, &["wanted is profile tiny, variant 3"]);
    dir.edit("benchmark/panoptic-l4d.toml", "variant = 3\n", "");
    released(&dir, "--profile tiny");
    assert!(dir.path(format!("{RELEASE}/archives/renders/tiny/room_living_cats.tar")).exists());
}

#[test]
fn renders_of_composed_scenes_have_the_seeds_of_their_compositions() {
    let dir = bench();
    let name: Name = "tabletop_mouse_cups".parse().unwrap();
    dir.edit("benchmark/scenes/tabletop_mouse_cups.json", "\"seed\":0", "\"seed\":7");
    write_renders(&dir);
    release(&dir, "--profile tiny").says(1, &["L4D604", "wanted is profile tiny, variant 0, seed 0"]);
    let composition = Composition::of(name, Scale::Tabletop, 7);
    json::write(&dir.path("benchmark/recipes/tabletop_mouse_cups.json"), &composition).unwrap();
    released(&dir, "--profile tiny");
}

#[test]
fn a_check_finds_everything_at_once() {
    let dir = bench();
    released(&dir, "");
    let path = |name: &str| format!("{RELEASE}/{name}");
    dir.remove(&path("DATASHEET.md"));
    dir.write(&path("archives/more.tar"), "x");
    dir.edit(&path("tables/queries.jsonl"), "candidate", "verified");
    std::os::unix::fs::symlink("/etc/passwd", dir.path(path("tables/more.jsonl"))).unwrap();
    let found = [
        ("L4D612", path("DATASHEET.md")),
        ("L4D613", path("archives/more.tar")),
        ("L4D613", path("tables/more.jsonl")),
        ("L4D614", path("tables/queries.jsonl")),
    ];
    expect(&check(&dir), &found.each_ref().map(|(code, path)| (*code, path.as_str())));

    dir.write(&path("SHA256SUMS"), "../../etc/passwd\n");
    expect(&check(&dir), &[("L4D611", &path("SHA256SUMS"))]);
    dir.refuses("release --check nowhere", &[]);
}

#[test]
fn a_benchmark_with_holes_is_refused_with_all_of_them() {
    let dir = bench();
    dir.remove("benchmark/truth/tiny/room_living_cats.json");
    dir.write(QUERIES, "{}\n");
    let run = release(&dir, "--json");
    assert_eq!((run.code, codes(&run.value())), (1, vec!["L4D601", "L4D601"]), "{run}");
    for wrong in ["--date 22.11.2026", "--date 2026-11-22", "--date 2026-11-22 --url here"] {
        assert_eq!(dir.run(format!("release {wrong}")).code, 2, "{wrong}");
    }
}
