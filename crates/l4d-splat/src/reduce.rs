//! Smaller models out of a trained one: fewer Gaussians, simpler colours.
//!
//! Nothing is trained again, so that what a reduction costs shows in the picture. Refuses to know how that is measured.

use rayon::prelude::*;

use crate::clip::{ClipError, Moment};
use crate::deform::{DeformError, DeformationField};
use crate::gaussians::{Gaussians, ShDegree};
use crate::model::Model;
use crate::raster::{RasterSettings, Rasterizer};
use crate::tensor::Tensor;

/// How much each Gaussian shows: the sum of its blend weights over all pixels of all views.
///
/// # Errors
/// As [`crate::clip::draw`].
pub fn weights<Key: Sync>(
    model: &Model,
    rasterizer: &dyn Rasterizer,
    settings: &RasterSettings,
    moments: &[Moment<Key>],
) -> Result<Vec<f64>, ClipError> {
    let mut sums = vec![0.0; model.gaussians.len()];
    for Moment { time, views } in moments {
        let time = *time;
        let splats = model.at(time).map_err(|source| ClipError::Model { time, source })?;
        let seen: Vec<Vec<f32>> = views
            .par_iter()
            .map(|(_, view)| {
                let ones = vec![1.0; view.pixel_count()];
                let gathered = rasterizer
                    .prepare(&splats, view, settings)
                    .and_then(|projected| projected.gather_features(&ones, 1));
                gathered.map_err(|source| ClipError::Raster { time, source })
            })
            .collect::<Result<_, _>>()?;
        for list in &seen {
            for (sum, &weight) in sums.iter_mut().zip(list) {
                *sum += f64::from(weight);
            }
        }
    }
    Ok(sums)
}

/// The `count` Gaussians with the largest weights, ascending; of equals the first.
pub fn strongest(weights: &[f64], count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..weights.len() as u32).collect();
    order.sort_by(|&a, &b| weights[b as usize].total_cmp(&weights[a as usize]));
    order.truncate(count);
    order.sort_unstable();
    order
}

/// The model with these Gaussians alone; indices ascend, those that name none are left out.
pub fn keep(model: &Model, indices: &[u32]) -> Model {
    let from = &model.gaussians;
    let rows = || indices.iter().map(|&index| index as usize).filter(|&index| index < from.len());
    let moves = |index: usize| model.dynamic.binary_search(&(index as u32)).is_ok();
    let dynamic = rows().enumerate().filter(|&(_, index)| moves(index)).map(|(row, _)| row as u32).collect();
    let rows: Vec<u32> = rows().map(|row| row as u32).collect();
    Model { gaussians: from.select(&rows), dynamic, field: model.field.clone() }
}

/// The model with colours of a lower degree: higher coefficients, and what the field does to them, are left out.
///
/// # Errors
/// None for a field that was built.
pub fn with_sh_degree(model: &Model, degree: ShDegree) -> Result<Model, DeformError> {
    let from = &model.gaussians;
    if degree >= from.sh_degree {
        return Ok(model.clone());
    }
    let kept = degree.coefficients();
    let sh = (0..from.len()).flat_map(|index| from.sh_of(index)[..kept].iter().copied()).collect();
    let gaussians = Gaussians { sh_degree: degree, sh, ..from.clone() };
    let field = model.field.as_ref().map(|field| field_of_fewer(field, kept)).transpose()?;
    Ok(Model { gaussians, dynamic: model.dynamic.clone(), field })
}

fn field_of_fewer(field: &DeformationField, coefficients: usize) -> Result<DeformationField, DeformError> {
    if field.config().no_dshs || field.config().sh_coefficients <= coefficients {
        return Ok(field.clone());
    }
    let mut config = field.config().clone();
    config.sh_coefficients = coefficients;
    let mut tensors = field.tensors();
    for name in ["deformation_net.shs_deform.3.weight", "deformation_net.shs_deform.3.bias"] {
        if let Some(tensor) = tensors.get_mut(name) {
            *tensor = first_rows(tensor, 3 * coefficients);
        }
    }
    DeformationField::from_tensors(config, &tensors)
}

fn first_rows(tensor: &Tensor, rows: usize) -> Tensor {
    let mut shape = tensor.shape.clone();
    let width: usize = shape.iter().skip(1).product();
    if let Some(first) = shape.first_mut() {
        *first = rows.min(*first);
    }
    Tensor { data: tensor.data.iter().take(rows * width).copied().collect(), shape }
}

/// Bytes of a model's numbers.
pub fn stored_bytes(model: &Model) -> u64 {
    let gaussians = &model.gaussians;
    let field = model.field.as_ref().map(DeformationField::tensors).unwrap_or_default();
    let numbers = (3 + 3 + 4 + 1) * gaussians.len() + 3 * gaussians.sh.len() + model.dynamic.len();
    4 * (numbers + field.values().map(|tensor| tensor.data.len()).sum::<usize>()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Cpu;
    use crate::synthetic::Room;

    fn model() -> Model {
        Room::small(11).model().unwrap()
    }

    #[test]
    fn the_strongest_are_kept_in_their_order_and_of_equals_the_first() {
        assert_eq!(strongest(&[1.0, 3.0, 2.0, 3.0, 2.0], 3), [1, 2, 3]);
        assert_eq!(strongest(&[1.0], 5), [0]);
        assert!(strongest(&[], 2).is_empty());
    }

    #[test]
    fn kept_gaussians_keep_their_values_and_whether_they_move() {
        let model = model();
        let kept = keep(&model, &[0, 7, 299, 300, 305]);
        assert_eq!(kept.gaussians.means[1], model.gaussians.means[7]);
        assert_eq!(kept.gaussians.sh_of(4), model.gaussians.sh_of(305));
        assert_eq!(kept.dynamic, [3, 4]);
        assert_eq!(kept.at(0.5).unwrap().means()[4], model.at(0.5).unwrap().means()[305]);
        assert_eq!(keep(&model, &(0..400).collect::<Vec<_>>()), model);
    }

    #[test]
    fn weights_add_up_to_what_the_pictures_hold() {
        let room = Room::small(11);
        let views: Vec<((), _)> =
            room.views([32, 24]).unwrap().into_iter().take(3).map(|view| ((), view)).collect();
        let moments = [Moment { time: 0.25, views: views.clone() }];
        let settings = RasterSettings::default();
        let model = model();
        let total: f64 = weights(&model, &Cpu::new(), &settings, &moments).unwrap().iter().sum();
        let splats = model.at(0.25).unwrap();
        let drawn: f64 = views
            .iter()
            .map(|(_, view)| Cpu::new().prepare(&splats, view, &settings).unwrap().draw().unwrap())
            .flat_map(|drawing| drawing.alpha.into_iter().map(f64::from).collect::<Vec<_>>())
            .sum();
        assert!((total - drawn).abs() < 1e-3 * drawn, "{total} and {drawn}");
    }

    #[test]
    fn a_lower_degree_is_the_same_model_without_its_higher_coefficients() {
        let model = model();
        let plain = with_sh_degree(&model, ShDegree::ZERO).unwrap();
        let (full, flat) = (model.at(0.75).unwrap(), plain.at(0.75).unwrap());
        assert_eq!(flat.means(), full.means());
        let constants: Vec<[f32; 3]> = (0..400).map(|index| full.sh_of(index)[0]).collect();
        assert_eq!(flat.sh(), constants);
        assert_eq!(with_sh_degree(&model, ShDegree::MAX).unwrap(), model);
    }
}
