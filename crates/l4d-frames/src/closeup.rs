//! A part of a picture at any size, with outlines drawn after scaling: one pixel wide on a grid of character
//! cells, several on a screen, never blurred.

use std::sync::OnceLock;

use glam::{UVec2, Vec2};
use image::Rgb;
use image::imageops::{FilterType, crop_imm, resize};

use crate::overlay::{Mark, label_of_size};
use crate::text::blend;
use l4d_masks::mask::{PixelBox, nearest};

pub use image::RgbImage;

/// The dark half of the double line.
const DARK: Rgb<u8> = Rgb([12, 12, 12]);
const DARK_STRENGTH: f32 = 0.8;
const FAINT_STRENGTH: f32 = 0.6;
/// Farther than any pixel.
const FAR: u32 = u32::MAX / 2;
/// Instances weigh more than what lies around them where several share a pixel: thin things stay whole.
const INSTANCE_WEIGHT: u32 = 2;
/// Straight and diagonal steps of the chamfer distance, in thirds of a pixel.
const STEP: u32 = 3;
const DIAGONAL_STEP: u32 = 4;

/// What a pixel of a closeup belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    None,
    /// The coloured line of a mark.
    Light,
    /// The dark line around it.
    Dark,
}

/// The pixel of an instance that is farthest from its border: where a number hides least.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// Column and row.
    pub pixel: UVec2,
    /// Distance to the border, pixels.
    pub depth: f32,
    /// Topmost row of the instance.
    pub top: u32,
}

/// A scaled part of a picture.
#[derive(Debug, Clone)]
pub struct Closeup {
    picture: RgbImage,
    ids: Vec<u32>,
    strokes: Vec<Stroke>,
    distance: OnceLock<Vec<u32>>,
}

impl Closeup {
    /// Scales `region` of a picture and of its `ids` (row-major) to `size`; sides need not scale alike.
    ///
    /// The region is cut to the picture, and no side of `size` is below one pixel.
    pub fn cut(picture: &RgbImage, ids: &[u32], region: PixelBox, size: UVec2) -> Self {
        let (width, height) = picture.dimensions();
        let first = UVec2::new(region.first_col.min(width - 1), region.first_row.min(height - 1));
        let last = UVec2::new(region.last_col.min(width - 1), region.last_row.min(height - 1)).max(first);
        let extent = last - first + 1;
        let size = size.max(UVec2::ONE);
        let part = crop_imm(picture, first.x, first.y, extent.x, extent.y);
        // Averages when it shrinks, so that thin things do not flicker; stays crisp when it enlarges.
        let grows = size.x > extent.x && size.y > extent.y;
        let filter = if grows { FilterType::CatmullRom } else { FilterType::Triangle };
        let source = IdGrid { ids, width, first, extent };
        Self {
            picture: resize(&*part, size.x, size.y, filter),
            ids: source.scaled(size),
            strokes: vec![Stroke::None; size.x as usize * size.y as usize],
            distance: OnceLock::new(),
        }
    }

    /// [`Self::cut`] of the whole picture.
    pub fn whole(picture: &RgbImage, ids: &[u32], size: UVec2) -> Self {
        let whole = PixelBox { first_col: 0, first_row: 0, last_col: u32::MAX, last_row: u32::MAX };
        Self::cut(picture, ids, whole, size)
    }

    /// What to show.
    pub fn picture(&self) -> &RgbImage {
        &self.picture
    }

    /// What to show, without the rest.
    pub fn into_picture(self) -> RgbImage {
        self.picture
    }

    /// Columns and rows.
    pub fn size(&self) -> UVec2 {
        UVec2::new(self.picture.width(), self.picture.height())
    }

    /// Whether a pixel was drawn over.
    pub fn stroke(&self, column: u32, row: u32) -> Stroke {
        self.index(column, row).map_or(Stroke::None, |index| self.strokes[index])
    }

    /// Turns the picture into shades of grey.
    pub fn remove_colour(&mut self) {
        for pixel in self.picture.pixels_mut() {
            let [red, green, blue] = pixel.0.map(u32::from);
            pixel.0 = [((299 * red + 587 * green + 114 * blue + 500) / 1000) as u8; 3];
        }
    }

