//! NumPy's files: `.npy` arrays of plain numbers, and `.npz` archives of them for writing.

use std::io::Write as _;
use std::path::Path;

use l4d_data::DataError;
use rawzip::ZipArchiveWriter;

pub(crate) mod read;

/// First bytes of every such file.
const MAGIC: &[u8] = b"\x93NUMPY";

/// What the numbers were in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Truth values.
    Bool,
    /// Whole numbers.
    Integer,
    /// Numbers.
    Float,
}

/// Numbers with a shape, the last axis fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Array<T = f32> {
    /// Length along each axis; none for a single number.
    pub shape: Vec<usize>,
    /// The numbers, as many as the product of `shape`.
    pub data: Vec<T>,
    /// What they were in the file.
    pub kind: Kind,
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

    #[test]
    fn what_is_written_is_read_and_aligned() {
        let values = [1.5, -2.0, 3.25, 0.0, 1e300, -0.1];
        let bytes = encode_f64(&[2, 3], &values);
        let read: Array<f64> = Array::decode(Path::new("a.npy"), &bytes).unwrap();
        assert_eq!((read.shape, read.data), (vec![2, 3], values.to_vec()));
        assert_eq!((bytes.len() - 8 * values.len()) % 64, 0);
        let narrow = encode_f32(&[6], &values.map(|value| value as f32));
        let read: Array<f64> = Array::decode(Path::new("a.npy"), &narrow).unwrap();
        assert_eq!((read.shape, &read.data[..4]), (vec![6], &values[..4]));
    }
}
