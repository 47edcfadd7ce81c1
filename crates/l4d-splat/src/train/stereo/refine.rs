//! Depths between the planes of a sweep, on slanted patches: each pixel tries the planes that its neighbours found, then
//! small changes of its own (Bleyer et al. 2011).

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::super::pinhole::Pinhole;
use super::cost::{DEAREST, Other, better_half, brightness, cost_of_window};
use super::planes::ScenePlane;
use super::{NEIGHBOURS, PlaneSweep, StereoImage, depth_m};

/// Half the side of a patch, pixels.
const RADIUS: i32 = 2;
/// Difference of brightness that takes a pixel out of a patch by a factor of e, bytes.
const EDGE: f32 = 12.0;
/// Dearer patches are none, bytes.
const WORST: f32 = 14.0;
/// Passes over the picture, each from the other corner.
const PASSES: i32 = 4;
/// Change of slope that is tried with a change of depth of 1.
const TURN: f32 = 0.3;
/// A patch is left for one that costs so much less, bytes.
const GAIN: f32 = 0.25;

/// A plane in the picture: inverse depth, 1/m, at the centre of a pixel, and its change a column and a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Patch {
    pub(super) inverse: f32,
    pub(super) slope: [f32; 2],
}

impl Patch {
    fn of_plane(plane: &ScenePlane, pinhole: &Pinhole, pixel: usize) -> Option<Self> {
        let [u, v] = pinhole.centre_of(pixel);
        let inverse = plane.inverse(pinhole, [u, v])?;
        let right = plane.inverse(pinhole, [u + 1.0, v])?;
        let below = plane.inverse(pinhole, [u, v + 1.0])?;
        Some(Self { inverse, slope: [right - inverse, below - inverse] })
    }

    fn at(&self, [dx, dy]: [f32; 2]) -> Self {
        Self { inverse: self.inverse + self.slope[0] * dx + self.slope[1] * dy, ..*self }
    }
}

/// What is known at a smaller size.
pub(super) struct Hints<'a> {
    pub(super) images: &'a [StereoImage<'a>],
    /// Inverse depth by view, 1/m; NaN where nothing is known.
    pub(super) known: &'a [Vec<f32>],
    /// The view that is refined.
    pub(super) of: usize,
    /// How many times smaller.
    pub(super) factor: u32,
    /// Planes that each pixel tries.
    pub(super) planes: &'a [ScenePlane],
}

/// Planar depths, metres, from what is known at a smaller size: +inf too far to tell, NaN unknown or not wanted.
pub(super) fn refine(
    image: &StereoImage<'_>,
    others: &[StereoImage<'_>],
    sweep: &PlaneSweep,
    wanted: &[bool],
    hints: &Hints<'_>,
) -> Vec<f32> {
    let width = image.view.width() as usize;
    let others: Vec<Other<'_>> = others.iter().map(|other| Other::new(image.view, other)).collect();
    let own: Vec<f32> = image.colour.iter().map(|colour| brightness(colour.map(f32::from))).collect();
    let pinhole = Pinhole::new(image.view);
    let matcher = Matcher { own: &own, size: [width, wanted.len() / width], pinhole, others: &others };
    let mut search = Search {
        best: vec![None; wanted.len()],
        costs: vec![f32::from(DEAREST); wanted.len()],
        random: ChaCha8Rng::seed_from_u64(hints.of as u64),
        step: sweep.step,
        matcher,
    };
    for pixel in (0..wanted.len()).filter(|pixel| wanted[*pixel]) {
        search.best[pixel] = hints.patch(pixel, width, sweep.step);
        search.costs[pixel] =
            search.best[pixel].map_or(DEAREST.into(), |patch| search.matcher.cost(pixel, &patch));
    }
    for (pixel, inverse) in hints.of_others(&pinhole).into_iter().filter(|(pixel, _)| wanted[*pixel]) {
        let slope = search.best[pixel].map_or([0.0; 2], |patch| patch.slope);
        search.attempt(pixel, Patch { inverse, slope });
    }
    for plane in hints.planes {
        for pixel in (0..wanted.len()).filter(|pixel| wanted[*pixel]) {
            if let Some(patch) = Patch::of_plane(plane, &pinhole, pixel) {
                search.attempt(pixel, patch);
            }
        }
    }
    for pass in 0..PASSES {
        let is_forward = pass % 2 == 0;
        for step in 0..wanted.len() {
            let pixel = if is_forward { step } else { wanted.len() - 1 - step };
            if wanted[pixel] {
                search.improve(pixel, is_forward, 0.5_f32.powi(pass));
            }
        }
    }
    let depth = |pixel: usize| match search.best[pixel] {
        Some(patch) if wanted[pixel] && search.costs[pixel] <= WORST => depth_m(patch.inverse, sweep.step),
        _ => f32::NAN,
    };
    (0..wanted.len()).map(depth).collect()
}

/// The best patch of each pixel so far.
struct Search<'a> {
    best: Vec<Option<Patch>>,
    costs: Vec<f32>,
    random: ChaCha8Rng,
    /// Inverse depth of a pixel of parallax, 1/m.
    step: f32,
    matcher: Matcher<'a>,
}

