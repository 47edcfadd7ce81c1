//! One `.npy` file: a header in Python's notation, then the numbers.
//!
//! Objects, records and big-endian numbers are refused: the first are pickles, the others nobody writes. What a header
//! promises is checked against the bytes that are there before anything is allocated.

use std::path::Path;

use half::f16;
use l4d_data::DataError;
use l4d_splat::checkpoint::Fault;
use l4d_splat::checkpoint::fault::quoted;
use l4d_splat::tensor::element_count;

use super::{Array, Contents, Kind, MAGIC, Real};

/// Bytes of a header: a shape of 32 axes takes under 1000.
const LONGEST_HEADER: usize = 1 << 16;
/// Axes of an array; numpy has no more either.
const MOST_AXES: usize = 32;
/// Characters of a text: sentences are far shorter.
const LONGEST_TEXT: usize = 4096;
/// What to do about a file that is refused.
pub(crate) const REMEDY: &str =
    "write the array again, as plain numbers: numpy.save(path, numpy.ascontiguousarray(a, '<f4'))";

impl<T: Real> Array<T> {
    /// Reads the bytes of a file that holds numbers.
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
pub(crate) fn decode<T: Real>(bytes: &[u8]) -> Result<Contents<T>, Fault> {
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
    Ok(Contents::Numbers(Array { shape: header.shape, data, kind: header.element.kind() }))
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

    fn kind(self) -> Kind {
        match self {
            Self::Bool => Kind::Bool,
            Self::F16 | Self::F32 | Self::F64 => Kind::Float,
            _ => Kind::Integer,
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
        let fault = |message: &str| Fault::new("header", message.to_owned(), REMEDY);
        let text = std::str::from_utf8(bytes).map_err(|_utf8| fault("is no text"))?.trim();
        let inner = text.strip_prefix('{').and_then(|text| text.strip_suffix('}'));
        let mut rest = inner.ok_or_else(|| fault("is no dict"))?.trim();
        let (mut element, mut fortran_order, mut shape) = (None, None, None);
        while !rest.is_empty() {
            let (key, after) = string(rest).ok_or_else(|| fault("has a key that is no string"))?;
            let after = after.trim_start().strip_prefix(':').ok_or_else(|| fault("lacks a colon"))?;
            rest = match key {
                "descr" => {
                    let (descr, after) = string(after.trim_start()).ok_or_else(|| {
                        fault("has a `descr` that is no string: a record of several fields")
                    })?;
                    element = Some(Element::parse(descr)?);
                    after
                }
                "fortran_order" => {
                    let after = after.trim_start();
                    let (value, after) = match (after.strip_prefix("True"), after.strip_prefix("False")) {
                        (Some(after), _) => (true, after),
                        (_, Some(after)) => (false, after),
                        _ => return Err(fault("has a `fortran_order` that is no truth value")),
                    };
                    fortran_order = Some(value);
                    after
                }
                "shape" => {
                    let (axes, after) = tuple(after.trim_start())
                        .ok_or_else(|| fault("has a `shape` that is no tuple of lengths"))?;
                    shape = Some(axes);
                    after
                }
                _ => return Err(fault("has a key beside `descr`, `fortran_order` and `shape`")),
            };
            rest = rest.trim_start();
            rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
        }
        match (element, fortran_order, shape) {
            (Some(element), Some(fortran_order), Some(shape)) => Ok(Self { element, fortran_order, shape }),
            _ => Err(fault("lacks one of `descr`, `fortran_order` and `shape`")),
        }
    }
}

fn string(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|quote| matches!(quote, '\'' | '"'))?;
    text[1..].split_once(quote)
}

fn tuple(text: &str) -> Option<(Vec<usize>, &str)> {
    let (inner, rest) = text.strip_prefix('(')?.split_once(')')?;
    let parts = inner.split(',').map(str::trim);
    let axes: Option<Vec<usize>> =
        parts.filter(|part| !part.is_empty()).map(|part| part.parse().ok()).collect();
    let axes = axes.filter(|axes| axes.len() <= MOST_AXES)?;
    Some((axes, rest))
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
        assert_eq!((array.shape, array.data, array.kind), (vec![], vec![1.0], Kind::Bool));
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
            ("'<f4'", "(1,,,2", "no tuple"),
        ] {
            let error = with(descr, shape);
            assert!(error.contains(reason), "{descr} {shape}: {error}");
        }
        assert!(read("{'descr': '<f4'}", &[]).unwrap_err().contains("lacks"));
        assert!(read("{'descr' '<f4'}", &[]).unwrap_err().contains("colon"));
        assert!(read("{'x': 1}", &[]).unwrap_err().contains("beside"));
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
