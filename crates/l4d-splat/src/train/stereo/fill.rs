//! Inverse depth where it is not known: carried on from what is, along surfaces of one colour.

use super::agreement::Known;
use super::{StereoImage, difference};

/// Difference of colour that weakens the bond of two neighbours by a factor of e, bytes.
const EDGE: f32 = 6.0;
/// The bond of neighbours of different colours; that of one colour is 1.
const WEAKEST: f32 = 1e-4;
const SWEEPS: usize = 60;
/// Over-relaxation where little is known.
const OVER: f32 = 1.7;
/// What support loses at each pixel, in bonds of one colour: it reaches some 7 pixels.
const LOSS: f32 = 2e-2;
/// Pixels with less support than this are left out.
const LEAST_SUPPORT: f32 = 0.6;

/// Inverse depth of the pixels that are wanted, 1/m, and how well what views share supports it, 0 to 1. The other pixels
/// have no part in it. NaN where nothing is known at all.
pub(super) fn fill(image: &StereoImage<'_>, wanted: &[bool], known: &[Known]) -> (Vec<f32>, Vec<f32>) {
    let bonds = Bonds::new(image, wanted, EDGE);
    let mut inverse = first_guess(wanted, known, image.view.width() as usize);
    bonds.settle(&mut inverse, wanted, |at| (known[at].trust, known[at].inverse), known);
    // Over-relaxation may step across infinity.
    inverse.iter_mut().filter(|inverse| **inverse < 0.0).for_each(|inverse| *inverse = 0.0);
    let share = |known: &Known| f32::from(u8::from(known.is_shared()));
    let mut support: Vec<f32> = known.iter().map(share).collect();
    let own = |at: usize| if known[at].is_shared() { (known[at].trust, 1.0) } else { (LOSS, 0.0) };
    bonds.settle(&mut support, wanted, own, known);
    (inverse, support)
}

/// Leaves out what nothing known supports, unless views share nothing at all.
pub(super) fn leave_out_unsupported(inverse: &mut [f32], support: &[f32]) {
    if support.iter().any(|support| *support > LEAST_SUPPORT) {
        for (inverse, support) in inverse.iter_mut().zip(support) {
            if *support < LEAST_SUPPORT {
                *inverse = f32::NAN;
            }
        }
    }
}

/// What holds neighbours together.
pub(super) struct Bonds {
    width: usize,
    right: Vec<f32>,
    below: Vec<f32>,
}

impl Bonds {
    /// `edge`: the difference of colour that weakens a bond by a factor of e, bytes.
    pub(super) fn new(image: &StereoImage<'_>, wanted: &[bool], edge: f32) -> Self {
        let width = image.view.width() as usize;
        let bond = |at: usize, other: usize| {
            if !wanted[at] || !wanted[other] {
                return 0.0;
            }
            let difference = difference(image.colour[at], image.colour[other]);
            (-f32::from(difference) / edge).exp().max(WEAKEST)
        };
        let right = |at: usize| if (at + 1).is_multiple_of(width) { 0.0 } else { bond(at, at + 1) };
        let below = |at: usize| if at + width < wanted.len() { bond(at, at + width) } else { 0.0 };
        Self {
            width,
            right: (0..wanted.len()).map(right).collect(),
            below: (0..wanted.len()).map(below).collect(),
        }
    }

    /// Lets values become the mean of their neighbours and of what they are by themselves (weight and value).
    pub(super) fn settle(
        &self,
        values: &mut [f32],
        wanted: &[bool],
        own: impl Fn(usize) -> (f32, f32),
        known: &[Known],
    ) {
        for sweep in 0..2 * SWEEPS {
            // Pixels of one colour of a chessboard have neighbours of the other alone.
            let is_turn = |at: &usize| (at % self.width + at / self.width) % 2 == sweep % 2;
            for at in (0..wanted.len()).filter(is_turn).filter(|at| wanted[*at]) {
                let (mut total, value) = own(at);
                let mut sum = total * value;
                for (bond, other) in self.of(at) {
                    if bond > 0.0 && !values[other].is_nan() {
                        sum += bond * values[other];
                        total += bond;
                    }
                }
                if total > 0.0 && !values[at].is_nan() {
                    let by = if known[at].is_shared() { 1.0 } else { OVER };
                    values[at] += by * (sum / total - values[at]);
                }
            }
        }
    }

