//! Trained 4D Gaussians, and what they show a camera.

use std::path::PathBuf;
use std::sync::Mutex;

use l4d_data::{Profile, Timeline};
use l4d_frames::drawn::picture_of;
use l4d_splat::checkpoint::foreign::Moments;
use l4d_splat::clip::{ClipError, TimeViews, draw};
use l4d_splat::model::time_of_frame;
use l4d_splat::raster::{Cpu, Drawing, RasterSettings};
use l4d_splat::source::{ReaderOptions, Source};
use l4d_splat::view::View;
use numpy::PyArrayMethods as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Deserialize;

use crate::arrays::{Array, Kept, array, shape_of};
use crate::camera::Camera;
use crate::error::{Failure, Result, choice};
use crate::timeline::check_frame;

/// A model on disk: a checkpoint folder of `l4d train-splats`, a model folder of 4DGaussians, or a PLY of 3D Gaussians.
///
/// Drawn on the processor. Colours are display colours, as those that it was trained on.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Splats {
    /// Who wrote it: `"l4d"`, `"4dgaussians"` or `"ply"`.
    #[pyo3(get)]
    family: String,
    /// Scene that it was trained on, or None where it does not say so.
    #[pyo3(get)]
    scene: Option<String>,
    /// Profile of the pictures that it was trained on, or None where it does not say so.
    #[pyo3(get)]
    profile: Option<&'static str>,
    /// How many Gaussians there are.
    #[pyo3(get)]
    gaussian_count: usize,
    /// How many of them go through the deformation field.
    #[pyo3(get)]
    dynamic_count: usize,
    /// Whether it learned from rendered depth of the training views, or None where it does not say so.
    #[pyo3(get)]
    saw_depth: Option<bool>,
    /// What was ignored or assumed when it was read, a sentence each.
    #[pyo3(get)]
    notes: Vec<String>,
    source: Source,
}

#[pymethods]
impl Splats {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> Result<Self> {
        let source = py.detach(|| {
            let source = Source::open(&path, ReaderOptions::default())?;
            match source.moments {
                Some(Moments::Unknown) => Ok(source),
                _ => source.on(&path, Timeline::CANONICAL, &[]),
            }
        })?;
        Ok(Self {
            family: source.family.to_string(),
            scene: source.scene.as_ref().map(|scene| scene.to_string()),
            profile: source.profile.map(Profile::as_str),
            gaussian_count: source.model.gaussians.len(),
            dynamic_count: source.model.dynamic.len(),
            saw_depth: source.saw_depth,
            notes: source.notes.clone(),
            source,
        })
    }

    /// What a camera sees at a canonical frame, or at a time from 0 to 1 (one of the two; a camera that moves has poses at
    /// frames alone).
    ///
    /// `size` is (width, height), pixels: that of the camera by default. `background` is a display colour, each channel
    /// 0 to 1: what the model was trained to show, else black. `depth` is `"median"` (where transmittance crosses a half),
    /// `"expected"` (sum z a T / sum a T) or `"sum"` (sum z a T, as 4DGaussians has it).
    #[pyo3(signature = (camera, *, frame = None, time = None, size = None, background = None, depth = "median"))]
    #[expect(clippy::too_many_arguments, reason = "what decides how a picture looks")]
    fn render(
        &self,
        py: Python<'_>,
        camera: &Camera,
        frame: Option<u32>,
        time: Option<f32>,
        size: Option<[u32; 2]>,
        background: Option<[f32; 3]>,
        depth: &str,
    ) -> Result<Picture> {
        let instant = self.one_of(frame, time)?;
        if time.is_some() && camera.camera.world_from_camera.len() > 1 {
            let message = "is given, but the camera moves and is known at canonical frames alone";
            return Err(Failure::argument("time", message, "give a frame instead"));
        }
        let depth = Depth::parse(depth)?;
        let size = size.unwrap_or(camera.size);
        let values = py.detach(|| self.draw(camera, &[instant], size, background, depth))?;
        Picture::new(py, values, size)
    }

