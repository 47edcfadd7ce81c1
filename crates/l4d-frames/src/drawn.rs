//! What a model draws, as files: display colour as PNG, depth as EXR or as 16-bit PNG in millimetres.
//!
//! Colours are display colours already; nothing here knows exposure, and nothing how a picture was drawn.

use std::io::Cursor;

use half::f16;
pub use image::{Rgb, RgbImage};

/// Millimetres in a metre: the unit of depth PNGs.
const PNG_UNITS_PER_METRE: f32 = 1000.0;

/// Depth as a model says it, row-major. Unlike that of a render it is a matter of degree.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthMap {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Planar depth (camera z), metres; +inf where there is none.
    pub depth_m: Vec<f32>,
    /// How much of the pixel is filled, 0 to 1.
    pub alpha: Vec<f16>,
    /// Depth behind which a quarter is filled, metres; +inf where that never is.
    pub near_m: Vec<f16>,
    /// Depth behind which three quarters are filled, metres; +inf where that never is.
    pub far_m: Vec<f16>,
}

impl DepthMap {
    /// A picture in which nothing is.
    pub fn empty(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            depth_m: vec![f32::INFINITY; pixels],
            alpha: vec![f16::ZERO; pixels],
            near_m: vec![f16::INFINITY; pixels],
            far_m: vec![f16::INFINITY; pixels],
        }
    }

    /// The bytes of a 16-bit grayscale PNG in millimetres; 0 where there is no depth or more than 65.535 m.
    pub fn png(&self) -> Vec<u8> {
        let samples = self.depth_m.iter().flat_map(|&depth_m| {
            let units = (depth_m * PNG_UNITS_PER_METRE).round();
            let units = if (1.0..=65_535.0).contains(&units) { units as u16 } else { 0 };
            units.to_be_bytes()
        });
        let samples: Vec<u8> = samples.collect();
        encode(self.width, self.height, png::ColorType::Grayscale, png::BitDepth::Sixteen, &samples)
    }
}

/// Why bytes are no drawn picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DrawnError {
    /// Another size than was asked for.
    #[error("is {}x{} pixels, but {}x{} are expected", found.0, found.1, expected.0, expected.1)]
    Size {
        /// Width and height in the file, pixels.
        found: (u32, u32),
        /// Width and height that were asked for, pixels.
        expected: (u32, u32),
    },
    /// Another kind of PNG.
    #[error("is a PNG of another kind: {0}")]
    Kind(String),
    /// No PNG, cut off, or broken.
    #[error("is no sound PNG: {0}")]
    Damaged(String),
}

/// A picture from display colours, 0 to 1; what lies outside is clamped.
pub fn picture_of(width: u32, height: u32, colour: &[[f32; 3]]) -> RgbImage {
    let mut pixels = colour.iter();
    RgbImage::from_fn(width, height, |_, _| {
        // Conversion saturates, and makes NaN 0.
        let byte = |value: f32| (value * 255.0).round() as u8;
        Rgb(pixels.next().map_or([0; 3], |pixel| pixel.map(byte)))
    })
}

/// A picture as the bytes of a PNG; the same picture gives the same bytes.
pub fn encode_colour(picture: &RgbImage) -> Vec<u8> {
    let (width, height) = picture.dimensions();
    encode(width, height, png::ColorType::Rgb, png::BitDepth::Eight, picture.as_raw())
}

/// A picture of `width` x `height` from the bytes of a PNG as [`encode_colour`] writes them.
///
/// # Errors
/// Bytes that are no such PNG of that size.
pub fn decode_colour(bytes: &[u8], width: u32, height: u32) -> Result<RgbImage, DrawnError> {
    let kind = (png::ColorType::Rgb, png::BitDepth::Eight);
    let samples = decode(bytes, (width, height), kind)?;
    RgbImage::from_raw(width, height, samples).ok_or_else(|| DrawnError::Damaged("pixels are missing".into()))
}

/// Depths in metres, +inf where there is none, from the bytes of a PNG as [`DepthMap::png`] writes them.
///
/// # Errors
/// Bytes that are no such PNG of that size.
pub fn decode_depth_png(bytes: &[u8], width: u32, height: u32) -> Result<Vec<f32>, DrawnError> {
    let kind = (png::ColorType::Grayscale, png::BitDepth::Sixteen);
    let samples = decode(bytes, (width, height), kind)?;
    let metres = |sample: &[u8; 2]| match u16::from_be_bytes(*sample) {
        0 => f32::INFINITY,
        units => f32::from(units) / PNG_UNITS_PER_METRE,
    };
    Ok(samples.as_chunks::<2>().0.iter().map(metres).collect())
}

fn encode(width: u32, height: u32, colour: png::ColorType, depth: png::BitDepth, samples: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Fast);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(samples)?;
        writer.finish()
    });
    written.expect("writing to memory with as many bytes as the header says cannot fail");
    file
}

fn decode(
    bytes: &[u8],
    expected: (u32, u32),
    kind: (png::ColorType, png::BitDepth),
) -> Result<Vec<u8>, DrawnError> {
    let damaged = |error: png::DecodingError| DrawnError::Damaged(error.to_string());
    let mut options = png::DecodeOptions::default();
    options.set_ignore_checksums(false);
    let decoder = png::Decoder::new_with_options(Cursor::new(bytes), options);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let info = reader.info();
    if info.size() != expected {
        return Err(DrawnError::Size { found: info.size(), expected });
    }
    if (info.color_type, info.bit_depth) != kind {
        return Err(DrawnError::Kind(format!("{:?}, {:?}", info.color_type, info.bit_depth)));
    }
    let bytes_a_pixel = kind.0.samples() * kind.1 as usize / 8;
    let mut samples = vec![0; expected.0 as usize * expected.1 as usize * bytes_a_pixel];
    reader.next_frame(&mut samples).map_err(damaged)?;
    // A file that was cut after its last row has no end mark.
    reader.finish().map_err(damaged)?;
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> RgbImage {
        RgbImage::from_fn(37, 5, |column, row| Rgb([column as u8 * 6, row as u8 * 50, 7]))
    }

    #[test]
    fn colours_are_clamped_rounded_and_read_back() {
        let colours = [[-0.5, 0.5, 1.5], [f32::NAN, 0.25, 1.0 / 255.0]];
        let picture = picture_of(2, 1, &colours);
        assert_eq!(picture.as_raw(), &[0, 128, 255, 0, 64, 1]);
        assert_eq!(decode_colour(&encode_colour(&picture), 2, 1).unwrap(), picture);
    }

    #[test]
    fn depth_pngs_hold_millimetres_and_zero_for_none() {
        let mut depth = DepthMap::empty(3, 2);
        depth.depth_m = vec![1.2344, 0.0004, 65.535, 65.536, f32::INFINITY, -1.0];
        let back = decode_depth_png(&depth.png(), 3, 2).unwrap();
        let none = f32::INFINITY;
        assert_eq!(back, [1.234, none, 65.535, none, none, none]);
    }

    #[test]
    fn other_sizes_kinds_and_cut_files_are_refused() {
        let file = encode_colour(&picture());
        assert_eq!(decode_colour(&file, 37, 5).unwrap(), picture());
        assert!(matches!(decode_colour(&file, 37, 6), Err(DrawnError::Size { found: (37, 5), .. })));
        assert!(matches!(decode_depth_png(&file, 37, 5), Err(DrawnError::Kind(_))));
        for length in 0..file.len() {
            assert!(decode_colour(&file[..length], 37, 5).is_err(), "{length} bytes passed");
        }
    }
}
