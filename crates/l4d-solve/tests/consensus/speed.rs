//! The work is that of what is marked, not that of the pictures.

use std::time::Instant;

use glam::DVec3;
use l4d_frames::Mask;
use l4d_ground::Grounding;
use l4d_solve::consensus::reproject::reproject;
use l4d_solve::consensus::{ConsensusSettings, Sight};

use crate::decide;
use crate::world::{Shape, Thing, World, arc};

fn ball_on_a_floor(cameras: usize, size: [u32; 2], focal_px: f64, frames: Vec<u32>) -> World {
    World {
        things: vec![
            Thing {
                id: 1001,
                shape: Shape::Box(DVec3::new(20.0, 20.0, 0.1)),
                centre: |_| DVec3::new(0.0, 0.0, -0.4),
            },
            Thing {
                id: 1,
                shape: Shape::Sphere(0.3),
                centre: |frame| DVec3::new(f64::from(frame) / 96.0 - 0.5, 0.0, 0.0),
            },
        ],
        cameras: arc(cameras, 120.0, size, focal_px),
        frames,
    }
}

#[test]
fn pixels_visited_are_a_few_for_each_that_is_marked() {
    let world = ball_on_a_floor(4, [256, 192], 260.0, vec![0, 48]);
    let clips = world.clips();
    let settings = ConsensusSettings::robust().reprojection;
    for frame in [0, 48] {
        let sights: Vec<Sight> =
            clips.iter().map(|clip| Sight::of_clip(clip, frame, &settings).unwrap()).collect();
        for from in 0..4 {
            let mask = world.mask(from, frame, 1);
            for to in (0..4).filter(|&to| to != from) {
                let there = reproject(&sights[from], &mask, &sights[to], &settings);
                assert!(mask.area() > 500);
                assert!(there.visited < 5 * mask.area(), "{} for {}", there.visited, mask.area());
            }
        }
    }
}

/// What all threads of this process have used, on Linux; 0 elsewhere. Says more than the clock on a busy machine.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name of the program, in brackets, may hold spaces. User and system time, in hundredths.
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    fields.iter().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// `cargo test --release -p l4d-solve --test consensus -- --ignored timing --nocapture`
#[test]
#[ignore = "a measurement"]
fn timing() {
    let world = ball_on_a_floor(8, [256, 192], 260.0, (0..97).step_by(2).collect());
    let clips = world.clips();
    let small: Vec<Grounding> = (0..8).map(|view| world.marking(&clips, view, 1)).collect();
    let full: Vec<Grounding> = clips
        .iter()
        .map(|clip| {
            let masks = clip.frame_numbers().map(|frame| (frame, Mask::full(256, 192)));
            Grounding::of_masks(clip, masks.collect(), Vec::new())
        })
        .collect();
    let pixels: u64 = small.iter().flat_map(|view| view.masks.values()).map(Mask::area).sum();
    println!("8 views x 49 frames at 256x192, {} pixels a mask", pixels / (8 * 49));
    for (name, groundings) in [("small", &small), ("full", &full)] {
        for settings in [ConsensusSettings::paper(), ConsensusSettings::robust()] {
            let (start, before) = (Instant::now(), processor_seconds());
            let consensus = decide(&clips, groundings, &settings);
            let (wall, processor) = (start.elapsed().as_secs_f64(), processor_seconds() - before);
            let what = format!("{name} masks, {:?}", settings.preset());
            println!("{what}: {processor:.2} s of a processor, {wall:.2} s; {:?}", consensus.decision);
        }
    }
}
