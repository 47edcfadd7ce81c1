//! Where everything is, relative to the folders that the user can choose.

use std::path::{Path, PathBuf};

use crate::camera::ViewCard;
use crate::capture::{CAPTURE, Capture, SPARSE};
use crate::composition::Composition;
use crate::error::DataError;
use crate::json;
use crate::query::{QueryId, QuerySet};
use crate::timeline::Profile;
use crate::truth::frame_key;

/// A scene: `<data>/<scene>`.
#[derive(Debug, Clone)]
pub struct SceneDir(PathBuf);

impl SceneDir {
    /// `<data>/<scene>`.
    pub fn new(data: &Path, scene: &str) -> Self {
        Self(data.join(scene))
    }

    pub fn root(&self) -> &Path {
        &self.0
    }

    /// `scene.json`.
    pub fn scene(&self) -> PathBuf {
        self.0.join("scene.json")
    }

    /// What says from where the scene is seen: `scene.json`, or `capture.json` of a scene that others recorded.
    pub fn rig(&self, profile: Profile) -> PathBuf {
        if profile.is_rendered() { self.scene() } else { self.0.join(CAPTURE) }
    }

    /// `scene.usdc`.
    pub fn usd(&self) -> PathBuf {
        self.0.join("scene.usdc")
    }

    /// `tracks.json`, as the generator wrote it.
    pub fn tracks(&self) -> PathBuf {
        self.0.join("tracks.json")
    }

    /// `plan.json`: which scripts made the tracks.
    pub fn plan(&self) -> PathBuf {
        self.0.join("plan.json")
    }

    /// `SHA256SUMS` of the files of the scene.
    pub fn checksums(&self) -> PathBuf {
        self.0.join("SHA256SUMS")
    }

    /// `sheet.png`: what the cameras saw.
    pub fn sheet(&self) -> PathBuf {
        self.0.join("sheet.png")
    }

    /// `frames/<view>`.
    pub fn view(&self, view: &str) -> PathBuf {
        self.0.join("frames").join(view)
    }

    /// `frames/<view>/view.json`.
    pub fn view_card(&self, view: &str) -> PathBuf {
        self.view(view).join("view.json")
    }

    /// Reads and checks `view.json`.
    ///
    /// # Errors
    /// A file that is missing or damaged, or of no camera.
    pub fn read_view_card(&self, view: &str) -> Result<ViewCard, DataError> {
        json::read_document(&self.view_card(view))
    }

    /// `frames/<view>/<frame:04>.exr`.
    pub fn frame(&self, view: &str, frame: u32) -> PathBuf {
        self.view(view).join(format!("{}.exr", frame_key(frame)))
    }
}

/// A scene that others recorded: `<data>/<scene>`.
#[derive(Debug, Clone)]
pub struct CaptureDir(PathBuf);

impl CaptureDir {
    /// `<data>/<scene>`.
    pub fn new(data: &Path, scene: &str) -> Self {
        Self(data.join(scene))
    }

    pub fn root(&self) -> &Path {
        &self.0
    }

    /// `frames/<view>/<frame:04>.png`.
    pub fn picture(&self, view: &str, frame: u32) -> PathBuf {
        self.0.join(Capture::picture_path(view, frame))
    }

    /// `sparse`: points of the source, a COLMAP model.
    pub fn sparse(&self) -> PathBuf {
        self.0.join(SPARSE)
    }
}

/// What can be remade of a scene: `<work>/<profile>/<scene>`.
#[derive(Debug, Clone)]
pub struct WorkDir(PathBuf);

impl WorkDir {
    /// `<work>/<profile>/<scene>`.
    pub fn new(work: &Path, profile: Profile, scene: &str) -> Self {
        Self(work.join(profile.as_str()).join(scene))
    }

    /// `splats`: the model of the scene.
    pub fn splats(&self) -> PathBuf {
        self.0.join("splats")
    }

    /// `clips`: what the model shows cameras.
    pub fn clips(&self) -> PathBuf {
        self.0.join("clips")
    }

    /// `clips-sum`: the same with depth as 4DGaussians has it.
    pub fn clips_of_summed_depth(&self) -> PathBuf {
        self.0.join("clips-sum")
    }

    /// `answers/<method>/<what>`: how a method came to an answer; `what` is the number of a query, or a name that the
    /// caller makes for a sentence of the user's own.
    pub fn answer(&self, method: &str, what: &str) -> AnswerDir {
        AnswerDir(self.0.join("answers").join(method).join(what))
    }
}

/// How a method came to one answer.
#[derive(Debug, Clone)]
pub struct AnswerDir(PathBuf);

