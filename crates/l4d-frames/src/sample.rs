//! A frame as a released sample: what a training loop reads with any decoder of PNG, and from which the frame comes back.
//!
//! Colour is what a screen shows, 8 bits a channel. Depth is 16 bits, linear, with a scale of its own in each picture;
//! what those 16 bits leave out is a picture of its own, so that depth comes back to the last bit. A frame made from a
//! sample shows the same colours, and has the same depths and ids, so that the digests of its scene hold.

use std::path::Path;

use glam::UVec2;
use half::f16;
use image::DynamicImage;
use l4d_data::timeline::FPS;
use l4d_data::{Camera, DataError, Name, Profile, Scene, Split, json};
use serde::{Deserialize, Serialize};

use crate::display::Display;
use crate::drawn::{decode_colour, encode, encode_colour};
use crate::exr::decode_frame;
use crate::frame::{Frame, Surfaces};
use crate::photo::{PhotoError, decode_sized};

/// Schema tag of a sample.
const SCHEMA: &str = "l4d/sample/1";
/// Its members: what follows the key and a dot in the name of a file.
pub const CARD: &str = "json";
/// Colours as a screen shows them.
pub const COLOUR: &str = "png";
/// Depth in units of [`SampleCard::depth_scale_m`]; 0 where nothing is hit.
pub const DEPTH: &str = "depth.png";
/// What [`DEPTH`] leaves out.
pub const DEPTH_REST: &str = "depth_rest.png";
pub const IDS: &str = "ids.png";

const HINT: &str = "fetch the file again, or read it with the l4d that made the release";

/// Where and when a picture was taken: `<key>.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleCard {
    /// `l4d/sample/1`.
    pub schema: String,
    pub scene: Name,
    pub view: Name,
    /// Whether methods may train on the view.
    pub split: Split,
    pub profile: Profile,
    /// Canonical frame.
    pub frame: u32,
    /// When that is, from the start of the scene.
    pub seconds: f64,
    /// Columns, pixels.
    pub width: u32,
    /// Rows, pixels.
    pub height: u32,
    /// Factor on linear light before it is shown.
    pub exposure: f64,
    /// Focal length along columns, pixels.
    pub fx: f64,
    /// Focal length along rows, pixels.
    pub fy: f64,
    /// Principal point, column, pixels.
    pub cx: f64,
    /// Principal point, row, pixels.
    pub cy: f64,
    /// Pose at that frame, row-major 4x4, metres.
    pub world_from_camera: [f64; 16],
    /// Metres in a unit of the depth picture.
    pub depth_scale_m: f32,
}

/// The members of the sample that the bytes of a frame are, each with its suffix, sorted by it.
///
/// # Errors
/// Bytes that are no frame of the scene.
pub fn members(
    scene: &Scene,
    camera: &Camera,
    frame: u32,
    path: &Path,
    bytes: &[u8],
) -> Result<Vec<(&'static str, Vec<u8>)>, DataError> {
    let seen = decode_frame(path, bytes, UVec2::new(scene.width, scene.height))?;
    let Surfaces { width, height, depth_m, id } = &seen.surfaces;
    let depth_scale_m = scale(depth_m);
    let (units, rest): (Vec<[u8; 2]>, Vec<[u8; 4]>) = depth_m
        .iter()
        .map(|&depth_m| {
            let (units, rest) = split(depth_m, depth_scale_m);
            (units.to_be_bytes(), rest.to_be_bytes())
        })
        .unzip();
    let card = SampleCard {
        schema: SCHEMA.to_owned(),
        scene: scene.name.clone(),
        view: camera.name.clone(),
        split: camera.split,
        profile: scene.profile,
        frame,
        seconds: f64::from(frame) / FPS,
        width: *width,
        height: *height,
        exposure: scene.exposure,
        fx: camera.fx,
        fy: camera.fy,
        cx: camera.cx,
        cy: camera.cy,
        world_from_camera: l4d_data::camera::rows(camera.world_from_camera(frame)),
        depth_scale_m,
    };
    let grey = |samples: &[u8], depth| encode(*width, *height, png::ColorType::Grayscale, depth, samples);
    let ids = match u8::try_from(id.iter().copied().max().unwrap_or(0)) {
        Ok(_) => grey(&id.iter().map(|&id| id as u8).collect::<Vec<u8>>(), png::BitDepth::Eight),
        // Ids end at 32767: `Scene` refuses others.
        Err(_) => grey(
            id.iter().map(|&id| (id as u16).to_be_bytes()).collect::<Vec<_>>().as_flattened(),
            png::BitDepth::Sixteen,
        ),
    };
    let rest = rest.as_flattened();
    Ok(vec![
        (DEPTH, grey(units.as_flattened(), png::BitDepth::Sixteen)),
        (DEPTH_REST, encode(*width, *height, png::ColorType::GrayscaleAlpha, png::BitDepth::Sixteen, rest)),
        (IDS, ids),
        (CARD, json::compact(path, &card)?),
        (COLOUR, encode_colour(&Display::new(scene.exposure).picture(&seen))),
    ])
}

