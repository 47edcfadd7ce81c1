//! The ways of drawing that are compared. Each changes one thing of the model as it is.

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::subject::Subject;
use super::{Result, plain};
use crate::raster::{Cpu, RasterSettings, Rasterizer};
use crate::reduce::{keep, strongest, weights, with_sh_degree};
use crate::{Model, ShDegree};

/// What is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sweep {
    /// Fewer Gaussians: those that show most.
    Count,
    /// Lower degrees of the spherical harmonics.
    Degree,
    /// Smaller pictures, enlarged.
    Resolution,
    /// Other instructions, one thread, graphics adapters.
    Rasterizer,
}

/// Shares of the Gaussians that are kept, percent.
const COUNTS: [usize; 6] = [90, 75, 60, 45, 30, 15];
/// Sides of drawn pictures, percent.
const SIDES: [u32; 4] = [75, 50, 35, 25];

/// Something that draws.
pub struct Backend {
    /// In figures.
    pub label: String,
    /// In full.
    pub name: String,
    /// What draws.
    pub rasterizer: Box<dyn Rasterizer>,
    /// Threads that it may use; none for all.
    pub pool: Option<ThreadPool>,
}

/// The processor at its best, with what every backend of its kind can do, on one thread; then the adapters.
pub(super) fn backends(adapters: Vec<Backend>) -> Result<Vec<Backend>> {
    let processor = |cpu: Cpu, pool: Option<ThreadPool>| {
        let threads = pool.as_ref().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
        let name = format!("{}, {threads} thread{}", cpu.name(), if threads == 1 { "" } else { "s" });
        Backend { label: name.clone(), name, rasterizer: Box::new(cpu), pool }
    };
    let alone = ThreadPoolBuilder::new().num_threads(1).build().map_err(plain)?;
    let mut list = vec![
        processor(Cpu::new(), None),
        processor(Cpu::portable(), None),
        processor(Cpu::new(), Some(alone)),
    ];
    list.extend(adapters);
    Ok(list)
}

/// One way of drawing.
#[derive(Clone)]
pub(super) struct Variant<'a> {
    pub(super) sweep: &'static str,
    pub(super) setting: String,
    pub(super) model: Model,
    /// Of the drawn pictures, pixels.
    pub(super) size: [u32; 2],
    pub(super) backend: &'a Backend,
}

/// Name of the first row, against which the others stand.
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
        let shown = weights(model, backend.rasterizer.as_ref(), &RasterSettings::default(), &moments);
        let shown = shown.map_err(plain)?;
        list.extend(COUNTS.map(|percent| {
            let model = keep(model, &strongest(&shown, shown.len() * percent / 100));
            Variant { model, ..named("fewer Gaussians", format!("{percent} % of the Gaussians")) }
        }));
    }
    if wants(Sweep::Degree) {
        for degree in (0..model.gaussians.sh_degree.get()).rev() {
            let model = with_sh_degree(model, ShDegree::new(degree).unwrap_or_default()).map_err(plain)?;
            list.push(Variant { model, ..named("lower degree", format!("degree {degree}")) });
        }
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
