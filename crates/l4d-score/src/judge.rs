//! One query, one frame: compares an answer with the truth and counts pixels.

use std::borrow::Cow;
use std::collections::BTreeMap;

use l4d_data::Query;
use l4d_masks::{Mask, Rle};

use crate::counts::{FrameCount, State};
use crate::labels::Labels;
use crate::truth::{SceneTruth, TruthInstance, TruthMask};

/// What a method says about one frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Nothing: there is no answer, or none that could be read.
    Missing,
    /// What is asked for cannot be seen.
    Absent,
    /// These pixels, perhaps none; same size as the truth.
    Pixels(Mask),
    /// The same as runs, which are compared without being drawn.
    Runs(Rle),
}

impl Answer {
    /// Answers by frame, one per frame of `clip`; null says absent, a frame that is not there is missing.
    pub fn of_frames(frames: &BTreeMap<u32, Option<Rle>>, clip: &[u32]) -> Vec<Self> {
        let answer = |frame: &u32| match frames.get(frame) {
            None => Self::Missing,
            Some(None) => Self::Absent,
            Some(Some(rle)) => Self::Runs(rle.clone()),
        };
        clip.iter().map(answer).collect()
    }

    /// The pixels of an answer about pictures of that width and height; none where it has none to give.
    pub fn mask(&self, (width, height): (u32, u32)) -> Option<Cow<'_, Mask>> {
        match self {
            Self::Missing | Self::Absent => None,
            Self::Pixels(mask) => Some(Cow::Borrowed(mask)),
            Self::Runs(rle) => Some(Cow::Owned(Mask::from_rle(rle, width, height))),
        }
    }
}

/// Compares answers to one query with the truth.
#[derive(Debug)]
pub struct QueryJudge<'a> {
    truth: &'a SceneTruth,
    query: &'a Query,
    referents: &'a [usize],
}

impl<'a> QueryJudge<'a> {
    /// `referents` are positions among the instances of the truth.
    pub fn new(truth: &'a SceneTruth, query: &'a Query, referents: &'a [usize]) -> Self {
        Self { truth, query, referents }
    }

    /// Counts the pixels of every answer. `answers` holds one per frame of `clip`.
    pub fn clip(&self, clip: &[u32], answers: &[Answer]) -> Vec<FrameCount> {
        clip.iter().zip(answers).map(|(&frame, answer)| self.frame(frame, answer)).collect()
    }

    /// Counts the pixels of the answer to a frame.
    pub fn frame(&self, frame: u32, answer: &Answer) -> FrameCount {
        let mut count = FrameCount {
            query: self.query.id.clone(),
            frame,
            state: State::NotAnnotated,
            intersection: 0,
            union: 0,
            predicted: 0,
            truth: 0,
            instance: None,
            instance_overlap: 0,
        };
        let Some(position) = self.truth.position(frame) else { return count };
        let size = (self.truth.width, self.truth.height);
        let overlaps = match (answer, self.truth.labels(position)) {
            (Answer::Missing | Answer::Absent, _) => self.nothing(position),
            (Answer::Runs(runs), Some(labels)) => self.runs(position, labels, runs),
            (answer, _) => match answer.mask(size) {
                Some(mask) => self.pixels(position, &mask),
                None => self.nothing(position),
            },
        };
        count.predicted = overlaps.predicted;
        if self.query.asks_at(frame) {
            (count.truth, count.intersection) = (overlaps.meant, overlaps.intersection);
        }
        if let Some((index, overlap)) = most_overlapped(self.referents, &overlaps.instances) {
            count.instance = Some(self.truth.instances[index].name.clone());
            count.instance_overlap = overlap;
        }
        count.union = count.predicted + count.truth - count.intersection;
        count.state = match answer {
            Answer::Missing => State::Missing,
            _ if count.truth > 0 && count.intersection > 0 => State::Hit,
            _ if count.truth > 0 => State::Miss,
            _ if count.predicted > 0 => State::FalseAlarm,
            _ => State::TrueAbsent,
        };
        count
    }

    /// Without a prediction.
    fn nothing(&self, position: usize) -> Overlaps {
        let meant = match self.truth.labels(position) {
            Some(_) => self.sum_of_areas(position),
            None => self.truth.union(self.referents, position).map_or(0, |union| union.area()),
        };
        Overlaps { predicted: 0, meant, intersection: 0, instances: Vec::new() }
    }

    /// The reference: pixel by pixel.
    fn pixels(&self, position: usize, mask: &Mask) -> Overlaps {
        let meant = self.truth.union(self.referents, position);
        let overlap = |instance: &TruthInstance| {
            instance.masks[position].as_ref().map_or(0, |instance| instance.overlap(mask))
        };
        Overlaps {
            predicted: mask.area(),
            meant: meant.as_ref().map_or(0, |meant| meant.area()),
            intersection: meant.map_or(0, |meant| meant.overlap(mask)),
            instances: self.truth.instances.iter().map(overlap).collect(),
        }
    }

