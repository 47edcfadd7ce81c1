//! The ways of drawing that are compared. Each changes one thing of the model as it is, those of the last sweep several.

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::subject::Subject;
use super::{Result, plain};
use crate::raster::{Cpu, RasterSettings, Rasterizer};
use crate::reduce::{
    Displacement, HalfPart, keep, stored_bytes, strongest, through_f16, weights, with_sh_degree,
};
use crate::{Model, ShDegree};

/// What is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sweep {
    /// Fewer Gaussians: those that show most.
    Count,
    /// Lower degrees of the spherical harmonics.
    Degree,
    /// Thresholds of alpha and transmittance.
    Cutoffs,
    /// What hardly moves is frozen.
    Static,
    /// Smaller pictures, enlarged.
    Resolution,
    /// Parameters stored in 16-bit floats.
    F16,
    /// Other instructions, one thread, graphics adapters.
    Rasterizer,
    /// Several of these at once.
    Together,
}

/// Shares of the Gaussians that are kept, percent.
const COUNTS: [usize; 6] = [90, 75, 60, 45, 30, 15];
/// Thresholds of alpha, as parts of 255.
const ALPHAS: [f32; 6] = [0.25, 2.0, 4.0, 8.0, 16.0, 32.0];
const TRANSMITTANCES: [f32; 4] = [1e-3, 1e-2, 3e-2, 1e-1];
/// Displacement below which a Gaussian is frozen, metres.
const STILL_M: [f32; 6] = [0.001, 0.003, 0.01, 0.03, 0.1, f32::INFINITY];
/// Sides of drawn pictures, percent.
const SIDES: [u32; 4] = [75, 50, 35, 25];

/// Everything that draws.
pub(super) struct Backends {
    list: Vec<Backend>,
}

/// One of them.
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

