//! A rasterizer against the reference: pictures, weights, gradients, refusals.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::scenes::{Case, cases};
use crate::raster::{
    DepthQuantiles, Drawing, DrawingGradient, Projected, RasterError, Rasterizer, Reference, ReferenceScene,
};
use crate::splats::SplatGradients;
use crate::view::View;

/// How far a rasterizer may be from the reference in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Colour, alpha and blended features: absolute, or relative to the largest value where that is above 1.
    pub colour: f64,
    /// Summed depth, relative to the largest one of the picture.
    pub depth: f64,
    /// Gradients, relative to the largest one of the same field.
    pub gradient: f64,
    /// Size of a flip, as colour and depth are measured.
    pub flip: f64,
    /// Share of the pixels that may flip.
    pub flips: f64,
    /// What a flip may do to a gradient, relative to the largest one of the same field.
    pub flipped_gradient: f64,
}

impl Bounds {
    /// What [`crate::raster::Cpu`] keeps.
    pub const CPU: Self =
        Self { colour: 1e-5, depth: 1e-5, gradient: 1e-4, flip: 0.02, flips: 1e-3, flipped_gradient: 2e-2 };
}

/// One quantity of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name of the scene.
    pub case: &'static str,
    /// What was compared.
    pub quantity: &'static str,
    /// Largest error, flips excepted.
    pub error: f64,
    /// Largest error that is allowed.
    pub bound: f64,
    /// Entries that a threshold may explain.
    pub flips: usize,
    /// How many there may be.
    pub flips_allowed: usize,
}

impl Finding {
    /// Whether error and flips are within their bounds.
    pub fn passes(&self) -> bool {
        self.error <= self.bound && self.flips <= self.flips_allowed
    }
}

/// Compares a rasterizer with the reference on all scenes.
///
/// # Errors
/// As the rasterizer.
pub fn check(rasterizer: &dyn Rasterizer, bounds: &Bounds) -> Result<Vec<Finding>, RasterError> {
    let mut findings = Vec::new();
    for case in &cases() {
        let reference = Reference::scene(&case.splats.to_f64(), &case.view, &case.settings)?;
        let projected = rasterizer.prepare(&case.splats, &case.view, &case.settings)?;
        let projected = projected.as_ref();
        let mut comparison = Comparison { case, bounds, projected, reference, findings: &mut findings };
        comparison.pictures()?;
        comparison.weights()?;
        comparison.gradients()?;
    }
    Ok(findings)
}

/// Names what a rasterizer should have refused and did not.
///
/// # Errors
/// As the rasterizer.
pub fn refusals(rasterizer: &dyn Rasterizer) -> Result<Vec<&'static str>, RasterError> {
    let Some(case) = cases().into_iter().find(|case| case.name == "cloud") else { return Ok(Vec::new()) };
    let projected = rasterizer.prepare(&case.splats, &case.view, &case.settings)?;
    let drawing = projected.draw()?;
    let gradient = DrawingGradient::zeros(&case.view);
    let short = DrawingGradient { alpha: vec![0.0; 3], ..gradient.clone() };
    let mut alien = drawing.clone();
    alien.transmittance.pop();
    let mut settings = case.settings;
    settings.alpha_max = 1.0;
    let outputs = [
        ("features that are too few", projected.splat_features(&[1.0; 7], 3).is_err()),
        ("pixels that are too few", projected.gather_features(&[1.0; 7], 1).is_err()),
        ("an absurd number of channels", projected.splat_features(&[1.0; 7], usize::MAX).is_err()),
        ("a gradient of another size", projected.backward(&drawing, &short).is_err()),
        ("a drawing of another size", projected.backward(&alien, &gradient).is_err()),
        ("an alpha of 1", rasterizer.prepare(&case.splats, &case.view, &settings).is_err()),
    ];
    Ok(outputs.into_iter().filter(|(_, refused)| !refused).map(|(what, _)| what).collect())
}

