//! What the end-to-end tests share: a folder of their own, the binary in it, and a made-up benchmark.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use l4d_data::truth::Truth;
use l4d_data::{Category, Query, Scale, Scene, Split, Status};
use l4d_testing::{camera, flat, instance, query, scene};
use serde_json::Value;

/// The project's folder.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The binary in the project's folder.
pub(crate) fn l4d(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_l4d"));
    command.current_dir(root()).args(args).stdin(Stdio::null());
    command
}

/// Both outputs of a command that has to succeed.
pub(crate) fn succeed(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{}\n{stderr}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stdout).unwrap() + &stderr
}

/// The Python of the Blender environment in the project's `work/` folder, made once if it is missing.
pub(crate) fn blender_python() -> PathBuf {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(make_blender_python).clone()
}

fn make_blender_python() -> PathBuf {
    let mut doctor = Command::new(env!("CARGO_BIN_EXE_l4d"));
    doctor.current_dir(env!("CARGO_MANIFEST_DIR")).args(["doctor", "--setup", "--json"]);
    let run: Run = doctor.output().unwrap().into();
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    let lines = document["doctor"].as_array().unwrap();
    let line = lines.iter().find(|line| line["name"] == "python").unwrap();
    let (_, path) = line["found"].as_str().unwrap().split_once('(').unwrap();
    PathBuf::from(path.trim_end_matches(')'))
}

/// A temporary working folder in which the binary is run.
pub(crate) struct Dir(tempfile::TempDir);

/// What a run of the binary left.
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Dir {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with a benchmark of two made-up scenes in `benchmark`.
    pub(crate) fn with_benchmark() -> Self {
        let dir = Self::new();
        write_benchmark(&dir.path("benchmark"));
        dir
    }

    pub(crate) fn path(&self, relative: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(relative)
    }

    pub(crate) fn read(&self, relative: &str) -> String {
        std::fs::read_to_string(self.path(relative)).unwrap()
    }

    pub(crate) fn write(&self, relative: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(relative);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    /// Changes one place of a text file.
    pub(crate) fn edit(&self, relative: &str, from: &str, to: &str) {
        let text = self.read(relative);
        assert!(text.contains(from), "{relative} does not contain `{from}`");
        self.write(relative, text.replacen(from, to, 1));
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Run {
        let output = Command::new(env!("CARGO_BIN_EXE_l4d"))
            .args(arguments)
            .current_dir(self.0.path())
            .env_remove("RUST_LOG")
            .output()
            .unwrap();
        output.into()
    }

    /// Runs the binary and demands success.
    pub(crate) fn succeed(&self, arguments: &[&str]) -> Run {
        let run = self.run(arguments);
        assert_eq!(run.code, 0, "l4d {}\n{}\n{}", arguments.join(" "), run.stdout, run.stderr);
        run
    }

    /// Runs the binary with `--json` and parses what it prints.
    pub(crate) fn json(&self, arguments: &[&str]) -> Value {
        let run = self.run(&[arguments, &["--json"]].concat());
        serde_json::from_str(&run.stdout)
            .unwrap_or_else(|error| panic!("{error}\n{}\n{}", run.stdout, run.stderr))
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

/// Deterministic noise (Marsaglia's xorshift): tests need variety, not quality.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub(crate) fn below(&mut self, bound: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as u32 % bound
    }
}

/// Scenes of the made-up benchmark.
pub(crate) const SCENES: [(&str, Scale); 2] =
    [("outdoor_discs", Scale::Outdoor), ("room_discs", Scale::Room)];
/// Queries of each made-up scene.
pub(crate) const QUERIES: [&str; 5] = ["001", "002", "003", "004", "005"];

/// Writes a benchmark of moving discs at the profile tiny: objects 1 to 4 in two categories, a landmark below them.
///
/// Of the queries of a scene, 002 is gated, 003 means two things, 004 is verified and 005 is rejected.
pub(crate) fn write_benchmark(root: &Path) {
    let scenes =
        (0..).zip(SCENES).map(|(seed, (scene, scale))| (truth(scene, scale, seed), queries(scene).to_vec()));
    l4d_testing::write_benchmark(root, &scenes.collect::<Vec<_>>());
}

pub(crate) fn truth(label: &str, scale: Scale, seed: u64) -> Truth {
    let mut noise = Noise::new(seed + 1);
    let starts: Vec<(i64, i64, i64)> = (0..4)
        .map(|_| (i64::from(noise.below(90)), i64::from(noise.below(90)), 8 + i64::from(noise.below(14))))
        .collect();
    let id_at = |col: u32, row: u32, frame: u32| {
        let inside = |&(x, y, radius): &(i64, i64, i64)| {
            let (dx, dy) = (i64::from(col) - x - i64::from(frame) / 3, i64::from(row) - y);
            dx * dx + dy * dy < radius * radius
        };
        let disc = starts.iter().position(inside).map(|index| index as u32 + 1);
        disc.unwrap_or(if row > 70 { 1001 } else { 0 })
    };
    let things = [(1, "disc_a"), (2, "disc_b"), (3, "disc_c"), (4, "ball_d"), (1001, "floor")];
    let instances = things.map(|(id, name)| instance(id, name)).to_vec();
    let described = Scene { scale, ..scene(label, vec![camera("test", Split::Test)], instances) };
    l4d_testing::truth(&described, |_, frame| flat(|col, row| id_at(col, row, frame)).surfaces)
}

fn queries(scene: &str) -> [Query; 5] {
    let query = |number: &str, category: Category, referents: &[&str], frames: [u32; 2], status: Status| {
        let text = format!("the thing that number {number} means");
        let query = query(&format!("{scene}/{number}"), &text, referents, frames);
        Query { categories: vec![category], status, ..query }
    };
    [
        query("001", Category::Attribute, &["disc_a"], [0, 96], Status::Candidate),
        query("002", Category::Action, &["disc_b"], [24, 60], Status::Candidate),
        query("003", Category::Spatial, &["disc_a", "ball_d"], [0, 96], Status::Candidate),
        query("004", Category::Interaction, &["disc_c"], [0, 48], Status::Verified),
        query("005", Category::Attribute, &["ball_d"], [0, 96], Status::Rejected),
    ]
}
