//! An answer in the making: masks as they come, checked against what was asked.

use std::collections::BTreeMap;

use super::protocol::{MaskLine, Segment};
use super::segmenter::{Object, Segmented};

/// More objects than any sentence means.
const MOST_OBJECTS: usize = 64;
/// Remarks about one answer that are kept.
const MOST_REMARKS: usize = 16;

/// What came of a request so far; masks are by index of the frame.
#[derive(Debug)]
pub(super) struct PartialAnswer {
    size: (u32, u32),
    range: [u32; 2],
    objects: BTreeMap<u32, Object>,
}

impl PartialAnswer {
    pub(super) fn new(segment: &Segment<'_>) -> Self {
        let size = (segment.frames.width, segment.frames.height);
        Self { size, range: segment.range, objects: BTreeMap::new() }
    }

    /// Takes a mask; the error says why the whole answer is of no use.
    pub(super) fn add(&mut self, line: &MaskLine) -> Result<(), String> {
        let [first, last] = self.range;
        if !(first..=last).contains(&line.frame) {
            return Err(format!("a mask of frame {}, asked were {first} to {last}", line.frame));
        }
        let mask = line.rle.decode(self.size.0, self.size.1)?;
        if !self.objects.contains_key(&line.object) && self.objects.len() == MOST_OBJECTS {
            return Err(format!("more than {MOST_OBJECTS} objects"));
        }
        let found = self.objects.entry(line.object).or_default();
        if found.masks.insert(line.frame, mask).is_some() {
            return Err(format!("two masks of object {} in frame {}", line.object, line.frame));
        }
        found.score = match (found.score, line.score) {
            (Some(before), Some(score)) => Some(before.max(score)),
            (before, score) => before.or(score),
        };
        Ok(())
    }

    /// The whole answer, with the steps that the worker left out.
    pub(super) fn finish(self, skipped: &[String]) -> Segmented {
        let skipped = skipped.iter().take(MOST_REMARKS).map(|remark| crate::plan::clean(remark, 200));
        Segmented { objects: self.objects.into_values().collect(), skipped: skipped.collect() }
    }
}