    /// The Gaussians as they are drawn, at a canonical frame or at a time from 0 to 1 (one of the two).
    ///
    /// float32 arrays by name: `means` (N, 3), centres in metres; `scales` (N, 3), standard deviations in metres;
    /// `rotations` (N, 4), unit quaternions (w, x, y, z) from own to world axes; `opacities` (N,), 0 to 1; `sh` (N, K, 3),
    /// spherical harmonics, the constant one first.
    #[pyo3(signature = (*, frame = None, time = None))]
    fn gaussians<'py>(
        &self,
        py: Python<'py>,
        frame: Option<u32>,
        time: Option<f32>,
    ) -> Result<Bound<'py, PyDict>> {
        let (_, time) = self.one_of(frame, time)?;
        let state = py.detach(|| self.source.model.at(time)).map_err(|error| Failure::of_chain(&error))?;
        let count = state.len();
        let harmonics = state.sh_degree().coefficients();
        let named = PyDict::new(py);
        named.set_item("means", array(py, state.means().as_flattened().to_vec(), [count, 3])?)?;
        named.set_item("scales", array(py, state.scales().as_flattened().to_vec(), [count, 3])?)?;
        named.set_item("rotations", array(py, state.rotations().as_flattened().to_vec(), [count, 4])?)?;
        named.set_item("opacities", array(py, state.opacities().to_vec(), [count])?)?;
        named.set_item("sh", array(py, state.sh().as_flattened().to_vec(), [count, harmonics, 3])?)?;
        Ok(named)
    }

    /// What a camera sees at canonical frames; arguments as in `render`. The model is deformed once a frame.
    #[pyo3(signature = (camera, frames, *, size = None, background = None, depth = "median"))]
    fn clip(
        &self,
        py: Python<'_>,
        camera: &Camera,
        frames: Vec<u32>,
        size: Option<[u32; 2]>,
        background: Option<[f32; 3]>,
        depth: &str,
    ) -> Result<PictureClip> {
        let instants = frames.iter().map(|frame| self.instant(*frame)).collect::<Result<Vec<_>>>()?;
        let depth = Depth::parse(depth)?;
        let size = size.unwrap_or(camera.size);
        let values = py.detach(|| self.draw(camera, &instants, size, background, depth))?;
        PictureClip::new(py, values, frames, size)
    }

    fn __repr__(&self) -> String {
        let Self { family, gaussian_count, dynamic_count, .. } = self;
        format!("Splats({family}, {gaussian_count} Gaussians, {dynamic_count} of them dynamic)")
    }
}

impl Splats {
    /// The frame of a camera and the time of the model, of either.
    fn one_of(&self, frame: Option<u32>, time: Option<f32>) -> Result<(u32, f32)> {
        match (frame, time) {
            (Some(frame), None) => self.instant(frame),
            (None, Some(time)) => Ok((0, time)),
            _ => {
                let message = "frame and time: exactly one is needed";
                let hint = "give a canonical frame, or a time from 0 to 1";
                Err(Failure::argument("frame", message, hint))
            }
        }
    }

    fn instant(&self, frame: u32) -> Result<(u32, f32)> {
        if self.source.moments == Some(Moments::Unknown) {
            let message = "is given, but nothing says at which times this model saw frames";
            let hint = "put the l4d-export.json of its data beside cfg_args, or give a time of its own";
            return Err(Failure::argument("frame", message, hint));
        }
        Ok((check_frame(frame)?, time_of_frame(frame)))
    }

    /// One picture for each (frame of the camera, time).
    fn draw(
        &self,
        camera: &Camera,
        instants: &[(u32, f32)],
        size: [u32; 2],
        background: Option<[f32; 3]>,
        depth: Depth,
    ) -> Result<Values> {
        let background = background.or(self.source.background).unwrap_or_default();
        let settings = RasterSettings { background, near_m: self.source.near_m, ..RasterSettings::default() };
        let view = |frame: u32| View::of_camera(&camera.camera, frame, camera.size, size);
        let moment = |&(frame, time): &(u32, f32)| {
            let view = view(frame).map_err(|error| Failure::of_chain(&error))?;
            Ok(TimeViews { time, views: vec![((), view)] })
        };
        let moments = instants.iter().map(moment).collect::<Result<Vec<_>>>()?;
        // Moments are drawn one after the other, and each has one view: the order is that of the instants.
        let drawn = Mutex::new(Vec::with_capacity(instants.len()));
        let keep = |(): &(), drawing: Drawing| {
            if let Ok(mut drawn) = drawn.lock() {
                drawn.push(Values::of(drawing, depth));
            }
            Ok::<(), ClipError>(())
        };
        draw(&self.source.model, &Cpu::new(), &settings, &moments, keep)
            .map_err(|error| Failure::of_chain(&error))?;
        Ok(Values::joined(drawn.into_inner().unwrap_or_default()))
    }
}

/// Which depth a pixel has.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Depth {
    Median,
    Expected,
    Sum,
}

impl Depth {
    fn parse(text: &str) -> Result<Self> {
        choice("depth", text, &["median", "expected", "sum"])
    }

    fn of(self, drawing: &mut Drawing) -> Vec<f32> {
        match self {
            Self::Median => drawing.quantiles.take().map(|quantiles| quantiles.median_m).unwrap_or_default(),
            Self::Expected => drawing.depth_expected_m(),
            Self::Sum => std::mem::take(&mut drawing.depth_sum_m),
        }
    }
}

/// Pictures one after another, row by row.
#[derive(Default)]
pub(crate) struct Values {
    pub(crate) rgb: Vec<f32>,
    pub(crate) depth_m: Vec<f32>,
    /// None where the pictures do not say.
    pub(crate) alpha: Option<Vec<f32>>,
}

