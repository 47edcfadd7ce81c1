//! Geometry and events of a scene, as the evaluator asks for them.
//!
//! Relations are decided from oriented boxes, exact mesh distances and contact, all in metres.

use std::collections::BTreeMap;

use glam::{DMat3, DVec2, DVec3};
use l4d_data::tracks::{Pair, TrackedInstance, Tracks, at_frame};
use l4d_data::{Name, Role, Scale};

use crate::ast::{Party, Relation};

/// Two things closer than this touch, even where the mesh contact flickers.
const CONTACT_M: f64 = 0.012;
/// `between`: how far along the segment the middle one may stand, as a share of its length.
const BETWEEN_SPAN: std::ops::RangeInclusive<f64> = 0.15..=0.85;
/// `between`: how far off the segment it may stand, as a share of its length.
const BETWEEN_OFFSET: f64 = 0.3;
/// `closest_to`: the runner-up is at least this much farther away.
const CLOSEST_MARGIN: f64 = 1.15;

/// Axis-aligned bounds of an oriented box.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    min: DVec3,
    max: DVec3,
}

impl Bounds {
    fn centre(self) -> DVec3 {
        (self.min + self.max) / 2.0
    }

    fn covers_in_plan(self, point: DVec3) -> bool {
        let inside = |low: f64, value: f64, high: f64| low <= value && value <= high;
        inside(self.min.x, point.x, self.max.x) && inside(self.min.y, point.y, self.max.y)
    }

    fn gap(self, other: Self) -> f64 {
        (self.min - other.max).max(other.min - self.max).max(DVec3::ZERO).length()
    }
}

/// A scene over time.
#[derive(Debug)]
pub struct World<'a> {
    tracks: &'a Tracks,
    pairs: BTreeMap<(&'a str, &'a str), &'a Pair>,
}

impl<'a> World<'a> {
    /// Indexes the tracks.
    pub fn new(tracks: &'a Tracks) -> Self {
        let ordered = |pair: &'a Pair| ordered(pair.a.as_str(), pair.b.as_str());
        Self { tracks, pairs: tracks.pairs.iter().map(|pair| (ordered(pair), pair)).collect() }
    }

