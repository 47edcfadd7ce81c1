//! Pictures and arrays of numbers.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_formats::arrays;

use super::super::codes;
use super::super::inside::{Cut, CutError, Inside};
use super::super::picture::{self, PictureError};
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
            return Err(Problem::unreadable(
                "name",
                format!("ends with `.{other}`, but pictures are PNG"),
                "write PNG",
            ));
        }
    }
    let bytes = read_bounded(path, MAX_PICTURE_BYTES)?;
    let picture = picture::decode(&bytes).map_err(|error| match error {
        PictureError::Ambiguous(message) => ambiguous(message),
        PictureError::Damaged(_) => {
            Problem::unreadable("picture", error.to_string(), "write the picture again")
        }
    })?;
    if picture.is_palette && !matches!(reading.inside, Inside::Index(_) | Inside::Selected | Inside::Nonzero)
    {
        return Err(ambiguous(
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

fn cut_all(values: &[f32], size: (u32, u32), reading: &Reading) -> Result<Vec<Piece>, Problem> {
    let piece = |(name, cut): (Option<String>, Cut)| Piece {
        name,
        place: None,
        mask: Some(cut.mask),
        soft: cut.soft,
    };
    Ok(cuts(values, size, reading)?.into_iter().map(piece).collect())
}

fn cuts(
    values: &[f32],
    (width, height): (u32, u32),
    reading: &Reading,
) -> Result<Vec<(Option<String>, Cut)>, Problem> {
    let cut = |selected: &BTreeSet<u32>| reading.inside.cut(values, width, height, selected).map_err(problem);
    if reading.inside != Inside::Selected {
        return Ok(vec![(None, cut(&BTreeSet::new())?)]);
    }
    reading.selections.iter().map(|(name, ids)| Ok((Some(name.clone()), cut(ids)?))).collect()
}

fn problem(error: CutError) -> Problem {
    let (code, hint) = match error {
        CutError::Ambiguous(_) => {
            (codes::AMBIGUOUS_MASK, "say what is inside: --inside nonzero, \"above 127\" or \"index 3\"")
        }
        CutError::NotFinite { .. } => (
            codes::NOT_FINITE,
            "find out where the method divides by zero; numbers that are none are no answer",
        ),
        CutError::Constant(_) => (
            codes::CONSTANT,
            "the map is blank: check that the checkpoint was loaded and that the decoder belongs to the latents",
        ),
    };
    Problem { code, place: "numbers".to_owned(), message: error.to_string(), hint: hint.to_owned() }
}

fn ambiguous(message: String) -> Problem {
    let hint = "write grey PNG of 0 and 255, or say which index is meant: --inside \"index 3\"";
    Problem { code: codes::AMBIGUOUS_MASK, place: "picture".to_owned(), message, hint: hint.to_owned() }
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
