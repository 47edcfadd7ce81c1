//! COCO's compressed run lengths: the text form of masks in truth and results.
//!
//! Runs alternate between outside and inside, start with outside, and go down the columns, as in pycocotools
//! (`mask.encode(numpy.asfortranarray(m))["counts"]`). From the fourth run on, each is stored as the difference
//! to the one two before it; numbers are written in groups of five bits, least significant first, as characters
//! `0` to `o`. Text that pycocotools writes decodes here, and masks encode here to the very same text.

mod canonical;

use crate::mask::Mask;
use crate::runs::Runs;

/// The character of zero.
const ZERO: u8 = b'0';
/// Characters that a number may have, five bits each: a run fits 32 bits, a difference of runs 33.
const LONGEST: usize = 7;

/// Why a text is no mask of the size that was asked for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RleError {
    /// No decoder should make room for this.
    #[error("a mask of {width}x{height} is refused: each side must have 1 to {} pixels", Mask::MAX_SIDE)]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// A character outside `0` to `o`.
    #[error("byte {offset} is {}, but run lengths use the characters `0` to `o`", escaped(*byte))]
    Byte {
        /// Offset in the text.
        offset: usize,
        /// What stands there.
        byte: u8,
    },
    /// The text stops inside a number.
    #[error("ends inside a number")]
    Truncated,
    /// A number of more than 35 bits.
    #[error("the number at byte {offset} overflows")]
    Overflow {
        /// Offset in the text.
        offset: usize,
    },
    /// A run below zero.
    #[error("run {run} has the length {length}")]
    Negative {
        /// Index of the run.
        run: usize,
        /// Its length.
        length: i64,
    },
    /// The runs cover another number of pixels.
    #[error("the runs cover {} pixels, but {width}x{height} has {pixels}", at_least(*covered, *pixels))]
    Total {
        /// Pixels covered up to the run that went too far, or by all.
        covered: u64,
        /// Pixels of the mask.
        pixels: u64,
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// More runs than pixels: runs of length zero, again and again.
    #[error("has more runs than the mask has pixels")]
    TooManyRuns,
}

/// Decodes compressed counts to a mask.
pub fn decode(counts: &str, width: u32, height: u32) -> Result<Mask, RleError> {
    let mut columns = Columns::new(width, height)?;
    read(counts, width, height, |start, end| columns.fill(start.into(), end.into()))?;
    Ok(columns.into_mask())
}

/// Decodes compressed counts to runs; refuses what [`decode`] refuses.
pub fn decode_runs(counts: &str, width: u32, height: u32) -> Result<Runs, RleError> {
    let mut runs = Runs::new(width, height);
    decode_runs_into(counts, &mut runs)?;
    Ok(runs)
}

/// Decodes compressed counts in the place of other runs of the same size, which saves making room for one mask after
/// another. What is refused leaves no runs.
pub fn decode_runs_into(counts: &str, runs: &mut Runs) -> Result<(), RleError> {
    let (width, height) = runs.size();
    if !Mask::is_sane_size(width, height) {
        return Err(RleError::Size { width, height });
    }
    // Sane sizes have less than 2^32 pixels.
    let is_canonical = runs.refill(|edges| canonical::read_edges(counts, width * height, edges));
    if is_canonical { Ok(()) } else { read_runs(counts, runs) }
}

/// [`decode_runs_into`] of any text, character by character: the reference.
fn read_runs(counts: &str, runs: &mut Runs) -> Result<(), RleError> {
    let (width, height) = runs.size();
    runs.clear();
    let read = read(counts, width, height, |start, end| runs.push(start, end));
    read.inspect_err(|_| runs.clear())
}

/// The runs of a mask.
pub(crate) fn runs_of(mask: &Mask) -> Runs {
    let (width, height) = mask.size();
    let mut runs = Runs::new(width, height);
    let mut start = 0_u32;
    for (index, length) in Columns::from_mask(mask).runs().into_iter().enumerate() {
        let end = start + length as u32;
        if index % 2 == 1 {
            runs.push(start, end);
        }
        start = end;
    }
    runs
}

pub(crate) fn draw(runs: &Runs) -> Mask {
    let (width, height) = runs.size();
    let mut columns = Columns::empty(width, height);
    runs.runs().iter().for_each(|&[start, end]| columns.fill(start.into(), end.into()));
    columns.into_mask()
}

