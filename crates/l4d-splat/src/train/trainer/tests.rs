//! Training on made-up worlds, whole and in pieces.

use super::*;
use crate::raster::Cpu;
use crate::train::test_world::World;

const PASSING: World =
    World { card: |moment, moments| Some(-1.2 + 1.6 * moment as f64 / moments as f64), ..World::EMPTY };

fn settings() -> Settings {
    Settings {
        gaussians: 500,
        coarse: 40,
        unfold: 4,
        fine: 60,
        resolution: 8,
        width: 16,
        ..Settings::default()
    }
}

fn finish(trainer: &mut Trainer<'_>) {
    while trainer.stage() != Stage::Done {
        trainer.step().unwrap();
    }
}

#[test]
fn training_that_was_put_down_at_any_stage_ends_the_same() {
    let (views, cpu) = (PASSING.views(6), Cpu::new());
    let begin = || Trainer::new(&views, settings(), &InitialPoints::Surfaces, &cpu).unwrap();
    let mut whole = begin();
    let unfold_start = whole.schedule.fine_start();
    let fine_start = whole.schedule.whole_start();
    let stops = [7, unfold_start, unfold_start + 5, fine_start, fine_start + 31];
    let mut saved = Vec::new();
    while whole.stage() != Stage::Done {
        if stops.contains(&whole.iteration()) {
            saved.push(whole.checkpoint());
        }
        whole.step().unwrap();
    }
    assert_eq!(saved.len(), stops.len());
    for checkpoint in saved {
        let at = checkpoint.iteration;
        let mut again = begin();
        again.resume(checkpoint).unwrap();
        finish(&mut again);
        assert_eq!(again.checkpoint(), whole.checkpoint(), "from {at}");
    }
}

#[test]
fn what_moves_is_learned_where_it_is() {
    let (views, cpu) = (PASSING.views(6), Cpu::new());
    let longer = Settings { coarse: 150, unfold: 40, fine: 900, ..settings() };
    let mut trainer = Trainer::new(&views, longer, &InitialPoints::Surfaces, &cpu).unwrap();
    finish(&mut trainer);
    let picks: Vec<(usize, usize)> = (0..6).map(|moment| (1, moment)).collect();
    let quality = trainer.measure(&picks).unwrap();
    assert!(quality.psnr_db > 25.0 && quality.psnr_moving_db.unwrap() > 20.0, "{quality:?}");
    assert!(quality.depth_error_m.unwrap() < 0.05, "{quality:?}");
    let model = trainer.model();
    assert!(!model.dynamic.is_empty() && model.dynamic.len() < model.gaussians.len() / 2);
}

#[test]
fn a_scene_that_stands_still_needs_no_field() {
    let (views, cpu) = (World::EMPTY.views(3), Cpu::new());
    let mut trainer = Trainer::new(&views, settings(), &InitialPoints::Surfaces, &cpu).unwrap();
    finish(&mut trainer);
    assert_eq!((trainer.model().field.is_none(), trainer.model().dynamic.len()), (true, 0));
    let all = Settings { dynamic_threshold: 0.0, ..settings() };
    let mut trainer = Trainer::new(&views, all, &InitialPoints::Surfaces, &cpu).unwrap();
    finish(&mut trainer);
    // All but the backdrop.
    assert!(10 * trainer.model().dynamic.len() > 9 * trainer.model().gaussians.len());
}

#[test]
fn one_moment_and_absurd_settings() {
    let (views, cpu) = (PASSING.views(1), Cpu::new());
    let mut trainer = Trainer::new(&views, settings(), &InitialPoints::Surfaces, &cpu).unwrap();
    finish(&mut trainer);
    let refused = |change: fn(&mut Settings)| {
        let mut settings = settings();
        change(&mut settings);
        Trainer::new(&views, settings, &InitialPoints::Surfaces, &cpu).err().unwrap().to_string()
    };
    assert!(refused(|settings| settings.gaussians = 0).contains("`gaussians` is 0"));
    assert!(refused(|settings| settings.dynamic_threshold = f32::NAN).contains("`dynamic_threshold` is NaN"));
    assert!(refused(|settings| settings.views = 0).contains("`views`"));
    let empty = TrainingViews::new([4, 4], vec![0], l4d_data::Timeline::CANONICAL).unwrap();
    let error = Trainer::new(&empty, settings(), &InitialPoints::Surfaces, &cpu).err().unwrap();
    assert!(error.to_string().contains("no cameras"), "{error}");
}

#[test]
fn a_checkpoint_without_its_state_is_refused_by_name() {
    let (views, cpu) = (PASSING.views(3), Cpu::new());
    let mut trainer = Trainer::new(&views, settings(), &InitialPoints::Surfaces, &cpu).unwrap();
    let mut checkpoint = trainer.checkpoint();
    checkpoint.training.tensors.remove("splats/means/0/second");
    assert!(trainer.resume(checkpoint).unwrap_err().to_string().contains("`splats/means/0/second`"));
}
