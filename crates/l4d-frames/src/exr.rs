//! The file forms of a frame and of a drawn depth: one part, scan lines, ZIP, the channels of a [`Layout`].
//!
//! Nothing else is read: a file that any other layout would describe better was not written by l4d, and
//! guessing would hide that. Who needs no ids may do without that channel alone, who needs colour without both
//! others. Sizes are checked against the expected ones before anything is allocated.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::compression::Compression;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::{LineOrder, ReadChannels as _, ReadLayers as _, WritableImage as _};
use glam::UVec2;
use half::f16;
use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::{DataError, StageError};

use crate::drawn::DepthMap;
use crate::frame::{Frame, Surfaces};

/// What a file holds.
struct Layout {
    /// Name and sample type of the channels, in file order (the format sorts them by name).
    channels: &'static [(&'static str, SampleType)],
    /// The verb that writes such files.
    verb: &'static str,
}

const FRAME: Layout = Layout {
    channels: &[
        ("B", SampleType::F16),
        ("G", SampleType::F16),
        ("R", SampleType::F16),
        ("Z", SampleType::F32),
        ("id", SampleType::U32),
    ],
    verb: "build-scenes",
};
const DEPTH: Layout = Layout {
    channels: &[
        ("A", SampleType::F16),
        ("Z", SampleType::F32),
        ("far.Z", SampleType::F16),
        ("near.Z", SampleType::F16),
    ],
    verb: "render-splats",
};
/// The first channels of a frame.
const COLOUR_CHANNELS: usize = 3;
/// Those of a frame.
const BYTES_PER_PIXEL: usize = 14;
/// Room for the header, the offset table and what ZIP adds to data that it cannot shrink.
const FILE_OVERHEAD_BYTES: usize = 1 << 20;

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[error("{error}")]
pub struct FrameError {
    code: &'static str,
    error: DataError,
}

impl FrameError {
    /// Missing, or no EXR that can be read to its end.
    const TORN: &str = "L4D104";
    /// A valid EXR of another layout.
    const LAYOUT: &str = "L4D105";
    /// Not the expected size.
    const SIZE: &str = "L4D106";
    /// A depth, id or colour that cannot be.
    pub(crate) const VALUES: &str = "L4D107";

    pub(crate) fn new(code: &'static str, error: DataError) -> Self {
        Self { code, error }
    }

    fn torn(path: &Path, layout: &Layout, message: impl ToString) -> Self {
        let hint = format!("delete the file and run `l4d {}` again", layout.verb);
        Self::new(Self::TORN, DataError::invalid(path, "EXR", message.to_string(), hint))
    }

    /// Stable code of the finding (`docs/findings.md`).
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// The error about the file.
    pub fn data_error(&self) -> &DataError {
        &self.error
    }
}

impl From<FrameError> for DataError {
    fn from(error: FrameError) -> Self {
        error.error
    }
}

impl From<FrameError> for StageError {
    fn from(error: FrameError) -> Self {
        error.error.into()
    }
}

/// Reads a frame of `size` (columns, rows) with colour.
///
/// # Errors
/// A file that is missing, torn, or no frame of that size.
pub fn read_frame(path: &Path, size: UVec2) -> Result<Frame, FrameError> {
    decode_frame(path, &read_bytes(path, size)?, size)
}

/// Reads depth and ids of a frame; colour is checked but not kept.
///
/// # Errors
/// A file that is missing, torn, or no frame of that size.
pub fn read_surfaces(path: &Path, size: UVec2) -> Result<Surfaces, FrameError> {
    decode_surfaces(path, &read_bytes(path, size)?, size)
}

/// Reads the bytes of a frame file, refusing files larger than any frame of `size`.
///
/// # Errors
/// A file that cannot be read, or is larger than any frame of that size.
pub fn read_bytes(path: &Path, size: UVec2) -> Result<Vec<u8>, FrameError> {
    let limit = size.x as usize * size.y as usize * BYTES_PER_PIXEL + FILE_OVERHEAD_BYTES;
    read_bounded(path, limit as u64).map_err(|error| FrameError::new(FrameError::TORN, error))
}

