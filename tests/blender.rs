//! The main job on real Blender: nothing here is skipped where Blender lacks; it is installed.
//!
//! The environment is made once in the project's `work/` folder and shared by all tests.

mod composed;
mod scenes;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::{Benchmark, Name, Profile, Scene};
use l4d_frames::exr::read_frame;
use l4d_frames::frame::Frame;
use serde_json::Value;

use crate::support::{Run, blender_python, files_below, l4d, root, succeed};

const SCENE: &str = "tabletop_mouse_cups";
/// The default of `quickstart`.
const FIRST_SCENE: &str = "room_playroom";

fn build(data: &Path, bench: &Path, more: &[&str]) -> Command {
    let mut command = l4d(&format!("build-scenes --profile tiny --scenes {SCENE}"));
    command.arg("--data").arg(data).arg("--bench").arg(bench).args(more);
    command
}

/// A benchmark folder of its own, so that the committed one is never written by a test.
fn bench_copy(folder: &Path) -> PathBuf {
    let bench = folder.join("benchmark");
    std::fs::create_dir_all(bench.join("queries")).unwrap();
    std::fs::copy(root().join("benchmark/panoptic-l4d.toml"), bench.join("panoptic-l4d.toml")).unwrap();
    for scene in &Benchmark::open(root().join("benchmark")).unwrap().manifest.scenes {
        let file = format!("queries/{scene}.jsonl");
        std::fs::copy(root().join("benchmark").join(&file), bench.join(&file)).unwrap();
    }
    bench
}

#[test]
fn the_python_suite_passes() {
    let status = Command::new(blender_python())
        .current_dir(root().join("blender_scripts"))
        .args(["-m", "pytest", "-q", "-x"])
        .status()
        .unwrap();
    assert!(status.success(), "pytest: {status}");
}

#[test]
fn the_python_code_is_formatted_linted_and_typed() {
    let environment = root().join("work/python-checks");
    let scripts = root().join("blender_scripts");
    let project = std::fs::read_to_string(scripts.join("pyproject.toml")).unwrap();
    let (_, pins) = project.split_once("\ndev = [").unwrap();
    let pins = pins.split_once(']').unwrap().0.split(',').map(|pin| pin.trim().trim_matches('"'));
    succeed(Command::new(blender_python()).args(["-m", "venv"]).arg(&environment));
    let python = environment.join("bin/python");
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    succeed(Command::new(&python).args(pip).args(pins.filter(|pin| !pin.is_empty())));
    for check in [&["ruff", "check", "."][..], &["ruff", "format", "--check", "."], &["mypy"]] {
        succeed(Command::new(&python).current_dir(&scripts).arg("-m").args(check));
    }
}

#[test]
fn the_quickstart_ends_with_a_leaderboard() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("quickstart");
    let mut quickstart = l4d("quickstart --out");
    quickstart.arg(&out);
    let said = succeed(&mut quickstart);
    for file in ["data/room_playroom/sheet.png", "leaderboard/leaderboard.csv", "leaderboard/index.html"] {
        assert!(out.join(file).metadata().is_ok_and(|metadata| metadata.len() > 0), "{file} is not there");
    }
    let scores = methods(&out);
    for column in ["miou", "macc", "tube_iou", "select"] {
        assert_eq!(scores["oracle"][column], 100.0, "oracle {column}");
        assert_eq!(scores["none"][column], 0.0, "none {column}");
    }
    let tube = |method: &str| scores[method]["tube_iou"].as_f64().unwrap();
    assert!(tube("time-agnostic") < tube("oracle"), "tube IoU does not see time");
    assert_eq!(scores["time-agnostic"]["miou"], 100.0, "the paper's mIoU was expected to be blind to time");
    assert!(tube("random-look-alike") < tube("look-alike-union").max(tube("time-agnostic")));

    let solver = &scores["panopticquery-panoptic"];
    assert!(solver["miou"].as_f64().unwrap() > 10.0, "the ranked row says nothing: {solver}");
    let oracle = scores["panopticquery-oracle"]["miou"].as_f64().unwrap();
    assert!(oracle > 35.0, "from pictures of four cameras far apart: {oracle}");
    assert!(oracle_with_depth(&out) > 60.0);
    assert!(said.contains("track: colour\n"), "the model's track is not named:\n{said}");
    assert!(said.contains("leaderboard/index.html"), "the page is not named:\n{said}");
    every_query_has_its_ending(&said);
    proposed_sentences_are_answered(&said);

    check_against_shipped_truth(&out.join("benchmark"));
    let again = succeed(&mut quickstart);
    assert!(again.contains("rendered 0 pictures"), "a second quickstart rendered again:\n{again}");
}

