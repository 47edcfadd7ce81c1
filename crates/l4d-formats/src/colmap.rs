//! COLMAP's sparse models: cameras, images, points; read as text or binary, written as binary.
//!
//! Quaternions are `camera_from_world`, axes are OpenCV's, and the centre of the first pixel is (0.5, 0.5).

mod binary;
mod text;

use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use l4d_data::DataError;
use l4d_data::store::{read_bounded, write_atomic};

/// No file of a model is larger, bytes.
const MAX_BYTES: u64 = 4 << 30;
const REMEDY: &str = "export the model again with COLMAP (`colmap model_converter`)";

/// A sparse model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    /// Intrinsics.
    pub cameras: Vec<ModelCamera>,
    /// Pictures with their poses.
    pub images: Vec<ModelImage>,
    /// Points of surfaces.
    pub points: Vec<ModelPoint>,
}

/// A camera model: what its parameters mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraModel {
    /// `f, cx, cy`.
    SimplePinhole,
    /// `fx, fy, cx, cy`.
    Pinhole,
    /// `f, cx, cy, k`.
    SimpleRadial,
    /// `f, cx, cy, k1, k2`.
    Radial,
    /// `fx, fy, cx, cy, k1, k2, p1, p2`.
    OpenCv,
}

impl CameraModel {
    /// The models that are understood, with their names, numbers and counts of parameters.
    const ALL: [(Self, &'static str, i32, usize); 5] = [
        (Self::SimplePinhole, "SIMPLE_PINHOLE", 0, 3),
        (Self::Pinhole, "PINHOLE", 1, 4),
        (Self::SimpleRadial, "SIMPLE_RADIAL", 2, 4),
        (Self::Radial, "RADIAL", 3, 5),
        (Self::OpenCv, "OPENCV", 4, 8),
    ];

    fn entry(self) -> (Self, &'static str, i32, usize) {
        // A model that is missing in the list would be a pinhole; the test below counts them.
        Self::ALL.into_iter().find(|entry| entry.0 == self).unwrap_or(Self::ALL[1])
    }

    /// COLMAP's name.
    pub fn name(self) -> &'static str {
        self.entry().1
    }

    fn number(self) -> i32 {
        self.entry().2
    }

    fn parameter_count(self) -> usize {
        self.entry().3
    }

    fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|entry| entry.1 == name).map(|entry| entry.0)
    }

    fn of_number(number: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|entry| entry.2 == number).map(|entry| entry.0)
    }
}

/// Intrinsics of pictures, pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelCamera {
    /// Number that images name.
    pub id: u32,
    /// What the parameters mean.
    pub model: CameraModel,
    /// Columns.
    pub width: u64,
    /// Rows.
    pub height: u64,
    /// Parameters of the model.
    pub parameters: Vec<f64>,
}

impl ModelCamera {
    /// `fx, fy, cx, cy` without what bends straight lines.
    pub fn pinhole(&self) -> [f64; 4] {
        match (self.model, self.parameters.as_slice()) {
            (CameraModel::Pinhole | CameraModel::OpenCv, &[fx, fy, cx, cy, ..]) => [fx, fy, cx, cy],
            (_, &[f, cx, cy, ..]) => [f, f, cx, cy],
            _ => [f64::NAN; 4],
        }
    }

    /// Whether a parameter bends straight lines.
    pub fn is_distorted(&self) -> bool {
        let first = if matches!(self.model, CameraModel::Pinhole | CameraModel::OpenCv) { 4 } else { 3 };
        self.parameters.iter().skip(first).any(|&parameter| parameter != 0.0)
    }
}

/// Where a picture shows a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Column and row, pixels.
    pub position: [f64; 2],
    /// The point; none if no point was made of it.
    pub point: Option<u64>,
}

/// A picture and its pose.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelImage {
    /// Number that tracks name.
    pub id: u32,
    /// `camera_from_world`, a unit quaternion.
    pub rotation: DQuat,
    /// `camera_from_world`.
    pub translation: DVec3,
    /// Number of its intrinsics.
    pub camera: u32,
    /// File name, relative to the folder of the images.
    pub name: String,
    /// What it shows.
    pub observations: Vec<Observation>,
}

impl ModelImage {
    /// The pose as a matrix.
    pub fn camera_from_world(&self) -> DMat4 {
        DMat4::from_rotation_translation(self.rotation.normalize(), self.translation)
    }
}

/// A point and the images that see it.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelPoint {
    /// Number that observations name.
    pub id: u64,
    /// World.
    pub position: DVec3,
    /// Display colour.
    pub rgb: [u8; 3],
    /// Mean distance between where it is seen and where it projects, pixels.
    pub error_px: f64,
    /// (image, place in its observations).
    pub track: Vec<(u32, u32)>,
}

