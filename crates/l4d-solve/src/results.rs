//! Answers as the judge reads them: masks of the held-out view, and the card of the method.

use std::collections::BTreeMap;

use l4d_data::layout::ResultsDir;
use l4d_data::results::MaskFile;
use l4d_data::truth::frame_key;
use l4d_data::{DataError, QueryId, json};
use l4d_masks::Mask;

use crate::clips::{Plan, Shot};

/// The file of one query. Frames without a pixel of the answer say absent.
pub fn mask_file(plan: &Plan, masks: &BTreeMap<Shot, Mask>) -> MaskFile {
    let [width, height] = plan.size;
    let counts = |shot: Shot| {
        let mask = masks.get(&shot).filter(|mask| !mask.is_empty());
        mask.map(Mask::to_rle)
    };
    let frames = plan.instants.iter().enumerate().filter_map(|(instant, at)| {
        let frame = at.frame?;
        Some((frame_key(frame), counts(Shot { view: 0, instant })))
    });
    MaskFile { size: [height, width], frames: frames.collect() }
}

/// Writes the masks of a query.
///
/// # Errors
/// What the disk refuses.
pub fn write_masks(results: &ResultsDir, id: &QueryId, file: &MaskFile) -> Result<(), DataError> {
    json::write_compact(&results.mask_file(id), file)
}

#[cfg(test)]
mod tests {
    use l4d_data::{Camera, Name, Split, Timeline};

    use super::*;
    use crate::clips::Instant;

    #[test]
    fn frames_without_a_pixel_say_absent() {
        let camera = Camera {
            name: Name::new("test").unwrap(),
            split: Split::Test,
            fx: 4.0,
            fy: 4.0,
            cx: 2.0,
            cy: 1.0,
            world_from_camera: vec![[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]],
        };
        let instants = [0, 48].map(|frame| Instant::at_frame(frame, Timeline::CANONICAL)).to_vec();
        let plan = Plan { cameras: vec![camera], camera_size: [4, 2], size: [4, 2], instants };
        let mask = |columns: u32| Mask::from_fn(4, 2, |column, _| column < columns);
        let masks = plan.shots().zip([mask(0), mask(1)]).collect();
        let file = mask_file(&plan, &masks);
        assert_eq!(file.size, [2, 4]);
        assert_eq!(file.frames["0000"], None);
        assert_eq!(file.frames["0048"].as_ref().unwrap().counts(), "026");
    }
}