impl Search<'_> {
    fn attempt(&mut self, pixel: usize, patch: Patch) {
        let cost = self.matcher.cost(pixel, &patch);
        if cost + GAIN < self.costs[pixel] {
            self.costs[pixel] = cost;
            self.best[pixel] = Some(patch);
        }
    }

    /// Tries the planes of the two neighbours that were looked at before, then changes of up to `reach` pixels of parallax.
    fn improve(&mut self, pixel: usize, is_forward: bool, reach: f32) {
        let [width, height] = self.matcher.size;
        let (column, row) = (pixel % width, pixel / width);
        let (beside, sign) = match is_forward {
            true => ([(column > 0).then(|| pixel - 1), (row > 0).then(|| pixel - width)], 1.0),
            false => {
                let right = (column + 1 < width).then(|| pixel + 1);
                ([right, (row + 1 < height).then(|| pixel + width)], -1.0)
            }
        };
        for (offset, other) in [[sign, 0.0], [0.0, sign]].into_iter().zip(beside) {
            if let Some(patch) = other.and_then(|other| self.best[other]) {
                self.attempt(pixel, patch.at(offset));
            }
        }
        if let Some(patch) = self.best[pixel] {
            let moved = patch.inverse + self.draw(reach * self.step);
            self.attempt(pixel, Patch { inverse: moved, ..patch });
            let turned = patch.slope.map(|slope| slope + self.draw(TURN * reach * self.step));
            self.attempt(pixel, Patch { slope: turned, ..patch });
        }
    }

    fn draw(&mut self, most: f32) -> f32 {
        most * (2.0 * self.random.random::<f32>() - 1.0)
    }
}

impl Hints<'_> {
    /// The plane at a pixel of the finer picture.
    fn patch(&self, pixel: usize, width: usize, step: f32) -> Option<Patch> {
        let factor = self.factor as usize;
        let small_width = self.images[self.of].view.width() as usize;
        let known = &self.known[self.of];
        let (column, row) = (pixel % width, pixel / width);
        let at = [column / factor, row / factor];
        let small = at[1] * small_width + at[0].min(small_width - 1);
        let patch = first(known, small_width, small, step * self.factor as f32)?;
        let by = 1.0 / factor as f32;
        let offset = |fine: usize, coarse: usize| fine as f32 + 0.5 - (coarse as f32 + 0.5) * factor as f32;
        let fine = Patch { inverse: patch.inverse, slope: patch.slope.map(|slope| slope * by) };
        Some(fine.at([offset(column, at[0]), offset(row, at[1])]))
    }

    /// Inverse depths at pixels of the finer picture, as the other views see what is there.
    fn of_others(&self, pinhole: &Pinhole) -> Vec<(usize, f32)> {
        let mut found = Vec::new();
        for (other, known) in self.known.iter().enumerate().filter(|(other, _)| *other != self.of) {
            let from = Pinhole::new(self.images[other].view);
            for (pixel, &inverse) in known.iter().enumerate().filter(|(_, inverse)| **inverse > 1e-4) {
                let point = from.world(from.centre_of(pixel), 1.0 / inverse);
                if let Some((seen, z_m)) = pinhole.pixel(point) {
                    found.push((seen, 1.0 / z_m));
                }
            }
        }
        found
    }
}

/// The plane at a pixel of a map of inverse depth.
fn first(known: &[f32], width: usize, pixel: usize, step: f32) -> Option<Patch> {
    let inverse = |pixel: usize| known.get(pixel).copied().filter(|inverse| !inverse.is_nan());
    let here = inverse(pixel)?;
    let slope = |before: Option<usize>, after: Option<usize>| {
        let side = |other: Option<usize>, sign: f32| {
            let change = sign * (inverse(other?)? - here);
            (change.abs() < 1.5 * step).then_some(change)
        };
        match (side(before, -1.0), side(after, 1.0)) {
            (Some(before), Some(after)) => 0.5 * (before + after),
            (one, other) => one.or(other).unwrap_or(0.0),
        }
    };
    let column = pixel % width;
    let beside = [(column > 0).then(|| pixel - 1), (column + 1 < width).then(|| pixel + 1)];
    let along = [pixel.checked_sub(width), Some(pixel + width)];
    Some(Patch { inverse: here, slope: [slope(beside[0], beside[1]), slope(along[0], along[1])] })
}

struct Matcher<'a> {
    own: &'a [f32],
    size: [usize; 2],
    pinhole: Pinhole,
    others: &'a [Other<'a>],
}

impl Matcher<'_> {
    /// How much a patch around a pixel differs from what the others show there, bytes.
    fn cost(&self, pixel: usize, patch: &Patch) -> f32 {
        let [width, height] = self.size.map(|side| side as i32);
        let (column, row) = (pixel as i32 % width, pixel as i32 / width);
        let [u, v] = self.pinhole.centre_of(pixel);
        let own = self.own[pixel];
        let mut sums = [[0.0_f32; 7]; NEIGHBOURS];
        for dy in -RADIUS..=RADIUS {
            for dx in -RADIUS..=RADIUS {
                let (at_column, at_row) = (column + dx, row + dy);
                if !(0..width).contains(&at_column) || !(0..height).contains(&at_row) {
                    continue;
                }
                let there = self.own[(at_row * width + at_column) as usize];
                let weight = 1.0 / (1.0 + ((there - own) / EDGE).powi(2));
                let (dx, dy) = (dx as f32, dy as f32);
                let inverse = patch.inverse + patch.slope[0] * dx + patch.slope[1] * dy;
                for (other, sums) in self.others.iter().zip(&mut sums) {
                    if let Some(seen) = other.brightness([u + dx, v + dy], inverse) {
                        let values = [
                            1.0,
                            there,
                            seen,
                            there * there,
                            seen * seen,
                            there * seen,
                            (there - seen).abs(),
                        ];
                        for (sum, value) in sums.iter_mut().zip(values) {
                            *sum += weight * value;
                        }
                    }
                }
            }
        }
        let found = sums[..self.others.len()].iter().filter(|sums| sums[0] > 0.0);
        better_half(found.map(|sums| cost_of_window(sums, sums[6] / sums[0]))).unwrap_or(DEAREST.into())
    }
}
