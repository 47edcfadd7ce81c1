//! How a track moves, and how much that looks like a verb.

use glam::DVec3;

use super::lexicon::Motion;
use super::perceive::{Glimpse, Perceived, Track};
use super::settings::{DASH_SPEED_M, STIR_SHARE, TRAVEL_SPEED};

/// Time over which speed is measured, either way, seconds.
const WINDOW_S: f64 = 0.25;

/// A track in motion; lists have one entry for each frame of the clip.
#[derive(Debug, Clone)]
pub(crate) struct Kinematics {
    /// Metres per second; zero where it isn't seen.
    pub(crate) velocity: Vec<DVec3>,
    /// Share of the silhouette that is another than a moment ago, 0 to 1.
    change: Vec<f64>,
    /// Longest side, metres.
    pub(crate) size_m: f64,
    is_seen: Vec<bool>,
}

impl Kinematics {
    pub(crate) fn new(track: &Track, seen: &Perceived) -> Self {
        let seconds: Vec<f64> = seen.frames.iter().map(|&frame| seen.timeline.seconds(frame)).collect();
        let count = seconds.len();
        let step = if count > 1 { (seconds[count - 1] - seconds[0]) / (count - 1) as f64 } else { 1.0 };
        let reach = ((WINDOW_S / step.max(1e-6)).round() as usize).max(1);
        let pair = |index: usize| {
            let from = index.saturating_sub(reach);
            let to = (index + reach).min(count.saturating_sub(1));
            let earliest = (from..=index).find_map(|at| Some((at, track.glimpses[at].as_ref()?)));
            let latest = (index..=to).rev().find_map(|at| Some((at, track.glimpses[at].as_ref()?)));
            earliest.zip(latest).filter(|(first, last)| first.0 < last.0)
        };
        let velocity = |index| {
            pair(index).map_or(DVec3::ZERO, |((from, first), (to, last))| {
                (last.centre - first.centre) / (seconds[to] - seconds[from]).max(1e-6)
            })
        };
        let change = |index| {
            pair(index).map_or(0.0, |((_, first), (_, last))| {
                let shared = first.shared_px(last) as f64;
                1.0 - shared / (first.area_px + last.area_px).max(1) as f64 * 2.0
            })
        };
        Self {
            velocity: (0..count).map(velocity).collect(),
            change: (0..count).map(change).collect(),
            size_m: track.median(Glimpse::longest_m).max(1e-6),
            is_seen: track.glimpses.iter().map(Option::is_some).collect(),
        }
    }

    /// 0 to 1: whether it moves at any time.
    pub(crate) fn ever_moves(&self) -> f64 {
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let travels = most(&mut (0..self.velocity.len()).map(|index| self.travels(index)));
        let stirs = most(&mut self.change.iter().map(|change| rise(*change, 2.0 * STIR_SHARE)));
        f64::max(travels, stirs)
    }

    fn travels(&self, index: usize) -> f64 {
        rise(self.velocity[index].length() / self.size_m, TRAVEL_SPEED)
    }

    /// How much it looks like this at each frame, 0 to 1.
    pub(crate) fn looks_like(&self, motion: Motion) -> Vec<f64> {
        let grade = |index: usize| {
            if !self.is_seen[index] {
                return 0.0;
            }
            let travel = self.travels(index);
            let stir = rise(self.change[index], STIR_SHARE);
            let upwards = self.velocity[index].z / self.size_m;
            match motion {
                Motion::Travel => travel,
                Motion::Dash => travel * rise(self.velocity[index].length(), DASH_SPEED_M),
                Motion::Hop => rise(upwards.abs(), TRAVEL_SPEED),
                Motion::Rise => rise(upwards, TRAVEL_SPEED),
                Motion::Sink => rise(-upwards, TRAVEL_SPEED),
                Motion::Turn | Motion::Stir => stir * (1.0 - 0.7 * travel),
                Motion::Move => travel.max(0.5 * stir),
                Motion::Still => 1.0 - travel,
                _ => 0.0,
            }
        };
        (0..self.velocity.len()).map(grade).collect()
    }
}

/// 0 at nothing, a half at the threshold, 1 far above.
pub(crate) fn rise(value: f64, threshold: f64) -> f64 {
    if value <= 0.0 { 0.0 } else { value.powi(2) / (value.powi(2) + threshold.powi(2)) }
}

/// One acts on another at a moment.
pub(crate) struct Encounter<'s> {
    pub(crate) agent: (&'s Glimpse, &'s Kinematics),
    pub(crate) other: (&'s Glimpse, &'s Kinematics),
    pub(crate) index: usize,
    /// Distance between what is seen of both, metres.
    pub(crate) gap_m: f64,
    /// Distance over which contact fades, metres.
    pub(crate) contact_m: f64,
}

impl Encounter<'_> {
    /// How much it looks like this, 0 to 1.
    pub(crate) fn looks_like(&self, motion: Motion) -> f64 {
        let contact = (-self.gap_m / self.contact_m).exp();
        let (own, others) = (self.agent.1.velocity[self.index], self.other.1.velocity[self.index]);
        let size_m = self.other.1.size_m;
        let travel = rise(others.length() / size_m, TRAVEL_SPEED);
        let together = own.normalize_or_zero().dot(others.normalize_or_zero()).max(0.0);
        let upwards = others.z / size_m;
        let towards = (self.other.0.centre - self.agent.0.centre).normalize_or_zero();
        match motion {
            Motion::Holding => contact,
            Motion::Carrying => contact * travel * (0.3 + 0.7 * together),
            Motion::Lifting => contact * rise(upwards, TRAVEL_SPEED),
            Motion::Lowering => contact * rise(-upwards, TRAVEL_SPEED),
            Motion::Touching => contact * (0.5 + 0.5 * self.agent.1.looks_like_at(self.index)),
            Motion::Pouring => {
                let above = rise(self.agent.0.high.z - self.other.0.centre.z, 0.3 * size_m);
                (-self.gap_m / (3.0 * self.contact_m)).exp() * above * (1.0 - 0.7 * travel)
            }
            Motion::Following => {
                let goes = rise(own.length() / self.agent.1.size_m, TRAVEL_SPEED);
                goes * (0.2 + 0.8 * own.normalize_or_zero().dot(towards).max(0.0))
            }
            Motion::Approaching => {
                let closing = (own - others).dot(towards) / self.agent.1.size_m;
                rise(closing, TRAVEL_SPEED)
            }
            Motion::Watching => 0.5,
            _ => 0.0,
        }
    }
}

impl Kinematics {
    fn looks_like_at(&self, index: usize) -> f64 {
        self.travels(index).max(rise(self.change[index], STIR_SHARE))
    }
}

/// Least distance between points that are seen of two things, metres.
pub(crate) fn gap_m(a: &Glimpse, b: &Glimpse) -> f64 {
    let nearest = |point: &DVec3| {
        b.points.iter().map(|other| point.distance_squared(*other)).fold(f64::INFINITY, f64::min)
    };
    a.points.iter().map(nearest).fold(f64::INFINITY, f64::min).sqrt()
}
