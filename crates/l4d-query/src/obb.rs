//! Oriented boxes: footprints, insides, distances. Knows nothing of names or time.

use glam::{DMat3, DVec2, DVec3};
use l4d_data::tracks::{Track, at_frame};

/// Rounds of alternating projection after which two boxes count as measured.
const ROUNDS: usize = 200;

/// Shorter than this in plan view, an axis points up or down.
const UPRIGHT: f64 = 0.05;

/// A box at one moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Obb {
    pub(crate) centre: DVec3,
    world_from_box: DMat3,
    half: DVec3,
}

impl Obb {
    pub(crate) fn new(track: &Track, frame: u32) -> Self {
        Self {
            centre: DVec3::from_array(*at_frame(&track.centre, frame)),
            world_from_box: DMat3::from_cols_array(at_frame(&track.axes, frame)).transpose(),
            half: DVec3::from_array(*at_frame(&track.extents, frame)) / 2.0,
        }
    }

    pub(crate) fn volume(&self) -> f64 {
        8.0 * self.half.x * self.half.y * self.half.z
    }

    pub(crate) fn diagonal(&self) -> f64 {
        2.0 * self.half.length()
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.centre.z - self.rise()
    }

    pub(crate) fn top(&self) -> f64 {
        self.centre.z + self.rise()
    }

    /// Bottom and top of the ellipsoid inside the box: those of a thing that stands upright, and of a ball however
    /// it has rolled, whose box has corners where the ball has nothing.
    pub(crate) fn rounded(&self) -> (f64, f64) {
        let rise = self.edges().iter().map(|edge| edge.z * edge.z).sum::<f64>().sqrt();
        (self.centre.z - rise, self.centre.z + rise)
    }

    pub(crate) fn height(&self) -> f64 {
        2.0 * self.rise()
    }

    /// The direction that a box axis such as `-y` has in plan view; none where it points up or down.
    pub(crate) fn plan_direction(&self, axis: &str) -> Option<DVec2> {
        let (sign, letter) = match axis.strip_prefix('-') {
            Some(letter) => (-1.0, letter),
            None => (1.0, axis.trim_start_matches('+')),
        };
        let column = match letter {
            "x" => self.world_from_box.x_axis,
            "y" => self.world_from_box.y_axis,
            "z" => self.world_from_box.z_axis,
            _ => return None,
        };
        let plan = column.truncate() * sign;
        (plan.length() > UPRIGHT).then(|| plan.normalize())
    }

    /// How far inside the box, scaled about its centre, a point lies; below 0 outside, metres.
    pub(crate) fn margin_m(&self, point: DVec3, scale: f64) -> f64 {
        let local = self.world_from_box.transpose() * (point - self.centre);
        (self.half * scale - local.abs()).min_element()
    }

    /// How far inside the footprint of the box, scaled about its centre, a point lies in plan view; below 0 outside,
    /// metres.
    ///
    /// The footprint of a box is the sum of three segments, so a point is inside if it is within reach along the normal
    /// of each of its sides.
    pub(crate) fn footprint_margin_m(&self, point: DVec2, scale: f64) -> f64 {
        let offset = point - self.centre.truncate();
        let edges = self.edges().map(DVec3::truncate);
        let sides = edges.iter().filter(|edge| edge.length_squared() > 1e-12);
        let margins = sides.map(|edge| edge.perp().normalize()).map(|normal| {
            let reach: f64 = edges.iter().map(|edge| edge.dot(normal).abs()).sum();
            reach * scale - offset.dot(normal).abs()
        });
        margins.fold(f64::INFINITY, f64::min)
    }

