//! Masks as PNG: 1-bit grayscale, or 8-bit grayscale with one value beside 0 (1 or 255).
//!
//! Everything else is refused rather than guessed: a palette's index is no truth value, and a grey of 128 may
//! mean either side. Size and kind are read from the header before anything is allocated.

use std::io::Cursor;

use crate::mask::{Mask, words_per_row};

/// Why bytes are no mask, with what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PngError {
    /// Not a PNG at all.
    #[error("is no PNG file")]
    NotPng,
    /// Another size than was asked for.
    #[error("is {}x{}, but masks are {}x{} here", found.0, found.1, expected.0, expected.1)]
    Size {
        /// Width and height in the file, pixels.
        found: (u32, u32),
        /// Width and height that were asked for, pixels.
        expected: (u32, u32),
    },
    /// A side that no decoder should make room for.
    #[error("is {}x{}, but each side must have 1 to {} pixels", found.0, found.1, Mask::MAX_SIDE)]
    AbsurdSize {
        /// Width and height in the file, pixels.
        found: (u32, u32),
    },
    /// Colour, palette, alpha or another depth.
    #[error("is {kind}, but a mask is 1-bit or 8-bit grayscale without alpha")]
    Kind {
        /// What it is.
        kind: String,
    },
    /// A grey that is neither inside nor outside.
    #[error("pixel ({col}, {row}) has the value {value}, but a mask uses 0 and {}", partner(*other))]
    Value {
        /// Column of the pixel.
        col: u32,
        /// Row of the pixel.
        row: u32,
        /// Its value.
        value: u8,
        /// The value of the inside pixels before it, if there were any.
        other: Option<u8>,
    },
    /// Truncated, bad checksum, bad stream.
    #[error("is damaged: {0}")]
    Damaged(String),
}

impl PngError {
    /// What to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::NotPng | Self::Damaged(_) => "write the file again",
            Self::Size { .. } => "render masks at the size of the profile, or let `l4d score --resize` do it",
            Self::AbsurdSize { .. } => "render masks at the size of the profile",
            Self::Kind { .. } => {
                "convert it, for example with Pillow: Image.fromarray((mask > 0).astype('uint8') * 255).save(path)"
            }
            Self::Value { .. } => "threshold the mask and write 0 for outside, 255 for inside",
        }
    }
}

/// What the first bytes of a PNG say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Header {
    width: u32,
    height: u32,
    bit_depth: u8,
    colour_type: u8,
}

/// Width and height, pixels, from the header alone.
pub fn size(bytes: &[u8]) -> Result<(u32, u32), PngError> {
    let header = Header::read(bytes)?;
    Ok((header.width, header.height))
}

/// Decodes a mask of exactly `width` x `height`.
pub fn decode(bytes: &[u8], width: u32, height: u32) -> Result<Mask, PngError> {
    let header = Header::read(bytes)?;
    if header.size() != (width, height) {
        return Err(PngError::Size { found: header.size(), expected: (width, height) });
    }
    decode_any(bytes)
}

/// Decodes a mask of whatever sane size.
pub fn decode_any(bytes: &[u8]) -> Result<Mask, PngError> {
    let header = Header::read(bytes)?;
    let (width, height) = header.size();
    if !Mask::is_sane_size(width, height) {
        return Err(PngError::AbsurdSize { found: header.size() });
    }
    header.check_kind()?;
    let mut options = png::DecodeOptions::default();
    options.set_ignore_checksums(false);
    options.set_skip_ancillary_crc_failures(false);
    let decoder = png::Decoder::new_with_options(Cursor::new(bytes), options);
    let mut reader = decoder.read_info().map_err(damaged)?;
    if reader.info().trns.is_some() {
        return Err(PngError::Kind { kind: "grayscale with a transparent value (tRNS)".to_owned() });
    }
    let row_bytes = if header.bit_depth == 1 { width.div_ceil(8) } else { width } as usize;
    let mut pixels = vec![0; row_bytes * height as usize];
    reader.next_frame(&mut pixels).map_err(damaged)?;
    // A file that was cut after its last row has no end mark.
    reader.finish().map_err(damaged)?;
    let rows = pixels.chunks_exact(row_bytes);
    if header.bit_depth == 1 {
        Ok(from_bit_rows(width, height, rows))
    } else {
        from_byte_rows(width, height, rows)
    }
}

