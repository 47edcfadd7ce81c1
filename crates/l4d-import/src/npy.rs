//! NumPy's files: `.npy` arrays of plain numbers, and `.npz` archives of them for writing.
//!
//! Objects, strings and structured types are refused: they are pickles or need a schema. What a header promises is
//! checked against the bytes that are there before anything is allocated.

use std::io::Write as _;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::error::inert;
use rawzip::ZipArchiveWriter;

/// No header is longer, bytes.
const LONGEST_HEADER: usize = 1 << 16;
const MAGIC: &[u8] = b"\x93NUMPY";
const REMEDY: &str = "save it again with numpy.save as an array of numbers, e.g. array.astype('float32')";

/// Type of the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `bool`.
    Bool,
    /// `int8` to `int64`, by bytes.
    Signed(usize),
    /// `uint8` to `uint64`, by bytes.
    Unsigned(usize),
    /// `float16` to `float64`, by bytes.
    Float(usize),
}

impl Kind {
    /// Bytes of one number.
    pub fn size(self) -> usize {
        match self {
            Self::Bool => 1,
            Self::Signed(size) | Self::Unsigned(size) | Self::Float(size) => size,
        }
    }
}

/// What the first bytes of an array say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// Numbers along each axis.
    pub shape: Vec<usize>,
    /// Type of the numbers.
    pub kind: Kind,
    /// Whether the first axis is the fastest one.
    pub fortran_order: bool,
    /// Where the numbers begin, bytes.
    pub offset: usize,
    big_endian: bool,
}

impl Header {
    /// Reads the header of the bytes of a file and checks that exactly its numbers follow.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self, DataError> {
        let wrong = |message: String| DataError::invalid(path, "npy header", inert(&message), REMEDY);
        let header = Self::parse(bytes).map_err(wrong)?;
        let count = header.shape.iter().try_fold(1_usize, |count, &side| count.checked_mul(side));
        let needed = count.and_then(|count| count.checked_mul(header.kind.size()));
        let there = bytes.len() - header.offset;
        if needed != Some(there) {
            let message = format!("promises the shape {:?}, but {there} bytes follow", header.shape);
            return Err(wrong(message));
        }
        Ok(header)
    }

    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let rest = bytes.strip_prefix(MAGIC).ok_or("is no NumPy array")?;
        let (length, start) = match *rest {
            [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 10),
            [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([a, b, c, d]) as usize, 12),
            _ => return Err("has an unknown version".to_owned()),
        };
        if length > LONGEST_HEADER {
            return Err(format!("has a header of {length} bytes"));
        }
        let text = bytes.get(start..start + length).ok_or("is cut")?;
        let text = std::str::from_utf8(text).map_err(|error| format!("is no text: {error}"))?;
        let (kind, big_endian) = kind_of(value_of(text, "descr")?)?;
        let fortran_order = match value_of(text, "fortran_order")? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return Err("`fortran_order` is neither True nor False".to_owned()),
        };
        let shape = shape_of(value_of(text, "shape")?)?;
        Ok(Self { shape, kind, fortran_order, offset: start + length, big_endian })
    }
}

/// The text that follows a key of the header's dictionary.
fn value_of<'a>(text: &'a str, key: &str) -> Result<&'a str, String> {
    let quoted = [format!("'{key}':"), format!("\"{key}\":")];
    let start = quoted.iter().find_map(|key| Some(text.find(key.as_str())? + key.len()));
    start.map(|start| text[start..].trim_start()).ok_or_else(|| format!("lacks `{key}`"))
}

fn kind_of(text: &str) -> Result<(Kind, bool), String> {
    let word: String = text.chars().skip(1).take_while(|c| !matches!(c, '\'' | '"')).take(16).collect();
    let refused = || format!("holds `{word}`, but plain numbers are read");
    let (order, code) = word.split_at_checked(1).ok_or_else(refused)?;
    if !matches!(order, "<" | ">" | "|" | "=") || !text.starts_with(['\'', '"']) {
        return Err(refused());
    }
    let kind = match code {
        "b1" => Kind::Bool,
        "i1" => Kind::Signed(1),
        "i2" => Kind::Signed(2),
        "i4" => Kind::Signed(4),
        "i8" => Kind::Signed(8),
        "u1" => Kind::Unsigned(1),
        "u2" => Kind::Unsigned(2),
        "u4" => Kind::Unsigned(4),
        "u8" => Kind::Unsigned(8),
        "f2" => Kind::Float(2),
        "f4" => Kind::Float(4),
        "f8" => Kind::Float(8),
        _ => return Err(refused()),
    };
    Ok((kind, order == ">"))
}

