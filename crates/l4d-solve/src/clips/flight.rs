//! One camera that moves over the clip: along the arc of the training cameras, or from camera to camera.

use std::f64::consts::TAU;

use glam::{DMat3, DMat4, DQuat, DVec3};
use l4d_data::camera::{looking_at_with_up, rows};
use l4d_data::{Camera, Name, StageError, Timeline};

/// A gap between neighbouring cameras that is wider than this is not flown through: nothing was seen from there.
const WIDEST_GAP_RAD: f64 = TAU / 4.0;

/// How the camera moves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Flight {
    /// Around the point that the cameras look at, at their mean distance and height: all the way round where they stand
    /// all around, else from the one end of their arc to the other and back.
    Orbit,
    /// Through these cameras, in equal times.
    Path(Vec<String>),
}

impl Flight {
    /// The camera, with a pose for each frame of the clip.
    ///
    /// # Errors
    /// Unknown cameras, a path of fewer than two, and an orbit of fewer than two cameras.
    pub(super) fn camera(&self, cameras: &[Camera], timeline: Timeline) -> Result<Camera, StageError> {
        let first = cameras.first().ok_or_else(|| {
            StageError::new("there are no cameras to fly along", "name a scene with cameras")
        })?;
        let frames = timeline.whole().frame_count();
        let shares = (0..frames).map(|frame| f64::from(frame) / f64::from(frames.max(2) - 1));
        let (name, poses): (&str, Vec<DMat4>) = match self {
            Self::Orbit => {
                let orbit = Orbit::around(cameras)?;
                ("orbit", shares.map(|share| orbit.pose(share)).collect())
            }
            Self::Path(names) => {
                let stops = stops(names, cameras)?;
                ("path", shares.map(|share| between(&stops, share)).collect())
            }
        };
        let name = Name::new(name).map_err(|error| StageError::of(&error, "report this"))?;
        Ok(Camera { name, world_from_camera: poses.into_iter().map(rows).collect(), ..first.clone() })
    }
}

#[derive(Debug)]
struct Orbit {
    centre: DVec3,
    up: DVec3,
    /// Directions across `up` from which angles are counted.
    across: [DVec3; 2],
    radius: f64,
    height: f64,
    from_rad: f64,
    arc_rad: f64,
    is_closed: bool,
}

impl Orbit {
    fn around(cameras: &[Camera]) -> Result<Self, StageError> {
        if cameras.len() < 2 {
            return Err(StageError::new(
                "an orbit needs two cameras at least",
                "fly a path, or name more cameras",
            ));
        }
        let poses: Vec<DMat4> = cameras.iter().map(|camera| camera.world_from_camera(0)).collect();
        let count = poses.len() as f64;
        let up = poses.iter().map(|pose| -pose.y_axis.truncate()).sum::<DVec3>().normalize_or(DVec3::Z);
        let centre = looked_at(&poses);
        let across = [up.any_orthonormal_vector(), up.cross(up.any_orthonormal_vector())];
        let from_centre: Vec<DVec3> = poses.iter().map(|pose| pose.w_axis.truncate() - centre).collect();
        let height = from_centre.iter().map(|offset| offset.dot(up)).sum::<f64>() / count;
        let radius = from_centre.iter().map(|offset| offset.reject_from(up).length()).sum::<f64>() / count;
        let angle = |offset: &DVec3| offset.dot(across[1]).atan2(offset.dot(across[0])).rem_euclid(TAU);
        let mut angles: Vec<f64> = from_centre.iter().map(angle).collect();
        angles.sort_by(f64::total_cmp);
        // The arc is what is left of the circle without its widest gap.
        let after = |index: usize| {
            let next = angles.get(index + 1).copied().unwrap_or(angles[0] + TAU);
            next - angles[index]
        };
        let widest = (0..angles.len()).max_by(|&a, &b| after(a).total_cmp(&after(b))).unwrap_or(0);
        let is_closed = after(widest) <= WIDEST_GAP_RAD;
        let (from_rad, arc_rad) = match is_closed {
            true => (angles[0], TAU),
            false => (angles[(widest + 1) % angles.len()], TAU - after(widest)),
        };
        Ok(Self { centre, up, across, radius, height, from_rad, arc_rad, is_closed })
    }

    fn pose(&self, share: f64) -> DMat4 {
        // To the end and back, slow where it turns; around without end.
        let along = if self.is_closed { share } else { (1.0 - (TAU * share).cos()) / 2.0 };
        let angle = self.from_rad + self.arc_rad * along;
        let outwards = self.across[0] * angle.cos() + self.across[1] * angle.sin();
        let place = self.centre + outwards * self.radius + self.up * self.height;
        looking_at_with_up(place, self.centre, self.up)
    }
}

/// The point that is nearest to the optical axes of all cameras.
fn looked_at(poses: &[DMat4]) -> DVec3 {
    let mut left = DMat3::ZERO;
    let mut right = DVec3::ZERO;
    for pose in poses {
        let (axis, place) = (pose.z_axis.truncate(), pose.w_axis.truncate());
        let off_axis = DMat3::IDENTITY - DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
        left += off_axis;
        right += off_axis * place;
    }
    // Parallel axes meet nowhere: then a metre before the cameras.
    if left.determinant().abs() > 1e-9 * poses.len() as f64 {
        return left.inverse() * right;
    }
    let ahead = |pose: &DMat4| (pose.w_axis + pose.z_axis).truncate();
    poses.iter().map(ahead).sum::<DVec3>() / poses.len() as f64
}

