//! Where things are that several views show, and without what noise adds over time.
//!
//! Depth that is drawn from Gaussians may be wrong for a whole view, so that a view counts that sees a thing where the
//! others do.

use glam::DVec3;

use super::perceive::{Body, Track, median};

/// How far the places may be apart at which views see one thing, in longest sides.
const APART: f64 = 0.8;

/// Time over which the middle of the places is taken, either way, seconds.
const WINDOW_S: f64 = 0.5;
/// What strays no farther than this from its middle place stays where it is; in longest sides.
const STRAY: f64 = 0.2;
/// Share of the frames in which it must not.
const STEADY_FRAMES: f64 = 0.75;

/// Where something is that several pictures of one moment show.
pub(super) fn joined(seen: &[Body]) -> Option<Body> {
    let longest_m = median(seen.iter().map(Body::longest_m).collect());
    let middle = middle_of(seen.iter().map(|body| body.centre));
    let agrees = |body: &&Body| body.centre.distance(middle) <= APART * longest_m;
    let mut agreeing: Vec<&Body> = seen.iter().filter(agrees).collect();
    if agreeing.is_empty() {
        agreeing.extend(seen.iter().max_by_key(|body| body.points.len()));
    }
    let points: Vec<DVec3> = agreeing.iter().flat_map(|body| body.points.iter().copied()).collect();
    Body::of(&points, agreeing.iter().any(|body| body.is_whole))
}

/// A track without what noise adds: single frames that are off, and the trembling of what stays where it is.
pub(super) fn steadied(track: Track, seconds: &[f64]) -> Track {
    let longest_m = track.longest_m();
    let seen = || track.bodies.iter().flatten();
    let stays = |part: &dyn Fn(&Body) -> DVec3, axes: DVec3| {
        let middle = middle_of(seen().map(part));
        let strays = seen().map(|body| ((part(body) - middle) * axes).length() > STRAY * longest_m);
        (strays.filter(|strays| *strays).count() as f64) <= (1.0 - STEADY_FRAMES) * seen().count() as f64
    };
    let parts: [&dyn Fn(&Body) -> DVec3; 3] = [&|body| body.centre, &|body| body.low, &|body| body.high];
    if parts.iter().all(|part| stays(part, DVec3::ONE)) {
        let points: Vec<DVec3> = seen().flat_map(|body| body.points.iter().copied()).collect();
        let pooled = Body::of(&points, seen().any(|body| body.is_whole));
        return Track { bodies: track.bodies.iter().map(|body| body.as_ref().and(pooled.clone())).collect() };
    }
    let level = DVec3::new(1.0, 1.0, 0.0);
    let place = stays(&|body| body.centre, level).then(|| middle_of(seen().map(|body| body.centre)));
    let moved = |(index, body): (usize, &Option<Body>)| {
        let body = body.as_ref()?;
        let is_near = |other: &usize| (seconds[*other] - seconds[index]).abs() <= WINDOW_S + 1e-6;
        let near = (0..track.bodies.len()).filter(is_near).filter_map(|other| track.bodies[other].as_ref());
        let mut centre = middle_of(near.map(|body| body.centre));
        if let Some(place) = place {
            centre = place * level + centre * DVec3::Z;
        }
        Some(body.shifted(centre - body.centre))
    };
    Track { bodies: track.bodies.iter().enumerate().map(moved).collect() }
}

fn middle_of(places: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let along = |axis: usize| median(places.clone().map(|place| place[axis]).collect());
    DVec3::new(along(0), along(1), along(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen_at(centre: DVec3) -> Body {
        let corner = |n: i32| DVec3::new(f64::from(n % 5), f64::from(n / 5), 0.0) * 0.06;
        Body::of(&(0..20).map(|n| centre + corner(n)).collect::<Vec<_>>(), true).unwrap()
    }

    #[test]
    fn a_view_that_sees_it_elsewhere_does_not_count() {
        let here = DVec3::new(1.0, 2.0, 0.5);
        let found = joined(&[seen_at(here), seen_at(here + DVec3::X * 3.0), seen_at(here)]).unwrap();
        assert!(found.centre.distance(here) < 0.3, "{}", found.centre);
        assert!(found.longest_m() < 0.4);
        assert!(joined(&[]).is_none());
    }

    fn track(centres: &[f64]) -> Track {
        let at = |x: &f64| {
            let centre = DVec3::X * *x;
            let corner = DVec3::splat(0.5);
            Some(Body {
                centre,
                low: centre - corner,
                high: centre + corner,
                points: vec![centre],
                is_whole: true,
            })
        };
        Track { bodies: centres.iter().map(at).collect() }
    }

    fn places(track: &Track) -> Vec<f64> {
        track.bodies.iter().flatten().map(|body| body.centre.x).collect()
    }

    #[test]
    fn what_trembles_stays_and_what_goes_is_followed() {
        let seconds: Vec<f64> = (0..7).map(|frame| 0.5 * f64::from(frame)).collect();
        let still = places(&steadied(track(&[0.0, 0.05, -0.05, 0.02, 0.9, 0.0, 0.01]), &seconds));
        assert!(still.iter().all(|x| *x == still[0]), "{still:?}");
        let walks = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0];
        assert_eq!(places(&steadied(track(&walks), &seconds))[1..6], walks[1..6]);
        let once_off = places(&steadied(track(&[0.0, 0.5, 9.0, 1.5, 2.0, 2.5, 3.0]), &seconds));
        assert!(once_off.iter().all(|x| *x <= 3.0), "{once_off:?}");
    }
}
