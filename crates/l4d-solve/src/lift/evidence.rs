//! What lifting learns from: the masks of the views that consensus let through.
//!
//! Owns the shape of evidence and its checks. Refuses to know how masks were found and which views were left out.

use std::collections::BTreeMap;

use l4d_ground::{Grounding, ViewClip};
use l4d_masks::Mask;
use l4d_splat::view::View;

use super::error::LiftError;

/// Masks of several views over a clip; views may have different sizes and different frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evidence {
    /// The reliable views.
    pub views: Vec<EvidenceView>,
}

/// One view's masks.
#[derive(Debug, Clone, PartialEq)]
pub struct EvidenceView {
    /// Name of the camera, for messages.
    pub name: String,
    /// What it says, by ascending frame.
    pub frames: Vec<EvidenceFrame>,
}

/// One view's mask at a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct EvidenceFrame {
    /// Number on the timeline of the clip.
    pub frame: u32,
    /// The same from 0 to 1.
    pub time: f32,
    pub view: View,
    /// What is meant; empty says that it is not seen.
    pub mask: Mask,
}

impl Evidence {
    /// What these views say, those that are believed alone. Frames of a clip without a mask say nothing.
    ///
    /// # Errors
    /// A camera without a pose at a frame, a mask for a frame that the clip lacks.
    pub fn of(clips: &[ViewClip], groundings: &[Grounding], believed: &[usize]) -> Result<Self, LiftError> {
        let view = |&view: &usize| EvidenceView::of_clip(&clips[view], &groundings[view].masks);
        Ok(Self { views: believed.iter().map(view).collect::<Result<_, _>>()? })
    }
}

impl EvidenceView {
    fn of_clip(clip: &ViewClip, masks: &BTreeMap<u32, Mask>) -> Result<Self, LiftError> {
        let name = clip.camera.name.to_string();
        let size = [clip.width, clip.height];
        let frames = masks.iter().map(|(&frame, mask)| {
            if clip.at(frame).is_none() {
                let message = "there is a mask, but the clip has no such frame".to_owned();
                return Err(LiftError::Evidence { view: name.clone(), frame, message });
            }
            let view = View::of_camera(&clip.camera, frame, size, size)
                .map_err(|source| LiftError::View { view: name.clone(), source })?;
            Ok(EvidenceFrame { frame, time: clip.timeline.time(frame), view, mask: mask.clone() })
        });
        Ok(Self { frames: frames.collect::<Result<_, _>>()?, name: name.clone() })
    }
}

/// One picture that has a mask.
#[derive(Debug, Clone, Copy)]
pub(super) struct Picture<'a> {
    pub(super) view: &'a View,
    pub(super) mask: &'a Mask,
}

/// All pictures of one time.
#[derive(Debug, Clone)]
pub(super) struct TimeEvidence<'a> {
    /// From 0 to 1.
    pub(super) time: f32,
    /// In the order of the views.
    pub(super) pictures: Vec<Picture<'a>>,
}

impl Evidence {
    /// The pictures by time, ascending.
    ///
    /// # Errors
    /// A mask that does not have the size of its view.
    pub(super) fn instants(&self) -> Result<Vec<TimeEvidence<'_>>, LiftError> {
        // Bits of times, which are never negative, are in the order of the times.
        let mut by_time: BTreeMap<u32, Vec<Picture<'_>>> = BTreeMap::new();
        for view in &self.views {
            for seen in &view.frames {
                let (size, drawn) = (seen.mask.size(), (seen.view.width(), seen.view.height()));
                if size != drawn {
                    let message = format!(
                        "the mask is {}x{}, but the view has {}x{} pixels",
                        size.0, size.1, drawn.0, drawn.1
                    );
                    return Err(LiftError::Evidence { view: view.name.clone(), frame: seen.frame, message });
                }
                let picture = Picture { view: &seen.view, mask: &seen.mask };
                by_time.entry(seen.time.to_bits()).or_default().push(picture);
            }
        }
        let instant = |(bits, pictures)| TimeEvidence { time: f32::from_bits(bits), pictures };
        Ok(by_time.into_iter().map(instant).collect())
    }
}

/// One number a pixel, row-major: 1 inside, 0 outside.
pub(super) fn numbers(mask: &Mask) -> Vec<f32> {
    let mut numbers = vec![0.0; mask.width() as usize * mask.height() as usize];
    for (column, row) in mask.pixels() {
        numbers[row as usize * mask.width() as usize + column as usize] = 1.0;
    }
    numbers
}
