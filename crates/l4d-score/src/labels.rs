//! Who shows where in one frame, as one list for all instances.
//!
//! Rendered ids are disjoint, so a prediction that comes as runs meets every instance in one pass, and nothing is drawn.
//! It is the fast path of [`crate::judge`]; where instances overlap there is none.

use l4d_frames::Runs;

use crate::truth::TruthMask;

/// Pixels in a block: few stretches begin in one.
const BLOCK: u32 = 128;

/// The picture, column by column, as stretches of pixels that show the same instance or none.
#[derive(Debug, Clone)]
pub struct Labels {
    /// One past the last pixel of every stretch, ascending; the last stretch ends with the picture.
    ends: Vec<u32>,
    /// What it shows: the index of an instance, or their number for nothing.
    shown: Vec<u16>,
    /// The stretch that the first pixel of every block belongs to.
    blocks: Vec<u32>,
    instances: u16,
}

impl Labels {
    /// The masks of the instances in their order, none where nothing is visible; no labels if two share a pixel.
    pub(crate) fn new<'a>(
        (width, height): (u32, u32),
        masks: impl Iterator<Item = Option<&'a TruthMask>>,
    ) -> Option<Self> {
        let mut spans = Vec::new();
        let mut instances = 0_u16;
        for mask in masks {
            let runs = mask.map_or(&[][..], |mask| mask.runs().runs());
            spans.extend(runs.iter().map(|&[start, end]| (start, end, instances)));
            // More than there are ids.
            instances = instances.checked_add(1)?;
        }
        // Each instance brings its runs in order: a stable sort finds that and merges.
        spans.sort_by_key(|&(start, ..)| start);
        let mut labels = Self::empty(width * height, 2 * spans.len() + 1, instances);
        let mut covered = 0;
        for (start, end, instance) in spans {
            if start < covered {
                return None;
            }
            if start > covered {
                labels.push(start, instances);
            }
            labels.push(end, instance);
            covered = end;
        }
        if covered < width * height {
            labels.push(width * height, instances);
        }
        Some(labels)
    }

    fn empty(pixels: u32, stretches: usize, instances: u16) -> Self {
        Self {
            ends: Vec::with_capacity(stretches),
            shown: Vec::with_capacity(stretches),
            blocks: Vec::with_capacity(pixels.div_ceil(BLOCK) as usize),
            instances,
        }
    }

    fn push(&mut self, end: u32, shown: u16) {
        self.blocks.resize(end.div_ceil(BLOCK) as usize, self.ends.len() as u32);
        self.ends.push(end);
        self.shown.push(shown);
    }

    /// Pixels that a prediction of the same size shares with each instance.
    pub fn overlaps(&self, predicted: &Runs) -> Vec<u64> {
        let mut overlaps = vec![0; usize::from(self.instances) + 1];
        for &[start, end] in predicted.runs() {
            let mut stretch = self.blocks[(start / BLOCK) as usize] as usize;
            // Without a branch at first: whether there is an edge between is a toss-up that no processor can guess.
            stretch += usize::from(self.ends[stretch] <= start);
            stretch += usize::from(self.ends[stretch] <= start);
            while self.ends[stretch] <= start {
                stretch += 1;
            }
            let mut from = start;
            while self.ends[stretch] < end {
                overlaps[usize::from(self.shown[stretch])] += u64::from(self.ends[stretch] - from);
                from = self.ends[stretch];
                stretch += 1;
            }
            overlaps[usize::from(self.shown[stretch])] += u64::from(end - from);
        }
        overlaps.truncate(self.instances.into());
        overlaps
    }
}
