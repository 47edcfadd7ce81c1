//! One bit per pixel: which pixels of a picture belong to something.
//!
//! Rows follow each other, each starts in a word of its own, and bit 0 of a word is its leftmost pixel. Bits
//! beyond the width are always zero, so that counting never masks and equal masks have equal words. The module
//! knows nothing of files; [`crate::rle`] and [`crate::png`] do.

use std::ops::Range;

/// A rectangle of pixels, both ends inclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PixelBox {
    /// Leftmost column.
    pub first_col: u32,
    /// Topmost row.
    pub first_row: u32,
    /// Rightmost column.
    pub last_col: u32,
    /// Bottommost row.
    pub last_row: u32,
}

/// A set of pixels of a picture of fixed size.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Mask {
    width: u32,
    height: u32,
    words: Vec<u64>,
}

/// A buffer that does not hold one value a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{found} values do not fill {width}x{height} pixels")]
pub struct LengthError {
    found: usize,
    width: u32,
    height: u32,
}

impl Mask {
    /// Longest side that a decoder will make room for: far above any profile, far below harm.
    pub const MAX_SIDE: u32 = 8192;

    /// Whether a decoder may make room for such a mask: it has pixels and no side above [`Self::MAX_SIDE`].
    pub fn is_sane_size(width: u32, height: u32) -> bool {
        (1..=Self::MAX_SIDE).contains(&width) && (1..=Self::MAX_SIDE).contains(&height)
    }

    /// No pixel.
    pub fn empty(width: u32, height: u32) -> Self {
        Self { width, height, words: vec![0; words_per_row(width) * height as usize] }
    }

    /// Every pixel.
    pub fn full(width: u32, height: u32) -> Self {
        let mut mask = Self::empty(width, height);
        for row in 0..height {
            mask.row_words_mut(row).fill(u64::MAX);
        }
        mask.clear_padding();
        mask
    }

    /// The pixels for which `inside(col, row)` holds.
    pub fn from_fn(width: u32, height: u32, mut inside: impl FnMut(u32, u32) -> bool) -> Self {
        let mut mask = Self::empty(width, height);
        for row in 0..height {
            for (index, word) in mask.row_words_mut(row).iter_mut().enumerate() {
                let first = index as u32 * 64;
                for col in first..width.min(first + 64) {
                    *word |= u64::from(inside(col, row)) << (col - first);
                }
            }
        }
        mask
    }

    /// The true pixels of a row-major buffer.
    pub fn from_bools(width: u32, height: u32, pixels: &[bool]) -> Result<Self, LengthError> {
        check_length(width, height, pixels.len())?;
        Ok(Self::from_fn(width, height, |col, row| pixels[row as usize * width as usize + col as usize]))
    }

    /// The pixels of a row-major id buffer that show `id`.
    pub fn from_ids(width: u32, height: u32, ids: &[u32], id: u32) -> Result<Self, LengthError> {
        check_length(width, height, ids.len())?;
        Ok(Self::from_fn(width, height, |col, row| ids[row as usize * width as usize + col as usize] == id))
    }

