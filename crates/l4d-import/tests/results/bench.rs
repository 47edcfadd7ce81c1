//! A small benchmark on disk, and masks of its held-out view.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::layout::BenchDir;
use l4d_data::query::text_digest;
use l4d_data::scene::{Role, Scale};
use l4d_data::truth::{InstanceTruth, SCHEMA, Truth, frame_key};
use l4d_data::{Benchmark, Name, Profile, Report, json};
use l4d_import::results::codec::{Reading, Selections};
use l4d_import::results::import::{Encoders, FrameOrder, Imported, Request, import};
use l4d_import::results::preset::Preset;
use l4d_masks::Mask;

/// The one scene.
pub(crate) const SCENE: &str = "tabletop_cups";
/// Sentences of queries 001 to 003; the third holds from frame 36 to 60.
pub(crate) const TEXTS: [&str; 3] = ["The red cup", "the blue cup", "the red cup while it tips"];

/// A folder with a benchmark in it.
pub(crate) struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    pub(crate) fn new() -> Self {
        let bench = Self { folder: l4d_testing::folder() };
        let dir = BenchDir::new(bench.path("bench"));
        std::fs::create_dir_all(dir.root().join("queries")).unwrap();
        let manifest =
            "name = \"Cups\"\nversion = \"0.1.0\"\nlicence = \"CC-BY-4.0\"\nscenes = [\"tabletop_cups\"]\n";
        std::fs::write(dir.manifest(), manifest).unwrap();
        let query = |(index, text): (usize, &&str)| {
            let is_gated = index == 2;
            serde_json::json!({
                "id": format!("{SCENE}/{:03}", index + 1), "text": text, "categories": ["attribute"],
                "referents": [if index == 1 { "cup_blue" } else { "cup_red" }],
                "temporal": if is_gated { "while" } else { "whole" },
                "frames": if is_gated { [[36, 60]] } else { [[0, 96]] },
                "predicate": null, "text_digest": text_digest(text, None),
                "provenance": {"source": "author"}, "status": "candidate",
            })
            .to_string()
        };
        let lines: Vec<String> = TEXTS.iter().enumerate().map(query).collect();
        std::fs::write(dir.queries(SCENE), lines.join("\n")).unwrap();
        json::write(&dir.truth(Profile::Tiny, SCENE), &truth()).unwrap();
        bench
    }

    pub(crate) fn path(&self, below: &str) -> PathBuf {
        self.folder.path().join(below)
    }

    pub(crate) fn open(&self) -> Benchmark {
        Benchmark::open(self.path("bench")).unwrap()
    }

    /// Writes a file below the folder of the method.
    pub(crate) fn write(&self, below: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path("method").join(below);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    /// Imports the method's folder under a preset, after `change` has had its way with the request.
    pub(crate) fn import(&self, preset: &str, change: impl FnOnce(&mut Request<'_>)) -> (Imported, Report) {
        let bench = self.open();
        let mut request = request(&bench, preset, &self.path("method"));
        change(&mut request);
        let mut report = Report::default();
        let imported = import(&request, |_| (), &mut report).unwrap();
        (imported, report)
    }
}

pub(crate) fn request<'a>(bench: &'a Benchmark, preset: &str, root: &Path) -> Request<'a> {
    let preset = Preset::find(preset).unwrap();
    Request {
        bench,
        profile: Profile::Tiny,
        scenes: vec![Name::new(SCENE).unwrap()],
        reading: Reading {
            codec: preset.codec,
            inside: preset.inside,
            key: preset.key.clone(),
            selections: Selections::new(),
        },
        resize: preset.resize,
        preset,
        root: root.to_owned(),
        choices: BTreeMap::new(),
        order: FrameOrder::Clip,
        images: None,
        encoders: Encoders::default(),
        claims: Vec::new(),
    }
}

/// Frames of the profile.
pub(crate) fn clip() -> Vec<u32> {
    Profile::Tiny.frames().collect()
}

/// What the held-out view sees: two cups that move, so that no two frames are alike.
pub(crate) fn cup(name: &str, position: usize) -> Mask {
    let left = if name == "cup_red" { 8 } else { 70 } + 5 * position as u32;
    Mask::from_fn(128, 96, |col, row| (left..left + 16).contains(&col) && (40..62).contains(&row))
}

/// The referent of a query, by its place among the texts.
pub(crate) fn referent(query: usize) -> &'static str {
    if query == 1 { "cup_blue" } else { "cup_red" }
}

fn truth() -> Truth {
    let instance = |(id, name): (u32, &str)| InstanceTruth {
        name: Name::new(name).unwrap(),
        id,
        role: Role::Object,
        category: "cup".to_owned(),
        masks: clip()
            .iter()
            .enumerate()
            .map(|(at, &frame)| (frame_key(frame), cup(name, at).to_rle()))
            .collect(),
    };
    Truth {
        unannotated: Vec::new(),
        schema: SCHEMA.to_owned(),
        scene: Name::new(SCENE).unwrap(),
        scale: Scale::Tabletop,
        variant: 0,
        profile: Profile::Tiny,
        width: 128,
        height: 96,
        test_view: Name::new("cam08").unwrap(),
        frames: clip(),
        instances: [(1, "cup_red"), (2, "cup_blue")].into_iter().map(instance).collect(),
        visible: BTreeMap::new(),
    }
}

/// The codes of all findings, sorted, each once.
pub(crate) fn codes(report: Report) -> Vec<&'static str> {
    let mut codes: Vec<&str> = report.into_sorted().into_iter().map(|finding| finding.code).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}
