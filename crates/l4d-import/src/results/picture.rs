//! PNG pictures of any kind as numbers, one a pixel.
//!
//! A palette gives its index, never its colour. Alpha is no mask unless every pixel is opaque. Colour is taken where
//! its channels are equal, as of programs that write grey as RGB; else it says nothing that could be called inside.

use std::io::Cursor;

use l4d_masks::Mask;
use png::{BitDepth, ColorType, Decoder, Limits};

use super::codec::Problem;
use super::codes;

/// Numbers of a picture, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Picture {
    /// Pixels in a row.
    pub(super) width: u32,
    /// Rows.
    pub(super) height: u32,
    /// One number a pixel.
    pub(super) values: Vec<f32>,
    /// Whether the numbers are indices of a palette.
    pub(super) is_palette: bool,
}

/// A picture that does not say what is inside.
pub(super) fn ambiguous(message: String) -> Problem {
    let hint = "write grey PNG of 0 and 255, or say which index is meant: --inside \"index 3\"";
    Problem::new(codes::AMBIGUOUS_MASK, "picture", message, hint)
}

/// Decodes a PNG.
pub(super) fn decode(bytes: &[u8]) -> Result<Picture, Problem> {
    let broken = |why: String| {
        Problem::unreadable("picture", format!("is no whole PNG: {why}"), "write the picture again")
    };
    let damaged = |error: png::DecodingError| broken(error.to_string());
    let decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: 64 << 20 });
    let mut reader = decoder.read_info().map_err(damaged)?;
    let info = reader.info();
    let (width, height) = info.size();
    let too_large = || {
        let most = Mask::MAX_SIDE;
        broken(format!("is {width}x{height}, but each side must have 1 to {most} pixels"))
    };
    if !Mask::is_sane_size(width, height) {
        return Err(too_large());
    }
    let (colour, depth) = (info.color_type, info.bit_depth);
    let length = reader.output_buffer_size().ok_or_else(too_large)?;
    let mut buffer = vec![0; length];
    let frame = reader.next_frame(&mut buffer).map_err(damaged)?;
    let row_bytes = frame.line_size;
    // White is 255 in every picture of up to 8 bits, as every other program reads it; an index stays an index.
    let scale = match (colour, depth) {
        (ColorType::Grayscale, BitDepth::One) => 255,
        (ColorType::Grayscale, BitDepth::Two) => 85,
        (ColorType::Grayscale, BitDepth::Four) => 17,
        _ => 1,
    };
    let per_pixel = colour.samples();
    let mut values = Vec::with_capacity(width as usize * height as usize);
    for (row, line) in buffer.chunks_exact(row_bytes).take(height as usize).enumerate() {
        let sample = |index: usize| sample(line, index, depth);
        for col in 0..width as usize {
            let at = |channel: usize| sample(col * per_pixel + channel);
            values.push(f32::from(scale * value(colour, depth, at, col, row)?));
        }
    }
    Ok(Picture { width, height, values, is_palette: colour == ColorType::Indexed })
}

fn value(
    colour: ColorType,
    depth: BitDepth,
    at: impl Fn(usize) -> u16,
    col: usize,
    row: usize,
) -> Result<u16, Problem> {
    let opaque = if depth == BitDepth::Sixteen { u16::MAX } else { 255 };
    let is_clear = match colour {
        ColorType::GrayscaleAlpha => at(1) != opaque,
        ColorType::Rgba => at(3) != opaque,
        _ => false,
    };
    if is_clear {
        let message = "has pixels that are not opaque, and alpha is no mask";
        return Err(ambiguous(message.to_owned()));
    }
    if matches!(colour, ColorType::Rgb | ColorType::Rgba) && (at(0) != at(1) || at(1) != at(2)) {
        let (red, green, blue) = (at(0), at(1), at(2));
        return Err(ambiguous(format!(
            "has colours (pixel {col}, {row} is {red}, {green}, {blue}), so nothing says what is inside"
        )));
    }
    Ok(at(0))
}

/// A sample of a row whose samples are packed as the file has them.
fn sample(line: &[u8], index: usize, depth: BitDepth) -> u16 {
    let bits = depth as usize;
    match depth {
        BitDepth::Sixteen => u16::from_be_bytes([line[2 * index], line[2 * index + 1]]),
        BitDepth::Eight => u16::from(line[index]),
        BitDepth::One | BitDepth::Two | BitDepth::Four => {
            let first = index * bits;
            let shift = 8 - bits - first % 8;
            u16::from(line[first / 8] >> shift) & ((1 << bits) - 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(colour: ColorType, depth: BitDepth, width: u32, pixels: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, 1);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        if colour == ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 128, 0, 0, 0, 128, 0, 1, 2, 3]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(pixels).unwrap();
        writer.finish().unwrap();
        file
    }

    #[test]
    fn every_kind_gives_its_numbers() {
        use BitDepth::{Eight, One, Sixteen, Two};
        use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
        let read =
            |colour, depth, width, pixels: &[u8]| decode(&png(colour, depth, width, pixels)).unwrap().values;
        assert_eq!(read(Grayscale, One, 3, &[0b1010_0000]), [255.0, 0.0, 255.0]);
        assert_eq!(read(Grayscale, Two, 3, &[0b0111_0000]), [85.0, 255.0, 0.0]);
        assert_eq!(read(Grayscale, Sixteen, 2, &[1, 0, 0, 7]), [256.0, 7.0]);
        assert_eq!(read(Indexed, Two, 3, &[0b0111_0000]), [1.0, 3.0, 0.0]);
        assert_eq!(read(Indexed, Eight, 2, &[3, 1]), [3.0, 1.0]);
        assert_eq!(read(Rgb, Eight, 2, &[9, 9, 9, 0, 0, 0]), [9.0, 0.0]);
        assert_eq!(read(Rgba, Eight, 1, &[9, 9, 9, 255]), [9.0]);
        assert_eq!(read(GrayscaleAlpha, Eight, 1, &[4, 255]), [4.0]);
    }

    #[test]
    fn what_says_nothing_of_inside_is_refused() {
        use BitDepth::Eight;
        let refused = |colour, pixels: &[u8]| decode(&png(colour, Eight, 1, pixels)).unwrap_err();
        assert!(refused(ColorType::Rgb, &[1, 2, 3]).message.contains("(pixel 0, 0 is 1, 2, 3)"));
        assert!(refused(ColorType::Rgba, &[1, 1, 1, 0]).message.contains("alpha is no mask"));
        assert_eq!(decode(b"no picture").unwrap_err().code, codes::UNREADABLE);
        let mut huge = png(ColorType::Grayscale, Eight, 1, &[0]);
        huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        assert!(decode(&huge).is_err());
    }
}