    /// Draws double lines around marks, a coloured one and a dark one outside it, each `width_px` wide.
    ///
    /// Lines lie beside the marks, so that small things are not covered by their own outline. Where marks touch
    /// each has its line on its own side. Faint marks have a faint line, and no dark one.
    pub fn outline(&mut self, marks: &[Mark], width_px: impl Fn(&Mark) -> u32) {
        if marks.is_empty() {
            return;
        }
        let widths: Vec<u32> = marks.iter().map(|mark| width_px(mark) * STEP).collect();
        let owner: Vec<Option<usize>> =
            self.ids.iter().map(|&id| marks.iter().position(|mark| mark.id == id)).collect();
        let reach = widths.iter().copied().max().unwrap_or(0) * 2;
        let outside = nearest_mark(&owner, self.size(), reach);
        let to_other = distances(
            self.size(),
            |from, to| owner[to].is_some() && owner[from] != owner[to],
            |from, to| owner[from] == owner[to],
        );
        for index in 0..self.ids.len() {
            let place = ((index as u32 % self.size().x) as f32, (index as u32 / self.size().x) as f32);
            let (distance, mark, to_line) = match (owner[index], outside[index]) {
                (Some(mark), _) => (to_other[index], mark, widths[mark]),
                (None, Some((distance, mark))) => (distance, mark, widths[mark]),
                (None, None) => continue,
            };
            if distance <= to_line {
                let strength = if marks[mark].faint { FAINT_STRENGTH } else { 1.0 };
                blend(&mut self.picture, place, marks[mark].colour, strength);
                self.strokes[index] = Stroke::Light;
            } else if owner[index].is_none() && distance <= 2 * to_line && !marks[mark].faint {
                blend(&mut self.picture, place, DARK, DARK_STRENGTH);
                self.strokes[index] = Stroke::Dark;
            }
        }
    }

    /// Where the number of an instance goes; none if no pixel shows it.
    pub fn anchor(&self, id: u32) -> Option<Anchor> {
        let size = self.size();
        let distance = self.border_distances();
        let depth = |index: usize| {
            let (column, row) = (index as u32 % size.x, index as u32 / size.x);
            let to_edge = (column + 1).min(row + 1).min(size.x - column).min(size.y - row);
            distance[index].min(to_edge * STEP)
        };
        let own = || (0..self.ids.len()).filter(|&index| self.ids[index] == id);
        // The last of equals would sit at the bottom right; the first is as good and cheaper to explain.
        let deepest = own().max_by_key(|&index| (depth(index), std::cmp::Reverse(index)))?;
        let top = own().next()? as u32 / size.x;
        let pixel = UVec2::new(deepest as u32 % size.x, deepest as u32 / size.x);
        Some(Anchor { pixel, depth: depth(deepest) as f32 / STEP as f32, top })
    }

    /// Writes the numbers of the marks onto their instances, or above those that a number would hide.
    pub fn write_numbers(&mut self, marks: &[Mark], letter_px: f32) {
        for mark in marks {
            let Some(anchor) = self.anchor(mark.id) else { continue };
            let mut place = anchor.pixel.as_vec2() + Vec2::splat(0.5);
            if anchor.depth < letter_px * 0.7 {
                place.y = anchor.top as f32 - letter_px * 0.7;
            }
            label_of_size(&mut self.picture, mark, place.x, place.y, letter_px);
        }
    }

    fn index(&self, column: u32, row: u32) -> Option<usize> {
        let size = self.size();
        (column < size.x && row < size.y).then(|| row as usize * size.x as usize + column as usize)
    }

    /// Distance of each pixel to the nearest one with another id, in thirds of a pixel.
    fn border_distances(&self) -> &[u32] {
        let differ = |from: usize, to: usize| self.ids[from] != self.ids[to];
        self.distance.get_or_init(|| distances(self.size(), differ, |from, to| !differ(from, to)))
    }
}

/// Distance of each pixel to the nearest one across a border, in thirds of a pixel. Pixels are indices; distances
/// add up along pixels that are `connected`. The edge of the picture is no border.
fn distances(
    size: UVec2,
    is_border: impl Fn(usize, usize) -> bool,
    connected: impl Fn(usize, usize) -> bool,
) -> Vec<u32> {
    let mut distance = vec![FAR; size.element_product() as usize];
    sweep(size, |index, other, step| {
        let through = if is_border(index, other) {
            step
        } else if connected(index, other) {
            distance[other].saturating_add(step)
        } else {
            FAR
        };
        distance[index] = distance[index].min(through);
    });
    distance
}

/// The mark that is nearest to each pixel that belongs to none, and how far it is, within `reach`.
fn nearest_mark(owner: &[Option<usize>], size: UVec2, reach: u32) -> Vec<Option<(u32, usize)>> {
    let mut nearest: Vec<Option<(u32, usize)>> =
        owner.iter().map(|mark| mark.map(|mark| (0, mark))).collect();
    sweep(size, |index, other, step| {
        if let (None, Some((distance, mark))) = (owner[index], nearest[other]) {
            let through = (distance + step, mark);
            if through.0 <= reach && nearest[index].is_none_or(|known| through < known) {
                nearest[index] = Some(through);
            }
        }
    });
    nearest
}

