//! `.npy` files: a header in Python's notation, then the numbers.
//!
//! Objects, records and big-endian numbers are refused: the first are pickles, and the others are rare. The size that a
//! header claims is checked against the bytes that follow before anything is allocated.

use crate::element::{Element, Problem, Real, View};
use crate::fault::{Fault, quoted};
use crate::python::{self, Literal};
use crate::tensor::{Tensor, element_count};

/// First bytes of every such file.
const MAGIC: &[u8] = b"\x93NUMPY";
/// Bytes of a header: a shape of 32 axes takes under 1000.
const LONGEST_HEADER: usize = 1 << 16;
/// Axes of an array; numpy has no more either.
const MOST_AXES: usize = 32;
/// Characters of a text: sentences are far shorter.
const LONGEST_TEXT: usize = 4096;
/// What to do about a file that is refused.
const HINT: &str =
    "write the array again, as plain numbers: numpy.save(path, numpy.ascontiguousarray(a, '<f4'))";

/// What an array holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Contents<T = f32> {
    /// Numbers of any type.
    Numbers(Tensor<T>),
    /// Texts, in order.
    Text(Vec<String>),
}

impl<T> Contents<T> {
    /// The numbers.
    ///
    /// # Errors
    /// Texts.
    pub fn into_numbers(self) -> Result<Tensor<T>, Fault> {
        match self {
            Self::Numbers(numbers) => Ok(numbers),
            Self::Text(_) => Err(Fault::new("dtype", "is text where numbers belong", HINT)),
        }
    }
}

