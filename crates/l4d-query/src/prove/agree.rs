//! Declared events against geometry that doesn't know of them: what is held is near, what moves moves, what rests rests.

use std::ops::RangeInclusive;
use std::path::Path;

use l4d_data::tracks::{TrackedInstance, at_frame};
use l4d_data::{Event, Report, Scale};

use crate::relations::contact;
use crate::thresholds::moves_mps;
use crate::verbs;
use crate::world::World;

/// Who holds a thing is this near to it, metres.
const HOLD_M: f64 = 0.02;
/// Frames at either end of an interval in which a hand may still close or already open.
const EDGE_FRAMES: u32 = 3;
/// What moves by less than this in a whole interval doesn't act at all, metres.
const STIRS_M: f64 = 0.001;

/// Farthest that the box centre of what stands, sits or lies strays from its mean in plan, metres: arms wave and
/// heads turn, and the box follows them.
const fn stays_m(scale: Scale) -> f64 {
    match scale {
        Scale::Outdoor => 0.35,
        Scale::Room => 0.30,
        Scale::Tabletop => 0.05,
    }
}

/// Compares every declared event with boxes and mesh distances; `path` is the file of the tracks.
pub(super) fn check(world: &World<'_>, path: &Path, report: &mut Report) {
    for event in world.events() {
        let Some(subject) = world.instance(&event.subject) else { continue };
        let object = event.object.as_ref().and_then(|name| world.instance(name));
        let declared = Declared { world, event, subject, object };
        let problems = [declared.contact_problem(), declared.motion_problem(), declared.idle_problem()];
        for (code, message) in problems.into_iter().flatten() {
            let (first, last) = (event.frames.first(), event.frames.last());
            let whom = event.object.as_ref().map_or_else(String::new, |name| format!(" {name}"));
            let place = format!("event {} {}{whom} [{first}, {last}]", event.subject, event.verb);
            report.error(code, path, place, message, "mend the recipe, or declare what it animates");
        }
    }
}

/// An event with who takes part.
struct Declared<'d, 'a> {
    world: &'d World<'a>,
    event: &'a Event,
    subject: &'a TrackedInstance,
    object: Option<&'a TrackedInstance>,
}