impl Values {
    fn of(mut drawing: Drawing, depth: Depth) -> Self {
        Self {
            rgb: drawing.colour.as_flattened().to_vec(),
            depth_m: depth.of(&mut drawing),
            alpha: Some(drawing.alpha),
        }
    }

    /// Pictures of the same kind in one.
    pub(crate) fn joined(pictures: Vec<Self>) -> Self {
        let mut pictures = pictures.into_iter();
        let mut all = pictures.next().unwrap_or_default();
        for mut picture in pictures {
            all.rgb.append(&mut picture.rgb);
            all.depth_m.append(&mut picture.depth_m);
            if let (Some(all), Some(alpha)) = (&mut all.alpha, &mut picture.alpha) {
                all.append(alpha);
            }
        }
        all
    }
}

/// Display colours as bytes.
fn bytes(rgb: &[f32], [width, height]: [u32; 2]) -> Vec<u8> {
    let pixels = rgb.as_chunks::<3>().0;
    let pictures = pixels.chunks_exact(width as usize * height as usize);
    pictures.flat_map(|pixels| picture_of(width, height, pixels).into_raw()).collect()
}

/// What a model shows a camera.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Picture {
    /// Display colour over the background, not clamped: float32 (H, W, 3), 0 to 1.
    #[pyo3(get)]
    rgb: Kept<f32, 3>,
    /// Planar depth (camera z), metres: float32 (H, W); +inf where there is none.
    #[pyo3(get)]
    depth_m: Kept<f32, 2>,
    /// How much of a pixel the splats fill: float32 (H, W), 0 to 1; None where the pictures do not say.
    #[pyo3(get)]
    alpha: Option<Kept<f32, 2>>,
    size: [u32; 2],
}

impl Picture {
    fn new(py: Python<'_>, values: Values, size: [u32; 2]) -> Result<Self> {
        let shape @ [rows, columns] = shape_of(size);
        let alpha = values.alpha.map(|alpha| array(py, alpha, shape)).transpose()?;
        Ok(Self {
            rgb: array(py, values.rgb, [rows, columns, 3])?.unbind(),
            depth_m: array(py, values.depth_m, shape)?.unbind(),
            alpha: alpha.map(Bound::unbind),
            size,
        })
    }
}

#[pymethods]
impl Picture {
    /// What a screen shows: uint8 (H, W, 3).
    fn display<'py>(&self, py: Python<'py>) -> Result<Array<'py, u8, 3>> {
        let [rows, columns] = shape_of(self.size);
        let rgb = self.rgb.bind(py).to_vec().map_err(PyErr::from)?;
        array(py, py.detach(|| bytes(&rgb, self.size)), [rows, columns, 3])
    }

    fn __repr__(&self) -> String {
        format!("Picture({}x{})", self.size[0], self.size[1])
    }
}

/// What a model shows a camera, one frame after another.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct PictureClip {
    /// Canonical frames, in the order of the arrays.
    #[pyo3(get)]
    frames: Vec<u32>,
    /// Display colour over the background, not clamped: float32 (T, H, W, 3), 0 to 1.
    #[pyo3(get)]
    rgb: Kept<f32, 4>,
    /// Planar depth (camera z), metres: float32 (T, H, W); +inf where there is none.
    #[pyo3(get)]
    depth_m: Kept<f32, 3>,
    /// How much of a pixel the splats fill: float32 (T, H, W), 0 to 1; None where the pictures do not say.
    #[pyo3(get)]
    alpha: Option<Kept<f32, 3>>,
    size: [u32; 2],
}

impl PictureClip {
    pub(crate) fn new(py: Python<'_>, values: Values, frames: Vec<u32>, size: [u32; 2]) -> Result<Self> {
        let [rows, columns] = shape_of(size);
        let shape = [frames.len(), rows, columns];
        let alpha = values.alpha.map(|alpha| array(py, alpha, shape)).transpose()?;
        Ok(Self {
            rgb: array(py, values.rgb, [frames.len(), rows, columns, 3])?.unbind(),
            depth_m: array(py, values.depth_m, shape)?.unbind(),
            alpha: alpha.map(Bound::unbind),
            frames,
            size,
        })
    }
}

#[pymethods]
impl PictureClip {
    /// What a screen shows: uint8 (T, H, W, 3).
    fn display<'py>(&self, py: Python<'py>) -> Result<Array<'py, u8, 4>> {
        let [rows, columns] = shape_of(self.size);
        let rgb = self.rgb.bind(py).to_vec().map_err(PyErr::from)?;
        array(py, py.detach(|| bytes(&rgb, self.size)), [self.frames.len(), rows, columns, 3])
    }

    fn __len__(&self) -> usize {
        self.frames.len()
    }

    fn __repr__(&self) -> String {
        format!("PictureClip({} frames, {}x{})", self.frames.len(), self.size[0], self.size[1])
    }
}
