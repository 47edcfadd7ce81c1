//! Smaller models out of a trained one: fewer Gaussians, simpler colours, fewer that move, coarser numbers.
//!
//! Nothing is trained again, so that what a reduction costs shows in the picture. Refuses to know how that is measured.

use half::f16;
use rayon::prelude::*;

use crate::clip::{ClipError, Moment};
use crate::deform::{DeformError, DeformationField, Offsets};
use crate::gaussians::{Gaussians, ShDegree};
use crate::model::{Model, ModelError};
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
    Model { gaussians: from.select(rows()), dynamic, field: model.field.clone() }
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
    DeformationField::from_tensors(config, |name| tensors.get(name))
}

fn first_rows(tensor: &Tensor, rows: usize) -> Tensor {
    let mut shape = tensor.shape.clone();
    let width: usize = shape.iter().skip(1).product();
    if let Some(first) = shape.first_mut() {
        *first = rows.min(*first);
    }
    Tensor { data: tensor.data.iter().take(rows * width).copied().collect(), shape }
}

/// How far each dynamic Gaussian strays, and where it is on average.
#[derive(Debug, Clone, PartialEq)]
pub struct Displacement {
    /// Largest distance from the mean place, metres; one per dynamic Gaussian.
    pub reach_m: Vec<f32>,
    /// Mean offsets over the times, a row per dynamic Gaussian.
    mean: Offsets,
}

impl Displacement {
    /// Follows the dynamic Gaussians of a model over some times.
    ///
    /// # Errors
    /// As [`Model::at`].
    pub fn of(model: &Model, times: &[f32]) -> Result<Self, ModelError> {
        let Some(field) = model.field.as_ref().filter(|_| !times.is_empty()) else {
            return Ok(Self { reach_m: vec![0.0; model.dynamic.len()], mean: Offsets::default() });
        };
        let canonical = &model.gaussians.means;
        let positions: Vec<[f32; 3]> =
            model.dynamic.iter().filter_map(|&index| canonical.get(index as usize).copied()).collect();
        let mut mean = Offsets::zeros(field.config(), positions.len());
        let mut places: Vec<Vec<[f32; 3]>> = Vec::new();
        let share = 1.0 / times.len() as f32;
        for &time in times {
            let offsets = field.offsets(&positions, time)?;
            for (sums, values) in mean.flat_mut().into_iter().zip(offsets.flat()) {
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += share * value;
                }
            }
            places.push(offsets.means);
        }
        let reach = |row: usize| {
            let Some(&centre) = mean.means.get(row) else { return 0.0 };
            let away =
                |place: [f32; 3]| (0..3).map(|axis| (place[axis] - centre[axis]).powi(2)).sum::<f32>().sqrt();
            places.iter().map(|moment| away(moment[row])).fold(0.0, f32::max)
        };
        Ok(Self { reach_m: (0..positions.len()).map(reach).collect(), mean })
    }

    /// The model in which those that stray less than `threshold_m` stand still, in their mean state.
    ///
    /// # Errors
    /// A model that has other dynamic Gaussians than the one that was followed.
    pub fn freeze(&self, model: &Model, threshold_m: f32) -> Result<Model, ModelError> {
        let is_still = |row: &u32| self.reach_m.get(*row as usize).is_some_and(|&reach| reach < threshold_m);
        let (still, moving): (Vec<u32>, Vec<u32>) = (0..model.dynamic.len() as u32).partition(is_still);
        let names = |rows: &[u32]| rows.iter().map(|&row| model.dynamic[row as usize]).collect::<Vec<u32>>();
        let mut gaussians = model.gaussians.clone();
        let mut mean = Offsets::default();
        self.mean.gather(gaussians.sh_degree.coefficients(), &still, &mut mean);
        mean.add_to(&mut gaussians, &names(&still))?;
        let dynamic = names(&moving);
        let field = model.field.clone().filter(|_| !dynamic.is_empty());
        Ok(Model { gaussians, dynamic, field })
    }
}

/// What is stored in 16-bit floats; the rest stays at 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HalfPart {
    /// Spherical harmonics: most of the numbers of a Gaussian.
    Harmonics,
    /// Everything but the centres, the field included.
    AllButCentres,
    /// Everything. Centres ten metres from the origin then are on a grid of 4 to 8 mm.
    Everything,
}

