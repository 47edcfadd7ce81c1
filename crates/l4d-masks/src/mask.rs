//! One bit per pixel: which pixels of a picture belong to something.
//!
//! Rows follow each other, each starts in a word of its own, and bit 0 of a word is its leftmost pixel. Bits
//! beyond the width are always zero, so that counting never masks and equal masks have equal words.

use std::ops::Range;

use l4d_data::rle::{self, Rle, RleError};

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

/// A buffer that does not hold one value per pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{found} values do not fill {width}x{height} pixels")]
pub struct LengthError {
    found: usize,
    width: u32,
    height: u32,
}

impl Mask {
    /// Longest side of a mask in a file, pixels.
    pub const MAX_SIDE: u32 = rle::MAX_SIDE;

    /// Whether a decoder may make room for such a mask: it has pixels and no side above [`Self::MAX_SIDE`].
    pub fn is_sane_size(width: u32, height: u32) -> bool {
        rle::is_sane_size(width, height)
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
    ///
    /// # Errors
    /// A buffer of another length.
    pub fn from_bools(width: u32, height: u32, pixels: &[bool]) -> Result<Self, LengthError> {
        check_length(width, height, pixels.len())?;
        Ok(Self::from_fn(width, height, |col, row| pixels[row as usize * width as usize + col as usize]))
    }

    /// The pixels of a row-major id buffer that show `id`.
    ///
    /// # Errors
    /// A buffer of another length.
    pub fn from_ids(width: u32, height: u32, ids: &[u32], id: u32) -> Result<Self, LengthError> {
        check_length(width, height, ids.len())?;
        Ok(Self::from_fn(width, height, |col, row| ids[row as usize * width as usize + col as usize] == id))
    }

    /// One bool per pixel, row-major.
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

    /// Intersection over union: 1 for equal masks, 0 for disjoint ones; none if both are empty.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn iou(&self, other: &Self) -> Option<f64> {
        iou(self.and_count(other), self.or_count(other))
    }

    /// The smallest box around all pixels; none if there is no pixel.
    pub fn bounding_box(&self) -> Option<PixelBox> {
        let mut rows = (0..self.height).filter(|&row| self.row_words(row).iter().any(|&word| word != 0));
        let first_row = rows.next()?;
        let last_row = rows.next_back().unwrap_or(first_row);
        let runs = || (first_row..=last_row).flat_map(|row| self.runs_of_row(row));
        let first_col = runs().map(|run| run.start).min()?;
        let last_col = runs().map(|run| run.end - 1).max()?;
        Some(PixelBox { first_col, first_row, last_col, last_row })
    }

