//! Events that geometry suggests: what boxes and distances over time say of a verb, to a degree.
//!
//! Owns which motion a verb looks like. Knows no pictures and no declared events; who has seen what happens says so
//! with events of its own.

use std::collections::BTreeSet;

use l4d_data::Scale;
use l4d_data::timeline::{FPS, LAST_FRAME};
use l4d_data::tracks::{TrackedInstance, Tracks, at_frame};

use super::belief::BelievedEvent;
use super::degrees::{Degrees, logistic};
use crate::ast::{Clause, Predicate};
use crate::reading::Truth as _;
use crate::thresholds::{before_m, moves_mps};
use crate::verbs::is_among;
use crate::world::World;

/// Frames before and after a moment over which speeds are taken.
const REACH: u32 = 3;
/// Frames after a blow in which what is hit moves.
const BLOW_FRAMES: u32 = 10;
/// An event that holds nowhere more than this is none.
const LEAST: f64 = 0.05;
/// Turning, degrees a second.
const TURN_DPS: f64 = 20.0;
/// Metres a second squared.
const GRAVITY: f64 = 9.81;
/// Leaning, degrees.
const TILT_DEG: [f64; 2] = [15.0, 5.0];
/// Change of the sides of a box, shares of its diagonal a second.
const STIR: f64 = 0.05;
/// Change of the height, shares of the largest a second.
const SINK: f64 = 0.15;
/// Of its largest height, what stands has more than this.
const UPRIGHT: [f64; 2] = [0.85, 0.05];
/// Speed at which walking ends, in speeds at which legs leave the ground (a Froude number of 0.5; Alexander 1989),
/// and how sharply. Legs are taken to be half of the height.
const DASH: [f64; 2] = [1.1, 0.12];

/// What somebody does alone looks like this.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Alone {
    Travel,
    Walk,
    Slide,
    Dash,
    Stand,
    Sit,
    Still,
    Turn,
    Tip,
    Sink,
    Grow,
    Fly,
    Land,
    Brake,
    Start,
    Unfold,
    Stir,
}

/// What somebody does to somebody looks like this.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Upon {
    Hold,
    Lift,
    Lower,
    Carry,
    Push,
    Hit,
    Chase,
    Approach,
    Leave,
    Pour,
    Await,
    Unfold,
    Turn,
    Busy,
}

const ALONE: &[(Alone, &str)] = &[
    (Alone::Travel, "drive swim glide move swing circle pass"),
    (Alone::Walk, "walk waddle crawl"),
    (Alone::Slide, "slide roll"),
    (Alone::Dash, "run trot jog"),
    (Alone::Stand, "stand"),
    (Alone::Sit, "sit kneel crouch"),
    (Alone::Still, "sleep lie rest wait stay perch lean park"),
    (Alone::Turn, "turn spin rotate turn_around"),
    (Alone::Tip, "tip tilt topple tip_over fall_over"),
    (Alone::Sink, "sit_down bend_down lie_down kneel_down crouch_down bow fall"),
    (Alone::Grow, "stand_up get_up sit_up rise stretch"),
    (Alone::Fly, "fly jump hop leap"),
    (Alone::Land, "land"),
    (Alone::Brake, "brake stop slow_down"),
    (Alone::Start, "pull_out start set_off"),
    (Alone::Unfold, "swing_open open close unfold"),
];

const UPON: &[(Upon, &str)] = &[
    (Upon::Hold, "hold grip hug wear ride grasp"),
    (Upon::Lift, "lift pick_up raise"),
    (Upon::Lower, "put_down lower set_down stack"),
    (Upon::Carry, "carry"),
    (Upon::Push, "push pull drag move roll slide turn_over"),
    (Upon::Hit, "kick bat hit nudge tap poke throw knock_over roll_down"),
    (Upon::Chase, "chase follow run_after"),
    (Upon::Approach, "approach walk_to run_to enter"),
    (Upon::Leave, "leave exit"),
    (Upon::Pour, "pour pour_into fill"),
    (Upon::Await, "wait_for"),
    (Upon::Unfold, "open close turn_page"),
    (Upon::Turn, "turn spin rotate"),
];

