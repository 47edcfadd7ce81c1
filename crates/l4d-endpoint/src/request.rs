//! A question to a model, free of any server's spelling: messages of text and pictures.

use std::fmt;
use std::sync::Arc;

use imagesize::ImageType;
use l4d_data::digest::sha256_hex;
use serde_json::Value;

use crate::error::EndpointError;

/// No side of a picture may be longer, pixels.
const MAX_SIDE: usize = 16_384;

#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The conversation so far; the last message is the question.
    pub messages: Vec<Message>,
    /// The shape of the answer. Servers that ignore it get the question all the same.
    pub schema: Option<Schema>,
    /// 0 for the likeliest answer; `None` leaves it to the server.
    pub temperature: Option<f64>,
    /// Seed of the sampling; not every server knows one.
    pub seed: Option<u32>,
    /// Longest answer, tokens, thinking included.
    pub max_tokens: u32,
    /// Asks the very same thing once more instead of taking the kept answer: part of the cache key, not of what
    /// is sent.
    pub repeat: u32,
}

impl Request {
    /// A question with the defaults of the project: temperature 0, seed 0, 1024 tokens, no schema.
    pub fn new(messages: Vec<Message>) -> Self {
        Self { messages, schema: None, temperature: Some(0.0), seed: Some(0), max_tokens: 1024, repeat: 0 }
    }

    /// With a schema.
    #[must_use]
    pub fn with_schema(self, schema: Schema) -> Self {
        Self { schema: Some(schema), ..self }
    }

    /// With another limit of the answer.
    #[must_use]
    pub fn with_max_tokens(self, max_tokens: u32) -> Self {
        Self { max_tokens, ..self }
    }

    /// All pictures, in order.
    pub fn images(&self) -> impl Iterator<Item = &Image> {
        self.messages.iter().flat_map(|message| &message.parts).filter_map(|part| match part {
            Part::Image(image) => Some(image),
            Part::Text(_) => None,
        })
    }
}

/// A JSON Schema of the answer. Servers in strict mode want an object at the root, every property required and
/// `additionalProperties: false`, and no `anyOf`.
#[derive(Debug, Clone, PartialEq)]
pub struct Schema {
    pub(crate) name: &'static str,
    pub(crate) value: Value,
}

impl Schema {
    /// A schema under a name of letters, digits, `_` and `-`.
    pub fn new(name: &'static str, value: Value) -> Self {
        Self { name, value }
    }
}

/// One message: parts in the order in which they are to be read.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Who says it, as the protocol spells it.
    pub(crate) role: &'static str,
    /// Text and pictures, alternating as the writer likes.
    pub parts: Vec<Part>,
}

impl Message {
    /// Instructions for the whole conversation.
    pub fn system(text: &str) -> Self {
        Self { role: "system", parts: vec![Part::text(text)] }
    }

    pub fn user(parts: Vec<Part>) -> Self {
        Self { role: "user", parts }
    }
}

/// A piece of a message.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    Text(String),
    Image(Image),
}

impl Part {
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

/// A picture as the exact bytes that are sent. Cheap to clone.
#[derive(Clone, PartialEq)]
pub struct Image {
    bytes: Arc<[u8]>,
    mime: &'static str,
    size: (u32, u32),
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
        if [size.width, size.height].iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
            return Err(unusable(format!("has {}x{} pixels", size.width, size.height)));
        }
        let size = (size.width as u32, size.height as u32);
        Ok(Self { digest: sha256_hex(&bytes), bytes: bytes.into(), mime, size })
    }

    /// The encoded bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// `image/png`, `image/jpeg` or `image/webp`.
    pub(crate) fn mime(&self) -> &'static str {
        self.mime
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// SHA-256 of the encoded bytes.
    pub fn digest(&self) -> &str {
        &self.digest
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mime, size: (width, height), digest, .. } = self;
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
    fn a_picture_says_what_it_is_by_its_bytes_and_others_are_refused() {
        let image = Image::new(png(12, 7)).unwrap();
        assert_eq!((image.mime(), image.size()), ("image/png", (12, 7)));
        assert!(format!("{image:?}").len() < 120, "a picture in a log would flood it");
        let mut huge = png(1, 1);
        huge[16..20].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff]);
        let gif = b"GIF89a\x01\0\x01\0\0\0\0".to_vec();
        for bytes in [Vec::new(), b"<html>".to_vec(), gif, png(1, 1)[..10].to_vec(), huge] {
            assert!(matches!(Image::new(bytes), Err(EndpointError::NotAsked { .. })));
        }
    }
}