impl Model {
    /// Reads the model in a folder, binary if both are there, as COLMAP does.
    ///
    /// # Errors
    /// Files that cannot be read, lens models other than the five, images of missing cameras, poses that are none.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        let is_binary = folder.join("cameras.bin").is_file();
        let read = |stem: &str| {
            let path = folder.join(if is_binary { format!("{stem}.bin") } else { format!("{stem}.txt") });
            Ok::<_, DataError>((read_bounded(&path, MAX_BYTES)?, path))
        };
        let (cameras, images, points) = (read("cameras")?, read("images")?, read("points3D")?);
        let model = if is_binary {
            Self {
                cameras: binary::cameras(&cameras.1, &cameras.0)?,
                images: binary::images(&images.1, &images.0)?,
                points: binary::points(&points.1, &points.0)?,
            }
        } else {
            Self {
                cameras: text::cameras(&cameras.1, &cameras.0)?,
                images: text::images(&images.1, &images.0)?,
                points: text::points(&points.1, &points.0)?,
            }
        };
        model.check(&images.1)?;
        Ok(model)
    }

    /// Writes the three binary files into a folder.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn write(&self, folder: &Path) -> Result<(), DataError> {
        write_atomic(&folder.join("cameras.bin"), &binary::encode_cameras(&self.cameras))?;
        write_atomic(&folder.join("images.bin"), &binary::encode_images(&self.images))?;
        write_atomic(&folder.join("points3D.bin"), &binary::encode_points(&self.points))
    }

    /// The intrinsics of that number.
    pub fn camera(&self, id: u32) -> Option<&ModelCamera> {
        self.cameras.iter().find(|camera| camera.id == id)
    }

    fn check(&self, path: &Path) -> Result<(), DataError> {
        for image in &self.images {
            let rotation_length = image.rotation.length();
            let sound = image.translation.is_finite() && (rotation_length - 1.0).abs() < 1e-3;
            let problem = if self.camera(image.camera).is_none() {
                format!("names camera {}, which is not there", image.camera)
            } else if !sound {
                "has a pose that is no rotation and translation".to_owned()
            } else {
                continue;
            };
            return Err(DataError::invalid(path, format!("image {}", image.id), problem, REMEDY));
        }
        Ok(())
    }
}

/// Reads a file of points: `points3D.txt`, or else the binary form.
///
/// # Errors
/// A file that cannot be read, or that is of another kind.
pub fn read_points(path: &Path) -> Result<Vec<ModelPoint>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let is_text = path.extension().is_some_and(|extension| extension == "txt");
    if is_text { text::points(path, &bytes) } else { binary::points(path, &bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> Model {
        let observed = Observation { position: [10.5, 20.25], point: Some(7) };
        let unused = Observation { position: [1.0, 2.0], point: None };
        let image = |id, name: &str, observations| ModelImage {
            id,
            rotation: DQuat::from_rotation_y(0.3),
            translation: DVec3::new(0.1, -2.0, 1e-7),
            camera: 1,
            name: name.to_owned(),
            observations,
        };
        Model {
            cameras: vec![ModelCamera {
                id: 1,
                model: CameraModel::Pinhole,
                width: 64,
                height: 48,
                parameters: vec![70.1, 70.2, 32.0, 24.0],
            }],
            images: vec![image(1, "a b.png", vec![unused, observed]), image(2, "c.png", Vec::new())],
            points: vec![ModelPoint {
                id: 7,
                position: DVec3::new(1.0, 2.0, 1.0 / 3.0),
                rgb: [1, 2, 3],
                error_px: 0.25,
                track: vec![(1, 1)],
            }],
        }
    }

    /// The same model as COLMAP writes it in text.
    const TEXT: [(&str, &str); 3] = [
        ("cameras.txt", "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n1 PINHOLE 64 48 70.1 70.2 32 24\n"),
        (
            "images.txt",
            "# two lines per image\n1 QUAT 0.1 -2 1e-7 1 a b.png\n1 2 -1 10.5 20.25 7\n2 QUAT 0.1 -2 1e-7 1 c.png\n\n",
        ),
        ("points3D.txt", "# a line per point\n7 1 2 0.3333333333333333 1 2 3 0.25 1 1\n"),
    ];

    fn write_text(folder: &Path) {
        let DQuat { x, y, z, w } = DQuat::from_rotation_y(0.3);
        for (name, text) in TEXT {
            std::fs::write(folder.join(name), text.replace("QUAT", &format!("{w} {x} {y} {z}"))).unwrap();
        }
    }

    #[test]
    fn both_encodings_bring_back_every_bit() {
        let folder = tempfile::tempdir().unwrap();
        write_text(folder.path());
        assert_eq!(Model::read(folder.path()).unwrap(), model());
        model().write(folder.path()).unwrap();
        assert_eq!(Model::read(folder.path()).unwrap(), model());
    }

    #[test]
    fn every_camera_model_knows_itself() {
        for (model, name, number, count) in CameraModel::ALL {
            assert_eq!((model.name(), model.number(), model.parameter_count()), (name, number, count));
            assert_eq!(
                (CameraModel::of_name(name), CameraModel::of_number(number)),
                (Some(model), Some(model))
            );
        }
    }

    #[test]
    fn cut_files_and_absurd_counts_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("images.bin");
        model().write(folder.path()).unwrap();
        let mut whole = std::fs::read(&path).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(Model::read(folder.path()).is_err(), "{length} bytes passed");
        }
        whole[..8].copy_from_slice(&u64::MAX.to_le_bytes());
        std::fs::write(&path, whole).unwrap();
        assert!(Model::read(folder.path()).is_err());
    }

    #[test]
    fn text_that_names_no_camera_or_no_image_is_refused() {
        for (from, to, said) in
            [(" 1 a b.png", " 9 a b.png", "names camera 9"), ("a b.png", "", "is missing")]
        {
            let folder = tempfile::tempdir().unwrap();
            write_text(folder.path());
            let path = folder.path().join("images.txt");
            let text = std::fs::read_to_string(&path).unwrap();
            std::fs::write(&path, text.replace(from, to)).unwrap();
            let error = Model::read(folder.path()).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn intrinsics_lose_only_what_bends() {
        let mut camera = model().cameras.remove(0);
        assert_eq!((camera.pinhole(), camera.is_distorted()), ([70.1, 70.2, 32.0, 24.0], false));
        camera.model = CameraModel::SimpleRadial;
        camera.parameters = vec![50.0, 32.0, 24.0, 0.01];
        assert_eq!((camera.pinhole(), camera.is_distorted()), ([50.0, 50.0, 32.0, 24.0], true));
    }
}
