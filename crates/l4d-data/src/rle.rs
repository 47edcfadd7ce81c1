//! COCO's compressed run lengths: the text form of masks in truth and results.
//!
//! Runs alternate between outside and inside, start with outside, and go down the columns, as in pycocotools
//! (`mask.encode(numpy.asfortranarray(m))["counts"]`). From the fourth run on, each is stored as the difference
//! to the one two before it; numbers are written in groups of five bits, least significant first, as characters
//! `0` to `o`.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Visitor};
use serde::ser::{Serialize, Serializer};

/// The character of zero.
const ZERO: u8 = b'0';
/// Characters that a number may have, five bits each: a run fits 32 bits, a difference of runs 33.
const LONGEST: usize = 7;
/// No mask has a longer side, pixels: far above any profile, and a bound on the memory that a file can ask for.
pub const MAX_SIDE: u32 = 8192;

/// A mask as runs down the columns of a picture, one column after the other; in files the text of its compressed counts.
/// Width and height are stated beside it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Rle {
    /// First pixel of every run and the one past its last, ascending.
    edges: Vec<u32>,
    pixels: u32,
}

/// Why a text is no mask.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RleError {
    /// No side may be 0 or above [`MAX_SIDE`].
    #[error("a mask of {0}x{1} is refused: each side must have 1 to {MAX_SIDE} pixels")]
    Size(u32, u32),
    /// The text is no list of run lengths.
    #[error("{0}")]
    Malformed(String),
    /// The runs cover another number of pixels.
    #[error("the runs cover {covered} pixels, but {width}x{height} has {}", u64::from(*width) * u64::from(*height))]
    Total {
        /// Pixels that are covered, or "at least" so many.
        covered: String,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}

impl RleError {
    /// What to do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Size(..) | Self::Total { .. } => "encode a mask of exactly the stated [height, width]",
            Self::Malformed(_) => {
                "write what pycocotools' mask.encode gives as `counts` (compressed, column-major)"
            }
        }
    }
}

/// Whether a mask may have that size: no side is 0 or above [`MAX_SIDE`].
pub fn is_sane_size(width: u32, height: u32) -> bool {
    (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height)
}

impl Rle {
    /// No pixel of so many.
    pub fn empty(pixels: u32) -> Self {
        Self { edges: Vec::new(), pixels }
    }

    /// The mask of a picture of a known size from its compressed counts.
    ///
    /// # Errors
    /// Text that is no such mask.
    pub fn decode(counts: &str, width: u32, height: u32) -> Result<Self, RleError> {
        let mut rle = Self::default();
        rle.decode_into(counts, width, height)?;
        Ok(rle)
    }

    /// The mask of so many pixels from lengths of runs, outside first; none if they cover another number.
    pub fn from_lengths(lengths: impl IntoIterator<Item = u64>, pixels: u32) -> Option<Self> {
        let mut rle = Self::empty(pixels);
        let mut start = 0_u32;
        for (run, length) in lengths.into_iter().enumerate() {
            let end = u64::from(start).checked_add(length).filter(|end| *end <= u64::from(pixels))? as u32;
            if run % 2 == 1 {
                rle.push(start, end);
            }
            start = end;
        }
        (start == pixels).then_some(rle)
    }

    /// [`Self::decode`] in the place of another mask, whose memory it takes.
    ///
    /// # Errors
    /// Text that is no such mask; then this one is empty.
    pub fn decode_into(&mut self, counts: &str, width: u32, height: u32) -> Result<(), RleError> {
        if !is_sane_size(width, height) {
            return Err(RleError::Size(width, height));
        }
        *self = Self { edges: std::mem::take(&mut self.edges), pixels: width * height };
        let covered = self.read(counts)?;
        if covered == u64::from(self.pixels) {
            return Ok(());
        }
        self.edges.clear();
        let at_least = if covered > u64::from(self.pixels) { "at least " } else { "" };
        Err(RleError::Total { covered: format!("{at_least}{covered}"), width, height })
    }