    /// One bool a pixel, row-major.
    pub fn to_bools(&self) -> Vec<bool> {
        let rows = (0..self.height).flat_map(|row| (0..self.width).map(move |col| (col, row)));
        rows.map(|(col, row)| self.get(col, row)).collect()
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// `(width, height)`.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Whether a pixel belongs; pixels outside the picture do not.
    pub fn get(&self, col: u32, row: u32) -> bool {
        col < self.width
            && row < self.height
            && self.row_words(row)[(col / 64) as usize] >> (col % 64) & 1 == 1
    }

    /// Adds or removes a pixel.
    ///
    /// # Panics
    /// If the pixel is outside the picture.
    pub fn set(&mut self, col: u32, row: u32, inside: bool) {
        assert!(col < self.width && row < self.height, "pixel ({col}, {row}) is outside {self:?}");
        let word = &mut self.row_words_mut(row)[(col / 64) as usize];
        let bit = 1 << (col % 64);
        *word = if inside { *word | bit } else { *word & !bit };
    }

    /// Number of pixels.
    pub fn area(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// Whether there is no pixel.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// Pixels in both masks.
    ///
    /// # Panics
    /// If the sizes differ, as do the other counts.
    pub fn and_count(&self, other: &Self) -> u64 {
        self.count_with(other, |ours, theirs| ours & theirs)
    }

    /// Pixels in both masks, looking only at some rows: quicker where one mask is known to have no others.
    ///
    /// # Panics
    /// If the sizes differ or the rows leave the picture.
    pub fn and_count_in_rows(&self, other: &Self, rows: Range<u32>) -> u64 {
        self.assert_same_size(other);
        let stride = words_per_row(self.width);
        let words = rows.start as usize * stride..rows.end as usize * stride;
        count_ones(&self.words[words.clone()], &other.words[words], |ours, theirs| ours & theirs)
    }

    /// Pixels in at least one of the masks.
    pub fn or_count(&self, other: &Self) -> u64 {
        self.count_with(other, |ours, theirs| ours | theirs)
    }

    /// Pixels in this mask and not in the other.
    pub fn and_not_count(&self, other: &Self) -> u64 {
        self.count_with(other, |ours, theirs| ours & !theirs)
    }

    /// Whether the masks share a pixel.
    pub fn intersects(&self, other: &Self) -> bool {
        self.assert_same_size(other);
        self.words.iter().zip(&other.words).any(|(ours, theirs)| ours & theirs != 0)
    }

    /// Adds the pixels of another mask of the same size.
    pub fn union_with(&mut self, other: &Self) {
        self.assert_same_size(other);
        for (ours, theirs) in self.words.iter_mut().zip(&other.words) {
            *ours |= theirs;
        }
    }

    /// The smallest box around all pixels; none if there is no pixel.
    pub fn bounding_box(&self) -> Option<PixelBox> {
        let first_row = (0..self.height).find(|&row| self.row_words(row).iter().any(|&word| word != 0))?;
        let last_row =
            (first_row..self.height).rev().find(|&row| self.row_words(row).iter().any(|&word| word != 0))?;
        let mut first_col = self.width;
        let mut last_col = 0;
        for row in first_row..=last_row {
            let words = self.row_words(row);
            if let Some(index) = words.iter().position(|&word| word != 0) {
                first_col = first_col.min(index as u32 * 64 + words[index].trailing_zeros());
            }
            if let Some(index) = words.iter().rposition(|&word| word != 0) {
                last_col = last_col.max(index as u32 * 64 + 63 - words[index].leading_zeros());
            }
        }
        Some(PixelBox { first_col, first_row, last_col, last_row })
    }

    /// The pixels as `(col, row)`, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.height).flat_map(move |row| {
            self.row_words(row)
                .iter()
                .enumerate()
                .flat_map(move |(index, &word)| set_bits(word).map(move |bit| (index as u32 * 64 + bit, row)))
        })
    }

    /// The same picture at another size: each pixel takes the nearest one of this mask.
    pub fn resized_nearest(&self, width: u32, height: u32) -> Self {
        Self::from_fn(width, height, |col, row| {
            self.get(nearest(col, self.width, width), nearest(row, self.height, height))
        })
    }

    /// The words of a row; bit 0 of the first is the leftmost pixel.
    pub fn row_words(&self, row: u32) -> &[u64] {
        let stride = words_per_row(self.width);
        &self.words[row as usize * stride..][..stride]
    }

    pub(crate) fn row_words_mut(&mut self, row: u32) -> &mut [u64] {
        let stride = words_per_row(self.width);
        &mut self.words[row as usize * stride..][..stride]
    }

    /// Restores the invariant after whole words were written.
    pub(crate) fn clear_padding(&mut self) {
        let used = self.width % 64;
        if used != 0 {
            for last in
                self.words.iter_mut().skip(words_per_row(self.width) - 1).step_by(words_per_row(self.width))
            {
                *last &= (1 << used) - 1;
            }
        }
    }

    fn count_with(&self, other: &Self, combine: impl Fn(u64, u64) -> u64) -> u64 {
        self.assert_same_size(other);
        count_ones(&self.words, &other.words, combine)
    }

    fn assert_same_size(&self, other: &Self) {
        assert_eq!(self.size(), other.size(), "masks of different sizes cannot be compared");
    }
}

/// Size and area: the words would help nobody.
impl std::fmt::Debug for Mask {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "Mask({}x{}, {} pixels)", self.width, self.height, self.area())
    }
}

fn count_ones(ours: &[u64], theirs: &[u64], combine: impl Fn(u64, u64) -> u64) -> u64 {
    ours.iter().zip(theirs).map(|(&ours, &theirs)| u64::from(combine(ours, theirs).count_ones())).sum()
}

pub(crate) fn words_per_row(width: u32) -> usize {
    width.div_ceil(64) as usize
}

fn check_length(width: u32, height: u32, found: usize) -> Result<(), LengthError> {
    let fits = width as u64 * height as u64 == found as u64;
    if fits { Ok(()) } else { Err(LengthError { found, width, height }) }
}