fn shape_of(text: &str) -> Result<Vec<usize>, String> {
    let inside = text.strip_prefix('(').and_then(|rest| rest.split_once(')')).map(|(inside, _)| inside);
    let inside = inside.ok_or("`shape` is no tuple")?;
    let sides = inside.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape: Option<Vec<usize>> =
        sides.map(|side| side.trim_end_matches('L').parse().ok()).take(33).collect();
    shape
        .filter(|shape| shape.len() <= 32)
        .ok_or_else(|| "`shape` holds something that is no size".to_owned())
}

/// An array of 64-bit floats in C order, whatever the file stores.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Numbers along each axis.
    pub shape: Vec<usize>,
    /// The numbers, last axis fastest.
    pub values: Vec<f64>,
}

impl Array {
    /// Reads the bytes of a `.npy` file.
    pub fn decode(path: &Path, bytes: &[u8]) -> Result<Self, DataError> {
        let header = Header::read(path, bytes)?;
        let size = header.kind.size();
        let number = |bytes: &[u8]| {
            let mut eight = [0; 8];
            eight[..size].copy_from_slice(bytes);
            if header.big_endian {
                eight[..size].reverse();
            }
            number_of(header.kind, eight)
        };
        let values: Vec<f64> = bytes[header.offset..].chunks_exact(size).map(number).collect();
        let values = if header.fortran_order { c_order(&header.shape, &values) } else { values };
        Ok(Self { shape: header.shape, values })
    }
}

fn number_of(kind: Kind, bytes: [u8; 8]) -> f64 {
    let low = |count: usize| u64::from_le_bytes(bytes) & (u64::MAX >> (64 - 8 * count));
    match kind {
        Kind::Bool => f64::from(u8::from(bytes[0] != 0)),
        Kind::Unsigned(size) => low(size) as f64,
        Kind::Signed(size) => {
            let shift = 64 - 8 * size;
            ((low(size) << shift) as i64 >> shift) as f64
        }
        Kind::Float(2) => half_float([bytes[0], bytes[1]]),
        Kind::Float(4) => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        Kind::Float(_) => f64::from_le_bytes(bytes),
    }
}

/// IEEE 754 half precision.
fn half_float(bytes: [u8; 2]) -> f64 {
    let bits = u16::from_le_bytes(bytes);
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff) / 1024.0);
    let size = match exponent {
        0 => fraction * 2.0_f64.powi(-14),
        0x1f if fraction == 0.0 => f64::INFINITY,
        0x1f => f64::NAN,
        _ => (1.0 + fraction) * 2.0_f64.powi(exponent - 15),
    };
    if bits >> 15 == 1 { -size } else { size }
}

fn c_order(shape: &[usize], values: &[f64]) -> Vec<f64> {
    let mut index = vec![0; shape.len()];
    let mut ordered = Vec::with_capacity(values.len());
    while ordered.len() < values.len() {
        let position = (0..shape.len()).rev().fold(0, |position, axis| position * shape[axis] + index[axis]);
        ordered.push(values[position]);
        for axis in (0..shape.len()).rev() {
            index[axis] += 1;
            if index[axis] < shape[axis] {
                break;
            }
            index[axis] = 0;
        }
    }
    ordered
}

/// 64-bit floats in C order as the bytes of a `.npy` file, as `numpy.save` writes them.
pub fn encode_f64(shape: &[usize], values: &[f64]) -> Vec<u8> {
    encode("<f8", shape, values.iter().flat_map(|value| value.to_le_bytes()))
}

/// 32-bit floats in C order as the bytes of a `.npy` file, as `numpy.save` writes them.
pub fn encode_f32(shape: &[usize], values: &[f32]) -> Vec<u8> {
    encode("<f4", shape, values.iter().flat_map(|value| value.to_le_bytes()))
}