/// [`read_frame`] on bytes that were read from `path`.
///
/// # Errors
/// Bytes that are no frame of that size.
pub fn decode_frame(path: &Path, bytes: &[u8], size: UVec2) -> Result<Frame, FrameError> {
    let (surfaces, colour) = decode(path, bytes, size, FRAME.channels.len())?;
    Ok(Frame { surfaces, rgb: pixels(&colour) })
}

/// The frame in bytes that were read from `path`, for a reader that needs no ids: where the file has none, all are 0.
///
/// # Errors
/// Bytes that are no frame of that size.
pub fn decode_seen(path: &Path, bytes: &[u8], size: UVec2) -> Result<Frame, FrameError> {
    let (surfaces, colour) = decode(path, bytes, size, FRAME.channels.len() - 1)?;
    Ok(Frame { surfaces, rgb: pixels(&colour) })
}

/// The colour in bytes that were read from `path`, linear and row-major. Depth and ids may be missing; where they are
/// there, they are dropped unchecked.
///
/// # Errors
/// Bytes that are no frame of that size.
pub fn decode_colour(path: &Path, bytes: &[u8], size: UVec2) -> Result<Vec<[f16; 3]>, FrameError> {
    let mut samples = read_samples(path, bytes, size, &FRAME, COLOUR_CHANNELS)?;
    samples.truncate(COLOUR_CHANNELS);
    let Ok([FlatSamples::F16(blue), FlatSamples::F16(green), FlatSamples::F16(red)]) =
        <[FlatSamples; COLOUR_CHANNELS]>::try_from(samples)
    else {
        return Err(FrameError::torn(path, &FRAME, "the channels are of other types"));
    };
    let colour = [blue, green, red];
    check_colour(path, size, &colour)?;
    Ok(pixels(&colour))
}

/// [`read_surfaces`] on bytes that were read from `path`.
///
/// # Errors
/// Bytes that are no frame of that size.
pub fn decode_surfaces(path: &Path, bytes: &[u8], size: UVec2) -> Result<Surfaces, FrameError> {
    decode(path, bytes, size, FRAME.channels.len()).map(|(surfaces, _)| surfaces)
}

/// Writes a frame atomically in the layout that [`read_frame`] reads.
///
/// # Errors
/// What the disk refuses.
pub fn write_frame(path: &Path, frame: &Frame) -> Result<(), DataError> {
    write_atomic(path, &encode_frame(path, frame)?)
}

/// A frame as the bytes of an EXR file; `path` is where they will be.
///
/// # Errors
/// A channel that has not one value per pixel.
pub fn encode_frame(path: &Path, frame: &Frame) -> Result<Vec<u8>, DataError> {
    let colour = |index: usize| FlatSamples::F16(frame.rgb.iter().map(|pixel| pixel[index]).collect());
    let Surfaces { width, height, depth_m, id } = &frame.surfaces;
    let samples =
        [colour(2), colour(1), colour(0), FlatSamples::F32(depth_m.clone()), FlatSamples::U32(id.clone())];
    encode(path, &FRAME, UVec2::new(*width, *height), samples)
}

/// A drawn depth as the bytes of an EXR file; `path` is where they will be.
///
/// # Errors
/// A channel that has not one value per pixel.
pub fn encode_depth(path: &Path, depth: &DepthMap) -> Result<Vec<u8>, DataError> {
    let samples = [
        FlatSamples::F16(depth.alpha.clone()),
        FlatSamples::F32(depth.depth_m.clone()),
        FlatSamples::F16(depth.far_m.clone()),
        FlatSamples::F16(depth.near_m.clone()),
    ];
    encode(path, &DEPTH, UVec2::new(depth.width, depth.height), samples)
}

