//! The box whose inside the planes resolve. Outside it everything is as on its nearest face.

use super::DeformError;

/// An axis-aligned box in world axes that has an inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    max: [f32; 3],
    min: [f32; 3],
    /// From metres to coordinates from 1 (at `min`) to -1 (at `max`).
    scale: [f32; 3],
}

impl Bounds {
    /// The box of a checkpoint: row 0 the larger corner, row 1 the smaller, metres.
    ///
    /// # Errors
    /// A corner that is not finite, and an axis without extent.
    pub fn new([max, min]: [[f32; 3]; 2]) -> Result<Self, DeformError> {
        let mut scale = [0.0; 3];
        for axis in 0..3 {
            scale[axis] = 2.0 / (min[axis] - max[axis]);
            let is_finite = max[axis].is_finite() && min[axis].is_finite();
            // An extent that over- or underflows would turn positions into NaN.
            if !is_finite || max[axis] <= min[axis] || !scale[axis].is_normal() {
                return Err(DeformError(format!(
                    "bounding box of the deformation field: axis {} runs from {} to {}: both must be finite and the \
                     first (row 1 of `aabb`) smaller than the second (row 0); widen the box along this axis",
                    ["x", "y", "z"][axis],
                    min[axis],
                    max[axis]
                )));
            }
        }
        Ok(Self { max, min, scale })
    }

    /// Corners as checkpoints have them: the larger, then the smaller, metres.
    pub fn corners(&self) -> [[f32; 3]; 2] {
        [self.max, self.min]
    }

    /// Coordinates of a position, -1 at the larger face and +1 at the smaller: the axes of 4DGaussians run backwards.
    pub(super) fn coordinates(&self, position: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| (position[axis] - self.max[axis]) * self.scale[axis] - 1.0)
    }

    /// Change of each coordinate per metre.
    pub(super) fn scale(&self) -> [f32; 3] {
        self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_face_is_minus_one() {
        let bounds = Bounds::new([[1.0, 2.0, 3.0], [-1.0, 0.0, -3.0]]).unwrap();
        assert_eq!(bounds.coordinates([1.0, 2.0, 3.0]), [-1.0; 3]);
        assert_eq!(bounds.coordinates([-1.0, 0.0, -3.0]), [1.0; 3]);
        assert_eq!(bounds.coordinates([0.5, 1.0, -1.5]), [-0.5, 0.0, 0.5]);
        assert_eq!(bounds.scale(), [-1.0, -1.0, -1.0 / 3.0]);
    }

    #[test]
    fn a_box_without_an_inside_is_refused_by_axis() {
        let refused = |max, min| Bounds::new([max, min]).unwrap_err().to_string();
        assert!(refused([1.0, 2.0, 1.0], [0.0, 2.0, 0.0]).contains("axis y runs from 2 to 2"));
        assert!(refused([1.0, 1.0, -1.0], [0.0, 0.0, 1.0]).contains("axis z runs from 1 to -1"));
        assert!(refused([f32::NAN, 1.0, 1.0], [0.0; 3]).contains("axis x runs from 0 to NaN"));
        assert!(refused([f32::INFINITY, 1.0, 1.0], [0.0; 3]).contains("axis x"));
        assert!(refused([f32::MAX; 3], [f32::MIN; 3]).contains("axis x"));
        assert!(refused([1.0, 1.0e-40, 1.0], [0.0; 3]).contains("axis y"));
    }
}
