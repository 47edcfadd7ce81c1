//! Pictures at a smaller size: what is flat from close by has a pattern from afar, and planes are fewer.

use crate::view::View;

use super::StereoImage;

/// About the width that pictures are shrunk to, pixels.
const WIDTH: u32 = 128;

/// By which factor pictures of a view are shrunk.
pub(super) fn factor_for(view: &View) -> u32 {
    (view.width() / WIDTH).max(1)
}

/// A picture whose pixels are means of squares of `factor` pixels, and its view; what fills no square is left out.
pub(super) fn shrunk(image: &StereoImage<'_>, factor: u32) -> (View, Vec<[u8; 3]>) {
    let size = [image.view.width() / factor, image.view.height() / factor];
    let by = f64::from(factor);
    let view = View::new(
        size,
        image.view.focal().map(|focal| focal / by),
        image.view.principal().map(|principal| principal / by),
        image.view.camera_from_world(),
    );
    let width = image.view.width();
    let mean = |at: u32| {
        let [column, row] = [at % size[0] * factor, at / size[0] * factor];
        std::array::from_fn(|channel| {
            let square =
                (0..factor * factor).map(|step| (row + step / factor) * width + column + step % factor);
            let sum: u32 = square.map(|pixel| u32::from(image.colour[pixel as usize][channel])).sum();
            (sum / (factor * factor)) as u8
        })
    };
    // A view that can be is one at a smaller size, too.
    (view.unwrap_or(*image.view), (0..size[0] * size[1]).map(mean).collect())
}

/// Squares of `factor` pixels in which any pixel is marked.
pub(super) fn any(marks: &[bool], view: &View, factor: u32) -> Vec<bool> {
    let size = [view.width() / factor, view.height() / factor];
    let mut small = vec![false; (size[0] * size[1]) as usize];
    for at in (0..marks.len() as u32).filter(|at| marks[*at as usize]) {
        let [column, row] = [at % view.width() / factor, at / view.width() / factor];
        if column < size[0] && row < size[1] {
            small[(row * size[0] + column) as usize] = true;
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_picture_shows_the_same_in_the_same_place() {
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let view = View::new([5, 4], [8.0, 8.0], [2.0, 2.0], pose).unwrap();
        let colour: Vec<[u8; 3]> = (0..20).map(|at| [10 * (at % 5), 0, 4]).collect();
        let (small, means) = shrunk(&StereoImage { view: &view, colour: &colour }, 2);
        assert_eq!(
            (small.width(), small.height(), small.focal(), small.principal()),
            (2, 2, [4.0; 2], [1.0; 2])
        );
        assert_eq!(means, [[5, 0, 4], [25, 0, 4], [5, 0, 4], [25, 0, 4]]);
        let mut marks = [false; 20];
        (marks[7], marks[19]) = (true, true);
        // The last column fills no square.
        assert_eq!(any(&marks, &view, 2), [false, true, false, false]);
        assert_eq!(factor_for(&view), 1);
    }
}