/// The drawn depth in bytes that were read from `path`, of `size` (columns, rows) pixels.
///
/// # Errors
/// Bytes that are no such depth of that size.
pub fn decode_depth(path: &Path, bytes: &[u8], size: UVec2) -> Result<DepthMap, DataError> {
    let samples = read_samples(path, bytes, size, &DEPTH, DEPTH.channels.len())?;
    let Ok(
        [
            FlatSamples::F16(alpha),
            FlatSamples::F32(depth_m),
            FlatSamples::F16(far_m),
            FlatSamples::F16(near_m),
        ],
    ) = <[FlatSamples; 4]>::try_from(samples)
    else {
        return Err(FrameError::torn(path, &DEPTH, "the channels are of other types").into());
    };
    Ok(DepthMap { width: size.x, height: size.y, depth_m, alpha, near_m, far_m })
}

/// Depth and ids, and blue, green and red.
fn decode(
    path: &Path,
    bytes: &[u8],
    size: UVec2,
    least_channels: usize,
) -> Result<(Surfaces, [Vec<f16>; 3]), FrameError> {
    let mut samples = read_samples(path, bytes, size, &FRAME, least_channels)?;
    samples.resize_with(FRAME.channels.len(), || FlatSamples::U32(vec![0; size.element_product() as usize]));
    let Ok(
        [
            FlatSamples::F16(blue),
            FlatSamples::F16(green),
            FlatSamples::F16(red),
            FlatSamples::F32(depth_m),
            FlatSamples::U32(id),
        ],
    ) = <[FlatSamples; 5]>::try_from(samples)
    else {
        return Err(FrameError::torn(path, &FRAME, "the channels are of other types"));
    };
    let (surfaces, colour) = (Surfaces { width: size.x, height: size.y, depth_m, id }, [blue, green, red]);
    check_values(path, &surfaces, &colour)?;
    Ok((surfaces, colour))
}

fn pixels([blue, green, red]: &[Vec<f16>; 3]) -> Vec<[f16; 3]> {
    red.iter().zip(green).zip(blue).map(|((&red, &green), &blue)| [red, green, blue]).collect()
}

fn encode(
    path: &Path,
    layout: &Layout,
    size: UVec2,
    samples: impl IntoIterator<Item = FlatSamples>,
) -> Result<Vec<u8>, DataError> {
    let channels =
        layout.channels.iter().zip(samples).map(|((name, _), samples)| AnyChannel::new(*name, samples));
    encode_channels(channels.collect(), size, Compression::ZIP16).map_err(|error| {
        DataError::invalid(path, "channels", error.to_string(), "give each channel one value a pixel")
    })
}

fn encode_channels(
    channels: Vec<AnyChannel<FlatSamples>>,
    size: UVec2,
    compression: Compression,
) -> Result<Vec<u8>, exr::error::Error> {
    let encoding =
        Encoding { compression, blocks: exr::image::Blocks::ScanLines, line_order: LineOrder::Increasing };
    let size = Vec2(size.x as usize, size.y as usize);
    let image = Image::from_encoded_channels(size, encoding, AnyChannels::sort(channels.into()));
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

/// The channels of a layout in its order, or its first ones where the file has no more but `least_channels`.
fn read_samples(
    path: &Path,
    bytes: &[u8],
    size: UVec2,
    layout: &Layout,
    least_channels: usize,
) -> Result<Vec<FlatSamples>, FrameError> {
    let torn = |error: exr::error::Error| FrameError::torn(path, layout, error);
    let read = || {
        let chunks = exr::block::read(Cursor::new(bytes), true).map_err(torn)?;
        check_headers(path, chunks.headers(), size, layout, least_channels)?;
        let flat = exr::prelude::read().no_deep_data().largest_resolution_level();
        let reader = flat.all_channels().first_valid_layer().all_attributes().pedantic().non_parallel();
        let channels = reader.from_chunks(chunks).map_err(torn)?.layer_data.channel_data.list;
        Ok(channels.into_iter().map(|channel| channel.sample_data).collect())
    };
    // The decoder indexes into bytes that a hostile file controls. It is the one place of the project where a
    // panic is turned into an error.
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(FrameError::torn(path, layout, "the pixel data is corrupt")))
}

