//! Who shows where in one frame: the runs of all instances in one list.
//!
//! Rendered ids are disjoint, so a prediction that comes as runs meets every instance in one pass over the two lists, and
//! nothing is drawn. It is the fast path of [`crate::judge`]; where instances overlap there is none.

use l4d_frames::Runs;
use l4d_frames::runs::Run;

use crate::truth::TruthMask;

/// Runs of all instances of a frame, ascending and disjoint.
#[derive(Debug, Clone)]
pub struct Labels {
    height: u32,
    spans: Vec<Span>,
    /// For every column the first span that does not end before it.
    columns: Vec<u32>,
    instances: usize,
}

#[derive(Debug, Clone, Copy)]
struct Span {
    run: Run,
    instance: u32,
}

impl Labels {
    /// The masks of the instances in their order, none where nothing is visible; no labels if two share a pixel.
    pub(crate) fn new<'a>(
        (width, height): (u32, u32),
        masks: impl Iterator<Item = Option<&'a TruthMask>>,
    ) -> Option<Self> {
        let mut spans = Vec::new();
        let mut instances = 0;
        for mask in masks {
            let runs = mask.map_or(&[][..], |mask| mask.runs().runs());
            spans.extend(runs.iter().map(|&run| Span { run, instance: instances as u32 }));
            instances += 1;
        }
        // Each instance brings its runs in order: a stable sort finds that and merges.
        spans.sort_by_key(|span| span.run.start);
        if spans.windows(2).any(|pair| pair[1].run.start < pair[0].run.end) {
            return None;
        }
        let mut first = 0;
        let columns = (0..width).map(|col| {
            while spans.get(first).is_some_and(|span: &Span| span.run.end <= col * height) {
                first += 1;
            }
            first as u32
        });
        let columns = columns.collect();
        Some(Self { height, spans, columns, instances })
    }

    /// Pixels that a prediction of the same size shares with each instance.
    pub fn overlaps(&self, predicted: &Runs) -> Vec<u64> {
        let mut overlaps = vec![0; self.instances];
        let mut next = 0;
        for run in predicted.runs() {
            // What the last run met its end in may go on under this one.
            next = next.max(self.columns[(run.start / self.height) as usize] as usize);
            while self.spans.get(next).is_some_and(|span| span.run.end <= run.start) {
                next += 1;
            }
            let met = self.spans[next..].iter().take_while(|span| span.run.start < run.end);
            for span in met {
                let shared = span.run.end.min(run.end) - span.run.start.max(run.start);
                overlaps[span.instance as usize] += u64::from(shared);
            }
        }
        overlaps
    }
}
