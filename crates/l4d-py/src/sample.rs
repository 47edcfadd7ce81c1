//! Members of released samples as arrays: what a training loop decodes.

use l4d_frames::drawn::decode_colour as colour_of;
use l4d_frames::photo::{self, PhotoError};
use l4d_frames::sample;
use pyo3::prelude::*;

use crate::arrays::{Array, array, shape_of};
use crate::error::{Failure, Result};

/// Colours of the member `png` of a sample: uint8 (H, W, 3), what a screen shows.
#[pyfunction]
pub(crate) fn decode_colour<'py>(py: Python<'py>, png: &[u8]) -> Result<Array<'py, u8, 3>> {
    let (size, values) = py
        .detach(|| -> std::result::Result<_, PhotoError> {
            let (width, height) = photo::size(png)?;
            Ok(([width, height], colour_of(png, width, height)?.into_raw()))
        })
        .map_err(refuse)?;
    let [rows, columns] = shape_of(size);
    array(py, values, [rows, columns, 3])
}

/// Planar depth of the member `depth.png` of a sample, metres: float32 (H, W); +inf where nothing is hit.
///
/// `scale_m` is `depth_scale_m` of the sample. With `rest`, the member `depth_rest.png`, depth is what was rendered to the last
/// bit; without it, it is off by half of `scale_m` at most.
#[pyfunction]
#[pyo3(signature = (png, scale_m, rest = None))]
pub(crate) fn decode_depth<'py>(
    py: Python<'py>,
    png: &[u8],
    scale_m: f32,
    rest: Option<&[u8]>,
) -> Result<Array<'py, f32, 2>> {
    let (size, values) = py
        .detach(|| -> std::result::Result<_, PhotoError> {
            let (width, height) = photo::size(png)?;
            Ok(([width, height], sample::depth(png, rest, [width, height], scale_m)?))
        })
        .map_err(refuse)?;
    array(py, values, shape_of(size))
}

/// Instance ids of the member `ids.png` of a sample: uint32 (H, W); 0 where nothing is annotated.
#[pyfunction]
pub(crate) fn decode_ids<'py>(py: Python<'py>, png: &[u8]) -> Result<Array<'py, u32, 2>> {
    let (size, values) = py
        .detach(|| -> std::result::Result<_, PhotoError> {
            let (width, height) = photo::size(png)?;
            Ok(([width, height], sample::ids(png, [width, height])?))
        })
        .map_err(refuse)?;
    array(py, values, shape_of(size))
}

fn refuse(error: PhotoError) -> Failure {
    Failure::argument("png", error.to_string(), "give the bytes of that member of a sample, whole")
}
