//! From the folder of clips to what a grounder is shown.

use l4d_data::{DataError, Timeline};
use l4d_ground::{ClipFrame, ViewClip};
use rayon::prelude::*;

use super::folder::ClipsFolder;
use super::plan::{Plan, Shot};

/// All views of a plan whose pictures are in the folder, in the order of its cameras. Times between frames are left
/// out: a sentence is asked about frames.
///
/// # Errors
/// A picture that is not there, or not as it was written.
pub fn read_views(folder: &ClipsFolder, plan: &Plan, timeline: Timeline) -> Result<Vec<ViewClip>, DataError> {
    let frames: Vec<(usize, u32)> =
        plan.instants.iter().enumerate().filter_map(|(at, instant)| Some((at, instant.frame?))).collect();
    let read = |view: usize| {
        let frame = |&(instant, frame): &(usize, u32)| {
            let (colour, depth) = folder.read(plan, Shot { view, instant })?;
            Ok(ClipFrame { frame, colour, depth })
        };
        let frames = frames.par_iter().map(frame).collect::<Result<_, DataError>>()?;
        let [width, height] = plan.size;
        Ok(ViewClip { camera: plan.drawn_camera(view), width, height, timeline, frames })
    };
    (0..plan.cameras.len()).map(read).collect()
}