fn set_bits(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros())?;
        word &= word - 1;
        Some(bit)
    })
}

/// Where a side of `from` pixels is shown with `to`: the pixel of `from` in which the centre of pixel `index` of `to` lies.
pub fn nearest(index: u32, from: u32, to: u32) -> u32 {
    // Exact in integers.
    ((2 * u64::from(index) + 1) * u64::from(from) / (2 * u64::from(to))) as u32
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Any size up to 200x40 with any pixels; two masks of the same size.
    fn two_buffers() -> impl Strategy<Value = (u32, u32, Vec<bool>, Vec<bool>)> {
        (1..200_u32, 1..40_u32).prop_flat_map(|(width, height)| {
            let pixels = || proptest::collection::vec(any::<bool>(), (width * height) as usize);
            (Just(width), Just(height), pixels(), pixels())
        })
    }

    proptest! {
        #[test]
        fn counts_equal_those_of_plain_buffers((width, height, a, b) in two_buffers()) {
            let first = Mask::from_bools(width, height, &a).unwrap();
            let second = Mask::from_bools(width, height, &b).unwrap();
            let count = |test: fn(bool, bool) -> bool| a.iter().zip(&b).filter(|&(&x, &y)| test(x, y)).count() as u64;
            prop_assert_eq!(first.to_bools(), a.clone());
            prop_assert_eq!(first.area(), count(|x, _| x));
            prop_assert_eq!(first.and_count(&second), count(|x, y| x && y));
            let rows = height / 3..height - height / 4;
            let in_rows = |index: usize| rows.contains(&(index as u32 / width));
            let both = (0..a.len()).filter(|&index| in_rows(index) && a[index] && b[index]).count() as u64;
            prop_assert_eq!(first.and_count_in_rows(&second, rows.clone()), both);
            prop_assert_eq!(first.or_count(&second), count(|x, y| x || y));
            prop_assert_eq!(first.and_not_count(&second), count(|x, y| x && !y));
            prop_assert_eq!(first.intersects(&second), count(|x, y| x && y) > 0);
            let pixels: Vec<(u32, u32)> = first.pixels().collect();
            let expected: Vec<(u32, u32)> = (0..width * height)
                .filter(|&index| a[index as usize])
                .map(|index| (index % width, index / width))
                .collect();
            prop_assert_eq!(first.bounding_box(), plain_box(&expected));
            prop_assert_eq!(pixels, expected);
            let mut union = first.clone();
            union.union_with(&second);
            prop_assert_eq!(union.area(), count(|x, y| x || y));
        }
    }

    fn plain_box(pixels: &[(u32, u32)]) -> Option<PixelBox> {
        let cols = || pixels.iter().map(|pixel| pixel.0);
        let rows = || pixels.iter().map(|pixel| pixel.1);
        Some(PixelBox {
            first_col: cols().min()?,
            first_row: rows().min()?,
            last_col: cols().max()?,
            last_row: rows().max()?,
        })
    }

    #[test]
    fn a_full_mask_has_no_padding_bits() {
        for width in [1, 63, 64, 65, 127, 128, 130] {
            let full = Mask::full(width, 3);
            assert_eq!(full.area(), u64::from(width) * 3);
            assert_eq!(full, Mask::from_fn(width, 3, |_, _| true));
        }
    }

    #[test]
    fn set_and_get_touch_one_pixel() {
        let mut mask = Mask::empty(70, 2);
        mask.set(65, 1, true);
        assert!(mask.get(65, 1) && !mask.get(65, 0) && !mask.get(70, 1) && !mask.get(0, 2));
        assert_eq!(mask.area(), 1);
        mask.set(65, 1, false);
        assert!(mask.is_empty());
        assert_eq!(mask.bounding_box(), None);
    }

    #[test]
    fn ids_select_their_pixels() {
        let mask = Mask::from_ids(2, 2, &[7, 0, 7, 1001], 7).unwrap();
        assert_eq!(mask.pixels().collect::<Vec<_>>(), [(0, 0), (0, 1)]);
        assert!(Mask::from_ids(2, 2, &[7, 0, 7], 7).is_err());
    }

    #[test]
    fn nearest_resizing_takes_the_pixel_under_the_centre() {
        let mask = Mask::from_fn(4, 2, |col, _| col >= 2);
        assert_eq!(mask.resized_nearest(8, 4), Mask::from_fn(8, 4, |col, _| col >= 4));
        assert_eq!(mask.resized_nearest(2, 1), Mask::from_fn(2, 1, |col, _| col >= 1));
        assert_eq!(mask.resized_nearest(4, 2), mask);
    }
}
