//! What a camera saw, as arrays: one picture, or a clip of them.

use std::sync::{Arc, OnceLock};

use half::f16;
use half::slice::HalfFloatSliceExt as _;
use l4d_frames::{Display, Frame as Seen};
use pyo3::prelude::*;

use crate::arrays::{Array, Kept, array, shape_of};
use crate::error::Result;

/// How light becomes bytes in one scene; tabulated when it is first asked for.
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

/// The values of pictures, one after another and row by row.
pub(crate) struct Values {
    pub(crate) linear: Vec<f16>,
    /// The same with 32 bits a channel.
    pub(crate) rgb: Vec<f32>,
    pub(crate) depth_m: Vec<f32>,
    pub(crate) id: Vec<u32>,
}

impl From<Seen> for Values {
    fn from(Seen { surfaces, rgb: linear }: Seen) -> Self {
        let linear = linear.into_flattened();
        let rgb = linear.to_f32_vec();
        Self { linear, rgb, depth_m: surfaces.depth_m, id: surfaces.id }
    }
}

/// One picture of a scene.
///
/// `rgb` and the other arrays are made once and handed out again: copy them before writing into them.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Frame {
    /// Name of the camera.
    #[pyo3(get)]
    view: String,
    /// Canonical frame.
    #[pyo3(get)]
    frame: u32,
    /// Linear, scene-referred light: float32 (H, W, 3), red, green, blue.
    #[pyo3(get)]
    rgb: Kept<f32, 3>,
    /// Planar depth (camera z) at the pixel centre, metres: float32 (H, W); +inf where nothing is hit.
    #[pyo3(get)]
    depth_m: Kept<f32, 2>,
    /// Instance at the pixel centre: uint32 (H, W); 0 where nothing is annotated.
    #[pyo3(get)]
    id: Kept<u32, 2>,
    exposure: Arc<Exposure>,
    linear: Vec<f16>,
    shape: [usize; 2],
}

impl Frame {
    pub(crate) fn new(
        py: Python<'_>,
        view: &str,
        frame: u32,
        size: [u32; 2],
        values: Values,
        exposure: &Arc<Exposure>,
    ) -> Result<Self> {
        let shape @ [rows, columns] = shape_of(size);
        Ok(Self {
            view: view.to_owned(),
            frame,
            rgb: array(py, values.rgb, [rows, columns, 3])?.unbind(),
            depth_m: array(py, values.depth_m, shape)?.unbind(),
            id: array(py, values.id, shape)?.unbind(),
            exposure: Arc::clone(exposure),
            linear: values.linear,
            shape,
        })
    }
}

#[pymethods]
impl Frame {
    /// What a screen shows: uint8 (H, W, 3), `clamp(sRGB_OETF(exposure * rgb))`.
    fn display<'py>(&self, py: Python<'py>) -> Result<Array<'py, u8, 3>> {
        let [rows, columns] = self.shape;
        array(py, py.detach(|| self.exposure.bytes(&self.linear)), [rows, columns, 3])
    }

    fn __repr__(&self) -> String {
        format!("Frame('{}', {}, {}x{})", self.view, self.frame, self.shape[1], self.shape[0])
    }
}

/// Pictures of one camera, one after another.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct FrameClip {
    /// Name of the camera.
    #[pyo3(get)]
    view: String,
    /// Canonical frames, in the order of the arrays.
    #[pyo3(get)]
    frames: Vec<u32>,
    /// Linear, scene-referred light: float32 (T, H, W, 3), red, green, blue.
    #[pyo3(get)]
    rgb: Kept<f32, 4>,
    /// Planar depth (camera z) at the pixel centre, metres: float32 (T, H, W); +inf where nothing is hit.
    #[pyo3(get)]
    depth_m: Kept<f32, 3>,
    /// Instance at the pixel centre: uint32 (T, H, W); 0 where nothing is annotated.
    #[pyo3(get)]
    id: Kept<u32, 3>,
    exposure: Arc<Exposure>,
    linear: Vec<f16>,
    shape: [usize; 3],
}

impl FrameClip {
    pub(crate) fn new(
        py: Python<'_>,
        view: &str,
        frames: Vec<u32>,
        size: [u32; 2],
        values: Values,
        exposure: &Arc<Exposure>,
    ) -> Result<Self> {
        let [rows, columns] = shape_of(size);
        let shape = [frames.len(), rows, columns];
        Ok(Self {
            view: view.to_owned(),
            rgb: array(py, values.rgb, [frames.len(), rows, columns, 3])?.unbind(),
            depth_m: array(py, values.depth_m, shape)?.unbind(),
            id: array(py, values.id, shape)?.unbind(),
            frames,
            exposure: Arc::clone(exposure),
            linear: values.linear,
            shape,
        })
    }
}

#[pymethods]
impl FrameClip {
    /// What a screen shows: uint8 (T, H, W, 3), `clamp(sRGB_OETF(exposure * rgb))`.
    fn display<'py>(&self, py: Python<'py>) -> Result<Array<'py, u8, 4>> {
        let [count, rows, columns] = self.shape;
        array(py, py.detach(|| self.exposure.bytes(&self.linear)), [count, rows, columns, 3])
    }

    fn __len__(&self) -> usize {
        self.frames.len()
    }

    fn __repr__(&self) -> String {
        let [count, rows, columns] = self.shape;
        format!("FrameClip('{}', {count} frames, {columns}x{rows})", self.view)
    }
}
