//! One pixel: which Gaussians are blended into it, with what weight, and their gradients.

use glam::{DVec2, DVec3};

use super::ReferenceScene;
use super::projection::{ProjectedGaussian, ProjectedGradient};
use crate::raster::{DepthQuantiles, Drawing, DrawingGradient, RasterError, TILE};
use crate::splats::SplatGradients;

/// One Gaussian blended into one pixel.
#[derive(Debug, Clone, Copy)]
struct BlendStep<'a> {
    /// Position in front-to-back order.
    rank: usize,
    gaussian: &'a ProjectedGaussian,
    /// With d the offset of the centre from the pixel and the shear xy/yy of its covariance: yy / det (dx - shear dy)
    /// and dy / yy. The inverse covariance times d is the first of them, and the second less shear times the first.
    scaled_offset: [f64; 2],
    shear: f64,
    /// The Gaussian's value here, 1 at its centre.
    falloff: f64,
    alpha: f64,
    capped: bool,
    /// Transmittance in front of it and behind it.
    before: f64,
    after: f64,
}

impl BlendStep<'_> {
    fn weight(&self) -> f64 {
        self.alpha * self.before
    }
}

impl ReferenceScene {
    /// Calls `visit` for each Gaussian blended into a pixel, front to back; the transmittance that is left.
    fn blend_pixel<'a>(&'a self, column: usize, row: usize, mut visit: impl FnMut(BlendStep<'a>)) -> f64 {
        let [alpha_min, alpha_max, transmittance_min] =
            [self.settings.alpha_min, self.settings.alpha_max, self.settings.transmittance_min]
                .map(f64::from);
        let mut before = 1.0;
        for &rank in &self.tiles[row / TILE * self.columns + column / TILE] {
            let gaussian = &self.gaussians[rank];
            let DVec2 { x: dx, y: dy } = gaussian.mean - DVec2::new(column as f64, row as f64);
            // d^T S^-1 d with the square completed, S = (xx xy; xy yy).
            let [_, xy, yy] = gaussian.covariance;
            let shear = xy / yy;
            let scaled_x = yy / gaussian.determinant * (dx - shear * dy);
            let power = -0.5 * ((dx - shear * dy) * scaled_x + dy * dy / yy);
            if power > 0.0 {
                continue;
            }
            let falloff = power.exp();
            let open = gaussian.opacity * falloff;
            let alpha = open.min(alpha_max);
            if alpha < alpha_min {
                continue;
            }
            let after = before * (1.0 - alpha);
            if after < transmittance_min {
                break;
            }
            let (scaled_offset, capped) = ([scaled_x, dy / yy], open > alpha_max);
            visit(BlendStep { rank, gaussian, scaled_offset, shear, falloff, alpha, capped, before, after });
            before = after;
        }
        before
    }

    fn pixels(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (width, height) = (self.view.width() as usize, self.view.height() as usize);
        (0..height).flat_map(move |row| (0..width).map(move |column| (column, row)))
    }

    fn background(&self) -> DVec3 {
        self.settings.background.map(f64::from).into()
    }

    /// Colour, accumulated alpha and depths.
    pub fn draw(&self) -> Drawing<f64> {
        let mut drawing =
            Drawing { width: self.view.width(), height: self.view.height(), ..Drawing::default() };
        let mut quantiles = DepthQuantiles::default();
        for (column, row) in self.pixels() {
            let (mut colour, mut alpha, mut depth_sum) = (DVec3::ZERO, 0.0, 0.0);
            let mut crossed = [f64::INFINITY; 3];
            let left = self.blend_pixel(column, row, |step| {
                let weight = step.weight();
                colour += weight * step.gaussian.colour;
                alpha += weight;
                depth_sum += weight * step.gaussian.depth;
                for (depth, level) in crossed.iter_mut().zip(DepthQuantiles::LEVELS) {
                    if depth.is_infinite() && step.after < level.into() {
                        *depth = step.gaussian.depth;
                    }
                }
            });
            drawing.colour.push((colour + left * self.background()).to_array());
            drawing.alpha.push(alpha);
            drawing.transmittance.push(left);
            drawing.depth_sum_m.push(depth_sum);
            quantiles.near_m.push(crossed[0]);
            quantiles.median_m.push(crossed[1]);
            quantiles.far_m.push(crossed[2]);
        }
        drawing.quantiles = self.settings.quantiles.then_some(quantiles);
        drawing
    }

