//! How a track moves.

use glam::DVec3;

use super::perceive::{Body, Perceived, Track};

/// Time over which speed is measured, either way, seconds.
const WINDOW_S: f64 = 0.25;

/// A track in motion.
#[derive(Debug, Clone)]
pub(super) struct Kinematics {
    /// Metres per second at each frame of the clip; zero where it isn't seen.
    pub(super) velocity: Vec<DVec3>,
    /// Longest side, metres.
    pub(super) size_m: f64,
}

impl Kinematics {
    pub(super) fn new(track: &Track, seen: &Perceived) -> Self {
        let seconds: Vec<f64> = seen.frames.iter().map(|&frame| seen.timeline.seconds(frame)).collect();
        let count = seconds.len();
        let step = if count > 1 { (seconds[count - 1] - seconds[0]) / (count - 1) as f64 } else { 1.0 };
        let reach = ((WINDOW_S / step.max(1e-6)).round() as usize).max(1);
        let velocity = |index: usize| {
            let from = index.saturating_sub(reach);
            let to = (index + reach).min(count.saturating_sub(1));
            let earliest = (from..=index).find_map(|at| Some((at, track.bodies[at].as_ref()?)));
            let latest = (index..=to).rev().find_map(|at| Some((at, track.bodies[at].as_ref()?)));
            match earliest.zip(latest) {
                Some(((from, first), (to, last))) if from < to => {
                    (last.centre - first.centre) / (seconds[to] - seconds[from]).max(1e-6)
                }
                _ => DVec3::ZERO,
            }
        };
        Self { velocity: (0..count).map(velocity).collect(), size_m: track.longest_m().max(1e-6) }
    }
}

/// Least distance between points that are seen of two things, metres.
pub(super) fn gap_m(a: &Body, b: &Body) -> f64 {
    let nearest = |point: &DVec3| {
        b.points.iter().map(|other| point.distance_squared(*other)).fold(f64::INFINITY, f64::min)
    };
    a.points.iter().map(nearest).fold(f64::INFINITY, f64::min).sqrt()
}
