//! A mask as runs down its columns: what compressed run lengths say, without a pixel drawn.
//!
//! Comparing two masks of a thousand runs takes a thousand steps, where drawing them takes one a pixel.

use crate::mask::Mask;
use crate::rle;

/// Pixels in columns one after the other, from `start` to before `end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Run {
    /// First pixel: column times height plus row.
    pub start: u32,
    /// One past the last.
    pub end: u32,
}

/// The inside of a mask of fixed size: runs, ascending, none empty, none touching the next.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Runs {
    width: u32,
    height: u32,
    runs: Vec<Run>,
    area: u64,
}

impl Runs {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self { width, height, runs: Vec::new(), area: 0 }
    }

    /// The runs of a mask.
    pub fn of(mask: &Mask) -> Self {
        rle::runs_of(mask)
    }

    pub(crate) fn reserve(&mut self, runs: usize) {
        self.runs.reserve(runs);
    }

    /// Appends a run at or after the end of the last one.
    pub(crate) fn push(&mut self, start: u32, end: u32) {
        if start == end {
            return;
        }
        self.area += u64::from(end - start);
        match self.runs.last_mut() {
            Some(last) if last.end == start => last.end = end,
            _ => self.runs.push(Run { start, end }),
        }
    }

    /// `(width, height)`, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Number of pixels.
    pub fn area(&self) -> u64 {
        self.area
    }

    /// The runs.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// The pixels.
    pub fn to_mask(&self) -> Mask {
        rle::draw(self)
    }
}
