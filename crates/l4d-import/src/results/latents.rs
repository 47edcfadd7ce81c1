//! Rendered latents of one frame: read, held against each other, and looked through for what users mistake for them.

use std::path::{Path, PathBuf};

use l4d_data::Report;

use l4d_formats::{Tensor, arrays};

use super::codes;
use super::relevancy::Latents;

/// Longer than any mean of unit vectors, with room for rounding.
const LONGEST: f32 = 1.05;

/// One level of one frame.
#[derive(Debug)]
pub(super) struct Level {
    /// Where it came from.
    pub(super) path: PathBuf,
    array: Tensor,
}

impl Level {
    /// Reads a level; what is no picture of latents is reported.
    pub(super) fn read(path: &Path, report: &mut Report) -> Option<Self> {
        let array = match arrays::read(path, None) {
            Ok(array) => array,
            Err(error) => {
                report.data_error(codes::UNREADABLE, &error);
                return None;
            }
        };
        let [height, width, channels] = array.shape[..] else {
            let message = format!("{:?} is no picture of latents (rows, columns, channels)", array.shape);
            let hint = "give the folders `renders_npy` of runs with --include_feature";
            report.error(codes::WIDTHS, path, "shape", message, hint);
            return None;
        };
        let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
        if !l4d_masks::Mask::is_sane_size(side(width), side(height)) || channels == 0 {
            report.error(codes::WRONG_SIZE, path, "shape", format!("{:?} is no picture", array.shape), "");
            return None;
        }
        if let Some((index, value)) = array.bad_value() {
            let pixel = index / channels;
            let place = format!("pixel ({}, {})", pixel % width, pixel / width);
            let hint =
                "training or rendering divided by zero: render the frame again from an earlier checkpoint";
            report.error(codes::NOT_FINITE, path, place, format!("is {value}"), hint);
            return None;
        }
        Some(Self { path: path.to_owned(), array })
    }

    /// The numbers as the engine takes them.
    pub(super) fn latents(&self) -> Latents<'_> {
        let [height, width, channels] = [self.array.shape[0], self.array.shape[1], self.array.shape[2]];
        Latents { width: width as u32, height: height as u32, channels, data: &self.array.data }
    }

    /// Width and height, pixels.
    pub(super) fn size(&self) -> (u32, u32) {
        let latents = self.latents();
        (latents.width, latents.height)
    }

    /// Whether these are probably colours: no negative number, and many pixels longer than any latent can be.
    ///
    /// LangSplat renders colours and latents into the same folder under the same names. A latent is a mean of unit
    /// vectors, so its length is at most 1, and negative numbers are usual. `is_stretched`: 0..1 means -1..1.
    fn looks_like_colours(&self, is_stretched: bool) -> bool {
        let latents = self.latents();
        if latents.channels != 3 || latents.data.iter().any(|&value| value < 0.0) {
            return false;
        }
        let pixels = latents.data.chunks_exact(3);
        let count = pixels.len();
        let meant = |value: &f32| if is_stretched { 2.0 * value - 1.0 } else { *value };
        let long = pixels
            .filter(|pixel| pixel.iter().map(|value| meant(value).powi(2)).sum::<f32>() > LONGEST * LONGEST);
        long.count() * 20 > count
    }

    /// The one value that all numbers have.
    pub(super) fn constant(&self) -> Option<f32> {
        let first = *self.array.data.first()?;
        self.array.data.iter().all(|&value| value == first).then_some(first)
    }
}

