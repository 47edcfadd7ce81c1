//! Moving pictures for people: all views of a clip side by side, colour above depth, moment after moment.
//!
//! Owns the page and the animated PNG. What else can show a moving picture is the caller's business.

use image::imageops::{replace, thumbnail};
use image::{Rgb, RgbImage};

use crate::quantiles::Quantiles;
use crate::text::{Style, Weight};

const GAP_PX: u32 = 4;
const PAPER: Rgb<u8> = Rgb([24, 24, 26]);
const LABEL: Style = Style { weight: Weight::Semibold, size_px: 13.0, colour: Rgb([255; 3]) };

/// How all pages of one clip are laid out.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    names: Vec<String>,
    columns: u32,
    /// Of one picture on the page, pixels.
    cell: (u32, u32),
    /// Nearest and farthest depth that differ on the picture, metres.
    range_m: (f32, f32),
}

/// What one view shows at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Display colour.
    pub colour: RgbImage,
    /// Planar depth, metres, row-major; +inf where there is none.
    pub depth_m: Vec<f32>,
}

impl Page {
    /// A page for these views, at most about `width_px` wide. `sample_m` are depths of one moment, which set the
    /// greys of all.
    pub fn new(
        names: Vec<String>,
        picture: (u32, u32),
        width_px: u32,
        sample_m: impl IntoIterator<Item = f32>,
    ) -> Self {
        let count = names.len().max(1) as u32;
        let columns = (1..=count).find(|columns| columns * columns >= count).unwrap_or(1);
        let room = (width_px / columns).saturating_sub(GAP_PX).max(1);
        let factor = picture.0.div_ceil(room).max(1);
        let cell = ((picture.0 / factor).max(1), (picture.1 / factor).max(1));
        let mut depths = Quantiles::default();
        sample_m.into_iter().filter(|depth_m| depth_m.is_finite()).for_each(|depth_m| depths.add(depth_m));
        let range_m =
            if depths.count() == 0 { (1.0, 2.0) } else { (depths.quantile(0.02), depths.quantile(0.98)) };
        Self { names, columns, cell, range_m }
    }

    /// Width and height of every page, even numbers of pixels: video codecs want them.
    pub fn size_px(&self) -> (u32, u32) {
        let rows = (self.names.len() as u32).div_ceil(self.columns).max(1);
        let (width, height) = self.cell;
        let page = (self.columns * (width + GAP_PX) + GAP_PX, rows * (2 * height + GAP_PX) + GAP_PX);
        (page.0.next_multiple_of(2), page.1.next_multiple_of(2))
    }

    /// One moment: a cell a view, in the order of the names.
    pub fn draw(&self, cells: &[Cell]) -> RgbImage {
        let (width, height) = self.size_px();
        let mut page = RgbImage::from_pixel(width, height, PAPER);
        for (index, (cell, name)) in cells.iter().zip(&self.names).enumerate() {
            let (column, row) = (index as u32 % self.columns, index as u32 / self.columns);
            let left = GAP_PX + column * (self.cell.0 + GAP_PX);
            let top = GAP_PX + row * (2 * self.cell.1 + GAP_PX);
            let small = |picture: &RgbImage| thumbnail(picture, self.cell.0, self.cell.1);
            replace(&mut page, &small(&cell.colour), left.into(), top.into());
            let grey = self.grey(cell);
            replace(&mut page, &small(&grey), left.into(), (top + self.cell.1).into());
            LABEL.write(&mut page, left as f32 + 4.0, top as f32 + 1.0, name);
        }
        page
    }

    /// Near is light, far is dark, nothing is black; steps are even in 1/z, as they are in what a picture shows.
    fn grey(&self, cell: &Cell) -> RgbImage {
        let (near, far) = (1.0 / self.range_m.0, 1.0 / self.range_m.1);
        let (width, height) = cell.colour.dimensions();
        let mut depths = cell.depth_m.iter();
        RgbImage::from_fn(width, height, |_, _| {
            let depth_m = depths.next().copied().unwrap_or(f32::INFINITY);
            if !depth_m.is_finite() {
                return Rgb([0; 3]);
            }
            let share = ((1.0 / depth_m - far) / (near - far).max(1e-6)).clamp(0.0, 1.0);
            Rgb([(40.0 + 200.0 * share).round() as u8; 3])
        })
    }
}