fn check_headers(
    path: &Path,
    headers: &[Header],
    size: UVec2,
    layout: &Layout,
    least_channels: usize,
) -> Result<(), FrameError> {
    let expected: Vec<String> =
        layout.channels.iter().map(|(name, kind)| format!("{name} {}", type_name(*kind))).collect();
    let refuse = |place: &str, message: String| {
        let hint = format!("write one part of scan lines with ZIP and the channels {}", expected.join(", "));
        Err(FrameError::new(FrameError::LAYOUT, DataError::invalid(path, place, message, hint)))
    };
    let [header] = headers else {
        return refuse("header", format!("has {} parts, but must have one", headers.len()));
    };
    if header.deep || header.blocks.has_tiles() {
        return refuse("header", "stores tiles or deep samples, but must store scan lines".to_owned());
    }
    if header.compression != Compression::ZIP16 {
        let lossy = if header.compression.may_loose_data() { ", which loses data" } else { "" };
        let message = format!("is {}{lossy}, but must be ZIP", header.compression);
        return refuse("attribute `compression`", message);
    }
    let list = &header.channels.list;
    let found: Vec<String> =
        list.iter().map(|channel| format!("{} {}", channel.name, type_name(channel.sample_type))).collect();
    if found.len() < least_channels || !expected.starts_with(&found) {
        let message = format!("are {}, but must be {}", found.join(", "), expected.join(", "));
        return refuse("attribute `channels`", message);
    }
    if list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        let message = "are subsampled, but each pixel has its own samples".to_owned();
        return refuse("attribute `channels`", message);
    }
    if header.own_attributes.capture_date.is_some() {
        return refuse("attribute `capDate`", "is set, but these files carry no date".to_owned());
    }
    let found_size = header.layer_size;
    if found_size != Vec2(size.x as usize, size.y as usize) {
        let message =
            format!("is {}x{} pixels, but {}x{} are expected", found_size.0, found_size.1, size.x, size.y);
        let hint = "choose the profile that the scene was built with, or build the scene again";
        let error = DataError::invalid(path, "attribute `dataWindow`", message, hint);
        return Err(FrameError::new(FrameError::SIZE, error));
    }
    let display = header.shared_attributes.display_window;
    if display.position != header.own_attributes.layer_position || display.size != found_size {
        let message = "differs from dataWindow, but a picture shows all it has".to_owned();
        return refuse("attribute `displayWindow`", message);
    }
    Ok(())
}

fn check_values(path: &Path, surfaces: &Surfaces, colour: &[Vec<f16>; 3]) -> Result<(), FrameError> {
    match surfaces.value_problem() {
        Some((place, message)) => Err(wrong_value(path, place, message)),
        None => check_colour(path, UVec2::new(surfaces.width, surfaces.height), colour),
    }
}

fn check_colour(path: &Path, size: UVec2, colour: &[Vec<f16>; 3]) -> Result<(), FrameError> {
    let bad = colour.iter().filter_map(|channel| channel.iter().position(|light| !light.is_finite()));
    match bad.min() {
        None => Ok(()),
        Some(pixel) => {
            let place = format!("channels `R G B`, row {}", pixel / size.x as usize);
            Err(wrong_value(path, place, "hold a colour that is not finite".to_owned()))
        }
    }
}

fn wrong_value(path: &Path, place: String, message: String) -> FrameError {
    let hint = "render the frame again with `l4d build-scenes`";
    FrameError::new(FrameError::VALUES, DataError::invalid(path, place, message, hint))
}

fn type_name(sample_type: SampleType) -> &'static str {
    match sample_type {
        SampleType::F16 => "half",
        SampleType::F32 => "float",
        SampleType::U32 => "uint",
    }
}

#[cfg(test)]
mod tests;