/// The card of a sample; `path` names it in messages.
///
/// # Errors
/// Bytes that are no such card.
pub fn card(path: &Path, bytes: &[u8]) -> Result<SampleCard, DataError> {
    let card: SampleCard = json::parse(path, None, bytes)?;
    if card.schema != SCHEMA {
        let message = format!("is `{}`, but this l4d reads `{SCHEMA}`", card.schema);
        return Err(DataError::invalid(path, "field `schema`", message, HINT));
    }
    Ok(card)
}

/// The frame of a sample, from its card and what `member` gives for a suffix; without ids all of them are 0.
///
/// # Errors
/// A member that is missing or no picture of the sample's size.
pub fn frame_of<'a>(
    path: &Path,
    card: &SampleCard,
    light: &Light,
    member: impl Fn(&str) -> Option<&'a [u8]>,
) -> Result<Frame, DataError> {
    let (width, height) = (card.width, card.height);
    let wanted = |suffix: &str| {
        let message = format!("has no .{suffix}");
        member(suffix).ok_or_else(|| DataError::invalid(path, "sample", message, HINT))
    };
    let broken = |suffix: &str, error: PhotoError| {
        DataError::invalid(path, format!(".{suffix}"), error.to_string(), HINT)
    };
    let colour = decode_colour(wanted(COLOUR)?, width, height).map_err(|error| broken(COLOUR, error))?;
    let depth_m = depth(wanted(DEPTH)?, Some(wanted(DEPTH_REST)?), [width, height], card.depth_scale_m)
        .map_err(|error| broken(DEPTH, error))?;
    let id = match member(IDS) {
        Some(bytes) => ids(bytes, [width, height]).map_err(|error| broken(IDS, error))?,
        None => vec![0; depth_m.len()],
    };
    let rgb = colour.as_raw().as_chunks::<3>().0;
    let rgb = rgb.iter().map(|pixel| pixel.map(|byte| light.0[usize::from(byte)])).collect();
    Ok(Frame { surfaces: Surfaces { width, height, depth_m, id }, rgb })
}

/// Depths in metres, +inf where nothing is hit: to the last bit with `rest`, else as near as 16 bits are.
///
/// # Errors
/// Bytes that are no such pictures of that size.
pub fn depth(
    bytes: &[u8],
    rest: Option<&[u8]>,
    [width, height]: [u32; 2],
    scale_m: f32,
) -> Result<Vec<f32>, PhotoError> {
    let DynamicImage::ImageLuma16(units) = decode_sized(bytes, (width, height))? else {
        return Err(PhotoError::OtherKind);
    };
    let Some(rest) = rest else {
        return Ok(units.iter().map(|&units| join(units, 0, scale_m)).collect());
    };
    let DynamicImage::ImageLumaA16(rest) = decode_sized(rest, (width, height))? else {
        return Err(PhotoError::OtherKind);
    };
    let rest = rest.as_raw().as_chunks::<2>().0;
    let rest = rest.iter().map(|&[high, low]| u32::from(high) << 16 | u32::from(low));
    Ok(units.iter().zip(rest).map(|(&units, rest)| join(units, rest, scale_m)).collect())
}

