//! Trajectories of the VOT toolkit: a region a frame, as text or binary.
//!
//! `vot/region/io.py` of votchallenge/toolkit. A mask is its offset, its size and run lengths along the rows, outside
//! first; what the runs do not cover is outside. Masks may reach beyond the picture, which the toolkit cuts off.

use std::path::Path;

use l4d_data::error::inert;
use l4d_data::store::read_bounded;
use l4d_masks::Mask;

use super::{Piece, Place, Problem};

const MAX_BYTES: u64 = 256 << 20;
const HINT: &str = "write what the toolkit's write_trajectory gives for masks";
/// What a binary file begins with.
const VERSION: [u8; 2] = [1, 0];

/// The regions of a file, `size` the columns and rows of the pictures.
pub(super) fn read(path: &Path, size: (u32, u32)) -> Result<Vec<Piece>, Problem> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let masks = match bytes.strip_prefix(&VERSION) {
        Some(rest) => binary(rest, size),
        None => text(&String::from_utf8_lossy(&bytes), size),
    };
    let masks = masks.map_err(|(place, message)| Problem::unreadable(place, message, HINT))?;
    let piece = |(position, mask)| Piece { name: None, place: Some(Place::Position(position)), mask };
    Ok(masks.into_iter().enumerate().map(piece).collect())
}

type Masks = Result<Vec<Option<Mask>>, (String, String)>;

fn text(text: &str, size: (u32, u32)) -> Masks {
    let region = |(index, line): (usize, &str)| {
        let fault = |message: String| (format!("line {}", index + 1), message);
        let line = line.trim();
        let Some(numbers) = line.strip_prefix('m') else {
            return match line.parse::<f64>() {
                Ok(_special) => Ok(None),
                Err(_error) => {
                    let start: String = line.chars().take(40).collect();
                    Err(fault(format!("`{}` is no mask", inert(&start))))
                }
            };
        };
        let numbers: Option<Vec<i64>> = numbers.split(',').map(|number| number.trim().parse().ok()).collect();
        let numbers = numbers.ok_or_else(|| fault("holds something that is no whole number".to_owned()))?;
        let [left, top, width, height, runs @ ..] = numbers.as_slice() else {
            return Err(fault("has no offset and size".to_owned()));
        };
        place([*left, *top, *width, *height], runs, size).map_err(fault)
    };
    text.lines().enumerate().map(region).collect()
}

fn binary(bytes: &[u8], size: (u32, u32)) -> Masks {
    let mut bytes = Bytes(bytes);
    let ends = || ("file".to_owned(), "ends within a region".to_owned());
    let count = bytes.number::<4>().ok_or_else(ends)?;
    let mut masks = Vec::new();
    for index in 0..count {
        let fault = |message: String| (format!("region {index}"), message);
        let mask = match bytes.number::<1>().ok_or_else(ends)? {
            0 => bytes.number::<4>().ok_or_else(ends).map(|_code| None)?,
            3 => {
                let offset =
                    [(); 2].map(|()| bytes.number::<2>().map(|number| i64::from(number as u16 as i16)));
                let shape = [(); 3].map(|()| bytes.number::<2>());
                let ([Some(left), Some(top)], [Some(width), Some(height), Some(runs)]) = (offset, shape)
                else {
                    return Err(ends());
                };
                let runs: Option<Vec<i64>> = (0..runs).map(|_run| bytes.number::<2>()).collect();
                place([left, top, width, height], &runs.ok_or_else(ends)?, size).map_err(fault)?
            }
            kind => return Err(fault(format!("is no mask but a region of kind {kind}"))),
        };
        masks.push(mask);
    }
    Ok(masks)
}

/// Little-endian numbers without a sign.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn number<const N: usize>(&mut self) -> Option<i64> {
        let (number, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(number.iter().rev().fold(0, |sum, &byte| sum << 8 | i64::from(byte)))
    }
}

/// A mask in the picture; none where it is empty.
fn place(
    [left, top, width, height]: [i64; 4],
    runs: &[i64],
    size: (u32, u32),
) -> Result<Option<Mask>, String> {
    let most = i64::from(Mask::MAX_SIDE);
    if !(0..=most).contains(&width) || !(0..=most).contains(&height) {
        return Err(format!("is {width}x{height}: each side must have 0 to {most} pixels"));
    }
    let mut mask = Mask::empty(size.0, size.1);
    let mut at = 0;
    for (index, &run) in runs.iter().enumerate() {
        if !(0..=width * height - at).contains(&run) {
            return Err(format!("has runs that do not fit its {width}x{height} pixels"));
        }
        let end = at + run;
        for pixel in (at..end).filter(|_| index % 2 == 1) {
            let (col, row) = (left.saturating_add(pixel % width), top.saturating_add(pixel / width));
            if (0..i64::from(size.0)).contains(&col) && (0..i64::from(size.1)).contains(&row) {
                mask.set(col as u32, row as u32, true);
            }
        }
        at = end;
    }
    Ok((!mask.is_empty()).then_some(mask))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (6, 4);

    /// A mask of 3x2 with a hole at (2, 1), a pixel that sticks out on the right, nothing, and what is no region.
    const TEXT: &str = "m2,1,3,2,0,1,1,4\nm5,0,2,1,0,2\nm0,0,0,0,0\n0\n";

    fn pixels(masks: &[Option<Mask>]) -> Vec<Vec<(u32, u32)>> {
        masks
            .iter()
            .map(|mask| mask.iter().flat_map(|mask| mask.pixels().collect::<Vec<_>>()).collect())
            .collect()
    }

    #[test]
    fn text_and_binary_say_the_same() {
        let of_text = text(TEXT, SIZE).unwrap();
        let hole = vec![(2, 1), (4, 1), (2, 2), (3, 2), (4, 2)];
        assert_eq!(pixels(&of_text), [hole, vec![(5, 0)], vec![], vec![]]);
        let mut bytes = vec![4, 0, 0, 0];
        for numbers in [&[2_i16, 1, 3, 2, 4, 0, 1, 1, 4][..], &[5, 0, 2, 1, 2, 0, 2], &[0, 0, 0, 0, 1, 0]] {
            bytes.push(3);
            bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
        bytes.extend([0, 0, 0, 0, 0]);
        assert_eq!(binary(&bytes, SIZE).unwrap(), of_text);
        for cut in 0..bytes.len() {
            assert!(binary(&bytes[..cut], SIZE).is_err(), "{cut}");
        }
    }

    #[test]
    fn what_lies_beyond_the_picture_is_cut_off() {
        let beyond = text("m9223372036854775807,-9223372036854775808,2,2,0,4\n", SIZE).unwrap();
        assert_eq!(beyond, [None]);
    }

    #[test]
    fn what_is_no_mask_is_named() {
        for (line, reason) in [
            ("1,2,3,4", "is no mask"),
            ("m1,2,3", "no offset"),
            ("m0,0,2,2,x", "no whole number"),
            ("m0,0,2,2,5", "do not fit"),
            ("m0,0,2,2,-1", "do not fit"),
            ("m0,0,2,2,1,9223372036854775807", "do not fit"),
            ("m0,0,2,99999999999,0", "each side"),
            ("", "is no mask"),
        ] {
            let (place, message) = text(&format!("0\n{line}\n"), SIZE).unwrap_err();
            assert!(place == "line 2" && message.contains(reason), "{line}: {place} {message}");
        }
    }
}
