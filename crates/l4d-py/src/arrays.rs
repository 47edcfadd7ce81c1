//! Lists of numbers as numpy arrays, without a copy, and masks from and to arrays of bools.

use l4d_masks::Mask;
use numpy::{Element, Ix2, Ix3, Ix4, PyArray, PyArray1, PyArrayMethods as _, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use crate::error::{Failure, Result};

pub(crate) type Array2<'py, T> = Bound<'py, PyArray<T, Ix2>>;
pub(crate) type Array3<'py, T> = Bound<'py, PyArray<T, Ix3>>;
pub(crate) type Array4<'py, T> = Bound<'py, PyArray<T, Ix4>>;

/// Rows and columns of a picture.
pub(crate) fn shape_of(width: u32, height: u32) -> [usize; 2] {
    [height as usize, width as usize]
}

pub(crate) fn array2<T: Element>(py: Python<'_>, values: Vec<T>, shape: [usize; 2]) -> Result<Array2<'_, T>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape)?)
}

pub(crate) fn array3<T: Element>(py: Python<'_>, values: Vec<T>, shape: [usize; 3]) -> Result<Array3<'_, T>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape)?)
}

pub(crate) fn array4<T: Element>(py: Python<'_>, values: Vec<T>, shape: [usize; 4]) -> Result<Array4<'_, T>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape)?)
}

/// A mask from an array of bools of (height, width); any strides.
pub(crate) fn mask_from(field: &str, value: &Bound<'_, PyAny>, size: (u32, u32)) -> Result<Mask> {
    let pixels = bools(field, value)?;
    let array = pixels.as_array();
    let (width, height) = size;
    let expected = shape_of(width, height);
    if array.shape() != expected {
        return Err(wrong_shape(field, array.shape(), &expected));
    }
    Ok(Mask::from_fn(width, height, |col, row| array[[row as usize, col as usize]]))
}

/// An array of bools that the caller gave: nothing else is guessed to be a mask.
pub(crate) fn bools<'py>(field: &str, value: &Bound<'py, PyAny>) -> Result<PyReadonlyArrayDyn<'py, bool>> {
    value.extract().map_err(|_wrong_type| {
        let found = match value.getattr("dtype") {
            Ok(dtype) => format!("is an array of {dtype}"),
            Err(_) => format!("is a {}", value.get_type()),
        };
        let remedy = "give a numpy array of bool, for example `scores > 0.5`";
        Failure::argument(field, format!("{found}, but a mask is an array of bool"), remedy)
    })
}

pub(crate) fn wrong_shape(field: &str, found: &[usize], expected: &[usize]) -> Failure {
    let message = format!("has the shape {found:?}, but {expected:?} is needed");
    Failure::argument(field, message, "rows come first, then columns: (height, width)")
}
