//! From where a picture is drawn, and how many pixels it has.
//!
//! OpenCV axes (x right, y down, z forward); the centre of pixel (column, row) is (column + 0.5, row + 0.5).

use glam::DMat4;
use l4d_data::Camera;
use l4d_data::camera::is_rigid;

/// Longest side of a picture, pixels.
const LONGEST_SIDE: u32 = 1 << 15;
/// Most pixels of a picture: what one can be asked to allocate for.
const MOST_PIXELS: u64 = 1 << 26;

/// A pinhole camera at one moment. Kept in f64: rasterizers subtract its centre before they round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    size: [u32; 2],
    focal: [f64; 2],
    principal: [f64; 2],
    camera_from_world: [[f64; 4]; 3],
}

/// Why a view cannot be drawn from: the field, its value and the hint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ViewError(String);

impl View {
    /// A view of `size` (width, height) pixels; `focal` and `principal` are (x, y) in pixels, `camera_from_world`
    /// the upper three rows of a rigid motion in metres.
    ///
    /// # Errors
    /// Sizes and numbers that no camera has; a pose that is not a rigid motion.
    pub fn new(
        size: [u32; 2],
        focal: [f64; 2],
        principal: [f64; 2],
        camera_from_world: [[f64; 4]; 3],
    ) -> Result<Self, ViewError> {
        let [width, height] = size;
        let sides_fit = size.iter().all(|side| (1..=LONGEST_SIDE).contains(side));
        if !sides_fit || u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(size_error(width, height));
        }
        let [[fx, fy], [cx, cy]] = [focal, principal];
        let (lens, centre) =
            ("a focal length is 0.001 to 1e9 pixels", "a principal point is finite, below 1e9");
        for (field, value, range, hint) in [
            ("fx", fx, 1e-3..=1e9, lens),
            ("fy", fy, 1e-3..=1e9, lens),
            ("cx", cx, -1e9..=1e9, centre),
            ("cy", cy, -1e9..=1e9, centre),
        ] {
            if !range.contains(&value) {
                return Err(ViewError(format!("field `{field}` of the view is {value}: {hint}")));
            }
        }
        let [right, down, ahead] = camera_from_world;
        let rows = DMat4::from_cols_array_2d(&[right, down, ahead, [0.0, 0.0, 0.0, 1.0]]);
        if !is_rigid(&rows.transpose()) {
            let message =
                "field `camera_from_world` of the view is not a rigid motion (rotation and translation)";
            return Err(ViewError(message.to_owned()));
        }
        Ok(Self { size, focal, principal, camera_from_world })
    }

    /// What `camera` sees at a canonical frame, in a picture of `size` pixels; its intrinsics are those of pictures
    /// of `camera_size` (the size in its `scene.json`).
    ///
    /// # Errors
    /// As [`Self::new`], and a frame for which a moving camera has no pose.
    pub fn of_camera(
        camera: &Camera,
        frame: u32,
        camera_size: [u32; 2],
        size: [u32; 2],
    ) -> Result<Self, ViewError> {
        let poses = camera.world_from_camera.len();
        if poses == 0 || (poses > 1 && frame as usize >= poses) {
            let name = &camera.name;
            return Err(ViewError(format!("camera `{name}` has {poses} poses, none for frame {frame}")));
        }
        let [width, height] = camera_size;
        if width == 0 || height == 0 {
            return Err(size_error(width, height));
        }
        let camera = camera.resized(camera_size, size);
        let columns = camera.camera_from_world(frame).to_cols_array_2d();
        let camera_from_world = std::array::from_fn(|row| std::array::from_fn(|column| columns[column][row]));
        Self::new(size, [camera.fx, camera.fy], [camera.cx, camera.cy], camera_from_world)
    }

    /// Pixels.
    pub fn width(&self) -> u32 {
        self.size[0]
    }

    /// Pixels.
    pub fn height(&self) -> u32 {
        self.size[1]
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Focal lengths (x, y), pixels.
    pub fn focal(&self) -> [f64; 2] {
        self.focal
    }

    /// Principal point (x, y), pixels.
    pub fn principal(&self) -> [f64; 2] {
        self.principal
    }

    /// Upper three rows of the pose, metres.
    pub fn camera_from_world(&self) -> [[f64; 4]; 3] {
        self.camera_from_world
    }

    /// Rows of the rotation from world to camera axes.
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        self.camera_from_world.map(|[x, y, z, _]| [x, y, z])
    }

    /// Position of the camera in world axes, metres.
    pub fn centre(&self) -> [f64; 3] {
        let pose = &self.camera_from_world;
        std::array::from_fn(|axis| -pose.iter().map(|row| row[axis] * row[3]).sum::<f64>())
    }
}

