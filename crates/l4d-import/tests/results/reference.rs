//! The reference of relevancy: every step as it is defined, pixel by pixel, in double precision.

use l4d_import::results::relevancy::{Decoder, Found, Latents, Rules, Smoothing, Summit, TextEmbeddings};
use l4d_masks::Mask;

/// How sharp the comparison with the phrases is.
const SHARPNESS: f64 = 10.0;

/// The definition.
pub(crate) struct Plain {
    decoder: Decoder,
    texts: TextEmbeddings,
}

impl Plain {
    pub(crate) fn new(decoder: Decoder, texts: TextEmbeddings) -> Self {
        Self { decoder, texts }
    }

    /// The embedding of a latent, of length 1.
    fn decode(&self, latent: &[f32]) -> Vec<f64> {
        let mut values: Vec<f64> = latent.iter().copied().map(f64::from).collect();
        let layers = self.decoder.layers();
        for (index, layer) in layers.iter().enumerate() {
            let rows = layer.weight.chunks_exact(layer.inputs).zip(&layer.bias);
            let products = rows.map(|(row, &bias)| f64::from(bias) + dot(&values, row));
            let is_last = index + 1 == layers.len();
            values = products.map(|value| if is_last { value } else { value.max(0.0) }).collect();
        }
        let length = values.iter().map(|value| value * value).sum::<f64>().sqrt();
        values.iter().map(|value| if length > 0.0 { value / length } else { 0.0 }).collect()
    }

    fn map(&self, latents: Latents<'_>, sentence: &[f32]) -> Vec<f64> {
        let pixel = |latent: &[f32]| {
            let embedding = self.decode(latent);
            let best_phrase =
                self.texts.phrases().map(|phrase| dot(&embedding, phrase)).fold(f64::NEG_INFINITY, f64::max);
            let margin = dot(&embedding, sentence) - best_phrase;
            1.0 / (1.0 + (-SHARPNESS * margin).exp())
        };
        latents.data.chunks_exact(latents.channels).map(pixel).collect()
    }
}

impl Plain {
    pub(crate) fn level(&self, latents: Latents<'_>, rules: &Rules) -> Vec<Found> {
        assert_eq!(latents.channels, self.decoder.inputs(), "channels of the latents");
        let picture = |sentence| Picture {
            width: latents.width as usize,
            height: latents.height as usize,
            values: self.map(latents, sentence),
        };
        self.texts.sentences().map(|sentence| picture(sentence).found(rules)).collect()
    }

    pub(crate) fn cosines(&self, latents: Latents<'_>) -> Vec<Vec<f32>> {
        assert_eq!(latents.channels, self.decoder.inputs(), "channels of the latents");
        let embeddings: Vec<Vec<f64>> =
            latents.data.chunks_exact(latents.channels).map(|latent| self.decode(latent)).collect();
        let cosines =
            |sentence: &[f32]| embeddings.iter().map(|embedding| dot(embedding, sentence) as f32).collect();
        self.texts.sentences().map(cosines).collect()
    }
}

fn dot(a: &[f64], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, &b)| a * f64::from(b)).sum()
}

struct Picture {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

impl Picture {
    fn found(self, rules: &Rules) -> Found {
        let means = self.means(rules.smoothing);
        let smoothed: Vec<f64> =
            means.iter().zip(&self.values).map(|(mean, value)| 0.5 * (mean + value)).collect();
        let floor = smoothed.iter().copied().fold(f64::INFINITY, f64::min);
        let peak = smoothed.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let is_inside = |value: f64| {
            let share = (value - floor) / (peak - floor + 1e-9);
            (share * 2.0 - 1.0).clamp(0.0, 1.0) > f64::from(rules.threshold)
        };
        let unsmoothed = Mask::from_fn(self.width as u32, self.height as u32, |col, row| {
            is_inside(smoothed[row as usize * self.width + col as usize])
        });
        let mask = majority(&unsmoothed, rules.smoothing);
        Found { mask, unsmoothed, peak: peak as f32, floor: floor as f32, summit: self.summit(&means) }
    }

    /// Where the mean is highest, the first of equals.
    fn summit(&self, means: &[f64]) -> Summit {
        let highest = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let index = means.iter().position(|&mean| mean == highest).unwrap_or(0);
        Summit::at(index, highest as f32, self.width, self.height)
    }

    /// The mean of the window around each pixel.
    fn means(&self, smoothing: Smoothing) -> Vec<f64> {
        let mut means = Vec::with_capacity(self.values.len());
        for row in 0..self.height {
            for col in 0..self.width {
                means.push(match smoothing {
                    Smoothing::Box30 => self.box_mean(row, col),
                    Smoothing::Pool29 => self.pool_mean(row, col),
                });
            }
        }
        means
    }

    /// Rows `row - 15` to `row + 14`, columns alike; beyond the border the picture is mirrored without its edge.
    fn box_mean(&self, row: usize, col: usize) -> f64 {
        let mut sum = 0.0;
        for down in 0..30 {
            for right in 0..30 {
                let y = mirrored(row as i64 + down - 15, self.height);
                let x = mirrored(col as i64 + right - 15, self.width);
                sum += self.values[y * self.width + x];
            }
        }
        sum / 900.0
    }

    /// The pixels at most 14 away that the picture has.
    fn pool_mean(&self, row: usize, col: usize) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for y in row.saturating_sub(14)..(row + 15).min(self.height) {
            for x in col.saturating_sub(14)..(col + 15).min(self.width) {
                sum += self.values[y * self.width + x];
                count += 1.0;
            }
        }
        sum / count
    }
}

/// OpenCV's border of mirrors: `... 2 1 | 0 1 2 ... n-1 | n-2 n-3 ...`.
fn mirrored(mut index: i64, length: usize) -> usize {
    let last = length as i64 - 1;
    if last == 0 {
        return 0;
    }
    while index < 0 || index > last {
        index = if index < 0 { -index } else { 2 * last - index };
    }
    index as usize
}

/// More than half of the pixels at most 3 away. In LangSplat the last row and column never vote.
fn majority(mask: &Mask, smoothing: Smoothing) -> Mask {
    let (width, height) = mask.size();
    let (voting_cols, voting_rows) = match smoothing {
        Smoothing::Box30 => (width - 1, height - 1),
        Smoothing::Pool29 => (width, height),
    };
    Mask::from_fn(width, height, |col, row| {
        let (mut inside, mut all) = (0, 0);
        for y in row.saturating_sub(3)..(row + 4).min(voting_rows) {
            for x in col.saturating_sub(3)..(col + 4).min(voting_cols) {
                inside += u32::from(mask.get(x, y));
                all += 1;
            }
        }
        2 * inside > all
    })
}
