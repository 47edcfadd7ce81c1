//! Test pictures: coloured squares at known places on a grey ground, for measuring where a model sees them.

use image::{Rgb, RgbImage};

use crate::drawn::encode_colour;

const GROUND: Rgb<u8> = Rgb([128; 3]);
const COLOURS: [(&str, Rgb<u8>); 4] = [
    ("red", Rgb([220, 30, 30])),
    ("green", Rgb([20, 160, 40])),
    ("blue", Rgb([30, 60, 220])),
    ("yellow", Rgb([240, 220, 30])),
];
/// Squares are in different cells of a grid with so many rows and columns, so that they never touch.
const GRID: u32 = 3;

/// A square; pixel edges, so that the right and lower ones are `x + side_px` and `y + side_px`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Square {
    /// Its colour in one word.
    pub colour: &'static str,
    /// Left edge, pixels.
    pub x: u32,
    /// Upper edge, pixels.
    pub y: u32,
    /// Width and height, pixels.
    pub side_px: u32,
    paint: Rgb<u8>,
}

/// A picture of squares, one of each colour.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Targets {
    width: u32,
    height: u32,
    squares: Vec<Square>,
}

impl Targets {
    /// No side may be shorter: squares of fewer pixels are hard to see.
    pub const MIN_SIDE: u32 = 96;

    /// The arrangement of that number; sizes below [`Self::MIN_SIDE`] are raised to it.
    pub fn arrange(width: u32, height: u32, number: u32) -> Self {
        let (width, height) = (width.max(Self::MIN_SIDE), height.max(Self::MIN_SIDE));
        let (cell_width, cell_height) = (width / GRID, height / GRID);
        let square = |(index, (colour, paint)): (u32, (&'static str, Rgb<u8>))| {
            // Steps that share no factor with the number of cells visit different cells.
            let cell = (2 * index + 4 * number + 1) % (GRID * GRID);
            let side_px = cell_width.min(cell_height) * (5 + (index + number) % 3) / 10;
            let slack = |cell_side: u32, step: u32| (cell_side - side_px) * (step % 5) / 4;
            Square {
                colour,
                x: cell % GRID * cell_width + slack(cell_width, 3 * index + number),
                y: cell / GRID * cell_height + slack(cell_height, index + 2 * number + 1),
                side_px,
                paint,
            }
        };
        Self { width, height, squares: (0..).zip(COLOURS).map(square).collect() }
    }

    /// One colour everywhere, and its name.
    pub fn plain(width: u32, height: u32) -> (Vec<u8>, &'static str) {
        let (name, paint) = COLOURS[0];
        (encode_colour(&RgbImage::from_pixel(width.max(1), height.max(1), paint)), name)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The squares, one of each colour.
    pub fn squares(&self) -> &[Square] {
        &self.squares
    }

    /// The picture as PNG.
    pub fn png(&self) -> Vec<u8> {
        let mut picture = RgbImage::from_pixel(self.width, self.height, GROUND);
        for square in &self.squares {
            for y in square.y..square.y + square.side_px {
                for x in square.x..square.x + square.side_px {
                    picture.put_pixel(x, y, square.paint);
                }
            }
        }
        encode_colour(&picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_where_they_say_and_never_touch() {
        for (width, height) in [(714, 490), (96, 96), (640, 480), (300, 97), (1, 1)] {
            for number in 0..9 {
                let targets = Targets::arrange(width, height, number);
                let picture = image::load_from_memory(&targets.png()).unwrap().to_rgb8();
                assert_eq!(picture.dimensions(), targets.size());
                for square in targets.squares() {
                    let count = picture.pixels().filter(|pixel| **pixel == square.paint).count() as u32;
                    assert_eq!(count, square.side_px.pow(2), "{square:?} of {number} is covered");
                    let corner = (square.x + square.side_px - 1, square.y + square.side_px - 1);
                    assert_eq!(picture[(square.x, square.y)], square.paint);
                    assert_eq!(picture[corner], square.paint);
                    assert!(square.side_px >= 16);
                }
            }
        }
    }

    #[test]
    fn arrangements_differ() {
        let places = |number| -> Vec<(u32, u32)> {
            Targets::arrange(714, 490, number).squares().iter().map(|square| (square.x, square.y)).collect()
        };
        assert_ne!(places(0), places(1));
        assert_eq!(places(3), places(3));
    }
}