/// Tells the runs inside of a mask of sane size, ascending, empty ones included.
fn read(counts: &str, width: u32, height: u32, mut inside: impl FnMut(u32, u32)) -> Result<(), RleError> {
    let pixels = u64::from(width) * u64::from(height);
    let mut numbers = Numbers { bytes: counts.as_bytes(), offset: 0 };
    let mut start = 0_u64;
    let mut before = [0_i64; 2];
    let mut run = 0;
    while let Some(number) = numbers.next()? {
        let length = if run > 2 { number + before[run % 2] } else { number };
        if length < 0 {
            return Err(RleError::Negative { run, length });
        }
        if run as u64 > pixels {
            return Err(RleError::TooManyRuns);
        }
        let end = start + length as u64;
        if end > pixels {
            return Err(RleError::Total { covered: end, pixels, width, height });
        }
        if run % 2 == 1 {
            // Sane sizes have less than 2^32 pixels.
            inside(start as u32, end as u32);
        }
        before[run % 2] = length;
        start = end;
        run += 1;
    }
    if start != pixels {
        return Err(RleError::Total { covered: start, pixels, width, height });
    }
    Ok(())
}

/// Encodes a mask to compressed counts.
pub fn encode(mask: &Mask) -> String {
    let mut runs = Columns::from_mask(mask).runs();
    let mut text = String::new();
    for index in (0..runs.len()).rev() {
        if index > 2 {
            runs[index] -= runs[index - 2];
        }
    }
    for run in runs {
        push_number(&mut text, run);
    }
    text
}

fn escaped(byte: u8) -> String {
    format!("`{}`", byte.escape_ascii())
}

fn at_least(covered: u64, pixels: u64) -> String {
    if covered > pixels { format!("at least {covered}") } else { covered.to_string() }
}

/// Reads the variable-length numbers of a text.
struct Numbers<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl Numbers<'_> {
    fn next(&mut self) -> Result<Option<i64>, RleError> {
        let first = self.offset;
        let mut value = 0_i64;
        let mut shift = 0;
        while let Some(&byte) = self.bytes.get(self.offset) {
            if !(ZERO..=b'o').contains(&byte) {
                return Err(RleError::Byte { offset: self.offset, byte });
            }
            if self.offset - first == LONGEST {
                return Err(RleError::Overflow { offset: first });
            }
            let group = i64::from(byte - ZERO);
            value |= (group & 0x1f) << shift;
            shift += 5;
            self.offset += 1;
            if group & 0x20 == 0 {
                let is_negative = group & 0x10 != 0;
                return Ok(Some(if is_negative { value | (-1 << shift) } else { value }));
            }
        }
        if self.offset == first { Ok(None) } else { Err(RleError::Truncated) }
    }
}

fn push_number(text: &mut String, mut value: i64) {
    loop {
        let group = (value & 0x1f) as u8;
        value >>= 5;
        let is_last = if group & 0x10 != 0 { value == -1 } else { value == 0 };
        text.push(char::from(ZERO + group + if is_last { 0 } else { 0x20 }));
        if is_last {
            return;
        }
    }
}

/// The mask turned on its side: one row of words a column, so that a run fills whole words. Turning back goes by
/// blocks of 64x64 bits, which beats setting the pixels of a run one by one about fivefold on large masks.
struct Columns {
    width: u32,
    height: u32,
    stride: usize,
    words: Vec<u64>,
}

impl Columns {
    fn new(width: u32, height: u32) -> Result<Self, RleError> {
        if !Mask::is_sane_size(width, height) {
            return Err(RleError::Size { width, height });
        }
        Ok(Self::empty(width, height))
    }

    fn empty(width: u32, height: u32) -> Self {
        let stride = height.div_ceil(64) as usize;
        Self { width, height, stride, words: vec![0; stride * width as usize] }
    }

    fn from_mask(mask: &Mask) -> Self {
        let (width, height) = mask.size();
        let mut columns = Self::empty(width, height);
        let stride = columns.stride;
        for first_col in (0..width).step_by(64) {
            for first_row in (0..height).step_by(64) {
                let mut block = [0; 64];
                for (word, row) in block.iter_mut().zip(first_row..height) {
                    *word = mask.row_words(row)[(first_col / 64) as usize];
                }
                transpose(&mut block);
                for (word, col) in block.iter().zip(first_col..width) {
                    columns.words[col as usize * stride + (first_row / 64) as usize] = *word;
                }
            }
        }
        columns
    }

    fn into_mask(self) -> Mask {
        let mut mask = Mask::empty(self.width, self.height);
        for first_col in (0..self.width).step_by(64) {
            for first_row in (0..self.height).step_by(64) {
                let mut block = [0; 64];
                for (word, col) in block.iter_mut().zip(first_col..self.width) {
                    *word = self.words[col as usize * self.stride + (first_row / 64) as usize];
                }
                transpose(&mut block);
                for (word, row) in block.iter().zip(first_row..self.height) {
                    mask.row_words_mut(row)[(first_col / 64) as usize] = *word;
                }
            }
        }
        mask
    }

    /// Sets the column-major pixels `start..end`.
    fn fill(&mut self, start: u64, end: u64) {
        let height = u64::from(self.height);
        let mut position = start;
        while position < end {
            let (col, row) = (position / height, position % height);
            let length = (end - position).min(height - row);
            let words = &mut self.words[col as usize * self.stride..][..self.stride];
            fill_bits(words, row as usize, (row + length) as usize);
            position += length;
        }
    }

