//! COLMAP's sparse models: cameras, images, points; read as text or binary, written as binary.
//!
//! Quaternions are `camera_from_world`, axes are OpenCV's, and the centre of the first pixel is (0.5, 0.5).

mod fields;

use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use l4d_data::DataError;
use l4d_data::store::{read_bounded, write_atomic};

use self::fields::{Binary, Entry, Fields, Text};

/// No file of a model is larger, bytes.
const MAX_BYTES: u64 = 4 << 30;
const HINT: &str = "export the model again with COLMAP (`colmap model_converter`)";

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

/// A camera model: what its parameters mean. Numbers and names are COLMAP's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, strum::EnumString, strum::FromRepr)]
#[strum(serialize_all = "SCREAMING_SNAKE_CASE")]
#[repr(i32)]
pub enum CameraModel {
    /// `f, cx, cy`.
    SimplePinhole = 0,
    /// `fx, fy, cx, cy`.
    Pinhole = 1,
    /// `f, cx, cy, k`.
    SimpleRadial = 2,
    /// `f, cx, cy, k1, k2`.
    Radial = 3,
    /// `fx, fy, cx, cy, k1, k2, p1, p2`.
    #[strum(serialize = "OPENCV")]
    OpenCv = 4,
}

impl CameraModel {
    fn parameter_count(self) -> usize {
        match self {
            Self::SimplePinhole => 3,
            Self::Pinhole | Self::SimpleRadial => 4,
            Self::Radial => 5,
            Self::OpenCv => 8,
        }
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
    /// `fx, fy, cx, cy` without distortion.
    pub fn pinhole(&self) -> [f64; 4] {
        match (self.model, self.parameters.as_slice()) {
            (CameraModel::Pinhole | CameraModel::OpenCv, &[fx, fy, cx, cy, ..]) => [fx, fy, cx, cy],
            (_, &[f, cx, cy, ..]) => [f, f, cx, cy],
            _ => [f64::NAN; 4],
        }
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
        let end = if folder.join("cameras.bin").is_file() { "bin" } else { "txt" };
        let path = |stem: &str| folder.join(format!("{stem}.{end}"));
        let images = path("images");
        let model = Self {
            cameras: read(&path("cameras"))?,
            images: read(&images)?,
            points: read_points(&path("points3D"))?,
        };
        model.check(&images)?;
        Ok(model)
    }

    /// Writes the three binary files into a folder.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn write(&self, folder: &Path) -> Result<(), DataError> {
        write_atomic(&folder.join("cameras.bin"), &encode_cameras(&self.cameras))?;
        write_atomic(&folder.join("images.bin"), &encode_images(&self.images))?;
        write_atomic(&folder.join("points3D.bin"), &encode_points(&self.points))
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
            return Err(DataError::invalid(path, format!("image {}", image.id), problem, HINT));
        }
        Ok(())
    }
}

/// Reads a file of points: `points3D.txt`, or else the binary form.
///
/// # Errors
/// A file that cannot be read, or that is of another kind.
pub fn read_points(path: &Path) -> Result<Vec<ModelPoint>, DataError> {
    read(path)
}

/// Reads a file in the encoding that its name says.
fn read<T: Entry>(path: &Path) -> Result<Vec<T>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    match path.extension().is_some_and(|extension| extension == "txt") {
        true => Text::new(path, &bytes)?.entries(),
        false => Binary::new(path, &bytes).entries(),
    }
}

impl Entry for ModelCamera {
    fn read(fields: &mut impl Fields) -> Result<Self, DataError> {
        let id = fields.number("id")?;
        let model = fields.model()?;
        let (width, height) = (fields.number("width")?, fields.number("height")?);
        let parameters =
            (0..model.parameter_count()).map(|_| fields.number("parameters")).collect::<Result<_, _>>()?;
        Ok(Self { id, model, width, height, parameters })
    }
}

