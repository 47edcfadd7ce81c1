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

/// One query under judgement: answers come one at a time, in any order, and none is kept.
#[derive(Debug)]
pub struct QueryJudge<'a> {
    truth: &'a SceneTruth,
    query: &'a Query,
    referents: &'a [usize],
    clip: &'a [u32],
    /// One per frame of the clip, none until its answer came.
    counts: Vec<Option<FrameCount>>,
}

impl<'a> QueryJudge<'a> {
    /// Nothing is answered yet. `referents` are positions among the instances of the truth.
    pub fn new(truth: &'a SceneTruth, query: &'a Query, referents: &'a [usize], clip: &'a [u32]) -> Self {
        Self { truth, query, referents, clip, counts: vec![None; clip.len()] }
    }

    /// Counts the pixels of an answer to the frame at a position of the clip.
    pub fn take(&mut self, position: usize, answer: &Answer) {
        self.counts[position] = Some(self.judge(self.clip[position], answer));
    }

    /// One per frame of the clip; those without an answer are missing.
    pub fn into_counts(mut self) -> Vec<FrameCount> {
        let counts = std::mem::take(&mut self.counts).into_iter();
        let judge = |(count, &frame): (Option<FrameCount>, &u32)| {
            count.unwrap_or_else(|| self.judge(frame, &Answer::Missing))
        };
        counts.zip(self.clip).map(judge).collect()
    }

    fn judge(&self, frame: u32, answer: &Answer) -> FrameCount {
        judge_frame(self.truth, self.query, self.referents, frame, answer)
    }
}

/// Counts the pixels of every answer. `answers` holds one per frame of `clip`.
pub fn judge_query(
    truth: &SceneTruth,
    query: &Query,
    referents: &[usize],
    clip: &[u32],
    answers: &[Answer],
) -> Vec<FrameCount> {
    clip.iter()
        .zip(answers)
        .map(|(&frame, answer)| judge_frame(truth, query, referents, frame, answer))
        .collect()
}

fn judge_frame(
    truth: &SceneTruth,
    query: &Query,
    referents: &[usize],
    frame: u32,
    answer: &Answer,
) -> FrameCount {
    let mut count = FrameCount {
        query: query.id.clone(),
        frame,
        state: State::NotAnnotated,
        intersection: 0,
        union: 0,
        predicted: 0,
        truth: 0,
        instance: None,
        instance_overlap: 0,
    };
    let Some(position) = truth.position(frame) else { return count };
    let is_asked = query.asks_at(frame);
    let overlaps = match (answer, truth.labels(position)) {
        (Answer::Missing | Answer::Absent, _) => Overlaps::none(truth, referents, position),
        (Answer::Runs(runs), Some(labels)) => Overlaps::of_runs(truth, referents, position, labels, runs),
        (answer, _) => {
            Overlaps::of_mask(truth, referents, position, answer.mask((truth.width, truth.height)).as_deref())
        }
    };
    count.predicted = overlaps.predicted;
    if is_asked {
        (count.truth, count.intersection) = (overlaps.meant, overlaps.intersection);
    }
    if let Some((index, overlap)) = most_overlapped(referents, &overlaps.instances) {
        count.instance = Some(truth.instances[index].name.clone());
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

/// What an answer shares with the instances of a frame, pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Overlaps {
    predicted: u64,
    /// What the referents show.
    meant: u64,
    /// What of it is predicted.
    intersection: u64,
    /// What is predicted of each instance; empty where nothing is.
    instances: Vec<u64>,
}

impl Overlaps {
    fn none(truth: &SceneTruth, referents: &[usize], position: usize) -> Self {
        let meant = match truth.labels(position) {
            Some(_) => sum_of_areas(truth, referents, position),
            None => truth.union(referents, position).map_or(0, |union| union.area()),
        };
        Self { predicted: 0, meant, intersection: 0, instances: Vec::new() }
    }

    /// The reference: pixel by pixel.
    fn of_mask(truth: &SceneTruth, referents: &[usize], position: usize, mask: Option<&Mask>) -> Self {
        let Some(mask) = mask else { return Self::none(truth, referents, position) };
        let meant = truth.union(referents, position);
        let overlap = |instance: &TruthInstance| {
            instance.masks[position].as_ref().map_or(0, |instance| instance.overlap(mask))
        };
        Self {
            predicted: mask.area(),
            meant: meant.as_ref().map_or(0, |meant| meant.area()),
            intersection: meant.map_or(0, |meant| meant.overlap(mask)),
            instances: truth.instances.iter().map(overlap).collect(),
        }
    }

    /// The fast path: run by run. Instances are disjoint, so what referents have adds up.
    fn of_runs(
        truth: &SceneTruth,
        referents: &[usize],
        position: usize,
        labels: &Labels,
        runs: &Rle,
    ) -> Self {
        let instances = labels.overlaps(runs);
        Self {
            predicted: runs.area(),
            meant: sum_of_areas(truth, referents, position),
            intersection: referents.iter().map(|&referent| instances[referent]).sum(),
            instances,
        }
    }
}

fn sum_of_areas(truth: &SceneTruth, referents: &[usize], position: usize) -> u64 {
    let visible = referents.iter().filter_map(|&referent| truth.instances[referent].masks[position].as_ref());
    visible.map(TruthMask::area).sum()
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
            let judged = answers.map(|answer| judge_query(&truth, &query(holds), &[0, 2], &[0], &[answer]));
            prop_assert_eq!(&judged[0], &judged[1]);
        }
    }

    #[test]
    fn answers_in_any_order_are_counted_as_all_at_once() {
        let mut truth = truth(2, 2, &[0, 1, 2, 4], false);
        truth.frames = vec![6];
        let (query, clip) = (query(true), [0, 6, 12]);
        let pixels = |bits: [bool; 4]| Answer::Pixels(Mask::from_bools(2, 2, &bits).unwrap());
        let answers = [pixels([true; 4]), pixels([true, true, false, false]), Answer::Missing];
        let mut judge = QueryJudge::new(&truth, &query, &[0, 2], &clip);
        judge.take(1, &answers[1]);
        judge.take(0, &answers[0]);
        let counts = judge.into_counts();
        assert_eq!(counts, judge_query(&truth, &query, &[0, 2], &clip, &answers));
        let states: Vec<State> = counts.iter().map(|count| count.state).collect();
        assert_eq!(states, [State::NotAnnotated, State::Hit, State::NotAnnotated]);
        assert_eq!((counts[1].intersection, counts[1].union), (1, 3));
    }
}
