//! A clip is learned from one moment outwards, so that what moves is never far from where it was last seen.
//!
//! The planes of a field have a row of numbers for each moment. What is not learned yet repeats the last row that is,
//! so that a new moment starts as its neighbour ended.

use crate::deform::DeformationField;

/// Planes with a time axis among the six of a level.
const WITH_TIME: [usize; 3] = [2, 4, 5];

/// The span of moments that are being learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) first: usize,
    pub(super) last: usize,
}

impl Span {
    /// `reach` moments on either side of `from`, within a clip of `moments`.
    pub(super) fn around(from: usize, reach: usize, moments: usize) -> Self {
        Self { first: from.saturating_sub(reach), last: (from + reach).min(moments.saturating_sub(1)) }
    }

    /// How far the farther end of a clip is.
    pub(super) fn reach(from: usize, moments: usize) -> usize {
        from.max(moments.saturating_sub(1).saturating_sub(from))
    }
}

/// Repeats the rows at both ends of a span of times (0 to 1) over the rest of the clip.
pub(super) fn repeat_ends(field: &mut DeformationField, first: f32, last: f32) {
    let rows = field.config().time_resolution;
    let row_of = |time: f32| (time * (rows - 1) as f32).round() as usize;
    let (first, last) = (row_of(first).min(rows - 1), row_of(last).min(rows - 1));
    for (index, texels) in field.parameters_mut().planes.into_iter().enumerate() {
        if !WITH_TIME.contains(&(index % 6)) {
            continue;
        }
        let row = texels.len() / rows;
        for other in 0..first {
            texels.copy_within(first * row..(first + 1) * row, other * row);
        }
        for other in last + 1..rows {
            texels.copy_within(last * row..(last + 1) * row, other * row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deform::{Bounds, DeformConfig, Init, TimeAxis};

    #[test]
    fn moments_beyond_the_span_look_like_its_ends() {
        let config = DeformConfig {
            spatial_resolution: [4; 3],
            time_resolution: 9,
            multires: vec![1, 2],
            sh_coefficients: 1,
            time_axis: TimeAxis::Whole,
            ..DeformConfig::dynerf()
        };
        let bounds = Bounds::new([[1.0; 3], [-1.0; 3]]).unwrap();
        let mut field = DeformationField::new(config, bounds, Init::Foreign, 1).unwrap();
        // Rows that differ, so that a wrong copy shows.
        for texels in field.parameters_mut().planes {
            for (index, texel) in texels.iter_mut().enumerate() {
                *texel = 0.5 + (index % 97) as f32 / 97.0;
            }
        }
        let at = [[0.3, -0.2, 0.1]];
        let before = [0.25, 0.5, 0.625].map(|time| field.offsets(&at, time).unwrap());
        repeat_ends(&mut field, 0.25, 0.625);
        assert_eq!([0.25, 0.5, 0.625].map(|time| field.offsets(&at, time).unwrap()), before);
        for (time, same) in [(0.0, 0), (0.125, 0), (0.75, 2), (1.0, 2)] {
            assert_eq!(field.offsets(&at, time).unwrap(), before[same], "{time}");
        }
    }

    #[test]
    fn a_span_ends_with_the_clip() {
        assert_eq!(Span::around(4, 2, 9), Span { first: 2, last: 6 });
        assert_eq!(Span::around(1, 5, 4), Span { first: 0, last: 3 });
        assert_eq!((Span::reach(1, 9), Span::reach(7, 9), Span::reach(0, 1)), (7, 7, 0));
    }
}
