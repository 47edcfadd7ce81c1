//! When something happens: 4D LangSplat's decision which frames of a clip answer a sentence about a time.
//!
//! A frame's similarity is the mean cosine between the decoded features of time and the sentence, over the pixels of
//! the unsmoothed mask. Frames that are at or above the mean of all once they are smoothed answer. That mean is taken of the frames themselves, so at
//! least one frame always answers: "this never happens" cannot be said.

use l4d_masks::Mask;

use super::{Engine, Latents};

/// Weights of a frame's neighbours and of itself.
const WEIGHTS: [f64; 3] = [0.1, 0.8, 0.1];

/// Whether each frame answers, by similarities in the order of time.
pub fn gate(similarities: &[f64]) -> Vec<bool> {
    let threshold = similarities.iter().sum::<f64>() / similarities.len().max(1) as f64;
    let smoothed = |frame: usize| match similarities.get(frame.wrapping_sub(1)..frame + 2) {
        Some(near) => near.iter().zip(WEIGHTS).map(|(value, weight)| value * weight).sum(),
        // The first and the last frame lack a neighbour and stay as they are.
        None => similarities[frame],
    };
    (0..similarities.len()).map(|frame| smoothed(frame) >= threshold).collect()
}

/// Mean cosine over the pixels of a mask with each sentence of an engine of time; none where there is no pixel.
///
/// Only the pixels of the mask are decoded: a feature of time is thousands wide.
///
/// # Panics
/// If mask and latents have different sizes.
pub fn similarities(engine: &Engine, latents: Latents<'_>, mask: &Mask) -> Option<Vec<f64>> {
    assert_eq!(mask.size(), (latents.width, latents.height), "mask and latents");
    let width = latents.width as usize;
    let pixel = |(col, row): (u32, u32)| {
        &latents.data[(row as usize * width + col as usize) * latents.channels..][..latents.channels]
    };
    let data: Vec<f32> = mask.pixels().flat_map(pixel).copied().collect();
    let count = (data.len() / latents.channels) as u32;
    let row = Latents { width: count, height: 1, channels: latents.channels, data: &data };
    let mean = |cosines: Vec<f32>| cosines.into_iter().map(f64::from).sum::<f64>() / f64::from(count);
    (count > 0).then(|| engine.cosines(row).into_iter().map(mean).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_at_or_above_the_mean_answer() {
        // Mean 0.4; the third frame falls below it by its neighbours, the first has only one and stays.
        assert_eq!(gate(&[0.4, 0.2, 0.41, 0.2, 0.79]), [true, false, false, false, true]);
        // Lifted to 0.41 by its neighbours.
        assert_eq!(gate(&[0.5, 0.39, 0.48, 0.23, 0.4]), [true, true, true, false, true]);
        assert_eq!(gate(&[0.5, 0.5, 0.5]), [true; 3]);
        assert_eq!(gate(&[-0.2]), [true]);
        assert!(gate(&[]).is_empty());
    }
}
