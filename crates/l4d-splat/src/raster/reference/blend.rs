//! One pixel: which Gaussians are blended into it, with what weight, and their gradients.

use super::ReferenceScene;
use super::matrix::dot;
use super::projection::{ProjectedGaussian, ProjectedGradient};
use crate::raster::{DepthQuantiles, Drawing, DrawingGradient, RasterError, TILE};
use crate::real::Real;
use crate::splats::SplatGradients;

/// One Gaussian blended into one pixel.
#[derive(Debug, Clone, Copy)]
struct Step<'a, F> {
    /// Position in front-to-back order.
    rank: usize,
    gaussian: &'a ProjectedGaussian<F>,
    /// With d the offset of the centre from the pixel and the shear xy/yy of its covariance: yy / det (dx - shear dy)
    /// and dy / yy. The inverse covariance times d is the first of them, and the second less shear times the first.
    pull: [F; 2],
    shear: F,
    /// The Gaussian's value here, 1 at its centre.
    falloff: F,
    alpha: F,
    capped: bool,
    /// Transmittance in front of it and behind it.
    before: F,
    after: F,
}

impl<F> Step<'_, F>
where
    F: Real,
{
    fn weight(&self) -> F {
        self.alpha * self.before
    }
}

impl<F: Real> ReferenceScene<F> {
    /// Calls `visit` for each Gaussian blended into a pixel, front to back; the transmittance that is left.
    fn blend_pixel<'a>(&'a self, column: usize, row: usize, mut visit: impl FnMut(Step<'a, F>)) -> F {
        let settings = &self.settings;
        let alpha_min = F::of(settings.alpha_min.into());
        let alpha_max = F::of(settings.alpha_max.into());
        let transmittance_min = F::of(settings.transmittance_min.into());
        let half = F::of(0.5);
        let mut before = F::one();
        for &rank in &self.tiles[row / TILE * self.columns + column / TILE] {
            let gaussian = &self.gaussians[rank];
            let dx = gaussian.mean[0] - F::of(column as f64);
            let dy = gaussian.mean[1] - F::of(row as f64);
            // d^T S^-1 d with the square completed, S = (xx xy; xy yy).
            let [_, xy, yy] = gaussian.covariance;
            let shear = xy / yy;
            let pull_x = yy / gaussian.determinant * (dx - shear * dy);
            let pull = [pull_x, dy / yy];
            let power = -half * ((dx - shear * dy) * pull_x + dy * dy / yy);
            if power > F::zero() {
                continue;
            }
            let falloff = power.exp();
            let open = gaussian.opacity * falloff;
            let alpha = open.min(alpha_max);
            if alpha < alpha_min {
                continue;
            }
            let after = before * (F::one() - alpha);
            if after < transmittance_min {
                break;
            }
            visit(Step {
                rank,
                gaussian,
                pull,
                shear,
                falloff,
                alpha,
                capped: open > alpha_max,
                before,
                after,
            });
            before = after;
        }
        before
    }

    fn pixels(&self) -> impl Iterator<Item = (usize, usize)> + use<F> {
        let (width, height) = (self.view.width() as usize, self.view.height() as usize);
        (0..height).flat_map(move |row| (0..width).map(move |column| (column, row)))
    }

