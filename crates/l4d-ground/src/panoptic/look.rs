//! What a network sees in a clip: things over time, what each may be called, and what it looks like.
//!
//! Frames are looked at one by one; what is the same thing in the next frame is where it was, as large and of the same
//! colour. Knows nothing of sentences.

use std::collections::BTreeMap;

use glam::DVec2;
use l4d_data::parallel::in_parallel;
use l4d_data::{Name, Timeline};
use l4d_masks::Mask;
use l4d_network::{Description, Found, Network, Picture, Seen, WeightsError};

use super::lab::LabTable;
use super::link::{Chain, lasts, link};
use super::perceive::{Glimpse, Perceived, Track};
use super::surface::{Surface, median_depth_m, scale_of};
use super::tracks::name_of;
use crate::clip::{ClipFrame, ViewClip};

/// Least pixels of a thing, as a share of the picture.
const LEAST_SHARE: f64 = 0.0003;
/// Pixels from which one glimpse of a thing counts fully.
const FULL_PX: f64 = 400.0;

/// No kind is less probable.
const LEAST_ODDS: f32 = 1e-6;
/// How much a thing counts less that is seen in few frames: power of their share.
const PRESENCE_POWER: f64 = 0.5;

/// Things over a clip, and what each may be.
pub(super) struct Things {
    pub(super) perceived: Perceived,
    /// Logarithms of the mean probabilities of kinds, by track.
    pub(super) kinds: Vec<Vec<f32>>,
    /// Mean logits of values, by track.
    pub(super) values: Vec<Vec<f32>>,
    /// How far each track is a thing at all, 0 to 1.
    pub(super) presence: Vec<f64>,
}

impl Things {
    /// The noun that fits it best.
    pub(super) fn likeliest<'d>(&self, name: &Name, description: &'d Description) -> &'d str {
        let kinds = self.number(name).and_then(|number| self.kinds.get(number));
        let best = kinds.and_then(|kinds| (1..kinds.len()).max_by(|a, b| kinds[*a].total_cmp(&kinds[*b])));
        best.and_then(|best| description.kinds.get(best)).map_or("thing", String::as_str)
    }

    /// The number of the track of that name.
    pub(super) fn number(&self, name: &Name) -> Option<usize> {
        (0..self.perceived.tracks.len()).find(|number| name_of(*number).as_ref() == Some(name))
    }
}

/// What one view shows: things, and the pixels of each in each frame.
pub(super) struct Looked {
    pub(super) things: Things,
    pub(super) chains: Vec<Chain>,
}

impl Looked {
    /// The pixels of a thing, by frame.
    pub(super) fn masks(&self, track: usize) -> BTreeMap<u32, Mask> {
        let chain = self.chains.get(track).into_iter().flatten();
        let frames = self.things.perceived.frames.iter().copied();
        frames.zip(chain).filter_map(|(frame, seen)| Some((frame, seen.as_ref()?.mask.clone()))).collect()
    }
}

/// Looks at every frame of a clip, several at once; what is seen does not depend on how many.
pub(super) fn look(clip: &ViewClip, network: &Network, table: &LabTable) -> Result<Looked, WeightsError> {
    let seen = look_at_all(clip, network)?;
    let frames: Vec<u32> = clip.frame_numbers().collect();
    let surfaces = clip.frames.iter().map(|frame| Surface::new(clip, frame));
    let glimpses = seen.iter().zip(surfaces).map(|(seen, surface)| glimpses_of(seen, &surface, table));
    let seconds: Vec<f64> = frames.iter().map(|&frame| clip.timeline.seconds(frame)).collect();
    let chains: Vec<Chain> = link(glimpses.collect(), &seconds).into_iter().filter(lasts).collect();
    let bodies = |chain: &Chain| chain.iter().map(|seen| Some(seen.as_ref()?.body.clone())).collect();
    let presence_of = |chain: &Chain| presence(chain.iter().flatten().count(), frames.len());
    let (kinds, values) = chains.iter().map(|chain| described(chain, &seen)).unzip();
    let tracks = chains.iter().map(|chain| Track { bodies: bodies(chain) }).collect();
    let things = Things {
        presence: chains.iter().map(presence_of).collect(),
        perceived: Perceived { tracks, ..scene_of(std::slice::from_ref(clip)) },
        kinds,
        values,
    };
    Ok(Looked { things, chains })
}

