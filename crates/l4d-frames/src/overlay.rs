//! Outlines and numbers of instances on a picture.

use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, resize};
use image::{Rgb, RgbImage};
use l4d_data::Role;
use l4d_data::scene::Instance;

use crate::frame::Surfaces;
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
const HALO_STRENGTH: f32 = 0.75;
const FAINT_STRENGTH: f32 = 0.6;
const LABEL_PX: f32 = 17.0;
/// Fine outlines survive this quality; a picture of 512x408 has about 50 kB.
const JPEG_QUALITY: u8 = 90;
/// Smaller spots of an instance get an outline but no number, pixels of the drawn picture.
const SMALLEST_LABELLED: usize = 24;
/// Distance from the border at which a number leaves enough of the instance to be seen, pixels.
const ROOM_FOR_LABEL: u32 = 16;

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
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
        .encode_image(picture)
        .expect("a picture of a profile is no wider than JPEG allows, and memory takes every byte");
    bytes
}

/// Draws outlines, then numbers, onto a picture that is `factor` times as large as `surfaces`.
pub fn outline(picture: &mut RgbImage, surfaces: &Surfaces, factor: u32, marks: &[Mark]) {
    let ids = EnlargedIds { surfaces, factor };
    // Halos first, so that none covers the line of a neighbour.
    for row in 0..picture.height() {
        for column in 0..picture.width() {
            if marks.iter().any(|mark| !mark.faint && ids.is_just_outside(column, row, mark.id)) {
                blend(picture, (column as f32, row as f32), HALO, HALO_STRENGTH);
            }
        }
    }
    for row in 0..picture.height() {
        for column in 0..picture.width() {
            let id = ids.at(column, row);
            let Some(mark) = marks.iter().find(|mark| mark.id == id) else { continue };
            let (width, strength) = if mark.faint { (1, FAINT_STRENGTH) } else { (factor.min(2), 1.0) };
            if ids.is_border(column, row, width) {
                blend(picture, (column as f32, row as f32), mark.colour, strength);
            }
        }
    }
    for mark in marks {
        if let Some((x, y)) = label_place(surfaces, mark.id, factor) {
            label(picture, mark, x, y);
        }
    }
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

/// The ids as if each pixel were `factor` pixels wide and high.
struct EnlargedIds<'a> {
    surfaces: &'a Surfaces,
    factor: u32,
}

impl EnlargedIds<'_> {
    fn at(&self, column: u32, row: u32) -> u32 {
        self.surfaces.id[self.surfaces.index(column / self.factor, row / self.factor)]
    }

    fn neighbours(&self, column: u32, row: u32, reach: i64) -> impl Iterator<Item = u32> {
        let (width, height) = (self.surfaces.width * self.factor, self.surfaces.height * self.factor);
        (-reach..=reach).flat_map(move |down| {
            (-reach..=reach).filter_map(move |right| {
                let (x, y) = (i64::from(column) + right, i64::from(row) + down);
                let inside = x >= 0 && y >= 0 && x < i64::from(width) && y < i64::from(height);
                inside.then(|| self.at(x as u32, y as u32))
            })
        })
    }

    /// Whether the pixel belongs to the line of its own instance, which runs along the inside of its border.
    fn is_border(&self, column: u32, row: u32, width: u32) -> bool {
        let id = self.at(column, row);
        self.neighbours(column, row, i64::from(width)).any(|other| other != id)
    }

    fn is_just_outside(&self, column: u32, row: u32, id: u32) -> bool {
        self.at(column, row) != id && self.neighbours(column, row, 1).any(|other| other == id)
    }
}

/// Where the number goes, in pixels of the enlarged picture: onto the pixel of the instance farthest from its
/// border, or above the instance if the number would hide it.
fn label_place(surfaces: &Surfaces, id: u32, factor: u32) -> Option<(f32, f32)> {
    let (width, height) = (surfaces.width as usize, surfaces.height as usize);
    let mut distance: Vec<u32> =
        surfaces.id.iter().map(|&found| if found == id { u32::MAX } else { 0 }).collect();
    let count = distance.iter().filter(|&&distance| distance > 0).count();
    if count * (factor * factor) as usize <= SMALLEST_LABELLED {
        return None;
    }
    // Two sweeps of the city-block distance; outside the picture counts as outside the instance.
    let relax = |distance: &mut Vec<u32>, index: usize, neighbours: [Option<usize>; 2]| {
        for neighbour in neighbours {
            let there = neighbour.map_or(0, |neighbour| distance[neighbour]);
            distance[index] = distance[index].min(there.saturating_add(1));
        }
    };
    for index in 0..width * height {
        if distance[index] > 0 {
            let (column, row) = (index % width, index / width);
            relax(&mut distance, index, [(column > 0).then(|| index - 1), (row > 0).then(|| index - width)]);
        }
    }
    for index in (0..width * height).rev() {
        if distance[index] > 0 {
            let (column, row) = (index % width, index / width);
            let right = (column + 1 < width).then_some(index + 1);
            relax(&mut distance, index, [right, (row + 1 < height).then_some(index + width)]);
        }
    }
    let deepest = distance.iter().copied().max()?;
    let first = distance.iter().position(|&depth| depth == deepest)?;
    let centre = |pixel: usize| (pixel as f32 + 0.5) * factor as f32;
    let place = (centre(first % width), centre(first / width));
    if deepest * factor >= ROOM_FOR_LABEL {
        return Some(place);
    }
    let top = surfaces.id.iter().position(|&found| found == id)? / width;
    Some((place.0, centre(top) - LABEL_PX))
}
