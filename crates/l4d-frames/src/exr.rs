//! The file form of a frame: one part, scan lines, ZIP, channels `B G R` half, `Z` float, `id` uint.
//!
//! Nothing else is read: a file that any other layout would describe better was not written by l4d, and
//! guessing would hide that. Who needs no ids may do without that channel alone. Sizes are checked against the expected ones before anything is allocated.

mod depth;

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::reader::ChunksReader as _;
use exr::compression::Compression;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::{LineOrder, WritableImage as _};
use glam::UVec2;
use half::f16;
use l4d_data::DataError;
use l4d_data::store::{read_bounded, write_atomic};

use crate::frame::{Frame, Surfaces};

pub use depth::{decode_depth, encode_depth};

/// Name and sample type of the channels, in file order (the format sorts them by name).
const CHANNELS: [(&str, SampleType); 5] = [
    ("B", SampleType::F16),
    ("G", SampleType::F16),
    ("R", SampleType::F16),
    ("Z", SampleType::F32),
    ("id", SampleType::U32),
];
const BYTES_PER_PIXEL: usize = 14;
/// Those of the last channel.
const ID_BYTES_PER_PIXEL: usize = 4;
/// Room for the header, the offset table and what ZIP adds to data that it cannot shrink.
const FILE_OVERHEAD_BYTES: usize = 1 << 20;

/// What can be wrong with a frame file, by stage; each carries path, place and remedy.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The file is missing or the operating system refused.
    #[error(transparent)]
    Unreadable(DataError),
    /// The bytes are no EXR, or end or break in the middle.
    #[error(transparent)]
    Torn(DataError),
    /// A valid EXR, but not of the layout of a frame.
    #[error(transparent)]
    Layout(DataError),
    /// The right layout, but not the expected size.
    #[error(transparent)]
    Size(DataError),
    /// A depth, id or colour that cannot be.
    #[error(transparent)]
    Values(DataError),
}

impl FrameError {
    /// Stable code of the finding (`docs/findings.md`).
    pub fn code(&self) -> &'static str {
        match self {
            Self::Unreadable(_) | Self::Torn(_) => "L4D104",
            Self::Layout(_) => "L4D105",
            Self::Size(_) => "L4D106",
            Self::Values(_) => "L4D107",
        }
    }

    /// The error about the file.
    pub fn data_error(&self) -> &DataError {
        let (Self::Unreadable(error)
        | Self::Torn(error)
        | Self::Layout(error)
        | Self::Size(error)
        | Self::Values(error)) = self;
        error
    }
}

