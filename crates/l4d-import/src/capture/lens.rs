//! Lens distortion, and its removal: our pictures are of pinholes.

use l4d_data::Camera;
use l4d_frames::drawn::{Rgb, RgbImage};

/// Brown's model, as OpenCV, COLMAP, nerfstudio and Nerfies have it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Distortion {
    /// k1, k2, k3.
    pub(super) radial: [f64; 3],
    /// p1, p2.
    pub(super) tangential: [f64; 2],
}

impl Distortion {
    pub(super) fn is_none(self) -> bool {
        self == Self::default()
    }

    /// Where a pinhole's ray goes through the lens; both as x/z and y/z.
    pub(super) fn distorted(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([k1, k2, k3], [p1, p2]) = (self.radial, self.tangential);
        let squared = x * x + y * y;
        let radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
        [
            x * radial + 2.0 * p1 * x * y + p2 * (squared + 2.0 * x * x),
            y * radial + 2.0 * p2 * x * y + p1 * (squared + 2.0 * y * y),
        ]
    }

    /// What a pinhole with the same intrinsics would have seen; black where the lens saw nothing.
    pub(super) fn undistorted(self, camera: &Camera, picture: &RgbImage) -> RgbImage {
        let (width, height) = picture.dimensions();
        RgbImage::from_fn(width, height, |column, row| {
            let x = (f64::from(column) + 0.5 - camera.cx) / camera.fx;
            let y = (f64::from(row) + 0.5 - camera.cy) / camera.fy;
            let [x, y] = self.distorted([x, y]);
            sample(picture, x * camera.fx + camera.cx - 0.5, y * camera.fy + camera.cy - 0.5)
        })
    }
}

/// Bilinear, at a position with pixel centres at integers.
fn sample(picture: &RgbImage, x: f64, y: f64) -> Rgb<u8> {
    let (width, height) = picture.dimensions();
    if !(x > -0.5 && y > -0.5 && x < f64::from(width) - 0.5 && y < f64::from(height) - 0.5) {
        return Rgb([0; 3]);
    }
    let (left, top) = (x.floor(), y.floor());
    let at = |x: f64, y: f64| {
        let column = (x.max(0.0) as u32).min(width - 1);
        let row = (y.max(0.0) as u32).min(height - 1);
        picture.get_pixel(column, row).0.map(f64::from)
    };
    let (right_share, down_share) = (x - left, y - top);
    let corners = [at(left, top), at(left + 1.0, top), at(left, top + 1.0), at(left + 1.0, top + 1.0)];
    let mix = |channel: usize| {
        let upper = corners[0][channel] + right_share * (corners[1][channel] - corners[0][channel]);
        let lower = corners[2][channel] + right_share * (corners[3][channel] - corners[2][channel]);
        (upper + down_share * (lower - upper)).round() as u8
    };
    Rgb([mix(0), mix(1), mix(2)])
}

#[cfg(test)]
mod tests {
    use l4d_data::{Name, Split};

    use super::*;

    fn camera() -> Camera {
        Camera {
            name: Name::new("a").unwrap(),
            split: Split::Train,
            fx: 60.0,
            fy: 60.0,
            cx: 40.0,
            cy: 30.0,
            world_from_camera: Vec::new(),
        }
    }

    #[test]
    fn no_distortion_changes_nothing() {
        let picture = RgbImage::from_fn(80, 60, |x, y| Rgb([x as u8, y as u8, (x ^ y) as u8]));
        assert!(Distortion::default().is_none());
        assert_eq!(Distortion::default().undistorted(&camera(), &picture), picture);
    }

    #[test]
    fn straight_lines_seen_through_a_lens_become_straight() {
        let distortion = Distortion { radial: [-0.2, 0.03, 0.0], tangential: [0.002, -0.001] };
        // A vertical edge of the world at x/z = 0.25, as the lens draws it: painted by searching the ray of each pixel.
        let undo = |target: [f64; 2]| {
            (0..50).fold(target, |guess: [f64; 2], _| {
                let [x, y] = distortion.distorted(guess);
                [guess[0] + target[0] - x, guess[1] + target[1] - y]
            })
        };
        let seen = RgbImage::from_fn(80, 60, |column, row| {
            let ray = undo([(f64::from(column) + 0.5 - 40.0) / 60.0, (f64::from(row) + 0.5 - 30.0) / 60.0]);
            Rgb([if ray[0] > 0.25 { 255 } else { 0 }; 3])
        });
        let straight = distortion.undistorted(&camera(), &seen);
        let bright = |picture: &RgbImage, row| {
            (0..80).filter(|&x| picture.get_pixel(x, row).0[0] > 127).map(|x| x as i64).min()
        };
        let edges: Vec<i64> = (4..56).filter_map(|row| bright(&straight, row)).collect();
        assert!(edges.iter().all(|edge| (54..=56).contains(edge)), "the edge lies at 55: {edges:?}");
        let bent: Vec<i64> = (4..56).filter_map(|row| bright(&seen, row)).collect();
        assert!(bent.iter().max().unwrap() - bent.iter().min().unwrap() >= 1, "the lens distorts: {bent:?}");
    }
}
