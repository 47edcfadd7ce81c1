//! Pictures of which a caller looks at some pixels alone.

use l4d_splat::conformance::{Case, cases};
use l4d_splat::raster::{Cpu, DrawingGradient, Projected, Rasterizer, Reference};
use l4d_splat::splats::SplatGradients;

fn case(name: &str) -> Case {
    cases().into_iter().find(|case| case.name == name).unwrap()
}

/// A disc and a single pixel in a corner.
fn marks(case: &Case) -> Vec<bool> {
    let (width, height) = (case.view.width() as f64, case.view.height() as f64);
    let inside = |pixel: usize| {
        let (x, y) = ((pixel as f64 % width).floor() / width, (pixel as f64 / width).floor() / height);
        pixel == 0 || (x - 0.6).powi(2) + (y - 0.4).powi(2) < 0.04
    };
    (0..case.view.pixel_count()).map(inside).collect()
}

fn gradients(scene: &dyn Projected, case: &Case, marks: &[bool]) -> SplatGradients {
    scene.backward(&scene.draw().unwrap(), &slopes(case, marks)).unwrap()
}

fn slopes(case: &Case, marks: &[bool]) -> DrawingGradient {
    let mut gradient = DrawingGradient::zeros(&case.view);
    for (pixel, _) in marks.iter().enumerate().filter(|(_, marked)| **marked) {
        let slope = (pixel as f32).sin();
        gradient.colour[pixel] = [slope, 0.5, -slope];
        gradient.depth_sum_m[pixel] = 0.3 * slope;
        gradient.alpha[pixel] = -0.2;
    }
    gradient
}

#[test]
fn marked_pixels_and_what_they_say_are_the_same() {
    for name in ["room", "cloud", "needles"] {
        let case = case(name);
        let marks = marks(&case);
        let cpu = Cpu::new();
        let whole = cpu.prepare(&case.splats, &case.view, &case.settings).unwrap();
        let part = cpu.prepare_marked(&case.splats, &case.view, &case.settings, &marks).unwrap();
        let (all, some) = (whole.draw().unwrap(), part.draw().unwrap());
        let mut left_out = 0;
        for (pixel, &marked) in marks.iter().enumerate() {
            if marked {
                assert_eq!(some.colour[pixel], all.colour[pixel], "{name} {pixel}");
                assert_eq!(some.depth_sum_m[pixel], all.depth_sum_m[pixel], "{name} {pixel}");
                assert_eq!(some.transmittance[pixel], all.transmittance[pixel], "{name} {pixel}");
            } else {
                assert_eq!((some.colour[pixel], some.alpha[pixel]), (case.settings.background, 0.0));
                left_out += usize::from(all.alpha[pixel] > 0.0);
            }
        }
        assert!(left_out > 100, "{name} {left_out}");
        let (all, some) = (gradients(&*whole, &case, &marks), gradients(&*part, &case, &marks));
        assert!(some.by == all.by && some.means_ndc == all.means_ndc, "{name}");
        // What touches no tile with a mark is not visible; nothing else becomes it.
        let visible = |gradients: &SplatGradients| gradients.visible.iter().filter(|seen| **seen).count();
        assert!(visible(&some) <= visible(&all));
        assert!(some.visible.iter().zip(&all.visible).all(|(some, all)| all | !some));
    }
}

#[test]
fn gaussians_that_do_not_learn_have_no_gradient_and_the_others_keep_theirs() {
    let case = case("room");
    let all = vec![true; case.view.pixel_count()];
    let trainable: Vec<bool> = (0..case.splats.len()).map(|index| index % 3 != 1).collect();
    for rasterizer in [&Cpu::new() as &dyn Rasterizer, &Reference] {
        let scene = rasterizer.prepare(&case.splats, &case.view, &case.settings).unwrap();
        let gradient = slopes(&case, &all);
        let drawing = scene.draw().unwrap();
        let (every, some) = (
            scene.backward(&drawing, &gradient).unwrap(),
            scene.backward_for(&drawing, &gradient, &trainable).unwrap(),
        );
        for (some, every) in std::iter::zip(some.by.lists(), every.by.lists()) {
            let width = some.len() / trainable.len();
            for (index, &is_trainable) in trainable.iter().enumerate() {
                let (some, every) = (&some[index * width..][..width], &every[index * width..][..width]);
                let is_right =
                    if is_trainable { some == every } else { some.iter().all(|value| *value == 0.0) };
                assert!(is_right, "Gaussian {index}: {some:?} and {every:?}");
            }
        }
        assert_eq!(some.visible, every.visible);
        assert!(scene.backward_for(&drawing, &gradient, &[true; 3]).is_err());
    }
}

#[test]
fn nothing_marked_is_nothing_drawn() {
    let case = case("room");
    let cpu = Cpu::new();
    let marks = vec![false; case.view.pixel_count()];
    let part = cpu.prepare_marked(&case.splats, &case.view, &case.settings, &marks).unwrap();
    assert!(part.draw().unwrap().alpha.iter().all(|&alpha| alpha == 0.0));
}

#[test]
fn marks_that_do_not_fit_are_refused() {
    let case = case("room");
    for rasterizer in [&Cpu::new() as &dyn Rasterizer, &Reference] {
        let refused = rasterizer.prepare_marked(&case.splats, &case.view, &case.settings, &[true; 7]);
        assert!(refused.err().unwrap().to_string().contains("7 numbers"));
    }
}
