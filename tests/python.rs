//! The Python package `l4d`: loaded into Python and asked for the numbers that Rust has.
//!
//! The plain suite loads the library that cargo built for these tests; in the slow one a wheel is built, installed into
//! a fresh environment and asked the same. What is asked is in `crates/l4d-py/tests/`. The program and its folders are
//! laid out as an installed wheel has them, and run where nothing else is.

use std::collections::BTreeMap;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX, EXE_SUFFIX};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::{DMat4, UVec2};
use l4d_data::capture::{self, Capture};
use l4d_data::digest::sha256_hex;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Role, Scale};
use l4d_data::truth::{InstanceTruth, Truth};
use l4d_data::{Camera, Category, Profile, Query, Rig, Scene, Split, Temporal, json};
use l4d_frames::Display;
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use l4d_frames::exr::read_frame;
use l4d_frames::sample;
use l4d_masks::Mask;
use l4d_release::gather::Source;
use l4d_release::shards;
use l4d_splat::model::{Model, time_of_frame};
use l4d_splat::raster::{Cpu, RasterSettings, Rasterizer as _};
use l4d_splat::synthetic::Room;
use l4d_splat::view::View;
use l4d_testing::{name, query, write_benchmark};
use serde_json::json;

use crate::support::{Dir, Run, blender_python, copy, named, root, succeed};
use crate::world;

/// What the package's tests are, but for those that need PyTorch; `{}` is their folder.
const WITHOUT_TORCH: &[&str] = &["{}", "--ignore={}/test_torch.py"];
const TORCH_TESTS: &str = "{}/test_torch.py";
/// The picture that Python and Rust are compared on.
const VIEW: &str = "cam01";
const FRAME: u32 = 48;
const SIZE: [u32; 2] = [128, 96];

#[test]
fn the_package_says_what_rust_says() {
    let (world, site) = (world_folder(), site_folder());
    ask(&blender_python(), &world, Some(&site.path("")), WITHOUT_TORCH);
}

#[test]
#[ignore = "needs PyTorch, numpy and pytest in L4D_TORCH_PYTHON"]
fn pytorch_reads_what_rust_wrote() {
    let python = std::env::var_os("L4D_TORCH_PYTHON").expect("L4D_TORCH_PYTHON names a Python");
    let (world, site) = (world_folder(), site_folder());
    ask(Path::new(&python), &world, Some(&site.path("")), &[TORCH_TESTS]);
}

#[test]
fn without_pytorch_the_data_set_says_what_it_needs() {
    let site = site_folder();
    let script = "import l4d\ntry:\n    l4d.torch\nexcept ImportError as error:\n    print(error)";
    let mut python = Command::new(blender_python());
    python.env("PYTHONPATH", site.path("")).env("PYTHONNOUSERSITE", "1").args(["-c", script]);
    let said = succeed(&mut python);
    assert!(said.contains("l4d.torch needs PyTorch") && said.contains("pip install torch"), "{said}");
}

#[test]
fn an_independent_evaluator_agrees_to_the_last_pixel() {
    crate::score::compare_with_numpy(&blender_python());
}