impl Backends {
    /// The processor at its best, with what every backend of its kind can do, on one thread; then the adapters.
    pub(super) fn with(adapters: Vec<Backend>) -> Result<Self> {
        let processor = |cpu: Cpu, pool: Option<ThreadPool>| {
            let threads =
                pool.as_ref().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
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
        Ok(Self { list })
    }

    pub(super) fn rasterizer(&self, backend: usize) -> &dyn Rasterizer {
        self.list[backend].rasterizer.as_ref()
    }

    pub(super) fn pool(&self, backend: usize) -> Option<&ThreadPool> {
        self.list[backend].pool.as_ref()
    }

    /// What it is, for people.
    pub(super) fn name(&self, backend: usize) -> String {
        self.list[backend].name.clone()
    }

    fn others(&self) -> std::ops::Range<usize> {
        1..self.list.len()
    }
}

/// One way of drawing.
pub(super) struct Variant {
    pub(super) sweep: &'static str,
    pub(super) setting: String,
    pub(super) model: Model,
    pub(super) settings: RasterSettings,
    /// Displacement below which Gaussians were frozen, metres.
    pub(super) still_below_m: f32,
    /// Of the drawn pictures, pixels.
    pub(super) size: [u32; 2],
    pub(super) stored: &'static str,
    pub(super) bytes: u64,
    pub(super) backend: usize,
}

/// Name of the first row, against which the others stand.
pub(super) const BASE: &str = "as it is";

/// All variants of the chosen sweeps (all if none are named), the model as it is first.
pub(super) fn variants(subject: &Subject, sweeps: &[Sweep], backends: &Backends) -> Result<Vec<Variant>> {
    let wants = |sweep: Sweep| sweeps.is_empty() || sweeps.contains(&sweep);
    let mut list = vec![unchanged(subject, BASE, BASE.to_owned())];
    let ranked = Ranked::of(subject, backends)?;
    if wants(Sweep::Count) {
        list.extend(COUNTS.map(|percent| {
            let name = format!("{percent} % of the Gaussians");
            with_model(unchanged(subject, "fewer Gaussians", name), ranked.kept(&subject.model, percent))
        }));
    }
    if wants(Sweep::Degree) {
        for degree in (0..subject.model.gaussians.sh_degree.get()).rev() {
            let model =
                with_sh_degree(&subject.model, ShDegree::new(degree).unwrap_or_default()).map_err(plain)?;
            list.push(with_model(unchanged(subject, "lower degree", format!("degree {degree}")), model));
        }
    }
    if wants(Sweep::Cutoffs) {
        list.extend(ALPHAS.map(|parts| {
            let name = format!("alpha from {parts}/255");
            with_cutoffs(unchanged(subject, "alpha cutoff", name), parts / 255.0, None)
        }));
        list.extend(TRANSMITTANCES.map(|least| {
            let variant = unchanged(subject, "transmittance stop", format!("stop at {least}"));
            with_cutoffs(variant, RasterSettings::default().alpha_min, Some(least))
        }));
    }
    let motion = Displacement::of(&subject.model, &subject.all_times()).map_err(plain)?;
    if wants(Sweep::Static) && !subject.model.dynamic.is_empty() {
        for below_m in STILL_M {
            let name = if below_m.is_finite() {
                format!("still below {} mm", (below_m * 1000.0).round())
            } else {
                "nothing moves".to_owned()
            };
            let model = motion.freeze(&subject.model, below_m).map_err(plain)?;
            let variant = with_model(unchanged(subject, "frozen motion", name), model);
            list.push(Variant { still_below_m: below_m, ..variant });
        }
    }
    if wants(Sweep::Resolution) {
        list.extend(SIDES.map(|percent| {
            let size = scaled(subject.size, percent);
            Variant { size, ..unchanged(subject, "smaller pictures", format!("{percent} % of the side")) }
        }));
    }
    if wants(Sweep::F16) {
        let parts = [
            (HalfPart::Harmonics, "f16: harmonics"),
            (HalfPart::AllButCentres, "f16: all but centres"),
            (HalfPart::Everything, "f16: everything"),
        ];
        list.extend(parts.map(|(part, stored)| {
            let model = through_f16(&subject.model, part);
            let bytes = stored_bytes(&model, Some(part));
            let variant = with_model(unchanged(subject, "f16 storage", stored.to_owned()), model);
            Variant { stored, bytes, ..variant }
        }));
    }
    if wants(Sweep::Rasterizer) {
        list.extend(backends.others().map(|backend| Variant {
            backend,
            ..unchanged(subject, "other machinery", backends.list[backend].label.clone())
        }));
    }
    if wants(Sweep::Together) {
        list.extend(together(subject, &ranked, &motion)?);
    }
    Ok(list)
}

/// Several reductions at once, from careful to rough.
fn together(subject: &Subject, ranked: &Ranked, motion: &Displacement) -> Result<Vec<Variant>> {
    let step = |percent, below_m, parts, least, side| Step { percent, below_m, parts, least, side };
    let steps = [
        step(100, 0.003, 4.0_f32, 1e-3_f32, 100_u32),
        step(100, 0.01, 8.0, 1e-3, 75),
        step(95, 0.01, 8.0, 1e-3, 50),
        step(90, 0.03, 16.0, 1e-2, 35),
    ];
    let variant = |step: Step| {
        let model = ranked.kept(&motion.freeze(&subject.model, step.below_m).map_err(plain)?, step.percent);
        let Step { percent, below_m, parts, least, side } = step;
        let name = format!("{percent} %, {} mm, {parts}/255, side {side} %", (below_m * 1000.0).round());
        let variant = with_model(unchanged(subject, "several at once", name), model);
        let size = scaled(subject.size, side);
        Ok(Variant { still_below_m: below_m, size, ..with_cutoffs(variant, parts / 255.0, Some(least)) })
    };
    steps.into_iter().map(variant).collect()
}

/// How far each reduction goes in a row of several.
struct Step {
    /// Of the Gaussians.
    percent: usize,
    /// Displacement that is frozen, metres.
    below_m: f32,
    /// Smallest alpha, parts of 255.
    parts: f32,
    /// Transmittance at which a pixel is finished.
    least: f32,
    /// Of the pictures, percent.
    side: u32,
}

fn scaled(size: [u32; 2], percent: u32) -> [u32; 2] {
    size.map(|side| (side * percent / 100).max(1))
}

fn unchanged(subject: &Subject, sweep: &'static str, setting: String) -> Variant {
    Variant {
        sweep,
        setting,
        model: subject.model.clone(),
        settings: RasterSettings::default(),
        still_below_m: 0.0,
        size: subject.size,
        stored: "f32",
        bytes: stored_bytes(&subject.model, None),
        backend: 0,
    }
}

fn with_model(variant: Variant, model: Model) -> Variant {
    Variant { bytes: stored_bytes(&model, None), model, ..variant }
}

fn with_cutoffs(variant: Variant, alpha_min: f32, transmittance_min: Option<f32>) -> Variant {
    let transmittance_min = transmittance_min.unwrap_or(variant.settings.transmittance_min);
    Variant { settings: RasterSettings { alpha_min, transmittance_min, ..variant.settings }, ..variant }
}

/// How much each Gaussian shows from where training looks.
struct Ranked {
    weights: Vec<f64>,
}

impl Ranked {
    fn of(subject: &Subject, backends: &Backends) -> Result<Self> {
        let moments = subject.training_moments()?;
        let weights = weights(&subject.model, backends.rasterizer(0), &RasterSettings::default(), &moments)
            .map_err(plain)?;
        Ok(Self { weights })
    }

    fn kept(&self, model: &Model, percent: usize) -> Model {
        keep(model, &strongest(&self.weights, self.weights.len() * percent / 100))
    }
}
