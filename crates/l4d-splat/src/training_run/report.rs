//! How good a model is and what it took.

use std::time::Instant;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::train::Quality;

/// What is said of a finished training.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Report {
    /// On all training pictures; depth where something moves.
    pub(super) train: Quality,
    /// On the held-out camera, which was not trained on; depth inside objects.
    pub(super) test: Option<Quality>,
    pub(super) iterations: u64,
    /// Whether it stopped before its last iteration because nothing was left to gain.
    pub(super) settled: bool,
    pub(super) gaussians: usize,
    pub(super) dynamic: usize,
    pub(super) pictures_bytes: u64,
    /// Of the whole process; none where the system does not say.
    pub(super) peak_memory_bytes: Option<u64>,
    pub(super) read_seconds: f64,
    pub(super) prepare_seconds: f64,
    pub(super) train_seconds: f64,
    pub(super) measure_seconds: f64,
    /// Of the iterations on the whole clip, in all runs together.
    pub(super) fine: Effort,
}

/// What some iterations took, nothing but the iterations counted.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Effort {
    pub(super) iterations: u64,
    pub(super) seconds: f64,
    /// Of all threads together.
    pub(super) cpu_seconds: f64,
}

impl Effort {
    /// Does something that is an iteration.
    pub(super) fn spend<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (begin, cpu) = (Instant::now(), cpu_seconds());
        let result = work();
        self.iterations += 1;
        self.seconds += begin.elapsed().as_secs_f64();
        self.cpu_seconds += cpu_seconds() - cpu;
        result
    }
}

/// Processor time of the process so far.
fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// The report of a manifest, for a terminal.
pub(super) fn table(manifest: &Value) -> String {
    let number = |path: &str| manifest.pointer(path).and_then(Value::as_f64);
    let show = |path: &str, factor: f64, digits: usize| {
        number(path).map_or_else(|| "-".to_owned(), |value| format!("{:.digits$}", value * factor))
    };
    let mut lines = vec!["views     pictures  PSNR dB   SSIM  moving dB  depth error mm".to_owned()];
    for (name, path) in [("training", "/report/train"), ("held out", "/report/test")] {
        lines.push(format!(
            "{name:8}  {:>8}  {:>7}  {:>5}  {:>9}  {:>14}",
            show(&format!("{path}/pictures"), 1.0, 0),
            show(&format!("{path}/psnr_db"), 1.0, 2),
            show(&format!("{path}/ssim"), 1.0, 3),
            show(&format!("{path}/psnr_moving_db"), 1.0, 2),
            show(&format!("{path}/depth_error_m"), 1e3, 1),
        ));
    }
    lines.push(format!(
        "{} Gaussians, {} of them dynamic; {} iterations in {} s; peak memory {} MB",
        show("/report/gaussians", 1.0, 0),
        show("/report/dynamic", 1.0, 0),
        show("/report/iterations", 1.0, 0),
        show("/report/train_seconds", 1.0, 0),
        show("/report/peak_memory_bytes", 1e-6, 0),
    ));
    lines.join("\n")
}
