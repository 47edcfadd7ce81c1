//! A rendered scene: its cameras, instances and pictures.

use std::path::PathBuf;
use std::sync::Arc;

use glam::UVec2;
use half::f16;
use half::slice::HalfFloatSliceExt as _;
use l4d_data::layout::SceneDir;
use l4d_data::{self as data, Split};
use l4d_frames::exr::{FrameError, read_frame};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::error::{Failure, Result, unknown};
use crate::frame::{Exposure, Frame, FrameClip, Values};
use crate::query::{Event, Instance};
use crate::timeline::Timeline;

/// A rendered scene: a folder with `scene.json` and `frames/` that `l4d build-scenes` made.
///
/// Pictures are read when they are asked for; nothing is kept in memory.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Scene {
    /// Scene name.
    #[pyo3(get)]
    name: String,
    /// `"outdoor"`, `"room"` or `"tabletop"`.
    #[pyo3(get)]
    scale: &'static str,
    /// Which permutation of looks, roles, layout and cameras; 0 is the benchmark.
    #[pyo3(get)]
    variant: u32,
    /// Seed of everything random in its recipe; 0 is the benchmark.
    #[pyo3(get)]
    seed: u64,
    /// How much was rendered: `"tiny"`, `"small"` or `"full"`.
    #[pyo3(get)]
    profile: &'static str,
    /// Columns of its pictures, pixels.
    #[pyo3(get)]
    width: u32,
    /// Rows of its pictures, pixels.
    #[pyo3(get)]
    height: u32,
    /// Factor on linear light before it is shown.
    #[pyo3(get)]
    exposure: f64,
    /// Canonical numbers of its frames, ascending.
    #[pyo3(get)]
    frames: Vec<u32>,
    dir: SceneDir,
    scene: data::Scene,
    display: Arc<Exposure>,
}

#[pymethods]
impl Scene {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> Result<Self> {
        let (Some(parent), Some(folder)) = (path.parent(), path.file_name().and_then(|name| name.to_str()))
        else {
            let hint = "give the folder of a scene, data/<profile>/<scene>";
            return Err(Failure::file(&path, "has no name", hint));
        };
        let dir = SceneDir::new(parent, folder);
        let scene = py.detach(|| data::Scene::read(&dir.scene()))?;
        Ok(Self {
            name: scene.name.to_string(),
            scale: scene.scale.as_str(),
            variant: scene.variant,
            seed: scene.seed,
            profile: scene.profile.as_str(),
            width: scene.width,
            height: scene.height,
            exposure: scene.exposure,
            frames: scene.profile.frames().collect(),
            display: Exposure::new(scene.exposure),
            dir,
            scene,
        })
    }

    /// When its frames are.
    #[getter]
    fn timeline(&self) -> Result<Timeline> {
        Timeline::of(self.scene.profile)
    }

    /// All views, sorted by name; exactly one is held out.
    #[getter]
    fn cameras(&self) -> Vec<Camera> {
        Camera::all(&self.scene.cameras, self.size())
    }

    /// The views that a method may train on.
    #[getter]
    fn training_cameras(&self) -> Vec<Camera> {
        Camera::of_split(&self.scene.cameras, Split::Train, self.size())
    }

    /// The held-out view. Methods may use its pose, never its pictures.
    #[getter]
    fn test_camera(&self) -> Option<Camera> {
        Camera::of_split(&self.scene.cameras, Split::Test, self.size()).pop()
    }

    /// The view of that name.
    fn camera(&self, name: &str) -> Result<Camera> {
        Camera::find(&self.scene.cameras, name, self.size())
    }

    /// All annotated things, sorted by id.
    #[getter]
    fn instances(&self) -> Vec<Instance> {
        self.scene.instances.iter().map(Instance::from).collect()
    }

    /// The annotated thing of that name.
    fn instance(&self, name: &str) -> Result<Instance> {
        let known: Vec<&str> = self.scene.instances.iter().map(|instance| instance.name.as_str()).collect();
        self.scene.instance(name).map(Instance::from).ok_or_else(|| unknown("instance", name, &known))
    }

    /// Actions and interactions: part of the answers. A method must not look at them.
    #[getter]
    fn events(&self) -> Vec<Event> {
        self.scene.events.iter().map(Event::from).collect()
    }

    /// What a view sees at a canonical frame.
    fn frame(&self, py: Python<'_>, view: &str, frame: u32) -> Result<Frame> {
        self.check(view, &[frame])?;
        let path = self.dir.frame(view, frame);
        let size = UVec2::from_array(self.size());
        let values = py.detach(|| read_frame(&path, size).map(Values::from))?;
        Frame::new(py, view, frame, self.size(), values, &self.display)
    }

    /// What a view sees at canonical frames (all of the profile by default), read by all threads.
    #[pyo3(signature = (view, frames = None))]
    fn clip(&self, py: Python<'_>, view: &str, frames: Option<Vec<u32>>) -> Result<FrameClip> {
        let frames = frames.unwrap_or_else(|| self.frames.clone());
        self.check(view, &frames)?;
        let values = py.detach(|| self.read_clip(view, &frames))?;
        FrameClip::new(py, view, frames, self.size(), values, &self.display)
    }

    fn __repr__(&self) -> String {
        let Self { name, profile, frames, .. } = self;
        format!("Scene('{name}', {profile}, {} views, {} frames)", self.scene.cameras.len(), frames.len())
    }
}

impl Scene {
    fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Refuses views and frames that were not rendered.
    fn check(&self, view: &str, frames: &[u32]) -> Result<()> {
        self.camera(view)?;
        let stride = self.scene.profile.stride();
        match frames.iter().find(|frame| !self.frames.contains(frame)) {
            None => Ok(()),
            Some(frame) => Err(Failure::argument(
                "frame",
                format!("{frame} is not rendered in profile {}", self.profile),
                format!("give 0, {stride}, {}, ... 96 (`Scene.frames`)", 2 * stride),
            )),
        }
    }

    fn read_clip(&self, view: &str, frames: &[u32]) -> std::result::Result<Values, FrameError> {
        let size = UVec2::from_array(self.size());
        let pixels = size.element_product() as usize;
        let mut linear = vec![f16::ZERO; 3 * pixels * frames.len()];
        let mut rgb = vec![0.0_f32; linear.len()];
        let mut depth_m = vec![0.0_f32; pixels * frames.len()];
        let mut id = vec![0_u32; depth_m.len()];
        let places = linear
            .par_chunks_exact_mut(3 * pixels)
            .zip(rgb.par_chunks_exact_mut(3 * pixels))
            .zip(depth_m.par_chunks_exact_mut(pixels))
            .zip(id.par_chunks_exact_mut(pixels));
        places.zip(frames).try_for_each(|((((linear, rgb), depth_m), id), &frame)| {
            let seen = read_frame(&self.dir.frame(view, frame), size)?;
            linear.copy_from_slice(seen.rgb.as_flattened());
            linear.convert_to_f32_slice(rgb);
            depth_m.copy_from_slice(&seen.surfaces.depth_m);
            id.copy_from_slice(&seen.surfaces.id);
            Ok(())
        })?;
        Ok(Values { linear, rgb, depth_m, id })
    }
}