    /// Instances that queries may refer to.
    pub fn objects(&self) -> impl Iterator<Item = &'a TrackedInstance> {
        self.tracks.instances.iter().filter(|instance| instance.role == Role::Object)
    }

    /// The instance of that name.
    pub fn instance(&self, name: &str) -> Option<&'a TrackedInstance> {
        self.tracks.instance(name)
    }

    /// How near counts as beside, metres: arm's reach at the scene's scale.
    pub fn beside_m(&self) -> f64 {
        match self.tracks.scale {
            Scale::Outdoor => 0.9,
            Scale::Room => 0.5,
            Scale::Tabletop => 0.1,
        }
    }

    /// Whether `subject` does `verb` (to `object`) at a frame; an absent object asks for the action alone.
    pub fn happens(&self, subject: &Party, verb: &str, object: Option<&Party>, frame: u32) -> bool {
        self.tracks.events.iter().any(|event| {
            let object_fits = match (object, &event.object) {
                (Some(party), Some(name)) => self.is(party, name),
                (None, _) => true,
                (Some(_), None) => false,
            };
            event.verb == verb
                && event.frames.contains(frame)
                && self.is(subject, &event.subject)
                && object_fits
        })
    }

    /// Whether anybody ever does this.
    pub fn has_verb(&self, verb: &str) -> bool {
        self.tracks.events.iter().any(|event| event.verb == verb)
    }

    /// Whether a relation holds at a frame.
    ///
    /// - `on`: they touch, its centre is above a quarter of the other's height and inside its footprint.
    /// - `under`: its centre is inside the other's footprint, its top below the other's top and its bottom below the
    ///   other's middle.
    /// - `beside`: mesh distance within [`World::beside_m`], and not on it.
    /// - `between`: in plan view, 15 to 85 % along the segment between the two centres and within 30 % of its length.
    /// - `closest_to`: nearer than every other object of its category, the runner-up at least 15 % farther.
    ///
    /// Nothing is related to itself.
    pub fn related(
        &self,
        subject: &TrackedInstance,
        kind: Relation,
        of: &[&TrackedInstance],
        frame: u32,
    ) -> bool {
        if of.iter().any(|other| other.name == subject.name) {
            return false;
        }
        match (kind, of) {
            (Relation::On, [other]) => self.is_on(subject, other, frame),
            (Relation::Under, [other]) => is_under(subject, other, frame),
            (Relation::Beside, [other]) => {
                self.distance_m(subject, other, frame) <= self.beside_m()
                    && !self.is_on(subject, other, frame)
            }
            (Relation::Between, [first, second]) => is_between(subject, first, second, frame),
            (Relation::ClosestTo, [other]) => self.is_closest(subject, other, frame),
            _ => false,
        }
    }

    /// Distance between two instances, metres: exact within the reach of the tracks, a lower bound beyond it.
    pub fn distance_m(&self, a: &TrackedInstance, b: &TrackedInstance, frame: u32) -> f64 {
        match self.pairs.get(&ordered(a.name.as_str(), b.name.as_str())) {
            Some(pair) => *at_frame(&pair.distance_m, frame),
            None => bounds(a, frame).gap(bounds(b, frame)).max(self.tracks.pair_reach_m),
        }
    }

    fn is(&self, party: &Party, name: &Name) -> bool {
        match party {
            Party::Name(wanted) => wanted == name,
            Party::Category(noun) => self.instance(name).is_some_and(|instance| instance.category == *noun),
        }
    }

    fn is_on(&self, subject: &TrackedInstance, other: &TrackedInstance, frame: u32) -> bool {
        let (below, above) = (bounds(other, frame), bounds(subject, frame));
        let quarter = below.min.z + 0.25 * (below.max.z - below.min.z);
        self.distance_m(subject, other, frame) <= CONTACT_M
            && below.covers_in_plan(above.centre())
            && above.centre().z > quarter
            && above.min.z > below.min.z
    }

    fn is_closest(&self, subject: &TrackedInstance, other: &TrackedInstance, frame: u32) -> bool {
        let own = self.distance_m(subject, other, frame).max(1e-3);
        let rivals = self.objects().filter(|rival| {
            rival.category == subject.category && rival.name != subject.name && rival.name != other.name
        });
        rivals
            .map(|rival| self.distance_m(rival, other, frame))
            .all(|distance| distance >= own * CLOSEST_MARGIN)
    }
}

fn ordered<'n>(a: &'n str, b: &'n str) -> (&'n str, &'n str) {
    if a <= b { (a, b) } else { (b, a) }
}

fn is_under(subject: &TrackedInstance, other: &TrackedInstance, frame: u32) -> bool {
    let (above, below) = (bounds(other, frame), bounds(subject, frame));
    above.covers_in_plan(below.centre()) && below.max.z <= above.max.z && below.min.z < above.centre().z
}

fn is_between(subject: &TrackedInstance, a: &TrackedInstance, b: &TrackedInstance, frame: u32) -> bool {
    let plan = |instance: &TrackedInstance| -> DVec2 { bounds(instance, frame).centre().truncate() };
    let (start, end, point) = (plan(a), plan(b), plan(subject));
    let along = end - start;
    let length = along.length();
    if length < 1e-6 {
        return false;
    }
    let share = (point - start).dot(along) / (length * length);
    let offset = (point - start - along * share).length();
    BETWEEN_SPAN.contains(&share) && offset <= BETWEEN_OFFSET * length
}

