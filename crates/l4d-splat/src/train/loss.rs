//! What pictures of one moment say about the splats of that moment.

use rayon::prelude::*;

use crate::optimise::{DepthGradient, RenderedDepth, depth_l1, l1};
use crate::raster::{DrawingGradient, RasterSettings, Rasterizer};
use crate::splats::{SplatGradients, Splats};
use crate::view::View;

use super::TrainError;

/// Errors of depth below this share of the typical depth give a gradient in proportion.
const KNEE: f32 = 0.002;

/// A picture, or a part of one, that the splats should look like.
#[derive(Debug)]
pub(super) struct Target {
    pub(super) view: View,
    /// Display colour, 0 to 1, three numbers per pixel.
    pub(super) colour: Vec<f32>,
    /// Metres; +inf says nothing.
    pub(super) depth_m: Vec<f32>,
    /// Pixels that say something; empty if all do. The depth of the others is +inf.
    pub(super) marked: Vec<bool>,
    /// Width and height of the whole picture over those of this part.
    pub(super) zoom: [f32; 2],
}

/// How the terms of the loss are weighted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights {
    /// By metres.
    pub(super) depth: f32,
    /// Metres.
    pub(super) typical_depth_m: f32,
}

#[derive(Debug)]
pub(super) struct LossGradients {
    pub(super) gradients: SplatGradients,
    /// For each Gaussian the lengths of the gradient by its projected centre in the whole picture, summed over
    /// pictures.
    pub(super) gradient_norms: Vec<f32>,
    /// Pictures in which it was visible and learned.
    pub(super) seen: Vec<f32>,
    /// Mean of the loss over pictures.
    pub(super) loss: f64,
}

/// What the targets say to the Gaussians that learn: all, or those that are marked.
pub(super) fn loss_gradients(
    rasterizer: &dyn Rasterizer,
    splats: &Splats,
    targets: &[Target],
    trainable: Option<&[bool]>,
    weights: Weights,
) -> Result<LossGradients, TrainError> {
    let results: Vec<(SplatGradients, f64)> = targets
        .par_iter()
        .map(|target| {
            picture_loss(rasterizer, splats, target, trainable, weights, 1.0 / targets.len() as f32)
        })
        .collect::<Result<_, _>>()?;
    let mut sum: Option<SplatGradients> = None;
    let (mut gradient_norms, mut seen) = (vec![0.0; splats.len()], vec![0.0; splats.len()]);
    let mut loss = 0.0;
    for ((gradients, value), target) in results.into_iter().zip(targets) {
        for (index, &[x, y]) in gradients.means_ndc.iter().enumerate() {
            if gradients.visible[index] && trainable.is_none_or(|trainable| trainable[index]) {
                gradient_norms[index] += (x * target.zoom[0]).hypot(y * target.zoom[1]);
                seen[index] += 1.0;
            }
        }
        match &mut sum {
            Some(sum) => sum.add(&gradients),
            None => sum = Some(gradients),
        }
        loss += value;
    }
    let gradients = sum.unwrap_or_else(|| SplatGradients::zeros(splats));
    Ok(LossGradients { gradients, gradient_norms, seen, loss: loss / targets.len().max(1) as f64 })
}

fn picture_loss(
    rasterizer: &dyn Rasterizer,
    splats: &Splats,
    target: &Target,
    trainable: Option<&[bool]>,
    weights: Weights,
    share: f32,
) -> Result<(SplatGradients, f64), TrainError> {
    let settings = RasterSettings { quantiles: false, ..RasterSettings::default() };
    let scene = if target.marked.is_empty() {
        rasterizer.prepare(splats, &target.view, &settings)?
    } else {
        rasterizer.prepare_marked(splats, &target.view, &settings, &target.marked)?
    };
    let drawing = scene.draw()?;
    // Losses are means over pixels; a part of a picture counts as much as it has pixels.
    let share = share / (target.zoom[0] * target.zoom[1]);
    let drawn = drawing.colour.as_flattened();
    let mut colour = target.colour.clone();
    for ((colour, drawn), marked) in
        colour.as_chunks_mut::<3>().0.iter_mut().zip(&drawing.colour).zip(&target.marked)
    {
        *colour = if *marked { *colour } else { *drawn };
    }
    let mut gradient = DrawingGradient::zeros(&target.view);
    let mut loss = l1(drawn, &colour, share, gradient.colour.as_flattened_mut())?;
    if weights.depth > 0.0 {
        let rendered = RenderedDepth { sum_m: &drawing.depth_sum_m, alpha: &drawing.alpha };
        let into = DepthGradient { sum: &mut gradient.depth_sum_m, alpha: &mut gradient.alpha };
        // This mean is over pixels that say something.
        let marked = target.marked.iter().filter(|marked| **marked).count();
        let said = if target.marked.is_empty() { 1.0 } else { marked as f32 / target.marked.len() as f32 };
        let weight = said * weights.depth / weights.typical_depth_m;
        let knee_m = KNEE * weights.typical_depth_m;
        loss += depth_l1(rendered, &target.depth_m, knee_m, share * weight, into)? * f64::from(weight);
    }
    let gradients = match trainable {
        Some(trainable) => scene.backward_for(&drawing, &gradient, trainable)?,
        None => scene.backward(&drawing, &gradient)?,
    };
    Ok((gradients, loss))
}