/// Width and height of a picture made smaller by the whole factor that brings it to about a width, pixels.
pub fn shrunk_size((width, height): (u32, u32), width_px: u32) -> (u32, u32) {
    let factor = width.div_ceil(width_px.max(1)).max(1);
    ((width / factor).max(1), (height / factor).max(1))
}

/// A picture of [`shrunk_size`]; as it is if it is no wider.
pub fn shrunk(picture: RgbImage, width_px: u32) -> RgbImage {
    let (width, height) = shrunk_size(picture.dimensions(), width_px);
    if (width, height) == picture.dimensions() { picture } else { thumbnail(&picture, width, height) }
}

/// Pages as the bytes of an animated PNG that repeats for ever. Browsers play it; what cannot shows the first page.
///
/// None without pages, and if they differ in size.
pub fn animated_png(pages: &[RgbImage], frames_per_second: f64) -> Option<Vec<u8>> {
    let (width, height) = pages.first()?.dimensions();
    if pages.iter().any(|page| page.dimensions() != (width, height)) {
        return None;
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let delay_ms = (1000.0 / frames_per_second.clamp(0.1, 60.0)).round() as u16;
    let written = encoder
        .set_animated(pages.len() as u32, 0)
        .and_then(|()| encoder.set_frame_delay(delay_ms, 1000))
        .and_then(|()| encoder.write_header())
        .and_then(|mut writer| {
            pages.iter().try_for_each(|page| writer.write_image_data(page.as_raw()))?;
            writer.finish()
        });
    written.ok().map(|()| file)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(colour: [u8; 3], depth_m: f32) -> Cell {
        Cell { colour: RgbImage::from_pixel(64, 48, Rgb(colour)), depth_m: vec![depth_m; 64 * 48] }
    }

    #[test]
    fn each_view_has_its_place_with_colour_above_depth() {
        let names = ["a", "b", "c"].map(str::to_owned).to_vec();
        let page = Page::new(names, (64, 48), 1000, [1.0, 4.0, f32::INFINITY]);
        assert_eq!((page.columns, page.size_px()), (2, (140, 204)));
        let drawn =
            page.draw(&[cell([250, 0, 0], 1.0), cell([0, 250, 0], 4.0), cell([0, 0, 250], f32::INFINITY)]);
        let at = |column: u32, row: u32| drawn.get_pixel(4 + 68 * column + 40, 4 + row * 48 + 30).0;
        assert_eq!([at(0, 0), at(1, 0)], [[250, 0, 0], [0, 250, 0]]);
        assert_eq!(at(0, 1), [240; 3], "near is light");
        assert_eq!(at(1, 1), [40; 3], "far is dark");
        assert_eq!(drawn.get_pixel(4 + 40, 4 + 100 + 30).0, [0, 0, 250]);
        assert_eq!(drawn.get_pixel(4 + 40, 4 + 100 + 48 + 30).0, [0; 3], "nothing is black");
    }

    #[test]
    fn large_pictures_are_shrunk_by_whole_factors() {
        let names: Vec<String> = (0..8).map(|index| format!("cam{index:02}")).collect();
        let page = Page::new(names, (640, 480), 700, []);
        assert_eq!(page.columns, 3);
        assert_eq!(page.cell, (213, 160));
        assert!(page.size_px().0 <= 700);
    }

    #[test]
    fn an_animation_has_all_pages() {
        let pages = [[1; 3], [2; 3], [3; 3]].map(|colour| RgbImage::from_pixel(8, 6, Rgb(colour)));
        let file = animated_png(&pages, 12.0).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        assert_eq!(reader.info().animation_control.unwrap().num_frames, 3);
        let mut pixels = vec![0; 8 * 6 * 3];
        for page in &pages {
            reader.next_frame(&mut pixels).unwrap();
            assert_eq!(&pixels, page.as_raw());
        }
        assert_eq!(reader.info().frame_control.unwrap().delay_num, 83);
        assert_eq!(animated_png(&[], 12.0), None);
    }
}
