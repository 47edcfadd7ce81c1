//! The benchmark as one profile sees it: scenes, cameras, sentences, truth.

use std::path::PathBuf;

use l4d_data::{self as data, Name, Profile, QueryId, Report, Split};
use l4d_score::EvalSet;
use pyo3::prelude::*;

use crate::camera::Camera;
use crate::error::{Failure, Result, choice, unknown};
use crate::query::{Event, Instance, Query, query_id};
use crate::timeline::{Timeline, parse_profile};
use crate::truth::Truth;

/// A benchmark folder (with `panoptic-l4d.toml`) at one profile. No render is needed: cameras come from the tracks.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Benchmark {
    pub(crate) bench: data::Benchmark,
    pub(crate) profile: Profile,
}

#[pymethods]
impl Benchmark {
    #[new]
    #[pyo3(signature = (path, profile = "small"))]
    fn new(path: PathBuf, profile: &str) -> Result<Self> {
        Ok(Self { profile: parse_profile(profile)?, bench: data::Benchmark::open(path)? })
    }

    /// Title.
    #[getter]
    fn name(&self) -> &str {
        &self.bench.manifest.name
    }

    /// Semantic version: major = changed answers, minor = additions, patch = written anew.
    #[getter]
    fn version(&self) -> &str {
        &self.bench.manifest.version
    }

    /// `"tiny"`, `"small"`, `"full"`, or `"real"` for captures.
    #[getter]
    fn profile(&self) -> &'static str {
        self.profile.as_str()
    }

    /// Columns of masks, pixels. Captures (profile `"real"`) have no common one: see `size`.
    #[getter]
    fn width(&self) -> Result<u32> {
        self.rendered().map(Profile::width)
    }

    /// Rows of masks, pixels. Captures (profile `"real"`) have no common one: see `size`.
    #[getter]
    fn height(&self) -> Result<u32> {
        self.rendered().map(Profile::height)
    }

    /// Canonical frames that a method answers, ascending. Captures (profile `"real"`) have no common ones: see `clip`.
    #[getter]
    fn frames(&self) -> Result<Vec<u32>> {
        Ok(self.rendered()?.frames().collect())
    }

    /// When these frames are.
    #[getter]
    fn timeline(&self) -> Result<Timeline> {
        Timeline::of(self.profile)
    }

    /// Columns and rows of the masks of a scene, pixels: (width, height).
    fn size(&self, scene: &str) -> Result<(u32, u32)> {
        Ok(self.asked(self.scene_named(scene)?)?.size.into())
    }

    /// Frames of a scene that masks may be of, ascending: those of the profile, or the moments of a capture.
    fn clip(&self, scene: &str) -> Result<Vec<u32>> {
        Ok(self.asked(self.scene_named(scene)?)?.clip)
    }

    /// Names of the scenes, in table order.
    #[getter]
    fn scenes(&self) -> Vec<&str> {
        self.bench.manifest.scenes.iter().map(|scene| scene.as_str()).collect()
    }

    /// SHA-256 over the truth of the profile: results carry it, so that masks of another version are refused.
    #[getter]
    fn truth_digest(&self, py: Python<'_>) -> Result<String> {
        Ok(py.detach(|| self.bench.truth_digest(self.profile))?)
    }

    /// Sentences of a scene (of all scenes by default). `set` is `"queries"` (those that count), `"composites"` (of two
    /// categories) or `"absents"` (that nothing in the scene satisfies).
    #[pyo3(signature = (scene = None, *, set = "queries"))]
    fn queries(&self, scene: Option<&str>, set: &str) -> Result<Vec<Query>> {
        Ok(self.queries_of(scene, set)?.into_iter().map(Query::from).collect())
    }

    /// The sentence of an id, `<scene>/<nnn>`, from any set.
    fn query(&self, id: &Bound<'_, PyAny>) -> Result<Query> {
        Ok(self.query_of(&query_id(id)?)?.into())
    }

    /// What the held-out view of a scene shows: the answers. Only judges, baselines and oracles look at it.
    fn truth(&self, py: Python<'_>, scene: &str) -> Result<Truth> {
        let scene = self.scene_named(scene)?;
        py.detach(|| Truth::load(self, scene))
    }

    /// Views that the profile has of a scene, sorted by name, for pictures of its size.
    fn cameras(&self, scene: &str) -> Result<Vec<Camera>> {
        let tracks = self.bench.tracks(self.scene_named(scene)?)?;
        Ok(tracks.views(self.profile).map(|camera| Camera::of_tracks(camera, self.profile)).collect())
    }

    /// The held-out view of a scene, from which every query is answered.
    fn test_camera(&self, scene: &str) -> Result<Camera> {
        let name = self.scene_named(scene)?;
        let tracks = self.bench.tracks(name)?;
        let camera = tracks.cameras.iter().find(|camera| camera.split == Split::Test).ok_or_else(|| {
            let path = self.bench.dir.tracks(name);
            Failure::file(&path, "has no view that is held out", "restore the file from the release")
        })?;
        Ok(Camera::of_tracks(camera, self.profile))
    }

    /// All annotated things of a scene, sorted by id.
    fn instances(&self, scene: &str) -> Result<Vec<Instance>> {
        let tracks = self.bench.tracks(self.scene_named(scene)?)?;
        Ok(tracks.instances.iter().map(|tracked| Instance::from(&tracked.instance())).collect())
    }

    /// Actions and interactions of a scene: part of the answers.
    fn events(&self, scene: &str) -> Result<Vec<Event>> {
        let tracks = self.bench.tracks(self.scene_named(scene)?)?;
        Ok(tracks.events.iter().map(Event::from).collect())
    }

    fn __repr__(&self) -> String {
        let data::benchmark::Manifest { name, version, scenes, .. } = &self.bench.manifest;
        format!("Benchmark('{name} {version}', {}, {} scenes)", self.profile, scenes.len())
    }
}