#[test]
fn an_installed_program_finds_what_came_with_it() {
    let place = installed();
    // What a build would write there: as if no picture of this size had been drawn yet.
    place.remove("share/l4d/benchmark/truth/full/room_kitchen.json");
    let program = place.path("bin").join(format!("l4d{EXE_SUFFIX}"));
    let shipped = place.tree("share");
    let empty = Dir::new();
    let run_in = |folder: &Dir, program: &Path, line: &str| -> Run {
        let mut command = Command::new(program);
        command.args(line.split_whitespace()).current_dir(folder.path(""));
        command.env_clear().env("PATH", "/nonexistent").output().unwrap().into()
    };
    let run = |program: &Path, line: &str| run_in(&empty, program, line);
    assert_eq!(run(&program, "--version").stdout.trim(), format!("l4d {}", env!("CARGO_PKG_VERSION")));
    run(&program, "check-queries --scenes room_kitchen").says(0, &["reads one frame"]);
    run(&program, "baseline oracle --profile tiny --scenes room_kitchen").says(0, &[]);
    run(&program, "score results --profile tiny --scenes room_kitchen").says(0, &["oracle"]);
    let line = run(&program, "doctor --json").value();
    let found = |name: &str| named(&line["doctor"], name)["found"].as_str().unwrap().to_owned();
    let share = place.path("share/l4d").canonicalize().unwrap();
    assert!(found("benchmark").contains("21 scenes"), "{}", found("benchmark"));
    assert!(found("benchmark").contains(text(&share)), "{}", found("benchmark"));
    // It has read what the environment has to hold.
    assert!(found("python").contains("no Blender environment yet"), "{}", found("python"));

    // A link is on the path where tools keep an environment for each program.
    let link = empty.path("l4d");
    std::os::unix::fs::symlink(&program, &link).unwrap();
    run(&link, "check-queries --scenes room_kitchen").says(0, &["reads one frame"]);

    for line in [
        "build-scenes --scenes room_kitchen --update-benchmark",
        "build-scenes --scenes room_kitchen --profile full",
        "verdict demo",
    ] {
        run(&program, line).refused(&["was installed with l4d and is not written to", "cp -r "]);
    }
    // uv that came with it makes the environment, on the path or not; this one makes nothing and says that it did.
    std::os::unix::fs::symlink("/bin/true", place.path("bin/uv")).unwrap();
    run(&program, "doctor --setup").refused(&["bin/python: cannot run"]);
    assert!(place.tree("share") == shipped, "what was installed was changed");

    // A benchmark of the working folder comes first.
    let own = run_in(&Dir::with_benchmark(), &program, "check-queries --scenes room_kitchen");
    own.refused(&["benchmark/panoptic-l4d.toml", "has no scene `room_kitchen`"]);
}

/// The program of these tests as a wheel puts it into an environment.
fn installed() -> Dir {
    let dir = Dir::new();
    let lay_out = root().join("crates/l4d-py/wheel/contents.py");
    let mut python = Command::new(blender_python());
    python.args([text(&lay_out), env!("CARGO_BIN_EXE_l4d"), text(&dir.path("wheel"))]);
    succeed(python.env("PYTHONDONTWRITEBYTECODE", "1"));
    dir.rename("wheel/scripts", "bin");
    dir.rename("wheel/data/share", "share");
    dir
}

#[test]
#[ignore = "slow: builds a wheel"]
fn a_wheel_says_what_rust_says() {
    let dir = Dir::new();
    let requirements = root().join("crates/l4d-py/tests/requirements.txt");
    let build = environment(&dir.path("build"), &["-r", text(&requirements)]);
    // In the target folder of these tests and with their profile: most of what a wheel needs is there.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let wheels = dir.path("wheels");
    let mut pip = Command::new(&build);
    pip.args(["-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", text(&wheels)]);
    pip.args(["--config-settings", "profile=dev"]);
    pip.args(["--config-settings", concat!("program=", env!("CARGO_BIN_EXE_l4d"))]);
    pip.env("CARGO_TARGET_DIR", target).env("PATH", path_with(build.parent().unwrap()));
    succeed(pip.arg(root().join("crates/l4d-py")));
    let wheel = fs::read_dir(&wheels).unwrap().next().unwrap().unwrap().path();
    let name = wheel.file_name().unwrap().to_string_lossy().into_owned();
    assert!(name.contains("-cp39-abi3-"), "{name} is not for all versions of Python");
    let fresh = environment(&dir.path("fresh"), &["pytest", "mypy", text(&wheel)]);
    ask(&fresh, &world_folder(), None, WITHOUT_TORCH);
    check_types(&fresh, &dir);
    let empty = Dir::new();
    let mut program = Command::new(fresh.with_file_name(format!("l4d{EXE_SUFFIX}")));
    program.args(["check-queries", "--scenes", "room_kitchen"]).current_dir(empty.path("")).env_clear();
    succeed(&mut program);
}

/// What a type checker says of the example, and of the stub beside the module that it describes.
fn check_types(python: &Path, dir: &Dir) {
    let example = root().join("crates/l4d-py/examples/score_your_method.py");
    let mypy = |words: &[&str]| succeed(Command::new(python).current_dir(dir.path("")).args(words));
    mypy(&["-m", "mypy", "--strict", text(&example)]);
    mypy(&["-m", "mypy.stubtest", "l4d"]);
}

