//! The binary encoding: little endian, counts before lists.

use std::path::Path;

use glam::{DQuat, DVec3};
use l4d_data::DataError;
use l4d_data::error::inert;

use super::{CameraModel, ModelCamera, ModelImage, ModelPoint, Observation, REMEDY};

/// What means no point.
const NO_POINT: u64 = u64::MAX;

pub(super) fn cameras(path: &Path, bytes: &[u8]) -> Result<Vec<ModelCamera>, DataError> {
    let mut reader = Reader { path, bytes, offset: 0 };
    reader.list(24, |reader| {
        let id = reader.u32()?;
        let number = reader.u32()? as i32;
        let model = CameraModel::of_number(number).ok_or_else(|| {
            let message = format!("camera model {number} is not understood");
            reader.wrong(message, "undistort the images first (`colmap image_undistorter`)")
        })?;
        let (width, height) = (reader.u64()?, reader.u64()?);
        let parameters = (0..model.parameter_count()).map(|_| reader.f64()).collect::<Result<_, _>>()?;
        Ok(ModelCamera { id, model, width, height, parameters })
    })
}

pub(super) fn images(path: &Path, bytes: &[u8]) -> Result<Vec<ModelImage>, DataError> {
    let mut reader = Reader { path, bytes, offset: 0 };
    reader.list(73, |reader| {
        let id = reader.u32()?;
        let [w, x, y, z] = [reader.f64()?, reader.f64()?, reader.f64()?, reader.f64()?];
        let translation = DVec3::new(reader.f64()?, reader.f64()?, reader.f64()?);
        let camera = reader.u32()?;
        let name = reader.name()?;
        let observations = reader.inner_list(24, |reader| {
            let position = [reader.f64()?, reader.f64()?];
            let point = reader.u64()?;
            Ok(Observation { position, point: (point != NO_POINT).then_some(point) })
        })?;
        Ok(ModelImage { id, rotation: DQuat::from_xyzw(x, y, z, w), translation, camera, name, observations })
    })
}

pub(super) fn points(path: &Path, bytes: &[u8]) -> Result<Vec<ModelPoint>, DataError> {
    let mut reader = Reader { path, bytes, offset: 0 };
    reader.list(51, |reader| {
        let id = reader.u64()?;
        let position = DVec3::new(reader.f64()?, reader.f64()?, reader.f64()?);
        let rgb = reader.take::<3>()?;
        let error_px = reader.f64()?;
        let track = reader.inner_list(8, |reader| Ok((reader.u32()?, reader.u32()?)))?;
        Ok(ModelPoint { id, position, rgb, error_px, track })
    })
}

pub(super) fn encode_cameras(cameras: &[ModelCamera]) -> Vec<u8> {
    let mut bytes = (cameras.len() as u64).to_le_bytes().to_vec();
    for camera in cameras {
        bytes.extend(camera.id.to_le_bytes());
        bytes.extend(camera.model.number().to_le_bytes());
        bytes.extend(camera.width.to_le_bytes());
        bytes.extend(camera.height.to_le_bytes());
        bytes.extend(camera.parameters.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

pub(super) fn encode_images(images: &[ModelImage]) -> Vec<u8> {
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
            bytes.extend(observation.point.unwrap_or(NO_POINT).to_le_bytes());
        }
    }
    bytes
}

pub(super) fn encode_points(points: &[ModelPoint]) -> Vec<u8> {
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

struct Reader<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    offset: usize,
}

impl Reader<'_> {
    /// A list that fills the file; entries have at least so many bytes.
    fn list<T>(
        &mut self,
        least_bytes: usize,
        entry: impl FnMut(&mut Self) -> Result<T, DataError>,
    ) -> Result<Vec<T>, DataError> {
        let entries = self.inner_list(least_bytes, entry)?;
        if self.offset < self.bytes.len() {
            let left = self.bytes.len() - self.offset;
            return Err(self.wrong(format!("{left} bytes are left over"), REMEDY));
        }
        Ok(entries)
    }

    fn inner_list<T>(
        &mut self,
        least_bytes: usize,
        mut entry: impl FnMut(&mut Self) -> Result<T, DataError>,
    ) -> Result<Vec<T>, DataError> {
        let count = self.u64()?;
        let room = ((self.bytes.len() - self.offset) / least_bytes) as u64;
        if count > room {
            let message = format!("promises {count} entries, but has room for {room}");
            return Err(self.wrong(message, REMEDY));
        }
        (0..count).map(|_| entry(self)).collect()
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], DataError> {
        let taken = self.bytes[self.offset..].first_chunk::<N>().copied();
        let taken = taken.ok_or_else(|| self.wrong("ends in the middle".to_owned(), REMEDY))?;
        self.offset += N;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, DataError> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, DataError> {
        self.take().map(u64::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64, DataError> {
        self.take().map(f64::from_le_bytes)
    }

    fn name(&mut self) -> Result<String, DataError> {
        let rest = &self.bytes[self.offset..];
        let length = rest.iter().position(|&byte| byte == 0);
        let length = length.ok_or_else(|| self.wrong("a name has no end".to_owned(), REMEDY))?;
        let name = std::str::from_utf8(&rest[..length])
            .map_err(|error| self.wrong(inert(&format!("a name is no UTF-8: {error}")), REMEDY))?;
        self.offset += length + 1;
        Ok(name.to_owned())
    }

    fn wrong(&self, message: String, remedy: &str) -> DataError {
        DataError::invalid(self.path, format!("byte {}", self.offset), message, remedy)
    }
}