/// Reports what makes the levels of a frame no answer: colours, copies, blanks, sizes. True if they are sound.
/// `stretches`: whether a frame without a number of 0 or less is stored as (x + 1) / 2.
pub(super) fn check(levels: &[(u64, Level)], channels: usize, stretches: bool, report: &mut Report) -> bool {
    let before = report.len();
    let is_stretched =
        stretches && levels.iter().all(|(_, level)| level.latents().data.iter().all(|&value| value > 0.0));
    for (number, level) in levels {
        let latents = level.latents();
        if latents.channels != channels {
            let message = format!("has {} channels, but the decoder takes {channels}", latents.channels);
            let hint = if latents.channels > 6 {
                "these look decoded already, or come from a run without an autoencoder: render the compressed features (language_features_dim3)"
            } else {
                "give the decoder of the autoencoder that compressed these features"
            };
            report.error(codes::WIDTHS, &level.path, "shape", message, hint);
        }
        if level.looks_like_colours(is_stretched) {
            let hint = "LangSplat writes colours and latents into the same folder: render again with --include_feature, last";
            let message =
                "holds colours, not latents: nothing is negative, and many pixels are longer than 1";
            report.error(codes::RGB_AS_LATENT, &level.path, "numbers", message, hint);
        }
        if let Some(value) = level.constant() {
            let message = format!("is {value} everywhere");
            let hint = "the render is blank: check that the checkpoint was loaded, and that language_features_dim3 was there in training";
            report.error(codes::CONSTANT, &level.path, "numbers", message, hint);
        }
        if let Some((_, first)) = levels.first().filter(|(_, first)| first.size() != level.size()) {
            let ((w0, h0), (w1, h1)) = (first.size(), level.size());
            let message = format!("is {w1}x{h1}, but {} is {w0}x{h0}", first.path.display());
            let hint = "render all levels at the same size";
            report.error(codes::WRONG_SIZE, &level.path, "shape", message, hint);
        }
        let same = levels.iter().find(|(other, earlier)| other < number && earlier.array == level.array);
        if let Some((other, earlier)) = same.filter(|_| level.constant().is_none()) {
            let message = format!("is the same as level {other} ({})", earlier.path.display());
            let hint =
                "each level has a model of its own: render each from its own checkpoint (--feature_level)";
            report.error(codes::IDENTICAL_LEVELS, &level.path, "numbers", message, hint);
        }
    }
    report.len() == before
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(number: u64, shape: [usize; 3], value: impl Fn(usize) -> f32) -> (u64, Level) {
        let data: Vec<f32> = (0..shape.iter().product()).map(value).collect();
        let path = PathBuf::from(format!("level{number}.npy"));
        (number, Level { path, array: Tensor { shape: shape.to_vec(), data } })
    }

    fn found(levels: &[(u64, Level)], channels: usize) -> Vec<&'static str> {
        let mut report = Report::default();
        let is_sound = check(levels, channels, false, &mut report);
        assert_eq!(is_sound, report.is_empty());
        report.into_sorted().into_iter().map(|finding| finding.code).collect()
    }

    fn wave(seed: f32) -> impl Fn(usize) -> f32 {
        move |index| 0.5 * ((index as f32) * 0.7 + seed).sin()
    }

    #[test]
    fn sound_levels_pass() {
        assert!(found(&[level(1, [4, 5, 3], wave(0.0)), level(2, [4, 5, 3], wave(1.0))], 3).is_empty());
    }

    #[test]
    fn every_confusion_has_its_code() {
        let colours = |index: usize| [0.9, 0.8, 0.7][index % 3] - 0.001 * index as f32;
        assert_eq!(found(&[level(1, [4, 5, 3], colours)], 3), [codes::RGB_AS_LATENT]);
        assert_eq!(found(&[level(1, [4, 5, 3], |_| 0.0)], 3), [codes::CONSTANT]);
        let copies = [level(1, [4, 5, 3], wave(0.0)), level(2, [4, 5, 3], wave(0.0))];
        assert_eq!(found(&copies, 3), [codes::IDENTICAL_LEVELS]);
        let sizes = [level(1, [4, 5, 3], wave(0.0)), level(2, [5, 4, 3], wave(1.0))];
        assert_eq!(found(&sizes, 3), [codes::WRONG_SIZE]);
        assert_eq!(found(&[level(1, [4, 5, 512], wave(0.0))], 3), [codes::WIDTHS]);
    }

    #[test]
    fn unit_latents_that_are_stored_from_0_to_1_are_latents() {
        // Every component of +-1 / sqrt 3, as (x + 1) / 2.
        let unit = |index: usize| 0.5 + if (index % 7).is_multiple_of(2) { 0.288 } else { -0.288 };
        let levels = [level(1, [4, 5, 3], unit), level(2, [4, 5, 3], |index| unit(index + 1))];
        let is_sound = |stretches| check(&levels, 3, stretches, &mut Report::default());
        assert!(is_sound(true) && !is_sound(false), "their length is that of what they mean");
        let bright = [level(1, [4, 5, 3], |index| 0.9 + 0.001 * index as f32)];
        assert!(!check(&bright, 3, true, &mut Report::default()), "longer than 1, whatever they mean");
    }

    #[test]
    fn dark_colours_are_not_told_from_positive_latents() {
        // A latent without a negative number is rare, but short ones say nothing against it.
        assert!(found(&[level(1, [4, 5, 3], |index| 0.3 + 0.001 * index as f32)], 3).is_empty());
    }
}