    /// Distance between the two boxes, 0 where they meet.
    ///
    /// Projecting back and forth between two convex bodies converges to a nearest pair (Cheney and Goldstein 1959).
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        let mut here = self.nearest(other.centre);
        let mut gap = f64::INFINITY;
        for _ in 0..ROUNDS {
            let there = other.nearest(here);
            here = self.nearest(there);
            let now = here.distance(there);
            if gap - now < 1e-7 {
                return now;
            }
            gap = now;
        }
        gap
    }

    /// Whether a corner of one lies farther than `tolerance` from that of the other.
    pub(crate) fn differs(&self, other: &Self, tolerance: f64) -> bool {
        let [here, there] = [self, other].map(|obb| obb.world_from_box * DMat3::from_diagonal(obb.half));
        let turned = (0..3).map(|axis| here.col(axis).distance(there.col(axis))).sum::<f64>();
        self.centre.distance(other.centre) + turned > tolerance
    }

    fn nearest(&self, point: DVec3) -> DVec3 {
        let local = self.world_from_box.transpose() * (point - self.centre);
        self.centre + self.world_from_box * local.clamp(-self.half, self.half)
    }

    fn edges(&self) -> [DVec3; 3] {
        let axes = self.world_from_box;
        [axes.x_axis * self.half.x, axes.y_axis * self.half.y, axes.z_axis * self.half.z]
    }

    fn rise(&self) -> f64 {
        self.edges().iter().map(|edge| edge.z.abs()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(centre: [f64; 3], extents: [f64; 3], degrees: f64) -> Obb {
        let world_from_box = DMat3::from_rotation_z(degrees.to_radians());
        let row_major = world_from_box.transpose().to_cols_array();
        let track = Track { centre: vec![centre], axes: vec![row_major], extents: vec![extents] };
        Obb::new(&track, 0)
    }

    #[test]
    fn distance_respects_the_axes() {
        let unit = turned([0.0; 3], [1.0; 3], 0.0);
        let diamond = turned([2.0, 0.0, 0.0], [1.0; 3], 45.0);
        let expected = 2.0 - 0.5 - 0.5_f64.sqrt();
        assert!((unit.distance(&diamond) - expected).abs() < 1e-5);
        assert!((diamond.distance(&unit) - expected).abs() < 1e-5);
        assert_eq!(unit.distance(&turned([0.9, 0.0, 0.0], [1.0; 3], 0.0)), 0.0);
    }

    #[test]
    fn the_shadow_of_a_turned_box_is_turned() {
        let diamond = turned([0.0; 3], [1.0; 3], 45.0);
        let footprint = |x: f64, y: f64, scale: f64| diamond.footprint_margin_m(DVec2::new(x, y), scale);
        assert!(footprint(0.69, 0.0, 1.0) >= 0.0);
        assert!(footprint(0.5, 0.5, 1.0) < 0.0);
        assert!(footprint(0.69, 0.0, 0.9) < 0.0);
        assert!(diamond.margin_m(DVec3::new(0.69, 0.0, 0.4), 1.0) >= 0.0);
        assert!(diamond.margin_m(DVec3::new(0.5, 0.5, 0.4), 1.0) < 0.0);
    }

    #[test]
    fn heights_and_fronts() {
        let leaning = Obb {
            centre: DVec3::new(0.0, 0.0, 1.0),
            world_from_box: DMat3::from_rotation_x(90_f64.to_radians()),
            half: DVec3::new(0.1, 0.8, 0.2),
        };
        assert!((leaning.height() - 1.6).abs() < 1e-12);
        assert!((leaning.bottom() - 0.2).abs() < 1e-12 && (leaning.top() - 1.8).abs() < 1e-12);
        assert_eq!(leaning.plan_direction("-y"), None);
        assert_eq!(leaning.rounded(), (leaning.bottom(), leaning.top()));
        let rolled = Obb { world_from_box: DMat3::from_rotation_x(0.7), half: DVec3::splat(0.5), ..leaning };
        let (bottom, top) = rolled.rounded();
        assert!((bottom - 0.5).abs() < 1e-12 && (top - 1.5).abs() < 1e-12 && rolled.bottom() < 0.35);
        let turned = turned([0.0; 3], [1.0; 3], 90.0);
        let front = turned.plan_direction("-y").unwrap();
        assert!((front - DVec2::new(1.0, 0.0)).length() < 1e-12);
    }
}