fn looks<L: Copy>(table: &[(L, &str)], verb: &str, otherwise: L) -> L {
    let row = table.iter().find(|(_, verbs)| is_among(verbs, verb));
    row.map_or(otherwise, |(look, _)| *look)
}

/// Within this much two boxes may touch, metres.
const fn touch_m(scale: Scale) -> f64 {
    match scale {
        Scale::Outdoor => 0.12,
        Scale::Room => 0.08,
        Scale::Tabletop => 0.02,
    }
}

/// What may happen of all that a predicate speaks of: of each thing alone where a clause says "it walks", of each pair
/// where it says to whom something is done.
pub fn events(tracks: &Tracks, predicate: &Predicate) -> Vec<BelievedEvent> {
    let world = World::new(tracks);
    let motions: Vec<Motion<'_>> = tracks.instances.iter().map(|thing| Motion::new(&world, thing)).collect();
    let wanted: BTreeSet<(&str, bool)> = predicate.clauses().into_iter().filter_map(wanted).collect();
    let mut events = Vec::new();
    for (verb, has_other) in wanted {
        let mut add = |subject: &Motion<'_>, object: Option<&Motion<'_>>, degree: Degrees| {
            if degree.values().iter().any(|degree| *degree > LEAST) {
                let subject = subject.thing.name.clone();
                let object = object.map(|object| object.thing.name.clone());
                events.push(BelievedEvent { subject, verb: verb.to_owned(), object, degree });
            }
        };
        for subject in &motions {
            if !has_other {
                let look = looks(ALONE, verb, Alone::Stir);
                add(subject, None, Degrees::when(|frame| subject.looks_like(look, frame)));
                continue;
            }
            let look = looks(UPON, verb, Upon::Busy);
            for object in motions.iter().filter(|object| object.thing.name != subject.thing.name) {
                let pair = Pair { world: &world, subject, object };
                add(subject, Some(object), Degrees::when(|frame| pair.looks_like(look, frame)));
            }
        }
    }
    events
}

/// The verb of a clause, and whether it says to whom or by whom.
fn wanted(clause: &Clause) -> Option<(&str, bool)> {
    match clause {
        Clause::Does { verb, to } => Some((verb, to.is_some())),
        Clause::Undergoes { verb, .. } => Some((verb, true)),
        _ => None,
    }
}

/// 0 at nothing, a half at the threshold, 1 far above.
fn rise(value: f64, threshold: f64) -> f64 {
    if value <= 0.0 { 0.0 } else { value * value / (value * value + threshold * threshold) }
}

/// How a thing moves.
struct Motion<'a> {
    thing: &'a TrackedInstance,
    /// Speed of what moves at this scale, metres a second.
    least_mps: f64,
    /// Velocity of the centre, metres a second.
    velocity: Vec<glam::DVec3>,
    /// Speed of turning, degrees a second.
    turn_dps: Vec<f64>,
    /// How far it leans from where it stands best, degrees.
    tilt_deg: Vec<f64>,
    /// Change of the sides, shares of the diagonal a second.
    stir: Vec<f64>,
    /// Height as a share of the largest.
    height: Vec<f64>,
    /// Speed at which its legs would leave the ground, metres a second.
    gait_mps: f64,
    /// How high its bottom is above where it is lowest, in heights.
    lift: Vec<f64>,
}