/// Runs the tests of the package with what it needs beside it.
fn ask(python: &Path, world: &Dir, site: Option<&Path>, tests: &[&str]) {
    let mut pytest = Command::new(python);
    pytest.current_dir(world.path("")).env("L4D_ROOT", root()).env("PYTHONDONTWRITEBYTECODE", "1");
    pytest.env("PYTHONNOUSERSITE", "1").env_remove("PYTHONPATH");
    if let Some(site) = site {
        pytest.env("PYTHONPATH", site);
    }
    let folder = root().join("crates/l4d-py/tests");
    pytest.args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", text(&folder)]);
    // Relative names are those of files beside each other.
    pytest.args(tests.iter().map(|test| test.replace("{}", text(&folder))));
    let said = succeed(&mut pytest);
    assert!(said.contains(" passed") && !said.contains("skipped"), "{said}");
}

/// A folder to import `l4d` from.
fn site_folder() -> Dir {
    let dir = Dir::new();
    write_site(&dir.path(""));
    dir
}

/// Writes the package `l4d` below a folder: the Python files, and the library beside them.
pub(crate) fn write_site(folder: &Path) {
    let package = folder.join("l4d");
    copy(&root().join("crates/l4d-py/python/l4d"), &package);
    let built = std::env::current_exe().unwrap();
    let library = built.with_file_name(format!("{DLL_PREFIX}l4d_py{DLL_SUFFIX}"));
    let extension = if cfg!(windows) { "pyd" } else { "abi3.so" };
    fs::copy(&library, package.join(format!("_native.{extension}")))
        .unwrap_or_else(|error| panic!("{}: {error}", library.display()));
}