impl AnswerDir {
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self(root.into())
    }

    pub fn root(&self) -> &Path {
        &self.0
    }

    /// `grounded`: what each view says, `<view>.json`.
    pub fn grounded(&self) -> PathBuf {
        self.0.join("grounded")
    }

    /// `consensus.json`: which views are believed, and why.
    pub fn consensus(&self) -> PathBuf {
        self.0.join("consensus.json")
    }

    /// `lift`: the answer as a 4D object.
    pub fn lift(&self) -> PathBuf {
        self.0.join("lift")
    }

    /// `manifest.json`: what the answer was made from, and what its stages took.
    pub fn manifest(&self) -> PathBuf {
        self.0.join("manifest.json")
    }
}

/// A benchmark folder.
#[derive(Debug, Clone)]
pub struct BenchDir(PathBuf);

impl BenchDir {
    /// The folder that holds `panoptic-l4d.toml`.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self(root.into())
    }

    pub fn root(&self) -> &Path {
        &self.0
    }

    /// `panoptic-l4d.toml`.
    pub fn manifest(&self) -> PathBuf {
        self.0.join("panoptic-l4d.toml")
    }

    /// `scenes/<scene>.json`.
    pub fn tracks(&self, scene: &str) -> PathBuf {
        self.0.join("scenes").join(format!("{scene}.json"))
    }

    /// `queries/<scene>.jsonl`.
    pub fn queries(&self, scene: &str) -> PathBuf {
        self.0.join("queries").join(format!("{scene}.jsonl"))
    }

    /// `queries/<scene>.composite.jsonl`: queries of two categories.
    pub fn composites(&self, scene: &str) -> PathBuf {
        self.0.join("queries").join(format!("{scene}.composite.jsonl"))
    }

    /// `queries/<scene>.absent.jsonl`: sentences that nothing satisfies.
    pub fn absents(&self, scene: &str) -> PathBuf {
        self.0.join("queries").join(format!("{scene}.absent.jsonl"))
    }

    /// The file of a set of queries; the first of two.
    pub fn asked(&self, set: QuerySet, scene: &str) -> PathBuf {
        match set {
            QuerySet::Queries | QuerySet::WithAbsents => self.queries(scene),
            QuerySet::Composites => self.composites(scene),
            QuerySet::Absents => self.absents(scene),
        }
    }

    /// `recipes`: what the composed scenes are made from.
    pub fn recipes(&self) -> PathBuf {
        self.0.join("recipes")
    }

    /// `recipes/<scene>.json`: the composition of a scene that has no recipe in Python.
    pub fn composition(&self, scene: &str) -> PathBuf {
        self.recipes().join(format!("{scene}.json"))
    }

    /// The composition of a scene; none where a recipe in Python takes its place.
    ///
    /// # Errors
    /// One that is damaged.
    pub fn read_composition(&self, scene: &str) -> Result<Option<Composition>, DataError> {
        let path = self.composition(scene);
        path.exists().then(|| json::read_document(&path)).transpose()
    }

    /// `rejected/<scene>.jsonl`: draws of a composed scene that were thrown away, with the reasons.
    pub fn rejected(&self, scene: &str) -> PathBuf {
        self.0.join("rejected").join(format!("{scene}.jsonl"))
    }

    /// `published/<table>.csv`: numbers from papers.
    pub fn published(&self, table: &str) -> PathBuf {
        self.0.join("published").join(format!("{table}.csv"))
    }

    /// `vocabulary.txt`: the reviewed words of the sentences.
    pub fn vocabulary(&self) -> PathBuf {
        self.0.join("vocabulary.txt")
    }

    /// `truth/<profile>/<scene>.json`.
    pub fn truth(&self, profile: Profile, scene: &str) -> PathBuf {
        self.0.join("truth").join(profile.as_str()).join(format!("{scene}.json"))
    }
}

/// The results of one method: `results/<method>`.
#[derive(Debug, Clone)]
pub struct ResultsDir(PathBuf);

impl ResultsDir {
    /// `results/<method>`.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self(root.into())
    }

    pub fn root(&self) -> &Path {
        &self.0
    }

    /// `method.json`.
    pub fn card(&self) -> PathBuf {
        self.0.join("method.json")
    }

    /// `masks`.
    pub fn masks(&self) -> PathBuf {
        self.0.join("masks")
    }

    /// `masks/<scene>/<nnn>.json`.
    pub fn mask_file(&self, id: &QueryId) -> PathBuf {
        self.masks().join(id.scene.as_str()).join(format!("{}.json", id.number))
    }

    /// `masks/<scene>/<nnn>`: the folder of PNG masks.
    pub fn mask_folder(&self, id: &QueryId) -> PathBuf {
        self.masks().join(id.scene.as_str()).join(id.number.as_str())
    }
}
