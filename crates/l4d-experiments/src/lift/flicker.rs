//! Flicker: pixels of the answer that come and go from frame to frame although the truth's do not.

use l4d_masks::Mask;

/// For each two neighbouring frames, the pixels that change in the answer beyond as many as change in the truth; their
/// mean over the clip, as percent of the mean area of the truth where it is seen. A still answer to a moving truth has
/// none, and neither has the truth itself. None where the truth is never seen, or has a single frame.
pub(super) fn flicker(answer: &[Mask], truth: &[Mask]) -> Option<f64> {
    let areas: Vec<u64> = truth.iter().map(Mask::area).filter(|&area| area > 0).collect();
    let pairs = answer.len().min(truth.len()).checked_sub(1).filter(|&pairs| pairs > 0)?;
    let area = areas.iter().sum::<u64>() as f64 / (!areas.is_empty()).then_some(areas.len() as f64)?;
    let beyond: u64 =
        changes(answer).zip(changes(truth)).map(|(answer, truth)| answer.saturating_sub(truth)).sum();
    Some(100.0 * beyond as f64 / pairs as f64 / area)
}

fn changes(masks: &[Mask]) -> impl Iterator<Item = u64> {
    masks.windows(2).map(|pair| match pair {
        [before, after] => before.and_not_count(after) + after.and_not_count(before),
        _ => 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar of columns.
    fn bar(columns: std::ops::Range<u32>) -> Mask {
        Mask::from_fn(10, 2, |column, _| columns.contains(&column))
    }

    #[test]
    fn by_hand() {
        let still = [bar(0..2), bar(0..2), bar(0..2)];
        assert_eq!(flicker(&still, &still), Some(0.0));
        // Gone in the middle: 4 of 4 pixels change twice.
        assert_eq!(flicker(&[bar(0..2), bar(0..0), bar(0..2)], &still), Some(100.0));
        // As large, but elsewhere in the middle: 8 pixels change twice.
        assert_eq!(flicker(&[bar(0..2), bar(5..7), bar(0..2)], &still), Some(200.0));
        // What moves with the truth does not flicker, one column too much of it does: 2 of 4 pixels, once in two pairs.
        let moving = [bar(0..2), bar(1..3), bar(2..4)];
        assert_eq!(flicker(&moving, &moving), Some(0.0));
        assert_eq!(flicker(&[bar(0..2), bar(1..3), bar(2..5)], &moving), Some(25.0));
        assert_eq!(flicker(&still, &moving), Some(0.0));
    }

    #[test]
    fn nothing_to_compare() {
        let nothing = [bar(0..0), bar(0..0)];
        assert_eq!(flicker(&[bar(0..1), bar(0..2)], &nothing), None);
        assert_eq!(flicker(&[bar(0..1)], &[bar(0..1)]), None);
        assert_eq!(flicker(&[], &[]), None);
    }
}