/// Encodes a mask as 1-bit grayscale; the same mask gives the same bytes.
pub fn encode(mask: &Mask) -> Vec<u8> {
    let (width, height) = mask.size();
    let mut pixels = Vec::with_capacity(width.div_ceil(8) as usize * height as usize);
    for row in 0..height {
        let bytes = mask.row_words(row).iter().flat_map(|word| word.reverse_bits().to_be_bytes());
        pixels.extend(bytes.take(width.div_ceil(8) as usize));
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&pixels)?;
        writer.finish()
    });
    written.expect("writing to memory with as many bytes as the header says cannot fail");
    file
}

impl Header {
    const SIGNATURE: [u8; 16] = *b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR";

    fn read(bytes: &[u8]) -> Result<Self, PngError> {
        let rest = bytes.strip_prefix(&Self::SIGNATURE).ok_or(PngError::NotPng)?;
        let [w0, w1, w2, w3, h0, h1, h2, h3, bit_depth, colour_type, ..] = *rest else {
            return Err(PngError::Damaged("the header is cut".to_owned()));
        };
        let width = u32::from_be_bytes([w0, w1, w2, w3]);
        let height = u32::from_be_bytes([h0, h1, h2, h3]);
        Ok(Self { width, height, bit_depth, colour_type })
    }

    fn size(self) -> (u32, u32) {
        (self.width, self.height)
    }

    fn check_kind(self) -> Result<(), PngError> {
        let kind = match (self.colour_type, self.bit_depth) {
            (0, 1 | 8) => return Ok(()),
            (0, depth) => format!("{depth}-bit grayscale"),
            (2, depth) => format!("{depth}-bit RGB"),
            (3, depth) => format!("a {depth}-bit palette picture"),
            (4, depth) => format!("{depth}-bit grayscale with alpha"),
            (6, depth) => format!("{depth}-bit RGBA"),
            (other, _) => format!("of the unknown colour type {other}"),
        };
        Err(PngError::Kind { kind })
    }
}

fn damaged(error: png::DecodingError) -> PngError {
    PngError::Damaged(error.to_string())
}

fn partner(other: Option<u8>) -> String {
    other.map_or_else(|| "1 or 0 and 255".to_owned(), |value| value.to_string())
}

fn from_bit_rows<'a>(width: u32, height: u32, rows: impl Iterator<Item = &'a [u8]>) -> Mask {
    let mut mask = Mask::empty(width, height);
    for (row, bytes) in (0..height).zip(rows) {
        for (word, bytes) in mask.row_words_mut(row).iter_mut().zip(bytes.chunks(8)) {
            let mut eight = [0; 8];
            eight[..bytes.len()].copy_from_slice(bytes);
            *word = u64::from_be_bytes(eight).reverse_bits();
        }
    }
    mask.clear_padding();
    mask
}

fn from_byte_rows<'a>(
    width: u32,
    height: u32,
    rows: impl Iterator<Item = &'a [u8]>,
) -> Result<Mask, PngError> {
    let mut mask = Mask::empty(width, height);
    let mut inside = None;
    for (row, bytes) in (0..height).zip(rows) {
        if inside.is_none() {
            inside = bytes.iter().copied().find(|&value| value != 0);
        }
        let value = inside.unwrap_or(255);
        let is_sound = matches!(value, 1 | 255);
        // Without a branch per pixel: the compiler turns this into vector compares.
        let stray =
            bytes.iter().fold(0, |stray, &byte| stray | (u8::from(byte != 0) & u8::from(byte != value)));
        if !is_sound || stray != 0 {
            return Err(stray_value(row, bytes, value));
        }
        debug_assert_eq!(words_per_row(width), mask.row_words(row).len());
        for (word, bytes) in mask.row_words_mut(row).iter_mut().zip(bytes.chunks(64)) {
            *word = pack(bytes);
        }
    }
    Ok(mask)
}

/// Lowest bits of up to 64 bytes, the first byte in bit 0.
fn pack(bytes: &[u8]) -> u64 {
    const LOWEST_BITS: u64 = 0x0101_0101_0101_0101;
    // Moves bit 8i to bit 56 + i without two of them ever meeting.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let mut word = 0;
    for (index, bytes) in bytes.chunks(8).enumerate() {
        let mut eight = [0; 8];
        eight[..bytes.len()].copy_from_slice(bytes);
        let bits = (u64::from_le_bytes(eight) & LOWEST_BITS).wrapping_mul(GATHER) >> 56;
        word |= bits << (8 * index);
    }
    word
}