impl<'a> Motion<'a> {
    fn new(world: &World<'a>, thing: &'a TrackedInstance) -> Self {
        let obb = |frame: u32| world.obb(thing, frame);
        let frames = || 0..=LAST_FRAME;
        let around = |frame: u32| (frame.saturating_sub(REACH), (frame + REACH).min(LAST_FRAME));
        let seconds = |(from, to): (u32, u32)| f64::from(to - from) / FPS;
        let axes = |frame: u32| glam::DMat3::from_cols_array(at_frame(&thing.track.axes, frame));
        let sides = |frame: u32| glam::DVec3::from_array(*at_frame(&thing.track.extents, frame));
        let rate = |measure: &dyn Fn(u32, u32) -> f64| -> Vec<f64> {
            frames().map(around).map(|span| measure(span.0, span.1) / seconds(span)).collect()
        };
        let angle = |from: u32, to: u32| {
            let between = axes(from).transpose() * axes(to);
            let trace = between.x_axis.x + between.y_axis.y + between.z_axis.z;
            ((trace - 1.0) / 2.0).clamp(-1.0, 1.0).acos().to_degrees()
        };
        let diagonal = obb(0).diagonal().max(1e-6);
        let tallest = frames().map(|frame| obb(frame).height()).fold(1e-6, f64::max);
        let lowest = frames().map(|frame| obb(frame).bottom()).fold(f64::INFINITY, f64::min);
        // Rows of the stored matrix are axes of the world in the box: the last one says which way is up.
        let up = |frame: u32| axes(frame).z_axis.abs();
        let standing = up(0).max_position();
        Self {
            thing,
            least_mps: moves_mps(world.scale()),
            velocity: frames()
                .map(around)
                .map(|span| (obb(span.1).centre - obb(span.0).centre) / seconds(span))
                .collect(),
            turn_dps: rate(&angle),
            tilt_deg: frames().map(|frame| up(frame)[standing].clamp(0.0, 1.0).acos().to_degrees()).collect(),
            stir: rate(&|from, to| (sides(to) - sides(from)).abs().element_sum() / diagonal),
            height: frames().map(|frame| obb(frame).height() / tallest).collect(),
            gait_mps: (0.5 * GRAVITY * 0.5 * tallest).sqrt(),
            lift: frames().map(|frame| (obb(frame).bottom() - lowest) / tallest).collect(),
        }
    }

    fn travels(&self, frame: u32) -> f64 {
        rise(self.velocity[frame as usize].truncate().length(), self.least_mps)
    }

    /// Travels, but not through the air.
    fn slides(&self, frame: u32) -> f64 {
        self.travels(frame) * (1.0 - rise(self.lift[frame as usize], 0.2))
    }

    fn stirs(&self, frame: u32) -> f64 {
        let at = frame as usize;
        rise(self.stir[at], STIR).max(rise(self.turn_dps[at], TURN_DPS))
    }

    /// Change of a measure around a frame, a second.
    fn change(&self, measure: impl Fn(usize) -> f64, frame: u32) -> f64 {
        let (from, to) = (frame.saturating_sub(REACH), (frame + REACH).min(LAST_FRAME));
        (measure(to as usize) - measure(from as usize)) * FPS / f64::from(to - from)
    }

    fn tips(&self, frame: u32) -> f64 {
        logistic(self.tilt_deg[frame as usize] - TILT_DEG[0], TILT_DEG[1])
    }