/// Calls for each pixel and each of its neighbours, forwards and backwards: the two passes of a chamfer distance.
fn sweep(size: UVec2, mut relax: impl FnMut(usize, usize, u32)) {
    const BACKWARDS: [(i64, i64, u32); 4] =
        [(-1, 0, STEP), (0, -1, STEP), (-1, -1, DIAGONAL_STEP), (1, -1, DIAGONAL_STEP)];
    let (width, height) = (i64::from(size.x), i64::from(size.y));
    let mut visit = |index: i64, sign: i64| {
        for (right, down, step) in BACKWARDS {
            let (x, y) = (index % width + sign * right, index / width + sign * down);
            if x >= 0 && y >= 0 && x < width && y < height {
                relax(index as usize, (y * width + x) as usize, step);
            }
        }
    };
    (0..width * height).for_each(|index| visit(index, 1));
    (0..width * height).rev().for_each(|index| visit(index, -1));
}

/// A part of the ids of a picture.
struct IdGrid<'a> {
    ids: &'a [u32],
    width: u32,
    first: UVec2,
    extent: UVec2,
}

impl IdGrid<'_> {
    /// At each target pixel the id that fills most of it.
    fn scaled(&self, size: UVec2) -> Vec<u32> {
        let columns: Vec<(u32, u32)> = (0..size.x).map(|x| span(x, size.x, self.extent.x)).collect();
        let rows = (0..size.y).map(|y| span(y, size.y, self.extent.y));
        let mut counts: Vec<(u32, u32)> = Vec::new();
        let mut scaled = Vec::with_capacity(size.x as usize * size.y as usize);
        for (top, bottom) in rows {
            for &(left, right) in &columns {
                counts.clear();
                for row in self.first.y + top..self.first.y + bottom {
                    let start = row as usize * self.width as usize + self.first.x as usize;
                    for &id in &self.ids[start + left as usize..start + right as usize] {
                        let weight = if id == 0 { 1 } else { INSTANCE_WEIGHT };
                        match counts.iter_mut().find(|(known, _)| *known == id) {
                            Some((_, count)) => *count += weight,
                            None => counts.push((id, weight)),
                        }
                    }
                }
                // Equal counts go to the smaller id, whatever order they were met in.
                let most = counts.iter().max_by_key(|(id, count)| (*count, std::cmp::Reverse(*id)));
                scaled.push(most.map_or(0, |(id, _)| *id));
            }
        }
        scaled
    }
}