/// The model as it comes back from being stored in 16-bit floats. Values beyond their range become its ends.
pub fn through_f16(model: &Model, part: HalfPart) -> Model {
    let mut model = model.clone();
    let gaussians = &mut model.gaussians;
    round(gaussians.sh.as_flattened_mut());
    if part != HalfPart::Harmonics {
        round(gaussians.log_scales.as_flattened_mut());
        round(gaussians.rotations.as_flattened_mut());
        round(&mut gaussians.opacity_logits);
        if let Some(field) = &mut model.field {
            let parameters = field.parameters_mut();
            parameters.planes.into_iter().chain(parameters.layers).for_each(round);
        }
    }
    if part == HalfPart::Everything {
        round(gaussians.means.as_flattened_mut());
    }
    model
}

fn round(values: &mut [f32]) {
    let largest = f16::MAX.to_f32();
    for value in values {
        *value = f16::from_f32(value.clamp(-largest, largest)).to_f32();
    }
}

/// Bytes of a model's numbers, with `part` of them in 16-bit floats.
pub fn stored_bytes(model: &Model, part: Option<HalfPart>) -> u64 {
    let gaussians = &model.gaussians;
    let centres = 3 * gaussians.len();
    let harmonics = 3 * gaussians.sh.len();
    let shapes = (3 + 4 + 1) * gaussians.len();
    let field = model
        .field
        .as_ref()
        .map_or(0, |field| field.tensors().values().map(|tensor| tensor.data.len()).sum::<usize>());
    let wide = |is_wide: bool, count: usize| (if is_wide { 4 } else { 2 }) * count;
    let bytes = wide(part.is_none(), harmonics)
        + wide(matches!(part, None | Some(HalfPart::Harmonics)), shapes + field)
        + wide(part != Some(HalfPart::Everything), centres)
        + 4 * model.dynamic.len();
    bytes as u64
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

    #[test]
    fn frozen_gaussians_stand_in_their_mean_state() {
        let model = model();
        let times = [0.0, 0.5, 1.0];
        let motion = Displacement::of(&model, &times).unwrap();
        assert_eq!(motion.freeze(&model, 0.0).unwrap(), model);

        let still = motion.freeze(&model, f32::INFINITY).unwrap();
        assert!(still.dynamic.is_empty() && still.field.is_none());
        let index = model.dynamic[17] as usize;
        let states = times.map(|time| model.raw_at(time).unwrap());
        for axis in 0..3 {
            let mean = states.iter().map(|state| state.means[index][axis]).sum::<f32>() / 3.0;
            assert!((still.gaussians.means[index][axis] - mean).abs() < 1e-5);
        }
        let last = states.iter().map(|state| state.sh_of(index)[3][2]).sum::<f32>() / 3.0;
        assert!((still.gaussians.sh_of(index)[3][2] - last).abs() < 1e-5);

        let mut reaches = motion.reach_m.clone();
        reaches.sort_by(f32::total_cmp);
        let half = motion.freeze(&model, reaches[50]).unwrap();
        assert_eq!(half.dynamic.len(), 50);
        let stays = *half.dynamic.first().unwrap() as usize;
        assert_eq!(half.at(0.5).unwrap().means()[stays], model.at(0.5).unwrap().means()[stays]);
    }

    #[test]
    fn half_floats_round_what_they_are_asked_to_and_stay_finite() {
        let mut model = model();
        model.gaussians.sh[0][0] = 0.1;
        model.gaussians.means[0] = [1e9, 0.1, -1e9];
        let harmonics = through_f16(&model, HalfPart::Harmonics);
        assert_eq!(harmonics.gaussians.sh[0][0], 0.099_975_586);
        assert_eq!((&harmonics.gaussians.means, &harmonics.field), (&model.gaussians.means, &model.field));
        let everything = through_f16(&model, HalfPart::Everything);
        assert_eq!(everything.gaussians.means[0], [65504.0, 0.099_975_586, -65504.0]);
        assert_ne!(everything.field, model.field);
        assert_eq!(through_f16(&everything, HalfPart::Everything), everything);

        let numbers = |part| stored_bytes(&Model { field: None, dynamic: Vec::new(), ..model.clone() }, part);
        assert_eq!(numbers(None), 400 * (11 + 12) * 4);
        assert_eq!(numbers(Some(HalfPart::Harmonics)), 400 * (11 * 4 + 12 * 2));
        assert_eq!(numbers(Some(HalfPart::AllButCentres)), 400 * (3 * 4 + 20 * 2));
        assert_eq!(numbers(Some(HalfPart::Everything)), 400 * 23 * 2);
    }
}
