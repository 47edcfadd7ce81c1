//! The variants whose drawing speed is compared: fewer Gaussians, smaller pictures, other rasterizers. Each changes one
//! thing of the model as it is. Measures nothing itself.

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Deserialize;

use super::subject::Subject;
use super::{Result, plain};
use crate::Model;
use crate::clip::{ClipError, TimeViews};
use crate::deform::DeformationField;
use crate::raster::{Cpu, RasterSettings, Rasterizer};

/// What the variants of a sweep change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sweep {
    /// Fewer Gaussians: those with the largest blend weights are kept.
    Count,
    /// Smaller pictures, enlarged to full size.
    Resolution,
    /// Portable instructions, one thread, graphics adapters.
    Rasterizer,
}

/// Shares of the Gaussians that are kept, percent.
const COUNTS: [usize; 6] = [90, 75, 60, 45, 30, 15];
/// Sides of drawn pictures, percent of the full ones.
const SIDES: [u32; 4] = [75, 50, 35, 25];

/// A rasterizer with the threads that it may use.
pub struct Backend {
    pub label: String,
    pub name: String,
    pub rasterizer: Box<dyn Rasterizer>,
    /// None for all threads.
    pub pool: Option<ThreadPool>,
}

/// The CPU with the best instructions of this machine, with those that every machine of this target has, and on one
/// thread; then the adapters.
pub(super) fn backends(adapters: Vec<Backend>) -> Result<Vec<Backend>> {
    let processor = |cpu: Cpu, pool: Option<ThreadPool>| {
        let threads = pool.as_ref().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
        let name = format!("{}, {threads} thread{}", cpu.name(), if threads == 1 { "" } else { "s" });
        Backend { label: name.clone(), name, rasterizer: Box::new(cpu), pool }
    };
    let one_thread = ThreadPoolBuilder::new().num_threads(1).build().map_err(plain)?;
    let mut list = vec![
        processor(Cpu::new(), None),
        processor(Cpu::portable(), None),
        processor(Cpu::new(), Some(one_thread)),
    ];
    list.extend(adapters);
    Ok(list)
}

/// What is drawn, how large, and with which backend.
#[derive(Clone)]
pub(super) struct Variant<'a> {
    pub(super) sweep: &'static str,
    pub(super) setting: String,
    pub(super) model: Model,
    /// Of the drawn pictures, pixels.
    pub(super) size: [u32; 2],
    pub(super) backend: &'a Backend,
}

/// Name of the first row, with which the others are compared.
pub(super) const BASE: &str = "as it is";

/// All variants of the chosen sweeps (all if none are named), the model as it is first.
pub(super) fn variants<'a>(
    subject: &Subject,
    sweeps: &[Sweep],
    backends: &'a [Backend],
) -> Result<Vec<Variant<'a>>> {
    let wants = |sweep: Sweep| sweeps.is_empty() || sweeps.contains(&sweep);
    let (model, size, backend) = (&subject.model, subject.size, &backends[0]);
    let base = Variant { sweep: BASE, setting: BASE.to_owned(), model: model.clone(), size, backend };
    let named = |sweep, setting| Variant { sweep, setting, ..base.clone() };
    let mut list = vec![base.clone()];
    if wants(Sweep::Count) {
        let moments = subject.training_moments()?;
        let rasterizer = backend.rasterizer.as_ref();
        let sums = blend_weight_sums(model, rasterizer, &RasterSettings::default(), &moments);
        let sums = sums.map_err(plain)?;
        list.extend(COUNTS.map(|percent| {
            let model = model.keep(&largest(&sums, sums.len() * percent / 100));
            Variant { model, ..named("fewer Gaussians", format!("{percent} % of the Gaussians")) }
        }));
    }
    if wants(Sweep::Resolution) {
        list.extend(SIDES.map(|percent| {
            let size = size.map(|side| (side * percent / 100).max(1));
            Variant { size, ..named("smaller pictures", format!("{percent} % of the side")) }
        }));
    }
    if wants(Sweep::Rasterizer) {
        let others = backends[1..].iter();
        list.extend(
            others.map(|backend| Variant { backend, ..named("other machinery", backend.label.clone()) }),
        );
    }
    Ok(list)
}

/// For each Gaussian the sum of its blend weights over all pixels of all views.
fn blend_weight_sums<Key: Sync>(
    model: &Model,
    rasterizer: &dyn Rasterizer,
    settings: &RasterSettings,
    moments: &[TimeViews<Key>],
) -> Result<Vec<f64>, ClipError> {
    let mut sums = vec![0.0; model.gaussians.len()];
    for TimeViews { time, views } in moments {
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

/// The `count` Gaussians with the largest sums, by ascending index; of equals the first.
fn largest(sums: &[f64], count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..sums.len() as u32).collect();
    order.sort_by(|&a, &b| sums[b as usize].total_cmp(&sums[a as usize]));
    order.truncate(count);
    order.sort_unstable();
    order
}

/// Bytes of a model's parameters, 4 each.
pub(super) fn stored_bytes(model: &Model) -> u64 {
    let gaussians = &model.gaussians;
    let field = model.field.as_ref().map(DeformationField::tensors).unwrap_or_default();
    let numbers = (3 + 3 + 4 + 1) * gaussians.len() + 3 * gaussians.sh.len() + model.dynamic.len();
    4 * (numbers + field.values().map(|tensor| tensor.data.len()).sum::<usize>()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Room;

    #[test]
    fn the_largest_are_kept_in_their_order_and_of_equals_the_first() {
        assert_eq!(largest(&[1.0, 3.0, 2.0, 3.0, 2.0], 3), [1, 2, 3]);
        assert_eq!(largest(&[1.0], 5), [0]);
        assert!(largest(&[], 2).is_empty());
    }

    #[test]
    fn blend_weights_of_all_gaussians_add_up_to_the_alpha_of_the_pictures() {
        let room = Room::small(11);
        let views: Vec<((), _)> =
            room.views([32, 24]).unwrap().into_iter().take(3).map(|view| ((), view)).collect();
        let moments = [TimeViews { time: 0.25, views: views.clone() }];
        let settings = RasterSettings::default();
        let model = room.model().unwrap();
        let total: f64 = blend_weight_sums(&model, &Cpu::new(), &settings, &moments).unwrap().iter().sum();
        let splats = model.at(0.25).unwrap();
        let drawn: f64 = views
            .iter()
            .map(|(_, view)| Cpu::new().prepare(&splats, view, &settings).unwrap().draw().unwrap())
            .flat_map(|drawing| drawing.alpha.into_iter().map(f64::from).collect::<Vec<_>>())
            .sum();
        assert!((total - drawn).abs() < 1e-3 * drawn, "{total} and {drawn}");
    }
}