impl From<FrameError> for DataError {
    fn from(error: FrameError) -> Self {
        let (FrameError::Unreadable(error)
        | FrameError::Torn(error)
        | FrameError::Layout(error)
        | FrameError::Size(error)
        | FrameError::Values(error)) = error;
        error
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
    read_bounded(path, limit as u64).map_err(FrameError::Unreadable)
}

/// [`read_frame`] on bytes that were read from `path`.
///
/// # Errors
/// Bytes that are no frame of that size.
pub fn decode_frame(path: &Path, bytes: &[u8], size: UVec2) -> Result<Frame, FrameError> {
    decode_with_colour(path, bytes, size, Ids::Needed)
}

/// [`decode_frame`] for a reader that needs no ids: where the file has none, all are 0.
///
/// # Errors
/// Bytes that are no frame of that size.
pub fn decode_seen(path: &Path, bytes: &[u8], size: UVec2) -> Result<Frame, FrameError> {
    decode_with_colour(path, bytes, size, Ids::Welcome)
}

fn decode_with_colour(path: &Path, bytes: &[u8], size: UVec2, ids: Ids) -> Result<Frame, FrameError> {
    let mut rgb = vec![[f16::ZERO; 3]; size.x as usize * size.y as usize];
    let surfaces = decode(path, bytes, size, ids, |first_pixel, blue, green, red| {
        let row = &mut rgb[first_pixel..first_pixel + red.len()];
        for (column, pixel) in row.iter_mut().enumerate() {
            *pixel = [red[column], green[column], blue[column]].map(f16::from_bits);
        }
    })?;
    Ok(Frame { surfaces, rgb })
}

/// [`read_surfaces`] on bytes that were read from `path`.
///
/// # Errors
/// Bytes that are no frame of that size.
pub fn decode_surfaces(path: &Path, bytes: &[u8], size: UVec2) -> Result<Surfaces, FrameError> {
    decode(path, bytes, size, Ids::Needed, |_, _, _, _| {})
}

/// Writes a frame atomically in the layout that [`read_frame`] reads.
///
/// # Errors
/// What the disk refuses.
pub fn write_frame(path: &Path, frame: &Frame) -> Result<(), DataError> {
    write_atomic(path, &encode_frame(path, frame)?)
}

fn encode_frame(path: &Path, frame: &Frame) -> Result<Vec<u8>, DataError> {
    let colour = |index: usize| FlatSamples::F16(frame.rgb.iter().map(|pixel| pixel[index]).collect());
    let channels = vec![
        AnyChannel::new("B", colour(2)),
        AnyChannel::new("G", colour(1)),
        AnyChannel::new("R", colour(0)),
        AnyChannel::new("Z", FlatSamples::F32(frame.surfaces.depth_m.clone())),
        AnyChannel::new("id", FlatSamples::U32(frame.surfaces.id.clone())),
    ];
    let size = UVec2::new(frame.surfaces.width, frame.surfaces.height);
    encode_channels(channels, size, Compression::ZIP16).map_err(|error| {
        DataError::invalid(path, "frame", error.to_string(), "give each channel one value a pixel")
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

/// Whether a file must say which instances it shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ids {
    Needed,
    Welcome,
}

/// Receives a row of colour: index of its first pixel, then blue, green, red as half-float bits.
trait ColourRow: FnMut(usize, &[u16], &[u16], &[u16]) {}
impl<F: FnMut(usize, &[u16], &[u16], &[u16])> ColourRow for F {}

fn decode(
    path: &Path,
    bytes: &[u8],
    size: UVec2,
    ids: Ids,
    mut keep_colour: impl ColourRow,
) -> Result<Surfaces, FrameError> {
    // The decoder indexes into bytes that a hostile file controls. It is the one place of the project where a
    // panic is turned into an error; the closure's captures are dropped on failure, so none is seen half-written.
    let attempt = catch_unwind(AssertUnwindSafe(|| decode_checked(path, bytes, size, ids, &mut keep_colour)));
    attempt.unwrap_or_else(|_| Err(torn(path, "the pixel data is corrupt")))
}

fn decode_checked(
    path: &Path,
    bytes: &[u8],
    size: UVec2,
    ids: Ids,
    keep_colour: &mut impl ColourRow,
) -> Result<Surfaces, FrameError> {
    let reader = exr::block::read(Cursor::new(bytes), true).map_err(|error| torn(path, error))?;
    let has_ids = check_headers(path, reader.headers(), size, ids)?;
    let bytes_per_pixel = if has_ids { BYTES_PER_PIXEL } else { BYTES_PER_PIXEL - ID_BYTES_PER_PIXEL };
    let mut chunks = reader.all_chunks(true).map_err(|error| torn(path, error))?;
    let meta = chunks.meta_data().clone();
    let width = size.x as usize;
    let mut surfaces = Surfaces::empty(size.x, size.y);
    let mut seen_rows = vec![false; size.y as usize];
    let mut colour = ColourCheck::default();
    let mut lines = LineBuffers::default();
    for chunk in &mut chunks {
        let chunk = chunk.map_err(|error| torn(path, error))?;
        let block = exr::block::UncompressedBlock::decompress_chunk(chunk, &meta, true)
            .map_err(|error| torn(path, error))?;
        let first_row = block.index.pixel_position.y();
        for (offset, line) in block.data.chunks_exact(width * bytes_per_pixel).enumerate() {
            let row = first_row + offset;
            if std::mem::replace(&mut seen_rows[row], true) {
                return Err(torn(path, format!("row {row} is stored twice")));
            }
            lines.split(line, width);
            let start = row * width;
            surfaces.depth_m[start..start + width].copy_from_slice(&lines.depth_m);
            if has_ids {
                surfaces.id[start..start + width].copy_from_slice(&lines.id);
            }
            colour.look_at(row, [&lines.red, &lines.green, &lines.blue]);
            keep_colour(start, &lines.blue, &lines.green, &lines.red);
        }
    }
    if let Some(row) = seen_rows.iter().position(|seen| !seen) {
        return Err(torn(path, format!("row {row} is missing")));
    }
    check_values(path, &surfaces, &colour)?;
    Ok(surfaces)
}

/// Whether the file has ids.
fn check_headers(path: &Path, headers: &[Header], size: UVec2, ids: Ids) -> Result<bool, FrameError> {
    let layout = |place: &str, message: String| {
        let remedy = "write one part of scan lines with ZIP and the channels B, G, R half, Z float, id uint";
        Err(FrameError::Layout(DataError::invalid(path, place, message, remedy)))
    };
    let [header] = headers else {
        return layout("header", format!("has {} parts, but a frame has one", headers.len()));
    };
    if header.deep || header.blocks.has_tiles() {
        return layout("header", "stores tiles or deep samples, but a frame stores scan lines".to_owned());
    }
    if header.compression != Compression::ZIP16 {
        let lossy = if header.compression.may_loose_data() { ", which loses data" } else { "" };
        return layout(
            "attribute `compression`",
            format!("is {}{lossy}, but must be ZIP", header.compression),
        );
    }
    let found: Vec<String> = header
        .channels
        .list
        .iter()
        .map(|channel| format!("{} {}", channel.name, type_name(channel.sample_type)))
        .collect();
    let expected = CHANNELS.map(|(name, sample_type)| format!("{name} {}", type_name(sample_type)));
    let has_ids = found == expected;
    let lacks_ids_alone = found == expected[..expected.len() - 1];
    if !has_ids && (ids == Ids::Needed || !lacks_ids_alone) {
        return layout(
            "attribute `channels`",
            format!("are {}, but must be {}", found.join(", "), expected.join(", ")),
        );
    }
    if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return layout(
            "attribute `channels`",
            "are subsampled, but each pixel has its own samples".to_owned(),
        );
    }
    if header.own_attributes.capture_date.is_some() {
        return layout("attribute `capDate`", "is set, but frames carry no date".to_owned());
    }
    let found_size = header.layer_size;
    if found_size != Vec2(size.x as usize, size.y as usize) {
        let message =
            format!("is {}x{} pixels, but {}x{} are expected", found_size.0, found_size.1, size.x, size.y);
        let remedy = "choose the profile that the scene was built with, or build the scene again";
        return Err(FrameError::Size(DataError::invalid(path, "attribute `dataWindow`", message, remedy)));
    }
    let display = header.shared_attributes.display_window;
    if display.position != header.own_attributes.layer_position || display.size != found_size {
        return layout(
            "attribute `displayWindow`",
            "differs from dataWindow, but a frame shows all it has".to_owned(),
        );
    }
    Ok(has_ids)
}

fn check_values(path: &Path, surfaces: &Surfaces, colour: &ColourCheck) -> Result<(), FrameError> {
    let fail = |place: String, message: String| {
        let remedy = "render the frame again with `l4d build-scenes`";
        Err(FrameError::Values(DataError::invalid(path, place, message, remedy)))
    };
    if let Some(problem) = surfaces.value_problem() {
        let more = match problem.count {
            1 => String::new(),
            count => format!("; {count} pixels in all"),
        };
        let place = format!("channel `{}`, column {}, row {}", problem.channel, problem.column, problem.row);
        return fail(place, format!("{}{more}", problem.message));
    }
    match colour.first_bad_row {
        None => Ok(()),
        Some(row) => {
            fail(format!("channels `R G B`, row {row}"), "hold a colour that is not finite".to_owned())
        }
    }
}

fn torn(path: &Path, message: impl ToString) -> FrameError {
    let message = message.to_string();
    FrameError::Torn(DataError::invalid(
        path,
        "EXR",
        message,
        "delete the file and run `l4d build-scenes` again",
    ))
}

fn type_name(sample_type: SampleType) -> &'static str {
    match sample_type {
        SampleType::F16 => "half",
        SampleType::F32 => "float",
        SampleType::U32 => "uint",
    }
}

/// Remembers the first row with an infinite or undefined colour.
#[derive(Default)]
struct ColourCheck {
    first_bad_row: Option<usize>,
}

impl ColourCheck {
    fn look_at(&mut self, row: usize, channels: [&[u16]; 3]) {
        const EXPONENT: u16 = 0x7c00;
        let bad = channels.iter().any(|line| line.iter().any(|bits| bits & EXPONENT == EXPONENT));
        if bad && self.first_bad_row.is_none_or(|first| row < first) {
            self.first_bad_row = Some(row);
        }
    }
}

/// One scan line, split into its channels. The decoder gives bytes in native order.
#[derive(Default)]
struct LineBuffers {
    blue: Vec<u16>,
    green: Vec<u16>,
    red: Vec<u16>,
    depth_m: Vec<f32>,
    id: Vec<u32>,
}

impl LineBuffers {
    fn split(&mut self, line: &[u8], width: usize) {
        let (blue, line) = line.split_at(2 * width);
        let (green, line) = line.split_at(2 * width);
        let (red, line) = line.split_at(2 * width);
        let (depth_m, id) = line.split_at(4 * width);
        for (channel, bytes) in [(&mut self.blue, blue), (&mut self.green, green), (&mut self.red, red)] {
            refill(channel, bytes, u16::from_ne_bytes);
        }
        refill(&mut self.depth_m, depth_m, f32::from_ne_bytes);
        refill(&mut self.id, id, u32::from_ne_bytes);
    }
}

fn refill<T, const N: usize>(values: &mut Vec<T>, bytes: &[u8], from_bytes: impl Fn([u8; N]) -> T) {
    let (groups, _) = bytes.as_chunks::<N>();
    values.clear();
    values.extend(groups.iter().map(|group| from_bytes(*group)));
}

#[cfg(test)]
mod tests;
