//! The file form of a drawn depth: one part, scan lines, ZIP, channels `A` half, `Z` float, `far.Z` and `near.Z` half.
//!
//! As strict as for frames: nothing else is read.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::reader::ChunksReader as _;
use exr::compression::Compression;
use exr::image::{AnyChannel, FlatSamples};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use glam::UVec2;
use half::f16;
use l4d_data::DataError;

use super::{encode_channels, type_name};
use crate::drawn::DepthMap;

/// Name and sample type of the channels, in file order.
const CHANNELS: [(&str, SampleType); 4] =
    [("A", SampleType::F16), ("Z", SampleType::F32), ("far.Z", SampleType::F16), ("near.Z", SampleType::F16)];
const BYTES_PER_PIXEL: usize = 10;
const REMEDY: &str = "delete the file and run `l4d render-splats` again";

/// A drawn depth as the bytes of an EXR file; `path` is where they will be.
///
/// # Errors
/// A channel that has not one value per pixel.
pub fn encode_depth(path: &Path, depth: &DepthMap) -> Result<Vec<u8>, DataError> {
    let channels = vec![
        AnyChannel::new("A", FlatSamples::F16(depth.alpha.clone())),
        AnyChannel::new("Z", FlatSamples::F32(depth.depth_m.clone())),
        AnyChannel::new("far.Z", FlatSamples::F16(depth.far_m.clone())),
        AnyChannel::new("near.Z", FlatSamples::F16(depth.near_m.clone())),
    ];
    encode_channels(channels, UVec2::new(depth.width, depth.height), Compression::ZIP16).map_err(|error| {
        DataError::invalid(path, "depth", error.to_string(), "give each channel one value a pixel")
    })
}

/// The drawn depth in bytes that were read from `path`, of `size` (columns, rows) pixels.
///
/// # Errors
/// Bytes that are no such depth of that size.
pub fn decode_depth(path: &Path, bytes: &[u8], size: UVec2) -> Result<DepthMap, DataError> {
    // As for frames: the decoder indexes into bytes that a hostile file controls.
    catch_unwind(AssertUnwindSafe(|| decode_checked(bytes, size)))
        .unwrap_or_else(|_| Err("the pixel data is corrupt".to_owned()))
        .map_err(|message| DataError::invalid(path, "EXR", message, REMEDY))
}

fn decode_checked(bytes: &[u8], size: UVec2) -> Result<DepthMap, String> {
    let reader = exr::block::read(Cursor::new(bytes), true).map_err(|error| error.to_string())?;
    check_header(reader.headers(), size)?;
    let mut chunks = reader.all_chunks(true).map_err(|error| error.to_string())?;
    let meta = chunks.meta_data().clone();
    let width = size.x as usize;
    let mut depth = DepthMap::empty(size.x, size.y);
    let mut rows_left = vec![true; size.y as usize];
    for chunk in &mut chunks {
        let chunk = chunk.map_err(|error| error.to_string())?;
        let block =
            UncompressedBlock::decompress_chunk(chunk, &meta, true).map_err(|error| error.to_string())?;
        for (offset, line) in block.data.chunks_exact(width * BYTES_PER_PIXEL).enumerate() {
            let row = block.index.pixel_position.y() + offset;
            if !std::mem::take(&mut rows_left[row]) {
                return Err(format!("row {row} is stored twice"));
            }
            let pixels = row * width..(row + 1) * width;
            let (alpha, line) = line.split_at(2 * width);
            let (depth_m, line) = line.split_at(4 * width);
            let (far_m, near_m) = line.split_at(2 * width);
            fill(&mut depth.alpha[pixels.clone()], alpha, f16::from_ne_bytes);
            fill(&mut depth.depth_m[pixels.clone()], depth_m, f32::from_ne_bytes);
            fill(&mut depth.far_m[pixels.clone()], far_m, f16::from_ne_bytes);
            fill(&mut depth.near_m[pixels], near_m, f16::from_ne_bytes);
        }
    }
    match rows_left.iter().position(|&left| left) {
        Some(row) => Err(format!("row {row} is missing")),
        None => Ok(depth),
    }
}

fn check_header(headers: &[Header], size: UVec2) -> Result<(), String> {
    let [header] = headers else {
        return Err(format!("has {} parts, but a depth has one", headers.len()));
    };
    if header.deep || header.blocks.has_tiles() || header.compression != Compression::ZIP16 {
        return Err("is not stored as scan lines with ZIP".to_owned());
    }
    let list = &header.channels.list;
    let found: Vec<String> =
        list.iter().map(|channel| format!("{} {}", channel.name, type_name(channel.sample_type))).collect();
    let expected = CHANNELS.map(|(name, sample_type)| format!("{name} {}", type_name(sample_type)));
    if found != expected || list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(format!(
            "has the channels {}, but a depth has {}",
            found.join(", "),
            expected.join(", ")
        ));
    }
    let Vec2(width, height) = header.layer_size;
    if (width, height) != (size.x as usize, size.y as usize) {
        return Err(format!("is {width}x{height} pixels, but {}x{} are expected", size.x, size.y));
    }
    Ok(())
}

fn fill<T, const N: usize>(to: &mut [T], bytes: &[u8], from_bytes: impl Fn([u8; N]) -> T) {
    for (value, group) in to.iter_mut().zip(bytes.as_chunks::<N>().0) {
        *value = from_bytes(*group);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SIZE: UVec2 = UVec2::new(20, 18);

    fn depth() -> DepthMap {
        let mut depth = DepthMap::empty(SIZE.x, SIZE.y);
        for index in 0..359 {
            depth.depth_m[index] = 1.0 + 0.37 * index as f32;
            depth.alpha[index] = f16::from_f32(index as f32 / 400.0);
            depth.near_m[index] = f16::from_f32(0.9 + 0.37 * index as f32);
            depth.far_m[index] = f16::from_f32(1.1 + 0.37 * index as f32);
        }
        depth
    }

    fn path() -> &'static Path {
        Path::new("cam00/0000.exr")
    }

    #[test]
    fn a_depth_reads_back_to_the_bit() {
        let bytes = encode_depth(path(), &depth()).unwrap();
        assert_eq!(decode_depth(path(), &bytes, SIZE).unwrap(), depth());
        assert_eq!(bytes, encode_depth(path(), &depth()).unwrap());
    }

    #[test]
    fn other_sizes_other_layouts_and_cut_files_are_refused() {
        let bytes = encode_depth(path(), &depth()).unwrap();
        let error = decode_depth(path(), &bytes, UVec2::new(256, 192)).unwrap_err().to_string();
        assert!(error.contains("is 20x18 pixels, but 256x192 are expected"), "{error}");
        let channel = vec![AnyChannel::new("Z", FlatSamples::F32(vec![1.0; 360]))];
        let other = encode_channels(channel, SIZE, Compression::ZIP16).unwrap();
        let error = decode_depth(path(), &other, SIZE).unwrap_err().to_string();
        assert!(error.contains("has the channels Z float, but"), "{error}");
        for length in 0..bytes.len() {
            assert!(decode_depth(path(), &bytes[..length], SIZE).is_err(), "{length} bytes passed");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_reader_panic(
            changes in prop::collection::vec((0usize..1_000_000, any::<u8>()), 1..12)
        ) {
            let mut bytes = encode_depth(path(), &depth()).unwrap();
            let length = bytes.len();
            for (place, value) in changes {
                bytes[place % length] = value;
            }
            if let Ok(depth) = decode_depth(path(), &bytes, SIZE) {
                prop_assert_eq!(depth.depth_m.len(), 360);
            }
        }
    }
}
