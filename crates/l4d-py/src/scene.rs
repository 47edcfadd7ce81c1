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
use crate::frame::{ClipValues, Exposure, Frame, FrameClip, wide};
use crate::instance::{Event, Instance};
use crate::timeline::Timeline;

/// A rendered scene: a folder with `scene.json` and `frames/` that `l4d build-scenes` made.
///
/// Pictures are read when they are asked for; nothing is kept in memory.
#[pyclass(frozen, module = "l4d")]
#[derive(Debug)]
pub(crate) struct Scene {
    dir: SceneDir,
    scene: data::Scene,
    exposure: Arc<Exposure>,
}

#[pymethods]
impl Scene {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> Result<Self> {
        let (Some(parent), Some(folder)) = (path.parent(), path.file_name().and_then(|name| name.to_str()))
        else {
            return Err(Failure::file(
                &path,
                "has no name",
                "give the folder of a scene, data/<profile>/<scene>",
            ));
        };
        let dir = SceneDir::new(parent, folder);
        let scene = py.detach(|| data::Scene::read(&dir.scene()))?;
        let exposure = Exposure::new(scene.exposure);
        Ok(Self { dir, scene, exposure })
    }

    /// Scene name.
    #[getter]
    fn name(&self) -> &str {
        &self.scene.name
    }

    /// `"outdoor"`, `"room"` or `"tabletop"`.
    #[getter]
    fn scale(&self) -> &'static str {
        self.scene.scale.as_str()
    }

    /// Which permutation of looks, roles, layout and cameras; 0 is the benchmark.
    #[getter]
    fn variant(&self) -> u32 {
        self.scene.variant
    }

    /// Seed of everything random in its recipe; 0 is the benchmark.
    #[getter]
    fn seed(&self) -> u64 {
        self.scene.seed
    }

    /// How much was rendered: `"tiny"`, `"small"` or `"full"`.
    #[getter]
    fn profile(&self) -> &'static str {
        self.scene.profile.as_str()
    }

    /// Columns of its pictures, pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.scene.width
    }

    /// Rows of its pictures, pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.scene.height
    }

    /// Factor on linear light before it is shown.
    #[getter]
    fn exposure(&self) -> f64 {
        self.scene.exposure
    }

    /// Canonical numbers of its frames, ascending.
    #[getter]
    fn frames(&self) -> Vec<u32> {
        self.scene.profile.frames().collect()
    }

    /// When its frames are.
    #[getter]
    fn timeline(&self) -> Result<Timeline> {
        Timeline::of(self.scene.profile)
    }

    /// All views, sorted by name; exactly one is held out.
    #[getter]
    fn cameras(&self) -> Vec<Camera> {
        self.scene.cameras.iter().map(|camera| self.seen_by(camera)).collect()
    }

    /// The views that a method may train on.
    #[getter]
    fn training_cameras(&self) -> Vec<Camera> {
        let training = self.scene.cameras.iter().filter(|camera| camera.split == Split::Train);
        training.map(|camera| self.seen_by(camera)).collect()
    }

    /// The held-out view. Methods may use its pose, never its pictures.
    #[getter]
    fn test_camera(&self) -> Result<Camera> {
        let camera = self.scene.test_camera().ok_or_else(|| {
            Failure::file(&self.dir.scene(), "has no view that is held out", "build the scene again")
        })?;
        Ok(self.seen_by(camera))
    }

    /// The view of that name.
    fn camera(&self, name: &str) -> Result<Camera> {
        Ok(self.seen_by(self.find(name)?))
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
        let view = &self.find(view)?.name;
        self.check_frames(&[frame])?;
        let path = self.dir.frame(view, frame);
        let (seen, rgb) = py.detach(|| {
            let seen = read_frame(&path, self.size())?;
            let rgb = wide(&seen.rgb);
            Ok::<_, FrameError>((seen, rgb))
        })?;
        Frame::new(py, view, frame, seen, rgb, &self.exposure)
    }

    /// What a view sees at canonical frames (all of the profile by default), read by all threads.
    #[pyo3(signature = (view, frames = None))]
    fn clip(&self, py: Python<'_>, view: &str, frames: Option<Vec<u32>>) -> Result<FrameClip> {
        let view = &self.find(view)?.name;
        let frames = frames.unwrap_or_else(|| self.scene.profile.frames().collect());
        self.check_frames(&frames)?;
        let values = py.detach(|| self.read_clip(view, &frames))?;
        FrameClip::new(py, view, frames, values, &self.exposure)
    }

    fn __repr__(&self) -> String {
        let views = self.scene.cameras.len();
        format!(
            "Scene('{}', {}, {views} views, {} frames)",
            self.scene.name,
            self.scene.profile,
            self.frames().len()
        )
    }
}

impl Scene {
    fn size(&self) -> UVec2 {
        UVec2::new(self.scene.width, self.scene.height)
    }

    fn seen_by(&self, camera: &data::Camera) -> Camera {
        Camera::new(camera, [self.scene.width, self.scene.height])
    }

    fn find(&self, view: &str) -> Result<&data::Camera> {
        let known: Vec<&str> = self.scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
        self.scene.camera(view).ok_or_else(|| unknown("view", view, &known))
    }

    fn check_frames(&self, frames: &[u32]) -> Result<()> {
        let stride = self.scene.profile.stride();
        let is_rendered = |frame: u32| self.scene.profile.frames().any(|rendered| rendered == frame);
        match frames.iter().find(|frame| !is_rendered(**frame)) {
            None => Ok(()),
            Some(frame) => Err(Failure::argument(
                "frame",
                format!("{frame} is not rendered in profile {}", self.scene.profile),
                format!("give 0, {stride}, {}, ... 96 (`Scene.frames`)", 2 * stride),
            )),
        }
    }

    fn read_clip(&self, view: &str, frames: &[u32]) -> std::result::Result<ClipValues, FrameError> {
        let pixels = self.scene.width as usize * self.scene.height as usize;
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
            let seen = read_frame(&self.dir.frame(view, frame), self.size())?;
            linear.copy_from_slice(seen.rgb.as_flattened());
            seen.rgb.as_flattened().convert_to_f32_slice(rgb);
            depth_m.copy_from_slice(&seen.surfaces.depth_m);
            id.copy_from_slice(&seen.surfaces.id);
            Ok(())
        })?;
        Ok(ClipValues { size: [self.scene.width, self.scene.height], linear, rgb, depth_m, id })
    }
}