    /// Run lengths, the first outside; the last may be of either kind.
    fn runs(&self) -> Vec<i64> {
        let mut runs = Vec::new();
        let mut is_inside = false;
        let mut length = 0;
        for words in self.words.chunks_exact(self.stride) {
            let mut row = 0;
            while row < self.height {
                let word = words[(row / 64) as usize] >> (row % 64);
                let same = if is_inside { word.trailing_ones() } else { word.trailing_zeros() };
                let step = same.min(64 - row % 64).min(self.height - row);
                length += i64::from(step);
                row += step;
                if step == 0 {
                    runs.push(length);
                    length = 0;
                    is_inside = !is_inside;
                }
            }
        }
        runs.push(length);
        runs
    }
}

fn fill_bits(words: &mut [u64], first: usize, end: usize) {
    let (low, high) = (first / 64, (end - 1) / 64);
    let head = u64::MAX << (first % 64);
    let tail = u64::MAX >> (63 - (end - 1) % 64);
    if low == high {
        words[low] |= head & tail;
    } else {
        words[low] |= head;
        words[low + 1..high].fill(u64::MAX);
        words[high] |= tail;
    }
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn any_mask_round_trips(
            (width, height, pixels) in (1..150_u32, 1..150_u32).prop_flat_map(|(width, height)| {
                (Just(width), Just(height), proptest::collection::vec(any::<bool>(), (width * height) as usize))
            })
        ) {
            let mask = Mask::from_bools(width, height, &pixels).unwrap();
            let runs = decode_runs(&encode(&mask), width, height).unwrap();
            prop_assert_eq!(runs.area(), mask.area());
            prop_assert!(runs.runs().as_flattened().is_sorted_by(|one, next| one < next));
            prop_assert_eq!(&runs.to_mask(), &mask);
            prop_assert_eq!(&Runs::of(&mask), &runs);
            prop_assert_eq!(decode(&encode(&mask), width, height).unwrap(), mask);
        }

        #[test]
        fn long_runs_round_trip(width in 1..200_u32, height in 1..200_u32, cut in any::<u32>()) {
            let cut = cut % (width * height);
            let mask = Mask::from_fn(width, height, |col, row| col * height + row >= cut);
            prop_assert_eq!(decode(&encode(&mask), width, height).unwrap(), mask);
        }

        #[test]
        fn any_text_is_decoded_or_refused(text in "[0-o]{0,60}|\\PC{0,20}") {
            let (mask, runs) = (decode(&text, 9, 7), decode_runs(&text, 9, 7));
            prop_assert_eq!(&runs.map(|runs| runs.to_mask()), &mask);
            prop_assert!(mask.is_err() || mask.unwrap().area() <= 63);
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
            let counts = line["counts"].as_str().unwrap();
            assert_eq!(encode(&mask), counts);
            assert_eq!(decode(counts, mask.width(), mask.height()).unwrap(), mask);
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

    /// 3 wide, 2 high; columns: (0,1), (1,1), (0,0) -> runs 1, 3, 2.
    #[test]
    fn hand_computed_counts() {
        let mask = Mask::from_bools(3, 2, &[false, true, false, true, true, false]).unwrap();
        assert_eq!(encode(&mask), "132");
        assert_eq!(decode("132", 3, 2).unwrap(), mask);
        assert_eq!(encode(&Mask::empty(3, 2)), "6");
        assert_eq!(encode(&Mask::full(3, 2)), "06");
    }

    #[test]
    fn damage_is_named() {
        use RleError::{Byte, Negative, Overflow, Size, TooManyRuns, Total, Truncated};
        let refused = |text: &str| decode(text, 3, 2).unwrap_err();
        assert_eq!(refused(""), Total { covered: 0, pixels: 6, width: 3, height: 2 });
        assert_eq!(refused("13"), Total { covered: 4, pixels: 6, width: 3, height: 2 });
        assert_eq!(refused("137"), Total { covered: 11, pixels: 6, width: 3, height: 2 });
        // `O` alone is the number -1.
        assert_eq!(refused("1O"), Negative { run: 1, length: -1 });
        // The fourth run is a difference to the second: 1 - 2.
        assert_eq!(refused("111N"), Negative { run: 3, length: -1 });
        assert_eq!(refused("1 3"), Byte { offset: 1, byte: b' ' });
        assert_eq!(refused("1p"), Byte { offset: 1, byte: b'p' });
        assert_eq!(refused("1P"), Truncated);
        assert_eq!(refused("1PPPPPPPP1"), Overflow { offset: 1 });
        assert_eq!(refused(&"0".repeat(1000)), TooManyRuns);
        assert_eq!(decode("0", 0, 5).unwrap_err(), Size { width: 0, height: 5 });
        assert_eq!(decode("0", 100_000, 100_000).unwrap_err(), Size { width: 100_000, height: 100_000 });
        assert!(decode("0", u32::MAX, 1).is_err());
    }
}
