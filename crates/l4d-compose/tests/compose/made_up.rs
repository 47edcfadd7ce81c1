//! Made-up scenes: two groups on a table, two hands, landmarks, and acts that are drawn and carried out.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use l4d_data::camera::{looking_at, rows};
use l4d_data::timeline::FRAME_COUNT;
use l4d_data::tracks::{Pair, SCHEMA, Track, TrackedCamera, TrackedInstance, Tracks};
use l4d_data::{Event, Interval, Name, Profile, Role, Scale, Split};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Radius of every thing, metres.
const RADIUS: f64 = 0.03;
/// When acts happen.
const SLOTS: [[u32; 2]; 3] = [[2, 28], [34, 60], [66, 94]];

struct Thing {
    name: String,
    noun: &'static str,
    attributes: BTreeMap<String, String>,
    front: Option<String>,
    size: f64,
    path: Vec<DVec3>,
}

fn name(text: &str) -> Name {
    Name::new(text).unwrap()
}

/// A scene of `groups`, each a noun and how many there are.
pub(crate) fn scene(label: &str, groups: &[(&'static str, usize)], seed: u64) -> Tracks {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut things: Vec<Thing> = Vec::new();
    for (noun, count) in groups {
        for place in 0..*count {
            let front = (*noun == "duck").then(|| "-y".to_owned());
            add(&mut things, format!("{noun}_{place}"), noun, front, &mut random);
        }
    }
    let objects = things.len();
    for noun in ["tray", "lamp", "book"] {
        let front = (noun == "lamp").then(|| "-y".to_owned());
        add(&mut things, noun.to_owned(), noun, front, &mut random);
    }
    for hand in ["hand_a", "hand_b"] {
        add(&mut things, hand.to_owned(), "hand", None, &mut random);
    }
    let [brown, blue] = [objects + 3, objects + 4];
    for (hand, sleeve) in [(brown, "brown"), (blue, "blue")] {
        things[hand].attributes = BTreeMap::from([("sleeve".to_owned(), sleeve.to_owned())]);
    }

    let mut events = Vec::new();
    for slot in SLOTS {
        let mut left: Vec<usize> = (0..objects).collect();
        for hand in [brown, blue] {
            let verb = ["push", "lift", "tap"][random.random_range(0..3)];
            let object = left.swap_remove(random.random_range(0..left.len()));
            act(&mut things, hand, object, verb, slot, &mut random);
            events.push(event(&things[hand].name, verb, Some(&things[object].name), slot));
        }
        for verb in ["roll", "wobble"] {
            if left.len() > 1 && random.random::<f64>() < 0.7 {
                let object = left.swap_remove(random.random_range(0..left.len()));
                alone(&mut things[object], verb, slot, &mut random);
                events.push(event(&things[object].name, verb, None, slot));
            }
        }
    }
    Tracks {
        schema: SCHEMA.to_owned(),
        scene: name(label),
        scale: Scale::Tabletop,
        variant: 0,
        seed,
        fps: 24.0,
        frame_count: FRAME_COUNT,
        exposure: 1.0,
        description: "A made-up scene.".to_owned(),
        pairs: pairs(&things),
        instances: things.iter().enumerate().map(|(place, thing)| instance(thing, place, objects)).collect(),
        events,
        pair_reach_m: 5.0,
        cameras: vec![
            camera("test", Split::Test, [0.5, -0.9, 0.9]),
            camera("cam00", Split::Train, [0., -1., 1.]),
        ],
    }
}

fn add(
    things: &mut Vec<Thing>,
    label: String,
    noun: &'static str,
    front: Option<String>,
    random: &mut ChaCha8Rng,
) {
    let mut draw = |values: &[&str]| values[random.random_range(0..values.len())].to_owned();
    let attributes = BTreeMap::from([
        ("colour".to_owned(), draw(&["red", "blue", "green"])),
        ("material".to_owned(), draw(&["wood", "plastic"])),
        ("pattern".to_owned(), draw(&["striped", "dotted", "plain"])),
    ]);
    let place = loop {
        let place = DVec2::new(random.random_range(-0.4..0.4), random.random_range(-0.3..0.3));
        if things.iter().all(|other| other.path[0].truncate().distance(place) > 2.5 * RADIUS) {
            break place;
        }
    };
    let size = 1.0 + 0.5 * random.random::<f64>();
    let path = vec![place.extend(RADIUS); FRAME_COUNT as usize];
    things.push(Thing { name: label, noun, attributes, front, size, path });
}

/// How far an act is, 0 to 1, smoothly.
fn progress(frame: u32, [first, last]: [u32; 2]) -> f64 {
    let t = ((f64::from(frame) - f64::from(first)) / f64::from(last - first)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn act(
    things: &mut [Thing],
    hand: usize,
    object: usize,
    verb: &str,
    slot: [u32; 2],
    random: &mut ChaCha8Rng,
) {
    let goal = DVec3::new(random.random_range(-0.4..0.4), random.random_range(-0.3..0.3), RADIUS);
    let start = things[object].path[slot[0] as usize];
    for frame in slot[0]..FRAME_COUNT {
        let along = progress(frame, slot);
        things[object].path[frame as usize] = match verb {
            "push" => start.lerp(goal, along),
            "lift" => start + DVec3::Z * 0.12 * (along * std::f64::consts::PI).sin(),
            _ => start,
        };
    }
    let rest = things[hand].path[slot[0] as usize];
    let reach = 2.0 * RADIUS;
    for frame in slot[0]..=slot[1] {
        let beside = things[object].path[frame as usize] + DVec3::Z * reach;
        // A tap comes down and goes; the others hold on.
        let near = if verb == "tap" { (progress(frame, slot) * std::f64::consts::PI).sin() } else { 1.0 };
        things[hand].path[frame as usize] = rest.lerp(beside, near);
    }
}

fn alone(thing: &mut Thing, verb: &str, slot: [u32; 2], random: &mut ChaCha8Rng) {
    let start = thing.path[slot[0] as usize];
    let turn = random.random_range(0.0..std::f64::consts::TAU);
    for frame in slot[0]..FRAME_COUNT {
        let along = progress(frame, slot);
        let offset = match verb {
            "roll" => 0.15 * along,
            _ => 0.01 * (along * std::f64::consts::TAU * 3.0).sin(),
        };
        thing.path[frame as usize] = start + DVec2::from_angle(turn).extend(0.0) * offset;
    }
}

fn event(subject: &str, verb: &str, object: Option<&str>, [first, last]: [u32; 2]) -> Event {
    let frames = Interval::new(first, last).unwrap();
    Event { subject: name(subject), verb: verb.to_owned(), object: object.map(name), frames }
}

fn instance(thing: &Thing, place: usize, objects: usize) -> TrackedInstance {
    let (role, id) =
        if place < objects { (Role::Object, place + 1) } else { (Role::Landmark, 1001 + place - objects) };
    let side = 2.0 * RADIUS * if role == Role::Object { thing.size } else { 1.0 };
    TrackedInstance {
        id: id as u32,
        name: name(&thing.name),
        role,
        category: thing.noun.to_owned(),
        attributes: thing.attributes.clone(),
        front: thing.front.clone(),
        track: Track {
            centre: thing.path.iter().map(DVec3::to_array).collect(),
            axes: vec![[1., 0., 0., 0., 1., 0., 0., 0., 1.]],
            extents: vec![[side; 3]],
        },
    }
}

/// Every pair, as if all were balls.
fn pairs(things: &[Thing]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (place, a) in things.iter().enumerate() {
        for b in &things[place + 1..] {
            let distance = |(here, there): (&DVec3, &DVec3)| (here.distance(*there) - 2.0 * RADIUS).max(0.0);
            let distance_m = a.path.iter().zip(&b.path).map(distance).collect();
            pairs.push(Pair { a: name(&a.name), b: name(&b.name), distance_m, contact: Vec::new() });
        }
    }
    pairs
}

fn camera(label: &str, split: Split, eye: [f64; 3]) -> TrackedCamera {
    TrackedCamera {
        name: name(label),
        split,
        profiles: vec![Profile::Tiny, Profile::Small, Profile::Full],
        focal_over_width: 0.9,
        world_from_camera: vec![rows(looking_at(DVec3::from_array(eye), DVec3::ZERO))],
    }
}
