//! Outlines to masks. The rule of drawing is part of a protocol: on small discs the rules differ by a fifth in IoU.

use l4d_frames::Mask;
use serde::{Deserialize, Serialize};

/// Which pixels belong to an outline.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Raster {
    /// As LangSplat draws its annotations (`cv2.fillPoly` of truncated coordinates): corners lose their fraction, and
    /// the border belongs to the inside. Larger than the outline by half a pixel all around.
    #[default]
    FillPoly,
    /// Pixels whose centre lies inside.
    Centres,
}

/// Corners of an outline.
const MOST_CORNERS: usize = 1 << 16;

/// The inside of an outline by the even-odd rule. None if it has too many corners or one that is no number.
pub fn fill(corners: &[[f64; 2]], width: u32, height: u32, raster: Raster) -> Option<Mask> {
    let is_sound = corners.len() <= MOST_CORNERS && corners.iter().flatten().all(|number| number.is_finite());
    is_sound.then(|| match raster {
        Raster::FillPoly => fill_poly(corners, width, height),
        Raster::Centres => {
            let mut mask = Mask::empty(width, height);
            scan(corners, 0.5, &mut mask);
            mask
        }
    })
}

fn fill_poly(corners: &[[f64; 2]], width: u32, height: u32) -> Mask {
    // Farther away than any picture is large makes no difference, and keeps whole numbers small.
    let far = f64::from(Mask::MAX_SIDE) * 4.0;
    let whole: Vec<[f64; 2]> =
        corners.iter().map(|corner| corner.map(|number| number.clamp(-far, far).trunc())).collect();
    let mut mask = Mask::empty(width, height);
    scan(&whole, 0.0, &mut mask);
    for (from, to) in whole.iter().zip(whole.iter().cycle().skip(1)) {
        line(*from, *to, &mut mask);
    }
    mask
}

/// Pixels `(col + offset, row + offset)` with an odd number of edges to their left.
fn scan(corners: &[[f64; 2]], offset: f64, mask: &mut Mask) {
    let (width, height) = mask.size();
    let mut crossings = Vec::new();
    for row in 0..height {
        let y = f64::from(row) + offset;
        crossings.clear();
        for ([x0, y0], [x1, y1]) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            if (*y0 <= y) != (*y1 <= y) {
                crossings.push(x0 + (y - y0) / (y1 - y0) * (x1 - x0));
            }
        }
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let first = (pair[0] - offset).ceil().clamp(0.0, f64::from(width)) as u32;
            let end = (pair[1] - offset).ceil().clamp(0.0, f64::from(width)) as u32;
            (first..end).for_each(|col| mask.set(col, row, true));
        }
    }
}

/// A line between whole corners, a pixel a step along its longer side.
fn line([x0, y0]: [f64; 2], [x1, y1]: [f64; 2], mask: &mut Mask) {
    let steps = (x1 - x0).abs().max((y1 - y0).abs());
    for step in 0..=steps as u64 {
        let share = if steps > 0.0 { step as f64 / steps } else { 0.0 };
        let (x, y) = ((x0 + share * (x1 - x0)).round(), (y0 + share * (y1 - y0)).round());
        if x >= 0.0 && y >= 0.0 && x < f64::from(mask.width()) && y < f64::from(mask.height()) {
            mask.set(x as u32, y as u32, true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(corners: &[[f64; 2]], raster: Raster) -> Vec<String> {
        let mask = fill(corners, 6, 5, raster).unwrap();
        let row = |row| (0..6).map(|col| if mask.get(col, row) { '#' } else { '.' }).collect();
        (0..5).map(row).collect()
    }

    #[test]
    fn a_square_with_and_without_its_border() {
        let square = [[1.0, 1.0], [4.9, 1.0], [4.9, 3.9], [1.0, 3.9]];
        assert_eq!(drawn(&square, Raster::FillPoly), ["......", ".####.", ".####.", ".####.", "......"]);
        let square = [[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.0]];
        assert_eq!(drawn(&square, Raster::Centres), ["......", ".###..", ".###..", "......", "......"]);
    }

    #[test]
    fn outlines_beyond_the_picture_are_cut() {
        let all = [[-1e12, -1e12], [1e12, -1e12], [1e12, 1e12], [-1e12, 1e12]];
        for raster in [Raster::FillPoly, Raster::Centres] {
            assert_eq!(fill(&all, 6, 5, raster).unwrap().area(), 30);
        }
        assert_eq!(fill(&[[f64::NAN, 0.0]], 6, 5, Raster::Centres), None);
        assert!(fill(&[], 6, 5, Raster::FillPoly).unwrap().is_empty());
    }

    #[test]
    fn a_single_corner_is_a_pixel_and_two_are_a_line() {
        assert_eq!(drawn(&[[2.7, 1.2]], Raster::FillPoly)[1], "..#...");
        assert_eq!(drawn(&[[0.0, 2.0], [5.0, 2.0]], Raster::FillPoly)[2], "######");
    }
}