impl Entry for ModelImage {
    fn read(fields: &mut impl Fields) -> Result<Self, DataError> {
        let id = fields.number("id")?;
        let (w, x) = (fields.number("qw")?, fields.number("qx")?);
        let rotation = DQuat::from_xyzw(x, fields.number("qy")?, fields.number("qz")?, w);
        let translation = DVec3::new(fields.number("tx")?, fields.number("ty")?, fields.number("tz")?);
        let camera = fields.number("camera")?;
        let name = fields.name()?;
        let observations = fields.list(24, |fields| {
            let position = [fields.number("x")?, fields.number("y")?];
            // No point is -1, or all bits.
            let point: i64 = fields.number("point")?;
            Ok(Observation { position, point: u64::try_from(point).ok() })
        })?;
        Ok(Self { id, rotation, translation, camera, name, observations })
    }
}

impl Entry for ModelPoint {
    fn read(fields: &mut impl Fields) -> Result<Self, DataError> {
        let id = fields.number("id")?;
        let position = DVec3::new(fields.number("x")?, fields.number("y")?, fields.number("z")?);
        let rgb = [fields.number("red")?, fields.number("green")?, fields.number("blue")?];
        let error_px = fields.number("error")?;
        let track = fields.list(8, |fields| Ok((fields.number("image")?, fields.number("place")?)))?;
        Ok(Self { id, position, rgb, error_px, track })
    }
}

fn encode_cameras(cameras: &[ModelCamera]) -> Vec<u8> {
    let mut bytes = (cameras.len() as u64).to_le_bytes().to_vec();
    for camera in cameras {
        bytes.extend(camera.id.to_le_bytes());
        bytes.extend((camera.model as i32).to_le_bytes());
        bytes.extend(camera.width.to_le_bytes());
        bytes.extend(camera.height.to_le_bytes());
        bytes.extend(camera.parameters.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

fn encode_images(images: &[ModelImage]) -> Vec<u8> {
    let mut bytes = (images.len() as u64).to_le_bytes().to_vec();
    for image in images {
        bytes.extend(image.id.to_le_bytes());
        let DQuat { x, y, z, w } = image.rotation;
        bytes.extend([w, x, y, z].into_iter().chain(image.translation.to_array()).flat_map(f64::to_le_bytes));
        bytes.extend(image.camera.to_le_bytes());
        bytes.extend(image.name.as_bytes());
        bytes.push(0);
        bytes.extend((image.observations.len() as u64).to_le_bytes());
        for observation in &image.observations {
            bytes.extend(observation.position.into_iter().flat_map(f64::to_le_bytes));
            bytes.extend(observation.point.unwrap_or(u64::MAX).to_le_bytes());
        }
    }
    bytes
}

fn encode_points(points: &[ModelPoint]) -> Vec<u8> {
    let mut bytes = (points.len() as u64).to_le_bytes().to_vec();
    for point in points {
        bytes.extend(point.id.to_le_bytes());
        bytes.extend(point.position.to_array().into_iter().flat_map(f64::to_le_bytes));
        bytes.extend(point.rgb);
        bytes.extend(point.error_px.to_le_bytes());
        bytes.extend((point.track.len() as u64).to_le_bytes());
        bytes.extend(
            point.track.iter().flat_map(|(image, place)| [image.to_le_bytes(), place.to_le_bytes()].concat()),
        );
    }
    bytes
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
    fn camera_models_have_the_names_and_numbers_of_colmap() {
        let names = ["SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV"];
        for (number, name) in (0..).zip(names) {
            assert_eq!(CameraModel::from_repr(number), Some(name.parse().unwrap()));
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
    fn intrinsics_lose_only_distortion() {
        let mut camera = model().cameras.remove(0);
        assert_eq!(camera.pinhole(), [70.1, 70.2, 32.0, 24.0]);
        camera.model = CameraModel::SimpleRadial;
        camera.parameters = vec![50.0, 32.0, 24.0, 0.01];
        assert_eq!(camera.pinhole(), [50.0, 50.0, 32.0, 24.0]);
    }
}
