//! What the unit tests of several modules are about.

use l4d_data::{Camera, Name, Split};

/// A training camera at `x`, which looks along +z at pictures of 4 x 3 pixels.
pub(crate) fn camera(name: &str, x: f64) -> Camera {
    Camera {
        name: Name::new(name).unwrap(),
        split: Split::Train,
        fx: 4.0,
        fy: 4.0,
        cx: 2.0,
        cy: 1.5,
        world_from_camera: vec![[1., 0., 0., x, 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]],
    }
}
