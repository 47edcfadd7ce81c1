//! Which views are looked from: few, and as different as can be.

use glam::DVec3;
use l4d_data::Camera;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Indices of `count` cameras by farthest-point sampling of their positions at frame 0, ascending: the first is drawn
/// by `seed`, each next one is the farthest from all before it, the earlier in the list where several are. All of
/// them if there are no more.
///
/// The paper says "V diverse viewpoints" and no more.
pub fn spread_views(cameras: &[Camera], count: usize, seed: u64) -> Vec<usize> {
    if cameras.is_empty() || count == 0 {
        return Vec::new();
    }
    let places: Vec<DVec3> =
        cameras.iter().map(|camera| camera.world_from_camera(0).w_axis.truncate()).collect();
    let first = ChaCha8Rng::seed_from_u64(seed).random_range(0..places.len());
    let mut chosen = vec![first];
    while chosen.len() < count.min(places.len()) {
        let nearest = |index: &usize| {
            let distances = chosen.iter().map(|&other| places[*index].distance_squared(places[other]));
            distances.fold(f64::INFINITY, f64::min)
        };
        let left = (0..places.len()).filter(|index| !chosen.contains(index));
        // Reversed, since `max_by` keeps the last of equals.
        match left.rev().max_by(|a, b| nearest(a).total_cmp(&nearest(b))) {
            Some(farthest) => chosen.push(farthest),
            None => break,
        }
    }
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use l4d_data::{Name, Split};

    use super::*;

    fn row(places: &[f64]) -> Vec<Camera> {
        let camera = |(index, x): (usize, &f64)| Camera {
            name: Name::new(format!("cam{index:02}")).unwrap(),
            split: Split::Train,
            fx: 100.0,
            fy: 100.0,
            cx: 50.0,
            cy: 50.0,
            world_from_camera: vec![[1., 0., 0., *x, 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]],
        };
        places.iter().enumerate().map(camera).collect()
    }

    #[test]
    fn the_next_view_is_the_farthest_from_all_before() {
        let cameras = row(&[0.0, 1.0, 2.0, 4.0, 10.0]);
        for seed in 0..20 {
            let two = spread_views(&cameras, 2, seed);
            assert!(two == [0, 4] || two == [2, 4] || two == [1, 4] || two == [3, 4], "{two:?}");
            let three = spread_views(&cameras, 3, seed);
            assert!(three.contains(&4) && (three.contains(&0) || three.contains(&1)), "{three:?}");
        }
        assert_eq!(spread_views(&cameras, 9, 1), [0, 1, 2, 3, 4]);
        assert_eq!(spread_views(&cameras, 0, 1), [0; 0]);
        assert_eq!(spread_views(&[], 3, 1), [0; 0]);
    }

    #[test]
    fn cameras_in_one_place_are_taken_in_order() {
        let chosen = spread_views(&row(&[5.0; 6]), 3, 7);
        assert_eq!(chosen.len(), 3);
        assert_eq!(chosen, spread_views(&row(&[5.0; 6]), 3, 7));
    }
}
