//! Masks as PNG: 1-bit grayscale, or 8-bit grayscale with one value beside 0 (1 or 255).
//!
//! Everything else is refused rather than guessed: a palette's index is no truth value, and a grey of 128 may
//! mean either side. Size and kind are read from the header before anything is allocated, and a stream is followed no
//! further than the picture goes. Knows one mask at a time; pictures of many ids are in [`crate::ids`].

use std::io::Cursor;

use png::{BitDepth, ColorType};

use crate::mask::Mask;

/// Why bytes are no mask.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PngError {
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
    /// A side so long that a decoder should not allocate for it.
    #[error("is {}x{}, but each side must have 1 to {} pixels", found.0, found.1, Mask::MAX_SIDE)]
    AbsurdSize {
        /// Width and height in the file, pixels.
        found: (u32, u32),
    },
    /// Colour, palette, alpha or another depth.
    #[error("is {kind}, but a mask is 1-bit or 8-bit grayscale, without alpha, row by row")]
    Kind {
        /// What it is instead.
        kind: String,
    },
    /// A grey that is neither inside nor outside.
    #[error("pixel ({col}, {row}) has the value {value}, but a mask uses 0 and {}", partner(*other))]
    Value {
        /// Column of the pixel.
        col: u32,
        /// Row of the pixel.
        row: u32,
        value: u8,
        /// The value of the inside pixels before it, if there were any.
        other: Option<u8>,
    },
    /// Truncated, a wrong checksum, or a stream that does not decode.
    #[error("is damaged: {0}")]
    Damaged(String),
}

