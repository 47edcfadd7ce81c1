//! What is said to a model: messages of text and pictures.

use std::fmt;
use std::sync::Arc;

use imagesize::ImageType;
use l4d_data::digest::sha256_hex;

use crate::error::EndpointError;

/// No side of a picture may be longer, pixels.
const MAX_SIDE: u32 = 16_384;

/// Who says a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Instructions for the whole conversation.
    System,
    /// The one who asks.
    User,
}

impl Role {
    /// As the protocols spell it.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::System => "system",
            Self::User => "user",
        }
    }
}

/// One message: parts in the order in which they are to be read.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Who says it.
    pub role: Role,
    /// Text and pictures, alternating as the writer likes.
    pub parts: Vec<Part>,
}

impl Message {
    /// Instructions for the whole conversation.
    pub fn system(text: impl Into<String>) -> Self {
        Self { role: Role::System, parts: vec![Part::Text(text.into())] }
    }

    /// A question.
    pub fn user(parts: Vec<Part>) -> Self {
        Self { role: Role::User, parts }
    }
}

/// A piece of a message.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// Plain text.
    Text(String),
    /// A picture.
    Image(Image),
}

impl Part {
    /// Plain text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

/// A picture as the exact bytes that are sent. Cheap to clone.
#[derive(Clone, PartialEq)]
pub struct Image {
    bytes: Arc<[u8]>,
    mime: &'static str,
    width: u32,
    height: u32,
    digest: String,
}

impl Image {
    /// Encoded bytes; what they are is read from their header.
    ///
    /// # Errors
    /// If they are no PNG, JPEG or WebP, or a side is longer than 16384 pixels.
    pub fn new(bytes: Vec<u8>) -> Result<Self, EndpointError> {
        let unusable =
            |message: String| EndpointError::not_asked("a picture", message, "send PNG, JPEG or WebP");
        let kind = imagesize::image_type(&bytes).map_err(|error| unusable(error.to_string()))?;
        let mime = match kind {
            ImageType::Png => "image/png",
            ImageType::Jpeg => "image/jpeg",
            ImageType::Webp => "image/webp",
            other => return Err(unusable(format!("is {other:?}, which model servers do not take"))),
        };
        let size = imagesize::blob_size(&bytes).map_err(|error| unusable(error.to_string()))?;
        let side = |pixels: usize| {
            let side = u32::try_from(pixels).ok().filter(|side| (1..=MAX_SIDE).contains(side));
            side.ok_or_else(|| unusable(format!("has a side of {pixels} pixels")))
        };
        let (width, height) = (side(size.width)?, side(size.height)?);
        Ok(Self { digest: sha256_hex(&bytes), bytes: bytes.into(), mime, width, height })
    }

    /// The encoded bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// `image/png`, `image/jpeg` or `image/webp`.
    pub fn mime(&self) -> &'static str {
        self.mime
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// SHA-256 of the encoded bytes.
    pub fn digest(&self) -> &str {
        &self.digest
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mime, width, height, digest, .. } = self;
        write!(formatter, "Image({mime}, {width}x{height}, sha256 {digest})")
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn png(width: u32, height: u32) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(png::ColorType::Grayscale);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&vec![0; (width * height) as usize]).unwrap();
        writer.finish().unwrap();
        file
    }

    #[test]
    fn a_picture_says_what_it_is_by_its_bytes() {
        let image = Image::new(png(12, 7)).unwrap();
        assert_eq!((image.mime(), image.size()), ("image/png", (12, 7)));
        assert_eq!(image.digest(), sha256_hex(image.bytes()));
        assert!(format!("{image:?}").len() < 120);
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let mut huge = png(1, 1);
        huge[16..20].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff]);
        for bytes in [
            Vec::new(),
            b"<html>".to_vec(),
            b"GIF89a\x01\0\x01\0\0\0\0".to_vec(),
            png(1, 1)[..10].to_vec(),
            huge,
        ] {
            assert!(matches!(Image::new(bytes), Err(EndpointError::NotAsked { .. })));
        }
    }
}
