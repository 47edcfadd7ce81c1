//! Releases: self-contained folders, the same bytes every time, honest about votes and versions.

mod metadata;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use l4d_data::digest::sha256_file;
use l4d_data::layout::SceneDir;
use l4d_data::query::text_digest;
use l4d_data::truth::frame_key;
use l4d_data::{Benchmark, Profile, json, sums};
use serde_json::{Value, json};

use crate::annotation::{bench, opened, panel_votes};
use crate::support::{Dir, Run};

const ARGUMENTS: [&str; 5] = ["release", "--date", "2026-11-22", "--url", "https://example.org/two"];
const RELEASE: &str = "release/two-0.1.0";
const QUERIES: &str = "benchmark/queries/tabletop_mouse_cups.jsonl";

fn release(dir: &Dir, more: &[&str]) -> Run {
    dir.run(&[&ARGUMENTS, more].concat())
}

fn released(dir: &Dir, more: &[&str]) -> Run {
    dir.succeed(&[&ARGUMENTS, more].concat())
}

fn check(dir: &Dir, folder: &str) -> (i32, Vec<(String, String)>) {
    let run = dir.run(&["release", "--check", folder, "--json"]);
    (run.code, findings(&serde_json::from_str(&run.stdout).unwrap()))
}

/// Code and path of each finding.
fn findings(document: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let all = document["findings"].as_array().unwrap().iter();
    all.map(|finding| (text(&finding["code"]), text(&finding["path"]))).collect()
}

/// Relative path -> bytes of everything below a folder.
fn tree(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
                files.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    files
}

/// Writes what `build-scenes` leaves of the scenes at `tiny`, with other bytes in the place of pictures: a release
/// carries pictures, and looks into none.
fn write_renders(dir: &Dir) {
    let bench = Benchmark::open(dir.path("benchmark")).unwrap();
    for name in &bench.manifest.scenes {
        let tracks = bench.tracks(name).unwrap();
        let scene_dir = SceneDir::new(&dir.path("data/tiny"), name);
        let profile = Profile::Tiny;
        let scene = tracks.scene(profile, l4d_testing::generator());
        let mut listed = BTreeMap::new();
        for camera in &scene.cameras {
            json::write(&scene_dir.view_card(&camera.name), &camera).unwrap();
            for frame in profile.frames() {
                let file = format!("frames/{}/{}.exr", camera.name, frame_key(frame));
                std::fs::write(scene_dir.root().join(&file), format!("{name} {file}")).unwrap();
                listed.insert(file.clone(), sha256_file(&scene_dir.root().join(&file)).unwrap());
            }
        }
        json::write(&scene_dir.scene(), &scene).unwrap();
        json::write_compact(&scene_dir.tracks(), &tracks).unwrap();
        std::fs::write(scene_dir.usd(), "usd").unwrap();
        for file in ["scene.json", "scene.usdc", "tracks.json"] {
            listed.insert(file.to_owned(), sha256_file(&scene_dir.root().join(file)).unwrap());
        }
        std::fs::write(scene_dir.checksums(), sums::to_text(&listed)).unwrap();
    }
}

/// Unpacks all archives of a release into a folder, by the tool that everybody has.
fn unpack(release: &Path, into: &Path) {
    std::fs::create_dir_all(into).unwrap();
    for name in tree(release).keys().filter(|name| name.ends_with(".tar")) {
        let status =
            Command::new("tar").arg("-xf").arg(release.join(name)).current_dir(into).status().unwrap();
        assert!(status.success(), "{name}");
    }
}

#[test]
fn a_release_stands_alone() {
    let dir = bench();
    write_renders(&dir);
    let run = released(&dir, &["--profile", "tiny"]);
    assert_eq!(run.stdout.trim(), RELEASE);
    assert!(run.stderr.contains("0 of") && run.stderr.contains("verified by people"), "{}", run.stderr);
    let mut sums = Command::new("sha256sum");
    sums.args(["--check", "--quiet", "SHA256SUMS"]).current_dir(dir.path(RELEASE));
    assert!(sums.status().unwrap().success());
    assert_eq!(check(&dir, RELEASE), (0, Vec::new()));

    // What comes out of the archives is what went in, and the verbs work on it.
    unpack(&dir.path(RELEASE), &dir.path("elsewhere"));
    for folder in ["benchmark", "data"] {
        assert_eq!(tree(&dir.path(format!("elsewhere/{folder}"))), tree(&dir.path(folder)), "{folder}");
    }
    let checked = dir.json(&["check-queries", "--bench", "elsewhere/benchmark", "--profile", "tiny"]);
    assert_eq!(checked["scenes"], 2);
}