impl PngError {
    /// What to do about it.
    pub fn hint(&self) -> &'static str {
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

/// Width and height, pixels, from the header alone.
///
/// # Errors
/// Bytes that are no PNG.
pub fn size(bytes: &[u8]) -> Result<(u32, u32), PngError> {
    let header = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR").ok_or(PngError::NotPng)?;
    let cut = || PngError::Damaged("the header is cut".to_owned());
    let [width, height] = header.first_chunk::<8>().ok_or_else(cut)?.as_chunks::<4>().0 else {
        return Err(cut());
    };
    Ok((u32::from_be_bytes(*width), u32::from_be_bytes(*height)))
}

/// Decodes a mask of exactly `width` x `height`.
///
/// # Errors
/// Bytes that are no such PNG of that size.
pub fn decode(bytes: &[u8], width: u32, height: u32) -> Result<Mask, PngError> {
    check_size(bytes, (width, height))?;
    decode_any(bytes)
}

/// Decodes a mask of any size up to [`Mask::MAX_SIDE`] on each side.
///
/// # Errors
/// Bytes that are no such PNG.
pub fn decode_any(bytes: &[u8]) -> Result<Mask, PngError> {
    let (width, height) = sane_size(bytes)?;
    let mut rows = Rows { mask: Mask::empty(width, height), row: 0, inside: None };
    read_rows(bytes, |depth, bytes| rows.push(depth, bytes))?;
    Ok(rows.mask)
}

fn check_size(bytes: &[u8], expected: (u32, u32)) -> Result<(), PngError> {
    let found = size(bytes)?;
    if found == expected { Ok(()) } else { Err(PngError::Size { found, expected }) }
}

pub(crate) fn sane_size(bytes: &[u8]) -> Result<(u32, u32), PngError> {
    let found = size(bytes)?;
    if Mask::is_sane_size(found.0, found.1) { Ok(found) } else { Err(PngError::AbsurdSize { found }) }
}

/// Gives the rows of a 1-bit or 8-bit grayscale picture to `take`, from the top.
fn read_rows(
    bytes: &[u8],
    mut take: impl FnMut(BitDepth, &[u8]) -> Result<(), PngError>,
) -> Result<(), PngError> {
    let (_, height) = sane_size(bytes)?;
    check_chunks(bytes)?;
    let mut options = png::DecodeOptions::default();
    // `check_chunks` has compared them all.
    options.set_ignore_checksums(true);
    options.set_ignore_text_chunk(true);
    options.set_ignore_iccp_chunk(true);
    let mut decoder = png::Decoder::new_with_options(Cursor::new(bytes), options);
    let header = decoder.read_header_info().map_err(damaged)?;
    let depth = header.bit_depth;
    let kind = match (header.color_type, depth) {
        (ColorType::Grayscale, BitDepth::One | BitDepth::Eight) if header.interlaced => {
            "interlaced".to_owned()
        }
        (ColorType::Grayscale, BitDepth::One | BitDepth::Eight) => String::new(),
        (ColorType::Grayscale, _) => format!("{}-bit grayscale", depth as u8),
        (ColorType::Rgb, _) => format!("{}-bit RGB", depth as u8),
        (ColorType::Indexed, _) => format!("{}-bit with a palette", depth as u8),
        (ColorType::GrayscaleAlpha, _) => format!("{}-bit grayscale with alpha", depth as u8),
        (ColorType::Rgba, _) => format!("{}-bit RGBA", depth as u8),
    };
    if !kind.is_empty() {
        return Err(PngError::Kind { kind });
    }
    let mut reader = decoder.read_info().map_err(damaged)?;
    if reader.info().trns.is_some() {
        return Err(PngError::Kind { kind: "grayscale with a transparent value (tRNS)".to_owned() });
    }
    // Row by row and no further: behind the last one a stream may go on for gigabytes.
    for _ in 0..height {
        let row = reader.next_row().map_err(damaged)?;
        take(depth, row.ok_or_else(|| PngError::Damaged("rows are missing".to_owned()))?.data())?;
    }
    Ok(())
}

/// Checks that chunks follow each other to IEND and have the checksums that they state.
fn check_chunks(bytes: &[u8]) -> Result<(), PngError> {
    let cut = || PngError::Damaged("it ends before its end mark".to_owned());
    let mut rest = &bytes[8..];
    loop {
        let (length, after) = rest.split_first_chunk().ok_or_else(cut)?;
        let length = u32::from_be_bytes(*length) as usize;
        let chunk = after.get(..length.saturating_add(4)).ok_or_else(cut)?;
        let (stated, next) = after[chunk.len()..].split_first_chunk().ok_or_else(cut)?;
        if crc32fast::hash(chunk) != u32::from_be_bytes(*stated) {
            return Err(PngError::Damaged("a checksum does not fit".to_owned()));
        }
        if chunk.starts_with(b"IEND") {
            return Ok(());
        }
        rest = next;
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
    encode_rows(&pixels, (width, height), BitDepth::One)
}

fn encode_rows(rows: &[u8], (width, height): (u32, u32), depth: BitDepth) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(depth);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(rows)?;
        writer.finish()
    });
    written.expect("writing to memory with as many bytes as the header says cannot fail");
    file
}

fn damaged(error: png::DecodingError) -> PngError {
    PngError::Damaged(error.to_string())
}

/// The value beside 0 that the mask uses, for the message.
fn partner(other: Option<u8>) -> String {
    other.map_or_else(|| "1 or 0 and 255".to_owned(), |value| value.to_string())
}

/// A mask whose rows are added from the top.
struct Rows {
    mask: Mask,
    row: u32,
    /// The value of inside pixels, once one was seen.
    inside: Option<u8>,
}

impl Rows {
    fn push(&mut self, depth: BitDepth, bytes: &[u8]) -> Result<(), PngError> {
        match depth {
            BitDepth::One => self.push_bits(bytes),
            _ => self.push_bytes(bytes)?,
        }
        self.row += 1;
        Ok(())
    }