/// A code, and what is wrong.
type Problem = Option<(&'static str, String)>;

impl Declared<'_, '_> {
    fn frames(&self) -> RangeInclusive<u32> {
        self.event.frames.first()..=self.event.frames.last()
    }

    fn contact_problem(&self) -> Problem {
        let pair = self.world.pair(self.subject, self.object?);
        let distance = |frame: u32| pair.map_or(f64::INFINITY, |pair| *at_frame(&pair.distance_m, frame));
        let centimetres = |metres: f64| format!("{:.1} cm", metres * 100.0);
        let limit = centimetres(HOLD_M);
        if verbs::is_holding(&self.event.verb) {
            let inner = self.event.frames.first() + EDGE_FRAMES..=self.event.frames.last() - EDGE_FRAMES;
            let distances = inner.map(|frame| (frame, distance(frame)));
            let (frame, worst) = distances.max_by(|a, b| a.1.total_cmp(&b.1))?;
            let message =
                format!("they are {} apart at frame {frame}, more than {limit}", centimetres(worst));
            return (worst > HOLD_M).then_some(("L4D220", message));
        }
        if verbs::is_meeting(&self.event.verb) {
            let nearest = self.frames().map(distance).min_by(f64::total_cmp)?;
            let message =
                format!("they never meet: at best {} apart, more than {limit}", centimetres(nearest));
            return (nearest > HOLD_M).then_some(("L4D220", message));
        }
        None
    }

    fn motion_problem(&self) -> Problem {
        let Self { world, event, subject, .. } = self;
        if verbs::is_moving(&event.verb) && !is_on_treadmill(world, subject, event.frames.first()) {
            let seconds = f64::from(event.frames.frame_count()) / world.tracks().fps;
            let speed = path_length_m(world, subject, self.frames()) / seconds;
            let least = moves_mps(world.scale());
            if speed < least {
                let message = format!("its box moves at {speed:.3} m/s, less than {least} m/s");
                return Some(("L4D221", message));
            }
        }
        if verbs::is_state(&event.verb) {
            let places: Vec<_> =
                self.frames().map(|frame| world.obb(subject, frame).centre.truncate()).collect();
            let mean = places.iter().sum::<glam::DVec2>() / places.len() as f64;
            let strays = places.iter().map(|place| place.distance(mean)).fold(0.0, f64::max);
            let most = stays_m(world.scale());
            if strays > most {
                return Some(("L4D222", format!("its box strays {strays:.2} m, more than {most} m")));
            }
        }
        None
    }

    /// Something that is declared and of which nothing can be seen: neither side changes at all.
    fn idle_problem(&self) -> Problem {
        let stirs = |instance: &TrackedInstance| {
            let start = self.world.obb(instance, self.event.frames.first());
            self.frames().any(|frame| self.world.obb(instance, frame).differs(start, STIRS_M))
        };
        let is_idle =
            !verbs::is_quiet(&self.event.verb) && !stirs(self.subject) && !self.object.is_some_and(stirs);
        is_idle.then(|| ("L4D223", "nothing of it moves in that time".to_owned()))
    }
}

fn is_on_treadmill(world: &World<'_>, subject: &TrackedInstance, frame: u32) -> bool {
    let mut machines = world.instances().filter(|instance| instance.category == "treadmill");
    machines.any(|machine| contact(world, world.slack(), subject, machine).at(frame))
}

/// Length of the path of the box centre, metres.
pub(crate) fn path_length_m(
    world: &World<'_>,
    instance: &TrackedInstance,
    frames: impl Iterator<Item = u32>,
) -> f64 {
    let places: Vec<_> = frames.map(|frame| world.obb(instance, frame).centre).collect();
    places.windows(2).map(|step| step[0].distance(step[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{event, moving, pair, standing, tracks};

    fn codes(events: &[String], distances: &[f64]) -> Vec<String> {
        let path: Vec<[f64; 3]> = (0..97).map(|frame| [f64::from(frame.min(48)) / 48.0, 0.0, 0.0]).collect();
        let instances = [
            moving(1, "mover", "cup", &path, [0.1; 3]),
            standing(2, "rester", "cup", [1., 0., 0.], [0.1; 3]),
            standing(1001, "hand", "hand", [1., 0., 0.], [0.1; 3]),
        ];
        let tracks = tracks(&instances, &events.join(","), &pair("hand", "rester", distances));
        let mut report = Report::default();
        check(&World::new(&tracks), Path::new("s.json"), &mut report);
        report.into_sorted().into_iter().map(|finding| finding.code.to_owned()).collect()
    }

    #[test]
    fn what_is_held_is_near() {
        let near: Vec<f64> =
            (0..97).map(|frame| if (20..=60).contains(&frame) { 0.01 } else { 0.3 }).collect();
        let hold = |frames: [u32; 2]| event("hand", "hold", Some("rester"), frames);
        let lift = |frames: [u32; 2]| event("hand", "lift", Some("rester"), frames);
        // Nothing moves here: holding may be quiet, lifting may not.
        assert_eq!(codes(&[hold([17, 63])], &near), [""; 0]);
        assert_eq!(codes(&[hold([10, 63])], &near), ["L4D220"]);
        assert_eq!(codes(&[lift([0, 40])], &near), ["L4D223"]);
        assert_eq!(codes(&[lift([70, 96])], &near), ["L4D220", "L4D223"]);
    }

    #[test]
    fn what_moves_moves_and_what_rests_rests() {
        let does = |who: &str, verb: &str, frames: [u32; 2]| codes(&[event(who, verb, None, frames)], &[0.3]);
        assert_eq!(does("mover", "roll", [0, 48]), [""; 0]);
        assert_eq!(does("mover", "roll", [60, 90]), ["L4D221", "L4D223"]);
        assert_eq!(does("mover", "stand", [0, 48]), ["L4D222"]);
        assert_eq!(does("rester", "stand", [0, 96]), [""; 0]);
        assert_eq!(does("rester", "wave", [0, 96]), ["L4D223"]);
    }
}
