//! `.npy` files: a header in Python's notation, then the numbers.
//!
//! Objects, records and big-endian numbers are refused: the first are pickles, and the others are rare. The size that a
//! header claims is checked against the bytes that follow before anything is allocated.

use std::path::Path;

use half::f16;
use l4d_data::DataError;

use crate::fault::{Fault, quoted};
use crate::python::{self, Literal};
use crate::tensor::element_count;

/// First bytes of every such file.
const MAGIC: &[u8] = b"\x93NUMPY";
/// Bytes of a header: a shape of 32 axes takes under 1000.
const LONGEST_HEADER: usize = 1 << 16;
/// Axes of an array; numpy has no more either.
const MOST_AXES: usize = 32;
/// Characters of a text: sentences are far shorter.
const LONGEST_TEXT: usize = 4096;
/// What to do about a file that is refused.
pub(crate) const REMEDY: &str =
    "write the array again, as plain numbers: numpy.save(path, numpy.ascontiguousarray(a, '<f4'))";

/// Numbers with a shape, the last axis fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Array<T = f32> {
    /// Length along each axis; none for a single number.
    pub shape: Vec<usize>,
    /// The numbers, as many as the product of `shape`.
    pub data: Vec<T>,
}

/// What an array holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Contents<T = f32> {
    /// Numbers of any type.
    Numbers(Array<T>),
    /// Texts, in order.
    Text(Vec<String>),
}

/// Floating point that numbers are read into.
pub trait Real: Copy {
    /// A whole number; none if it cannot be held exactly.
    fn of_whole(value: i64) -> Option<Self>;
    /// The nearest to a number.
    fn of_float(value: f64) -> Self;
}

impl Real for f32 {
    fn of_whole(value: i64) -> Option<Self> {
        (value.unsigned_abs() <= 1 << 24).then_some(value as Self)
    }

    fn of_float(value: f64) -> Self {
        value as Self
    }
}

impl Real for f64 {
    fn of_whole(value: i64) -> Option<Self> {
        (value.unsigned_abs() <= 1 << 53).then_some(value as Self)
    }

    fn of_float(value: f64) -> Self {
        value
    }
}

