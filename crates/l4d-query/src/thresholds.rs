//! Every number that decides a relation, in one place, and the slack with which a proof tries them again.
//!
//! A query whose answer changes when all thresholds move by [`SLACK`] hangs on a threshold and is refused.

use l4d_data::Scale;

/// Two surfaces begin to touch at this distance, metres.
pub const CONTACT_BEGIN_M: f64 = 0.010;
/// They touch until they are farther apart than this, metres, so that contact doesn't flicker.
pub const CONTACT_END_M: f64 = 0.020;
/// `on`: the centre of the upper one lies above this share of the height of the lower one.
pub const ON_HEIGHT_SHARE: f64 = 0.25;
/// `under`: the bottom of the lower one lies below this share of the height of the upper one.
pub const UNDER_HEIGHT_SHARE: f64 = 0.5;
/// `between`: at least this share of the segment lies on either side.
pub const BETWEEN_MARGIN: f64 = 0.15;
/// `between`: farthest off the segment, as a share of its length.
pub const BETWEEN_OFFSET: f64 = 0.3;
/// `closest_to`, `farthest_from`: distances differ at least by this factor.
pub const DISTANCE_MARGIN: f64 = 1.15;
/// `largest`, `smallest`: volumes of the boxes differ at least by this factor.
pub const VOLUME_MARGIN: f64 = 1.3;
/// `tallest`: heights differ at least by this factor.
pub const HEIGHT_MARGIN: f64 = 1.1;
/// `in_front_of`, `behind`: half angle of the cone, degrees.
pub const CONE_DEG: f64 = 45.0;
/// `facing`: largest angle between the front and the direction to the other, degrees.
pub const FACING_DEG: f64 = 30.0;
/// `first`, `last`, `then`: the one starts at least this many frames (a quarter of a second) before the other.
pub const LEAD_FRAMES: f64 = 6.0;
/// How far the proof moves every threshold, both ways, as a share.
pub const SLACK: f64 = 0.10;
/// `while`: how far an edge may move when thresholds move by [`SLACK`], frames.
pub const EDGE_FRAMES: u32 = 3;

/// `beside`: arm's reach at a scale, metres.
pub const fn beside_m(scale: Scale) -> f64 {
    match scale {
        Scale::Outdoor => 0.9,
        Scale::Room => 0.5,
        Scale::Tabletop => 0.1,
    }
}

/// `in_front_of`, `behind`: farthest mesh distance at a scale, metres.
pub const fn before_m(scale: Scale) -> f64 {
    match scale {
        Scale::Outdoor => 2.5,
        Scale::Room => 1.5,
        Scale::Tabletop => 0.35,
    }
}

/// `highest`, `lowest`: the centres of the boxes differ at least by this at a scale, metres.
pub const fn higher_m(scale: Scale) -> f64 {
    match scale {
        Scale::Outdoor => 0.25,
        Scale::Room => 0.12,
        Scale::Tabletop => 0.025,
    }
}

/// Slowest mean speed of the box centre of what walks, rolls or flies, metres a second.
pub const fn moves_mps(scale: Scale) -> f64 {
    match scale {
        Scale::Outdoor => 0.15,
        Scale::Room => 0.10,
        Scale::Tabletop => 0.02,
    }
}

/// How strictly the thresholds are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Slack {
    Nominal,
    /// Harder to satisfy by [`SLACK`].
    Tight,
    /// Easier to satisfy by [`SLACK`].
    Loose,
}

impl Slack {
    /// What makes a condition harder makes its negation easier.
    pub fn opposite(self) -> Self {
        match self {
            Self::Nominal => Self::Nominal,
            Self::Tight => Self::Loose,
            Self::Loose => Self::Tight,
        }
    }

    /// Something must be at most this.
    pub fn at_most(self, limit: f64) -> f64 {
        match self {
            Self::Nominal => limit,
            Self::Tight => limit * (1.0 - SLACK),
            Self::Loose => limit * (1.0 + SLACK),
        }
    }

    /// Something must be at least this.
    pub fn at_least(self, limit: f64) -> f64 {
        match self {
            Self::Nominal => limit,
            Self::Tight => limit * (1.0 + SLACK),
            Self::Loose => limit * (1.0 - SLACK),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tight_is_harder_both_ways() {
        assert!((Slack::Tight.at_most(0.5) - 0.45).abs() < 1e-12);
        assert!((Slack::Tight.at_least(0.5) - 0.55).abs() < 1e-12);
        assert!((Slack::Loose.at_most(0.5) - 0.55).abs() < 1e-12);
        assert_eq!(Slack::Nominal.at_least(0.5), 0.5);
    }
}
