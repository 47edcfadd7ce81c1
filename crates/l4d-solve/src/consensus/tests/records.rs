//! The record: complete, the same for any number of threads, readable again, and shown to people.

use glam::DVec3;
use l4d_ground::{Grounding, Outcome, ViewClip};

use super::decide;
use super::world::{Shape, Thing, World, arc};
use crate::consensus::{Consensus, ConsensusSettings};

/// Two balls that change places, on a floor; eight views.
fn two_balls() -> World {
    World {
        things: vec![
            Thing {
                id: 1001,
                shape: Shape::Box(DVec3::new(20.0, 20.0, 0.1)),
                centre: |_| DVec3::new(0.0, 0.0, -0.5),
            },
            Thing {
                id: 1,
                shape: Shape::Sphere(0.35),
                centre: |frame| DVec3::new(f64::from(frame) / 60.0 - 0.8, 0.0, 0.0),
            },
            Thing {
                id: 2,
                shape: Shape::Sphere(0.35),
                centre: |frame| DVec3::new(0.8 - f64::from(frame) / 60.0, 0.9, 0.0),
            },
        ],
        cameras: arc(8, 90.0, [128, 96], 120.0),
        frames: (0..97).step_by(12).collect(),
    }
}

/// Five views mean one ball, one the other, one nothing; one did not answer.
fn mixed(world: &World, clips: &[ViewClip]) -> Vec<Grounding> {
    let mut groundings: Vec<Grounding> =
        (0..8).map(|view| world.marking(clips, view, if view == 5 { 2 } else { 1 })).collect();
    groundings[6] = Grounding::of_masks(&clips[6], Default::default(), Vec::new());
    groundings[7] = Grounding::without_answer(Outcome::Refused("it would rather not".into()));
    groundings
}

#[test]
fn the_record_is_the_same_for_any_number_of_threads_and_reads_back() {
    let world = two_balls();
    let clips = world.clips();
    let groundings = mixed(&world, &clips);
    for settings in [ConsensusSettings::paper(), ConsensusSettings::robust()] {
        let with_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| decide(&clips, &groundings, &settings))
        };
        let consensus = with_threads(1);
        assert_eq!(consensus, with_threads(5));
        let json = serde_json::to_string(&consensus).unwrap();
        assert_eq!(json, serde_json::to_string(&with_threads(3)).unwrap());
        assert_eq!(serde_json::from_str::<Consensus>(&json).unwrap(), consensus);
        assert_eq!(consensus.evidence, [0, 1, 2, 3, 4]);
        // Six views found something, and seven answered.
        assert_eq!(consensus.pairs.len(), 6 * 6);
        assert!(consensus.pairs.iter().all(|pair| pair.frames.len() == 9));
        for record in consensus.pairs.iter().flat_map(|pair| &pair.frames) {
            let counts = record.counts;
            assert!(counts.marked >= counts.projected && counts.projected >= counts.in_frame);
            assert!(counts.in_frame >= counts.passing);
            assert!(counts.shared <= counts.covered.min(counts.target));
        }
    }
}

#[test]
fn people_can_read_why() {
    let world = two_balls();
    let clips = world.clips();
    let consensus = decide(&clips, &mixed(&world, &clips), &ConsensusSettings::robust());
    let text = consensus.explain();
    for part in [
        "consensus (robust): 5 of 8 views go on: enough others vote for them",
        "cam05  found",
        "a larger group contradicts it",
        "says that it is not there",
        "refused",
        "group A, 5 views: cam00 cam01 cam02 cam03 cam04",
        "vote 9/9",
        "\n48     ",
    ] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
}