/// mIoU of the oracle grounder on a model of the quickstart's scene that learned from rendered depth.
fn oracle_with_depth(out: &Path) -> f64 {
    for verb in ["train-splats room_playroom --depth", "solve --grounder oracle --results deep/results"] {
        let mut command =
            l4d(&format!("{verb} --profile tiny --bench benchmark --data data --work deep/work"));
        succeed(command.current_dir(out));
    }
    let mut score = l4d("score deep/results --profile tiny --bench benchmark --scores deep/scores --json");
    let document: Value = serde_json::from_slice(&score.current_dir(out).output().unwrap().stdout).unwrap();
    document["methods"][0]["miou"].as_f64().unwrap()
}

fn every_query_has_its_ending(said: &str) {
    let queries = Benchmark::open(root().join("benchmark")).unwrap();
    let queries = queries.queries(&Name::new(FIRST_SCENE).unwrap()).unwrap();
    let endings = ["right", "not read", "not found", "outvoted", "wrong object", "no answer"];
    for query in &queries {
        let ended = |line: &str| {
            endings.iter().any(|ending| line.contains(&format!(" IoU  {}: {ending}", query.text)))
        };
        assert!(said.lines().any(ended), "how did `{}` end?\n{said}", query.text);
    }
}

/// The two commands are typed as they are printed; what they find is what the referent is.
fn proposed_sentences_are_answered(said: &str) {
    let commands: Vec<&str> =
        said.lines().map(str::trim).filter(|line| line.contains(&format!(" query {FIRST_SCENE} "))).collect();
    assert_eq!(commands.len(), 2, "{said}");
    for command in commands {
        let mut shell = Command::new("bash");
        let output = succeed(shell.current_dir(root()).args(["-c", command]));
        assert!(output.contains("answer: "), "{command}\n{output}");
    }
}

fn methods(out: &Path) -> BTreeMap<String, Value> {
    let mut score = l4d("score --profile tiny --json --bench");
    score.arg(out.join("benchmark")).arg("--scores").arg(out.join("scores")).arg(out.join("results"));
    let output = score.output().unwrap();
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let methods = document["methods"].as_array().unwrap().clone();
    methods.into_iter().map(|method| (method["name"].as_str().unwrap().to_owned(), method)).collect()
}

/// The shipped truth is what these scripts render: at most a stray edge pixel of another processor may differ.
fn check_against_shipped_truth(bench: &Path) {
    let shipped = Benchmark::open(root().join("benchmark")).unwrap();
    let scene = Name::new(FIRST_SCENE).unwrap();
    let shipped = shipped.truth(Profile::Tiny, &scene).unwrap();
    let rendered = Benchmark::open(bench).unwrap().truth(Profile::Tiny, &scene).unwrap();
    assert_eq!(shipped.test_view, rendered.test_view);
    let pixels = |truth: &l4d_data::truth::Truth| -> i64 {
        truth.visible.values().flat_map(|view| view.values()).flatten().map(|&count| i64::from(count)).sum()
    };
    let (shipped, rendered) = (pixels(&shipped), pixels(&rendered));
    assert!(
        (shipped - rendered).abs() <= shipped / 1000,
        "{shipped} pixels are shipped, {rendered} were rendered"
    );
}

#[test]
fn a_killed_build_ends_with_the_same_bytes_and_a_torn_frame_is_rendered_again() {
    let build = Build::whole();
    build.renders_parts_alone_and_then_the_rest();
    build.ends_with_the_same_bytes_after(3);
    build.renders_torn_frames_again_and_keeps_good_ones();
}

#[test]
#[ignore = "slow: kills a build twenty times"]
fn a_build_killed_twenty_times_ends_with_the_same_bytes() {
    Build::whole().ends_with_the_same_bytes_after(20);
}

/// A scene that was rendered without a kill.
struct Build {
    folder: tempfile::TempDir,
    bench: PathBuf,
    data: PathBuf,
}