    fn looks_like(&self, look: Alone, frame: u32) -> f64 {
        let at = frame as usize;
        let speed = |at: usize| self.velocity[at].truncate().length();
        let still = 1.0 - self.travels(frame);
        let dashes = logistic(speed(at) / self.gait_mps - DASH[0], DASH[1]);
        let flies = rise(self.lift[at], 0.5);
        let upright = logistic(self.height[at] - UPRIGHT[0], UPRIGHT[1]);
        let grows = self.change(|at| self.height[at], frame);
        match look {
            Alone::Travel => self.travels(frame),
            // What runs or flies does not walk.
            Alone::Walk => self.travels(frame) * (1.0 - dashes) * (1.0 - flies),
            Alone::Slide => self.slides(frame),
            Alone::Dash => dashes,
            Alone::Stand => still * upright,
            Alone::Sit => still * (1.0 - 0.7 * upright),
            Alone::Still => still,
            Alone::Turn => rise(self.turn_dps[at], TURN_DPS),
            Alone::Tip => self.tips(frame),
            Alone::Sink => rise(-grows, SINK),
            Alone::Grow => rise(grows, SINK),
            Alone::Fly => flies,
            Alone::Land => rise(-self.velocity[at].z, self.least_mps) * (1.0 - rise(self.lift[at], 2.0)),
            Alone::Brake => rise(-self.change(speed, frame), self.least_mps),
            Alone::Start => rise(self.change(speed, frame), self.least_mps),
            Alone::Unfold => rise(self.stir[at], STIR) * still,
            Alone::Stir => self.stirs(frame) * (1.0 - 0.7 * self.travels(frame)),
        }
    }
}

/// Somebody and what may be acted on.
struct Pair<'p, 'a> {
    world: &'p World<'a>,
    subject: &'p Motion<'a>,
    object: &'p Motion<'a>,
}

impl Pair<'_, '_> {
    fn distance_m(&self, frame: u32) -> f64 {
        self.world.distance_m(self.subject.thing, self.object.thing, frame)
    }

    /// Whether both are within some touches of each other.
    fn near(&self, frame: u32, touches: f64) -> f64 {
        let touch = touches * touch_m(self.world.scale());
        logistic(touch - self.distance_m(frame), touch / 3.0)
    }

    fn looks_like(&self, look: Upon, frame: u32) -> f64 {
        let (subject, object) = (self.subject, self.object);
        let at = frame as usize;
        let [own, others] = [subject.velocity[at], object.velocity[at]];
        let least = subject.least_mps;
        let near = self.near(frame, 1.0);
        let moves = rise(others.length(), least);
        let together = own.normalize_or_zero().dot(others.normalize_or_zero()).max(0.0);
        let [here, there] = [subject, object].map(|one| self.world.obb(one.thing, frame));
        let towards = (there.centre - here.centre).normalize_or_zero();
        match look {
            Upon::Hold => near * (0.5 + 0.5 * moves),
            Upon::Lift => near * rise(others.z, least),
            Upon::Lower => near * rise(-others.z, least),
            Upon::Carry => near * moves * (0.3 + 0.7 * together),
            Upon::Push => near * object.slides(frame),
            Upon::Hit => {
                let after = frame..=(frame + BLOW_FRAMES).min(LAST_FRAME);
                let before = object.travels(frame.saturating_sub(BLOW_FRAMES));
                near * after.map(|frame| object.travels(frame)).fold(0.0, f64::max) * (1.0 - 0.5 * before)
            }
            Upon::Chase => {
                subject.travels(frame)
                    * moves
                    * own.normalize_or_zero().dot(towards).max(0.0)
                    * (0.3 + 0.7 * together)
            }
            Upon::Approach => subject.travels(frame) * rise((own - others).dot(towards), least),
            Upon::Leave => subject.travels(frame) * rise(-(own - others).dot(towards), least),
            Upon::Pour => {
                let above = logistic(here.top() - there.top(), 0.3 * there.height().max(1e-6));
                self.near(frame, 4.0) * above * subject.tips(frame).max(0.6 * subject.stirs(frame))
            }
            Upon::Await => {
                let far = 4.0 * before_m(self.world.scale());
                let is_in_sight = logistic(far - self.distance_m(frame), far / 3.0);
                (1.0 - subject.travels(frame)) * object.travels(frame) * is_in_sight
            }
            Upon::Unfold => near * rise(object.stir[at], STIR),
            Upon::Turn => near * rise(object.turn_dps[at], TURN_DPS),
            Upon::Busy => near * (0.4 + 0.6 * subject.stirs(frame)),
        }
    }
}
