//! What the held-out view of a scene shows, as arrays of bools.

use l4d_data::{self as data, Name};
use l4d_score::truth::{SceneTruth, TruthMask};
use pyo3::prelude::*;

use crate::arrays::{Array, array, shape_of};
use crate::benchmark::Benchmark;
use crate::error::{Failure, Result, unknown};
use crate::query::query_id;

/// The truth of one scene at one profile.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Truth {
    truth: SceneTruth,
    queries: Vec<data::Query>,
    queries_path: std::path::PathBuf,
}

impl Truth {
    pub(crate) fn load(benchmark: &Benchmark, scene: &Name) -> Result<Self> {
        let Benchmark { bench, profile } = benchmark;
        let mut queries = bench.queries(scene)?;
        queries.extend(bench.composites(scene)?);
        queries.extend(bench.absents(scene)?);
        let truth = SceneTruth::load(bench, *profile, scene)?;
        Ok(Self { truth, queries, queries_path: bench.dir.queries(scene) })
    }

    fn position(&self, frame: u32) -> Result<usize> {
        self.truth.position(frame).ok_or_else(|| {
            let message = format!("{frame} is not annotated in this profile");
            Failure::argument("frame", message, "give one of `Truth.frames`")
        })
    }

    /// The query and the indices of its referents among the instances.
    fn referents(&self, query: &Bound<'_, PyAny>) -> Result<(&data::Query, Vec<usize>)> {
        let id = query_id(query)?;
        let query = self.queries.iter().find(|query| query.id == id).ok_or_else(|| {
            let message = format!("`{id}` is not asked about scene {}", self.truth.scene);
            Failure::argument("query", message, "take the truth of its scene")
        })?;
        Ok((query, self.truth.referents(query, &self.queries_path)?))
    }

    fn target(&self, query: &data::Query, referents: &[usize], position: usize) -> Vec<bool> {
        self.pixels(self.truth.target(query, referents, position).as_deref())
    }

    /// The pixels of a mask; none without one.
    fn pixels(&self, mask: Option<&TruthMask>) -> Vec<bool> {
        let nothing = || vec![false; self.shape().iter().product()];
        mask.map_or_else(nothing, |mask| mask.mask().to_bools())
    }

    fn shape(&self) -> [usize; 2] {
        shape_of([self.truth.width, self.truth.height])
    }

    /// An array over all frames.
    fn clip<'py>(&self, py: Python<'py>, pixels: Vec<bool>) -> Result<Array<'py, bool, 3>> {
        let [rows, columns] = self.shape();
        array(py, pixels, [self.truth.frames.len(), rows, columns])
    }
}

#[pymethods]
impl Truth {
    /// Scene name.
    #[getter]
    fn scene(&self) -> &str {
        &self.truth.scene
    }

    /// Annotated canonical frames, ascending.
    #[getter]
    fn frames(&self) -> Vec<u32> {
        self.truth.frames.clone()
    }

    /// Names of the annotated things, ascending by id.
    #[getter]
    fn instances(&self) -> Vec<&str> {
        self.truth.instances.iter().map(|instance| instance.name.as_str()).collect()
    }

    /// What a query asks to find at a frame: bool (H, W). No pixel where it does not hold or nothing is visible.
    fn mask<'py>(
        &self,
        py: Python<'py>,
        query: &Bound<'py, PyAny>,
        frame: u32,
    ) -> Result<Array<'py, bool, 2>> {
        let (query, referents) = self.referents(query)?;
        array(py, self.target(query, &referents, self.position(frame)?), self.shape())
    }

    /// What a query asks to find in the whole clip: bool (T, H, W), in the order of `frames`.
    fn masks<'py>(&self, py: Python<'py>, query: &Bound<'py, PyAny>) -> Result<Array<'py, bool, 3>> {
        let (query, referents) = self.referents(query)?;
        let positions = 0..self.truth.frames.len();
        let masks = positions.flat_map(|position| self.target(query, &referents, position));
        self.clip(py, masks.collect())
    }

    /// Where an annotated thing is visible in the whole clip: bool (T, H, W), in the order of `frames`.
    fn instance_masks<'py>(&self, py: Python<'py>, name: &str) -> Result<Array<'py, bool, 3>> {
        let found = self.truth.instances.iter().find(|instance| instance.name.as_str() == name);
        let instance = found.ok_or_else(|| unknown("instance", name, &self.instances()))?;
        self.clip(py, instance.masks.iter().flat_map(|mask| self.pixels(mask.as_ref())).collect())
    }

    fn __repr__(&self) -> String {
        let SceneTruth { scene, frames, width, height, .. } = &self.truth;
        format!("Truth('{scene}', {} frames, {width}x{height})", frames.len())
    }
}
