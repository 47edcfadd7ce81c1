mod rendered;
mod swaps;

use std::collections::BTreeSet;

use l4d_data::scene::Instance;
use l4d_data::{Category, DataError, Interval};

use super::*;
use crate::testing::{asked_from, blank_clip, question};

const SIZE: (u32, u32) = (40, 30);
const FRAMES: [u32; 5] = [0, 12, 24, 36, 48];
const REFERENT: u32 = 1;

/// Each instance is a block of 8 x 8 pixels, in every view and frame at the same place.
#[derive(Debug)]
struct Blocks;

fn block(id: u32) -> Mask {
    Mask::from_fn(SIZE.0, SIZE.1, |col, row| col / 8 == id - 1 && (10..18).contains(&row))
}

impl IdSource for Blocks {
    fn identity(&self) -> Value {
        json!("blocks")
    }

    fn instances(&self) -> &[Instance] {
        &[]
    }

    fn pixels_of(&self, _: &Name, _: u32, ids: &[u32]) -> Result<Mask, DataError> {
        let mut pixels = Mask::empty(SIZE.0, SIZE.1);
        ids.iter().for_each(|&id| pixels.union_with(&block(id)));
        Ok(pixels)
    }
}

fn name(text: &str) -> Name {
    Name::new(text).unwrap()
}

fn target() -> Target {
    Target {
        referents: vec![REFERENT],
        look_alikes: vec![2, 3, 4],
        categories: vec![Category::Action],
        frames: vec![Interval::WHOLE],
    }
}

fn swaps(probability: f64) -> NoiseModel {
    NoiseModel { swap: Swap { probability, correlation: 0.0 }, ..NoiseModel::default() }
}

fn oracle_of(target: Target, noise: NoiseModel, seed: u64) -> Oracle {
    let preset = NoisePreset { seed, noise, swap_probability: BTreeMap::new() };
    let targets = (0..500).map(|number| (name(&format!("{number:03}")), target.clone())).collect();
    Oracle::new(name("yard"), Arc::new(Blocks), targets, preset)
}

fn oracle(noise: NoiseModel) -> Oracle {
    oracle_of(target(), noise, 7)
}

fn clip(view: usize) -> ViewClip {
    blank_clip(&format!("cam{view:02}"), SIZE.0, SIZE.1, &FRAMES)
}

fn ask(oracle: &Oracle, number: usize, view: usize) -> Grounding {
    oracle.ground(&clip(view), &question("yard", &format!("{number:03}")))
}

/// Which instance a grounding shows in its first frame.
fn shown(grounding: &Grounding) -> Option<u32> {
    (1..=4).find(|&id| grounding.masks[&0] == block(id))
}

#[test]
fn without_noise_it_is_the_truth() {
    let oracle = oracle(NoiseModel::default());
    for view in 0..4 {
        let grounding = ask(&oracle, 1, view);
        assert_eq!(grounding.outcome, Outcome::Found);
        assert_eq!(grounding.masks.keys().copied().collect::<Vec<_>>(), FRAMES);
        assert!(grounding.masks.values().all(|mask| *mask == block(REFERENT)));
    }
    assert!(oracle.uses_truth());
}

#[test]
fn a_query_bound_to_a_time_is_shown_then_alone() {
    let gated = Target { frames: vec![Interval::new(12, 30).unwrap()], ..target() };
    for noise in [NoiseModel::default(), swaps(1.0)] {
        let grounding = ask(&oracle_of(gated.clone(), noise, 7), 1, 0);
        let seen: Vec<u32> = FRAMES.into_iter().filter(|frame| !grounding.masks[frame].is_empty()).collect();
        assert_eq!(seen, [12, 24]);
    }
    let asked = asked_from(question("yard", "001"), 20, 40);
    let masks = oracle(NoiseModel::default()).ground(&clip(0), &asked).masks;
    assert_eq!(FRAMES.map(|frame| masks[&frame].is_empty()), [true, true, false, false, true]);
}

#[test]
fn swapped_views_agree_on_a_look_alike() {
    let swapping = oracle(swaps(1.0));
    for number in 0..20 {
        assert_eq!(shown(&ask(&swapping, number, 0)), shown(&ask(&swapping, number, 1)));
    }
    let all: BTreeSet<u32> = (0..100).filter_map(|number| shown(&ask(&swapping, number, 0))).collect();
    assert_eq!(all.into_iter().collect::<Vec<_>>(), [2, 3, 4]);
}

#[test]
fn groups_are_swapped_for_as_many_as_there_are() {
    let pair = Target { referents: vec![1, 2], look_alikes: vec![3, 4], ..target() };
    let both = ask(&oracle_of(pair.clone(), swaps(1.0), 7), 1, 0);
    let mut expected = block(3);
    expected.union_with(&block(4));
    assert_eq!(both.masks[&0], expected);
    let lonely = Target { look_alikes: Vec::new(), ..target() };
    let grounding = ask(&oracle_of(lonely, swaps(1.0), 7), 1, 0);
    assert_eq!(shown(&grounding), Some(REFERENT));
    assert!(grounding.notes[0].contains("nothing is like them"), "{:?}", grounding.notes);
    let absent = Target { referents: Vec::new(), look_alikes: Vec::new(), ..target() };
    assert_eq!(ask(&oracle_of(absent, swaps(1.0), 7), 1, 0).outcome, Outcome::Absent);
}