/// Instance ids from the bytes of their picture.
///
/// # Errors
/// Bytes that are no such picture of that size.
pub fn ids(bytes: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u32>, PhotoError> {
    match decode_sized(bytes, (width, height))? {
        DynamicImage::ImageLuma8(ids) => Ok(ids.iter().map(|&id| u32::from(id)).collect()),
        DynamicImage::ImageLuma16(ids) => Ok(ids.iter().map(|&id| u32::from(id)).collect()),
        _ => Err(PhotoError::OtherKind),
    }
}

/// Linear light that shows as each byte at one exposure.
#[derive(Debug, Clone)]
pub struct Light([f16; 256]);

impl Light {
    /// At an exposure as in `scene.json`.
    pub fn new(exposure: f64) -> Self {
        let display = Display::new(exposure);
        let mut spans: [Option<(u16, u16)>; 256] = [None; 256];
        // Half floats that are not negative ascend with their bits, and so do the bytes that they show as.
        for bits in 0..f16::INFINITY.to_bits() {
            let span = &mut spans[usize::from(display.byte(f16::from_bits(bits)))];
            *span = Some((span.map_or(bits, |(first, _)| first), bits));
        }
        let mut light = [f16::ZERO; 256];
        for (byte, span) in spans.into_iter().enumerate() {
            light[byte] = match (byte, span) {
                (0, _) | (_, None) => f16::ZERO,
                // How much brighter it was than the screen can show is not known.
                (255, Some((first, _))) => f16::from_bits(first),
                (_, Some((first, last))) => f16::from_bits(first.midpoint(last)),
            };
        }
        Self(light)
    }
}

/// Metres in a unit, so that the farthest depth is the largest of 16 bits.
fn scale(depth_m: &[f32]) -> f32 {
    let farthest_m = depth_m.iter().copied().filter(|depth_m| depth_m.is_finite()).fold(0.0, f32::max);
    let scale_m = farthest_m / f32::from(u16::MAX);
    if scale_m.is_normal() { scale_m } else { 1.0 }
}

/// A depth as units, and as how many floats the units miss it by, small numbers for small ones of either sign.
fn split(depth_m: f32, scale_m: f32) -> (u16, u32) {
    if !depth_m.is_finite() {
        return (0, 0);
    }
    let units = (depth_m / scale_m).round().clamp(1.0, f32::from(u16::MAX)) as u16;
    let missed = depth_m.to_bits().wrapping_sub((f32::from(units) * scale_m).to_bits()).cast_signed();
    (units, ((missed << 1) ^ (missed >> 31)).cast_unsigned())
}

fn join(units: u16, rest: u32, scale_m: f32) -> f32 {
    if units == 0 {
        return f32::INFINITY;
    }
    let missed = (rest >> 1) ^ (rest & 1).wrapping_neg();
    f32::from_bits((f32::from(units) * scale_m).to_bits().wrapping_add(missed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_depth_comes_back_to_the_last_bit() {
        let none = f32::INFINITY;
        let depths =
            [f32::MIN_POSITIVE, 1e-30, 0.1, 1.0, 1.234_567_9, 77.7, 1234.5, 65_535.0, f32::MAX, none];
        for farthest_m in [1e-30, 0.5, 100.0, 1e30] {
            for depth_m in depths {
                let scale_m = scale(&[farthest_m, none]);
                let (units, rest) = split(depth_m, scale_m);
                assert_eq!(join(units, rest, scale_m).to_bits(), depth_m.to_bits(), "{depth_m} {farthest_m}");
            }
        }
        // What most have to say is small, so that it takes little room.
        assert!(split(50.0, scale(&[100.0])).1 < 1 << 12);
        assert_eq!(scale(&[none]), 1.0);
    }

    #[test]
    fn light_shows_as_the_byte_that_it_came_from() {
        for exposure in [0.25, 1.0, 3.7] {
            let (light, display) = (Light::new(exposure), Display::new(exposure));
            for byte in 0..=255_u8 {
                assert_eq!(display.byte(light.0[usize::from(byte)]), byte, "{exposure}");
            }
        }
    }
}