/// 64-bit floats in C order as the bytes of a `.npy` file, as `numpy.save` writes them.
pub fn encode_f64(shape: &[usize], values: &[f64]) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let mut text =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}{comma}), }}", sides.join(", "));
    // Numbers begin at a multiple of 64 bytes, after a line feed.
    let unpadded = MAGIC.len() + 4 + text.len() + 1;
    text.push_str(&" ".repeat(unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let mut bytes = [MAGIC, &[1, 0], &(text.len() as u16).to_le_bytes(), text.as_bytes()].concat();
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

impl<T: Real> Array<T> {
    /// Reads the bytes of a file that holds numbers.
    ///
    /// # Errors
    /// Text, and everything that [`decode`] refuses.
    pub fn decode(path: &Path, bytes: &[u8]) -> Result<Self, DataError> {
        match decode(bytes).map_err(|fault| fault.at(path))? {
            Contents::Numbers(array) => Ok(array),
            Contents::Text(_) => {
                Err(DataError::invalid(path, "dtype", "is text where numbers belong", REMEDY))
            }
        }
    }
}

/// The array in the bytes of a file.
///
/// # Errors
/// Objects, records, big-endian numbers, a size that is not the file's, whole numbers that do not fit exactly.
pub fn decode<T: Real>(bytes: &[u8]) -> Result<Contents<T>, Fault> {
    let (header, body) = split(bytes)?;
    let header = Header::parse(header)?;
    let count = element_count(&header.shape)
        .ok_or_else(|| Fault::new("header, `shape`", format!("{:?} is no size", header.shape), REMEDY))?;
    let needed = count.checked_mul(header.element.size());
    if needed != Some(body.len()) {
        return Err(Fault::new(
            "header, `shape`",
            format!(
                "{:?} of {} bytes each does not fit the {} bytes that follow",
                header.shape,
                header.element.size(),
                body.len()
            ),
            "copy or write the file again: it is cut, or its header lies",
        ));
    }
    if let Element::Text(length) = header.element {
        return texts(body, length).map(Contents::Text);
    }
    let data: Vec<T> = numbers(body, header.element)?;
    let data = if header.fortran_order { to_last_axis_fastest(&data, &header.shape) } else { data };
    Ok(Contents::Numbers(Array { shape: header.shape, data }))
}

fn split(bytes: &[u8]) -> Result<(&[u8], &[u8]), Fault> {
    let cut = || Fault::new("first bytes", "are not those of a .npy file", REMEDY);
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(cut)?;
    let (length, rest) = match *rest {
        [1, _, a, b, ref rest @ ..] => (usize::from(u16::from_le_bytes([a, b])), rest),
        [2 | 3, _, a, b, c, d, ref rest @ ..] => (u32::from_le_bytes([a, b, c, d]) as usize, rest),
        _ => return Err(cut()),
    };
    if length > LONGEST_HEADER {
        return Err(Fault::new("header", format!("claims {length} bytes"), REMEDY));
    }
    rest.split_at_checked(length).ok_or_else(|| Fault::new("header", "is cut", REMEDY))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Element {
    Bool,
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
    /// Text of so many characters of four bytes each.
    Text(usize),
}

impl Element {
    fn parse(descr: &str) -> Result<Self, Fault> {
        let fault = |message: String| Fault::new("header, `descr`", message, REMEDY);
        Ok(match descr {
            "|b1" => Self::Bool,
            "|u1" => Self::U8,
            "|i1" => Self::I8,
            "<u2" => Self::U16,
            "<i2" => Self::I16,
            "<u4" => Self::U32,
            "<i4" => Self::I32,
            "<u8" => Self::U64,
            "<i8" => Self::I64,
            "<f2" => Self::F16,
            "<f4" => Self::F32,
            "<f8" => Self::F64,
            _ if descr.starts_with("|O") => {
                return Err(fault("is `|O`: Python objects, which would have to be executed".to_owned()));
            }
            _ if descr.starts_with('>') => return Err(fault(format!("{} is big-endian", quoted(descr)))),
            _ => match descr.strip_prefix("<U").and_then(|length| length.parse().ok()) {
                Some(length @ 1..=LONGEST_TEXT) => Self::Text(length),
                _ => return Err(fault(format!("{} is no type that is read here", quoted(descr)))),
            },
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Bool | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
            Self::Text(length) => 4 * length,
        }
    }
}

#[derive(Debug, PartialEq)]
struct Header {
    element: Element,
    fortran_order: bool,
    shape: Vec<usize>,
}

impl Header {
    /// Python's dict of exactly three keys; anything else is no header that numpy writes.
    fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        let fault = |message: &str| Fault::new("header", message, REMEDY);
        let text = std::str::from_utf8(bytes).map_err(|_utf8| fault("is no text"))?;
        let literal = python::literal(text).map_err(|broken| fault(&broken.message))?;
        let Literal::Dict(entries) = literal else { return Err(fault("is no dict")) };
        let (mut element, mut fortran_order, mut shape) = (None, None, None);
        for (key, value) in entries {
            match (key, value) {
                (Literal::Text(key), Literal::Text(descr)) if key == "descr" => {
                    element = Some(Element::parse(&descr)?);
                }
                (Literal::Text(key), _) if key == "descr" => {
                    return Err(fault("has a `descr` that is no string: a record of several fields"));
                }
                (Literal::Text(key), Literal::Bool(value)) if key == "fortran_order" => {
                    fortran_order = Some(value);
                }
                (Literal::Text(key), Literal::Tuple(axes)) if key == "shape" && axes.len() <= MOST_AXES => {
                    let length = |axis: &Literal| match axis {
                        Literal::Int(length) => usize::try_from(*length).ok(),
                        _ => None,
                    };
                    let axes: Option<Vec<usize>> = axes.iter().map(length).collect();
                    shape = Some(axes.ok_or_else(|| fault("has a `shape` that is no tuple of lengths"))?);
                }
                _ => return Err(fault("has other entries than `descr`, `fortran_order` and `shape`")),
            }
        }
        match (element, fortran_order, shape) {
            (Some(element), Some(fortran_order), Some(shape)) => Ok(Self { element, fortran_order, shape }),
            _ => Err(fault("lacks one of `descr`, `fortran_order` and `shape`")),
        }
    }
}

fn numbers<T: Real>(body: &[u8], element: Element) -> Result<Vec<T>, Fault> {
    let whole = T::of_whole;
    match element {
        Element::Bool | Element::Text(_) => convert(body, |[byte]| whole((byte != 0).into())),
        Element::U8 => convert(body, |[byte]: [u8; 1]| whole(byte.into())),
        Element::I8 => convert(body, |word| whole(i8::from_le_bytes(word).into())),
        Element::U16 => convert(body, |word| whole(u16::from_le_bytes(word).into())),
        Element::I16 => convert(body, |word| whole(i16::from_le_bytes(word).into())),
        Element::U32 => convert(body, |word| whole(u32::from_le_bytes(word).into())),
        Element::I32 => convert(body, |word| whole(i32::from_le_bytes(word).into())),
        Element::U64 => convert(body, |word| whole(i64::try_from(u64::from_le_bytes(word)).ok()?)),
        Element::I64 => convert(body, |word| whole(i64::from_le_bytes(word))),
        Element::F16 => convert(body, |word| Some(T::of_float(f16::from_le_bytes(word).to_f64()))),
        Element::F32 => convert(body, |word| Some(T::of_float(f32::from_le_bytes(word).into()))),
        Element::F64 => convert(body, |word| Some(T::of_float(f64::from_le_bytes(word)))),
    }
}

fn convert<const N: usize, T>(body: &[u8], number: impl Fn([u8; N]) -> Option<T>) -> Result<Vec<T>, Fault> {
    let (words, _) = body.as_chunks::<N>();
    let read = |(index, word): (usize, &[u8; N])| {
        number(*word).ok_or_else(|| {
            let message = "is a whole number too large to be held exactly";
            Fault::new(format!("number {index}"), message, "renumber the ids below 16777216")
        })
    };
    words.iter().enumerate().map(read).collect()
}

fn to_last_axis_fastest<T: Copy>(data: &[T], shape: &[usize]) -> Vec<T> {
    let mut strides = Vec::with_capacity(shape.len());
    let mut stride = 1;
    for &length in shape {
        strides.push(stride);
        stride *= length;
    }
    let mut place = vec![0; shape.len()];
    let mut sorted = Vec::with_capacity(data.len());
    for _ in 0..data.len() {
        let from: usize = place.iter().zip(&strides).map(|(place, stride)| place * stride).sum();
        sorted.push(data[from]);
        for axis in (0..shape.len()).rev() {
            place[axis] += 1;
            if place[axis] < shape[axis] {
                break;
            }
            place[axis] = 0;
        }
    }
    sorted
}

fn texts(body: &[u8], length: usize) -> Result<Vec<String>, Fault> {
    let text = |(index, bytes): (usize, &[u8])| {
        let (words, _) = bytes.as_chunks::<4>();
        let characters = words.iter().map(|word| u32::from_le_bytes(*word)).take_while(|&code| code != 0);
        let text: Option<String> = characters.map(char::from_u32).collect();
        text.ok_or_else(|| Fault::new(format!("text {index}"), "is no Unicode", REMEDY))
    };
    body.chunks_exact(4 * length).enumerate().map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, body: &[u8]) -> Vec<u8> {
        let mut file = MAGIC.to_vec();
        file.extend([1, 0]);
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.as_bytes());
        file.extend(body);
        file
    }

    fn read(header: &str, body: &[u8]) -> Result<Array, String> {
        match decode(&file(header, body)) {
            Ok(Contents::Numbers(array)) => Ok(array),
            Ok(Contents::Text(_)) => Err("text".to_owned()),
            Err(fault) => Err(fault.to_string()),
        }
    }

    #[test]
    fn what_is_written_is_read_and_aligned() {
        let values = [1.5, -2.0, 3.25, 0.0, 1e300, -0.1];
        let bytes = encode_f64(&[2, 3], &values);
        let read: Array<f64> = Array::decode(Path::new("a.npy"), &bytes).unwrap();
        assert_eq!((read.shape, read.data), (vec![2, 3], values.to_vec()));
        assert_eq!((bytes.len() - 8 * values.len()) % 64, 0);
    }

    #[test]
    fn every_type_becomes_the_same_numbers() {
        let cases: [(&str, &[u8]); 8] = [
            ("|u1", &[1, 2]),
            ("|i1", &[1, 2]),
            ("<i2", &[1, 0, 2, 0]),
            ("<u4", &[1, 0, 0, 0, 2, 0, 0, 0]),
            ("<i8", &[1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0]),
            ("<f2", &[0, 0x3c, 0, 0x40]),
            ("<f4", &[0, 0, 0x80, 0x3f, 0, 0, 0, 0x40]),
            ("<f8", &[0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0x40]),
        ];
        for (descr, body) in cases {
            let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (2,), }}   \n");
            let array = read(&header, body).unwrap();
            assert_eq!((array.shape, array.data), (vec![2], vec![1.0, 2.0]), "{descr}");
        }
        let array = read("{'descr': '|b1', 'fortran_order': False, 'shape': ()}", &[7]).unwrap();
        assert_eq!((array.shape, array.data), (vec![], vec![1.0]));
    }

    #[test]
    fn columns_first_is_turned_round() {
        // [[1, 2, 3], [4, 5, 6]] stored by columns.
        let header = "{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3), }";
        assert_eq!(read(header, &[1, 4, 2, 5, 3, 6]).unwrap().data, [1., 2., 3., 4., 5., 6.]);
    }

    #[test]
    fn texts_end_at_their_first_zero() {
        let mut body = Vec::new();
        for text in ["ab\0", "\u{e9}\0\0"] {
            body.extend(text.chars().flat_map(|character| (character as u32).to_le_bytes()));
        }
        let texts: Contents =
            decode(&file("{'descr': '<U3', 'fortran_order': False, 'shape': (2,)}", &body)).unwrap();
        assert_eq!(texts, Contents::Text(vec!["ab".to_owned(), "\u{e9}".to_owned()]));
    }

    #[test]
    fn what_is_no_plain_array_is_refused_with_its_reason() {
        let with = |descr: &str, shape: &str| {
            read(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}}}"), &[0; 8])
                .unwrap_err()
        };
        for (descr, shape, reason) in [
            ("'|O'", "(1,)", "executed"),
            ("'>f4'", "(2,)", "big-endian"),
            ("'<c8'", "(1,)", "no type"),
            ("'<U99999999999'", "(1,)", "no type"),
            ("[('a', '<f4')]", "(2,)", "several fields"),
            ("'<f4'", "(3,)", "does not fit the 8 bytes"),
            ("'<f4'", "(4294967296, 4294967296, 2)", "is no size"),
            ("'<f8'", "(2305843009213693952,)", "does not fit"),
            ("'<f4'", "(-2,)", "no tuple"),
            ("'<f4'", "(1,,,2", "no literal"),
            ("'<f4'", "[2]", "other entries"),
        ] {
            let error = with(descr, shape);
            assert!(error.contains(reason), "{descr} {shape}: {error}");
        }
        assert!(read("{'descr': '<f4'}", &[]).unwrap_err().contains("lacks"));
        assert!(read("{'descr' '<f4'}", &[]).unwrap_err().contains("`:` comes here"));
        assert!(read("{'x': 1}", &[]).unwrap_err().contains("other entries"));
        let huge = [MAGIC, &[2, 0, 0xff, 0xff, 0xff, 0xff]].concat();
        assert!(decode::<f32>(&huge).unwrap_err().to_string().contains("claims 4294967295 bytes"));
        let whole = file("{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }", &[0; 8]);
        for length in 0..whole.len() {
            assert!(decode::<f32>(&whole[..length]).is_err(), "the first {length} bytes pass");
        }
    }

    #[test]
    fn ids_that_no_float_can_tell_apart_are_refused() {
        let header = "{'descr': '<u4', 'fortran_order': False, 'shape': (1,)}";
        assert!(read(header, &[1, 0, 0, 1]).unwrap_err().contains("too large"));
        assert_eq!(read(header, &[0, 0, 0, 1]).unwrap().data, [16_777_216.0]);
        let wide: Contents<f64> = decode(&file(header, &[1, 0, 0, 1])).unwrap();
        assert!(matches!(wide, Contents::Numbers(Array { data, .. }) if data == [16_777_217.0]));
    }
}
