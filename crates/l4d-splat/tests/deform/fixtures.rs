//! What the fixture scripts wrote, and how near two lists of numbers are.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use l4d_splat::Tensor;
use l4d_splat::deform::{Bounds, DeformConfig, DeformationField, Offsets};
use serde::Deserialize;
use serde::de::DeserializeOwned;

pub(crate) fn read<T: DeserializeOwned>(name: &str) -> T {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name);
    serde_json::from_slice(&fs::read(&path).unwrap()).unwrap()
}

#[derive(Debug, Deserialize)]
pub(crate) struct Named {
    pub(crate) shape: Vec<usize>,
    pub(crate) data: Vec<f64>,
}

pub(crate) fn tensors(named: &BTreeMap<String, Named>) -> BTreeMap<String, Tensor> {
    let tensor = |named: &Named| Tensor { shape: named.shape.clone(), data: narrow(&named.data) };
    named.iter().map(|(name, named)| (name.clone(), tensor(named))).collect()
}

pub(crate) fn narrow(list: &[f64]) -> Vec<f32> {
    list.iter().map(|&value| value as f32).collect()
}

pub(crate) fn wide(list: &[f32]) -> Vec<f64> {
    list.iter().copied().map(f64::from).collect()
}

/// Flat lists of the fields of [`Offsets`], as the fixtures have them.
#[derive(Debug, Deserialize)]
pub(crate) struct Lists {
    means: Vec<f64>,
    log_scales: Vec<f64>,
    rotations: Vec<f64>,
    opacity_logits: Vec<f64>,
    sh: Vec<f64>,
}

impl Lists {
    pub(crate) fn each(&self) -> [(&'static str, &[f64]); 5] {
        [
            ("means", &self.means),
            ("log_scales", &self.log_scales),
            ("rotations", &self.rotations),
            ("opacity_logits", &self.opacity_logits),
            ("sh", &self.sh),
        ]
    }

    pub(crate) fn offsets(&self) -> Offsets {
        Offsets {
            means: narrow(&self.means).as_chunks().0.to_vec(),
            log_scales: narrow(&self.log_scales).as_chunks().0.to_vec(),
            rotations: narrow(&self.rotations).as_chunks().0.to_vec(),
            opacity_logits: narrow(&self.opacity_logits),
            sh: narrow(&self.sh).as_chunks().0.to_vec(),
            ..Offsets::default()
        }
    }
}

/// Largest difference; lists of different lengths are infinitely far apart, and so is NaN.
pub(crate) fn largest_difference(found: &[f32], expected: &[f64]) -> f64 {
    if found.len() != expected.len() {
        return f64::INFINITY;
    }
    let difference = |(found, expected): (&f32, &f64)| (f64::from(*found) - expected).abs();
    let differences = found.iter().zip(expected).map(difference);
    differences.fold(0.0, |largest, value| if value.is_nan() { f64::INFINITY } else { largest.max(value) })
}

/// Largest difference as a share of the largest value that is expected.
pub(crate) fn relative_difference(found: &[f32], expected: &[f64]) -> f64 {
    let scale = expected.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    largest_difference(found, expected) / scale.max(1.0e-12)
}

/// A small untrained field in the box from -1 to 1 whose heads do something.
pub(crate) fn small_field(config: DeformConfig, seed: u64) -> DeformationField {
    let bounds = Bounds::new([[1.0; 3], [-1.0; 3]]).unwrap();
    DeformationField::new(config, bounds, l4d_splat::deform::Init::Foreign, seed).unwrap()
}

/// A field of five heads that a test can afford.
pub(crate) fn small_config() -> DeformConfig {
    DeformConfig {
        channels: 4,
        spatial_resolution: [5, 4, 6],
        time_resolution: 7,
        width: 16,
        sh_coefficients: 4,
        ..DeformConfig::dynerf()
    }
}

/// Positions in and around the box from -1 to 1, from a seed.
pub(crate) fn positions(rows: usize, seed: u32) -> Vec<[f32; 3]> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 * 2.4 - 1.2
    };
    (0..rows).map(|_| std::array::from_fn(|_| next())).collect()
}