/// A rendered scene, its benchmark, results and scores, a model, clips, and `expected.json` with what Rust says of them.
fn world_folder() -> Dir {
    let dir = Dir::new();
    let data = dir.path("data/tiny");
    world::write_twins(&data);
    world::write_twins_benchmark(&dir.path("benchmark"), &data);
    dir.succeed("baseline oracle time-agnostic random-look-alike --profile tiny");
    let score = dir.run("score results --profile tiny --json");
    dir.write("score.json", score.stdout);
    dir.write("damaged/oracle/masks/ball/009.json", "{}");
    dir.write("damaged/oracle/masks/ball/001.json", r#"{"size":[96,128],"frames":{"0000":"~","0001":null}}"#);
    let findings = dir.run("check-results damaged --profile tiny --json");
    dir.write("findings.json", findings.stdout);

    let model = Room::small(4).model().unwrap();
    model.write(&dir.path("work/tiny/ball/splats")).unwrap();
    let render = format!("render-splats {} --profile tiny --views {VIEW}", world::SCENE);
    dir.succeed(&render);
    dir.succeed(format!("{render} --depth-format png --depth expected --frames 0 --out clips-png"));
    write_shards(&dir, &SceneDir::new(&data, world::SCENE));
    write_capture(&dir);
    json::write(&dir.path("expected.json"), &expected(&SceneDir::new(&data, world::SCENE), &model)).unwrap();
    dir
}

/// The shards of a scene as a release has them.
fn write_shards(dir: &Dir, scene_dir: &SceneDir) {
    let scene = Scene::read(&scene_dir.scene()).unwrap();
    let source = |camera: &Camera, frame: u32| {
        let path = scene_dir.frame(&camera.name, frame);
        Source::read(path.to_str().unwrap().to_owned(), path).ok()
    };
    for shard in shards::shards(&scene, shards::MOST_BYTES, source) {
        let name = shard.path.rsplit('/').next().unwrap();
        shard.write(&dir.path("shards").join(name), &sample::members, &|_| {}).unwrap();
    }
}

/// A capture of two cameras and three moments, and a benchmark about it. The moment in the middle has no annotation, and
/// one camera missed the last.
fn write_capture(dir: &Dir) {
    let camera =
        |view: &str, split: Split| Camera { split, ..Camera::new(name(view), [6, 4], 5.0, DMat4::IDENTITY) };
    let capture = Capture {
        schema: capture::SCHEMA.to_owned(),
        name: name("desk"),
        source: "a test".to_owned(),
        width: 6,
        height: 4,
        cameras: vec![camera("cam00", Split::Test), camera("cam01", Split::Train)],
        frames: vec![0, 1, 200],
        frames_per_second: Some(30.0),
        depth: capture::Depth::Absent,
        points: 0,
        is_metric: false,
        unseen: BTreeMap::from([(name("cam01"), vec![200])]),
        substituted: Vec::new(),
        inputs: BTreeMap::new(),
        notes: vec!["Made up.".to_owned()],
    };
    json::write(&dir.path("data/captures/desk").join(capture::CAPTURE), &capture).unwrap();
    for (view, frame) in [("cam00", 0), ("cam00", 1), ("cam00", 200), ("cam01", 0), ("cam01", 1)] {
        let shade = |column: u32, row: u32| Rgb([frame as u8, 10 * column as u8, 20 * row as u8]);
        let picture = RgbImage::from_fn(6, 4, shade);
        let path = Path::new("data/captures/desk").join(Capture::picture_path(view, frame));
        dir.write(path.to_str().unwrap(), encode_colour(&picture));
    }
    let mask = Mask::from_fn(6, 4, |column, row| column < 2 && row < 3).to_rle();
    let cup = InstanceTruth {
        name: name("cup"),
        id: 1,
        role: Role::Object,
        category: "cup".to_owned(),
        masks: ["0000", "0200"].map(|key| (key.to_owned(), mask.clone())).into(),
    };
    let truth = Truth {
        schema: l4d_data::truth::SCHEMA.to_owned(),
        scene: name("desk"),
        scale: Scale::Tabletop,
        variant: 0,
        profile: Profile::Real,
        width: 6,
        height: 4,
        test_view: name("cam00"),
        frames: vec![0, 200],
        unannotated: vec![1],
        instances: vec![cup],
        visible: BTreeMap::new(),
    };
    let asked = query("desk/001", "the cup on the desk", &["cup"], [0, 200]);
    let asked = Query { temporal: Temporal::Whole, categories: vec![Category::Spatial], ..asked };
    write_benchmark(&dir.path("captures"), &[(truth, vec![asked])]);
}

fn expected(scene: &SceneDir, model: &Model) -> serde_json::Value {
    let seen = read_frame(&scene.frame(VIEW, FRAME), UVec2::from_array(SIZE)).unwrap();
    let linear: Vec<f32> = seen.rgb.iter().flatten().map(|light| light.to_f32()).collect();
    let surfaces = seen.surfaces.digest();
    let rig = Rig::read(&scene.scene()).unwrap();
    let camera = rig.camera(VIEW).unwrap();
    let view = View::of_camera(camera, FRAME, SIZE, SIZE).unwrap();
    let splats = model.at(time_of_frame(FRAME)).unwrap();
    let cpu = Cpu::new();
    let drawing = cpu.prepare(&splats, &view, &RasterSettings::default()).unwrap().draw().unwrap();
    assert!(drawing.alpha.iter().any(|&alpha| alpha > 0.5), "the model is out of sight");
    json!({
        "view": VIEW,
        "frame": FRAME,
        "rgb": digest(&linear),
        "depth_m": surfaces.z,
        "id": surfaces.id,
        "display": sha256_hex(Display::new(1.0).picture(&seen).as_raw()),
        "world_from_camera": camera.world_from_camera[0],
        "splats": {
            "rgb": digest(drawing.colour.as_flattened()),
            "alpha": digest(&drawing.alpha),
            "median": digest(&drawing.quantiles.as_ref().unwrap().median_m),
            "expected": digest(&drawing.depth_expected_m()),
            "sum": digest(&drawing.depth_sum_m),
        },
    })
}

fn digest(values: &[f32]) -> String {
    sha256_hex(&values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
}

/// The interpreter of a new environment with some packages.
fn environment(folder: &Path, packages: &[&str]) -> PathBuf {
    succeed(Command::new(blender_python()).args(["-m", "venv", text(folder)]));
    let programs = if cfg!(windows) { "Scripts" } else { "bin" };
    let python = folder.join(programs).join(format!("python{EXE_SUFFIX}"));
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    succeed(install.args(packages));
    python
}

/// The variable PATH with a folder before all others: pip looks for the program of maturin there.
fn path_with(folder: &Path) -> OsString {
    let others = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(folder.to_owned()).chain(std::env::split_paths(&others));
    std::env::join_paths(folders).unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