/// What masks of a scene must be like.
pub(crate) struct Asked {
    /// Width and height, pixels.
    pub(crate) size: [u32; 2],
    /// Frames that masks may be of, ascending.
    pub(crate) clip: Vec<u32>,
    /// Those that need no mask, ascending.
    pub(crate) unannotated: Vec<u32>,
}

impl Benchmark {
    /// What is asked of the masks of a scene.
    pub(crate) fn asked(&self, scene: &Name) -> Result<Asked> {
        let profile = self.profile;
        if profile.is_rendered() {
            let size = [profile.width(), profile.height()];
            return Ok(Asked { size, clip: profile.frames().collect(), unannotated: Vec::new() });
        }
        let truth = self.bench.truth(profile, scene)?;
        Ok(Asked { size: [truth.width, truth.height], clip: truth.clip(), unannotated: truth.unannotated })
    }

    /// The profile, if all its scenes have the same size and frames.
    fn rendered(&self) -> Result<Profile> {
        if self.profile.is_rendered() {
            return Ok(self.profile);
        }
        let hint = "ask about a scene: `Benchmark.size(scene)`, `Benchmark.clip(scene)`";
        Err(Failure::argument("profile", "captures differ in size and frames", hint))
    }

    pub(crate) fn scene_named(&self, scene: &str) -> Result<&Name> {
        Ok(self.bench.scene(scene)?)
    }

    /// Sentences of one set, of a scene or of all.
    pub(crate) fn queries_of(&self, scene: Option<&str>, set: &str) -> Result<Vec<data::Query>> {
        let read = match set {
            "queries" => data::Benchmark::queries,
            "composites" => data::Benchmark::composites,
            "absents" => data::Benchmark::absents,
            other => return Err(unknown("set", other, &["queries", "composites", "absents"])),
        };
        let scenes = match scene {
            Some(scene) => vec![self.scene_named(scene)?],
            None => self.bench.manifest.scenes.iter().collect(),
        };
        let mut queries = Vec::new();
        for scene in scenes {
            queries.extend(read(&self.bench, scene)?);
        }
        Ok(queries)
    }

    /// A sentence of any set.
    pub(crate) fn query_of(&self, id: &QueryId) -> Result<data::Query> {
        let scene = self.scene_named(&id.scene)?;
        for read in [data::Benchmark::queries, data::Benchmark::composites, data::Benchmark::absents] {
            if let Some(query) = read(&self.bench, scene)?.into_iter().find(|query| query.id == *id) {
                return Ok(query);
            }
        }
        Err(Failure::argument("query", format!("there is no `{id}`"), "see `Benchmark.queries`"))
    }

    /// What is asked of a results folder.
    pub(crate) fn eval_set(&self, set: &str, scenes: &[String], report: &mut Report) -> Result<EvalSet> {
        let set = choice("set", set, &["queries", "composites"])?;
        Ok(EvalSet::open(self.bench.clone(), self.profile, set, scenes, report)?)
    }
}
