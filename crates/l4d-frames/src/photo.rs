//! Pictures that others took or drew: PNG and JPEG of any kind as display colours.
//!
//! Sizes are read before room is made; a picture that breaks off is an error, never a picture with a grey end.

use std::io::Cursor;

use image::error::ImageError;
use image::{DynamicImage, ImageFormat, ImageReader, RgbImage};
use l4d_masks::mask::Mask;

/// Why bytes are no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PhotoError {
    /// Neither PNG nor JPEG.
    #[error("is neither PNG nor JPEG")]
    Kind,
    /// Other samples than were asked for.
    #[error("is a picture of another kind")]
    OtherKind,
    /// Another size than was asked for.
    #[error("is {}x{} pixels, but {}x{} are expected", found.0, found.1, expected.0, expected.1)]
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
    /// Cut off or broken.
    #[error("is damaged: {0}")]
    Damaged(String),
}

/// Width and height, pixels, from the header alone.
///
/// # Errors
/// Bytes that are no PNG or JPEG, or have no sane size.
pub fn size(bytes: &[u8]) -> Result<(u32, u32), PhotoError> {
    let found = reader(bytes)?.into_dimensions().map_err(damaged)?;
    if Mask::is_sane_size(found.0, found.1) { Ok(found) } else { Err(PhotoError::AbsurdSize { found }) }
}

/// Decodes a picture. Transparency is dropped, 16 bits become 8.
///
/// # Errors
/// Bytes that are no PNG or JPEG, or have no sane size.
pub fn decode(bytes: &[u8]) -> Result<RgbImage, PhotoError> {
    size(bytes)?;
    Ok(load(bytes)?.into_rgb8())
}

/// The picture of exactly that size in bytes, whatever its samples.
pub(crate) fn decode_sized(bytes: &[u8], expected: (u32, u32)) -> Result<DynamicImage, PhotoError> {
    let found = size(bytes)?;
    if found == expected { load(bytes) } else { Err(PhotoError::Size { found, expected }) }
}

fn load(bytes: &[u8]) -> Result<DynamicImage, PhotoError> {
    if !ends_well(bytes) {
        return Err(PhotoError::Damaged("it breaks off".to_owned()));
    }
    reader(bytes)?.decode().map_err(damaged)
}

fn reader(bytes: &[u8]) -> Result<ImageReader<Cursor<&[u8]>>, PhotoError> {
    let reader = ImageReader::new(Cursor::new(bytes));
    let reader = reader.with_guessed_format().map_err(|error| PhotoError::Damaged(error.to_string()))?;
    match reader.format() {
        Some(ImageFormat::Png | ImageFormat::Jpeg) => Ok(reader),
        _ => Err(PhotoError::Kind),
    }
}

fn damaged(error: ImageError) -> PhotoError {
    PhotoError::Damaged(error.to_string())
}

/// Decoders fill what a cut file lacks; only its end mark tells. Some programs write a few bytes after it.
fn ends_well(bytes: &[u8]) -> bool {
    let tail = &bytes[bytes.len().saturating_sub(4096)..];
    let mark: &[u8] = if bytes.starts_with(b"\x89PNG") { b"IEND\xae\x42\x60\x82" } else { b"\xff\xd9" };
    tail.windows(mark.len()).any(|window| window == mark)
}

#[cfg(test)]
mod tests {
    use image::{Rgb, Rgba, RgbaImage};

    use super::*;

    fn encoded(format: ImageFormat, picture: &image::DynamicImage) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn png_and_jpeg_are_read_whatever_their_kind() {
        let clear: image::DynamicImage = RgbaImage::from_pixel(5, 4, Rgba([10, 200, 30, 128])).into();
        let read = decode(&encoded(ImageFormat::Png, &clear)).unwrap();
        assert_eq!((read.dimensions(), *read.get_pixel(4, 3)), ((5, 4), Rgb([10, 200, 30])));
        let grey: image::DynamicImage = image::GrayImage::from_pixel(9, 8, image::Luma([77])).into();
        let read = decode(&encoded(ImageFormat::Jpeg, &grey)).unwrap();
        assert_eq!(read.dimensions(), (9, 8));
        assert!(read.get_pixel(3, 3).0.iter().all(|&value| value.abs_diff(77) < 3));
    }

    #[test]
    fn cut_pictures_are_errors_at_every_length() {
        let noise = RgbImage::from_fn(32, 16, |x, y| Rgb([(x * 7 + y * 13) as u8, (x * y) as u8, x as u8]));
        for format in [ImageFormat::Png, ImageFormat::Jpeg] {
            let whole = encoded(format, &noise.clone().into());
            assert!(decode(&whole).is_ok());
            for length in 0..whole.len() {
                assert!(decode(&whole[..length]).is_err(), "{length} bytes of {format:?} passed");
            }
        }
    }

    #[test]
    fn other_kinds_and_absurd_sizes_are_refused() {
        assert_eq!(decode(b"GIF89a\0\0\0\0"), Err(PhotoError::Kind));
        let mut file = encoded(ImageFormat::Png, &RgbImage::new(4, 4).into());
        file[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
        assert!(size(&file).is_err() && decode(&file).is_err());
    }
}