    fn push_bits(&mut self, bytes: &[u8]) {
        let used_bits = self.mask.width() % 64;
        let words = self.mask.row_words_mut(self.row);
        for (word, bytes) in words.iter_mut().zip(bytes.chunks(8)) {
            let mut eight = [0; 8];
            eight[..bytes.len()].copy_from_slice(bytes);
            *word = u64::from_be_bytes(eight).reverse_bits();
        }
        if let Some(last) = words.last_mut().filter(|_| used_bits != 0) {
            *last &= (1 << used_bits) - 1;
        }
    }

    fn push_bytes(&mut self, bytes: &[u8]) -> Result<(), PngError> {
        if self.inside.is_none() {
            self.inside = bytes.iter().copied().find(|&value| value != 0);
        }
        let value = self.inside.unwrap_or(255);
        let is_sound = matches!(value, 1 | 255);
        // Without a branch per pixel: the compiler turns this into vector compares.
        let stray =
            bytes.iter().fold(0, |stray, &byte| stray | (u8::from(byte != 0) & u8::from(byte != value)));
        if !is_sound || stray != 0 {
            return Err(stray_value(self.row, bytes, value));
        }
        for (word, bytes) in self.mask.row_words_mut(self.row).iter_mut().zip(bytes.chunks(64)) {
            *word = pack(bytes);
        }
        Ok(())
    }
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

    fn write(width: u32, height: u32, colour: ColorType, depth: BitDepth, pixels: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        if colour == ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 255, 0, 0]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(pixels).unwrap();
        writer.finish().unwrap();
        file
    }

    fn gray8(width: u32, pixels: &[u8]) -> Vec<u8> {
        let height = pixels.len() as u32 / width;
        write(width, height, ColorType::Grayscale, BitDepth::Eight, pixels)
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
    fn other_kinds_are_refused_with_a_hint() {
        let cases = [
            (ColorType::Indexed, BitDepth::One, vec![0x80], "1-bit with a palette"),
            (ColorType::Indexed, BitDepth::Eight, vec![0, 1], "8-bit with a palette"),
            (ColorType::Grayscale, BitDepth::Sixteen, vec![0, 0, 255, 255], "16-bit grayscale"),
            (ColorType::Grayscale, BitDepth::Two, vec![0], "2-bit grayscale"),
            (ColorType::GrayscaleAlpha, BitDepth::Eight, vec![0; 4], "with alpha"),
            (ColorType::Rgb, BitDepth::Eight, vec![0; 6], "RGB"),
            (ColorType::Rgba, BitDepth::Eight, vec![0; 8], "RGBA"),
        ];
        for (colour, depth, pixels, name) in cases {
            let error = decode(&write(2, 1, colour, depth, &pixels), 2, 1).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
            assert!(error.hint().contains("Pillow"));
        }
    }

    /// A file whose header says 128x96 before the stream of 8192x8192.
    #[test]
    fn a_stream_is_followed_no_further_than_its_picture() {
        let mut bomb = Vec::new();
        let mut encoder = png::Encoder::new(&mut bomb, 8192, 8192);
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_filter(png::Filter::NoFilter);
        encoder.write_header().unwrap().write_image_data(&vec![0; 8192 * 8192]).unwrap();
        bomb[16..24].copy_from_slice(&[0, 0, 0, 128, 0, 0, 0, 96]);
        let checksum = crc32fast::hash(&bomb[12..29]);
        bomb[29..33].copy_from_slice(&checksum.to_be_bytes());
        // What comes before the end of the picture is what a picture of that size would have had.
        assert_eq!(decode(&bomb, 128, 96).unwrap(), Mask::empty(128, 96));
    }

    #[test]
    fn interlaced_masks_are_refused() {
        let mut file = encode(&Mask::full(9, 9));
        file[28] = 1;
        let checksum = crc32fast::hash(&file[12..29]);
        file[29..33].copy_from_slice(&checksum.to_be_bytes());
        let error = decode(&file, 9, 9).unwrap_err().to_string();
        assert!(error.contains("interlaced"), "{error}");
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
