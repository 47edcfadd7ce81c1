//! A scene over time as the evaluator asks for it: who there is, what happens, how far apart things are.
//!
//! Owns names, boxes and distances; the definitions of relations are in `relations`.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use l4d_data::timeline::FRAME_COUNT;
use l4d_data::tracks::{Pair, TrackedInstance, Tracks, at_frame};
use l4d_data::{Event, Role, Scale};

use crate::obb::Obb;
use crate::thresholds::{CONTACT_END_M, Slack};

/// A scene over time, with the slack that thresholds have.
#[derive(Debug, Clone)]
pub struct World<'a> {
    stage: Arc<Stage<'a>>,
    slack: Slack,
}

/// What of a scene doesn't depend on thresholds.
#[derive(Debug)]
struct Stage<'a> {
    tracks: &'a Tracks,
    pairs: BTreeMap<(&'a str, &'a str), &'a Pair>,
    boxes: BTreeMap<&'a str, Vec<Obb>>,
    places: BTreeMap<&'a str, usize>,
    /// Distances between boxes over time, by the places of both; measured when first asked for.
    gaps: Vec<OnceLock<Vec<f64>>>,
}

impl<'a> World<'a> {
    /// Indexes the tracks.
    pub fn new(tracks: &'a Tracks) -> Self {
        let pairs =
            tracks.pairs.iter().map(|pair| (ordered(pair.a.as_str(), pair.b.as_str()), pair)).collect();
        let boxes =
            tracks.instances.iter().map(|instance| (instance.name.as_str(), boxes_of(instance))).collect();
        let names = tracks.instances.iter().map(|instance| instance.name.as_str());
        let places: BTreeMap<&str, usize> = names.enumerate().map(|(place, name)| (name, place)).collect();
        let gaps = (0..places.len() * places.len()).map(|_| OnceLock::new()).collect();
        Self { stage: Arc::new(Stage { tracks, pairs, boxes, places, gaps }), slack: Slack::Nominal }
    }

    /// The same scene with other slack.
    pub fn with_slack(&self, slack: Slack) -> Self {
        Self { stage: Arc::clone(&self.stage), slack }
    }

    /// How strictly thresholds are meant.
    pub fn slack(&self) -> Slack {
        self.slack
    }

    /// The scale of the scene.
    pub fn scale(&self) -> Scale {
        self.stage.tracks.scale
    }

    /// The tracks themselves.
    pub fn tracks(&self) -> &'a Tracks {
        self.stage.tracks
    }

    /// Everything annotated, by id.
    pub fn instances(&self) -> impl Iterator<Item = &'a TrackedInstance> + use<'a> {
        self.stage.tracks.instances.iter()
    }

    /// Instances that queries may refer to.
    pub fn objects(&self) -> impl Iterator<Item = &'a TrackedInstance> + use<'a> {
        self.instances().filter(|instance| instance.role == Role::Object)
    }

    /// The instance of that name.
    pub fn instance(&self, name: &str) -> Option<&'a TrackedInstance> {
        self.stage.tracks.instance(name)
    }

    /// What happens, by subject.
    pub fn events(&self) -> impl Iterator<Item = &'a Event> + use<'a> {
        self.stage.tracks.events.iter()
    }

    /// Whether any instance ever does this.
    pub fn has_verb(&self, verb: &str) -> bool {
        self.events().any(|event| event.verb == verb)
    }

    /// Distance between two instances, metres: between surfaces within the reach of the tracks, between boxes (never
    /// less than the reach) beyond it.
    pub fn distance_m(&self, a: &TrackedInstance, b: &TrackedInstance, frame: u32) -> f64 {
        match self.pair(a, b) {
            Some(pair) => *at_frame(&pair.distance_m, frame),
            None => at_frame(self.gap_m(a, b), frame).max(self.stage.tracks.pair_reach_m),
        }
    }

    /// Distances between two boxes, metres: 1 where both rest, else one a frame.
    fn gap_m(&self, a: &TrackedInstance, b: &TrackedInstance) -> &[f64] {
        let Stage { places, gaps, boxes, .. } = &*self.stage;
        let (first, second) = ordered(a.name.as_str(), b.name.as_str());
        gaps[places[first] * places.len() + places[second]].get_or_init(|| {
            let (first, second) = (&boxes[first], &boxes[second]);
            let frames = first.len().max(second.len()) as u32;
            (0..frames).map(|frame| at_frame(first, frame).distance(at_frame(second, frame))).collect()
        })
    }

    /// Distances of two instances that may touch, metres: between surfaces where the tracks have them, between boxes
    /// where the tracks promise nothing of pairs that they leave out.
    pub(crate) fn near_m(&self, a: &TrackedInstance, b: &TrackedInstance) -> Option<&[f64]> {
        match self.pair(a, b) {
            Some(pair) => Some(&pair.distance_m),
            None => (self.stage.tracks.pair_reach_m < CONTACT_END_M).then(|| self.gap_m(a, b)),
        }
    }

    /// The exact distance of a pair over time, if the tracks have it.
    pub(crate) fn pair(&self, a: &TrackedInstance, b: &TrackedInstance) -> Option<&'a Pair> {
        self.stage.pairs.get(&ordered(a.name.as_str(), b.name.as_str())).copied()
    }

    pub(crate) fn obb(&self, instance: &TrackedInstance, frame: u32) -> &Obb {
        at_frame(&self.stage.boxes[instance.name.as_str()], frame)
    }

    /// Median over the clip of something measured on the box: what a body is like, whatever it is doing.
    pub(crate) fn median(&self, instance: &TrackedInstance, measure: impl Fn(&Obb) -> f64) -> f64 {
        let mut values: Vec<f64> = self.stage.boxes[instance.name.as_str()].iter().map(measure).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    }
}

fn ordered<'n>(a: &'n str, b: &'n str) -> (&'n str, &'n str) {
    if a <= b { (a, b) } else { (b, a) }
}

fn boxes_of(instance: &TrackedInstance) -> Vec<Obb> {
    let track = &instance.track;
    let is_static = [track.centre.len(), track.axes.len(), track.extents.len()] == [1; 3];
    let frames = if is_static { 1 } else { FRAME_COUNT };
    (0..frames).map(|frame| Obb::new(track, frame)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{pair, standing, tracks};

    #[test]
    fn exact_distances_win_over_boxes_and_boxes_over_the_reach() {
        let a = standing(1, "a", "cup", [0., 0., 0.], [0.1, 0.1, 0.1]);
        let b = standing(2, "b", "cup", [0.2, 0., 0.], [0.1, 0.1, 0.1]);
        let with_pair = tracks(&[a.clone(), b.clone()], "", &pair("b", "a", &[0.123]));
        let without = tracks(&[a, b], "", "");
        let distance = |tracks: &Tracks| {
            let world = World::new(tracks);
            world.distance_m(world.instance("a").unwrap(), world.instance("b").unwrap(), 5)
        };
        assert_eq!(distance(&with_pair), 0.123);
        assert!((distance(&without) - 0.1).abs() < 1e-12);
    }
}
