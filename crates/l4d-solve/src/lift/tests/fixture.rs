//! A room of 400 Gaussians, of which the moving ones of the first ball are meant, and what cameras see of them.

use l4d_masks::Mask;
use l4d_splat::Model;
use l4d_splat::raster::{Cpu, RasterSettings, Rasterizer as _};
use l4d_splat::synthetic::Room;
use l4d_splat::view::View;

use crate::lift::{
    Answer, ClosedSettings, Evidence, EvidenceFrame, EvidenceView, FieldSettings, LiftError, LiftSettings,
    RenderedModel, lift,
};

pub(crate) const FRAMES: [u32; 5] = [0, 24, 48, 72, 96];
pub(crate) const SIZE: [u32; 2] = [64, 48];

pub(crate) struct Scene {
    pub(crate) model: Model,
    /// Eight, and one held out.
    pub(crate) views: Vec<View>,
    pub(crate) cpu: Cpu,
    pub(crate) raster: RasterSettings,
}

impl Scene {
    pub(crate) fn new() -> Self {
        let room = Room::small(4);
        let views = room.views(SIZE).unwrap();
        Self { model: room.model().unwrap(), views, cpu: Cpu::new(), raster: RasterSettings::default() }
    }

    pub(crate) fn rendered(&self) -> RenderedModel<'_> {
        RenderedModel { model: &self.model, rasterizer: &self.cpu, raster: &self.raster, states: None }
    }

    /// The pixels of the ball.
    pub(crate) fn truth(&self, view: &View, frame: u32) -> Mask {
        let splats = self.model.at(frame as f32 / 96.0).unwrap();
        let is_meant = |index: usize| index >= 300 && index.is_multiple_of(3);
        let labels: Vec<f32> = (0..400).map(|index| f32::from(u8::from(is_meant(index)))).collect();
        let blend =
            self.cpu.prepare(&splats, view, &self.raster).unwrap().splat_features(&labels, 1).unwrap();
        Mask::from_fn(SIZE[0], SIZE[1], |column, row| blend[(row * SIZE[0] + column) as usize] > 0.5)
    }

    /// Evidence of the first `views` views, each mask through `change`.
    pub(crate) fn evidence(&self, views: usize, change: impl Fn(usize, u32, Mask) -> Mask) -> Evidence {
        let frames = |(index, view): (usize, &View)| {
            let frame = |frame: u32| {
                let mask = change(index, frame, self.truth(view, frame));
                EvidenceFrame { frame, time: frame as f32 / 96.0, view: *view, mask }
            };
            EvidenceView { name: format!("cam{index:02}"), frames: FRAMES.map(frame).to_vec() }
        };
        Evidence { views: self.views.iter().take(views).enumerate().map(frames).collect() }
    }

    /// Lifts evidence that has pictures.
    pub(crate) fn lift(&self, evidence: &Evidence, settings: &LiftSettings) -> Result<Answer, LiftError> {
        Ok(lift(&self.rendered(), evidence, settings)?.unwrap())
    }

    /// The answer in the held-out view.
    pub(crate) fn held_out(&self, lifted: &Answer, frame: u32) -> Mask {
        lifted.mask(&self.rendered(), &self.views[8], frame as f32 / 96.0).unwrap()
    }

    /// Mean intersection over union in the held-out view, over frames in which the ball shows.
    pub(crate) fn score(&self, lifted: &Answer) -> f64 {
        let overlaps: Vec<f64> = FRAMES
            .iter()
            .filter_map(|&frame| {
                let (found, truth) = (self.held_out(lifted, frame), self.truth(&self.views[8], frame));
                if truth.is_empty() { None } else { found.iou(&truth) }
            })
            .collect();
        assert!(overlaps.len() >= 3, "the ball hides from the held-out view");
        overlaps.iter().sum::<f64>() / overlaps.len() as f64
    }
}

pub(crate) fn as_it_is(_: usize, _: u32, mask: Mask) -> Mask {
    mask
}

pub(crate) fn empty() -> Mask {
    Mask::empty(SIZE[0], SIZE[1])
}

pub(crate) fn closed() -> LiftSettings {
    LiftSettings::Closed(ClosedSettings::robust())
}

pub(crate) fn vote() -> LiftSettings {
    LiftSettings::Closed(ClosedSettings::vote())
}

/// Three steps over all pictures, no graph.
pub(crate) fn sirt() -> LiftSettings {
    let robust = ClosedSettings::robust();
    LiftSettings::Closed(ClosedSettings { steps: 3, step_times: u32::MAX, smoothness: 0.0, ..robust })
}

/// A small field that hardly learns.
pub(crate) fn field(iterations: u32) -> LiftSettings {
    LiftSettings::Field(FieldSettings { iterations, width: 16, sampled: 50, ..FieldSettings::paper() })
}
