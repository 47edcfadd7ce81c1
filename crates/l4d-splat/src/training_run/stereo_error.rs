//! How far off depths of backgrounds are that comparing pictures finds, on rendered scenes.
//!
//! `L4D_SCENE` names the folder of a scene, `L4D_PROFILE` its profile.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use l4d_data::Name;

use super::*;
use crate::raster::Cpu;
use crate::train::{Preset, background_errors};

#[test]
#[ignore = "measures: needs a rendered scene"]
fn depths_of_backgrounds_against_the_truth() {
    let path = PathBuf::from(std::env::var_os("L4D_SCENE").unwrap());
    let name = Name::new(path.file_name().unwrap().to_str().unwrap()).unwrap();
    let profile: Profile = std::env::var("L4D_PROFILE").unwrap().parse().unwrap();
    let dir = SceneDir::new(path.parent().unwrap(), name.as_str());
    let source = PictureSource::open(&TrainingRequest {
        scene: &name,
        profile,
        dir: &dir,
        folder: PathBuf::new(),
        settings: Settings::of(Preset::default(), profile),
        sees_depth: true,
        points: None,
        sampling: Sampling { shrink: 1, every: 1 },
        between_checkpoints: Duration::from_secs(3600),
        overwrite: false,
        stop: &AtomicBool::new(false),
        rasterizer: &Cpu::default(),
        adapter: None,
    });
    let input = Input::read(&dir, &source.unwrap(), &|| ()).unwrap();
    let begin = Instant::now();
    let mut errors = background_errors(&input.views);
    let seconds = begin.elapsed().as_secs_f64();
    errors.sort_by(f32::total_cmp);
    let at = |share: f64| 100.0 * errors[(share * (errors.len() - 1) as f64) as usize];
    let right = 100.0 * errors.iter().filter(|error| **error < 0.01).count() as f64 / errors.len() as f64;
    println!(
        "{} pixels, median {:.2} %, 75th {:.2} %, 90th {:.2} % of the distance; right to 1 %: {right:.1} %; {seconds:.1} s",
        errors.len(),
        at(0.5),
        at(0.75),
        at(0.9)
    );
}
