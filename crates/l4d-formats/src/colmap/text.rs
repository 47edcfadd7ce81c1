//! The text encoding: a line an entry, two for images, `#` begins a comment.

use std::path::Path;
use std::str::FromStr;

use glam::{DQuat, DVec3};
use l4d_data::DataError;
use l4d_data::error::inert;

use super::{CameraModel, ModelCamera, ModelImage, ModelPoint, Observation, REMEDY};

pub(super) fn cameras(path: &Path, bytes: &[u8]) -> Result<Vec<ModelCamera>, DataError> {
    let lines = entries(path, bytes)?;
    lines
        .filter(|line| !line.is_blank())
        .map(|mut line| {
            let id = line.number("id")?;
            let name = line.word("model")?;
            let model = CameraModel::of_name(name).ok_or_else(|| {
                let message = format!("camera model `{}` is not understood", inert(name));
                line.wrong("model", message, "undistort the images first (`colmap image_undistorter`)")
            })?;
            let (width, height) = (line.number("width")?, line.number("height")?);
            let parameters =
                (0..model.parameter_count()).map(|_| line.number("parameters")).collect::<Result<_, _>>()?;
            line.end()?;
            Ok(ModelCamera { id, model, width, height, parameters })
        })
        .collect()
}

pub(super) fn images(path: &Path, bytes: &[u8]) -> Result<Vec<ModelImage>, DataError> {
    let mut lines = entries(path, bytes)?;
    let mut images = Vec::new();
    while let Some(mut line) = lines.next() {
        if line.is_blank() {
            continue;
        }
        let id = line.number("id")?;
        let [w, x, y, z] = [line.number("qw")?, line.number("qx")?, line.number("qy")?, line.number("qz")?];
        let translation = DVec3::new(line.number("tx")?, line.number("ty")?, line.number("tz")?);
        let camera = line.number("camera")?;
        let name = line.rest("name")?;
        // The second line may be empty, and at the end of the file it may be missing.
        let observations = lines.next().map(observations).transpose()?.unwrap_or_default();
        images.push(ModelImage {
            id,
            rotation: DQuat::from_xyzw(x, y, z, w),
            translation,
            camera,
            name,
            observations,
        });
    }
    Ok(images)
}

fn observations(mut line: Line<'_>) -> Result<Vec<Observation>, DataError> {
    let mut observations = Vec::new();
    while !line.is_blank() {
        let position = [line.number("x")?, line.number("y")?];
        let point: i64 = line.number("point")?;
        observations.push(Observation { position, point: u64::try_from(point).ok() });
    }
    Ok(observations)
}

pub(super) fn points(path: &Path, bytes: &[u8]) -> Result<Vec<ModelPoint>, DataError> {
    let lines = entries(path, bytes)?;
    lines
        .filter(|line| !line.is_blank())
        .map(|mut line| {
            let id = line.number("id")?;
            let position = DVec3::new(line.number("x")?, line.number("y")?, line.number("z")?);
            let rgb = [line.number("red")?, line.number("green")?, line.number("blue")?];
            let error_px = line.number("error")?;
            let mut track = Vec::new();
            while !line.is_blank() {
                track.push((line.number("image")?, line.number("place")?));
            }
            Ok(ModelPoint { id, position, rgb, error_px, track })
        })
        .collect()
}

/// Lines that are no comments; blank ones stay, since the second line of an image may be one.
fn entries<'a>(path: &'a Path, bytes: &'a [u8]) -> Result<impl Iterator<Item = Line<'a>>, DataError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        DataError::invalid(path, format!("byte {}", error.valid_up_to()), "is no UTF-8", REMEDY)
    })?;
    let lines = text.lines().enumerate().map(|(index, text)| Line { path, number: index + 1, rest: text });
    Ok(lines.filter(|line| !line.rest.trim_start().starts_with('#')))
}

struct Line<'a> {
    path: &'a Path,
    number: usize,
    rest: &'a str,
}

impl<'a> Line<'a> {
    fn is_blank(&self) -> bool {
        self.rest.trim().is_empty()
    }

    fn word(&mut self, field: &str) -> Result<&'a str, DataError> {
        let rest = self.rest.trim_start();
        let (word, rest) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        if word.is_empty() {
            return Err(self.wrong(field, "is missing".to_owned(), REMEDY));
        }
        self.rest = rest;
        Ok(word)
    }

    fn number<T: FromStr>(&mut self, field: &str) -> Result<T, DataError> {
        let word = self.word(field)?;
        word.parse()
            .ok()
            .ok_or_else(|| self.wrong(field, format!("`{}` is no such number", inert(word)), REMEDY))
    }

    /// All that is left: names may hold blanks.
    fn rest(&mut self, field: &str) -> Result<String, DataError> {
        let rest = self.rest.trim();
        if rest.is_empty() {
            return Err(self.wrong(field, "is missing".to_owned(), REMEDY));
        }
        Ok(rest.to_owned())
    }

    fn end(&self) -> Result<(), DataError> {
        if self.is_blank() {
            return Ok(());
        }
        Err(self.wrong("end", format!("`{}` is left over", inert(self.rest.trim())), REMEDY))
    }

    fn wrong(&self, field: &str, message: String, remedy: &str) -> DataError {
        DataError::invalid(self.path, format!("line {}, field `{field}`", self.number), message, remedy)
    }
}
