//! What the end-to-end tests share: a folder of their own, the binary in it, and a made-up benchmark.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;

use l4d_data::layout::BenchDir;
use l4d_data::query::text_digest;
use l4d_data::truth::Truth;
use l4d_data::{Profile, Scale, Scene, Split, json};
use l4d_testing::{camera, flat, instance, scene};
use serde_json::{Value, json};

/// The project's folder.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The binary in the project's folder. Of a command line, what is between `'` is one argument.
pub(crate) fn l4d(line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_l4d"));
    for (place, part) in line.split('\'').enumerate() {
        match place % 2 {
            0 => command.args(part.split_whitespace()),
            _ => command.arg(part),
        };
    }
    command.current_dir(root()).stdin(Stdio::null()).env_remove("RUST_LOG");
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
    static PYTHON: LazyLock<PathBuf> = LazyLock::new(|| {
        let run: Run = l4d("doctor --setup --json").output().unwrap().into();
        assert_eq!(run.code, 0, "{run}");
        let document = run.value();
        let (_, path) =
            named(&document["doctor"], "python")["found"].as_str().unwrap().split_once('(').unwrap();
        PathBuf::from(path.trim_end_matches(')'))
    });
    PYTHON.clone()
}

/// A file that the repository ships.
pub(crate) fn shipped(relative: &str) -> String {
    std::fs::read_to_string(root().join(relative)).unwrap_or_else(|error| panic!("{relative}: {error}"))
}

/// A temporary working folder in which the binary is run.
pub(crate) struct Dir(tempfile::TempDir);

/// What a run of the binary left.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Dir {
    pub(crate) fn new() -> Self {
        Self(l4d_testing::folder())
    }

    /// A folder with a benchmark of two made-up scenes in `benchmark`.
    pub(crate) fn with_benchmark() -> Self {
        let dir = Self::new();
        write_benchmark(&dir.path("benchmark"));
        dir
    }

    /// The same, and the results of the baseline `oracle`, which are made once.
    pub(crate) fn with_oracle() -> Self {
        static ORACLE: LazyLock<Dir> = LazyLock::new(|| {
            let dir = Dir::with_benchmark();
            dir.succeed("baseline oracle --profile tiny");
            dir
        });
        ORACLE.copy()
    }

    /// The same with the results of all baselines.
    pub(crate) fn with_baselines() -> Self {
        static BASELINES: LazyLock<Dir> = LazyLock::new(|| {
            let dir = Dir::with_benchmark();
            dir.succeed("baseline --profile tiny");
            dir
        });
        BASELINES.copy()
    }

    /// A folder with a benchmark of some shipped scenes, as far as these files of them go: `scenes/{}.json`.
    pub(crate) fn with_shipped(name: &str, scenes: &[&str], files: &[&str]) -> Self {
        let dir = Self::new();
        for scene in scenes {
            for file in files {
                let file = format!("benchmark/{}", file.replace("{}", scene));
                dir.write(&file, shipped(&file));
            }
        }
        dir.write("benchmark/vocabulary.txt", shipped("benchmark/vocabulary.txt"));
        dir.write("benchmark/panoptic-l4d.toml", manifest(name, scenes));
        dir
    }

    /// Another folder with the same files.
    pub(crate) fn copy(&self) -> Self {
        let dir = Self::new();
        copy(self.0.path(), dir.0.path());
        dir
    }

    pub(crate) fn path(&self, relative: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(relative)
    }

    pub(crate) fn bytes(&self, relative: &str) -> Vec<u8> {
        std::fs::read(self.path(relative)).unwrap_or_else(|error| panic!("{relative}: {error}"))
    }

    pub(crate) fn read(&self, relative: &str) -> String {
        String::from_utf8(self.bytes(relative)).unwrap()
    }

    /// A JSON document.
    pub(crate) fn value(&self, relative: &str) -> Value {
        serde_json::from_slice(&self.bytes(relative)).unwrap_or_else(|error| panic!("{relative}: {error}"))
    }

    /// A file of JSON lines.
    pub(crate) fn lines(&self, relative: &str) -> Vec<Value> {
        self.read(relative).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// A CSV table by its columns.
    pub(crate) fn table(&self, relative: &str) -> Vec<BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_path(self.path(relative)).unwrap();
        reader.deserialize().map(Result::unwrap).collect()
    }

    /// Everything below a folder: relative path and bytes.
    pub(crate) fn tree(&self, relative: &str) -> BTreeMap<String, Vec<u8>> {
        let root = self.path(relative);
        let name = |path: &Path| path.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
        files_below(&root).iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect()
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

    /// Changes a JSON document.
    pub(crate) fn change(&self, relative: &str, change: impl FnOnce(&mut Value)) {
        let mut value = self.value(relative);
        change(&mut value);
        self.write(relative, value.to_string());
    }

    /// Removes a file or a folder.
    pub(crate) fn remove(&self, relative: &str) {
        let path = self.path(relative);
        if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) }.unwrap();
    }

    pub(crate) fn rename(&self, from: &str, to: &str) {
        std::fs::rename(self.path(from), self.path(to)).unwrap();
    }

    /// Turns the results of a baseline into those of a method of its own, which looked at no truth.
    pub(crate) fn contestant(&self, baseline: &str, name: &str) {
        self.rename(&format!("results/{baseline}"), &format!("results/{name}"));
        self.change(&format!("results/{name}/method.json"), |card| {
            card["name"] = name.into();
            card["used"]["ground_truth"] = false.into();
            card.as_object_mut().unwrap().remove("baseline");
        });
    }

    /// The binary in this folder.
    pub(crate) fn command(&self, line: impl AsRef<str>) -> Command {
        let mut command = l4d(line.as_ref());
        command.current_dir(self.0.path());
        command
    }

    pub(crate) fn run(&self, line: impl AsRef<str>) -> Run {
        self.command(line).output().unwrap().into()
    }

    /// Starts the binary, to be killed.
    pub(crate) fn spawn(&self, line: impl AsRef<str>) -> Child {
        self.command(line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    }

    /// Runs the binary and demands success.
    pub(crate) fn succeed(&self, line: impl AsRef<str>) -> Run {
        let run = self.run(&line);
        assert_eq!(run.code, 0, "l4d {}\n{run}", line.as_ref());
        run
    }

    /// Runs the binary and demands an error that says all this, and a hint.
    pub(crate) fn refuses(&self, line: impl AsRef<str>, parts: &[&str]) {
        self.run(line).refused(parts);
    }

    /// Runs the binary with `--json` and parses what it prints.
    pub(crate) fn json(&self, line: impl AsRef<str>) -> Value {
        self.run(format!("{} --json", line.as_ref())).value()
    }
}

