//! Who shows where in one frame, as one list for all instances.
//!
//! Rendered ids are disjoint, so a prediction that comes as runs meets every instance in one pass, and nothing is drawn.
//! It is the fast path of [`crate::judge`]; where instances overlap there is none.

use l4d_masks::Rle;

use crate::truth::TruthMask;

/// Pixels in a block: hardly any holds more than two edges.
const BLOCK: u32 = 64;
/// Stretches that are looked at for most runs: up to two before it, the one that it starts in, and the next.
const AHEAD: usize = 4;

/// Pixels that show the same instance or none.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    /// One past the last.
    end: u32,
    /// The index of an instance, or their number for nothing.
    shown: u32,
}

/// The picture, column by column, as stretches.
#[derive(Debug, Clone)]
pub struct Labels {
    /// Ascending; after the last of the picture come [`AHEAD`] that no pixel is in.
    stretches: Vec<Stretch>,
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
            let runs = mask.map_or(&[][..], |mask| mask.rle().runs());
            spans.extend(runs.iter().map(|&[start, end]| (start, end, instances)));
            // More than there are ids.
            instances = instances.checked_add(1)?;
        }
        // Each instance brings its runs in order: a stable sort finds that and merges.
        spans.sort_by_key(|&(start, ..)| start);
        let mut labels = Self::empty(width * height, 2 * spans.len() + 1, instances);
        let nothing = u32::from(instances);
        let mut covered = 0;
        for (start, end, instance) in spans {
            if start < covered {
                return None;
            }
            if start > covered {
                labels.push(Stretch { end: start, shown: nothing });
            }
            labels.push(Stretch { end, shown: instance.into() });
            covered = end;
        }
        if covered < width * height {
            labels.push(Stretch { end: width * height, shown: nothing });
        }
        labels.stretches.extend([Stretch { end: u32::MAX, shown: nothing }; AHEAD]);
        Some(labels)
    }

    fn empty(pixels: u32, stretches: usize, instances: u16) -> Self {
        Self {
            stretches: Vec::with_capacity(stretches + AHEAD),
            blocks: Vec::with_capacity(pixels.div_ceil(BLOCK) as usize),
            instances,
        }
    }

    fn push(&mut self, stretch: Stretch) {
        self.blocks.resize(stretch.end.div_ceil(BLOCK) as usize, self.stretches.len() as u32);
        self.stretches.push(stretch);
    }

    /// Pixels that a prediction of the same size shares with each instance.
    pub fn overlaps(&self, predicted: &Rle) -> Vec<u64> {
        let kinds = usize::from(self.instances) + 1;
        // Of what a run starts in, and of what comes next: one sum would make every run wait for the one before.
        let mut sums = vec![0; 2 * kinds];
        let (of_first, of_next) = sums.split_at_mut(kinds);
        for &[start, end] in predicted.runs() {
            let stretches = &self.stretches[self.blocks[(start / BLOCK) as usize] as usize..];
            let ahead = stretches.first_chunk::<AHEAD>().expect("so many come after the last of the picture");
            // Without a branch: whether there is an edge before or in a run is a toss-up that no processor can guess.
            let skipped = usize::from(ahead[0].end <= start) + usize::from(ahead[1].end <= start);
            let (first, next) = (ahead[skipped], ahead[skipped + 1]);
            if first.end <= start || next.end < end {
                add_stretches(stretches, start, end, of_first);
                continue;
            }
            let edge = first.end.min(end);
            of_first[first.shown as usize] += u64::from(edge - start);
            of_next[next.shown as usize] += u64::from(end - edge);
        }
        of_first.iter_mut().zip(of_next).for_each(|(first, next)| *first += *next);
        sums.truncate(self.instances.into());
        sums
    }
}

/// Adds what a run shares with each of any number of stretches.
fn add_stretches(stretches: &[Stretch], start: u32, end: u32, sums: &mut [u64]) {
    let mut from = start;
    for stretch in stretches.iter().skip_while(|stretch| stretch.end <= start) {
        let to = stretch.end.min(end);
        sums[stretch.shown as usize] += u64::from(to - from);
        if to == end {
            return;
        }
        from = to;
    }
}