#[test]
fn tables_say_what_the_files_say() {
    let dir = bench();
    released(&dir, &[]);
    let rows = |table: &str| -> Vec<Value> {
        let text = dir.read(&format!("{RELEASE}/tables/{table}.jsonl"));
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let bench = Benchmark::open(dir.path("benchmark")).unwrap();
    let queries: Vec<_> =
        bench.manifest.scenes.iter().flat_map(|scene| bench.queries(scene).unwrap()).collect();
    let table = rows("queries");
    assert_eq!(table.len(), queries.len());
    for (row, query) in table.iter().zip(&queries) {
        assert_eq!(row["id"], query.id.to_string());
        assert_eq!(row["text"], query.text.as_str());
        assert_eq!(row["frames"], serde_json::to_value(&query.frames).unwrap());
        let predicate: Value = serde_json::from_str(row["predicate"].as_str().unwrap()).unwrap();
        assert_eq!(Some(predicate), query.predicate);
    }
    let masks: usize = bench
        .manifest
        .scenes
        .iter()
        .flat_map(|scene| bench.truth(Profile::Tiny, scene).unwrap().instances)
        .map(|instance| instance.masks.len())
        .sum();
    assert_eq!(rows("truth_tiny").len(), masks);
    assert_eq!(rows("scenes")[0]["scene"], "room_living_cats");
    assert!(rows("events").len() > 2 && rows("instances").len() > 8);
}

#[test]
fn the_same_bytes_every_time_and_after_every_kill() {
    let dir = bench();
    write_renders(&dir);
    let more = ["--profile", "tiny"];
    released(&dir, &more);
    let whole = tree(&dir.path(RELEASE));
    let again = released(&dir, &more);
    assert!(again.stderr.contains("nothing was written"), "{}", again.stderr);

    // Torn by hand: some archives, half a file, metadata of a run that nearly ended.
    let torn = dir.path("torn/.two-0.1.0.partial");
    for (name, bytes) in whole.iter().filter(|(name, _)| !name.contains("mouse_cups")) {
        let path = torn.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    std::fs::write(torn.join("archives/scenes/.tabletop_mouse_cups.tar.1.tmp"), "half").unwrap();
    released(&dir, &[&more[..], &["--out", "torn"]].concat());
    assert_eq!(tree(&dir.path("torn/two-0.1.0")), whole);

    // Left by a run on other files: nothing of it may get in.
    let stale = dir.path("stale/.two-0.1.0.partial");
    std::fs::create_dir_all(stale.join("archives/scenes")).unwrap();
    std::fs::write(stale.join("archives/scenes/tabletop_mouse_cups.tar"), "other").unwrap();
    std::fs::write(stale.join("release.json"), "{}").unwrap();
    released(&dir, &[&more[..], &["--out", "stale"]].concat());
    assert_eq!(tree(&dir.path("stale/two-0.1.0")), whole);

    // Killed, later each time, until a run is quick enough.
    let mut kills = 0;
    for attempt in 1.. {
        let mut command = Command::new(env!("CARGO_BIN_EXE_l4d"));
        command.args(ARGUMENTS).args(more).args(["--out", "killed", "--quiet"]).current_dir(dir.path(""));
        let mut child = command.stdout(std::process::Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(attempt * 7));
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success());
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    assert!(kills > 0, "no run was killed");
    assert_eq!(tree(&dir.path("killed/two-0.1.0")), whole, "after {kills} kills");
    let left: Vec<_> = std::fs::read_dir(dir.path("killed")).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

#[test]
fn what_was_published_stays() {
    let dir = bench();
    released(&dir, &[]);
    let before = tree(&dir.path(RELEASE));
    edit_text(&dir);
    let run = release(&dir, &["--json"]);
    assert_eq!(run.code, 1);
    let found = findings(&serde_json::from_str(&run.stdout).unwrap());
    assert_eq!(found, [("L4D605".to_owned(), RELEASE.to_owned())]);
    assert!(run.stdout.contains("asks something else"), "{}", run.stdout);
    assert_eq!(tree(&dir.path(RELEASE)), before);
}

/// Rewords the first query of a scene.
fn edit_text(dir: &Dir) {
    let text = dir.read(QUERIES);
    let (first, rest) = text.split_once('\n').unwrap();
    let mut query: Value = serde_json::from_str(first).unwrap();
    query["text"] = "The mug in other words".into();
    query["text_digest"] = text_digest("The mug in other words", query.get("predicate")).into();
    dir.write(QUERIES, format!("{query}\n{rest}"));
}

#[test]
fn a_version_says_what_changed() {
    let dir = bench();
    released(&dir, &[]);
    let since = ["--since", RELEASE];
    let raise = |version: &str| {
        let manifest = dir.read("benchmark/panoptic-l4d.toml");
        let line = manifest.lines().find(|line| line.starts_with("version")).unwrap().to_owned();
        dir.edit("benchmark/panoptic-l4d.toml", &line, &format!("version = \"{version}\""));
    };
    let refused = |hint: &str| {
        let run = release(&dir, &since);
        assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
        assert!(run.stdout.contains("error[L4D603]") && run.stdout.contains(hint), "{}", run.stdout);
    };
    // Other bytes, the same words.
    let lines = dir.read(QUERIES).replace("\"candidate\"}", "\"candidate\" }");
    dir.write(QUERIES, lines);
    raise("0.1.0-rc.1");
    refused("write 0.1.1 or higher");
    raise("0.1.1");
    let run = released(&dir, &since);
    assert!(run.stderr.contains("patch: files were written anew"), "{}", run.stderr);

    edit_text(&dir);
    raise("0.9.0");
    refused("write 1.0.0 or higher");
    raise("1.0.0");
    let changes = dir.json(&[&ARGUMENTS[..], &since].concat());
    assert_eq!(changes["changes"][0]["step"], "major");

    raise("one");
    refused("major.minor.patch");
    // A release that somebody edited is no ground to compare with.
    raise("2.0.0");
    dir.edit(&format!("{RELEASE}/release.json"), "candidate", "verified");
    let run = release(&dir, &since);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("SHA256SUMS") && run.stderr.contains("hint:"), "{}", run.stderr);
}

#[test]
fn nobody_is_called_a_verifier_who_did_not_vote() {
    let dir = bench();
    dir.edit(QUERIES, "\"candidate\"", "\"verified\"");
    let run = release(&dir, &["--json"]);
    assert_eq!(run.code, 1);
    let found = findings(&serde_json::from_str(&run.stdout).unwrap());
    assert_eq!(found, [("L4D602".to_owned(), QUERIES.to_owned())]);
    assert!(!dir.path("release").exists(), "nothing may be written");
    dir.edit(QUERIES, "\"verified\"", "\"candidate\"");

    // Programs verify nothing, however well they vote.
    opened(&dir, "robots", &["--simulated"]);
    panel_votes(&dir, "robots", "", &BTreeMap::new());
    dir.succeed(&["verdict", "--round", "robots"]);
    released(&dir, &[]);
    assert!(!dir.path(format!("{RELEASE}/archives/annotation.tar")).exists());
    let sheet = dir.read(&format!("{RELEASE}/DATASHEET.md"));
    assert!(sheet.contains("0 are verified by people") && sheet.contains("No one was recorded"), "{sheet}");

    // People do, once they have sealed and the verdict is pronounced.
    std::fs::remove_dir_all(dir.path("release")).unwrap();
    opened(&dir, "people", &[]);
    panel_votes(&dir, "people", "", &BTreeMap::new());
    let run = release(&dir, &[]);
    assert!(run.code == 1 && run.stdout.contains("by the votes of people it is verified"), "{}", run.stdout);
    dir.succeed(&["verdict", "--round", "people"]);
    let run = released(&dir, &[]);
    assert!(run.stderr.contains("scored queries are verified by people, 0 were rejected"), "{}", run.stderr);
    let contents: Value = serde_json::from_str(&dir.read(&format!("{RELEASE}/release.json"))).unwrap();
    assert_eq!(
        (&contents["rounds"][0]["rule"], &contents["rounds"][0]["annotators"]),
        (&json!("unanimous:5"), &json!(5))
    );
    assert_eq!(contents["rounds"].as_array().unwrap().len(), 1, "the robots' round is no round of people");
    unpack(&dir.path(RELEASE), &dir.path("elsewhere"));
    let votes = "annotation/rounds/people/votes/ada.jsonl";
    assert_eq!(dir.read(&format!("elsewhere/{votes}")), dir.read(votes));
    // Who unpacks it can count again.
    let at = ["--bench", "elsewhere/benchmark", "--rounds", "elsewhere/annotation/rounds"];
    dir.succeed(&[&["verdict", "--round", "people", "--check"], &at[..]].concat());
}

#[test]
fn renders_are_complete_or_refused() {
    let dir = bench();
    let refused = |more: &[&str], code: i32, words: &[&str]| {
        let run = release(&dir, &[&["--profile", "tiny"], more].concat());
        assert_eq!(run.code, code, "{}{}", run.stdout, run.stderr);
        for word in words {
            assert!(
                run.stdout.contains(word) || run.stderr.contains(word),
                "{word}\n{}{}",
                run.stdout,
                run.stderr
            );
        }
        assert!(!dir.path(RELEASE).exists());
    };
    refused(
        &[],
        1,
        &["L4D604", "room_living_cats/scene.json", "tabletop_mouse_cups/scene.json", "build-scenes"],
    );
    write_renders(&dir);
    refused(&["--data", "elsewhere"], 1, &["L4D604", "elsewhere/room_living_cats"]);
    let frame = dir.path("data/tiny/room_living_cats/frames").join("cam00/0048.exr");
    let frame = if frame.exists() { frame } else { first_frame(&dir) };
    let bytes = std::fs::read(&frame).unwrap();
    std::fs::remove_file(&frame).unwrap();
    refused(&[], 1, &["lacks 1 of 48 files", frame.file_name().unwrap().to_str().unwrap()]);
    std::fs::write(&frame, bytes.to_ascii_uppercase()).unwrap();
    refused(&[], 2, &[frame.file_name().unwrap().to_str().unwrap(), "are not those of its digest", "hint:"]);
    std::fs::write(&frame, &bytes).unwrap();
    dir.edit("benchmark/panoptic-l4d.toml", "scenes", "variant = 3\nscenes");
    refused(&["--data", "data/tiny"], 1, &["wanted is profile tiny, variant 3"]);
    dir.edit("benchmark/panoptic-l4d.toml", "variant = 3\n", "");
    released(&dir, &["--profile", "tiny"]);
    assert!(dir.path(format!("{RELEASE}/archives/renders/tiny/room_living_cats.tar")).exists());
}

fn first_frame(dir: &Dir) -> std::path::PathBuf {
    let root = dir.path("data/tiny/room_living_cats/frames");
    let name = tree(&root).into_keys().find(|name| name.ends_with(".exr")).unwrap();
    root.join(name)
}

#[test]
fn a_check_finds_everything_at_once() {
    let dir = bench();
    released(&dir, &[]);
    let path = |name: &str| format!("{RELEASE}/{name}");
    let finding = |code: &str, name: &str| (code.to_owned(), path(name));
    std::fs::remove_file(dir.path(path("DATASHEET.md"))).unwrap();
    dir.write(&path("archives/more.tar"), "x");
    dir.edit(&path("tables/queries.jsonl"), "candidate", "verified");
    std::os::unix::fs::symlink("/etc/passwd", dir.path(path("tables/more.jsonl"))).unwrap();
    let expected = [
        finding("L4D612", "DATASHEET.md"),
        finding("L4D613", "archives/more.tar"),
        finding("L4D613", "tables/more.jsonl"),
        finding("L4D614", "tables/queries.jsonl"),
    ];
    assert_eq!(check(&dir, RELEASE), (1, expected.into()));

    dir.write(&path("SHA256SUMS"), "../../etc/passwd\n");
    assert_eq!(check(&dir, RELEASE), (1, vec![finding("L4D611", "SHA256SUMS")]));
    let run = dir.run(&["release", "--check", "nowhere"]);
    assert!(run.code == 2 && run.stderr.contains("hint:"), "{}", run.stderr);
}

#[test]
fn a_benchmark_with_holes_is_refused_with_all_of_them() {
    let dir = bench();
    std::fs::remove_file(dir.path("benchmark/truth/tiny/room_living_cats.json")).unwrap();
    dir.write(QUERIES, "{}\n");
    let run = release(&dir, &["--json"]);
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    let found = findings(&serde_json::from_str(&run.stdout).unwrap());
    let codes: Vec<&str> = found.iter().map(|(code, _)| code.as_str()).collect();
    assert_eq!(codes, ["L4D601", "L4D601"], "{found:?}");
    for arguments in
        [&["--date", "22.11.2026"][..], &["--date", "2026-11-22"], &["--date", "2026-11-22", "--url", "here"]]
    {
        let run = dir.run(&[&["release"], arguments].concat());
        assert_eq!(run.code, 2, "{arguments:?}");
    }
}