impl Build {
    fn whole() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (bench, data) = (bench_copy(folder.path()), folder.path().join("calm"));
        succeed(&mut build(&data, &bench, &[]));
        Self { folder, bench, data }
    }

    fn renders_parts_alone_and_then_the_rest(&self) {
        let parted = self.folder.path().join("parted");
        let (calm, dir) = (SceneDir::new(&self.data, SCENE), SceneDir::new(&parted, SCENE));
        let camera = &Scene::read(&calm.scene()).unwrap().cameras[1].name;
        let frames = || {
            files_below(&dir.root().join("frames"))
                .into_iter()
                .filter(|path| is_frame(path))
                .collect::<Vec<_>>()
        };
        let part = |more: &str| {
            let words: Vec<&str> = ["--views", camera.as_str()].into_iter().chain(more.split(' ')).collect();
            succeed(&mut build(&parted, &self.bench, &words))
        };
        let one = part("--frames 12");
        assert!(one.contains("rendered 1 pictures"), "{one}");
        assert!(one.contains(SCENE) && one.contains("still to be rendered"), "{one}");
        assert_eq!(frames(), [dir.frame(camera, 12)]);
        assert!(!dir.scene().exists());
        // Of 0, 12, 24 the second shard has the second, which is there.
        assert!(part("--frames 0-24 --shard 2/2").contains("rendered 0 pictures"));
        assert!(part("--frames 0-24 --shard 1/2").contains("rendered 2 pictures"));
        assert_eq!(frames().len(), 3);
        let rest = succeed(&mut build(&parted, &self.bench, &[]));
        let all = Profile::Tiny.frames().count() * (Profile::Tiny.training_views() + 1);
        assert!(rest.contains(&format!("rendered {} pictures", all - 3)), "{rest}");
        assert_same_build(&calm, &dir);
    }

    fn ends_with_the_same_bytes_after(&self, kills: u64) {
        let shaken = self.folder.path().join("shaken");
        for kill in 0..kills {
            let mut child =
                build(&shaken, &self.bench, &[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            // Spread over planning, rendering and settling without a random source: primes of milliseconds.
            std::thread::sleep(Duration::from_millis(1500 + (kill * 2711) % 9973));
            child.kill().unwrap();
            child.wait().unwrap();
            assert!(temporaries_are_hidden(&shaken), "a half-written file has a final name");
        }
        succeed(&mut build(&shaken, &self.bench, &[]));
        assert_same_build(&SceneDir::new(&self.data, SCENE), &SceneDir::new(&shaken, SCENE));
    }

    fn renders_torn_frames_again_and_keeps_good_ones(&self) {
        let dir = SceneDir::new(&self.data, SCENE);
        let before = std::fs::read(dir.scene()).unwrap();
        let camera = Scene::read(&dir.scene()).unwrap().cameras[0].name.clone();
        let (torn, kept) = (dir.frame(&camera, 12), dir.frame(&camera, 24));
        let bytes = std::fs::read(&torn).unwrap();
        std::fs::write(&torn, &bytes[..bytes.len() / 2]).unwrap();
        let modified = kept.metadata().unwrap().modified().unwrap();
        let talk = succeed(&mut build(&self.data, &self.bench, &[]));
        assert!(talk.contains("rendered 1 picture"), "{talk}");
        assert_eq!(kept.metadata().unwrap().modified().unwrap(), modified, "a good frame was rendered again");
        assert_eq!(std::fs::read(dir.scene()).unwrap(), before);

        let refused = build(&self.data, &self.bench, &["--samples", "2"]).output().unwrap();
        assert_eq!(refused.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&refused.stderr).contains("--force"), "{refused:?}");
    }
}

fn is_frame(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "exr")
}

fn temporaries_are_hidden(data: &Path) -> bool {
    let frames = SceneDir::new(data, SCENE).root().join("frames");
    let Ok(views) = std::fs::read_dir(frames) else { return true };
    let files = views.flatten().filter_map(|view| std::fs::read_dir(view.path()).ok()).flatten().flatten();
    files
        .map(|file| file.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "exr"))
        .all(|path| {
            path.file_name().unwrap().to_string_lossy().starts_with('.')
                || read_frame(&path, tiny_size()).is_ok()
        })
}

fn tiny_size() -> UVec2 {
    UVec2::new(Profile::Tiny.width(), Profile::Tiny.height())
}

fn assert_same_build(calm: &SceneDir, shaken: &SceneDir) {
    assert_eq!(std::fs::read(calm.scene()).unwrap(), std::fs::read(shaken.scene()).unwrap(), "scene.json");
    let scene = Scene::read(&calm.scene()).unwrap();
    for camera in &scene.cameras {
        for frame in Profile::Tiny.frames() {
            let [calm, shaken] =
                [calm, shaken].map(|dir| read_frame(&dir.frame(&camera.name, frame), tiny_size()).unwrap());
            let place = format!("{}/{frame:04}", camera.name);
            assert_eq!(calm.surfaces, shaken.surfaces, "depth and ids of {place}");
            assert_close_colour(&calm, &shaken, &place);
        }
    }
}

/// Within 1e-4, or one step of half precision.
fn assert_close_colour(calm: &Frame, shaken: &Frame, place: &str) {
    for (left, right) in calm.rgb.iter().flatten().zip(shaken.rgb.iter().flatten()) {
        let step = i32::from(left.to_bits()).abs_diff(i32::from(right.to_bits()));
        let difference = (left.to_f32() - right.to_f32()).abs();
        assert!(difference <= 1e-4 || step <= 1, "colour of {place}: {left} and {right}");
    }
}

#[test]
fn requests_that_cannot_be_served_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench_copy(folder.path());
    let refused = |command: &mut Command, words: &[&str]| Run::from(command.output().unwrap()).refused(words);
    refused(&mut l4d("build-scenes --scenes moon_base"), &["no scene `moon_base`", SCENE]);
    refused(&mut l4d("build-scenes --scenes ../evil"), &["no scene `../evil`"]);
    let data = folder.path().join("data");
    let python = ["/nonexistent", "--python"];
    refused(&mut build(&data, &bench, &["--python", "/nonexistent"]), &python);
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    refused(&mut build(&file.join("data"), &bench, &[]), &["file"]);
    refused(&mut l4d("build-scenes --blender-scripts /nonexistent"), &["--blender-scripts"]);
}
