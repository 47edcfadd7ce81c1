//! Lists of numbers as numpy arrays, without a copy; masks from and to arrays of bools, and as text.

use l4d_masks::Mask;
use numpy::ndarray::{Dim, Dimension, IntoDimension};
use numpy::{Element, PyArray, PyArray1, PyArrayMethods as _, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use crate::error::{Failure, Result};

/// An array of `N` axes.
pub(crate) type Array<'py, T, const N: usize> = Bound<'py, PyArray<T, Dim<[usize; N]>>>;
/// The same, kept.
pub(crate) type Kept<T, const N: usize> = Py<PyArray<T, Dim<[usize; N]>>>;

/// Rows and columns of a picture of (width, height).
pub(crate) fn shape_of([width, height]: [u32; 2]) -> [usize; 2] {
    [height as usize, width as usize]
}

pub(crate) fn array<T: Element, const N: usize>(
    py: Python<'_>,
    values: Vec<T>,
    shape: [usize; N],
) -> Result<Array<'_, T, N>>
where
    [usize; N]: IntoDimension<Dim = Dim<[usize; N]>>,
    Dim<[usize; N]>: Dimension,
{
    Ok(PyArray1::from_vec(py, values).reshape(shape)?)
}

/// A mask from an array of bools of (height, width); any strides.
pub(crate) fn mask_from(field: &str, value: &Bound<'_, PyAny>, size: [u32; 2]) -> Result<Mask> {
    let pixels = bools(field, value, &shape_of(size))?;
    let array = pixels.as_array();
    Ok(Mask::from_fn(size[0], size[1], |col, row| array[[row as usize, col as usize]]))
}

/// An array of bools that the caller gave, of this shape: nothing else is guessed to be a mask.
pub(crate) fn bools<'py>(
    field: &str,
    value: &Bound<'py, PyAny>,
    shape: &[usize],
) -> Result<PyReadonlyArrayDyn<'py, bool>> {
    let Ok(array) = value.extract::<PyReadonlyArrayDyn<'py, bool>>() else {
        let found = match value.getattr("dtype") {
            Ok(dtype) => format!("is an array of {dtype}"),
            Err(_) => format!("is a {}", value.get_type()),
        };
        let hint = "give a numpy array of bool, for example `scores > 0.5`";
        return Err(Failure::argument(field, format!("{found}, but a mask is an array of bool"), hint));
    };
    check_shape(field, array.as_array().shape(), shape)?;
    Ok(array)
}

pub(crate) fn check_shape(field: &str, found: &[usize], expected: &[usize]) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    let message = format!("has the shape {found:?}, but {expected:?} is needed");
    Err(Failure::argument(field, message, "rows come first, then columns: (height, width)"))
}

/// A mask, bool (H, W), as compressed COCO counts.
#[pyfunction]
pub(crate) fn rle_encode(mask: &Bound<'_, PyAny>) -> Result<String> {
    let shape = mask.getattr("shape").and_then(|shape| shape.extract::<[usize; 2]>());
    let [rows, columns] = shape.ok().ok_or_else(|| {
        let hint = "give one mask as a numpy array of bool, (height, width)";
        Failure::argument("mask", "is no array of two axes", hint)
    })?;
    let size = [side(columns)?, side(rows)?];
    Ok(mask_from("mask", mask, size)?.to_rle().counts())
}

/// The mask, bool (H, W), of compressed COCO counts.
#[pyfunction]
pub(crate) fn rle_decode<'py>(
    py: Python<'py>,
    counts: &str,
    height: usize,
    width: usize,
) -> Result<Array<'py, bool, 2>> {
    let size = [side(width)?, side(height)?];
    let mask = Mask::decode(counts, size[0], size[1]).map_err(|error| {
        let hint = "give the `counts` of pycocotools' mask.encode as str, and the size of the mask";
        Failure::argument("counts", error.to_string(), hint)
    })?;
    array(py, mask.to_bools(), shape_of(size))
}

/// A side of a mask that there may be.
fn side(pixels: usize) -> Result<u32> {
    let found = u32::try_from(pixels).ok().filter(|&pixels| Mask::is_sane_size(pixels, pixels));
    found.ok_or_else(|| {
        let message = format!("{pixels} pixels are no side of a mask");
        Failure::argument("size", message, format!("sides are 1 to {} pixels", Mask::MAX_SIDE))
    })
}
