//! What the end-to-end tests share: a folder of their own, the binary in it, and a made-up benchmark.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use l4d_data::layout::BenchDir;
use l4d_data::name::Name;
use l4d_data::query::text_digest;
use l4d_data::scene::{Role, Scale};
use l4d_data::truth::{InstanceTruth, SCHEMA, Truth, frame_key};
use l4d_data::{Profile, json};
use l4d_masks::{Mask, Rle};
use serde_json::{Value, json};

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
const PROFILE: Profile = Profile::Tiny;

/// Writes a benchmark of moving discs at the profile tiny: objects 1 to 4 in two categories, a landmark below them.
///
/// Of the queries of a scene, 002 is gated, 003 means two things, 004 is verified and 005 is rejected.
pub(crate) fn write_benchmark(root: &Path) {
    let dir = BenchDir::new(root);
    let names: Vec<String> = SCENES.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    let manifest = format!(
        "name = \"Discs\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\nscenes = [{}]\n",
        names.join(", ")
    );
    std::fs::create_dir_all(root).unwrap();
    std::fs::write(dir.manifest(), manifest).unwrap();
    for (seed, (scene, scale)) in SCENES.into_iter().enumerate() {
        json::write_compact(&dir.truth(PROFILE, scene), &truth(scene, scale, seed as u64)).unwrap();
        json::write_lines(&dir.queries(scene), &queries(scene)).unwrap();
    }
}

pub(crate) fn truth(scene: &str, scale: Scale, seed: u64) -> Truth {
    let mut noise = Noise::new(seed + 1);
    let (width, height) = (PROFILE.width(), PROFILE.height());
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
    let instance = |name: &str, id: u32, role: Role, category: &str| {
        let masks: BTreeMap<String, Rle> = PROFILE
            .frames()
            .map(|frame| (frame, Mask::from_fn(width, height, |col, row| id_at(col, row, frame) == id)))
            .filter(|(_, mask)| !mask.is_empty())
            .map(|(frame, mask)| (frame_key(frame), mask.to_rle()))
            .collect();
        InstanceTruth { name: Name::new(name).unwrap(), id, role, category: category.to_owned(), masks }
    };
    let instances = vec![
        instance("disc_a", 1, Role::Object, "disc"),
        instance("disc_b", 2, Role::Object, "disc"),
        instance("disc_c", 3, Role::Object, "disc"),
        instance("ball_d", 4, Role::Object, "ball"),
        instance("floor", 1001, Role::Landmark, "floor"),
    ];
    let seen = |id: u32| -> Vec<u32> {
        let pixels =
            |frame| Mask::from_fn(width, height, |col, row| id_at(col, row, frame) == id).area() as u32;
        PROFILE.frames().map(pixels).collect()
    };
    let view = Name::new("test").unwrap();
    let visible = instances.iter().map(|instance| (instance.name.clone(), seen(instance.id))).collect();
    Truth {
        unannotated: Vec::new(),
        schema: SCHEMA.to_owned(),
        scene: Name::new(scene).unwrap(),
        scale,
        variant: 0,
        profile: PROFILE,
        width,
        height,
        test_view: view.clone(),
        frames: PROFILE.frames().collect(),
        instances,
        visible: BTreeMap::from([(view, visible)]),
    }
}

fn queries(scene: &str) -> Vec<Value> {
    let query =
        |number: &str, category: &str, referents: &[&str], interval: Option<[u32; 2]>, status: &str| {
            let text = format!("the thing that number {number} means");
            json!({
                "id": format!("{scene}/{number}"),
                "text": text,
                "categories": [category],
                "referents": referents,
                "temporal": if interval.is_some() { "while" } else { "whole" },
                "frames": [interval.unwrap_or([0, 96])],
                "predicate": null,
                "text_digest": text_digest(&text, None),
                "provenance": { "source": "author" },
                "status": status,
            })
        };
    vec![
        query("001", "attribute", &["disc_a"], None, "candidate"),
        query("002", "action", &["disc_b"], Some([24, 60]), "candidate"),
        query("003", "spatial", &["disc_a", "ball_d"], None, "candidate"),
        query("004", "interaction", &["disc_c"], Some([0, 48]), "verified"),
        query("005", "attribute", &["ball_d"], None, "rejected"),
    ]
}
