//! Numbers of any type in bytes, and strided views of them.

use half::{bf16, f16};

use crate::tensor::element_count;

/// Type of the numbers, little-endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Element {
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
    Bf16,
    F32,
    F64,
}

/// Floating point that numbers are read into.
pub trait Real: Copy {
    /// A whole number; none if it cannot be held exactly.
    fn of_whole(value: i64) -> Option<Self>;
    /// The nearest to a number; none if that is infinite and the number is not.
    fn of_float(value: f64) -> Option<Self>;
}

impl Real for f32 {
    fn of_whole(value: i64) -> Option<Self> {
        (value.unsigned_abs() <= 1 << 24).then_some(value as Self)
    }

    fn of_float(value: f64) -> Option<Self> {
        let narrow = value as Self;
        (narrow.is_finite() || !value.is_finite()).then_some(narrow)
    }
}

impl Real for f64 {
    fn of_whole(value: i64) -> Option<Self> {
        (value.unsigned_abs() <= 1 << 53).then_some(value as Self)
    }

    fn of_float(value: f64) -> Option<Self> {
        Some(value)
    }
}

/// Which numbers of a buffer make a tensor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct View {
    /// The number that comes first.
    pub(crate) offset: usize,
    pub(crate) shape: Vec<usize>,
    /// Numbers of the buffer from one to the next along each axis.
    pub(crate) strides: Vec<usize>,
}

/// Why a view cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Problem {
    /// It reaches beyond its buffer.
    OutOfBounds,
    /// The number at this place of the tensor is too large to be held.
    TooLarge(usize),
    /// Its numbers do not fit into memory.
    OutOfMemory,
}

impl Element {
    /// Bytes of one number.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::Bool | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 | Self::Bf16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// The numbers that a view shows, in the order of its shape. Makes room for all of them: the caller has held their
    /// count against the file.
    pub(crate) fn read<T: Real>(self, bytes: &[u8], view: &View) -> Result<Vec<T>, Problem> {
        let (whole, float) = (T::of_whole, T::of_float);
        match self {
            Self::Bool => view.gather(bytes, |[byte]: [u8; 1]| whole((byte != 0).into())),
            Self::U8 => view.gather(bytes, |word| whole(u8::from_le_bytes(word).into())),
            Self::I8 => view.gather(bytes, |word| whole(i8::from_le_bytes(word).into())),
            Self::U16 => view.gather(bytes, |word| whole(u16::from_le_bytes(word).into())),
            Self::I16 => view.gather(bytes, |word| whole(i16::from_le_bytes(word).into())),
            Self::U32 => view.gather(bytes, |word| whole(u32::from_le_bytes(word).into())),
            Self::I32 => view.gather(bytes, |word| whole(i32::from_le_bytes(word).into())),
            Self::U64 => view.gather(bytes, |word| whole(i64::try_from(u64::from_le_bytes(word)).ok()?)),
            Self::I64 => view.gather(bytes, |word| whole(i64::from_le_bytes(word))),
            Self::F16 => view.gather(bytes, |word| float(f16::from_le_bytes(word).to_f64())),
            Self::Bf16 => view.gather(bytes, |word| float(bf16::from_le_bytes(word).to_f64())),
            Self::F32 => view.gather(bytes, |word| float(f32::from_le_bytes(word).into())),
            Self::F64 => view.gather(bytes, |word| float(f64::from_le_bytes(word))),
        }
    }
}

impl View {
    fn gather<const N: usize, T>(
        &self,
        bytes: &[u8],
        number: impl Fn([u8; N]) -> Option<T>,
    ) -> Result<Vec<T>, Problem> {
        let count = element_count(&self.shape).ok_or(Problem::OutOfBounds)?;
        if count == 0 {
            return Ok(Vec::new());
        }
        let (words, _) = bytes.as_chunks::<N>();
        if self.last_word().is_none_or(|last| last >= words.len()) {
            return Err(Problem::OutOfBounds);
        }
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(count).or(Err(Problem::OutOfMemory))?;
        let mut place = vec![0; self.shape.len()];
        let mut word = self.offset;
        for index in 0..count {
            numbers.push(number(words[word]).ok_or(Problem::TooLarge(index))?);
            // The next place, the last axis fastest; an axis that is through goes back to its start.
            for axis in (0..place.len()).rev() {
                place[axis] += 1;
                if place[axis] < self.shape[axis] {
                    word += self.strides[axis];
                    break;
                }
                place[axis] = 0;
                word -= self.strides[axis] * (self.shape[axis] - 1);
            }
        }
        Ok(numbers)
    }