    /// What is wrong with this mask in a picture of that size, if anything.
    pub fn misfit(&self, width: u32, height: u32) -> Option<RleError> {
        if !is_sane_size(width, height) {
            return Some(RleError::Size(width, height));
        }
        let is_right = self.pixels == width * height;
        (!is_right).then(|| RleError::Total { covered: self.pixels.to_string(), width, height })
    }

    /// Reads counts as runs until they cover more than all pixels. Gives how many they cover.
    fn read(&mut self, counts: &str) -> Result<u64, RleError> {
        self.edges.clear();
        let read = self.read_runs(counts.as_bytes());
        read.inspect_err(|_| self.edges.clear())
    }

    fn read_runs(&mut self, counts: &[u8]) -> Result<u64, RleError> {
        let mut offset = 0;
        let mut covered = 0;
        let mut before = [0; 2];
        let mut run = 0;
        while offset < counts.len() {
            let number = read_number(counts, &mut offset)?;
            let length = if run > 2 { number + before[run % 2] } else { number };
            if length < 0 {
                return Err(RleError::Malformed(format!("run {run} has the length {length}")));
            }
            let start = covered;
            covered += length as u64;
            if covered > u64::from(self.pixels) {
                break;
            }
            if run % 2 == 1 {
                // No more than all pixels, which are fewer than 2^32.
                self.push(start as u32, covered as u32);
            }
            before[run % 2] = length;
            run += 1;
        }
        Ok(covered)
    }

    /// Appends the pixels `start..end`, which come after all others.
    ///
    /// # Panics
    /// If the run begins before the end of the last one or ends beyond the picture.
    pub fn push(&mut self, start: u32, end: u32) {
        assert!(start <= end && end <= self.pixels, "{start}..{end} of {} pixels", self.pixels);
        if start == end {
            return;
        }
        match self.edges.last_mut() {
            Some(last) if *last >= start => {
                assert_eq!(*last, start, "runs ascend");
                *last = end;
            }
            _ => self.edges.extend([start, end]),
        }
    }

    /// Gives back memory that the runs do not need: for masks that are kept.
    pub fn shrink_to_fit(&mut self) {
        self.edges.shrink_to_fit();
    }

    /// The first pixel of every run and the one past its last; pixel `column * height + row`.
    pub fn runs(&self) -> &[[u32; 2]] {
        self.edges.as_chunks().0
    }

    /// Pixels of the picture.
    pub fn pixels(&self) -> u32 {
        self.pixels
    }

    /// Pixels inside.
    pub fn area(&self) -> u64 {
        self.runs().iter().map(|[start, end]| u64::from(end - start)).sum()
    }

    /// Pixels inside one of the two and not the other; both belong to pictures of one size.
    pub fn difference(&self, other: &Self) -> u64 {
        // Each edge of either mask begins or ends a stretch in which they differ.
        let mut edges = [self.edges.as_slice(), &other.edges].concat();
        edges.sort_unstable();
        edges.as_chunks().0.iter().map(|[start, end]| u64::from(end - start)).sum()
    }

    /// Whether no pixel is inside.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// The text of compressed counts, as pycocotools writes it.
    pub fn counts(&self) -> String {
        let end = self.edges.last().copied().unwrap_or(0);
        let tail = (end < self.pixels).then_some(self.pixels);
        let mut start = 0;
        let lengths: Vec<i64> = self
            .edges
            .iter()
            .copied()
            .chain(tail)
            .map(|edge| i64::from(edge) - std::mem::replace(&mut start, i64::from(edge)))
            .collect();
        let mut text = String::new();
        for (run, &length) in lengths.iter().enumerate() {
            push_number(&mut text, if run > 2 { length - lengths[run - 2] } else { length });
        }
        text
    }
}

impl Serialize for Rle {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.counts())
    }
}

impl<'de> Deserialize<'de> for Rle {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Counts;

        impl Visitor<'_> for Counts {
            type Value = Rle;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("the text of compressed run lengths")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Rle, E> {
                let mut rle = Rle::empty(MAX_SIDE * MAX_SIDE);
                let covered = rle.read(text).map_err(E::custom)?;
                rle.pixels = u32::try_from(covered)
                    .ok()
                    .filter(|pixels| *pixels <= rle.pixels)
                    .ok_or_else(|| E::custom(format!("the runs cover more than {} pixels", rle.pixels)))?;
                rle.shrink_to_fit();
                Ok(rle)
            }
        }

        deserializer.deserialize_str(Counts)
    }
}

