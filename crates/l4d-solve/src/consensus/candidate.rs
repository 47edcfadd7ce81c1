//! Proposals made ready for the vote: which of them may take part, and what is wrong with the others.

use std::collections::BTreeMap;

use l4d_ground::{Grounding, ViewClip};
use l4d_masks::Mask;

use super::record::MarkedFrame;

/// What one view saw, and what it says.
#[derive(Debug, Clone, Copy)]
pub struct Proposal<'a> {
    /// What it saw.
    pub clip: &'a ViewClip,
    /// What it says.
    pub grounding: &'a Grounding,
}

/// What a proposal may do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Part {
    /// It is judged, and judges.
    Found,
    /// It judges.
    Absent,
    /// Neither.
    NoAnswer,
    /// Neither: this is wrong with it.
    Unusable(String),
}

impl<'a> Proposal<'a> {
    pub(super) fn part(&self) -> Part {
        if !self.grounding.outcome.is_answer() {
            return Part::NoAnswer;
        }
        if let Some(problem) = self.problem() {
            return Part::Unusable(problem);
        }
        // Masks decide which answer it is, whatever the outcome says: what marks nothing cannot be voted on.
        let marks_any = self.marked().iter().any(|marked| marked.pixels > 0);
        if marks_any { Part::Found } else { Part::Absent }
    }

    /// What it marks at a frame of its clip, if anything.
    pub(super) fn mask(&self, frame: u32) -> Option<&'a Mask> {
        let masks: &'a BTreeMap<u32, Mask> = &self.grounding.masks;
        masks.get(&frame).filter(|mask| !mask.is_empty())
    }

    pub(super) fn marked(&self) -> Vec<MarkedFrame> {
        let pixels = |frame| self.mask(frame).map_or(0, Mask::area);
        self.clip.frame_numbers().map(|frame| MarkedFrame { frame, pixels: pixels(frame) }).collect()
    }

    fn problem(&self) -> Option<String> {
        let clip = self.clip;
        if let Some(problem) = clip.camera.problem() {
            return Some(format!("camera: {problem}"));
        }
        if !Mask::is_sane_size(clip.width, clip.height) {
            return Some(format!("a clip of {}x{} pixels", clip.width, clip.height));
        }
        if !clip.frames.is_sorted_by(|a, b| a.frame < b.frame) {
            return Some("the frames of the clip do not ascend".to_owned());
        }
        clip.frames.iter().find_map(|seen| self.frame_problem(seen.frame))
    }

    fn frame_problem(&self, frame: u32) -> Option<String> {
        let clip = self.clip;
        let poses = clip.camera.world_from_camera.len();
        if poses > 1 && frame as usize >= poses {
            return Some(format!("frame {frame}: the camera has {poses} poses"));
        }
        let depth = &clip.at(frame)?.depth;
        let pixels = clip.width as usize * clip.height as usize;
        let lengths = [depth.depth_m.len(), depth.alpha.len(), depth.near_m.len(), depth.far_m.len()];
        if (depth.width, depth.height) != (clip.width, clip.height) || lengths != [pixels; 4] {
            return Some(format!("frame {frame}: the depth is not of the size of the clip"));
        }
        let mask = self.grounding.masks.get(&frame)?;
        (mask.size() != (clip.width, clip.height)).then(|| {
            let (width, height) = mask.size();
            format!("frame {frame}: a mask of {width}x{height} for {}x{} pixels", clip.width, clip.height)
        })
    }
}
