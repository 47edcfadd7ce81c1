//! The sparse points of COLMAP: `points3D.txt` and `points3D.bin`.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::error::inert;
use l4d_data::store::read_bounded;

use super::views::unit;

/// No such file is longer, bytes.
const MAX_BYTES: u64 = 1 << 30;
/// Bytes of a point without its track: id, three coordinates, colour, error, length of the track.
const POINT_BYTES: usize = 8 + 24 + 3 + 8 + 8;
/// Bytes of an entry of a track.
const TRACK_BYTES: usize = 8;

const REMEDY: &str = "give the points3D.txt or points3D.bin of a COLMAP model";

/// A position (metres) and a display colour (0 to 1).
pub type ColouredPoint = ([f32; 3], [f32; 3]);

/// Reads either form; the name says which.
///
/// # Errors
/// A file that is missing, torn, of another kind, or that holds a coordinate that is not finite.
pub fn read_points(path: &Path) -> Result<Vec<ColouredPoint>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let is_text = path.extension().is_some_and(|extension| extension == "txt");
    let points = if is_text { text(&bytes) } else { binary(&bytes) };
    let points = points.map_err(|(place, message)| DataError::invalid(path, place, message, REMEDY))?;
    if points.is_empty() {
        return Err(DataError::invalid(path, "points", "there are none", REMEDY));
    }
    Ok(points)
}

type Problem = (String, String);

fn text(bytes: &[u8]) -> Result<Vec<ColouredPoint>, Problem> {
    let problem = |number: usize, message: String| (format!("line {}", number + 1), message);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        (format!("byte {}", error.valid_up_to()), "is no text; is this the binary form?".to_owned())
    })?;
    let is_data = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.starts_with('#');
    text.lines()
        .enumerate()
        .filter(is_data)
        .map(|(number, line)| {
            let mut words = line.split_ascii_whitespace().skip(1);
            let mut number_of = |field: &str| {
                let word = words.next().ok_or_else(|| problem(number, format!("ends before {field}")))?;
                word.parse::<f64>().map_err(|_error| problem(number, format!("{field} is `{}`", inert(word))))
            };
            let position = [number_of("X")?, number_of("Y")?, number_of("Z")?];
            let colour = [number_of("R")?, number_of("G")?, number_of("B")?];
            checked(position, colour).map_err(|message| problem(number, message))
        })
        .collect()
}

fn binary(bytes: &[u8]) -> Result<Vec<ColouredPoint>, Problem> {
    let torn = |at: usize| (format!("byte {}", bytes.len()), format!("the file ends within point {at}"));
    let (count, mut rest) = bytes.split_first_chunk().ok_or_else(|| torn(0))?;
    let count = u64::from_le_bytes(*count);
    if count > (rest.len() / POINT_BYTES) as u64 {
        return Err(("byte 0".to_owned(), format!("claims {count} points, more than the file can hold")));
    }
    let mut points = Vec::with_capacity(count as usize);
    for index in 0..count as usize {
        let (point, more) = rest.split_at_checked(POINT_BYTES).ok_or_else(|| torn(index))?;
        let coordinates = point[8..32].as_chunks::<8>().0;
        let position = [0, 1, 2].map(|axis| f64::from_le_bytes(coordinates[axis]));
        let colour = [32, 33, 34].map(|place| f64::from(point[place]));
        points.push(checked(position, colour).map_err(|message| (format!("point {index}"), message))?);
        let length = u64::from_le_bytes(point[43..].as_chunks::<8>().0[0]);
        let track = usize::try_from(length).ok().and_then(|length| length.checked_mul(TRACK_BYTES));
        rest = track.and_then(|track| more.get(track..)).ok_or_else(|| torn(index))?;
    }
    if !rest.is_empty() {
        return Err(("end".to_owned(), format!("{} bytes follow the last point", rest.len())));
    }
    Ok(points)
}

fn checked(position: [f64; 3], colour: [f64; 3]) -> Result<ColouredPoint, String> {
    let position = position.map(|value| value as f32);
    if let Some(value) = position.iter().find(|value| !value.is_finite()) {
        return Err(format!("a coordinate is {value}"));
    }
    if let Some(value) = colour.iter().find(|value| !(0.0..=255.0).contains(*value)) {
        return Err(format!("a colour is {value}, but colours are 0 to 255"));
    }
    Ok((position, colour.map(|value| unit(value as u8))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(id: u64, at: f64, track: u64) -> Vec<u8> {
        let mut bytes = id.to_le_bytes().to_vec();
        for axis in 0..3 {
            bytes.extend((at + f64::from(axis)).to_le_bytes());
        }
        bytes.extend([255, 0, 51]);
        bytes.extend(0.5_f64.to_le_bytes());
        bytes.extend(track.to_le_bytes());
        bytes.extend(vec![7; track as usize * TRACK_BYTES]);
        bytes
    }

    fn file(count: u64, points: &[Vec<u8>]) -> Vec<u8> {
        [count.to_le_bytes().to_vec(), points.concat()].concat()
    }

    #[test]
    fn both_forms_say_the_same() {
        let words = "# 3D point list\n1 1 2 3 255 0 51 0.5 1 2 3 4\n\n9 4.0 5 6 255 0 51 0.5\n";
        let bytes = file(2, &[point(1, 1.0, 2), point(9, 4.0, 0)]);
        let expected = vec![([1.0, 2.0, 3.0], [1.0, 0.0, 0.2]), ([4.0, 5.0, 6.0], [1.0, 0.0, 0.2])];
        assert_eq!(text(words.as_bytes()).unwrap(), expected);
        assert_eq!(binary(&bytes).unwrap(), expected);
    }

    #[test]
    fn torn_and_hostile_files_are_refused_with_the_place() {
        let whole = file(2, &[point(1, 1.0, 2), point(9, 4.0, 1)]);
        for cut in 0..whole.len() {
            assert!(binary(&whole[..cut]).is_err(), "{cut}");
        }
        assert!(binary(&file(u64::MAX, &[])).unwrap_err().1.contains("more than"));
        let mut endless = point(1, 1.0, 0);
        endless[43..51].copy_from_slice(&u64::MAX.to_le_bytes());
        assert!(binary(&file(1, &[endless])).unwrap_err().1.contains("within point 0"));
        assert!(binary(&file(1, &[point(1, f64::NAN, 0)])).unwrap_err().1.contains("NaN"));
        assert!(binary(&[whole, vec![0]].concat()).unwrap_err().1.contains("1 bytes follow"));
        for (line, part) in [
            ("1 2 3", "line 1: ends before Z"),
            ("1 2 3 x 0 0 0", "line 1: Z is `x`"),
            ("1 2 3 4 0 300 0", "line 1: a colour is 300"),
            ("1 inf 3 4 0 0 0", "line 1: a coordinate is inf"),
        ] {
            let (place, message) = text(line.as_bytes()).unwrap_err();
            assert_eq!(format!("{place}: {message}").get(..part.len()), Some(part));
        }
    }
}
