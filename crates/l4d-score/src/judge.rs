//! One query, one frame: compares an answer with the truth and counts pixels.

use l4d_data::Query;
use l4d_frames::Mask;

use crate::counts::{FrameCount, State};
use crate::truth::SceneTruth;

/// What a method says about one frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Nothing: there is no answer, or none that could be read.
    Missing,
    /// What is asked for cannot be seen.
    Absent,
    /// These pixels, perhaps none; same size as the truth.
    Pixels(Mask),
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
    let target = truth.target(query, referents, position);
    count.truth = target.as_ref().map_or(0, |target| target.area());
    if let Answer::Pixels(predicted) = answer {
        count.predicted = predicted.area();
        count.intersection = target.as_ref().map_or(0, |target| target.overlap(predicted));
        if let Some((index, overlap)) = most_overlapped(truth, referents, position, predicted) {
            count.instance = Some(truth.instances[index].name.clone());
            count.instance_overlap = overlap;
        }
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

/// The instance that shares most pixels with a prediction. A referent must be strictly ahead of all others, then
/// the lower id wins: a mask that fits two things equally well has chosen neither.
fn most_overlapped(
    truth: &SceneTruth,
    referents: &[usize],
    position: usize,
    predicted: &Mask,
) -> Option<(usize, u64)> {
    let mut best: Option<(usize, u64)> = None;
    for (index, instance) in truth.instances.iter().enumerate() {
        let overlap = instance.masks[position].as_ref().map_or(0, |mask| mask.overlap(predicted));
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