    /// Colour, accumulated alpha and depths.
    pub fn draw(&self) -> Drawing<F> {
        let background = self.settings.background.map(|value| F::of(value.into()));
        let mut drawing =
            Drawing { width: self.view.width(), height: self.view.height(), ..Drawing::default() };
        let mut quantiles = DepthQuantiles::default();
        for (column, row) in self.pixels() {
            let mut colour = [F::zero(); 3];
            let mut alpha = F::zero();
            let mut depth_sum = F::zero();
            let mut crossed = [F::infinity(); 3];
            let left = self.blend_pixel(column, row, |step| {
                let weight = step.weight();
                colour =
                    std::array::from_fn(|channel| colour[channel] + weight * step.gaussian.colour[channel]);
                alpha = alpha + weight;
                depth_sum = depth_sum + weight * step.gaussian.depth;
                for (depth, level) in crossed.iter_mut().zip(DepthQuantiles::LEVELS) {
                    if depth.is_infinite() && step.after < F::of(level.into()) {
                        *depth = step.gaussian.depth;
                    }
                }
            });
            drawing.colour.push(std::array::from_fn(|channel| colour[channel] + left * background[channel]));
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

    /// See [`crate::raster::Projected::spread`].
    pub fn splat_features(&self, features: &[F], channels: usize) -> Vec<F> {
        let mut values = vec![F::zero(); self.view.pixel_count() * channels];
        for (pixel, (column, row)) in self.pixels().enumerate() {
            let pixel = &mut values[pixel * channels..][..channels];
            self.blend_pixel(column, row, |step| {
                let carried = &features[step.gaussian.index * channels..][..channels];
                for (sum, &feature) in pixel.iter_mut().zip(carried) {
                    *sum = *sum + step.weight() * feature;
                }
            });
        }
        values
    }

    /// See [`crate::raster::Projected::gather`].
    pub fn gather_features(&self, pixels: &[F], channels: usize) -> Vec<F> {
        let mut values = vec![F::zero(); self.splats.len() * channels];
        for (pixel, (column, row)) in self.pixels().enumerate() {
            let held = &pixels[pixel * channels..][..channels];
            self.blend_pixel(column, row, |step| {
                let sums = &mut values[step.gaussian.index * channels..][..channels];
                for (sum, &value) in sums.iter_mut().zip(held) {
                    *sum = *sum + step.weight() * value;
                }
            });
        }
        values
    }

    /// Index and weight of each Gaussian blended into a pixel, front to back.
    pub fn contributors(&self, column: usize, row: usize) -> Vec<(usize, F)> {
        let mut list = Vec::new();
        self.blend_pixel(column, row, |step| list.push((step.gaussian.index, step.weight())));
        list
    }

    /// Distance along the optical axis of each Gaussian, metres; +inf for those that are not visible.
    pub fn depths_m(&self) -> Vec<F> {
        let mut depths = vec![F::infinity(); self.splats.len()];
        for gaussian in &self.gaussians {
            depths[gaussian.index] = gaussian.depth;
        }
        depths
    }

    /// Half sides of the squares in which the Gaussians are drawn; 0 for those that are not visible.
    pub(super) fn radii(&self) -> Vec<F> {
        let mut radii = vec![F::zero(); self.splats.len()];
        for gaussian in &self.gaussians {
            radii[gaussian.index] = gaussian.radius;
        }
        radii
    }

    /// A fingerprint of every yes and no behind the picture: who is blended where, what is clamped. As long as it
    /// stays the same the picture is a smooth function of the splats.
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
    pub fn backward(&self, gradient: &DrawingGradient<F>) -> Result<SplatGradients<F>, RasterError> {
        gradient.check(&self.view)?;
        let background = self.settings.background.map(|value| F::of(value.into()));
        let mut gradients_2d = vec![ProjectedGradient::default(); self.gaussians.len()];
        for (pixel, (column, row)) in self.pixels().enumerate() {
            let by_colour = gradient.colour[pixel];
            let mut steps = Vec::new();
            self.blend_pixel(column, row, |step| steps.push(step));
            // What a unit of light is worth behind the current Gaussian.
            let mut behind = dot(background, by_colour);
            for step in steps.iter().rev() {
                let worth = dot(step.gaussian.colour, by_colour)
                    + step.gaussian.depth * gradient.depth_sum_m[pixel]
                    + gradient.alpha[pixel];
                let by_alpha = step.before * (worth - behind);
                behind = step.alpha * worth + (F::one() - step.alpha) * behind;
                add_step(
                    &mut gradients_2d[step.rank],
                    step,
                    by_alpha,
                    by_colour,
                    gradient.depth_sum_m[pixel],
                );
            }
        }
        let mut gradients = SplatGradients::zeros(&self.splats);
        for (gaussian, gradient) in self.gaussians.iter().zip(&gradients_2d) {
            self.projection.backward(&self.splats, gaussian, gradient, &mut gradients);
        }
        Ok(gradients)
    }
}

fn add_step<F: Real>(
    sums: &mut ProjectedGradient<F>,
    step: &Step<'_, F>,
    by_alpha: F,
    by_colour: [F; 3],
    by_depth: F,
) {
    let weight = step.weight();
    sums.colour = std::array::from_fn(|channel| sums.colour[channel] + weight * by_colour[channel]);
    sums.depth = sums.depth + weight * by_depth;
    if step.capped {
        return;
    }
    sums.opacity = sums.opacity + by_alpha * step.falloff;
    // The exponent is -1/2 d^T S^-1 d: its derivative by d is -S^-1 d.
    let by_power = by_alpha * step.alpha;
    let [x, y] = step.pull;
    sums.mean = [sums.mean[0] - by_power * x, sums.mean[1] - by_power * (y - step.shear * x)];
    let squares = [x * x, x * y, y * y];
    sums.pulls = std::array::from_fn(|entry| sums.pulls[entry] + by_power * squares[entry]);
}
