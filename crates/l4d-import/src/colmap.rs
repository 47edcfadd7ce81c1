//! COLMAP's sparse models: cameras, images, points, as text or binary.
//!
//! Owns the two encodings of the same three lists, and how a pinhole of ours stands in them: no picture, no scene. Quaternions are
//! `camera_from_world`, axes are OpenCV's, and the centre of the first pixel is (0.5, 0.5), as everywhere here.

mod binary;
mod pinholes;
mod text;

use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use l4d_data::DataError;
use l4d_data::store::{read_bounded, write_atomic};

pub use self::pinholes::picture_name;

/// No file of a model is larger, bytes.
const MAX_BYTES: u64 = 4 << 30;
const REMEDY: &str = "export the model again with COLMAP (`colmap model_converter`)";

/// How a model is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// `cameras.txt`, `images.txt`, `points3D.txt`.
    Text,
    /// `cameras.bin`, `images.bin`, `points3D.bin`.
    Binary,
}

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

/// How a camera bends light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lens {
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

impl Lens {
    /// The lenses that are understood, with their names, numbers and counts of parameters.
    const ALL: [(Self, &'static str, i32, usize); 5] = [
        (Self::SimplePinhole, "SIMPLE_PINHOLE", 0, 3),
        (Self::Pinhole, "PINHOLE", 1, 4),
        (Self::SimpleRadial, "SIMPLE_RADIAL", 2, 4),
        (Self::Radial, "RADIAL", 3, 5),
        (Self::OpenCv, "OPENCV", 4, 8),
    ];

    fn entry(self) -> (Self, &'static str, i32, usize) {
        // A lens that is missing in the list would be a pinhole; the test below counts them.
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
    pub lens: Lens,
    /// Columns.
    pub width: u64,
    /// Rows.
    pub height: u64,
    /// Parameters of the lens.
    pub parameters: Vec<f64>,
}

impl ModelCamera {
    /// `fx, fy, cx, cy` without what bends straight lines.
    pub fn pinhole(&self) -> [f64; 4] {
        match (self.lens, self.parameters.as_slice()) {
            (Lens::Pinhole | Lens::OpenCv, &[fx, fy, cx, cy, ..]) => [fx, fy, cx, cy],
            (_, &[f, cx, cy, ..]) => [f, f, cx, cy],
            _ => [f64::NAN; 4],
        }
    }

    /// Whether a parameter bends straight lines.
    pub fn is_distorted(&self) -> bool {
        let first = if matches!(self.lens, Lens::Pinhole | Lens::OpenCv) { 4 } else { 3 };
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

/// A point and who sees it.
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

    /// Writes the three files into a folder.
    pub fn write(&self, folder: &Path, encoding: Encoding) -> Result<(), DataError> {
        let (suffix, files) = match encoding {
            Encoding::Text => {
                let files = [
                    text::encode_cameras(&self.cameras),
                    text::encode_images(&self.images),
                    text::encode_points(&self.points),
                ];
                ("txt", files.map(String::into_bytes))
            }
            Encoding::Binary => {
                let files = [
                    binary::encode_cameras(&self.cameras),
                    binary::encode_images(&self.images),
                    binary::encode_points(&self.points),
                ];
                ("bin", files)
            }
        };
        for (stem, bytes) in ["cameras", "images", "points3D"].into_iter().zip(files) {
            write_atomic(&folder.join(format!("{stem}.{suffix}")), &bytes)?;
        }
        Ok(())
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
                lens: Lens::Pinhole,
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

    #[test]
    fn both_encodings_bring_back_every_bit() {
        for encoding in [Encoding::Text, Encoding::Binary] {
            let folder = tempfile::tempdir().unwrap();
            model().write(folder.path(), encoding).unwrap();
            assert_eq!(Model::read(folder.path()).unwrap(), model(), "{encoding:?}");
        }
    }

    #[test]
    fn every_lens_knows_itself() {
        for (lens, name, number, count) in Lens::ALL {
            assert_eq!((lens.name(), lens.number(), lens.parameter_count()), (name, number, count));
            assert_eq!((Lens::of_name(name), Lens::of_number(number)), (Some(lens), Some(lens)));
        }
    }

    #[test]
    fn cut_files_and_absurd_counts_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for (encoding, name) in [(Encoding::Text, "images.txt"), (Encoding::Binary, "images.bin")] {
            let path = folder.path().join(name);
            model().write(folder.path(), encoding).unwrap();
            let whole = std::fs::read(&path).unwrap();
            if encoding == Encoding::Binary {
                for length in 0..whole.len() {
                    std::fs::write(&path, &whole[..length]).unwrap();
                    assert!(Model::read(folder.path()).is_err(), "{length} bytes passed");
                }
                let mut absurd = whole.clone();
                absurd[..8].copy_from_slice(&u64::MAX.to_le_bytes());
                std::fs::write(&path, absurd).unwrap();
                assert!(Model::read(folder.path()).is_err());
            } else {
                let text = String::from_utf8(whole).unwrap();
                std::fs::write(&path, text.replace(" 1 a b.png", " 9 a b.png")).unwrap();
                let error = Model::read(folder.path()).unwrap_err().to_string();
                assert!(error.contains("names camera 9"), "{error}");
                std::fs::write(&path, text.replace("a b.png", "")).unwrap();
                assert!(Model::read(folder.path()).is_err());
            }
        }
    }

    #[test]
    fn intrinsics_lose_only_what_bends() {
        let mut camera = model().cameras.remove(0);
        assert_eq!((camera.pinhole(), camera.is_distorted()), ([70.1, 70.2, 32.0, 24.0], false));
        camera.lens = Lens::SimpleRadial;
        camera.parameters = vec![50.0, 32.0, 24.0, 0.01];
        assert_eq!((camera.pinhole(), camera.is_distorted()), ([50.0, 50.0, 32.0, 24.0], true));
    }
}
