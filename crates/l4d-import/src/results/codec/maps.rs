//! Pictures and arrays of numbers.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_formats::arrays;

use super::super::inside::Inside;
use super::super::picture;
use super::{Piece, Problem, Reading, sane};

/// No picture of a mask is larger: an uncompressed one of 4K in 16 bits fits.
const MAX_PICTURE_BYTES: u64 = 32 << 20;

pub(super) fn read_picture(path: &Path, reading: &Reading) -> Result<Vec<Piece>, Problem> {
    match arrays::extension(path).as_str() {
        "png" => {}
        "jpg" | "jpeg" => {
            let hint = "write PNG: JPEG rings around outlines, and thresholds move them";
            return Err(Problem::unreadable("file", "is a JPEG, which is no exact mask", hint));
        }
        "mp4" | "avi" | "gif" | "webm" | "mov" => {
            let hint = "write a PNG a frame: a video is lossy and does not say which frame is which";
            return Err(Problem::unreadable("file", "is a video, which is no exact mask", hint));
        }
        other => {
            let message = format!("ends with `.{other}`, but pictures are PNG");
            return Err(Problem::unreadable("name", message, "write PNG"));
        }
    }
    let bytes = read_bounded(path, MAX_PICTURE_BYTES)?;
    let picture = picture::decode(&bytes)?;
    if picture.is_palette && !matches!(reading.inside, Inside::Index(_) | Inside::Selected | Inside::Nonzero)
    {
        return Err(picture::ambiguous(
            "is a palette picture, whose indices are names of things and no truth values".to_owned(),
        ));
    }
    let size = (picture.width, picture.height);
    cut_all(&picture.values, size, reading)
}

/// Rows and columns; every other axis has length 1.
pub(super) fn read_array(path: &Path, reading: &Reading) -> Result<Vec<Piece>, Problem> {
    let array = arrays::read(path, reading.key.as_deref())?;
    let (rows, columns) = rows_and_columns(&array.shape).ok_or_else(|| {
        let message = format!("{:?} has several axes beside rows and columns", array.shape);
        Problem::unreadable("shape", message, "write one file per frame and sentence, of rows and columns")
    })?;
    let size = sane(columns as u64, rows as u64, "shape")?;
    cut_all(&array.data, size, reading)
}

fn rows_and_columns(shape: &[usize]) -> Option<(usize, usize)> {
    let mut long = shape.iter().copied().filter(|&length| length != 1);
    match (long.next(), long.next(), long.next()) {
        (Some(rows), Some(columns), None) => Some((rows, columns)),
        _ => <[usize; 2]>::try_from(shape).ok().map(|[rows, columns]| (rows, columns)),
    }
}

fn cut_all(values: &[f32], (width, height): (u32, u32), reading: &Reading) -> Result<Vec<Piece>, Problem> {
    let cut = |name: Option<String>, selected: &BTreeSet<u32>| {
        let mask = reading.inside.cut(values, width, height, selected)?;
        Ok(Piece { name, place: None, mask: Some(mask) })
    };
    if reading.inside != Inside::Selected {
        return Ok(vec![cut(None, &BTreeSet::new())?]);
    }
    reading.selections.iter().map(|(name, ids)| cut(Some(name.clone()), ids)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_length_one_are_left_out() {
        for (shape, size) in [
            (&[4, 6][..], Some((4, 6))),
            (&[1, 6], Some((1, 6))),
            (&[4, 6, 1], Some((4, 6))),
            (&[1, 4, 6], Some((4, 6))),
            (&[3, 4, 6], None),
            (&[6], None),
        ] {
            assert_eq!(rows_and_columns(shape), size, "{shape:?}");
        }
    }
}
