//! What pixels say about Gaussians, summed time by time: the transpose of drawing.

use std::sync::Arc;

use l4d_splat::splats::Splats;
use rayon::prelude::*;

use crate::lift::error::LiftError;
use crate::lift::evidence::{Picture, TimeEvidence, numbers};
use crate::lift::rendered_model::RenderedModel;

/// For one time and each Gaussian, sums of blend weights over the pixels of all views.
#[derive(Debug, Clone, Default)]
pub(super) struct Votes {
    /// Over the pixels inside the masks.
    pub(super) inside: Vec<f32>,
    /// Over all pixels.
    pub(super) seen: Vec<f32>,
}

/// The votes at one time.
pub(super) fn votes(
    rendered: &RenderedModel<'_>,
    splats: &Splats,
    instant: &TimeEvidence<'_>,
) -> Result<Votes, LiftError> {
    let views = instant.pictures.par_iter().map(|picture| ballot(rendered, splats, instant.time, picture));
    let (inside, seen): (Vec<Vec<f32>>, Vec<Arc<[f32]>>) =
        views.collect::<Result<Vec<_>, LiftError>>()?.into_iter().unzip();
    Ok(Votes { inside: total(&inside), seen: total(&seen) })
}

/// What one picture says: of each Gaussian, how much is inside its mask and how much it sees of it. The latter is the
/// same for all masks; where it is known, only pixels inside the mask are looked at.
fn ballot(
    rendered: &RenderedModel<'_>,
    splats: &Splats,
    time: f32,
    picture: &Picture<'_>,
) -> Result<(Vec<f32>, Arc<[f32]>), LiftError> {
    match rendered.states.and_then(|moments| moments.seen(time, picture.view)) {
        Some(seen) if picture.mask.is_empty() => Ok((vec![0.0; splats.len()], seen)),
        Some(seen) => {
            let marked = picture.mask.to_bools();
            let projected =
                rendered.rasterizer.prepare_marked(splats, picture.view, rendered.raster, &marked)?;
            Ok((projected.gather_features(&numbers(picture.mask), 1)?, seen))
        }
        None => {
            let projected = rendered.rasterizer.prepare(splats, picture.view, rendered.raster)?;
            let pixels: Vec<f32> =
                numbers(picture.mask).into_iter().flat_map(|inside| [inside, 1.0]).collect();
            let sums = projected.gather_features(&pixels, 2)?;
            let (inside, seen): (Vec<f32>, Vec<f32>) =
                sums.as_chunks::<2>().0.iter().map(|&[inside, seen]| (inside, seen)).unzip();
            let seen = Arc::from(seen);
            if let Some(moments) = rendered.states {
                moments.keep_seen(time, picture.view, &seen);
            }
            Ok((inside, seen))
        }
    }
}

/// What masks hold beyond the blend of `labels`, brought back to the Gaussians: A^T (m - A s).
pub(super) fn residual(
    rendered: &RenderedModel<'_>,
    splats: &Splats,
    instant: &TimeEvidence<'_>,
    labels: &[f32],
) -> Result<Vec<f32>, LiftError> {
    let views = instant.pictures.par_iter().map(|picture| {
        let projected = rendered.rasterizer.prepare(splats, picture.view, rendered.raster)?;
        let blend = projected.splat_features(labels, 1)?;
        let mut rest = numbers(picture.mask);
        for (rest, blend) in rest.iter_mut().zip(blend) {
            *rest -= blend;
        }
        Ok(projected.gather_features(&rest, 1)?)
    });
    let views: Vec<Vec<f32>> = views.collect::<Result<_, LiftError>>()?;
    Ok(total(&views))
}

/// Sums over the views, always in their order.
fn total<L: AsRef<[f32]>>(views: &[L]) -> Vec<f32> {
    let mut views = views.iter().map(AsRef::as_ref);
    let mut sums = views.next().map(<[f32]>::to_vec).unwrap_or_default();
    for view in views {
        for (sum, value) in sums.iter_mut().zip(view) {
            *sum += value;
        }
    }
    sums
}
