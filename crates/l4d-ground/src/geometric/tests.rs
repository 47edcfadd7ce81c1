//! The geometric grounder on a small made-up world: blocks on a floor, drawn by casting rays at boxes.

mod reading;

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DVec2, DVec3};
use half::f16;
use l4d_data::{Camera, Interval, Name, Split, Timeline};
use l4d_frames::drawn::{DepthMap, RgbImage};
use l4d_masks::Mask;

use super::*;
use crate::testing::{asked_from, sentence};
use crate::{ClipFrame, Reason};

const WIDTH: u32 = 160;
const HEIGHT: u32 = 120;
const RED: [u8; 3] = [190, 40, 36];
const GREEN: [u8; 3] = [62, 140, 66];
const BLUE: [u8; 3] = [48, 88, 172];
const FLOOR: [u8; 3] = [150, 140, 130];

/// A box on the floor, or above it.
struct Block {
    colour: [u8; 3],
    size: DVec3,
    /// Middle of its bottom at a share of the clip, metres.
    place: fn(f64) -> DVec3,
}

/// Red is left, tall blue right; green is in front, then slides to the right in the second half.
fn blocks() -> [Block; 3] {
    let small = DVec3::splat(0.06);
    [
        Block { colour: RED, size: small, place: |_| DVec3::new(-0.15, 0.05, 0.0) },
        Block { colour: BLUE, size: DVec3::new(0.06, 0.06, 0.11), place: |_| DVec3::new(0.13, 0.06, 0.0) },
        Block {
            colour: GREEN,
            size: small,
            place: |share| DVec3::new(-0.05 + 0.3 * (share - 0.5).max(0.0), -0.12, 0.0),
        },
    ]
}

