//! Random fields against the slow reference, and gradients against their own sums.

use l4d_splat::ShDegree;
use l4d_splat::deform::{Bounds, DeformConfig, DeformationField, Init, TimeAxis, Trace};
use proptest::prelude::*;

use crate::fixtures::{largest_difference, positions, relative_difference, small_config, small_field, wide};
use crate::reference::{self, doubles};

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

#[test]
fn gradients_of_many_rows_are_the_sums_of_those_of_a_few_until_they_are_cleared() {
    let field = small_field(small_config(), 11);
    // More rows than a block has.
    let positions = positions(600, 5);
    let mut upstream = field.config().zeros(positions.len());
    for (place, value) in upstream.flat_mut().into_iter().flatten().enumerate() {
        *value = (place as f32 * 0.7).sin();
    }
    let mut trace = Trace::default();
    let (mut whole, mut parts) = (field.zero_gradients(), field.zero_gradients());
    field.trace(&positions, 0.3, &mut trace).unwrap();
    field.backward(&mut trace, &upstream, &mut whole).unwrap();
    upstream.sh_degree = ShDegree::new(1).unwrap();
    let rows: Vec<u32> = (0..600).collect();
    for rows in rows.chunks(7) {
        let few: Vec<[f32; 3]> = rows.iter().map(|&row| positions[row as usize]).collect();
        field.trace(&few, 0.3, &mut trace).unwrap();
        field.backward(&mut trace, &upstream.select(rows), &mut parts).unwrap();
    }
    let whole = field.gradient_tensors(&whole);
    for (name, parts) in field.gradient_tensors(&parts) {
        assert!(relative_difference(&parts.data, &wide(&whole[&name].data)) < 1.0e-4, "`{name}`");
    }
    parts.clear();
    assert_eq!(parts, field.zero_gradients());
}
