//! Random fields against the slow reference: offsets, and gradients against central differences of the reference.

use std::collections::BTreeSet;

use l4d_splat::deform::{Bounds, DeformConfig, DeformationField, Init, Offsets, TimeAxis, Trace};
use proptest::prelude::*;

use crate::fixtures::{largest_difference, positions, relative_difference, small_config, small_field};
use crate::reference::{self, Doubles, doubles};

fn configs() -> impl Strategy<Value = DeformConfig> {
    let sizes =
        (1..6_usize, prop::array::uniform3(1..5_usize), 1..6_usize, prop::collection::vec(1..4_u32, 1..3));
    let rest = (1..9_usize, any::<[bool; 5]>(), prop::sample::select(vec![1, 4]), any::<bool>());
    (sizes, rest).prop_map(
        |(
            (channels, spatial_resolution, time_resolution, multires),
            (width, off, sh_coefficients, whole),
        )| {
            let [no_dx, no_ds, no_dr, no_do, no_dshs] = off;
            DeformConfig {
                channels,
                spatial_resolution,
                time_resolution,
                multires,
                width,
                no_dx,
                no_ds,
                no_dr,
                no_do,
                no_dshs,
                sh_coefficients,
                time_axis: if whole { TimeAxis::Whole } else { TimeAxis::Half },
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn offsets_are_those_of_the_reference(
        config in configs(),
        seed in any::<u64>(),
        rows in 0..4_usize,
        place in any::<u32>(),
        time in 0.0..=1.0_f32,
    ) {
        let corners = [[2.0, 0.5, 1.5], [-1.0, -0.75, -1.25]];
        let field =
            DeformationField::new(config.clone(), Bounds::new(corners).unwrap(), Init::Foreign, seed).unwrap();
        let positions = positions(rows, place);
        let offsets = field.offsets(&positions, time).unwrap();
        let tensors = doubles(&field.tensors());
        let mut expected: [Vec<f64>; 5] = Default::default();
        for position in positions {
            let row = reference::offsets(&config, &tensors, position.map(f64::from), time.into());
            for (all, row) in expected.iter_mut().zip(row) {
                all.extend(row);
            }
        }
        for (found, expected) in offsets.flat().into_iter().zip(&expected) {
            prop_assert!(largest_difference(found, expected) < 1.0e-5, "{found:?} instead of {expected:?}");
        }
    }
}

/// What the gradients are checked on: more rows than a block has, so that sums over blocks are part of it.
struct Problem {
    field: DeformationField,
    positions: Vec<[f32; 3]>,
    time: f32,
    upstream: Offsets,
}

impl Problem {
    fn small() -> Self {
        let field = small_field(small_config(), 11);
        let positions = positions(600, 5);
        let mut upstream = field.config().zeros(positions.len());
        let mut place = 0_u32;
        for value in upstream.flat_mut().into_iter().flatten() {
            place += 1;
            *value = (place as f32 * 0.7).sin();
        }
        Self { field, positions, time: 0.3, upstream }
    }

    /// Sum over rows of upstream gradient times offset: what the gradients are derivatives of.
    fn loss(&self, tensors: &Doubles, positions: impl Iterator<Item = (usize, [f64; 3])>) -> f64 {
        let upstream = self.upstream.flat();
        let row = |(row, position): (usize, [f64; 3])| {
            let offsets = reference::offsets(self.field.config(), tensors, position, self.time.into());
            let head = |(upstream, offsets): (&&[f32], &Vec<f64>)| {
                let upstream = &upstream[row * offsets.len()..][..offsets.len()];
                upstream.iter().zip(offsets).map(|(slope, offset)| f64::from(*slope) * offset).sum::<f64>()
            };
            upstream.iter().zip(&offsets).map(head).sum::<f64>()
        };
        positions.map(row).sum()
    }

    fn wide_positions(&self) -> impl Iterator<Item = (usize, [f64; 3])> {
        self.positions.iter().map(|position| position.map(f64::from)).enumerate()
    }
}

#[test]
fn gradients_of_parameters_are_central_differences_of_the_reference() {
    let problem = Problem::small();
    let mut trace = Trace::default();
    problem.field.trace(&problem.positions, problem.time, &mut trace).unwrap();
    let mut gradients = problem.field.zero_gradients();
    problem.field.backward(&mut trace, &problem.upstream, &mut gradients).unwrap();
    let mut tensors = doubles(&problem.field.tensors());
    for (name, gradient) in problem.field.gradient_tensors(&gradients) {
        // A few numbers of each tensor, spread over it, and the steepest, since most texels are met by no row.
        let count = gradient.data.len();
        let size = |place: &usize| gradient.data[*place].abs();
        let steepest = (0..count).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap();
        let scale = f64::from(size(&steepest));
        assert!(scale > 0.0, "`{name}` has no gradient");
        for place in BTreeSet::from([0, count / 3, count / 2, count - 1, steepest]) {
            // Steps so small that hardly any ReLU changes its side.
            let mut side = |step: f64| {
                let number = &mut tensors.get_mut(&name).unwrap().1[place];
                let before = *number;
                *number += step;
                let loss = problem.loss(&tensors, problem.wide_positions());
                tensors.get_mut(&name).unwrap().1[place] = before;
                loss
            };
            let expected = (side(1.0e-6) - side(-1.0e-6)) / 2.0e-6;
            let found = f64::from(gradient.data[place]);
            let error = (found - expected).abs() / scale;
            assert!(error < 1.0e-3, "`{name}`[{place}]: {found} instead of {expected}");
        }
    }
}

#[test]
fn gradients_add_up_over_calls_until_they_are_cleared() {
    let problem = Problem::small();
    let mut trace = Trace::default();
    problem.field.trace(&problem.positions, problem.time, &mut trace).unwrap();
    let mut once = problem.field.zero_gradients();
    problem.field.backward(&mut trace, &problem.upstream, &mut once).unwrap();
    let mut twice = once.clone();
    problem.field.backward(&mut trace, &problem.upstream, &mut twice).unwrap();
    for (name, once) in problem.field.gradient_tensors(&once) {
        let doubled: Vec<f64> = once.data.iter().map(|value| 2.0 * f64::from(*value)).collect();
        assert!(
            relative_difference(&problem.field.gradient_tensors(&twice)[&name].data, &doubled) < 1.0e-5,
            "`{name}`"
        );
    }
    twice.clear();
    assert_eq!(twice, problem.field.zero_gradients());
}
