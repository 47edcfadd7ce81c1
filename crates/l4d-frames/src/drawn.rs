//! What a model draws, as files: display colour as PNG, depth as EXR or as 16-bit PNG in millimetres.
//!
//! Colours are display colours already; nothing here knows exposure, and nothing how a picture was drawn.

use half::f16;
use image::DynamicImage;
pub use image::{Rgb, RgbImage};

use crate::photo::{PhotoError, decode_sized};

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
pub fn decode_colour(bytes: &[u8], width: u32, height: u32) -> Result<RgbImage, PhotoError> {
    match decode_sized(bytes, (width, height))? {
        DynamicImage::ImageRgb8(picture) => Ok(picture),
        _ => Err(PhotoError::OtherKind),
    }
}

/// Depths in metres, +inf where there is none, from the bytes of a PNG as [`DepthMap::png`] writes them.
///
/// # Errors
/// Bytes that are no such PNG of that size.
pub fn decode_depth_png(bytes: &[u8], width: u32, height: u32) -> Result<Vec<f32>, PhotoError> {
    let DynamicImage::ImageLuma16(picture) = decode_sized(bytes, (width, height))? else {
        return Err(PhotoError::OtherKind);
    };
    let metres = |&units: &u16| match units {
        0 => f32::INFINITY,
        units => f32::from(units) / PNG_UNITS_PER_METRE,
    };
    Ok(picture.iter().map(metres).collect())
}

/// The same samples give the same bytes.
pub(crate) fn encode(
    width: u32,
    height: u32,
    colour: png::ColorType,
    depth: png::BitDepth,
    samples: &[u8],
) -> Vec<u8> {
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
        assert!(matches!(decode_colour(&file, 37, 6), Err(PhotoError::Size { found: (37, 5), .. })));
        assert!(matches!(decode_depth_png(&file, 37, 5), Err(PhotoError::OtherKind)));
        for length in 0..file.len() {
            assert!(decode_colour(&file[..length], 37, 5).is_err(), "{length} bytes passed");
        }
    }
}
