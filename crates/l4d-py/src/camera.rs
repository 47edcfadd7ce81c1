//! Pinhole cameras: poses, intrinsics, rays, and the way from pixels to the world and back.

use glam::{DMat4, DVec2, DVec3};
use l4d_data::tracks::TrackedCamera;
use l4d_data::{self as data, Profile, Split};
use numpy::{AllowTypeChange, PyArray1, PyArrayLikeDyn};
use pyo3::prelude::*;

use crate::arrays::{Array, array, check_shape, shape_of};
use crate::error::{Failure, Result, choice, name as checked_name, unknown};
use crate::query::word;

type Numbers<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;

/// A pinhole camera in OpenCV axes (x right, y down, z forward); the world is right-handed, +Z up, in metres.
///
/// The centre of pixel (column, row) is (column + 0.5, row + 0.5), and `u = fx * x / z + cx`.
/// `world_from_camera` is one 4x4 pose, or one for each frame from 0 on: 97 of them (97, 4, 4) on the canonical timeline.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Camera {
    pub(crate) camera: data::Camera,
    /// Width and height of its pictures, pixels.
    pub(crate) size: [u32; 2],
}

impl Camera {
    /// Cameras whose pictures have one size.
    pub(crate) fn all<'a>(cameras: impl IntoIterator<Item = &'a data::Camera>, size: [u32; 2]) -> Vec<Self> {
        cameras.into_iter().map(|camera| Self { camera: camera.clone(), size }).collect()
    }

    /// Those of one split.
    pub(crate) fn of_split(cameras: &[data::Camera], split: Split, size: [u32; 2]) -> Vec<Self> {
        Self::all(cameras.iter().filter(|camera| camera.split == split), size)
    }

    /// The one of that name.
    pub(crate) fn find(cameras: &[data::Camera], name: &str, size: [u32; 2]) -> Result<Self> {
        let known: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        let found = Self::all(cameras.iter().filter(|camera| camera.name.as_str() == name), size).pop();
        found.ok_or_else(|| unknown("view", name, &known))
    }

    /// A camera of the tracks at the size of a profile.
    pub(crate) fn of_tracks(camera: &TrackedCamera, profile: Profile) -> Self {
        let [width, height] = [profile.width(), profile.height()];
        let focal = camera.focal_over_width * f64::from(width);
        let camera = data::Camera {
            name: camera.name.clone(),
            split: camera.split,
            fx: focal,
            fy: focal,
            cx: f64::from(width) / 2.0,
            cy: f64::from(height) / 2.0,
            world_from_camera: camera.world_from_camera.clone(),
        };
        Self { camera, size: [width, height] }
    }

    /// Refuses a frame at which the camera has no pose.
    fn pose_frame(&self, frame: u32) -> Result<u32> {
        let poses = self.camera.world_from_camera.len();
        if poses > 1 && frame as usize >= poses {
            let message = format!("camera {} has {poses} poses, none for frame {frame}", self.camera.name);
            return Err(Failure::argument("frame", message, "give a frame at which it was recorded"));
        }
        Ok(frame)
    }

    /// Pixel centres, row by row.
    fn centres(&self) -> impl Iterator<Item = DVec2> + use<> {
        let [width, height] = self.size;
        let columns = move |row| (0..width).map(move |col| (col, row));
        let centre = |(col, row)| DVec2::new(f64::from(col) + 0.5, f64::from(row) + 0.5);
        (0..height).flat_map(columns).map(centre)
    }
}

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (name, width, height, fx, fy, cx, cy, world_from_camera, *, split = "train"))]
    #[expect(clippy::too_many_arguments, reason = "a camera has that many numbers")]
    fn create(
        name: &str,
        width: u32,
        height: u32,
        fx: f64,
        fy: f64,
        cx: f64,
        cy: f64,
        world_from_camera: Numbers<'_>,
        split: &str,
    ) -> Result<Self> {
        let split = choice("split", split, &["train", "test"])?;
        let world_from_camera = poses(&world_from_camera)?;
        let name = checked_name("name", name)?;
        let camera = data::Camera { name, split, fx, fy, cx, cy, world_from_camera };
        if let Some(problem) = camera.problem() {
            return Err(Failure::argument("camera", problem, "mend the numbers of the camera"));
        }
        Ok(Self { camera, size: [width, height] })
    }

    /// View name, also the folder of its frames.
    #[getter]
    fn name(&self) -> &str {
        &self.camera.name
    }

    /// `"train"` (methods may use it) or `"test"` (held out: only the judge looks at it).
    #[getter]
    fn split(&self) -> String {
        word(&self.camera.split)
    }

    /// Columns of its pictures, pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.size[0]
    }

    /// Rows of its pictures, pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.size[1]
    }

    /// Focal length along columns, pixels.
    #[getter]
    fn fx(&self) -> f64 {
        self.camera.fx
    }

    /// Focal length along rows, pixels.
    #[getter]
    fn fy(&self) -> f64 {
        self.camera.fy
    }

    /// Principal point, column, pixels from the outer corner of the top left pixel.
    #[getter]
    fn cx(&self) -> f64 {
        self.camera.cx
    }

    /// Principal point, row, pixels from the outer corner of the top left pixel.
    #[getter]
    fn cy(&self) -> f64 {
        self.camera.cy
    }

    /// Whether its pose changes over the clip.
    #[getter]
    fn moves(&self) -> bool {
        self.camera.world_from_camera.len() > 1
    }

    /// Intrinsics: float64 (3, 3), pixels; `[u, v, 1] * z = intrinsics @ point_camera`.
    #[getter]
    fn intrinsics<'py>(&self, py: Python<'py>) -> Result<Array<'py, f64, 2>> {
        let data::Camera { fx, fy, cx, cy, .. } = self.camera;
        array(py, vec![fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0], [3, 3])
    }

    /// Pose at a canonical frame: float64 (4, 4), metres; `point_world = world_from_camera @ point_camera`.
    #[pyo3(signature = (frame = 0))]
    fn world_from_camera<'py>(&self, py: Python<'py>, frame: u32) -> Result<Array<'py, f64, 2>> {
        matrix(py, self.camera.world_from_camera(self.pose_frame(frame)?))
    }

    /// Inverse pose at a canonical frame: float64 (4, 4), metres.
    #[pyo3(signature = (frame = 0))]
    fn camera_from_world<'py>(&self, py: Python<'py>, frame: u32) -> Result<Array<'py, f64, 2>> {
        matrix(py, self.camera.camera_from_world(self.pose_frame(frame)?))
    }

    /// Rays through the pixel centres at a canonical frame: the origin, float64 (3,), and directions, float64 (H, W, 3).
    ///
    /// Directions have length 1 along the optical axis, so that `origin + depth_m[..., None] * directions` is the surface
    /// point of a planar depth. Normalise them for the length of the ray.
    #[pyo3(signature = (frame = 0))]
    fn rays<'py>(&self, py: Python<'py>, frame: u32) -> Result<(Array<'py, f64, 1>, Array<'py, f64, 3>)> {
        let pose = self.camera.world_from_camera(self.pose_frame(frame)?);
        let data::Camera { fx, fy, cx, cy, .. } = self.camera;
        let directions = py.detach(|| {
            let along =
                |at: DVec2| pose.transform_vector3(DVec3::new((at.x - cx) / fx, (at.y - cy) / fy, 1.0));
            self.centres().flat_map(|at| along(at).to_array()).collect()
        });
        let [rows, columns] = shape_of(self.size);
        let origin = PyArray1::from_slice(py, &pose.w_axis.truncate().to_array());
        Ok((origin, array(py, directions, [rows, columns, 3])?))
    }

    /// World points, float64 (H, W, 3), metres, of the planar depths (H, W) of a picture at a canonical frame.
    ///
    /// Where nothing was hit (+inf) the point is nan.
    #[pyo3(signature = (depth_m, frame = 0))]
    fn unproject<'py>(
        &self,
        py: Python<'py>,
        depth_m: Numbers<'py>,
        frame: u32,
    ) -> Result<Array<'py, f64, 3>> {
        let frame = self.pose_frame(frame)?;
        let depth = depth_m.as_array();
        let [rows, columns] = shape_of(self.size);
        check_shape("depth_m", depth.shape(), &[rows, columns])?;
        let depths_m: Vec<f64> = depth.iter().copied().collect();
        let point = |(at, &depth_m): (DVec2, &f64)| {
            if depth_m.is_finite() { self.camera.unproject(frame, at, depth_m) } else { DVec3::NAN }
        };
        let points =
            py.detach(|| self.centres().zip(&depths_m).flat_map(|pair| point(pair).to_array()).collect());
        array(py, points, [rows, columns, 3])
    }

    /// Where world points (N, 3), metres, appear at a canonical frame: positions, float64 (N, 2), as (column, row) in
    /// pixels, and planar depths, float64 (N,), metres, negative behind the camera.
    ///
    /// The pixel of a position is its floor, since centres are at half pixels.
    #[pyo3(signature = (points_world, frame = 0))]
    fn project<'py>(
        &self,
        py: Python<'py>,
        points_world: Numbers<'py>,
        frame: u32,
    ) -> Result<(Array<'py, f64, 2>, Array<'py, f64, 1>)> {
        let frame = self.pose_frame(frame)?;
        let points = points_world.as_array();
        let [count, 3] = points.shape() else {
            let message = format!("has the shape {:?}", points.shape());
            let hint = "give points as (N, 3): reshape(-1, 3)";
            return Err(Failure::argument("points_world", message, hint));
        };
        let count = *count;
        let numbers: Vec<f64> = points.iter().copied().collect();
        let (positions, depths_m) = py.detach(|| {
            let points = numbers.as_chunks::<3>().0.iter();
            let seen = points.map(|&point| self.camera.project(frame, DVec3::from_array(point)));
            let (positions, depths_m): (Vec<DVec2>, Vec<f64>) = seen.unzip();
            (positions.into_iter().flat_map(|position| position.to_array()).collect(), depths_m)
        });
        Ok((array(py, positions, [count, 2])?, PyArray1::from_vec(py, depths_m)))
    }

    /// The same camera for pictures of another size, pixels.
    fn resized(&self, width: u32, height: u32) -> Result<Self> {
        if [width, height, self.size[0], self.size[1]].contains(&0) {
            let hint = "give a width and height above 0";
            return Err(Failure::argument("size", "a picture has no pixels", hint));
        }
        Ok(Self { camera: self.camera.resized(self.size, [width, height]), size: [width, height] })
    }

    fn __repr__(&self) -> String {
        format!("Camera('{}', {}x{}, {})", self.camera.name, self.size[0], self.size[1], self.split())
    }
}

fn matrix(py: Python<'_>, matrix: DMat4) -> Result<Array<'_, f64, 2>> {
    array(py, matrix.transpose().to_cols_array().to_vec(), [4, 4])
}

/// One pose (4, 4) or one per canonical frame.
fn poses(numbers: &Numbers<'_>) -> Result<Vec<[f64; 16]>> {
    let array = numbers.as_array();
    if !matches!(array.shape(), [4, 4] | [_, 4, 4]) {
        let message = format!("has the shape {:?}", array.shape());
        let hint = "give one pose, (4, 4), or one for each frame from 0 on, (97, 4, 4)";
        return Err(Failure::argument("world_from_camera", message, hint));
    }
    let numbers: Vec<f64> = array.iter().copied().collect();
    Ok(numbers.as_chunks::<16>().0.to_vec())
}