    /// The furthest number that a view without an empty axis shows.
    fn last_word(&self) -> Option<usize> {
        let mut axes = self.shape.iter().zip(&self.strides);
        axes.try_fold(self.offset, |last, (&length, &stride)| {
            last.checked_add(stride.checked_mul(length - 1)?)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(offset: usize, shape: &[usize], strides: &[usize]) -> View {
        View { offset, shape: shape.to_vec(), strides: strides.to_vec() }
    }

    #[test]
    fn strides_and_offsets_are_followed() {
        let bytes: Vec<u8> = (0..7).flat_map(|value| (value as f32).to_le_bytes()).collect();
        let read = |view: View| Element::F32.read::<f32>(&bytes, &view);
        // Rows 1, 2, 3 and 4, 5, 6, transposed.
        assert_eq!(read(view(1, &[3, 2], &[1, 3])), Ok(vec![1., 4., 2., 5., 3., 6.]));
        assert_eq!(read(view(6, &[], &[])), Ok(vec![6.]));
        assert_eq!(read(view(2, &[2, 2], &[0, 1])), Ok(vec![2., 3., 2., 3.]));
        assert_eq!(read(view(900, &[0, 3], &[9, 9])), Ok(vec![]));
        for beyond in [
            view(2, &[3, 2], &[2, 1]),
            view(7, &[], &[]),
            view(0, &[2], &[usize::MAX]),
            view(usize::MAX, &[2], &[1]),
            view(0, &[2, 2], &[usize::MAX / 2, usize::MAX / 2 + 2]),
        ] {
            assert_eq!(read(beyond.clone()), Err(Problem::OutOfBounds), "{beyond:?}");
        }
    }

    #[test]
    fn all_types_become_floats_or_say_where_they_cannot() {
        fn two<T: Real>(element: Element, a: &[u8], b: &[u8]) -> Result<Vec<T>, Problem> {
            element.read(&[a, b].concat(), &view(0, &[2], &[1]))
        }
        let numbers = [
            two(Element::F64, &1.5_f64.to_le_bytes(), &(-2.0_f64).to_le_bytes()),
            two(Element::F32, &1.5_f32.to_le_bytes(), &(-2.0_f32).to_le_bytes()),
            two(Element::F16, &[0x00, 0x3e], &[0x00, 0xc0]),
            two(Element::Bf16, &[0xc0, 0x3f], &[0x00, 0xc0]),
        ];
        assert!(numbers.iter().all(|found| *found == Ok(vec![1.5_f32, -2.0])), "{numbers:?}");
        for (element, size) in [
            (Element::U16, 2),
            (Element::I16, 2),
            (Element::U32, 4),
            (Element::I32, 4),
            (Element::U64, 8),
            (Element::I64, 8),
        ] {
            let word = |number: u64| number.to_le_bytes()[..size].to_vec();
            assert_eq!(two(element, &word(7), &word(300)), Ok(vec![7.0_f32, 300.0]), "{element:?}");
        }
        assert_eq!(two(Element::I8, &[0xff], &[5]), Ok(vec![-1.0_f32, 5.0]));
        assert_eq!(two(Element::U8, &[0xff], &[5]), Ok(vec![255.0_f32, 5.0]));
        assert_eq!(two(Element::Bool, &[9], &[0]), Ok(vec![1.0_f32, 0.0]));
        let second = Err(Problem::TooLarge(1));
        assert_eq!(two::<f32>(Element::F64, &[0; 8], &1e300_f64.to_le_bytes()), second);
        assert_eq!(two::<f32>(Element::I64, &[0; 8], &i64::MIN.to_le_bytes()), second);
        let (exact, beyond) = ((1_u32 << 24).to_le_bytes(), ((1_u32 << 24) + 1).to_le_bytes());
        assert_eq!(two::<f32>(Element::U32, &exact, &beyond), second);
        assert_eq!(two(Element::U32, &exact, &beyond), Ok(vec![16_777_216.0_f64, 16_777_217.0]));
    }
}
