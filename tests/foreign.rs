//! Models of other programs that were trained on our exports: drawn as their originals draw them, at the right times.

use std::path::PathBuf;

use glam::DVec3;
use l4d_formats::npy;

use crate::interop::wall;
use crate::support::{Dir, copy, manifest, query, root};

const RENDER: &str = "render-splats wall --profile tiny --views cam01 --frames 0,48,96";
const FRAMES: [&str; 3] = ["0000", "0048", "0096"];

/// A folder with the scene `wall` in profile tiny, its exports below `data/`, and below `output/` a model for each as
/// 4DGaussians leaves it that was started there: two dozen moving Gaussians about the origin.
pub(crate) fn folder() -> Dir {
    let dir = wall(|number| DVec3::new(number - 1.0, 0.25, -6.0));
    for (reader, format) in [("panoptic", "4dgaussians"), ("dynerf", "4dgaussians-dynerf")] {
        dir.succeed(format!("export wall --profile tiny --format {format} --out data/{reader}"));
        model(&dir, reader);
    }
    dir
}

fn model(dir: &Dir, reader: &str) {
    let output = format!("output/{reader}");
    copy(&root().join("crates/l4d-splat/tests/fixtures/checkpoint/trainers/moving"), &dir.path(&output));
    dir.edit(&format!("{output}/cfg_args"), r#""/data/it's here""#, &format!("'data/{reader}'"));
}

fn data() -> PathBuf {
    root().join("tests/data/foreign")
}

/// How far two pictures are apart, channel by channel.
fn differences(ours: PathBuf, theirs: PathBuf) -> Vec<u8> {
    let [ours, theirs] = [ours, theirs].map(|path| image::open(path).unwrap().to_rgb8().into_raw());
    assert_eq!(ours.len(), theirs.len());
    ours.iter().zip(theirs).map(|(ours, theirs)| ours.abs_diff(theirs)).collect()
}

/// Largest and mean difference of the pictures in a folder of clips from those that the original's equations give.
fn difference(dir: &Dir, reader: &str, clips: &str) -> (u8, f64) {
    let of_frame = |frame| {
        let ours = dir.path(format!("{clips}/cam01/{frame}.png"));
        differences(ours, data().join(format!("{reader}_{frame}.png")))
    };
    let differences: Vec<u8> = FRAMES.into_iter().flat_map(of_frame).collect();
    let mean = differences.iter().map(|one| f64::from(*one)).sum::<f64>() / differences.len() as f64;
    (differences.into_iter().max().unwrap(), mean / 255.0)
}

#[test]
fn models_trained_on_exports_are_drawn_as_their_originals_draw_them() {
    let dir = folder();
    for reader in ["panoptic", "dynerf"] {
        let run = dir.succeed(format!("{RENDER} --splats output/{reader} --out {reader}"));
        let (largest, mean) = difference(&dir, reader, reader);
        assert!(largest <= 1 && mean <= 1e-3, "{reader}: {largest} of 255, mean {mean}\n{run}");
        assert!(run.stderr.contains(&format!("data/{reader}/l4d-export.json")), "{run}");
        let warns =
            run.stderr.contains("cfg_args says another background than the reader panoptic draws over");
        assert_eq!(warns, reader == "panoptic", "{run}");
        let manifest = dir.value(&format!("{reader}/manifest.json"));
        assert_eq!(manifest["drawn"]["model"]["scene"], "wall");
    }
}

/// `gsplat.png` is of gsplat's own reference (`draw_gsplat.py`), from where nerfstudio's reader sees the export.
#[test]
fn splats_of_nerfstudio_are_drawn_as_gsplat_draws_them() {
    let dir = folder();
    let splats = "output/panoptic/point_cloud/iteration_14000/point_cloud.ply";
    dir.succeed(format!(
        "render-splats wall --profile tiny --views cam01 --frames 0 --splats {splats} --out splats"
    ));
    let differences = differences(dir.path("splats/cam01/0000.png"), data().join("gsplat.png"));
    let mean = differences.iter().map(|one| f64::from(*one)).sum::<f64>() / differences.len() as f64 / 255.0;
    // 3DGS ends a splat at the edge of a tile three deviations away, gsplat goes on to where it is too faint to draw.
    let beyond = differences.iter().filter(|one| **one > 1).count();
    assert!(differences.iter().all(|one| *one <= 2) && beyond <= 20 && mean < 1e-5, "{beyond}, mean {mean}");
}

#[test]
fn what_a_model_does_not_say_is_asked_for() {
    let dir = folder();
    dir.rename("data/panoptic", "elsewhere");
    let stray = format!("{RENDER} --splats output/panoptic");
    dir.refuses(format!("{stray} --out asked"), &["nothing says at which times", "--reader panoptic"]);
    assert!(!dir.path("asked").exists());
    dir.refuses("query wall 'the red ball' --profile tiny --splats output/panoptic", &["--reader panoptic"]);
    dir.write("benchmark/panoptic-l4d.toml", manifest("Wall", &["wall"]));
    let asked = query("wall/001", "the red ball", "attribute", &["ball"], "whole", [0, 96]);
    dir.write("benchmark/queries/wall.jsonl", format!("{asked}\n"));
    copy(&dir.path("output/panoptic"), &dir.path("work/tiny/wall/splats"));
    let solve = "solve --profile tiny --grounder panoptic";
    dir.refuses(solve, &["nothing says at which times", "--reader panoptic"]);
    // By a flag, by a copy of the card, and by hand.
    dir.succeed(format!("{stray} --reader panoptic --out flag"));
    assert!(difference(&dir, "panoptic", "flag").0 <= 1);
    std::fs::copy(dir.path("elsewhere/l4d-export.json"), dir.path("output/panoptic/l4d-export.json"))
        .unwrap();
    dir.succeed(format!("{stray} --out card"));
    assert!(difference(&dir, "panoptic", "card").0 <= 1);
    dir.remove("output/panoptic/l4d-export.json");
    let by_hand = "--times 0,0.44444445,0.8888889 --sh-degree 0 --background black";
    dir.succeed(format!(
        "render-splats wall --profile tiny --views cam01 --splats output/panoptic {by_hand} --out hand"
    ));
    for (time, frame) in ["t0.000000", "t0.444444", "t0.888889"].into_iter().zip(FRAMES) {
        assert_eq!(
            dir.bytes(&format!("hand/cam01/{time}.png")),
            dir.bytes(&format!("flag/cam01/{frame}.png"))
        );
    }
}

#[test]
fn latents_of_4d_langsplat_are_blended_like_colours() {
    let dir = folder();
    copy(
        &root().join("crates/l4d-splat/tests/fixtures/checkpoint/trainers/language"),
        &dir.path("output/language"),
    );
    let render = format!("{RENDER} --reader dynerf --language");
    dir.succeed(format!("{render} --splats output/language --out language"));
    let latents = npy::decode::<f32>(&dir.bytes("language/language/cam01/00002.npy")).unwrap();
    let latents = latents.into_numbers().unwrap();
    assert_eq!(latents.shape, [96, 128, 2]);
    assert!(latents.data.as_chunks::<2>().0.iter().any(|[x, y]| x.hypot(*y) > 0.5));
    // No latent is longer than what is filled of its pixel.
    let longest = latents.data.as_chunks::<2>().0.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f32::max);
    assert!(longest <= 1.0 + 1e-5, "{longest}");
    let without = format!("{render} --splats output/dynerf --out none");
    dir.refuses(without, &["the model has no language features", "fine-lang-discrete"]);
    assert!(!dir.path("none").exists());
}

#[test]
fn moments_that_a_model_did_not_see_are_not_made_up() {
    let dir = folder();
    dir.remove("data/panoptic");
    dir.succeed("export wall --profile tiny --format 4dgaussians --frames 24,36,48 --out data/panoptic");
    let render =
        |more: &str| dir.run(format!("render-splats wall --profile tiny --splats output/panoptic {more}"));
    render("--frames 24,40,48 --out seen").says(0, &[]);
    render("--frames 60 --out beyond").says(2, &["saw the clip from 0.25 to 0.5 alone"]);
    render("--out whole").says(2, &["saw the clip from 0.25 to 0.5 alone"]);
}