fn bounds(instance: &TrackedInstance, frame: u32) -> Bounds {
    let centre = DVec3::from_array(*at_frame(&instance.track.centre, frame));
    let world_from_box = DMat3::from_cols_array(at_frame(&instance.track.axes, frame)).transpose();
    let half = DVec3::from_array(*at_frame(&instance.track.extents, frame)) / 2.0;
    let reach = DMat3::from_cols(
        world_from_box.x_axis.abs(),
        world_from_box.y_axis.abs(),
        world_from_box.z_axis.abs(),
    ) * half;
    Bounds { min: centre - reach, max: centre + reach }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A box of the given size standing on the floor at (x, y), raised by z.
    pub(crate) fn standing(id: u32, name: &str, category: &str, at: [f64; 3], size: [f64; 3]) -> String {
        let role = if id > 1000 { "landmark" } else { "object" };
        let centre = [at[0], at[1], at[2] + size[2] / 2.0];
        format!(
            r#"{{"id":{id},"name":"{name}","role":"{role}","category":"{category}","attributes":{{"colour":"grey"}},"front":null,"track":{{"centre":[{centre:?}],"axes":[[1,0,0,0,1,0,0,0,1]],"extents":[{size:?}]}}}}"#
        )
    }

    pub(crate) fn tracks(instances: &[String], events: &str, pairs: &str) -> Tracks {
        let text = format!(
            r#"{{"schema":"l4d/tracks/1","scene":"s","scale":"tabletop","variant":0,"seed":0,"fps":24,"frame_count":97,"exposure":1,"description":"","pair_reach_m":0.05,"instances":[{}],"events":[{events}],"pairs":[{pairs}],"cameras":[]}}"#,
            instances.join(",")
        );
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn relations_by_hand() {
        let table = standing(1001, "table", "table", [0., 0., 0.], [1., 1., 0.7]);
        let on = standing(1, "on", "cup", [0.2, 0., 0.7], [0.08, 0.08, 0.1]);
        let under = standing(2, "under", "cup", [0.2, 0., 0.], [0.08, 0.08, 0.1]);
        let near = standing(3, "near", "cup", [0.6, 0., 0.], [0.08, 0.08, 0.1]);
        let far = standing(4, "far", "cup", [2., 0., 0.], [0.08, 0.08, 0.1]);
        let pair = |cup: &str, distance_m: f64| {
            format!(r#"{{"a":"{cup}","b":"table","distance_m":[{distance_m}],"contact":[]}}"#)
        };
        let pairs = [pair("on", 0.0), pair("under", 0.6), pair("near", 0.06)].join(",");
        let tracks = tracks(&[table, on, under, near, far], "", &pairs);
        let world = World::new(&tracks);
        let get = |name: &str| world.instance(name).unwrap();
        let holding = |kind: Relation, of: &[&str]| -> Vec<&str> {
            let of: Vec<_> = of.iter().map(|name| get(name)).collect();
            let related = world.objects().filter(|object| world.related(object, kind, &of, 0));
            related.map(|object| object.name.as_str()).collect()
        };
        assert_eq!(holding(Relation::On, &["table"]), ["on"]);
        assert_eq!(holding(Relation::Under, &["table"]), ["under"]);
        assert_eq!(holding(Relation::Beside, &["table"]), ["near"]);
        assert_eq!(holding(Relation::Between, &["under", "far"]), ["near"]);
        assert_eq!(holding(Relation::ClosestTo, &["far"]), ["near"]);
    }

    #[test]
    fn exact_distances_win_over_boxes_and_boxes_over_the_reach() {
        let a = standing(1, "a", "cup", [0., 0., 0.], [0.1, 0.1, 0.1]);
        let b = standing(2, "b", "cup", [0.2, 0., 0.], [0.1, 0.1, 0.1]);
        let with_pair =
            tracks(&[a.clone(), b.clone()], "", r#"{"a":"b","b":"a","distance_m":[0.123],"contact":[]}"#);
        let without = tracks(&[a, b], "", "");
        let distance = |tracks: &Tracks| {
            let world = World::new(tracks);
            world.distance_m(world.instance("a").unwrap(), world.instance("b").unwrap(), 5)
        };
        assert_eq!(distance(&with_pair), 0.123);
        assert!((distance(&without) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn events_hold_in_their_interval_and_for_the_right_parties() {
        let instances = [
            standing(1, "a", "cup", [0., 0., 0.], [0.1; 3]),
            standing(1001, "hand", "hand", [0., 0., 0.], [0.1; 3]),
        ];
        let event = r#"{"subject":"hand","verb":"lift","object":"a","frames":[10,30]}"#;
        let tracks = tracks(&instances, event, "");
        let world = World::new(&tracks);
        let hand = Party::Category("hand".into());
        let cup = Party::Name(Name::new("a").unwrap());
        assert!(world.happens(&hand, "lift", Some(&cup), 10) && world.happens(&hand, "lift", Some(&cup), 30));
        assert!(!world.happens(&hand, "lift", Some(&cup), 31));
        assert!(!world.happens(&cup, "lift", Some(&hand), 20));
    }
}