    /// The pixels as `(col, row)`, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.height).flat_map(|row| self.runs_of_row(row).flatten().map(move |col| (col, row)))
    }

    /// Columns of the runs of a row, from left to right.
    pub fn runs_of_row(&self, row: u32) -> impl Iterator<Item = Range<u32>> {
        let words = self.row_words(row);
        let mut from = 0;
        std::iter::from_fn(move || {
            let start = next_bit(words, from, 0)?;
            from = next_bit(words, start, u64::MAX).unwrap_or(self.width);
            Some(start..from)
        })
    }

    /// Adds the pixels of a row in some columns, which may go beyond the right edge.
    pub(crate) fn fill_row(&mut self, row: u32, columns: Range<u32>) {
        let (start, end) = (columns.start, columns.end.min(self.width));
        if start >= end {
            return;
        }
        let (low, high) = ((start / 64) as usize, ((end - 1) / 64) as usize);
        let (head, tail) = (u64::MAX << (start % 64), u64::MAX >> (63 - (end - 1) % 64));
        let words = self.row_words_mut(row);
        if low == high {
            words[low] |= head & tail;
        } else {
            words[low] |= head;
            words[low + 1..high].fill(u64::MAX);
            words[high] |= tail;
        }
    }

    /// The mask of a picture of that size from runs down its columns. Pixels beyond it are left out.
    pub fn from_rle(rle: &Rle, width: u32, height: u32) -> Self {
        // Filled along rows, then turned.
        let mut columns = Self::empty(height, width);
        let mut fill = |start: u32, end: u32| {
            let mut position = start;
            while position < end && position / height < width {
                let (col, row) = (position / height, position % height);
                let length = (end - position).min(height - row);
                columns.fill_row(col, row..row + length);
                position += length;
            }
        };
        if height > 0 {
            rle.runs().iter().for_each(|&[start, end]| fill(start, end));
        }
        columns.transposed()
    }

    /// The mask of COCO's compressed counts.
    ///
    /// # Errors
    /// Text that is no mask of that size.
    pub fn decode(counts: &str, width: u32, height: u32) -> Result<Self, RleError> {
        Ok(Self::from_rle(&Rle::decode(counts, width, height)?, width, height))
    }

    /// The mask as runs down its columns.
    ///
    /// # Panics
    /// If there are 2^32 pixels or more.
    pub fn to_rle(&self) -> Rle {
        let pixels = self.width.checked_mul(self.height).expect("masks have fewer than 2^32 pixels");
        let mut rle = Rle::empty(pixels);
        let columns = self.transposed();
        for col in 0..self.width {
            let first = col * self.height;
            columns.runs_of_row(col).for_each(|run| rle.push(first + run.start, first + run.end));
        }
        rle
    }

    /// Columns become rows. It goes by blocks of 64x64 bits, which is several times as fast as pixel by pixel.
    fn transposed(&self) -> Self {
        let mut turned = Self::empty(self.height, self.width);
        for first_col in (0..self.width).step_by(64) {
            for first_row in (0..self.height).step_by(64) {
                let mut block = [0; 64];
                for (word, row) in block.iter_mut().zip(first_row..self.height) {
                    *word = self.row_words(row)[(first_col / 64) as usize];
                }
                transpose(&mut block);
                for (word, col) in block.iter().zip(first_col..self.width) {
                    turned.row_words_mut(col)[(first_row / 64) as usize] = *word;
                }
            }
        }
        turned
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

/// Size and area.
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

/// The first bit at or after `from` that differs from `flip`, whose bits are all the same.
fn next_bit(words: &[u64], from: u32, flip: u64) -> Option<u32> {
    let mut index = (from / 64) as usize;
    let mut word = (words.get(index)? ^ flip) & (u64::MAX << (from % 64));
    while word == 0 {
        index += 1;
        word = words.get(index)? ^ flip;
    }
    Some(index as u32 * 64 + word.trailing_zeros())
}

/// Transposes 64x64 bits in place by swapping ever smaller halves (Warren, Hacker's Delight, section 7-3).
fn transpose(block: &mut [u64; 64]) {
    let mut half = 32;
    let mut low = u64::MAX >> 32;
    while half > 0 {
        for start in (0..64).step_by(2 * half) {
            for index in start..start + half {
                let swapped = ((block[index] >> half) ^ block[index + half]) & low;
                block[index] ^= swapped << half;
                block[index + half] ^= swapped;
            }
        }
        half /= 2;
        low ^= low << half;
    }
}

/// Intersection over union of two sets by their counts; none if both are empty.
pub fn iou(intersection: u64, union: u64) -> Option<f64> {
    (union > 0).then(|| intersection as f64 / union as f64)
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
        fn long_runs_round_trip(width in 1..200_u32, height in 1..200_u32, cut in any::<u32>()) {
            let cut = cut % (width * height);
            let mask = Mask::from_fn(width, height, |col, row| col * height + row >= cut);
            prop_assert_eq!(Mask::from_rle(&mask.to_rle(), width, height), mask);
        }

        #[test]
        fn any_text_is_decoded_or_refused(text in "[0-o]{0,60}|\\PC{0,20}") {
            let decoded = Rle::decode(&text, 9, 7);
            prop_assert!(decoded.is_err() || decoded.unwrap().area() <= 63);
        }

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
            let rle = first.to_rle();
            prop_assert_eq!(rle.area(), first.area());
            prop_assert!(rle.runs().as_flattened().is_sorted_by(|one, next| one < next));
            prop_assert_eq!(Rle::decode(&rle.counts(), width, height).unwrap(), rle.clone());
            prop_assert_eq!(Mask::from_rle(&rle, width, height), first);
        }
    }

    #[test]
    fn texts_equal_those_of_pycocotools() {
        let lines: Vec<serde_json::Value> = include_str!("../../../tests/data/rle/pycocotools.jsonl")
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        assert!(lines.len() > 30, "the fixture is cut");
        for line in lines {
            let mask = fixture_mask(&line);
            let (width, height) = mask.size();
            let counts = line["counts"].as_str().unwrap();
            assert_eq!(mask.to_rle().counts(), counts);
            assert_eq!(Mask::from_rle(&Rle::decode(counts, width, height).unwrap(), width, height), mask);
        }
    }

    fn fixture_mask(line: &serde_json::Value) -> Mask {
        let side = |name: &str| line[name].as_u64().unwrap() as u32;
        let (width, height) = (side("width"), side("height"));
        if let Some(rows) = line["rows"].as_array() {
            let inside = |col, row| rows[row as usize].as_str().unwrap().as_bytes()[col as usize] == b'#';
            return Mask::from_fn(width, height, inside);
        }
        let hex = line["packed"].as_str().unwrap();
        let bytes: Vec<u8> =
            (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect();
        let stride = width.div_ceil(8);
        Mask::from_fn(width, height, |col, row| {
            bytes[(row * stride + col / 8) as usize] >> (7 - col % 8) & 1 == 1
        })
    }

    #[test]
    fn runs_beyond_a_picture_are_left_out() {
        let mut rle = Rle::empty(100);
        rle.push(2, 50);
        assert_eq!(Mask::from_rle(&rle, 3, 2), Mask::from_fn(3, 2, |col, _| col > 0));
        assert_eq!(Mask::from_rle(&rle, 3, 0), Mask::empty(3, 0));
    }

    #[test]
    fn iou_by_hand() {
        let columns = |first: u32, last: u32| Mask::from_fn(6, 4, |col, _| (first..=last).contains(&col));
        assert_eq!(columns(0, 3).iou(&columns(2, 5)), Some(1.0 / 3.0));
        assert_eq!(columns(0, 3).iou(&Mask::empty(6, 4)), Some(0.0));
        assert_eq!(Mask::empty(6, 4).iou(&Mask::empty(6, 4)), None);
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