fn encode(descr: &str, shape: &[usize], numbers: impl Iterator<Item = u8>) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let mut text =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}{comma}), }}", sides.join(", "));
    // Numbers begin at a multiple of 64 bytes, after a line feed.
    let unpadded = MAGIC.len() + 4 + text.len() + 1;
    text.push_str(&" ".repeat(unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend(numbers);
    bytes
}

/// An uncompressed archive of arrays, as `numpy.savez` writes it: each with its name without `.npy`.
pub fn encode_archive(path: &Path, arrays: &[(&str, Vec<u8>)]) -> Result<Vec<u8>, DataError> {
    let mut zip = ZipArchiveWriter::new(Vec::new());
    let written = arrays
        .iter()
        .try_for_each(|(name, bytes)| add_entry(&mut zip, &format!("{name}.npy"), bytes))
        .and_then(|()| zip.finish());
    written.map_err(|error| {
        DataError::invalid(path, "archive", format!("cannot be written: {error}"), "use fewer --points")
    })
}

fn add_entry(zip: &mut ZipArchiveWriter<Vec<u8>>, name: &str, bytes: &[u8]) -> Result<(), rawzip::Error> {
    let (mut entry, config) = zip.new_file(name).start()?;
    let mut writer = config.wrap(&mut entry);
    writer.write_all(bytes)?;
    let (_, descriptor) = writer.finish()?;
    entry.finish(descriptor)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(bytes: &[u8]) -> Result<Array, DataError> {
        Array::decode(Path::new("a.npy"), bytes)
    }

    fn with_header(header: &str, numbers: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(numbers);
        bytes
    }

    #[test]
    fn what_is_written_is_read_and_aligned() {
        let values = [1.5, -2.0, 3.25, 0.0, 1e300, -0.1];
        let bytes = encode_f64(&[2, 3], &values);
        assert_eq!(decode(&bytes).unwrap(), Array { shape: vec![2, 3], values: values.to_vec() });
        assert_eq!(Header::read(Path::new("a"), &bytes).unwrap().offset % 64, 0);
        let narrow = encode_f32(&[6], &values.map(|value| value as f32));
        assert_eq!(decode(&narrow).unwrap().values[..4], values[..4]);
    }

    #[test]
    fn every_kind_of_number_is_understood() {
        let one = |descr: &str, number: &[u8]| {
            let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (1,), }}");
            decode(&with_header(&header, number)).unwrap().values[0]
        };
        assert_eq!(one("|b1", &[1]), 1.0);
        assert_eq!(one("|i1", &[0xff]), -1.0);
        assert_eq!(one(">i2", &[0xff, 0xfe]), -2.0);
        assert_eq!(one("<u2", &[0xff, 0xff]), 65535.0);
        assert_eq!(one("<i8", &(-5_i64).to_le_bytes()), -5.0);
        assert_eq!(one("<f2", &[0x00, 0x3e]), 1.5);
        assert_eq!(one("<f2", &[0x01, 0x80]), -(2.0_f64.powi(-24)));
        assert_eq!(one(">f4", &1.5_f32.to_be_bytes()), 1.5);
    }

    #[test]
    fn fortran_order_is_turned() {
        let numbers: Vec<u8> =
            [1.0, 4.0, 2.0, 5.0, 3.0, 6.0_f64].iter().flat_map(|x| x.to_le_bytes()).collect();
        let bytes = with_header("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", &numbers);
        assert_eq!(decode(&bytes).unwrap().values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn promises_that_the_bytes_do_not_keep_are_refused() {
        let header = |descr: &str, shape: &str| {
            with_header(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}"), &[0; 8])
        };
        for (bytes, said) in [
            (header("'<f8'", "(99999999999, 99999999999)"), "promises the shape"),
            (header("'<f8'", "(2,)"), "promises the shape"),
            (header("'|O'", "(1,)"), "plain numbers"),
            (header("[('a', '<f8')]", "(1,)"), "plain numbers"),
            (header("'<f8'", "(-1,)"), "no size"),
            (header("'<f8'", "1"), "no tuple"),
            (b"\x93NUMPY\x02\0\xff\xff\xff\xff".to_vec(), "header of"),
            (b"\x93NUMPY\x01\0\xff\0{".to_vec(), "is cut"),
            (b"PK".to_vec(), "no NumPy array"),
        ] {
            let error = decode(&bytes).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        let whole = encode_f64(&[3], &[1.0, 2.0, 3.0]);
        for length in 0..whole.len() {
            assert!(decode(&whole[..length]).is_err(), "{length} bytes passed");
        }
    }
}
