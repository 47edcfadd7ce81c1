//! When something happens: 4D LangSplat's decision which frames of a clip answer a sentence about a time.
//!
//! A frame's similarity is the mean cosine between the decoded features of time and the sentence, over the pixels of
//! the unsmoothed mask. Frames at or above the mean of all answer. That mean is taken of the frames themselves, so at
//! least one frame always answers: "this never happens" cannot be said.

use l4d_frames::Mask;

/// Weights of a frame's neighbours and of itself.
const WEIGHTS: [f64; 3] = [0.1, 0.8, 0.1];

/// What the gate says of the frames of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Gate {
    /// Similarity of each frame after smoothing.
    pub smoothed: Vec<f64>,
    /// The mean of all frames before it.
    pub threshold: f64,
    /// Whether each frame answers.
    pub open: Vec<bool>,
}

/// Opens the gate for frames by their similarities, in the order of time. `smooth` is what the published script asks for.
pub fn gate(similarities: &[f64], smooth: bool) -> Gate {
    let threshold = similarities.iter().sum::<f64>() / similarities.len().max(1) as f64;
    let smoothed: Vec<f64> = (0..similarities.len())
        .map(|frame| match similarities.get(frame.wrapping_sub(1)..frame + 2) {
            Some(near) if smooth => near.iter().zip(WEIGHTS).map(|(value, weight)| value * weight).sum(),
            // The first and the last frame lack a neighbour and stay as they are.
            _ => similarities[frame],
        })
        .collect();
    let open = smoothed.iter().map(|&value| value >= threshold).collect();
    Gate { smoothed, threshold, open }
}

/// Mean of a picture of cosines over the pixels of a mask; none where there is no pixel.
pub fn similarity(cosines: &[f32], mask: &Mask) -> Option<f64> {
    let width = mask.width() as usize;
    let (mut sum, mut count) = (0.0, 0_u64);
    for (col, row) in mask.pixels() {
        sum += f64::from(cosines[row as usize * width + col as usize]);
        count += 1;
    }
    (count > 0).then(|| sum / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_at_or_above_the_mean_answer() {
        // Mean 0.4; the third frame falls below it by its neighbours, the first has only one and stays.
        let gate = gate(&[0.4, 0.2, 0.41, 0.2, 0.79], true);
        assert_eq!(gate.threshold, 0.4);
        let expected = [0.4, 0.241, 0.368, 0.28, 0.79];
        assert!(gate.smoothed.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{gate:?}");
        assert_eq!(gate.open, [true, false, false, false, true]);
    }

    #[test]
    fn equal_frames_all_answer_and_one_frame_answers() {
        assert_eq!(gate(&[0.5, 0.5, 0.5], true).open, [true; 3]);
        assert_eq!(gate(&[-0.2], true).open, [true]);
        assert_eq!(gate(&[0.1, 0.3], false).open, [false, true]);
        assert!(gate(&[], true).open.is_empty());
    }

    #[test]
    fn similarity_looks_at_the_mask_alone() {
        let mask = Mask::from_fn(2, 2, |col, _| col == 1);
        assert_eq!(similarity(&[9.0, 0.25, 9.0, 0.75], &mask), Some(0.5));
        assert_eq!(similarity(&[9.0; 4], &Mask::empty(2, 2)), None);
    }
}
