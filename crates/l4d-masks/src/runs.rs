//! A mask as runs down its columns: what compressed run lengths say, without a pixel drawn.
//!
//! Comparing two masks of a thousand runs takes a thousand steps, where drawing them takes one a pixel.

use crate::mask::Mask;
use crate::rle;

/// The inside of a mask of fixed size: runs, ascending, none empty, none touching the next.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Runs {
    width: u32,
    height: u32,
    /// Start and end of every run, so that each is larger than the one before.
    edges: Vec<u32>,
    area: u64,
}

impl Runs {
    /// No pixel.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, edges: Vec::new(), area: 0 }
    }

    /// Lets `fill` write ascending starts and ends of runs that do not touch; no runs where it gives false.
    pub(crate) fn refill(&mut self, fill: impl FnOnce(&mut Vec<u32>) -> bool) -> bool {
        let is_filled = fill(&mut self.edges);
        if is_filled {
            // No more than a mask of sane size has pixels.
            let area: u32 = self.runs().iter().map(|[start, end]| end - start).sum();
            self.area = area.into();
        } else {
            self.clear();
        }
        is_filled
    }

    pub(crate) fn clear(&mut self) {
        self.edges.clear();
        self.area = 0;
    }

    /// The runs of a mask.
    pub fn of(mask: &Mask) -> Self {
        rle::runs_of(mask)
    }

    /// Appends a run at or after the end of the last one.
    pub(crate) fn push(&mut self, start: u32, end: u32) {
        if start == end {
            return;
        }
        self.area += u64::from(end - start);
        match self.edges.last_mut() {
            Some(last) if *last == start => *last = end,
            _ => self.edges.extend([start, end]),
        }
    }

    /// Gives back room that decoding took and the runs do not need: for those that are kept.
    pub fn shrink_to_fit(&mut self) {
        self.edges.shrink_to_fit();
    }

    /// `(width, height)`, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Number of pixels.
    pub fn area(&self) -> u64 {
        self.area
    }

    /// Pixels in columns one after the other: the first of a run (column times height plus row), and one past its last.
    pub fn runs(&self) -> &[[u32; 2]] {
        self.edges.as_chunks().0
    }

    /// The pixels.
    pub fn to_mask(&self) -> Mask {
        rle::draw(self)
    }
}
