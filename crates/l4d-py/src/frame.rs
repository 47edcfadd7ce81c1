//! What a camera saw, as arrays: one picture, or a clip of them.

use std::sync::{Arc, OnceLock};

use half::f16;
use half::slice::HalfFloatSliceExt as _;
use l4d_frames::{Display, Frame as Seen};
use pyo3::prelude::*;

use crate::arrays::{Array2, Array3, Array4, array2, array3, array4, shape_of};
use crate::error::Result;
use numpy::{Ix2, Ix3, Ix4, PyArray};

/// How light becomes bytes in one scene; tabulated when it is first asked for.
#[derive(Debug)]
pub(crate) struct Exposure {
    exposure: f64,
    display: OnceLock<Display>,
}

impl Exposure {
    pub(crate) fn new(exposure: f64) -> Arc<Self> {
        Arc::new(Self { exposure, display: OnceLock::new() })
    }

    fn bytes(&self, linear: &[f16]) -> Vec<u8> {
        let display = self.display.get_or_init(|| Display::new(self.exposure));
        linear.iter().map(|&value| display.byte(value)).collect()
    }
}

/// One picture of a scene.
///
/// `rgb` and the other arrays are made once and handed out again: copy them before writing into them.
#[pyclass(frozen, module = "l4d")]
#[derive(Debug)]
pub(crate) struct Frame {
    view: String,
    frame: u32,
    exposure: Arc<Exposure>,
    linear: Vec<[f16; 3]>,
    size: [usize; 2],
    rgb: Py<PyArray<f32, Ix3>>,
    depth_m: Py<PyArray<f32, Ix2>>,
    id: Py<PyArray<u32, Ix2>>,
}

impl Frame {
    pub(crate) fn new(
        py: Python<'_>,
        view: &str,
        frame: u32,
        seen: Seen,
        rgb: Vec<f32>,
        exposure: &Arc<Exposure>,
    ) -> Result<Self> {
        let Seen { surfaces, rgb: linear } = seen;
        let size = shape_of(surfaces.width, surfaces.height);
        Ok(Self {
            view: view.to_owned(),
            frame,
            exposure: Arc::clone(exposure),
            linear,
            size,
            rgb: array3(py, rgb, [size[0], size[1], 3])?.unbind(),
            depth_m: array2(py, surfaces.depth_m, size)?.unbind(),
            id: array2(py, surfaces.id, size)?.unbind(),
        })
    }
}

#[pymethods]
impl Frame {
    /// Name of the camera.
    #[getter]
    fn view(&self) -> &str {
        &self.view
    }

    /// Canonical frame.
    #[getter]
    fn frame(&self) -> u32 {
        self.frame
    }

    /// Linear, scene-referred light: float32 (H, W, 3), red, green, blue.
    #[getter]
    fn rgb<'py>(&self, py: Python<'py>) -> Array3<'py, f32> {
        self.rgb.bind(py).clone()
    }

    /// Planar depth (camera z) at the pixel centre, metres: float32 (H, W); +inf where nothing is hit.
    #[getter]
    fn depth_m<'py>(&self, py: Python<'py>) -> Array2<'py, f32> {
        self.depth_m.bind(py).clone()
    }

    /// Instance at the pixel centre: uint32 (H, W); 0 where nothing is annotated.
    #[getter]
    fn id<'py>(&self, py: Python<'py>) -> Array2<'py, u32> {
        self.id.bind(py).clone()
    }

    /// What a screen shows: uint8 (H, W, 3), `clamp(sRGB_OETF(exposure * rgb))`.
    fn display<'py>(&self, py: Python<'py>) -> Result<Array3<'py, u8>> {
        let bytes = py.detach(|| self.exposure.bytes(self.linear.as_flattened()));
        array3(py, bytes, [self.size[0], self.size[1], 3])
    }

    fn __repr__(&self) -> String {
        format!("Frame('{}', {}, {}x{})", self.view, self.frame, self.size[1], self.size[0])
    }
}

/// Pictures of one camera, one after another.
#[pyclass(frozen, module = "l4d")]
#[derive(Debug)]
pub(crate) struct FrameClip {
    view: String,
    frames: Vec<u32>,
    exposure: Arc<Exposure>,
    linear: Vec<f16>,
    size: [usize; 2],
    rgb: Py<PyArray<f32, Ix4>>,
    depth_m: Py<PyArray<f32, Ix3>>,
    id: Py<PyArray<u32, Ix3>>,
}

/// The values of a clip, frame by frame and row by row.
pub(crate) struct ClipValues {
    pub(crate) size: [u32; 2],
    pub(crate) linear: Vec<f16>,
    pub(crate) rgb: Vec<f32>,
    pub(crate) depth_m: Vec<f32>,
    pub(crate) id: Vec<u32>,
}

impl FrameClip {
    pub(crate) fn new(
        py: Python<'_>,
        view: &str,
        frames: Vec<u32>,
        values: ClipValues,
        exposure: &Arc<Exposure>,
    ) -> Result<Self> {
        let size = shape_of(values.size[0], values.size[1]);
        let (count, [rows, columns]) = (frames.len(), size);
        Ok(Self {
            view: view.to_owned(),
            frames,
            exposure: Arc::clone(exposure),
            linear: values.linear,
            size,
            rgb: array4(py, values.rgb, [count, rows, columns, 3])?.unbind(),
            depth_m: array3(py, values.depth_m, [count, rows, columns])?.unbind(),
            id: array3(py, values.id, [count, rows, columns])?.unbind(),
        })
    }
}

#[pymethods]
impl FrameClip {
    /// Name of the camera.
    #[getter]
    fn view(&self) -> &str {
        &self.view
    }

    /// Canonical frames, in the order of the arrays.
    #[getter]
    fn frames(&self) -> Vec<u32> {
        self.frames.clone()
    }

    /// Linear, scene-referred light: float32 (T, H, W, 3), red, green, blue.
    #[getter]
    fn rgb<'py>(&self, py: Python<'py>) -> Array4<'py, f32> {
        self.rgb.bind(py).clone()
    }

    /// Planar depth (camera z) at the pixel centre, metres: float32 (T, H, W); +inf where nothing is hit.
    #[getter]
    fn depth_m<'py>(&self, py: Python<'py>) -> Array3<'py, f32> {
        self.depth_m.bind(py).clone()
    }

    /// Instance at the pixel centre: uint32 (T, H, W); 0 where nothing is annotated.
    #[getter]
    fn id<'py>(&self, py: Python<'py>) -> Array3<'py, u32> {
        self.id.bind(py).clone()
    }

    /// What a screen shows: uint8 (T, H, W, 3), `clamp(sRGB_OETF(exposure * rgb))`.
    fn display<'py>(&self, py: Python<'py>) -> Result<Array4<'py, u8>> {
        let bytes = py.detach(|| self.exposure.bytes(&self.linear));
        array4(py, bytes, [self.frames.len(), self.size[0], self.size[1], 3])
    }

    fn __len__(&self) -> usize {
        self.frames.len()
    }

    fn __repr__(&self) -> String {
        let [rows, columns] = self.size;
        format!("FrameClip('{}', {} frames, {columns}x{rows})", self.view, self.frames.len())
    }
}

/// The light of a picture with 32 bits a channel.
pub(crate) fn wide(linear: &[[f16; 3]]) -> Vec<f32> {
    let mut rgb = vec![0.0; linear.len() * 3];
    linear.as_flattened().convert_to_f32_slice(&mut rgb);
    rgb
}
