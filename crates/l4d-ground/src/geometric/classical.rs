//! Perception without learning: depth, colour and motion.

use glam::DVec2;

use super::lab::LabTable;
use super::link::{Chain, lasts, link};
use super::perceive::{Perceived, Track};
use super::segment::{Level, segments};
use super::settings::{MOST_TRACKS, SAME_IOU};
use super::surface::{Backdrop, Surface, median_depth_m, scale_of};
use crate::clip::ViewClip;

/// The things of a clip: segments from depth, colour and motion, linked over time within one view. Never fails: what
/// it cannot make out is not there.
pub(super) fn perceive(clip: &ViewClip, table: &LabTable) -> Perceived {
    let frames: Vec<u32> = clip.frame_numbers().collect();
    let surfaces: Vec<Surface> = clip.frames.iter().map(|seen| Surface::new(clip, seen, table)).collect();
    let median_depth_m = median_depth_m(&surfaces);
    let footprint = 1.0 / clip.camera.fx.max(1e-9) as f32;
    let backdrop = Backdrop::new(clip, &surfaces, median_depth_m);
    let seconds: Vec<f64> = frames.iter().map(|&frame| clip.timeline.seconds(frame)).collect();
    let mut chains = Vec::new();
    for level in Level::ALL {
        let found = surfaces.iter().map(|surface| segments(surface, &backdrop, level, footprint));
        chains.extend(link(found.collect(), &seconds));
    }
    let spacing_m = median_depth_m * f64::from(footprint);
    let levels_m = backdrop.levels_m.iter().map(|&level| f64::from(level)).collect();
    let middle = frames.get(frames.len() / 2).copied().unwrap_or(0);
    let eye = clip.camera.unproject(middle, DVec2::ZERO, 0.0);
    Perceived {
        tracks: distinct(chains),
        frames,
        timeline: clip.timeline,
        scale: scale_of(median_depth_m),
        spacing_m,
        eye,
        focus: backdrop.focus(&surfaces),
        levels_m,
    }
}

/// Chains that last, the same pixels not twice, those with most pixels.
fn distinct(chains: Vec<Chain>) -> Vec<Track> {
    let pixels = |chain: &Chain| chain.iter().flatten().map(|glimpse| glimpse.area_px).sum::<u64>();
    let mut chains: Vec<(u64, Chain)> =
        chains.into_iter().filter(lasts).map(|chain| (pixels(&chain), chain)).collect();
    // The sort is stable: among equals the coarser level comes first.
    chains.sort_by_key(|(pixels, _)| std::cmp::Reverse(*pixels));
    let mut kept: Vec<(u64, Chain)> = Vec::new();
    for (area, chain) in chains {
        let mut rivals = kept.iter().rev().take_while(|(other, _)| area as f64 >= SAME_IOU * *other as f64);
        let is_known = rivals.any(|(other, kept)| iou(&chain, kept, area + other) >= SAME_IOU);
        if !is_known {
            kept.push((area, chain));
        }
        if kept.len() == MOST_TRACKS {
            break;
        }
    }
    kept.into_iter().map(|(_, glimpses)| Track { glimpses }).collect()
}

/// Intersection over union of all pixels of all frames.
fn iou(a: &Chain, b: &Chain, both: u64) -> f64 {
    let pairs = a.iter().zip(b).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
    let shared: u64 = pairs.map(|(a, b)| a.shared_px(b)).sum();
    shared as f64 / (both - shared).max(1) as f64
}