/// A gradient by every pixel of a picture, from a seed.
pub(super) fn random_gradient(view: &View, seed: u64) -> DrawingGradient {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut gradient = DrawingGradient::zeros(view);
    for pixel in 0..view.pixel_count() {
        gradient.colour[pixel] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
        gradient.alpha[pixel] = random.random_range(-1.0..1.0);
        gradient.depth_sum_m[pixel] = random.random_range(-0.3..0.3);
    }
    gradient
}

fn random_numbers(count: usize, seed: u64) -> Vec<f32> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..count).map(|_| random.random_range(-1.0..1.0)).collect()
}

struct Comparison<'a> {
    case: &'a Case,
    bounds: &'a Bounds,
    projected: &'a dyn Projected,
    reference: ReferenceScene,
    findings: &'a mut Vec<Finding>,
}

impl Comparison<'_> {
    fn report(&mut self, quantity: &'static str, error: f64, bound: f64, flips: usize, flips_allowed: usize) {
        let case = self.case.name;
        self.findings.push(Finding { case, quantity, error, bound, flips, flips_allowed });
    }

    fn flips_allowed(&self, entries: usize) -> usize {
        (self.bounds.flips * entries as f64).ceil() as usize
    }

    /// Compares lists with `width` numbers per row, relative to `scale`. A row that is off by more than the bound, but by
    /// no more than `flip`, counts as flipped. Also the number of rows.
    fn compare(
        ours: &[f32],
        theirs: &[f64],
        width: usize,
        [scale, bound, flip]: [f64; 3],
    ) -> (f64, usize, usize) {
        let (mut worst, mut flips) = (0.0_f64, 0);
        for (ours, theirs) in ours.chunks(width).zip(theirs.chunks(width)) {
            let error = std::iter::zip(ours, theirs)
                .map(|(&ours, theirs)| (f64::from(ours) - theirs).abs() / scale)
                // NaN is as wrong as can be.
                .fold(0.0, |most: f64, error| if error.is_nan() { f64::INFINITY } else { most.max(error) });
            if error > bound && error <= flip {
                flips += 1;
            } else {
                worst = worst.max(error);
            }
        }
        let worst = if ours.len() == theirs.len() { worst } else { f64::INFINITY };
        (worst, flips, theirs.len() / width)
    }

    /// Compares lists with `width` numbers per pixel.
    fn per_pixel(&mut self, quantity: &'static str, ours: &[f32], theirs: &[f64], width: usize, bound: f64) {
        let scale = theirs.iter().fold(1.0_f64, |most, value| most.max(value.abs()));
        let (worst, flips, rows) = Self::compare(ours, theirs, width, [scale, bound, self.bounds.flip]);
        self.report(quantity, worst, bound, flips, self.flips_allowed(rows));
    }

    /// Compares lists with `width` numbers per Gaussian, relative to the largest of them.
    fn per_field(&mut self, quantity: &'static str, ours: &[f32], theirs: &[f64], width: usize) {
        let largest = theirs.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let scale = if largest > 0.0 { largest } else { 1.0 };
        let limits = [scale, self.bounds.gradient, self.bounds.flipped_gradient];
        let (worst, flips, rows) = Self::compare(ours, theirs, width, limits);
        // A flipped pixel touches all Gaussians that show in it; how many that are depends on the scene.
        self.report(quantity, worst, self.bounds.gradient, flips, self.flips_allowed(20 * rows));
    }

    fn pictures(&mut self) -> Result<(), RasterError> {
        let (ours, theirs) = (self.projected.draw()?, self.reference.draw());
        let Bounds { colour, depth, .. } = *self.bounds;
        self.per_pixel("colour", ours.colour.as_flattened(), theirs.colour.as_flattened(), 3, colour);
        self.per_pixel("alpha", &ours.alpha, &theirs.alpha, 1, colour);
        self.per_pixel("transmittance", &ours.transmittance, &theirs.transmittance, 1, colour);
        self.per_pixel("depth sum", &ours.depth_sum_m, &theirs.depth_sum_m, 1, depth);
        self.quantiles(&ours);
        let again = self.projected.draw()?;
        self.report("drawn again", f64::from(u8::from(again != ours)), 0.0, 0, 0);
        Ok(())
    }

    /// A depth quantile is right if some transmittance within the bound of the level explains it.
    fn quantiles(&mut self, drawing: &Drawing) {
        let Some(ours) = &drawing.quantiles else {
            return self.report("depth quantiles", f64::INFINITY, 0.0, 0, 0);
        };
        let depths = self.reference.depths_m();
        let width = self.case.view.width() as usize;
        let mut wrong = 0;
        for pixel in 0..self.case.view.pixel_count() {
            let list = self.reference.contributors(pixel % width, pixel / width);
            let found = [ours.near_m[pixel], ours.median_m[pixel], ours.far_m[pixel]].map(f64::from);
            for (found, level) in found.into_iter().zip(DepthQuantiles::LEVELS) {
                let fits = [1.0 - self.bounds.colour, 1.0 + self.bounds.colour].iter().any(|factor| {
                    let depth = crossing(&list, &depths, f64::from(level) * factor);
                    depth == found || (depth - found).abs() <= self.bounds.depth * depth.abs()
                });
                wrong += usize::from(!fits);
            }
        }
        self.report("depth quantiles", 0.0, 0.0, wrong, self.flips_allowed(3 * self.case.view.pixel_count()));
    }

    fn weights(&mut self) -> Result<(), RasterError> {
        // More than the channels of one pass.
        let channels = 19;
        let features = random_numbers(self.case.splats.len() * channels, 21);
        let pixels = random_numbers(self.case.view.pixel_count() * channels, 22);
        let wide = |list: &[f32]| list.iter().copied().map(f64::from).collect::<Vec<_>>();
        let splatted = self.projected.splat_features(&features, channels)?;
        let expected = self.reference.splat_features(&wide(&features), channels);
        self.per_pixel("splatted features", &splatted, &expected, channels, self.bounds.colour);
        let gathered = self.projected.gather_features(&pixels, channels)?;
        let expected = self.reference.gather_features(&wide(&pixels), channels);
        self.per_field("gathered features", &gathered, &expected, channels);
        let dot = |a: &[f32], b: &[f32]| -> (f64, f64) {
            std::iter::zip(a, b)
                .map(|(&a, &b)| f64::from(a) * f64::from(b))
                .fold((0.0, 0.0), |(sum, size), x| (sum + x, size + x.abs()))
        };
        let ((there, size), (back, _)) = (dot(&splatted, &pixels), dot(&features, &gathered));
        let error = (there - back).abs() / if size > 0.0 { size } else { 1.0 };
        self.report("gather is transposed", error, 1e-6, 0, 0);
        Ok(())
    }

    fn gradients(&mut self) -> Result<(), RasterError> {
        let gradient = random_gradient(&self.case.view, 23);
        let ours: SplatGradients = self.projected.backward(&self.projected.draw()?, &gradient)?;
        let theirs = self.reference.backward(&gradient.map(f64::from))?;
        let fields = ["by means", "by scales", "by rotations", "by opacities", "by sh"];
        for (list, (field, width)) in fields.into_iter().zip([3, 3, 4, 1, 3]).enumerate() {
            self.per_field(field, ours.by.lists()[list], theirs.by.lists()[list], width);
        }
        self.per_field("by means (ndc)", ours.means_ndc.as_flattened(), theirs.means_ndc.as_flattened(), 2);
        let differ = std::iter::zip(&ours.visible, &theirs.visible).filter(|(a, b)| a != b).count();
        self.report("visible", 0.0, 0.0, differ, self.flips_allowed(ours.visible.len()));
        Ok(())
    }
}

/// Depth of the first contributor behind which the transmittance is below a level.
fn crossing(list: &[(usize, f64)], depths: &[f64], level: f64) -> f64 {
    let mut left = 1.0;
    for &(index, weight) in list {
        left -= weight;
        if left < level {
            return depths[index];
        }
    }
    f64::INFINITY
}