fn stray_value(row: u32, bytes: &[u8], inside: u8) -> PngError {
    let is_sound = matches!(inside, 1 | 255);
    let is_stray = |byte: u8| byte != 0 && (!is_sound || byte != inside);
    let col = bytes.iter().position(|&byte| is_stray(byte)).unwrap_or(0);
    PngError::Value { col: col as u32, row, value: bytes[col], other: is_sound.then_some(inside) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn write(
        width: u32,
        height: u32,
        colour: png::ColorType,
        depth: png::BitDepth,
        pixels: &[u8],
    ) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        if colour == png::ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 255, 0, 0]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(pixels).unwrap();
        writer.finish().unwrap();
        file
    }

    fn gray8(width: u32, pixels: &[u8]) -> Vec<u8> {
        let height = pixels.len() as u32 / width;
        write(width, height, png::ColorType::Grayscale, png::BitDepth::Eight, pixels)
    }

    proptest! {
        #[test]
        fn both_kinds_round_trip(
            (width, height, pixels) in (1..150_u32, 1..20_u32).prop_flat_map(|(width, height)| {
                (Just(width), Just(height), proptest::collection::vec(any::<bool>(), (width * height) as usize))
            })
        ) {
            let mask = Mask::from_bools(width, height, &pixels).unwrap();
            prop_assert_eq!(&decode(&encode(&mask), width, height).unwrap(), &mask);
            for inside in [1, 255] {
                let bytes: Vec<u8> = pixels.iter().map(|&pixel| if pixel { inside } else { 0 }).collect();
                prop_assert_eq!(&decode(&gray8(width, &bytes), width, height).unwrap(), &mask);
            }
        }

        #[test]
        fn damaged_bytes_never_panic_nor_pass(offset in 0..200_usize, flip in 1..=255_u8) {
            let mask = Mask::from_fn(70, 9, |col, row| (col * row) % 3 == 1);
            let mut file = encode(&mask);
            let offset = offset % file.len();
            file[offset] ^= flip;
            prop_assert!(decode(&file, 70, 9).is_err(), "byte {} was flipped unnoticed", offset);
        }
    }

    #[test]
    fn every_truncation_is_refused() {
        let file = encode(&Mask::from_fn(70, 9, |col, row| (col + row) % 5 == 0));
        for length in 0..file.len() {
            assert!(
                decode(&file[..length], 70, 9).is_err(),
                "the first {length} of {} bytes passed",
                file.len()
            );
        }
    }

    #[test]
    fn other_kinds_are_refused_with_a_remedy() {
        use png::{BitDepth, ColorType};
        let cases = [
            (ColorType::Indexed, BitDepth::One, vec![0x80], "1-bit palette"),
            (ColorType::Indexed, BitDepth::Eight, vec![0, 1], "8-bit palette"),
            (ColorType::Grayscale, BitDepth::Sixteen, vec![0, 0, 255, 255], "16-bit grayscale"),
            (ColorType::Grayscale, BitDepth::Two, vec![0], "2-bit grayscale"),
            (ColorType::GrayscaleAlpha, BitDepth::Eight, vec![0; 4], "with alpha"),
            (ColorType::Rgb, BitDepth::Eight, vec![0; 6], "RGB"),
            (ColorType::Rgba, BitDepth::Eight, vec![0; 8], "RGBA"),
        ];
        for (colour, depth, pixels, name) in cases {
            let error = decode(&write(2, 1, colour, depth, &pixels), 2, 1).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
            assert!(error.remedy().contains("Pillow"));
        }
    }

    #[test]
    fn other_values_are_named_with_their_pixel() {
        let other = |pixels: &[u8]| decode(&gray8(2, pixels), 2, 2).unwrap_err();
        assert_eq!(other(&[0, 0, 7, 0]), PngError::Value { col: 0, row: 1, value: 7, other: None });
        assert_eq!(other(&[255, 0, 0, 1]), PngError::Value { col: 1, row: 1, value: 1, other: Some(255) });
        assert_eq!(other(&[1, 128, 0, 1]), PngError::Value { col: 1, row: 0, value: 128, other: Some(1) });
        let text = other(&[0, 0, 7, 0]).to_string();
        assert!(text.contains("0 and 1 or 0 and 255"), "{text}");
    }

    #[test]
    fn a_huge_header_is_refused_before_anything_is_allocated() {
        let mut file = encode(&Mask::empty(4, 4));
        file[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
        assert_eq!(size(&file).unwrap(), (100_000, 100_000));
        let found = (100_000, 100_000);
        assert_eq!(decode(&file, 4, 4).unwrap_err(), PngError::Size { found, expected: (4, 4) });
        assert_eq!(decode_any(&file).unwrap_err(), PngError::AbsurdSize { found });
        assert_eq!(decode_any(b"not a picture").unwrap_err(), PngError::NotPng);
    }
}