/// Source pixels under target pixel `index` of `to`: those that it covers, or the one at its centre.
fn span(index: u32, to: u32, from: u32) -> (u32, u32) {
    let scaled = |position: u64| position * u64::from(from) / u64::from(to);
    if from <= to {
        let centre = nearest(index, from, to);
        return (centre, centre + 1);
    }
    let (first, last) = (scaled(u64::from(index)), scaled(u64::from(index) + 1));
    (first as u32, last as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlay::object_colour;

    const WHOLE: PixelBox = PixelBox { first_col: 0, first_row: 0, last_col: 7, last_row: 5 };

    /// 8x6 pixels, grey; instance 3 fills columns 2 to 5 of rows 1 to 4.
    fn picture() -> (RgbImage, Vec<u32>) {
        let inside = |index: u32| (2..=5).contains(&(index % 8)) && (1..=4).contains(&(index / 8));
        let ids = (0..48).map(|index| if inside(index) { 3 } else { 0 }).collect();
        (RgbImage::from_pixel(8, 6, Rgb([120; 3])), ids)
    }

    fn mark() -> Mark {
        Mark { id: 3, number: 1, colour: object_colour(0), faint: false }
    }

    #[test]
    fn ids_follow_the_region_and_the_size() {
        let (image, all) = picture();
        assert_eq!(Closeup::cut(&image, &all, WHOLE, UVec2::new(8, 6)).ids, all);
        let quarter = PixelBox { first_col: 4, first_row: 3, last_col: 7, last_row: 5 };
        // Columns 4 and 5 of rows 3 and 4 are inside, doubled in width only.
        let row = [3, 3, 3, 3, 0, 0, 0, 0];
        let expected = [row, row, [0; 8]].concat();
        assert_eq!(Closeup::cut(&image, &all, quarter, UVec2::new(8, 3)).ids, expected);
        // Halved: target column 0 covers source columns 0 and 1, and so on.
        let row = [0, 3, 3, 0];
        assert_eq!(Closeup::cut(&image, &all, WHOLE, UVec2::new(4, 3)).ids, [row, row, row].concat());
    }

    #[test]
    fn a_thin_thing_survives_shrinking() {
        let image = RgbImage::new(9, 3);
        let all: Vec<u32> = (0..27).map(|index| u32::from(index % 9 == 4) * 7).collect();
        let whole = PixelBox { first_col: 0, first_row: 0, last_col: 8, last_row: 2 };
        // One column in three with twice the weight: 6 against 6, and 0 is the smaller id; two in three win.
        assert_eq!(Closeup::cut(&image, &all, whole, UVec2::new(3, 1)).ids, [0, 0, 0]);
        assert_eq!(Closeup::cut(&image, &all, whole, UVec2::new(4, 1)).ids, [0, 0, 7, 0]);
    }

    #[test]
    fn a_double_line_runs_around_a_thing_and_leaves_it_alone() {
        let inside = |index: u32| (3..=5).contains(&(index % 9)) && (3..=4).contains(&(index / 9));
        let all: Vec<u32> = (0..72).map(|index| if inside(index) { 3 } else { 0 }).collect();
        let image = RgbImage::from_pixel(9, 8, Rgb([120; 3]));
        let mut closeup =
            Closeup::cut(&image, &all, PixelBox { last_col: 8, last_row: 7, ..WHOLE }, UVec2::new(9, 8));
        closeup.outline(&[mark()], |_| 1);
        let row = |y: u32| (0..9).map(|x| closeup.stroke(x, y)).collect::<Vec<Stroke>>();
        use Stroke::{Dark, Light, None};
        assert_eq!(row(0), [None; 9]);
        // A corner is 4/3 of a pixel away and a knight's move 7/3: beyond one pixel, and beyond two.
        assert_eq!(row(1), [None, None, None, Dark, Dark, Dark, None, None, None]);
        assert_eq!(row(2), [None, None, Dark, Light, Light, Light, Dark, None, None]);
        assert_eq!(row(3), [None, Dark, Light, None, None, None, Light, Dark, None]);
        assert_eq!(closeup.picture().get_pixel(2, 3), &mark().colour);
        assert_eq!(closeup.picture().get_pixel(3, 3), &Rgb([120; 3]));
    }

    #[test]
    fn where_marks_touch_each_has_its_own_line() {
        let all: Vec<u32> = (0..24).map(|index| if index % 6 < 3 { 3 } else { 4 }).collect();
        let image = RgbImage::new(6, 4);
        let mut closeup =
            Closeup::cut(&image, &all, PixelBox { last_col: 5, last_row: 3, ..WHOLE }, UVec2::new(6, 4));
        let other = Mark { id: 4, number: 2, colour: object_colour(1), faint: false };
        closeup.outline(&[mark(), other.clone()], |_| 1);
        let colours = [2, 3].map(|column| *closeup.picture().get_pixel(column, 1));
        assert_eq!(colours, [mark().colour, other.colour]);
        assert_eq!([1, 4].map(|column| closeup.stroke(column, 1)), [Stroke::None; 2]);
    }

    #[test]
    fn the_anchor_is_the_deepest_pixel_and_edges_count() {
        let (image, all) = picture();
        let closeup = Closeup::cut(&image, &all, WHOLE, UVec2::new(8, 6));
        let anchor = closeup.anchor(3).unwrap();
        assert_eq!((anchor.pixel, anchor.depth, anchor.top), (UVec2::new(3, 2), 2.0, 1));
        assert_eq!(closeup.anchor(9), None);
        let left = PixelBox { first_col: 3, first_row: 1, last_col: 5, last_row: 4 };
        // Cut by three edges and open to none: the middle is deepest.
        assert_eq!(
            Closeup::cut(&image, &all, left, UVec2::new(3, 4)).anchor(3).unwrap().pixel,
            UVec2::new(1, 1)
        );
    }

    #[test]
    fn regions_and_sizes_beyond_reason_are_cut() {
        let (image, all) = picture();
        let beyond = PixelBox { first_col: 99, first_row: 99, last_col: 0, last_row: u32::MAX };
        let closeup = Closeup::cut(&image, &all, beyond, UVec2::ZERO);
        assert_eq!(closeup.size(), UVec2::ONE);
    }

    #[test]
    fn numbers_are_written_and_colour_can_go() {
        let (image, all) = picture();
        let mut closeup = Closeup::cut(&image, &all, WHOLE, UVec2::new(160, 120));
        closeup.write_numbers(&[mark()], 17.0);
        assert!(closeup.picture().pixels().any(|pixel| *pixel == mark().colour));
        closeup.remove_colour();
        assert!(closeup.picture().pixels().all(|pixel| pixel[0] == pixel[1] && pixel[1] == pixel[2]));
    }
}
