//! From the bytes of a storage to the numbers of a tensor.

use half::{bf16, f16};

use super::global::Element;
use super::node::{Storage, View};

/// Why a view cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Problem {
    /// It reaches beyond its storage.
    OutOfBounds,
    /// The number at this place of the tensor has no `f32` like it.
    Inexact(usize),
}

/// Numbers between 0 and this, and their negatives, are `f32` exactly.
const LARGEST_EXACT: u64 = 1 << 24;

/// The numbers that `view` shows of `storage`, whose bytes are `bytes`, in the order of the shape.
pub(super) fn read(bytes: &[u8], storage: &Storage, view: &View, count: usize) -> Result<Vec<f32>, Problem> {
    match storage.element {
        Element::F32 => gather(bytes, view, count, |word| Some(f32::from_le_bytes(word))),
        Element::F64 => gather(bytes, view, count, |word| {
            let wide = f64::from_le_bytes(word);
            let narrow = wide as f32;
            (narrow.is_finite() || !wide.is_finite()).then_some(narrow)
        }),
        Element::F16 => gather(bytes, view, count, |word| Some(f16::from_le_bytes(word).to_f32())),
        Element::Bf16 => gather(bytes, view, count, |word| Some(bf16::from_le_bytes(word).to_f32())),
        Element::I64 => gather(bytes, view, count, |word| exact(i64::from_le_bytes(word))),
        Element::I32 => gather(bytes, view, count, |word| exact(i32::from_le_bytes(word).into())),
        Element::I16 => gather(bytes, view, count, |word| exact(i16::from_le_bytes(word).into())),
        Element::I8 => gather(bytes, view, count, |word| exact(i8::from_le_bytes(word).into())),
        Element::U8 => gather(bytes, view, count, |[byte]| Some(f32::from(byte))),
        Element::Bool => gather(bytes, view, count, |[byte]| Some(f32::from(u8::from(byte != 0)))),
    }
}

fn exact(value: i64) -> Option<f32> {
    (value.unsigned_abs() <= LARGEST_EXACT).then_some(value as f32)
}

fn gather<const N: usize>(
    bytes: &[u8],
    view: &View,
    count: usize,
    convert: impl Fn([u8; N]) -> Option<f32>,
) -> Result<Vec<f32>, Problem> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let (words, _) = bytes.as_chunks::<N>();
    let last = last_word(view).ok_or(Problem::OutOfBounds)?;
    if last >= words.len() {
        return Err(Problem::OutOfBounds);
    }
    let mut numbers = Vec::with_capacity(count);
    let mut place = vec![0; view.shape.len()];
    let mut word = view.offset;
    for index in 0..count {
        let bytes = *words.get(word).ok_or(Problem::OutOfBounds)?;
        numbers.push(convert(bytes).ok_or(Problem::Inexact(index))?);
        // The next place, the last axis fastest; an axis that is through goes back to its start.
        for axis in (0..place.len()).rev() {
            place[axis] += 1;
            if place[axis] < view.shape[axis] {
                word += view.strides[axis];
                break;
            }
            place[axis] = 0;
            word -= view.strides[axis] * (view.shape[axis] - 1);
        }
    }
    Ok(numbers)
}

/// The furthest number of the storage that a view without an empty axis shows.
fn last_word(view: &View) -> Option<usize> {
    view.shape
        .iter()
        .zip(&view.strides)
        .try_fold(view.offset, |last, (&length, &stride)| last.checked_add(stride.checked_mul(length - 1)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn storage(element: Element, count: usize) -> Storage {
        Storage { key: "0".into(), element, count }
    }

    fn view(offset: usize, shape: &[usize], strides: &[usize]) -> View {
        View { storage: 0, offset, shape: shape.to_vec(), strides: strides.to_vec() }
    }

    fn floats(values: &[f32]) -> Vec<u8> {
        values.iter().flat_map(|value| value.to_le_bytes()).collect()
    }

    #[test]
    fn strides_and_offsets_are_followed() {
        let bytes = floats(&[0., 1., 2., 3., 4., 5., 6.]);
        let storage = storage(Element::F32, 7);
        // Rows 1, 2, 3 and 4, 5, 6, transposed.
        let transposed = view(1, &[3, 2], &[1, 3]);
        assert_eq!(read(&bytes, &storage, &transposed, 6), Ok(vec![1., 4., 2., 5., 3., 6.]));
        assert_eq!(read(&bytes, &storage, &view(6, &[], &[]), 1), Ok(vec![6.]));
        assert_eq!(read(&bytes, &storage, &view(2, &[2, 2], &[0, 1]), 4), Ok(vec![2., 3., 2., 3.]));
        assert_eq!(read(&bytes, &storage, &view(900, &[0, 3], &[9, 9]), 0), Ok(vec![]));
    }

    #[test]
    fn a_view_beyond_its_storage_is_refused() {
        let bytes = floats(&[0.; 6]);
        let storage = storage(Element::F32, 6);
        for view in [
            view(1, &[3, 2], &[2, 1]),
            view(6, &[], &[]),
            view(0, &[2], &[usize::MAX]),
            view(usize::MAX, &[2], &[1]),
            view(0, &[2, 2], &[usize::MAX / 2, usize::MAX / 2 + 2]),
        ] {
            let count = view.shape.iter().product();
            assert_eq!(read(&bytes, &storage, &view, count), Err(Problem::OutOfBounds), "{view:?}");
        }
    }

    #[test]
    fn all_types_become_f32_or_say_where_they_cannot() {
        let read_two = |element, bytes: &[u8]| read(bytes, &storage(element, 2), &view(0, &[2], &[1]), 2);
        let pair = |a: &[u8], b: &[u8]| [a, b].concat();
        assert_eq!(
            read_two(Element::F64, &pair(&1.5_f64.to_le_bytes(), &(-2.0_f64).to_le_bytes())),
            Ok(vec![1.5, -2.0])
        );
        assert_eq!(
            read_two(Element::F64, &pair(&0_f64.to_le_bytes(), &1e300_f64.to_le_bytes())),
            Err(Problem::Inexact(1))
        );
        assert_eq!(read_two(Element::F16, &[0x00, 0x3c, 0x00, 0xc0]), Ok(vec![1.0, -2.0]));
        assert_eq!(read_two(Element::Bf16, &[0x80, 0x3f, 0x00, 0xc0]), Ok(vec![1.0, -2.0]));
        assert_eq!(
            read_two(Element::I64, &pair(&7_i64.to_le_bytes(), &(1_i64 << 24).to_le_bytes())),
            Ok(vec![7.0, 16_777_216.0])
        );
        assert_eq!(
            read_two(Element::I64, &pair(&7_i64.to_le_bytes(), &i64::MIN.to_le_bytes())),
            Err(Problem::Inexact(1))
        );
        assert_eq!(read_two(Element::I8, &[0xff, 5]), Ok(vec![-1.0, 5.0]));
        assert_eq!(read_two(Element::U8, &[0xff, 5]), Ok(vec![255.0, 5.0]));
        assert_eq!(read_two(Element::Bool, &[1, 0]), Ok(vec![1.0, 0.0]));
    }
}