#[test]
fn dropped_views_and_flickering_frames_come_at_their_rates() {
    let dropping = oracle(NoiseModel { dropped_views: 0.3, ..NoiseModel::default() });
    let groundings: Vec<Grounding> =
        (0..250).flat_map(|number| [0, 1].map(|view| ask(&dropping, number, view))).collect();
    assert!(groundings.iter().all(|grounding| grounding.masks.len() == FRAMES.len()));
    let dropped = groundings.iter().filter(|grounding| grounding.outcome == Outcome::Absent).count();
    // 4 standard deviations of a binomial of 500 at 0.3 are 41.
    assert!(dropped.abs_diff(150) < 41, "{dropped}");
    let flickering = oracle(NoiseModel { flicker: 0.3, ..NoiseModel::default() });
    let frames = (0..200).flat_map(|number| ask(&flickering, number, 0).masks.into_values());
    let dark = frames.filter(Mask::is_empty).count();
    // 4 standard deviations of a binomial of 1000 at 0.3 are 58.
    assert!(dark.abs_diff(300) < 58, "{dark}");
}

#[test]
fn edges_move_by_the_stated_pixels() {
    let area = |edge_px: [i32; 2], number: usize| {
        let mask = &ask(&oracle(NoiseModel { edge_px, ..NoiseModel::default() }), number, 1).masks[&0];
        mask.area()
    };
    // The block of id 1 touches the left border, which neither grows nor shrinks: 8 x 8 becomes 7 x 6.
    assert_eq!(area([-1, -1], 1), 42);
    // Grown by 1: 8 x 8, and 8 pixels on each of three sides, without the corners.
    assert_eq!(area([1, 1], 1), 64 + 24);
    assert_eq!(area([-4, -4], 1), 0);
    let areas: BTreeSet<u64> = (0..60).map(|number| area([-1, 1], number)).collect();
    assert_eq!(areas.into_iter().collect::<Vec<_>>(), [42, 64, 88]);
}

fn everything() -> NoiseModel {
    NoiseModel {
        swap: Swap { probability: 0.4, correlation: 0.3 },
        dropped_views: 0.2,
        flicker: 0.3,
        edge_px: [-2, 2],
    }
}

#[test]
fn answers_depend_on_seed_query_view_and_frame_alone() {
    let one = oracle(everything());
    let other = oracle(everything());
    // Asked in another order, and of some views only.
    let forward: Vec<Grounding> = (0..8).map(|view| ask(&one, 5, view)).collect();
    for view in [6, 2, 4] {
        assert_eq!(ask(&other, 5, view), forward[view]);
    }
    // Some frames only.
    let short = blank_clip("cam03", SIZE.0, SIZE.1, &[12, 48]);
    let masks = other.ground(&short, &question("yard", "005")).masks;
    assert_eq!([&masks[&12], &masks[&48]], [&forward[3].masks[&12], &forward[3].masks[&48]]);
    let differs =
        |oracle: &Oracle, number: usize| (0..8).any(|view| ask(oracle, number, view) != forward[view]);
    assert!(differs(&oracle_of(target(), everything(), 8), 5), "the seed has no say");
    assert!(differs(&one, 6), "the query has no say");
    // No noise of one kind touches the draws of another.
    let calm = oracle(NoiseModel { dropped_views: 0.0, flicker: 0.0, edge_px: [0, 0], ..everything() });
    let notes = |oracle: &Oracle| -> Vec<String> {
        let of_view = |view| ask(oracle, 5, view).notes.remove(0);
        (0..8).map(of_view).collect()
    };
    let pairs = notes(&one).into_iter().zip(notes(&calm));
    assert!(pairs.filter(|(noisy, _)| !noisy.starts_with("dropped")).all(|(noisy, calm)| noisy == calm));
}

#[test]
fn categories_have_their_own_share_of_swaps() {
    let preset =
        NoisePreset { swap_probability: BTreeMap::from([(Category::Action, 1.0)]), ..NoisePreset::none() };
    let spatial = Target { categories: vec![Category::Spatial], ..target() };
    let targets = BTreeMap::from([(name("001"), target()), (name("002"), spatial)]);
    let oracle = Oracle::new(name("yard"), Arc::new(Blocks), targets, preset);
    assert_ne!(shown(&ask(&oracle, 1, 0)), Some(REFERENT));
    assert_eq!(shown(&ask(&oracle, 2, 0)), Some(REFERENT));
}

#[test]
fn the_identity_holds_all_that_answers_depend_on() {
    let other = Target { look_alikes: vec![2], ..target() };
    let identities = [
        oracle(NoiseModel::default()),
        oracle(swaps(0.1)),
        oracle_of(target(), NoiseModel::default(), 8),
        oracle_of(other, NoiseModel::default(), 7),
    ]
    .map(|oracle| oracle.identity().to_string());
    assert_eq!(identities.into_iter().collect::<BTreeSet<_>>().len(), 4);
}

#[test]
fn what_it_does_not_know_is_an_error_with_its_place() {
    let oracle = oracle(NoiseModel::default());
    let own = Question { number: None, ..question("yard", "001") };
    for (clip, question, words) in [
        (clip(0), question("barn", "001"), "scene yard, but is asked about barn"),
        (clip(0), question("yard", "999"), "no query 999"),
        (clip(0), own, "by their number alone"),
        (blank_clip("cam00", 20, 15, &FRAMES), question("yard", "001"), "clip is 20x15, but ids of"),
    ] {
        let outcome = oracle.ground(&clip, &question).outcome;
        assert!(matches!(&outcome, Outcome::Error(why) if why.contains(words)), "{outcome:?}");
    }
}
