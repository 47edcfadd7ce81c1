//! Values at the ends of what f32 holds: refused by name, or drawn without a number that isn't one.

use l4d_splat::raster::{Cpu, DrawingGradient, RasterError, RasterSettings, Rasterizer, Reference};
use l4d_splat::splats::{SplatParts, Splats};
use l4d_splat::view::View;
use l4d_splat::{Gaussians, ShDegree};
use proptest::prelude::*;

/// Any finite f32, half of them of a size that a scene might have.
fn number() -> impl Strategy<Value = f32> {
    use proptest::num::f32;
    prop_oneof![f32::NORMAL | f32::SUBNORMAL | f32::ZERO, -10.0_f32..10.0]
}

/// Mean, scale, rotation, opacity, colour.
type Row = ([f32; 3], [f32; 3], [f32; 4], f32, [f32; 3]);

fn gaussian() -> impl Strategy<Value = Row> {
    let triple = || [number(), number(), number()];
    (triple(), triple(), [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0, 0.1_f32..1.0], 0.0_f32..=1.0, triple())
}

fn splats(list: Vec<Row>) -> Splats {
    let mut parts = SplatParts { sh_degree: ShDegree::ZERO, ..SplatParts::default() };
    for (mean, scale, rotation, opacity, sh) in list {
        let length = rotation.iter().map(|value| value * value).sum::<f32>().sqrt();
        parts.means.push(mean);
        parts.scales.push(scale.map(f32::abs));
        parts.rotations.push(rotation.map(|value| value / length));
        parts.opacities.push(opacity);
        parts.sh.push(sh);
    }
    Splats::new(parts).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn whatever_is_finite_is_drawn_or_named(list in prop::collection::vec(gaussian(), 1..12)) {
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 3.0]];
        let view = View::new([37, 21], [30.0, 30.0], [18.0, 10.0], pose).unwrap();
        let splats = splats(list);
        let cpu = Cpu::new();
        let projected = match cpu.prepare(&splats, &view, &RasterSettings::default()) {
            Ok(projected) => projected,
            Err(RasterError::Overflow(bad)) => {
                prop_assert!(bad.index < splats.len());
                return Ok(());
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        let drawing = projected.draw().unwrap();
        prop_assert!(drawing.colour.as_flattened().iter().all(|value| value.is_finite()));
        prop_assert!(drawing.depth_sum_m.iter().all(|value| value.is_finite()));
        prop_assert!(drawing.alpha.iter().all(|alpha| (0.0..=1.0).contains(alpha)));
        let mut gradient = DrawingGradient::zeros(&view);
        gradient.colour.fill([1.0, -0.5, 0.25]);
        gradient.depth_sum_m.fill(0.1);
        let gradients = projected.backward(&drawing, &gradient).unwrap();
        // Some of these derivatives are larger than f32 can hold, but none of them is nonsense.
        for list in gradients.by.lists() {
            prop_assert!(!list.iter().any(|value| value.is_nan()), "{:?}", splats);
        }
    }
}

#[test]
fn what_is_not_a_number_is_refused_with_its_index_and_field_wherever_it_stands() {
    let fine = Gaussians {
        sh_degree: ShDegree::new(1).unwrap(),
        means: vec![[0.0, 0.0, 2.0]; 5],
        log_scales: vec![[-2.0; 3]; 5],
        rotations: vec![[1.0, 0.0, 0.0, 0.0]; 5],
        opacity_logits: vec![0.0; 5],
        sh: vec![[0.1; 3]; 20],
    };
    type Put = fn(&mut Gaussians, usize, f32);
    let fields: [(&str, Put); 5] = [
        ("means", |g, index, value| g.means[index][1] = value),
        ("log_scales", |g, index, value| g.log_scales[index][2] = value),
        ("rotations", |g, index, value| g.rotations[index][3] = value),
        ("opacity_logits", |g, index, value| g.opacity_logits[index] = value),
        ("sh", |g, index, value| g.sh[4 * index + 3][0] = value),
    ];
    assert!(fine.activate().is_ok());
    for (field, put) in fields {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for index in [0, 4] {
                let mut poisoned = fine.clone();
                put(&mut poisoned, index, value);
                let error = poisoned.activate().unwrap_err().to_string();
                assert!(
                    error.starts_with(&format!("Gaussian {index}, field `{field}` is {value}")),
                    "{error}"
                );
            }
        }
    }
}

#[test]
fn absurdly_many_channels_of_nothing_are_refused() {
    let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let view = View::new([8, 8], [8.0, 8.0], [4.0, 4.0], pose).unwrap();
    let (nothing, settings) = (splats(Vec::new()), RasterSettings::default());
    let rasterizers: [Box<dyn Rasterizer>; 2] = [Box::new(Cpu::new()), Box::new(Reference)];
    for rasterizer in rasterizers {
        let projected = rasterizer.prepare(&nothing, &view, &settings).unwrap();
        assert_eq!(projected.splat_features(&[], 3).unwrap(), [0.0; 3 * 64]);
        assert!(projected.splat_features(&[], usize::MAX).unwrap_err().to_string().starts_with("channels"));
    }
}

#[test]
fn a_picture_that_nobody_could_draw_is_refused_before_it_is_begun() {
    let list = vec![([0.0, 0.0, 2.0], [1e4; 3], [1.0, 0.0, 0.0, 0.0], 0.5, [0.0; 3]); 4000];
    let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let view = View::new([8192, 8192], [8e3, 8e3], [4096.0, 4096.0], pose).unwrap();
    let splats = splats(list);
    let cpu = Cpu::new();
    let error = cpu.prepare(&splats, &view, &RasterSettings::default()).err().unwrap().to_string();
    assert!(error.contains("1048576000 tiles"), "{error}");
}
