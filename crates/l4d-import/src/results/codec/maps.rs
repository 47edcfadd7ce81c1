//! Pictures and arrays of numbers.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_formats::arrays;
use l4d_formats::npy::Array;
use serde::{Deserialize, Serialize};

use super::super::codes;
use super::super::inside::{Cut, CutError, Inside};
use super::super::picture::{self, PictureError};
use super::{Piece, Place, Problem, Reading, sane};

/// No picture of a mask is larger: an uncompressed one of 4K in 16 bits fits.
const MAX_PICTURE_BYTES: u64 = 32 << 20;

/// What an axis of an array counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Frames of the clip, in order.
    Frame,
    /// Sentences, in the order of a list.
    Prompt,
    /// Levels, of which the one with the highest peak answers.
    Level,
    /// Rows.
    Row,
    /// Columns.
    Col,
    /// Always 1.
    One,
}

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
        PictureError::Colours { .. } | PictureError::Alpha => ambiguous(error.to_string()),
        PictureError::Damaged(_) | PictureError::Size(..) => {
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

pub(super) fn read_array(path: &Path, reading: &Reading) -> Result<Vec<Piece>, Problem> {
    let array = arrays::read(path, reading.key.as_deref())?;
    let axes = match &reading.axes {
        Some(axes) => axes.clone(),
        None => guess(&array.shape).ok_or_else(|| {
            let message = format!("{:?} has several axes beside rows and columns", array.shape);
            Problem::unreadable("shape", message, "say what the axes are, for example --axes level,row,col")
        })?,
    };
    let layout = Layout::new(&array, &axes)?;
    let mut pieces = Vec::new();
    for frame in 0..layout.length(Axis::Frame) {
        for prompt in 0..layout.length(Axis::Prompt) {
            let place = axes.contains(&Axis::Frame).then_some(Place::Position(frame));
            let name = axes.contains(&Axis::Prompt).then(|| reading.prompts.get(prompt).cloned());
            let name =
                name.map(|name| name.ok_or_else(|| no_prompt(prompt, reading.prompts.len()))).transpose()?;
            let levels =
                (0..layout.length(Axis::Level)).map(|level| layout.picture(&array, [frame, prompt, level]));
            pieces.extend(best_level(levels, layout.size, name, place, reading)?);
        }
    }
    Ok(pieces)
}

/// The level with the highest peak answers; where ids are selected there is one answer a sentence.
fn best_level(
    levels: impl Iterator<Item = Vec<f32>>,
    size: (u32, u32),
    name: Option<String>,
    place: Option<Place>,
    reading: &Reading,
) -> Result<Vec<Piece>, Problem> {
    let mut best: Vec<(Option<String>, Cut)> = Vec::new();
    for (level, values) in levels.enumerate() {
        let cuts = cuts(&values, size, reading)?;
        if level == 0 {
            best = cuts;
            continue;
        }
        for (best, cut) in best.iter_mut().zip(cuts) {
            if cut.1.peak > best.1.peak {
                *best = cut;
            }
        }
    }
    let piece = |(own, cut): (Option<String>, Cut)| Piece {
        name: own.or_else(|| name.clone()),
        place,
        mask: Some(cut.mask),
        soft: cut.soft,
    };
    Ok(best.into_iter().map(piece).collect())
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

fn no_prompt(index: usize, known: usize) -> Problem {
    let message = format!("has a prompt {index}, but {known} sentences are listed");
    Problem::unreadable(
        "shape",
        message,
        "list the sentences in the order of the axis: --prompts <file>, one a line",
    )
}

/// Rows and columns where every other axis has length 1.
fn guess(shape: &[usize]) -> Option<Vec<Axis>> {
    let mut axes = vec![Axis::One; shape.len()];
    let mut long = (0..shape.len()).filter(|&axis| shape[axis] != 1);
    let (row, col) = match (long.next(), long.next(), long.next()) {
        (Some(row), Some(col), None) => (row, col),
        _ if shape.len() == 2 => (0, 1),
        _ => return None,
    };
    (axes[row], axes[col]) = (Axis::Row, Axis::Col);
    Some(axes)
}

/// Where the numbers of a picture lie within an array.
struct Layout {
    /// Axis, its length, and numbers from one to the next.
    axes: Vec<(Axis, usize, usize)>,
    size: (u32, u32),
}

impl Layout {
    fn new(array: &Array, axes: &[Axis]) -> Result<Self, Problem> {
        let fault = |message: String| {
            Problem::unreadable("shape", message, "say what the axes are, for example --axes frame,row,col")
        };
        if axes.len() != array.shape.len() {
            return Err(fault(format!(
                "{:?} has {} axes, but {} are named",
                array.shape,
                array.shape.len(),
                axes.len()
            )));
        }
        let count = |wanted: Axis| axes.iter().filter(|axis| **axis == wanted).count();
        if count(Axis::Row) != 1 || count(Axis::Col) != 1 {
            return Err(fault("needs exactly one axis of rows and one of columns".to_owned()));
        }
        if [Axis::Frame, Axis::Prompt, Axis::Level].into_iter().any(|axis| count(axis) > 1) {
            return Err(fault("names an axis twice".to_owned()));
        }
        let mut stride = 1;
        let mut laid = Vec::new();
        for (&axis, &length) in axes.iter().zip(&array.shape).rev() {
            if axis == Axis::One && length != 1 {
                return Err(fault(format!("{:?} has {length} where 1 is said to be", array.shape)));
            }
            laid.push((axis, length, stride));
            stride *= length;
        }
        let side = |wanted: Axis| {
            laid.iter().find(|(axis, ..)| *axis == wanted).map_or(1, |(_, length, _)| *length as u64)
        };
        let size = sane(side(Axis::Col), side(Axis::Row), "shape")?;
        Ok(Self { axes: laid, size })
    }

    fn length(&self, wanted: Axis) -> usize {
        self.axes.iter().find(|(axis, ..)| *axis == wanted).map_or(1, |(_, length, _)| *length)
    }

    fn stride(&self, wanted: Axis) -> usize {
        self.axes.iter().find(|(axis, ..)| *axis == wanted).map_or(0, |(_, _, stride)| *stride)
    }

    /// The picture of a frame, a sentence and a level, row by row.
    fn picture(&self, array: &Array, [frame, prompt, level]: [usize; 3]) -> Vec<f32> {
        let first = frame * self.stride(Axis::Frame)
            + prompt * self.stride(Axis::Prompt)
            + level * self.stride(Axis::Level);
        let (down, right) = (self.stride(Axis::Row), self.stride(Axis::Col));
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let pixels = (0..height).flat_map(|row| (0..width).map(move |col| first + row * down + col * right));
        pixels.map(|index| array.data[index]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_length_one_are_left_out_and_others_are_asked_for() {
        use Axis::{Col, One, Row};
        assert_eq!(guess(&[4, 6]).unwrap(), [Row, Col]);
        assert_eq!(guess(&[1, 6]).unwrap(), [Row, Col]);
        assert_eq!(guess(&[4, 6, 1]).unwrap(), [Row, Col, One]);
        assert_eq!(guess(&[1, 4, 6]).unwrap(), [One, Row, Col]);
        assert_eq!(guess(&[3, 4, 6]), None);
        assert_eq!(guess(&[6]), None);
    }

    #[test]
    fn pictures_are_gathered_from_any_order_of_axes() {
        // Columns first, then levels, then rows: 2 columns, 2 levels, 3 rows.
        let array = Array { shape: vec![2, 2, 3], data: (0..12).map(|n| n as f32).collect() };
        let layout = Layout::new(&array, &[Axis::Col, Axis::Level, Axis::Row]).unwrap();
        assert_eq!(layout.size, (2, 3));
        assert_eq!(layout.picture(&array, [0, 0, 1]), [3.0, 9.0, 4.0, 10.0, 5.0, 11.0]);
        assert!(Layout::new(&array, &[Axis::Col, Axis::Level]).is_err());
        assert!(Layout::new(&array, &[Axis::One, Axis::Col, Axis::Row]).is_err());
        assert!(Layout::new(&array, &[Axis::Row, Axis::Row, Axis::Col]).is_err());
    }
}