fn stops(names: &[String], cameras: &[Camera]) -> Result<Vec<(DVec3, DQuat)>, StageError> {
    if names.len() < 2 {
        return Err(StageError::new(
            "a path needs two cameras at least",
            "name them like --path cam00,cam03",
        ));
    }
    let stop = |name: &String| {
        let camera = cameras.iter().find(|camera| camera.name.as_str() == name).ok_or_else(|| {
            let known: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
            let message = format!("there is no view `{}`", name.escape_debug());
            StageError::new(message, format!("choose among {}", known.join(", ")))
        })?;
        let (_, rotation, place) = camera.world_from_camera(0).to_scale_rotation_translation();
        Ok((place, rotation))
    };
    names.iter().map(stop).collect()
}

/// Between stops along a Catmull-Rom curve, turning evenly.
fn between(stops: &[(DVec3, DQuat)], share: f64) -> DMat4 {
    let at = share * (stops.len() - 1) as f64;
    let left = (at as usize).min(stops.len() - 2);
    let t = at - left as f64;
    let place = |offset: isize| {
        let index = (left as isize + offset).clamp(0, stops.len() as isize - 1) as usize;
        stops[index].0
    };
    let [a, b, c, d] = [place(-1), place(0), place(1), place(2)];
    let curve = b
        + ((c - a) * t + (a * 2.0 - b * 5.0 + c * 4.0 - d) * t * t + (b * 3.0 - a - c * 3.0 + d) * t * t * t)
            * 0.5;
    DMat4::from_rotation_translation(stops[left].1.slerp(stops[left + 1].1, t), curve)
}

#[cfg(test)]
mod tests {
    use l4d_data::camera::looking_at;

    use super::*;

    fn ring(angles_deg: &[f64]) -> Vec<Camera> {
        let camera = |(index, angle): (usize, &f64)| {
            let (sin, cos) = angle.to_radians().sin_cos();
            let pose = looking_at(DVec3::new(3.0 * cos, 3.0 * sin, 2.0), DVec3::new(0.0, 0.0, 0.5));
            Camera::new(Name::new(format!("cam{index:02}")).unwrap(), [64, 48], 50.0, pose)
        };
        angles_deg.iter().enumerate().map(camera).collect()
    }

    fn places(flight: &Flight, cameras: &[Camera]) -> Vec<DVec3> {
        let camera = flight.camera(cameras, Timeline::CANONICAL).unwrap();
        (0..97).map(|frame| camera.world_from_camera(frame).w_axis.truncate()).collect()
    }

    #[test]
    fn an_orbit_keeps_to_the_arc_of_the_cameras_and_looks_at_what_they_look_at() {
        let cameras = ring(&[-40.0, -10.0, 20.0, 50.0]);
        let camera = Flight::Orbit.camera(&cameras, Timeline::CANONICAL).unwrap();
        for frame in 0..97 {
            let pose = camera.world_from_camera(frame);
            let place = pose.w_axis.truncate();
            let angle = place.y.atan2(place.x).to_degrees();
            assert!((-40.001..=50.001).contains(&angle), "frame {frame} at {angle} degrees");
            let (pixel, depth) = camera.project(frame, DVec3::new(0.0, 0.0, 0.5));
            assert!(depth > 0.0 && (pixel.x - 32.0).abs() < 0.1 && (pixel.y - 24.0).abs() < 0.5, "{pixel}");
            assert!((pose.determinant() - 1.0).abs() < 1e-9, "a pose is a rotation, never a mirror");
        }
        let ends = places(&Flight::Orbit, &cameras);
        assert!(ends[0].distance(ends[96]) < 1e-9, "back to where it began");
        assert!(ends[0].distance(ends[48]) > 3.0, "half-way at the other end");
    }

    #[test]
    fn cameras_all_around_are_circled() {
        let all_around = places(&Flight::Orbit, &ring(&[0.0, 72.0, 144.0, 216.0, 288.0]));
        assert!(all_around[0].distance(all_around[48]) > 5.0);
    }

    #[test]
    fn a_path_meets_its_cameras_in_equal_times() {
        let cameras = ring(&[0.0, 60.0, 120.0]);
        let names = ["cam02", "cam00", "cam01"].map(str::to_owned).to_vec();
        let flown = Flight::Path(names).camera(&cameras, Timeline::CANONICAL).unwrap();
        for (frame, camera) in [(0, 2), (48, 0), (96, 1)] {
            let difference = flown.world_from_camera(frame) - cameras[camera].world_from_camera(0);
            let largest =
                difference.to_cols_array().into_iter().fold(0.0, |most: f64, part| most.max(part.abs()));
            assert!(largest < 1e-9, "frame {frame}: {difference}");
        }
    }

    #[test]
    fn what_cannot_be_flown_is_refused() {
        let cameras = ring(&[0.0, 60.0]);
        let refusal = |names: &[&str]| {
            let names = names.iter().map(|name| (*name).to_owned()).collect();
            Flight::Path(names).camera(&cameras, Timeline::CANONICAL).unwrap_err().to_string()
        };
        assert_eq!(refusal(&["cam00"]), "a path needs two cameras at least");
        assert_eq!(refusal(&["cam00", "cam07"]), "there is no view `cam07`");
        assert!(Flight::Orbit.camera(&cameras[..1], Timeline::CANONICAL).is_err());
    }
}
