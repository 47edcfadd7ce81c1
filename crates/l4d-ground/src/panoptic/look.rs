//! What a network sees in a clip: things over time, what each may be called, and what it looks like.
//!
//! Frames are looked at one by one; what is the same thing in the next frame is where it was, as large and of the same
//! colour. Knows nothing of sentences.

use glam::DVec2;
use l4d_data::Name;
use l4d_data::parallel::in_parallel;
use l4d_network::{Description, Network, Picture, Seen, WeightsError};

use super::lab::LabTable;
use super::link::{lasts, link};
use super::perceive::{Glimpse, Perceived, Track};
use super::stage::name_of;
use super::surface::{Surface, median_depth_m, scale_of};
use crate::clip::{ClipFrame, ViewClip};

/// Least pixels of a thing, as a share of the picture.
const LEAST_SHARE: f64 = 0.0003;
/// Pixels from which one glimpse of a thing counts fully.
const FULL_PX: f64 = 400.0;

/// How much a thing counts less that is seen in few frames: power of their share.
pub(super) const PRESENCE_POWER: f64 = 0.5;

/// What is seen over a clip, and what each track may be.
pub(super) struct Looked {
    pub(super) perceived: Perceived,
    /// Mean of the logarithms of the probabilities of kinds, by track.
    pub(super) kinds: Vec<Vec<f32>>,
    /// Mean logits of values, by track.
    pub(super) values: Vec<Vec<f32>>,
    /// How far each track is a thing at all, 0 to 1.
    pub(super) presence: Vec<f64>,
}

impl Looked {
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

/// Looks at every frame of a clip, several at once; what is seen does not depend on how many.
pub(super) fn look(clip: &ViewClip, network: &Network, table: &LabTable) -> Result<Looked, WeightsError> {
    let seen = look_at_all(clip, network)?;
    let frames: Vec<u32> = clip.frame_numbers().collect();
    let surfaces: Vec<Surface> = clip.frames.iter().map(|frame| Surface::new(clip, frame, table)).collect();
    let glimpses = seen.iter().zip(&surfaces).map(|(seen, surface)| glimpses_of(seen, surface));
    let seconds: Vec<f64> = frames.iter().map(|&frame| clip.timeline.seconds(frame)).collect();
    let chains = link(glimpses.collect(), &seconds).into_iter().filter(lasts);
    let tracks: Vec<Track> = chains.map(|glimpses| Track { glimpses }).collect();
    let median_depth_m = median_depth_m(&surfaces);
    let middle = frames.get(frames.len() / 2).copied().unwrap_or(0);
    let presence_of =
        |track: &Track| (track.seen().count() as f64 / frames.len() as f64).powf(PRESENCE_POWER);
    let presence = tracks.iter().map(presence_of).collect();
    let (kinds, values) = tracks.iter().map(|track| described(track, &seen)).unzip();
    let perceived = Perceived {
        tracks,
        timeline: clip.timeline,
        scale: scale_of(median_depth_m),
        spacing_m: median_depth_m / clip.camera.fx.max(1e-9),
        eye: clip.camera.unproject(middle, DVec2::ZERO, 0.0),
        frames,
    };
    Ok(Looked { perceived, kinds, values, presence })
}

fn look_at_all(clip: &ViewClip, network: &Network) -> Result<Vec<Seen>, WeightsError> {
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    in_parallel(&clip.frames, jobs, |frame| network.look(&picture_of(frame)))
}

fn picture_of(frame: &ClipFrame) -> Picture {
    let (width, height) = frame.colour.dimensions();
    let colour = frame.colour.as_raw().iter().map(|value| f32::from(*value) / 255.0).collect();
    Picture { width: width as usize, height: height as usize, colour }
}

/// The things of a frame that have depth; what has none is nowhere.
fn glimpses_of(seen: &Seen, surface: &Surface) -> Vec<Glimpse> {
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
        .map(|(number, members)| surface.glimpse(number, members))
        .collect()
}

/// How much was seen of a track: what it counts when views are put together.
pub(super) fn weight(track: &Track) -> f32 {
    track.seen().map(|(_, glimpse)| share(glimpse)).sum()
}

/// How much a glimpse tells.
fn share(glimpse: &Glimpse) -> f32 {
    (glimpse.area_px as f64).min(FULL_PX).sqrt() as f32
}

/// Means over the glimpses of a track; larger ones count more.
fn described(track: &Track, seen: &[Seen]) -> (Vec<f32>, Vec<f32>) {
    let mut kinds: Vec<f32> = Vec::new();
    let mut values: Vec<f32> = Vec::new();
    let mut total = 0.0;
    for (index, glimpse) in track.seen() {
        let Some(found) = seen[index].found.get(glimpse.number) else { continue };
        let share = share(glimpse);
        kinds.resize(found.kinds.len(), 0.0);
        values.resize(found.values.len(), 0.0);
        kinds.iter_mut().zip(log_softmax(&found.kinds)).for_each(|(sum, value)| *sum += share * value);
        values.iter_mut().zip(&found.values).for_each(|(sum, value)| *sum += share * value);
        total += share;
    }
    kinds.iter_mut().chain(&mut values).for_each(|sum| *sum /= total.max(1e-6));
    (kinds, values)
}

pub(super) fn log_softmax(logits: &[f32]) -> Vec<f32> {
    let most = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let total: f32 = logits.iter().map(|value| (value - most).exp()).sum();
    logits.iter().map(|value| value - most - total.ln()).collect()
}