fn camera() -> Camera {
    let (eye, target) = (DVec3::new(0.0, -0.8, 0.55), DVec3::ZERO);
    let forward = (target - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let down = forward.cross(right);
    let pose = DMat4::from_cols(right.extend(0.0), down.extend(0.0), forward.extend(0.0), eye.extend(1.0));
    Camera {
        name: Name::new("cam00").unwrap(),
        split: Split::Train,
        fx: 170.0,
        fy: 170.0,
        cx: f64::from(WIDTH) / 2.0,
        cy: f64::from(HEIGHT) / 2.0,
        world_from_camera: vec![pose.transpose().to_cols_array()],
    }
}

/// Distance along a ray to a box, if it meets it (the slab method).
fn hit(eye: DVec3, ray: DVec3, low: DVec3, high: DVec3) -> Option<f64> {
    let (a, b) = ((low - eye) / ray, (high - eye) / ray);
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    (near > 0.0 && near <= far).then_some(near)
}

/// The clip, and the masks of the blocks.
fn clip() -> (ViewClip, Vec<Vec<Mask>>) {
    let camera = camera();
    let blocks = blocks();
    let mut frames = Vec::new();
    let mut truth = vec![Vec::new(); blocks.len()];
    for number in (0..97).step_by(8) {
        let share = f64::from(number) / 96.0;
        let eye = camera.unproject(number, DVec2::ZERO, 0.0);
        let mut colour = RgbImage::new(WIDTH, HEIGHT);
        let mut depth = DepthMap::empty(WIDTH, HEIGHT);
        let mut masks = vec![Mask::empty(WIDTH, HEIGHT); blocks.len()];
        for row in 0..HEIGHT {
            for column in 0..WIDTH {
                let at = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                // Length 1 along the ray is depth 1: the ray reaches planar depth 1 at its end.
                let ray = camera.unproject(number, at, 1.0) - eye;
                let mut nearest = (-eye.z / ray.z, FLOOR, None);
                for (index, block) in blocks.iter().enumerate() {
                    let bottom = (block.place)(share);
                    let half = DVec3::new(block.size.x / 2.0, block.size.y / 2.0, 0.0);
                    let high = bottom + half + DVec3::Z * block.size.z;
                    match hit(eye, ray, bottom - half, high) {
                        Some(found) if found < nearest.0 => nearest = (found, block.colour, Some(index)),
                        _ => {}
                    }
                }
                if nearest.0 <= 0.0 {
                    continue;
                }
                colour.put_pixel(column, row, nearest.1.into());
                depth.depth_m[(row * WIDTH + column) as usize] = nearest.0 as f32;
                depth.alpha[(row * WIDTH + column) as usize] = f16::ONE;
                if let Some(index) = nearest.2 {
                    masks[index].set(column, row, true);
                }
            }
        }
        frames.push(ClipFrame { frame: number, colour, depth });
        truth.iter_mut().zip(masks).for_each(|(truth, mask)| truth.push(mask));
    }
    (ViewClip { camera, width: WIDTH, height: HEIGHT, timeline: Timeline::CANONICAL, frames }, truth)
}

/// Intersection over union of all frames.
fn tube(clip: &ViewClip, masks: &BTreeMap<u32, Mask>, truth: &[Mask]) -> f64 {
    let pairs = || clip.frame_numbers().zip(truth).map(|(frame, truth)| (&masks[&frame], truth));
    let shared: u64 = pairs().map(|(mask, truth)| mask.and_count(truth)).sum();
    let all: u64 = pairs().map(|(mask, truth)| mask.or_count(truth)).sum();
    shared as f64 / all as f64
}

#[test]
fn sentences_find_their_blocks() {
    let (clip, truth) = clip();
    let grounder = Geometric::default();
    let (red, blue, green) = (0, 1, 2);
    let cases = [
        ("The red block", red),
        ("The blue block", blue),
        ("The block that slides", green),
        ("The green block that never jumps", green),
        ("The tallest of the blocks", blue),
        ("The block that ends up farthest from the red block", green),
        ("The block that starts out closest to the green block", red),
    ];
    for (text, meant) in cases {
        let grounding = grounder.ground(&clip, &sentence(text));
        assert_eq!(grounding.outcome, Outcome::Found, "{text}: {:?}", grounding.notes);
        assert_eq!(grounding.masks.len(), clip.frames.len());
        let ious = [red, blue, green].map(|index| tube(&clip, &grounding.masks, &truth[index]));
        assert!(ious[meant] > 0.7, "{text}: {ious:?} {:#?}", grounding.notes);
    }
}

#[test]
fn a_while_opens_only_while_it_holds() {
    let (clip, truth) = clip();
    let grounding = Geometric::default().ground(&clip, &sentence("The block while it slides"));
    let frames = || clip.frames.iter().map(|seen| seen.frame).enumerate();
    for (index, frame) in frames().filter(|(_, frame)| !(40..56).contains(frame)) {
        let is_open = grounding.masks[&frame].intersects(&truth[2][index]);
        assert_eq!(is_open, frame >= 56, "frame {frame}: {:#?}", grounding.notes);
    }
}

#[test]
fn a_timeline_of_its_own_changes_nothing_but_the_numbers() {
    let (clip, _) = clip();
    let mut recorded = clip.clone();
    // Twice as many frames a second, from 100 on.
    recorded.timeline = Timeline::new(Interval::new(100, 292).unwrap(), Some(48.0));
    recorded.frames.iter_mut().for_each(|seen| seen.frame = 100 + 2 * seen.frame);
    let grounder = Geometric::default();
    for text in [
        "The block that slides",
        "The block while it slides",
        "The block that ends up farthest from the red block",
        "The block that starts out closest to the green block",
    ] {
        let [expected, found] = [&clip, &recorded].map(|clip| grounder.ground(clip, &sentence(text)));
        assert_eq!(found.outcome, expected.outcome, "{text}");
        let renumbered = expected.masks.into_iter().map(|(frame, mask)| (100 + 2 * frame, mask)).collect();
        assert_eq!(found.masks, renumbered, "{text}");
    }
}

#[test]
fn frames_that_were_not_asked_about_stay_empty() {
    let (clip, _) = clip();
    let asked = asked_from(sentence("The red block"), 16, 40);
    let grounding = Geometric::default().ground(&clip, &asked);
    let full: Vec<u32> =
        grounding.masks.iter().filter(|(_, mask)| !mask.is_empty()).map(|(frame, _)| *frame).collect();
    assert_eq!(full, [16, 24, 32, 40]);
}

#[test]
fn what_is_not_understood_is_no_answer() {
    let (clip, _) = clip();
    let grounder = Geometric::default();
    let outcome = |text: &str| grounder.ground(&clip, &sentence(text)).outcome;
    let unread = |text: &str| {
        let unread = grounder.reads(text).unwrap_err();
        assert_eq!(outcome(text), Outcome::Unsupported(unread.clone()), "{text}");
        (unread.reason.clone(), unread.words.join(" "))
    };
    assert_eq!(unread("The zorple block"), (Reason::Unknown, "zorple".to_owned()));
    for (text, words) in [
        ("The person with the ponytail", "ponytail"),
        ("The cup without a lid", "lid"),
        ("The pot with a wooden knob on its lid", "wooden knob"),
        ("The long-haired, shiny cat", "long-haired shiny"),
        ("The closed box", "closed"),
    ] {
        assert_eq!(unread(text), (Reason::Unmeasured, words.to_owned()), "{text}");
    }
    assert_eq!(grounder.reads("The red person with the ponytail"), Ok(()), "the colour can decide");
    for strange in ["", "\u{1f431}\u{1f431}", "\u{0414}\u{043e}\u{043c}", &"block ".repeat(10_000)] {
        assert!(matches!(outcome(strange), Outcome::Unsupported(_)), "{strange:.20}");
    }
    assert!(!grounder.uses_truth());
}

#[test]
fn nothing_in_sight_is_absent() {
    let (mut clip, _) = clip();
    for seen in &mut clip.frames {
        seen.depth = DepthMap::empty(WIDTH, HEIGHT);
    }
    let grounding = Geometric::default().ground(&clip, &sentence("The red block"));
    assert_eq!(grounding.outcome, Outcome::Absent);
    // An aeroplane-sized thing among blocks.
    let (clip, _) = self::clip();
    let grounding = Geometric::default().ground(&clip, &sentence("The red bus"));
    assert_eq!(grounding.outcome, Outcome::Absent, "{:?}", grounding.notes);
}

#[test]
fn damaged_clips_do_no_harm() {
    let sound = clip().0;
    let edited = |edit: &dyn Fn(&mut ViewClip)| {
        let mut clip = sound.clone();
        edit(&mut clip);
        clip
    };
    let odd = [
        edited(&|clip| clip.frames.clear()),
        edited(&|clip| clip.frames.truncate(1)),
        edited(&|clip| {
            for (index, depth_m) in clip.frames[3].depth.depth_m.iter_mut().enumerate() {
                *depth_m = [f32::NAN, f32::NEG_INFINITY, -1.0, 0.0, f32::MAX, 1e-30][index % 6];
            }
        }),
        edited(&|clip| {
            clip.frames[0].depth.depth_m.truncate(100);
            clip.frames[1].colour = RgbImage::new(3, 3);
        }),
        edited(&|clip| {
            for seen in &mut clip.frames {
                seen.depth.depth_m.fill(1.0);
                seen.depth.alpha.fill(f16::ONE);
            }
        }),
        edited(&|clip| clip.frames[12].frame = 4000),
    ];
    for clip in odd {
        for text in [
            "The red block",
            "The first block to slide",
            "The block between the cup and the box",
            "The block while a hand holds it",
        ] {
            let grounding = Geometric::default().ground(&clip, &sentence(text));
            assert!(grounding.outcome.is_answer(), "{text}");
        }
    }
}

#[test]
fn the_same_clip_gives_the_same_answer() {
    let (clip, _) = clip();
    let answer = || Geometric::default().ground(&clip, &sentence("The block nearest to the red block"));
    assert_eq!(answer(), answer());
    // Remembered or seen anew.
    let grounder = Geometric::default();
    let first = grounder.ground(&clip, &sentence("The blue block"));
    assert_eq!(grounder.ground(&clip, &sentence("The blue block")), first);
    assert_eq!(grounder.identity(), Geometric::default().identity());
}

/// Types give it nothing but a clip and a sentence; this keeps files out as well.
#[test]
fn no_code_of_it_reads_a_file() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut waiting = vec![root.join("geometric"), root.join("geometric.rs")];
    let mut read = 0;
    while let Some(path) = waiting.pop() {
        if path.is_dir() && !path.ends_with("tests") {
            waiting.extend(std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|kind| kind == "rs") && !path.ends_with("tests.rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            // Unit tests are no part of the grounder.
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
            let gates = ["std::fs", "std::env", "std::process", "std::net", "File::", "::read(", "layout::"];
            let found: Vec<&str> = gates.into_iter().filter(|gate| code.contains(gate)).collect();
            assert!(found.is_empty(), "{} has {found:?}", path.display());
            read += 1;
        }
    }
    assert!(read > 10);
}
