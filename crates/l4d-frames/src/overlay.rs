//! Outlines and numbers of instances on a picture.

use glam::UVec2;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, resize};
use image::{Rgb, RgbImage};
use l4d_data::Role;
use l4d_data::scene::Instance;

use crate::closeup::Closeup;
use crate::text::{Style, Weight, blend};

/// Okabe and Ito's colours that stay apart for every kind of colour vision, without black; yellow and sky first,
/// since they stand out from most renders.
const OBJECT_COLOURS: [[u8; 3]; 7] = [
    [240, 228, 66],
    [86, 180, 233],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [0, 114, 178],
];
const LANDMARK_COLOUR: [u8; 3] = [225, 225, 225];
const HALO: Rgb<u8> = Rgb([20, 20, 20]);
const LABEL_PX: f32 = 17.0;
/// Fine outlines survive this quality; a picture of 512x408 has about 50 kB.
const JPEG_QUALITY: u8 = 90;

/// Number and colour of an instance on pictures and in the legend.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// Value of the `id` channel.
    pub id: u32,
    /// Short number, from 1.
    pub number: usize,
    /// Outline and label.
    pub colour: Rgb<u8>,
    /// Landmarks have thin, faint outlines: they are many, and no query asks for them.
    pub faint: bool,
}

/// Outline colour of the object at a place in an order; repeats after seven.
pub fn object_colour(place: usize) -> Rgb<u8> {
    Rgb(OBJECT_COLOURS[place % OBJECT_COLOURS.len()])
}

/// Marks of instances in their order; colours repeat after seven objects, numbers do not.
pub fn marks(instances: &[Instance]) -> Vec<Mark> {
    let mut objects = 0;
    let colour_of = |role: Role, objects: &mut usize| match role {
        Role::Landmark => Rgb(LANDMARK_COLOUR),
        Role::Object => {
            *objects += 1;
            object_colour(*objects - 1)
        }
    };
    let mark = |(index, instance): (usize, &Instance)| Mark {
        id: instance.id,
        number: index + 1,
        colour: colour_of(instance.role, &mut objects),
        faint: instance.role == Role::Landmark,
    };
    instances.iter().enumerate().map(mark).collect()
}

/// Enlarges a picture by a whole factor.
pub fn enlarge(picture: &RgbImage, factor: u32) -> RgbImage {
    match factor {
        1 => picture.clone(),
        _ => resize(picture, picture.width() * factor, picture.height() * factor, FilterType::CatmullRom),
    }
}

/// A picture as JPEG, for those who are sent many; the same picture always gives the same bytes.
///
/// # Panics
/// If a side has no pixel or more than 65 535.
pub fn encode_jpeg(picture: &RgbImage) -> Vec<u8> {
    encode_jpeg_of(picture, JPEG_QUALITY)
}

/// [`encode_jpeg`] of another quality, 1 to 100.
pub(crate) fn encode_jpeg_of(picture: &RgbImage, quality: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode_image(picture)
        .expect("a picture of a profile is no wider than JPEG allows, and memory takes every byte");
    bytes
}

/// A picture `factor` times as large, with outlines and numbers of what its `ids` (row-major) mark.
pub fn annotated(picture: &RgbImage, ids: &[u32], factor: u32, marks: &[Mark]) -> RgbImage {
    let size = UVec2::from(picture.dimensions()) * factor;
    let mut closeup = Closeup::whole(picture, ids, size);
    closeup.outline(marks, |mark| if mark.faint { 1 } else { factor.min(2) });
    closeup.write_numbers(marks, LABEL_PX);
    closeup.into_picture()
}

/// Writes the number of a mark on a rounded patch of its colour, centred at a place.
pub fn label(picture: &mut RgbImage, mark: &Mark, x: f32, y: f32) {
    label_of_size(picture, mark, x, y, LABEL_PX);
}

/// [`label`] in letters of another height.
pub fn label_of_size(picture: &mut RgbImage, mark: &Mark, x: f32, y: f32, letter_px: f32) {
    let [red, green, blue] = mark.colour.0.map(f32::from);
    let is_bright = 0.299 * red + 0.587 * green + 0.114 * blue > 110.0;
    let ink = if is_bright { Rgb([0; 3]) } else { Rgb([255; 3]) };
    let style = Style { weight: Weight::Semibold, size_px: letter_px, colour: ink };
    let text = mark.number.to_string();
    let width = style.width_px(&text);
    let radius = letter_px / 2.0;
    let reach = (width / 2.0 - radius / 2.0).max(0.0);
    let x = x.clamp(
        radius + reach + 1.0,
        (picture.width() as f32 - radius - reach - 2.0).max(radius + reach + 1.0),
    );
    let y = y.clamp(radius + 1.0, (picture.height() as f32 - radius - 2.0).max(radius + 1.0));
    patch(picture, (x, y), reach, radius + 1.0, HALO);
    patch(picture, (x, y), reach, radius, mark.colour);
    style.write(picture, x - width / 2.0, y - letter_px / 2.0 - 0.5, &text);
}

/// A capsule: all within `radius` of the horizontal segment of half length `reach`, with soft edges.
fn patch(picture: &mut RgbImage, (x, y): (f32, f32), reach: f32, radius: f32, colour: Rgb<u8>) {
    let span = |centre: f32, half: f32| (centre - half).floor() as i64..=(centre + half).ceil() as i64;
    for row in span(y, radius + 1.0) {
        for column in span(x, reach + radius + 1.0) {
            let dx = ((column as f32 + 0.5 - x).abs() - reach).max(0.0);
            let dy = row as f32 + 0.5 - y;
            let coverage = radius + 0.5 - dx.hypot(dy);
            if coverage > 0.0 {
                blend(picture, (column as f32, row as f32), colour, coverage);
            }
        }
    }
}
