//! Pixels to points and back, in f32: for millions of pixels at once.

use crate::view::View;

/// A view, prepared for single points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pinhole {
    size: [f32; 2],
    focal: [f32; 2],
    principal: [f32; 2],
    rotation: [[f32; 3]; 3],
    centre: [f32; 3],
}

impl Pinhole {
    pub(super) fn new(view: &View) -> Self {
        let narrow = |value: f64| value as f32;
        Self {
            size: [view.width() as f32, view.height() as f32],
            focal: view.focal().map(narrow),
            principal: view.principal().map(narrow),
            rotation: view.rotation().map(|row| row.map(narrow)),
            centre: view.centre().map(narrow),
        }
    }

    /// Position (u, v) of the centre of a pixel, by its row-major index.
    pub(super) fn centre_of(&self, pixel: usize) -> [f32; 2] {
        let width = self.size[0] as usize;
        [(pixel % width) as f32 + 0.5, (pixel / width) as f32 + 0.5]
    }

    /// Direction in world axes whose planar depth is 1.
    pub(super) fn ray(&self, position: [f32; 2]) -> [f32; 3] {
        let x = (position[0] - self.principal[0]) / self.focal[0];
        let y = (position[1] - self.principal[1]) / self.focal[1];
        std::array::from_fn(|axis| {
            x * self.rotation[0][axis] + y * self.rotation[1][axis] + self.rotation[2][axis]
        })
    }

    /// World point at a position and planar depth, metres.
    pub(super) fn world(&self, position: [f32; 2], depth_m: f32) -> [f32; 3] {
        let ray = self.ray(position);
        std::array::from_fn(|axis| self.centre[axis] + ray[axis] * depth_m)
    }

    /// Row-major index of the pixel that shows a world point, and its planar depth, metres; none outside the picture.
    pub(super) fn pixel(&self, point: [f32; 3]) -> Option<(usize, f32)> {
        let offset: [f32; 3] = std::array::from_fn(|axis| point[axis] - self.centre[axis]);
        let [x, y, z] = self.rotation.map(|row| row[0] * offset[0] + row[1] * offset[1] + row[2] * offset[2]);
        if z <= 0.0 {
            return None;
        }
        let u = self.focal[0] * x / z + self.principal[0];
        let v = self.focal[1] * y / z + self.principal[1];
        let inside = u >= 0.0 && u < self.size[0] && v >= 0.0 && v < self.size[1];
        inside.then(|| (v as usize * self.size[0] as usize + u as usize, z))
    }

    /// Metres that a pixel spans at a planar depth.
    pub(super) fn footprint_m(&self, depth_m: f32) -> f32 {
        2.0 * depth_m / (self.focal[0] + self.focal[1])
    }

    /// Position of the camera, metres.
    pub(super) fn centre(&self) -> [f32; 3] {
        self.centre
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_comes_back_from_its_point() {
        // Looks along world +X from (1, 2, 3): camera x = world -Y, camera y = world -Z.
        let pose = [[0.0, -1.0, 0.0, 2.0], [0.0, 0.0, -1.0, 3.0], [1.0, 0.0, 0.0, -1.0]];
        let view = View::new([8, 6], [4.0, 2.0], [4.0, 3.0], pose).unwrap();
        let pinhole = Pinhole::new(&view);
        assert_eq!(pinhole.centre_of(8 * 2 + 5), [5.5, 2.5]);
        let point = pinhole.world([5.5, 2.5], 2.0);
        // x = 1.5 / 4 * 2 = 0.75, y = -0.5 / 2 * 2 = -0.5.
        for (found, expected) in point.into_iter().zip([3.0, 1.25, 3.5]) {
            assert!((found - expected).abs() < 1e-6, "{point:?}");
        }
        let (pixel, depth_m) = pinhole.pixel(point).unwrap();
        assert_eq!(pixel, 8 * 2 + 5);
        assert!((depth_m - 2.0).abs() < 1e-6);
        assert_eq!(pinhole.pixel([0.0, 2.0, 3.0]), None);
        assert_eq!(pinhole.pixel([2.0, 9.0, 3.0]), None);
        assert!((pinhole.footprint_m(3.0) - 1.0).abs() < 1e-6);
    }
}
