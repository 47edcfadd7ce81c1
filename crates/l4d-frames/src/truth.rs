//! From decoded ids to `benchmark/truth/<profile>/<scene>.json`, one picture at a time.
//!
//! Pictures may come in any order and from many threads: [`Observation::of`] is the work, [`TruthBuilder`]
//! only files it away.

use std::collections::BTreeMap;

use l4d_data::scene::Scene;
use l4d_data::truth::{InstanceTruth, SCHEMA, Truth, frame_key};
use l4d_masks::{Mask, Rle};

use crate::frame::Surfaces;

/// What one picture says about the instances of its scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Observation {
    /// Visible pixels of each id that occurs, ascending by id.
    pub visible: Vec<(u32, u32)>,
    /// Mask of each id that occurs, ascending by id; empty unless asked for.
    pub masks: Vec<(u32, Rle)>,
}

impl Observation {
    /// Counts the ids of a picture and, for the held-out view, encodes their masks.
    pub fn of(surfaces: &Surfaces, with_masks: bool) -> Self {
        let visible = surfaces.visible();
        let encode = |&(id, _): &(u32, u32)| {
            let inside = |column, row| surfaces.id[surfaces.index(column, row)] == id;
            (id, Mask::from_fn(surfaces.width, surfaces.height, inside).to_rle())
        };
        let masks = if with_masks { visible.iter().map(encode).collect() } else { Vec::new() };
        Self { visible, masks }
    }
}

/// Collects the observations of a scene.
#[derive(Debug, Clone)]
pub struct TruthBuilder {
    truth: Truth,
}

impl TruthBuilder {
    /// For a scene whose `scene.json` was read (and so has exactly one held-out view).
    pub fn new(scene: &Scene) -> Option<Self> {
        let test_view = scene.test_camera()?.name.clone();
        let frames: Vec<u32> = scene.profile.frames().collect();
        let instances = scene.instances.iter().map(|instance| InstanceTruth {
            name: instance.name.clone(),
            id: instance.id,
            role: instance.role,
            category: instance.category.clone(),
            masks: BTreeMap::new(),
        });
        let unseen = || scene.instances.iter().map(|instance| (instance.name.clone(), vec![0; frames.len()]));
        let visible = scene.cameras.iter().map(|camera| (camera.name.clone(), unseen().collect())).collect();
        let truth = Truth {
            unannotated: Vec::new(),
            schema: SCHEMA.to_owned(),
            scene: scene.name.clone(),
            scale: scene.scale,
            variant: scene.variant,
            profile: scene.profile,
            width: scene.width,
            height: scene.height,
            test_view,
            frames,
            instances: instances.collect(),
            visible,
        };
        Some(Self { truth })
    }

    /// Whether the masks of this view belong into the truth.
    pub fn wants_masks(&self, view: &str) -> bool {
        self.truth.test_view.as_str() == view
    }

    /// Files a picture away. Views, frames and ids that the scene does not have are left out.
    pub fn insert(&mut self, view: &str, frame: u32, observation: Observation) {
        let truth = &mut self.truth;
        let Ok(position) = truth.frames.binary_search(&frame) else { return };
        let Some(counts_of_view) = truth.visible.get_mut(view) else { return };
        for instance in &truth.instances {
            let count = observation.visible.iter().find(|(id, _)| *id == instance.id);
            if let (Some((_, count)), Some(counts)) = (count, counts_of_view.get_mut(&instance.name)) {
                counts[position] = *count;
            }
        }
        if truth.test_view.as_str() == view {
            for (id, mask) in observation.masks {
                if let Some(instance) = truth.instances.iter_mut().find(|instance| instance.id == id) {
                    instance.masks.insert(frame_key(frame), mask);
                }
            }
        }
    }

    pub fn finish(self) -> Truth {
        self.truth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_observation_counts_and_encodes_by_hand() {
        // 2 columns, 3 rows:  1 .
        //                     1 2
        //                     . 2
        let surfaces = Surfaces { width: 2, height: 3, depth_m: vec![1.0; 6], id: vec![1, 0, 1, 2, 0, 2] };
        let observation = Observation::of(&surfaces, true);
        assert_eq!(observation.visible, [(1, 2), (2, 2)]);
        // Down the columns: id 1 is 0 outside, 2 inside, 4 outside; id 2 is 4 outside, 2 inside.
        let masks: Vec<_> = observation.masks.iter().map(|(id, mask)| (*id, mask.counts())).collect();
        assert_eq!(masks, [(1, "024".to_owned()), (2, "42".to_owned())]);
        assert!(Observation::of(&surfaces, false).masks.is_empty());
    }
}
