//! How wrong the oracle is: shares, lengths in pixels, and how errors of different views are correlated.
//!
//! Knows nothing of pictures and draws nothing; [`super::draws`] does.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::{Category, DataError, toml_file};
use serde::{Deserialize, Serialize};

/// Correlations of the ablation of consensus.
pub const CORRELATIONS: [f64; 4] = [0.0, 0.3, 0.6, 0.9];
/// Widest edge error, pixels: beyond any profile's objects.
const MAX_PX: u32 = 512;

/// The errors of the oracle. Applied in this order: a dropped view says nothing else; a swap decides what is shown;
/// then each frame flickers and has its edges moved. Without any it is what the training views show, pixel for pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NoiseModel {
    /// Views that mean another object.
    pub swap: Swap,
    /// Share of views that say absent, 0 to 1; each view for itself.
    pub dropped_views: f64,
    /// Share of frames in which nothing is shown, 0 to 1; each frame for itself.
    pub flicker: f64,
    /// Pixels by which outlines move, from the first to the second number, uniformly and anew in each frame: below 0
    /// inwards, above 0 outwards. Small objects may vanish.
    pub edge_px: [i32; 2],
}

/// Views that show a look-alike in place of the referent, all of a query the same one.
///
/// The views of a query share a chance of being swapped, which is drawn from Beta(a, b) with
/// a = p (1 / rho - 1), b = (1 - p) (1 / rho - 1); given that, views are independent. The number of swapped views
/// among n is then beta-binomial: mean n p, variance n p (1 - p) (1 + (n - 1) rho), and rho is the correlation of any
/// two views. At rho = 0 all queries have the chance p; at rho = 1 all views are swapped or none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Swap {
    /// Share of views that are swapped (p), 0 to 1.
    pub probability: f64,
    /// Correlation of any two views of a query (rho), 0 to 1.
    pub correlation: f64,
}

/// A noise model for a whole benchmark, as a TOML file holds it: one for all queries, but for the share of swaps,
/// which may depend on the category.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoisePreset {
    /// Seed of every draw.
    pub seed: u64,
    /// What holds for all queries.
    #[serde(default)]
    pub noise: NoiseModel,
    /// Category -> share of swapped views, in place of that of `noise`. A query of two categories takes the larger.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub swap_probability: BTreeMap<Category, f64>,
}

impl NoisePreset {
    /// The truth itself.
    pub fn none() -> Self {
        Self::default()
    }

    /// Reads a preset.
    ///
    /// # Errors
    /// The file cannot be read, or a number in it cannot be.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let preset: Self = toml_file::read(path, "see docs/panopticquery.md for the fields of a preset")?;
        match preset.problem() {
            Some(message) => {
                Err(DataError::invalid(path, "noise preset", message, "write a number of that range"))
            }
            None => Ok(preset),
        }
    }

    /// The first number that cannot be.
    fn problem(&self) -> Option<String> {
        let NoiseModel { swap, dropped_views, flicker, edge_px: [inwards, outwards] } = self.noise;
        let mut shares = vec![
            ("swap.probability".to_owned(), swap.probability),
            ("swap.correlation".to_owned(), swap.correlation),
            ("dropped_views".to_owned(), dropped_views),
            ("flicker".to_owned(), flicker),
        ];
        let of_categories = self.swap_probability.iter();
        shares.extend(
            of_categories.map(|(kind, share)| (format!("swap_probability.{}", kind.as_str()), *share)),
        );
        if let Some((field, share)) = shares.into_iter().find(|(_, share)| !(0.0..=1.0).contains(share)) {
            return Some(format!("`{field}` is {share}, but a share lies between 0 and 1"));
        }
        let is_far = |pixels: i32| pixels.unsigned_abs() > MAX_PX;
        (inwards > outwards || is_far(inwards) || is_far(outwards)).then(|| {
            format!(
                "`edge_px` is [{inwards}, {outwards}], but it is [smallest, largest] in pixels, from -{MAX_PX} to {MAX_PX}"
            )
        })
    }

    /// The errors of a query of these categories.
    pub fn of_categories(&self, categories: &[Category]) -> NoiseModel {
        let stated = categories.iter().filter_map(|category| self.swap_probability.get(category));
        let probability = stated.copied().reduce(f64::max).unwrap_or(self.noise.swap.probability);
        NoiseModel { swap: Swap { probability, ..self.noise.swap }, ..self.noise }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_is_read_with_its_defaults_and_its_categories() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("noise.toml");
        let text = "seed = 7\n\
            [noise]\ndropped_views = 0.1\nedge_px = [-2, 1]\n\
            [noise.swap]\ncorrelation = 0.6\nprobability = 0.05\n\
            [swap_probability]\naction = 0.2\nspatial = 0.3\n";
        std::fs::write(&path, text).unwrap();
        let preset = NoisePreset::read(&path).unwrap();
        assert_eq!((preset.seed, preset.noise.dropped_views, preset.noise.flicker), (7, 0.1, 0.0));
        assert_eq!(preset.noise.edge_px, [-2, 1]);
        assert_eq!(preset.noise.swap, Swap { probability: 0.05, correlation: 0.6 });
        let share = |categories: &[Category]| preset.of_categories(categories).swap.probability;
        assert_eq!(share(&[Category::Attribute]), 0.05);
        assert_eq!(share(&[Category::Action]), 0.2);
        assert_eq!(share(&[Category::Spatial, Category::Action]), 0.3);
        assert_eq!(preset.of_categories(&[Category::Action]).swap.correlation, 0.6);
        let again: NoisePreset = toml::from_str(&toml::to_string(&preset).unwrap()).unwrap();
        assert_eq!(again, preset);
    }

    #[test]
    fn numbers_that_cannot_be_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("noise.toml");
        for (text, words) in [
            ("seed = 0\n[noise.swap]\nprobability = 1.5", "`swap.probability` is 1.5"),
            ("seed = 0\n[noise.swap]\ncorrelation = nan", "`swap.correlation` is NaN"),
            ("seed = 0\n[noise]\nedge_px = [1, 0]", "`edge_px` is [1, 0]"),
            ("seed = 0\n[noise]\nedge_px = [-2147483648, 0]", "`edge_px`"),
            ("seed = 0\n[swap_probability]\naction = 2.0", "`swap_probability.action` is 2"),
            ("seed = 0\n[noise]\nflickr = 0.1", "flickr"),
            ("seed = 0\n[swap_probability]\ncolour = 0.1", "colour"),
            ("[noise]", "seed"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error = NoisePreset::read(&path).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