    /// See [`crate::raster::Projected::splat_features`].
    pub fn splat_features(&self, features: &[f64], channels: usize) -> Vec<f64> {
        let mut values = vec![0.0; self.view.pixel_count() * channels];
        for (pixel, (column, row)) in self.pixels().enumerate() {
            let pixel = &mut values[pixel * channels..][..channels];
            self.blend_pixel(column, row, |step| {
                let features = &features[step.gaussian.index * channels..][..channels];
                pixel.iter_mut().zip(features).for_each(|(sum, feature)| *sum += step.weight() * feature);
            });
        }
        values
    }

    /// See [`crate::raster::Projected::gather_features`].
    pub fn gather_features(&self, pixels: &[f64], channels: usize) -> Vec<f64> {
        let mut values = vec![0.0; self.splats.len() * channels];
        for (pixel, (column, row)) in self.pixels().enumerate() {
            let pixel = &pixels[pixel * channels..][..channels];
            self.blend_pixel(column, row, |step| {
                let sums = &mut values[step.gaussian.index * channels..][..channels];
                sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += step.weight() * value);
            });
        }
        values
    }

    /// Index and weight of each Gaussian blended into a pixel, front to back.
    pub fn contributors(&self, column: usize, row: usize) -> Vec<(usize, f64)> {
        let mut list = Vec::new();
        self.blend_pixel(column, row, |step| list.push((step.gaussian.index, step.weight())));
        list
    }

    /// Distance along the optical axis of each Gaussian, metres; +inf for those that are not visible.
    pub fn depths_m(&self) -> Vec<f64> {
        let mut depths = vec![f64::INFINITY; self.splats.len()];
        for gaussian in &self.gaussians {
            depths[gaussian.index] = gaussian.depth;
        }
        depths
    }

    /// A hash of every decision behind the picture: what is blended where, what is clamped. As long as it stays the
    /// same the picture is a smooth function of the splats.
    pub fn decisions(&self) -> u64 {
        // FNV-1a.
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut note = |word: u64| hash = (hash ^ word).wrapping_mul(0x0100_0000_01b3);
        for gaussian in &self.gaussians {
            note(gaussian.index as u64);
            gaussian.clamped.iter().for_each(|&clamped| note(clamped.into()));
        }
        for (column, row) in self.pixels() {
            self.blend_pixel(column, row, |step| note(2 * step.rank as u64 + u64::from(step.capped)));
            note(u64::MAX);
        }
        hash
    }

    /// See [`crate::raster::Projected::backward`]. Back to front, so nothing is ever divided by a transmittance.
    ///
    /// # Errors
    /// A gradient of another size than the picture.
    pub fn backward(&self, gradient: &DrawingGradient<f64>) -> Result<SplatGradients<f64>, RasterError> {
        gradient.check(&self.view)?;
        let mut sums = vec![ProjectedGradient::default(); self.gaussians.len()];
        for (pixel, (column, row)) in self.pixels().enumerate() {
            let by_colour = DVec3::from(gradient.colour[pixel]);
            let by_depth = gradient.depth_sum_m[pixel];
            let mut steps = Vec::new();
            self.blend_pixel(column, row, |step| steps.push(step));
            // Derivative by the light that comes from behind the current Gaussian.
            let mut behind = self.background().dot(by_colour);
            for step in steps.iter().rev() {
                let by_weight = step.gaussian.colour.dot(by_colour)
                    + step.gaussian.depth * by_depth
                    + gradient.alpha[pixel];
                let by_alpha = step.before * (by_weight - behind);
                behind = step.alpha * by_weight + (1.0 - step.alpha) * behind;
                add_step(&mut sums[step.rank], step, by_alpha, by_colour, by_depth);
            }
        }
        let mut gradients = SplatGradients::zeros(&self.splats);
        for (gaussian, gradient) in self.gaussians.iter().zip(&sums) {
            self.projection.backward(&self.splats, gaussian, gradient, &mut gradients);
        }
        Ok(gradients)
    }
}

fn add_step(
    sums: &mut ProjectedGradient,
    step: &BlendStep<'_>,
    by_alpha: f64,
    by_colour: DVec3,
    by_depth: f64,
) {
    sums.colour += step.weight() * by_colour;
    sums.depth += step.weight() * by_depth;
    if step.capped {
        return;
    }
    sums.opacity += by_alpha * step.falloff;
    // The exponent is -1/2 d^T S^-1 d: its derivative by d is -S^-1 d.
    let by_power = by_alpha * step.alpha;
    let [x, y] = step.scaled_offset;
    sums.mean -= by_power * DVec2::new(x, y - step.shear * x);
    for (sum, square) in sums.offset_squares.iter_mut().zip([x * x, x * y, y * y]) {
        *sum += by_power * square;
    }
}