/// What views tell of a scene before anything is found in it: the first view its size, all of them their mean place.
pub(super) fn scene_of(clips: &[ViewClip]) -> Perceived {
    let first = clips.first();
    let median_depth_m = first.map_or(0.0, median_depth_m);
    let middle = |clip: &ViewClip| clip.frames.get(clip.frames.len() / 2).map_or(0, |seen| seen.frame);
    let eye = |clip: &ViewClip| clip.camera.unproject(middle(clip), DVec2::ZERO, 0.0);
    Perceived {
        frames: first.map_or(Vec::new(), |clip| clip.frame_numbers().collect()),
        timeline: first.map_or(Timeline::CANONICAL, |clip| clip.timeline),
        tracks: Vec::new(),
        scale: scale_of(median_depth_m),
        spacing_m: first.map_or(0.0, |clip| median_depth_m / clip.camera.fx.max(1e-9)),
        eye: clips.iter().map(|clip| eye(clip) / clips.len() as f64).sum(),
    }
}

/// How far something is a thing that is seen in so many of the pictures that may show it.
pub(super) fn presence(seen: usize, of: usize) -> f64 {
    (seen as f64 / of.max(1) as f64).powf(PRESENCE_POWER)
}

pub(super) fn look_at_all(clip: &ViewClip, network: &Network) -> Result<Vec<Seen>, WeightsError> {
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    in_parallel(&clip.frames, jobs, |frame| network.look(&picture_of(frame)))
}

pub(super) fn picture_of(frame: &ClipFrame) -> Picture {
    let (width, height) = frame.colour.dimensions();
    let colour = frame.colour.as_raw().iter().map(|value| f32::from(*value) / 255.0).collect();
    Picture { width: width as usize, height: height as usize, colour }
}

/// The things of a frame that have depth; what has none is nowhere.
fn glimpses_of(seen: &Seen, surface: &Surface<'_>, table: &LabTable) -> Vec<Glimpse> {
    let least = ((seen.labels.len() as f64 * LEAST_SHARE) as usize).max(4);
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); seen.found.len()];
    for (index, label) in seen.labels.iter().enumerate() {
        if *label > 0 && surface.is_known(index) {
            members[*label as usize - 1].push(index as u32);
        }
    }
    members
        .iter()
        .enumerate()
        .filter(|(_, members)| members.len() >= least)
        .filter_map(|(number, members)| surface.glimpse(number, members, table))
        .collect()
}

/// How much a view of something of so many pixels tells.
pub(super) fn weight(area_px: u64) -> f32 {
    (area_px as f64).min(FULL_PX).sqrt() as f32
}

fn described(chain: &Chain, seen: &[Seen]) -> (Vec<f32>, Vec<f32>) {
    let found = chain.iter().enumerate().filter_map(|(index, glimpse)| {
        let glimpse = glimpse.as_ref()?;
        Some((weight(glimpse.area_px), seen[index].found.get(glimpse.number)?))
    });
    mean_of(found)
}

/// Means of what the network says of one thing, with weights: logarithms of mean probabilities of kinds, and mean logits
/// of values. Of logarithms, one picture that shows something else would outweigh all others.
pub(super) fn mean_of<'s>(found: impl Iterator<Item = (f32, &'s Found)>) -> (Vec<f32>, Vec<f32>) {
    let mut kinds: Vec<f32> = Vec::new();
    let mut values: Vec<f32> = Vec::new();
    let mut total = 0.0;
    for (weight, found) in found {
        kinds.resize(found.kinds.len(), 0.0);
        values.resize(found.values.len(), 0.0);
        let odds = log_softmax(&found.kinds).into_iter().map(f32::exp);
        kinds.iter_mut().zip(odds).for_each(|(sum, odds)| *sum += weight * odds);
        values.iter_mut().zip(&found.values).for_each(|(sum, value)| *sum += weight * value);
        total += weight;
    }
    kinds.iter_mut().chain(&mut values).for_each(|sum| *sum /= total.max(1e-6));
    kinds.iter_mut().for_each(|odds| *odds = odds.max(LEAST_ODDS).ln());
    (kinds, values)
}

pub(super) fn log_softmax(logits: &[f32]) -> Vec<f32> {
    let most = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let total: f32 = logits.iter().map(|value| (value - most).exp()).sum();
    logits.iter().map(|value| value - most - total.ln()).collect()
}