    /// The fast path: run by run. Instances are disjoint, so what referents have adds up.
    fn runs(&self, position: usize, labels: &Labels, runs: &Rle) -> Overlaps {
        let instances = labels.overlaps(runs);
        Overlaps {
            predicted: runs.area(),
            meant: self.sum_of_areas(position),
            intersection: self.referents.iter().map(|&referent| instances[referent]).sum(),
            instances,
        }
    }

    fn sum_of_areas(&self, position: usize) -> u64 {
        let masks = self.referents.iter().map(|&referent| &self.truth.instances[referent].masks[position]);
        masks.flatten().map(TruthMask::area).sum()
    }
}

/// What an answer shares with the instances of a frame, pixels.
struct Overlaps {
    predicted: u64,
    /// What the referents show.
    meant: u64,
    /// What of it is predicted.
    intersection: u64,
    /// What is predicted of each instance; empty where nothing is.
    instances: Vec<u64>,
}

/// The instance that shares most pixels with a prediction. A referent must be strictly ahead of all others, then
/// the lower id wins: a mask that fits two things equally well has chosen neither.
fn most_overlapped(referents: &[usize], overlaps: &[u64]) -> Option<(usize, u64)> {
    let mut best: Option<(usize, u64)> = None;
    for (index, &overlap) in overlaps.iter().enumerate() {
        let is_better = match best {
            None => overlap > 0,
            Some((leader, most)) => {
                let dethrones = referents.contains(&leader) && !referents.contains(&index);
                overlap > most || (overlap == most && dethrones)
            }
        };
        if is_better {
            best = Some((index, overlap));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use l4d_data::query::text_digest;
    use l4d_data::scene::Role;
    use l4d_data::{Name, Scale};
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    /// A frame whose pixels belong to instances 0 to 3, or to none.
    fn truth(width: u32, height: u32, ids: &[u8], are_overlapping: bool) -> SceneTruth {
        let instance = |index: u8| {
            let at = |col: u32, row: u32| ids[(row * width + col) as usize];
            let is_inside = |col, row| at(col, row) == index || (are_overlapping && at(col, row) == 3);
            TruthInstance {
                name: Name::new(format!("thing_{index}")).unwrap(),
                id: u32::from(index) + 1,
                role: Role::Object,
                category: "thing".to_owned(),
                masks: vec![TruthMask::of(&Mask::from_fn(width, height, is_inside))],
            }
        };
        let scene = (Name::new("a").unwrap(), Scale::Room);
        SceneTruth::new(scene, (width, height), vec![0], (0..4).map(instance).collect())
    }

    fn query(holds: bool) -> Query {
        serde_json::from_value(json!({
            "id": "a/001", "text": "it", "categories": ["action"], "referents": ["thing_0", "thing_2"],
            "temporal": "while", "frames": [if holds { [0, 12] } else { [24, 36] }], "predicate": null,
            "text_digest": text_digest("it", None), "provenance": {"source": "author"}, "status": "candidate",
        }))
        .unwrap()
    }

    /// Ids in blocks, so that there are runs, with stray pixels.
    fn pixels(values: u8) -> impl Strategy<Value = (u32, u32, Vec<u8>, Vec<bool>)> {
        (1..90_u32, 1..90_u32, 1..30_u32).prop_flat_map(move |(width, height, block)| {
            let of_blocks = proptest::collection::vec((0..values, any::<bool>()), (90 * 90) as usize);
            (of_blocks, proptest::collection::vec(0..(width * height) as usize, 0..20)).prop_map(
                move |(of_blocks, strays)| {
                    let block_of = |index: u32| (index / width / block) * 90 + index % width / block;
                    let mut ids: Vec<u8> =
                        (0..width * height).map(|index| of_blocks[block_of(index) as usize].0).collect();
                    let mut inside: Vec<bool> = (0..width * height)
                        .map(|index| of_blocks[(block_of(index) * 7 % 8100) as usize].1)
                        .collect();
                    for stray in strays {
                        ids[stray] = (ids[stray] + 1) % values;
                        inside[stray] = !inside[stray];
                    }
                    (width, height, ids, inside)
                },
            )
        })
    }

    proptest! {
        #[test]
        fn runs_count_what_pixels_count(
            (width, height, ids, inside) in pixels(5), holds in any::<bool>(), are_overlapping in any::<bool>(),
        ) {
            let mask = Mask::from_bools(width, height, &inside).unwrap();
            let truth = truth(width, height, &ids, are_overlapping);
            let has_shared = are_overlapping && ids.contains(&3);
            prop_assert_eq!(truth.labels(0).is_none(), has_shared);
            let answers = [Answer::Runs(mask.to_rle()), Answer::Pixels(mask)];
            let query = query(holds);
            let judge = QueryJudge::new(&truth, &query, &[0, 2]);
            let judged = answers.map(|answer| judge.frame(0, &answer));
            prop_assert_eq!(&judged[0], &judged[1]);
        }
    }
}
