//! What pixels say about Gaussians, summed time by time: the transpose of drawing.

use l4d_splat::splats::Splats;
use rayon::prelude::*;

use crate::lift::canvas::Canvas;
use crate::lift::error::LiftError;
use crate::lift::evidence::{Instant, Picture, numbers};

/// For one time and each Gaussian, sums of blend weights over the pixels of all views.
#[derive(Debug, Clone, Default)]
pub(super) struct Votes {
    /// Over the pixels inside the masks.
    pub(super) inside: Vec<f32>,
    /// Over all pixels.
    pub(super) seen: Vec<f32>,
}

/// The votes at one time.
pub(super) fn votes(canvas: &Canvas<'_>, splats: &Splats, instant: &Instant<'_>) -> Result<Votes, LiftError> {
    let sums = gather(canvas, splats, instant, |_, picture| {
        let mask = numbers(picture.mask);
        Ok((mask.into_iter().flat_map(|inside| [inside, 1.0]).collect(), 2))
    })?;
    let (inside, seen) = sums.as_chunks::<2>().0.iter().map(|&[inside, seen]| (inside, seen)).unzip();
    Ok(Votes { inside, seen })
}

/// What masks hold beyond the blend of `labels`, brought back to the Gaussians: A^T (m - A s).
pub(super) fn residual(
    canvas: &Canvas<'_>,
    splats: &Splats,
    instant: &Instant<'_>,
    labels: &[f32],
) -> Result<Vec<f32>, LiftError> {
    gather(canvas, splats, instant, |projected, picture| {
        let blend = projected.spread(labels, 1)?;
        let mut rest = numbers(picture.mask);
        for (rest, blend) in rest.iter_mut().zip(blend) {
            *rest -= blend;
        }
        Ok((rest, 1))
    })
}

/// Sums over the views, always in their order.
fn gather(
    canvas: &Canvas<'_>,
    splats: &Splats,
    instant: &Instant<'_>,
    pixels: impl Fn(&dyn l4d_splat::raster::Projected, &Picture<'_>) -> Result<(Vec<f32>, usize), LiftError>
    + Sync,
) -> Result<Vec<f32>, LiftError> {
    let views = instant.pictures.par_iter().map(|picture| {
        let projected = canvas.rasterizer.prepare(splats, picture.view, canvas.raster)?;
        let (pixels, channels) = pixels(projected.as_ref(), picture)?;
        Ok(projected.gather(&pixels, channels)?)
    });
    let views: Vec<Vec<f32>> = views.collect::<Result<_, LiftError>>()?;
    let mut views = views.into_iter();
    let mut sums = views.next().unwrap_or_default();
    for view in views {
        for (sum, value) in sums.iter_mut().zip(view) {
            *sum += value;
        }
    }
    Ok(sums)
}
