//! From rendered latents to masks, as LangSplat and 4D LangSplat do it, without CLIP and without a GPU.
//!
//! A latent is decoded to the width of CLIP, compared with a sentence and with four phrases that mean anything, and
//! the map of that comparison is smoothed, stretched over its own range and cut ([`Rules`]). Of several levels the
//! one with the highest peak answers.

pub mod decoder;
mod engine;
pub mod gate;
mod smooth;
pub mod texts;

use l4d_masks::Mask;
use serde::{Deserialize, Serialize};

pub use decoder::Decoder;
pub use engine::Engine;
pub use texts::{TextEmbeddings, TextEmbeddingsFile};

/// How sharp the comparison with the phrases is.
const SHARPNESS: f32 = 10.0;

/// Which of the two published smoothings is meant: their masks differ (IoU 0.97 on a synthetic map).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Smoothing {
    /// LangSplat: a box of 30 x 30 with mirrored borders; the last row and column never vote in the majority.
    Box30,
    /// LangSplatV2 and 4D LangSplat: the mean of 29 x 29 pixels, of those inside the picture.
    Pool29,
}

/// How a map of relevancy becomes a mask.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rules {
    pub smoothing: Smoothing,
    /// Inside is what lies above `(1 + threshold) / 2` of the map's own range.
    pub threshold: f32,
    /// 4D LangSplat's own reading of frames without any negative number: they are stretched from 0..1 to -1..1.
    #[serde(default)]
    pub stretch_positive: bool,
}

/// A picture of latents, row by row, the channels of a pixel together.
#[derive(Debug, Clone, Copy)]
pub struct Latents<'a> {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Numbers a pixel.
    pub channels: usize,
    pub data: &'a [f32],
}

/// What one level says of one sentence.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The mask after the majority vote of neighbours.
    pub mask: Mask,
    /// The mask before it: where 4D LangSplat looks for what happens.
    pub unsmoothed: Mask,
    /// The highest smoothed relevancy, by which levels compete.
    pub peak: f32,
    /// The lowest one.
    pub floor: f32,
    /// Where LangSplat's localisation looks.
    pub summit: Summit,
}

/// Where the mean over the window alone is highest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summit {
    pub height: f32,
    /// The pixel, the first of equals row by row: its centre, as a share of width and of height.
    pub at: [f64; 2],
}

impl Summit {
    /// The pixel of this index, row by row.
    pub fn at(index: usize, height: f32, cols: usize, rows: usize) -> Self {
        let share = |place: usize, count: usize| (place as f64 + 0.5) / count as f64;
        Self { height, at: [share(index % cols, cols), share(index / cols, rows)] }
    }
}

/// The answer of a frame to one sentence.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Which level answers, from 0.
    pub level: usize,
    /// What it says.
    pub found: Found,
    /// The highest summit of all levels: they compete for it apart.
    pub summit: Summit,
}

/// The answer of a frame to each sentence: the level with the highest peak, the first of equals.
pub fn answer(engine: &Engine, levels: &[Latents<'_>], rules: &Rules) -> Vec<Chosen> {
    let lowest = || levels.iter().flat_map(|level| level.data).copied().fold(f32::INFINITY, f32::min);
    if rules.stretch_positive && lowest() > 0.0 {
        let stretched: Vec<Vec<f32>> =
            levels.iter().map(|level| level.data.iter().map(|value| value * 2.0 - 1.0).collect()).collect();
        let levels = levels.iter().zip(&stretched).map(|(level, data)| Latents { data, ..*level });
        return best(engine, levels, rules);
    }
    best(engine, levels.iter().copied(), rules)
}

fn best<'a>(engine: &Engine, levels: impl Iterator<Item = Latents<'a>>, rules: &Rules) -> Vec<Chosen> {
    let mut chosen: Vec<Chosen> = Vec::new();
    for (level, latents) in levels.enumerate() {
        let found = engine.level(latents, rules).into_iter();
        if level == 0 {
            chosen = found.map(|found| Chosen { level, summit: found.summit, found }).collect();
            continue;
        }
        for (best, found) in chosen.iter_mut().zip(found) {
            let summit = if found.summit.height > best.summit.height { found.summit } else { best.summit };
            if found.peak > best.found.peak {
                *best = Chosen { level, summit, found };
            }
            best.summit = summit;
        }
    }
    chosen
}

/// The rules upon a map of relevancy that was made elsewhere.
pub fn of_map(map: Vec<f32>, width: u32, height: u32, rules: &Rules) -> Found {
    smooth::find(map, width as usize, height as usize, rules)
}

/// Probability of the sentence beside the phrase that fits best.
fn relevancy(sentence: f32, best_phrase: f32) -> f32 {
    1.0 / (1.0 + (-SHARPNESS * (sentence - best_phrase)).exp())
}
