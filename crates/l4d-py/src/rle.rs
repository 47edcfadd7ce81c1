//! Masks as text: compressed COCO run lengths, column-major, as pycocotools writes them.

use l4d_masks::Mask;
use pyo3::prelude::*;

use crate::arrays::{Array2, array2, bools, mask_from, shape_of};
use crate::error::{Failure, Result};

/// A mask, bool (H, W), as compressed COCO counts.
#[pyfunction]
pub(crate) fn rle_encode(mask: &Bound<'_, PyAny>) -> Result<String> {
    let size = match bools("mask", mask)?.as_array().shape() {
        [rows, columns] => (side(*columns)?, side(*rows)?),
        found => {
            let message = format!("has the shape {found:?}");
            return Err(Failure::argument("mask", message, "give one mask, (height, width)"));
        }
    };
    Ok(mask_from("mask", mask, size)?.to_rle().counts())
}

/// The mask, bool (H, W), of compressed COCO counts.
#[pyfunction]
pub(crate) fn rle_decode<'py>(
    py: Python<'py>,
    counts: &str,
    height: usize,
    width: usize,
) -> Result<Array2<'py, bool>> {
    let (width, height) = (side(width)?, side(height)?);
    let mask = Mask::decode(counts, width, height).map_err(|error| {
        let remedy = "give the `counts` of pycocotools' mask.encode as str, and the size of the mask";
        Failure::argument("counts", error.to_string(), remedy)
    })?;
    array2(py, mask.to_bools(), shape_of(width, height))
}

/// A side of a mask that there may be.
fn side(pixels: usize) -> Result<u32> {
    let found = u32::try_from(pixels).ok().filter(|&pixels| Mask::is_sane_size(pixels, pixels));
    found.ok_or_else(|| {
        let message = format!("{pixels} pixels are no side of a mask");
        Failure::argument("size", message, format!("sides are 1 to {} pixels", Mask::MAX_SIDE))
    })
}