impl Run {
    /// What was printed, as JSON.
    pub(crate) fn value(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}\n{self}"))
    }

    /// Demands an exit code, and all this in the output.
    pub(crate) fn says(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, code, "{self}");
        for part in parts {
            assert!(self.stdout.contains(part) || self.stderr.contains(part), "no `{part}` in\n{self}");
        }
    }

    /// Demands an error with a hint that says all this.
    pub(crate) fn refused(&self, parts: &[&str]) {
        assert_eq!(self.code, 2, "{self}");
        for part in parts.iter().chain(&["hint:"]) {
            assert!(self.stderr.contains(part), "no `{part}` in\n{}", self.stderr);
        }
    }
}

impl fmt::Display for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.stdout, self.stderr)
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

/// Copies a folder and all that is in it.
pub(crate) fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// All files below a folder, by path.
pub(crate) fn files_below(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let (inner, found): (Vec<_>, Vec<_>) = paths.partition(|path| path.is_dir());
        folders.extend(inner);
        files.extend(found);
    }
    files.sort();
    files
}

/// The member of a list that has this name.
pub(crate) fn named<'a>(list: &'a Value, name: &str) -> &'a Value {
    let found = list.as_array().unwrap().iter().find(|one| one["name"] == name);
    found.unwrap_or_else(|| panic!("no {name} in {list:#}"))
}

/// The codes of a document's findings.
pub(crate) fn codes(document: &Value) -> Vec<&str> {
    document["findings"].as_array().unwrap().iter().map(|one| one["code"].as_str().unwrap()).collect()
}

/// A query as files of queries have it, a candidate without predicate; `categories` as in `action+spatial`.
pub(crate) fn query(
    id: &str,
    text: &str,
    categories: &str,
    referents: &[&str],
    temporal: &str,
    frames: [u32; 2],
) -> Value {
    json!({
        "id": id,
        "text": text,
        "categories": categories.split('+').collect::<Vec<_>>(),
        "referents": referents,
        "temporal": temporal,
        "frames": [frames],
        "predicate": null,
        "text_digest": text_digest(text, None),
        "provenance": { "source": "author" },
        "status": "candidate",
    })
}

/// A manifest of a benchmark.
pub(crate) fn manifest(name: &str, scenes: &[impl AsRef<str>]) -> String {
    let scenes: Vec<&str> = scenes.iter().map(AsRef::as_ref).collect();
    format!("name = \"{name}\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\nscenes = {scenes:?}\n")
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
fn write_benchmark(root: &Path) {
    let dir = BenchDir::new(root);
    std::fs::create_dir_all(root).unwrap();
    std::fs::write(dir.manifest(), manifest("Discs", &SCENES.map(|(name, _)| name))).unwrap();
    for (seed, (scene, scale)) in SCENES.into_iter().enumerate() {
        json::write_compact(&dir.truth(Profile::Tiny, scene), &truth(scene, scale, seed as u64)).unwrap();
        json::write_lines(&dir.queries(scene), &queries(scene)).unwrap();
    }
}

fn truth(label: &str, scale: Scale, seed: u64) -> Truth {
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

fn queries(scene: &str) -> Vec<Value> {
    let one = |number: &str, category: &str, referents: &[&str], frames: [u32; 2], status: &str| {
        let temporal = if frames == [0, 96] { "whole" } else { "while" };
        let text = format!("the thing that number {number} means");
        let mut query = query(&format!("{scene}/{number}"), &text, category, referents, temporal, frames);
        query["status"] = status.into();
        query
    };
    vec![
        one("001", "attribute", &["disc_a"], [0, 96], "candidate"),
        one("002", "action", &["disc_b"], [24, 60], "candidate"),
        one("003", "spatial", &["disc_a", "ball_d"], [0, 96], "candidate"),
        one("004", "interaction", &["disc_c"], [0, 48], "verified"),
        one("005", "attribute", &["ball_d"], [0, 96], "rejected"),
    ]
}