fn size_error(width: u32, height: u32) -> ViewError {
    ViewError(format!(
        "a picture of {width} x {height} pixels: sides are 1 to {LONGEST_SIDE}, pixels at most {MOST_PIXELS}"
    ))
}

#[cfg(test)]
mod tests {
    use l4d_data::{Name, Split};

    use super::*;

    const AHEAD: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    fn camera() -> Camera {
        // Looks along world +X from (1, 2, 3): camera x = world -Y, camera y = world -Z.
        let pose = [0., 0., 1., 1., -1., 0., 0., 2., 0., -1., 0., 3., 0., 0., 0., 1.];
        Camera {
            name: Name::new("cam00").unwrap(),
            split: Split::Train,
            fx: 200.0,
            fy: 100.0,
            cx: 64.0,
            cy: 48.0,
            world_from_camera: vec![pose],
        }
    }

    #[test]
    fn a_camera_is_scaled_to_the_size_of_the_picture() {
        let view = View::of_camera(&camera(), 7, [128, 96], [256, 192]).unwrap();
        assert_eq!((view.focal(), view.principal()), ([400.0, 200.0], [128.0, 96.0]));
        assert_eq!((view.width(), view.height(), view.pixel_count()), (256, 192, 256 * 192));
        for (axis, expected) in [1.0, 2.0, 3.0].into_iter().enumerate() {
            assert!((view.centre()[axis] - expected).abs() < 1e-12);
        }
        assert_eq!(view.rotation()[2], [1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_moving_camera_has_no_frames_that_were_not_recorded() {
        let mut moving = camera();
        moving.world_from_camera.push(moving.world_from_camera[0]);
        assert!(View::of_camera(&moving, 1, [128, 96], [128, 96]).is_ok());
        let error = View::of_camera(&moving, 2, [128, 96], [128, 96]).unwrap_err();
        assert_eq!(error.to_string(), "camera `cam00` has 2 poses, none for frame 2");
        moving.world_from_camera.clear();
        assert!(View::of_camera(&moving, 0, [128, 96], [128, 96]).is_err());
    }

    #[test]
    fn views_that_cannot_be_are_refused() {
        let with = |size, focal, pose| View::new(size, focal, [0.0, 0.0], pose);
        assert!(with([1, 1], [1.0, 1.0], AHEAD).is_ok());
        for size in [[0, 4], [4, 0], [1 << 16, 1], [1 << 15, 1 << 15]] {
            assert!(with(size, [1.0, 1.0], AHEAD).is_err(), "{size:?}");
        }
        for focal in [0.0, -3.0, f64::NAN, f64::INFINITY] {
            let error = with([4, 4], [1.0, focal], AHEAD).unwrap_err().to_string();
            assert!(error.contains("`fy`"), "{error}");
        }
        let mut mirrored = AHEAD;
        mirrored[0][0] = -1.0;
        let mut lost = AHEAD;
        lost[1][3] = f64::NAN;
        for pose in [mirrored, lost, [[0.0; 4]; 3]] {
            assert!(with([4, 4], [1.0, 1.0], pose).unwrap_err().to_string().contains("rigid motion"));
        }
        assert!(View::of_camera(&camera(), 0, [0, 96], [128, 96]).is_err());
    }
}