/// Reads the number at an offset, and moves that behind it.
#[inline(always)]
fn read_number(text: &[u8], offset: &mut usize) -> Result<i64, RleError> {
    const GOES_ON: u8 = 0x20;
    let first = *offset;
    let mut value = 0;
    for (digit, byte) in text[first..].iter().take(LONGEST).enumerate() {
        let group = byte.wrapping_sub(ZERO);
        if group >= 2 * GOES_ON {
            return Err(RleError::Malformed(format!(
                "byte {} is `{}`, but run lengths use the characters `0` to `o`",
                first + digit,
                byte.escape_ascii()
            )));
        }
        value |= i64::from(group & (GOES_ON - 1)) << (5 * digit);
        if group < GOES_ON {
            *offset = first + digit + 1;
            // The highest bit is the sign.
            let unused = 64 - 5 * (digit + 1);
            return Ok(value << unused >> unused);
        }
    }
    let is_cut = text.len() < first + LONGEST + 1;
    Err(RleError::Malformed(match is_cut {
        true => "ends inside a number".to_owned(),
        false => format!("the number at byte {first} overflows"),
    }))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn rle(pixels: u32, runs: &[[u32; 2]]) -> Rle {
        let mut rle = Rle::empty(pixels);
        runs.iter().for_each(|&[start, end]| rle.push(start, end));
        rle
    }

    #[test]
    fn hand_computed_counts() {
        for (counts, runs) in
            [("132", &[[1, 4]][..]), ("6", &[]), ("06", &[[0, 6]]), ("11101", &[[1, 2], [3, 4]])]
        {
            let mask = rle(6, runs);
            assert_eq!(Rle::decode(counts, 3, 2).as_ref(), Ok(&mask), "{counts}");
            assert_eq!(serde_json::from_str::<Rle>(&format!("\"{counts}\"")).unwrap(), mask);
            assert_eq!(mask.counts(), counts);
        }
        // Empty runs are read and left out.
        assert_eq!(Rle::decode("6P0", 3, 2), Rle::decode("60", 3, 2));
        assert_eq!(rle(6, &[[0, 2], [2, 3]]), rle(6, &[[0, 3]]));
    }

    #[test]
    fn differences_are_counted() {
        let mask = rle(20, &[[2, 6], [8, 10]]);
        let others: [(&[[u32; 2]], u64); 4] =
            [(&[[2, 6], [8, 10]], 0), (&[], 6), (&[[6, 8], [10, 20]], 18), (&[[4, 9]], 5)];
        for (runs, pixels) in others {
            let other = rle(20, runs);
            assert_eq!((mask.difference(&other), other.difference(&mask)), (pixels, pixels), "{runs:?}");
        }
    }

    #[test]
    fn damage_is_named() {
        for (counts, said) in [
            ("", "cover 0 pixels, but 3x2 has 6"),
            ("13", "cover 4 pixels"),
            ("137", "cover at least 11 pixels"),
            // `O` alone is the number -1; the fourth run is a difference to the second: 1 - 2.
            ("1O", "run 1 has the length -1"),
            ("111N", "run 3 has the length -1"),
            ("1 3", "byte 1 is ` `"),
            ("1p", "byte 1 is `p`"),
            ("1P", "ends inside a number"),
            ("1PPPPPPPP1", "the number at byte 1 overflows"),
            (&"0".repeat(1000), "cover 0 pixels"),
        ] {
            let error = Rle::decode(counts, 3, 2).unwrap_err().to_string();
            assert!(error.contains(said), "{counts}: {error}");
        }
        for (width, height) in [(0, 5), (100_000, 100_000), (u32::MAX, 1)] {
            assert_eq!(Rle::decode("0", width, height), Err(RleError::Size(width, height)));
        }
        assert!(serde_json::from_str::<Rle>("\"1P\"").unwrap_err().to_string().contains("inside a number"));
        assert!(serde_json::from_str::<Rle>("\"PPPPP21\"").unwrap_err().to_string().contains("more than"));
    }
}