/// 64-bit floats in C order as the bytes of a `.npy` file, as `numpy.save` writes them.
pub fn encode_f64(shape: &[usize], values: &[f64]) -> Vec<u8> {
    let mut bytes = header("<f8", shape);
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// As [`encode_f64`], 32-bit floats.
pub fn encode_f32(shape: &[usize], values: &[f32]) -> Vec<u8> {
    let mut bytes = header("<f4", shape);
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

fn header(numbers: &str, shape: &[usize]) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let mut text =
        format!("{{'descr': '{numbers}', 'fortran_order': False, 'shape': ({}{comma}), }}", sides.join(", "));
    // Numbers begin at a multiple of 64 bytes, after a line feed.
    let unpadded = MAGIC.len() + 4 + text.len() + 1;
    text.push_str(&" ".repeat(unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    [MAGIC, &[1, 0], &(text.len() as u16).to_le_bytes(), text.as_bytes()].concat()
}

/// The array in the bytes of a file.
///
/// # Errors
/// Objects, records, big-endian numbers, a size that is not the file's, numbers that do not fit.
pub fn decode<T: Real>(bytes: &[u8]) -> Result<Contents<T>, Fault> {
    let (header, body) = split(bytes)?;
    let Header { kind, fortran_order, shape } = Header::parse(header)?;
    let fault = |message: String, hint| Fault::new("header, `shape`", message, hint);
    let count = element_count(&shape).ok_or_else(|| fault(format!("{shape:?} is no size"), HINT))?;
    if count.checked_mul(kind.size()) != Some(body.len()) {
        let (size, follow) = (kind.size(), body.len());
        let message = format!("{shape:?} of {size} bytes each does not fit the {follow} bytes that follow");
        return Err(fault(message, "copy or write the file again: it is cut, or its header lies"));
    }
    match kind {
        Kind::Text(length) => texts(body, length).map(Contents::Text),
        Kind::Numbers(element) => {
            let view = View { offset: 0, strides: strides(&shape, fortran_order), shape };
            let data = element.read(body, &view).map_err(|problem| {
                let Problem::TooLarge(index) = problem else {
                    return fault("does not fit into memory".to_owned(), HINT);
                };
                let message = "is too large to be held exactly";
                Fault::new(format!("number {index}"), message, "renumber the ids below 16777216")
            })?;
            Ok(Contents::Numbers(Tensor { shape: view.shape, data }))
        }
    }
}

fn split(bytes: &[u8]) -> Result<(&[u8], &[u8]), Fault> {
    let cut = || Fault::new("first bytes", "are not those of a .npy file", HINT);
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(cut)?;
    let (length, rest) = match *rest {
        [1, _, a, b, ref rest @ ..] => (usize::from(u16::from_le_bytes([a, b])), rest),
        [2 | 3, _, a, b, c, d, ref rest @ ..] => (u32::from_le_bytes([a, b, c, d]) as usize, rest),
        _ => return Err(cut()),
    };
    if length > LONGEST_HEADER {
        return Err(Fault::new("header", format!("claims {length} bytes"), HINT));
    }
    rest.split_at_checked(length).ok_or_else(|| Fault::new("header", "is cut", HINT))
}

fn strides(shape: &[usize], fortran_order: bool) -> Vec<usize> {
    // Saturating: an empty array may have absurd axes.
    let product = |axes: &[usize]| axes.iter().fold(1, |product: usize, &axis| product.saturating_mul(axis));
    let axes = 0..shape.len();
    axes.map(|axis| product(if fortran_order { &shape[..axis] } else { &shape[axis + 1..] })).collect()
}

/// What one entry is.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Numbers(Element),
    /// Text of so many characters of four bytes each.
    Text(usize),
}

impl Kind {
    const NUMBERS: [(&str, Element); 12] = [
        ("|b1", Element::Bool),
        ("|u1", Element::U8),
        ("|i1", Element::I8),
        ("<u2", Element::U16),
        ("<i2", Element::I16),
        ("<u4", Element::U32),
        ("<i4", Element::I32),
        ("<u8", Element::U64),
        ("<i8", Element::I64),
        ("<f2", Element::F16),
        ("<f4", Element::F32),
        ("<f8", Element::F64),
    ];

    fn parse(descr: &str) -> Result<Self, Fault> {
        if let Some((_, element)) = Self::NUMBERS.into_iter().find(|(name, _)| *name == descr) {
            return Ok(Self::Numbers(element));
        }
        let message = match descr.strip_prefix("<U").and_then(|length| length.parse().ok()) {
            Some(length @ 1..=LONGEST_TEXT) => return Ok(Self::Text(length)),
            _ if descr.starts_with("|O") => {
                "is `|O`: Python objects, which would have to be executed".to_owned()
            }
            _ if descr.starts_with('>') => format!("{} is big-endian", quoted(descr)),
            _ => format!("{} is no type that is read here", quoted(descr)),
        };
        Err(Fault::new("header, `descr`", message, HINT))
    }

    fn size(self) -> usize {
        match self {
            Self::Numbers(element) => element.size(),
            Self::Text(length) => 4 * length,
        }
    }
}

#[derive(Debug)]
struct Header {
    kind: Kind,
    fortran_order: bool,
    shape: Vec<usize>,
}

impl Header {
    /// Python's dict of exactly three keys; anything else is no header that numpy writes.
    fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        let fault = |message: &str| Fault::new("header", message, HINT);
        let text = std::str::from_utf8(bytes).map_err(|_utf8| fault("is no text"))?;
        let literal = python::literal(text).map_err(|broken| fault(&broken.message))?;
        let Literal::Dict(entries) = literal else { return Err(fault("is no dict")) };
        let (mut kind, mut fortran_order, mut shape) = (None, None, None);
        for (key, value) in &entries {
            let Literal::Text(key) = key else { return Err(fault("has a key that is no string")) };
            match (key.as_str(), value) {
                ("descr", Literal::Text(descr)) => kind = Some(Kind::parse(descr)?),
                ("descr", _) => {
                    return Err(fault("has a `descr` that is no string: a record of several fields"));
                }
                ("fortran_order", Literal::Bool(value)) => fortran_order = Some(*value),
                ("shape", Literal::Tuple(axes)) if axes.len() <= MOST_AXES => {
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
        match (kind, fortran_order, shape) {
            (Some(kind), Some(fortran_order), Some(shape)) => Ok(Self { kind, fortran_order, shape }),
            _ => Err(fault("lacks one of `descr`, `fortran_order` and `shape`")),
        }
    }
}

fn texts(body: &[u8], length: usize) -> Result<Vec<String>, Fault> {
    let text = |(index, bytes): (usize, &[u8])| {
        let (words, _) = bytes.as_chunks::<4>();
        let characters = words.iter().map(|word| u32::from_le_bytes(*word)).take_while(|&code| code != 0);
        let text: Option<String> = characters.map(char::from_u32).collect();
        text.ok_or_else(|| Fault::new(format!("text {index}"), "is no Unicode", HINT))
    };
    body.chunks_exact(4 * length).enumerate().map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, body: &[u8]) -> Vec<u8> {
        [MAGIC, &[1, 0], &(header.len() as u16).to_le_bytes(), header.as_bytes(), body].concat()
    }

    fn read(descr: &str, order: &str, shape: &str, body: &[u8]) -> Result<Tensor, String> {
        let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}   \n");
        let contents = decode(&file(&header, body)).and_then(Contents::into_numbers);
        contents.map_err(|fault| fault.to_string())
    }

    #[test]
    fn what_is_written_is_read_and_aligned() {
        let values = [1.5, -2.0, 3.25, 0.0, 1e300, -0.1];
        let bytes = encode_f64(&[2, 3], &values);
        let read: Tensor<f64> = decode(&bytes).and_then(Contents::into_numbers).unwrap();
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
            let array = read(&format!("'{descr}'"), "False", "(2,)", body).unwrap();
            assert_eq!((array.shape, array.data), (vec![2], vec![1.0, 2.0]), "{descr}");
        }
        let single = read("'|b1'", "False", "()", &[7]).unwrap();
        assert_eq!((single.shape, single.data), (vec![], vec![1.0]));
        assert_eq!(read("'<f4'", "True", "(4611686018427387904, 0)", &[]).unwrap().data.len(), 0);
        // [[1, 2, 3], [4, 5, 6]] stored by columns.
        let columns = read("'|u1'", "True", "(2, 3)", &[1, 4, 2, 5, 3, 6]).unwrap();
        assert_eq!(columns.data, [1., 2., 3., 4., 5., 6.]);
    }

    #[test]
    fn texts_end_at_their_first_zero() {
        let body: Vec<u8> = "ab\0\u{e9}\0\0".chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        let header = "{'descr': '<U3', 'fortran_order': False, 'shape': (2,)}";
        let texts: Contents = decode(&file(header, &body)).unwrap();
        assert_eq!(texts, Contents::Text(vec!["ab".to_owned(), "\u{e9}".to_owned()]));
        assert_eq!(texts.into_numbers().unwrap_err().message, "is text where numbers belong");
    }

    #[test]
    fn what_is_no_plain_array_is_refused_with_its_reason() {
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
            ("'<u4'", "(2,)", "number 1: is too large to be held exactly"),
        ] {
            let error = read(descr, "False", shape, &[0, 0, 0, 1, 1, 0, 0, 1]).unwrap_err();
            assert!(error.contains(reason), "{descr} {shape}: {error}");
        }
        let refused = |header: &str| decode::<f32>(&file(header, &[])).unwrap_err().to_string();
        assert!(refused("{'descr': '<f4'}").contains("lacks"));
        assert!(refused("{'descr' '<f4'}").contains("`:` comes here"));
        assert!(refused("{'x': 1}").contains("other entries"));
        let huge = [MAGIC, &[2, 0, 0xff, 0xff, 0xff, 0xff]].concat();
        assert!(decode::<f32>(&huge).unwrap_err().to_string().contains("claims 4294967295 bytes"));
        let whole = file("{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }", &[0; 8]);
        for length in 0..whole.len() {
            assert!(decode::<f32>(&whole[..length]).is_err(), "the first {length} bytes pass");
        }
    }
}
