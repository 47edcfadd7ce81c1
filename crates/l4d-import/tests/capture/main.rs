//! Captures of others, written by the tests in the layouts of their data sets, and read.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

#[path = "../support/mod.rs"]
#[expect(dead_code, reason = "tests of exports use all of it")]
mod support;

mod masks;
mod sources;

use std::path::{Path, PathBuf};

use glam::{DMat3, DMat4, DVec2, DVec3};
use l4d_data::{Camera, DataError, Name, Split};
use l4d_frames::drawn::{RgbImage, encode_colour};
use l4d_import::capture::{Capture, CaptureRequest, Source, import};

/// Rays of a capture are those of the source, pixels.
pub(crate) const RAY_TOLERANCE_PX: f64 = 1e-4;

/// A folder of somebody, and where a capture of it goes.
pub(crate) struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self { folder: l4d_testing::folder() }
    }

    pub(crate) fn input(&self) -> PathBuf {
        self.folder.path().join("input")
    }

    pub(crate) fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    /// Writes a file of the source.
    pub(crate) fn put(&self, path: &str, bytes: impl AsRef<[u8]>) {
        let path = self.input().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    pub(crate) fn read(&self, source: Source) -> Result<Capture, DataError> {
        self.read_with(source, &[], None, Path::new("no-such-ffmpeg"))
    }

    pub(crate) fn read_with(
        &self,
        source: Source,
        held_out: &[String],
        moments: Option<[u32; 2]>,
        ffmpeg: &Path,
    ) -> Result<Capture, DataError> {
        let (input, out) = (self.input(), self.out());
        let name = Name::new("found").unwrap();
        let request =
            CaptureRequest { source, input: &input, name: &name, out: &out, held_out, moments, ffmpeg };
        let capture = import(request, &|| {})?;
        assert_eq!(Capture::read(&out).unwrap(), capture);
        Ok(capture)
    }

    /// The picture of a view of the capture.
    pub(crate) fn picture(&self, capture: &Capture, view: &str, frame: u32) -> RgbImage {
        let bytes = std::fs::read(self.out().join(Capture::picture_path(view, frame))).unwrap();
        l4d_frames::drawn::decode_colour(&bytes, capture.width, capture.height).unwrap()
    }
}

/// A picture that differs from all others.
pub(crate) fn painted(width: u32, height: u32, number: u32) -> RgbImage {
    let value = |x: u32, y: u32| [(x * 5 + number * 40) as u8, (y * 9) as u8, (number * 23) as u8];
    RgbImage::from_fn(width, height, |x, y| l4d_frames::drawn::Rgb(value(x, y)))
}

pub(crate) fn png(width: u32, height: u32, number: u32) -> Vec<u8> {
    encode_colour(&painted(width, height, number))
}

/// A camera somewhere, looking somewhere.
pub(crate) fn pose(number: usize) -> DMat4 {
    let number = number as f64;
    let rotation = DMat3::from_rotation_y(0.2 * number - 0.5) * DMat3::from_rotation_x(0.1 * number - 1.7);
    DMat4::from_mat3_translation(rotation, DVec3::new(number - 2.0, 0.4 * number, 1.0 / 3.0))
}

/// A row of LLFF: down, right, backward, centre, (height, width, focal length).
pub(crate) fn llff_row(pose: DMat4, focal: f64) -> Vec<f64> {
    let columns = [pose.y_axis, pose.x_axis, -pose.z_axis, pose.w_axis];
    let hwf = [96.0, 128.0, focal];
    let mut row: Vec<f64> =
        (0..3).flat_map(|axis| columns.map(|column| column[axis]).into_iter().chain([hwf[axis]])).collect();
    row.extend([0.5, 20.0]);
    row
}

/// Checks that a camera sees points before `world_from_camera` where a pinhole with these intrinsics sees them.
pub(crate) fn assert_rays(camera: &Camera, frame: u32, world_from_camera: DMat4, [fx, fy, cx, cy]: [f64; 4]) {
    for at in [[0.0, 0.0], [63.0, 1.0], [20.0, 47.0], [64.0, 48.0]] {
        for depth in [0.8, 12.0] {
            let local = DVec3::new((at[0] - cx) / fx * depth, (at[1] - cy) / fy * depth, depth);
            let (seen, depth_seen) = camera.project(frame, world_from_camera.transform_point3(local));
            assert!(
                (seen - DVec2::from_array(at)).length() < RAY_TOLERANCE_PX,
                "{}: {seen} for {at:?}",
                camera.name
            );
            assert!((depth_seen - depth).abs() < 1e-9);
        }
    }
}

pub(crate) fn held_out(capture: &Capture) -> Vec<&str> {
    let cameras = capture.cameras.iter().filter(|camera| camera.split == Split::Test);
    cameras.map(|camera| camera.name.as_str()).collect()
}
