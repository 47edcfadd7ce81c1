//! Segments of successive frames -> tracks of one level.

use super::lab::distance;
use super::perceive::Glimpse;

/// Least affinity with which what is seen goes on with a track.
const LINK_AFFINITY: f64 = 0.2;
/// Speed with which things may move between frames, lengths per second.
const LINK_SPEED: f64 = 2.0;
/// Frames of the clip after which a track that isn't seen is given up for new segments at once.
const PATIENCE: usize = 3;
/// Share of the affinity that overlap in the picture decides; nearness in space decides the rest.
const OVERLAP_SHARE: f64 = 0.5;
/// Colour distance that costs one unit of affinity.
const COLOUR_COST: f64 = 60.0;
/// What a change of area by a factor of e costs.
const AREA_COST: f64 = 0.15;

/// Longest pause over which a thing is followed by how it moves, seconds.
const LONGEST_PAUSE_S: f64 = 1.0;
/// What it costs that nothing is seen in between.
const STITCH_COST: f64 = 0.05;

/// Glimpses of one thing, by frame index.
pub(super) type Chain = Vec<Option<Glimpse>>;

/// Whether a chain is seen in enough of its frames to be a thing.
pub(super) fn lasts(chain: &Chain) -> bool {
    chain.iter().flatten().count() >= (chain.len() / 12).clamp(1, 4)
}

/// Links segments over the frames; `seconds` are the times of the frames.
pub(super) fn link(frames: Vec<Vec<Glimpse>>, seconds: &[f64]) -> Vec<Chain> {
    let count = frames.len();
    let mut chains: Vec<Chain> = Vec::new();
    let mut last_seen: Vec<usize> = Vec::new();
    for (index, segments) in frames.into_iter().enumerate() {
        let mut offers = Vec::new();
        for (chain, &last) in last_seen.iter().enumerate() {
            if index - last > PATIENCE {
                continue;
            }
            let Some(before) = chains[chain][last].as_ref() else { continue };
            let pause = seconds[index] - seconds[last];
            let offer = |(segment, now): (usize, &Glimpse)| (affinity(before, now, pause), chain, segment);
            offers.extend(segments.iter().enumerate().map(offer).filter(|offer| offer.0 >= LINK_AFFINITY));
        }
        offers.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut owners: Vec<Option<usize>> = vec![None; segments.len()];
        let mut is_taken = vec![false; chains.len()];
        for (_, chain, segment) in offers {
            if owners[segment].is_none() && !is_taken[chain] {
                owners[segment] = Some(chain);
                is_taken[chain] = true;
            }
        }
        for (segment, owner) in segments.into_iter().zip(owners) {
            let chain = owner.unwrap_or_else(|| {
                chains.push(vec![None; count]);
                last_seen.push(index);
                chains.len() - 1
            });
            chains[chain][index] = Some(segment);
            last_seen[chain] = index;
        }
    }
    stitch(chains, seconds)
}

/// How readily a segment goes on with what was seen before; at most 1.
fn affinity(before: &Glimpse, now: &Glimpse, pause_s: f64) -> f64 {
    let size = before.body.longest_m().max(now.body.longest_m()).max(1e-6);
    let reach = size * (0.3 + LINK_SPEED * pause_s);
    let near = (-before.body.centre.distance(now.body.centre) / reach).exp();
    let colour = f64::from(distance(before.colour, now.colour)) / COLOUR_COST;
    if near < 0.05 || colour > 1.0 {
        return 0.0;
    }
    let shared = before.shared_px(now) as f64;
    let overlap = shared / (before.area_px + now.area_px) as f64;
    let overlap = overlap / (1.0 - overlap);
    let growth = (now.area_px as f64 / before.area_px as f64).ln().abs();
    OVERLAP_SHARE * overlap + (1.0 - OVERLAP_SHARE) * near - colour - AREA_COST * growth
}

/// Joins chains that end to those that begin later at the same place with the same looks; the readiest first.
fn stitch(chains: Vec<Chain>, seconds: &[f64]) -> Vec<Chain> {
    let ends: Vec<_> = chains.iter().map(last_of).collect();
    let starts: Vec<_> = chains.iter().map(first_of).collect();
    let mut offers = Vec::new();
    for (first, end) in ends.iter().enumerate() {
        for (second, start) in starts.iter().enumerate() {
            let (Some((end, before)), Some((start, now))) = (end, start) else { continue };
            if start <= end {
                continue;
            }
            // However long it was away, it can't have become another.
            let pause = (seconds[*start] - seconds[*end]).min(LONGEST_PAUSE_S);
            let value = affinity(before, now, pause) - STITCH_COST;
            if value >= LINK_AFFINITY {
                offers.push((value, first, second));
            }
        }
    }
    offers.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut next: Vec<Option<usize>> = vec![None; chains.len()];
    let mut is_later = vec![false; chains.len()];
    for (_, first, second) in offers {
        if next[first].is_none() && !is_later[second] {
            next[first] = Some(second);
            is_later[second] = true;
        }
    }
    // Successors begin after their predecessors end, so following them always comes to an end.
    let mut chains: Vec<Option<Chain>> = chains.into_iter().map(Some).collect();
    let mut stitched = Vec::new();
    for first in (0..chains.len()).filter(|&index| !is_later[index]) {
        let Some(mut whole) = chains[first].take() else { continue };
        let mut at = next[first];
        while let Some(index) = at {
            let later = chains[index].take().unwrap_or_default();
            whole
                .iter_mut()
                .zip(later)
                .filter(|(_, glimpse)| glimpse.is_some())
                .for_each(|(slot, glimpse)| *slot = glimpse);
            at = next[index];
        }
        stitched.push(whole);
    }
    stitched
}

fn last_of(chain: &Chain) -> Option<(usize, &Glimpse)> {
    chain.iter().enumerate().rev().find_map(|(index, glimpse)| Some((index, glimpse.as_ref()?)))
}

fn first_of(chain: &Chain) -> Option<(usize, &Glimpse)> {
    chain.iter().enumerate().find_map(|(index, glimpse)| Some((index, glimpse.as_ref()?)))
}