    /// Neighbours of a pixel, with the strength of their bonds; 0 where there is none.
    fn of(&self, at: usize) -> [(f32, usize); 4] {
        let before = |bonds: &[f32], step: usize| {
            at.checked_sub(step).map_or((0.0, at), |other| (bonds[other], other))
        };
        let after = |bonds: &[f32], step: usize| (bonds[at], (at + step).min(bonds.len() - 1));
        [
            before(&self.right, 1),
            after(&self.right, 1),
            before(&self.below, self.width),
            after(&self.below, self.width),
        ]
    }
}

/// What views share, and means over ever larger blocks of it elsewhere; of anything that is known where they share nothing.
fn first_guess(wanted: &[bool], known: &[Known], width: usize) -> Vec<f32> {
    let has_shared = (0..wanted.len()).any(|at| wanted[at] && known[at].is_shared());
    let is_taken = |known: &Known| if has_shared { known.is_shared() } else { known.trust > 0.0 };
    let mut inverse: Vec<f32> =
        known.iter().map(|known| if is_taken(known) { known.inverse } else { f32::NAN }).collect();
    let height = wanted.len() / width;
    let mut side = 4;
    while side < 4 * width.max(height) {
        let columns = width.div_ceil(side);
        let mut sums = vec![[0.0_f64; 2]; columns * height.div_ceil(side)];
        let block = |at: usize| at / width / side * columns + at % width / side;
        for at in (0..wanted.len()).filter(|&at| wanted[at] && !inverse[at].is_nan()) {
            sums[block(at)][0] += f64::from(inverse[at]);
            sums[block(at)][1] += 1.0;
        }
        let unknown = inverse.iter_mut().enumerate().filter(|(at, inverse)| wanted[*at] && inverse.is_nan());
        for (at, inverse) in unknown {
            let [sum, count] = sums[block(at)];
            if count > 0.0 {
                *inverse = (sum / count) as f32;
            }
        }
        side *= 2;
    }
    for at in (0..wanted.len()).filter(|&at| !wanted[at]) {
        inverse[at] = f32::NAN;
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::super::agreement::SHARED;
    use super::*;
    use crate::view::View;

    #[test]
    fn what_is_known_goes_on_to_where_the_colour_changes() {
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let view = View::new([8, 4], [8.0, 8.0], [4.0, 2.0], pose).unwrap();
        let is_left = |at: usize| at % 8 < 5;
        let colour: Vec<[u8; 3]> =
            (0..32).map(|at| if is_left(at) { [200; 3] } else { [20, 90, 40] }).collect();
        let mut known = [Known::default(); 32];
        known[9] = Known { inverse: 1.0, trust: SHARED };
        known[23] = Known { inverse: 0.25, trust: SHARED };
        let mut wanted = [true; 32];
        wanted[0] = false;
        let (found, _) = fill(&StereoImage { view: &view, colour: &colour }, &wanted, &known);
        assert!(found[0].is_nan(), "not wanted");
        for (at, found) in found.iter().enumerate().skip(1) {
            let expected = if is_left(at) { 1.0 } else { 0.25 };
            assert!((found - expected).abs() < 0.02, "{at}: {found}");
        }
        let (nothing, _) =
            fill(&StereoImage { view: &view, colour: &colour }, &wanted, &[Known::default(); 32]);
        assert!(nothing.iter().all(|inverse| inverse.is_nan()));
    }
}
