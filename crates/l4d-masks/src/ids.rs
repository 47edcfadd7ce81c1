//! PNG pictures with an instance id for each pixel: palette pictures as DAVIS has them, and grey ones.
//!
//! A palette's colours mean nothing here, its indices are the ids. Colour pictures are refused: no file says which
//! colour is which instance.

use std::io::Cursor;

use crate::mask::Mask;
use crate::png::PngError;

/// An instance id for each pixel; 0 is none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IdPicture {
    pub width: u32,
    pub height: u32,
    /// Row-major.
    pub ids: Vec<u32>,
}

impl IdPicture {
    /// Ids that occur, ascending, without 0.
    pub fn present(&self) -> Vec<u32> {
        let mut present: Vec<u32> = self.ids.iter().copied().filter(|&id| id != 0).collect();
        present.sort_unstable();
        present.dedup();
        present
    }

    pub fn mask(&self, id: u32) -> Mask {
        let width = self.width as usize;
        Mask::from_fn(self.width, self.height, |col, row| self.ids[row as usize * width + col as usize] == id)
    }
}

/// Encodes row-major ids as a palette picture with the colours of PASCAL VOC and DAVIS; the same ids give the same
/// bytes.
///
/// # Panics
/// If there is not one id for each pixel.
pub fn encode_palette(width: u32, height: u32, ids: &[u8]) -> Vec<u8> {
    assert_eq!(ids.len() as u64, u64::from(width) * u64::from(height), "one number a pixel");
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette((0..=255).flat_map(colour_of).collect::<Vec<u8>>());
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(ids)?;
        writer.finish()
    });
    written.expect("writing to memory with as many bytes as the header says cannot fail");
    file
}

/// PASCAL VOC's colour of an id: its bits, from the lowest, go to red, green and blue in turn, and fill these from the
/// highest bit down.
fn colour_of(id: u8) -> [u8; 3] {
    let mut colour = [0; 3];
    for group in 0..3 {
        for (channel, value) in colour.iter_mut().enumerate() {
            let place = 3 * group + channel;
            if place < 8 {
                *value |= (id >> place & 1) << (7 - group);
            }
        }
    }
    colour
}

/// Decodes a palette picture (the indices) or a grey one of 1 to 16 bits (the values).
///
/// # Errors
/// Bytes that are no such PNG, or are damaged.
pub fn decode(bytes: &[u8]) -> Result<IdPicture, PngError> {
    let damaged = |error: png::DecodingError| PngError::Damaged(error.to_string());
    let (width, height) = crate::png::sane_size(bytes)?;
    let mut options = png::DecodeOptions::default();
    options.set_ignore_checksums(false);
    let decoder = png::Decoder::new_with_options(Cursor::new(bytes), options);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (colour, depth) = (reader.info().color_type, reader.info().bit_depth);
    if !matches!(colour, png::ColorType::Grayscale | png::ColorType::Indexed) {
        return Err(PngError::Kind { kind: format!("{colour:?}, so that its numbers are unknown") });
    }
    let bits = depth as usize;
    let row_bytes = (width as usize * bits).div_ceil(8);
    let mut samples = vec![0; row_bytes * height as usize];
    reader.next_frame(&mut samples).map_err(damaged)?;
    reader.finish().map_err(damaged)?;
    let ids = samples.chunks_exact(row_bytes).flat_map(|row| samples_of_row(row, bits, width as usize));
    Ok(IdPicture { width, height, ids: ids.collect() })
}

/// Unpacks the samples of a row, `bits` each, the first in the highest bits (PNG, section 7.2).
fn samples_of_row(row: &[u8], bits: usize, width: usize) -> impl Iterator<Item = u32> {
    (0..width).map(move |col| match bits {
        16 => u32::from(u16::from_be_bytes([row[2 * col], row[2 * col + 1]])),
        8 => u32::from(row[col]),
        _ => {
            let first_bit = col * bits;
            let shift = 8 - bits - first_bit % 8;
            u32::from(row[first_bit / 8] >> shift) & ((1 << bits) - 1)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(bits: png::BitDepth, width: u32, samples: &[u8]) -> Vec<u8> {
        row(png::ColorType::Grayscale, bits, width, samples)
    }

    fn row(colour: png::ColorType, bits: png::BitDepth, width: u32, samples: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, 1);
        encoder.set_color(colour);
        encoder.set_depth(bits);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(samples).unwrap();
        writer.finish().unwrap();
        file
    }

    #[test]
    fn palettes_have_the_colours_of_davis_and_keep_their_ids() {
        assert_eq!(
            [1, 2, 3, 4, 8].map(colour_of),
            [[128, 0, 0], [0, 128, 0], [128, 128, 0], [0, 0, 128], [64, 0, 0]]
        );
        assert_eq!(colour_of(255), [224, 224, 192]);
        let picture = decode(&encode_palette(3, 2, &[0, 1, 2, 255, 1, 0])).unwrap();
        assert_eq!(picture.ids, [0, 1, 2, 255, 1, 0]);
        assert_eq!(picture.present(), [1, 2, 255]);
        assert_eq!(picture.mask(1).pixels().collect::<Vec<_>>(), [(1, 0), (1, 1)]);
    }

    #[test]
    fn every_depth_of_grey_is_read() {
        use png::BitDepth;
        assert_eq!(decode(&grey(BitDepth::Sixteen, 2, &[1, 2, 0, 9])).unwrap().ids, [258, 9]);
        assert_eq!(decode(&grey(BitDepth::Four, 3, &[0x1f, 0x70])).unwrap().ids, [1, 15, 7]);
        assert_eq!(
            decode(&grey(BitDepth::Two, 5, &[0b00_01_10_11, 0b10_00_00_00])).unwrap().ids,
            [0, 1, 2, 3, 2]
        );
        assert_eq!(decode(&grey(BitDepth::One, 3, &[0b1010_0000])).unwrap().ids, [1, 0, 1]);
    }

    #[test]
    fn colours_cut_files_and_absurd_sizes_are_refused() {
        let colour = row(png::ColorType::Rgb, png::BitDepth::Eight, 2, &[0; 6]);
        assert!(matches!(decode(&colour), Err(PngError::Kind { .. })));
        let mut file = encode_palette(4, 4, &[7; 16]);
        for length in 0..file.len() {
            assert!(decode(&file[..length]).is_err(), "{length} bytes passed");
        }
        file[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
        assert!(matches!(decode(&file), Err(PngError::AbsurdSize { .. })));
    }
}
