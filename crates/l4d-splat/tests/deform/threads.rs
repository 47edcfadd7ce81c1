//! The same bytes on one, two and eight threads.

use l4d_splat::deform::{DeformConfig, Trace};
use l4d_splat::optimise::{Adam, Group, GroupUpdate, LearningRate, PlaneWeights, plane_penalty};

use crate::fixtures::{positions, small_field};

/// Everything that a step computes, as bits.
fn step() -> Vec<u32> {
    let config = DeformConfig {
        channels: 8,
        spatial_resolution: [9, 7, 8],
        time_resolution: 12,
        width: 32,
        ..DeformConfig::dynerf()
    };
    let mut field = small_field(config, 1);
    // Not a whole number of blocks, and more blocks than lists of partial sums.
    let positions = positions(17 * 256 + 33, 4);
    let mut trace = Trace::default();
    let offsets = field.trace(&positions, 0.61, &mut trace).unwrap();
    let mut gradients = field.zero_gradients();
    let slopes = field.backward(&mut trace, &offsets, &mut gradients).unwrap();
    plane_penalty(&field, &PlaneWeights::default(), &mut gradients).unwrap();
    let rate = LearningRate::constant(1.0e-2).unwrap();
    let lists = gradients.lists();
    let lengths = |lists: &[&[f32]]| lists.iter().map(|list| list.len()).collect::<Vec<_>>();
    let groups = vec![
        Group::new("planes", rate, &lengths(&lists.planes)),
        Group::new("layers", rate, &lengths(&lists.layers)),
    ];
    let mut adam = Adam { groups };
    let parameters = field.parameters_mut();
    let shares = vec![
        GroupUpdate { parameters: parameters.planes, gradients: lists.planes },
        GroupUpdate { parameters: parameters.layers, gradients: lists.layers },
    ];
    adam.step(1, shares).unwrap();

    let bits = |list: &[f32]| list.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let mut all: Vec<u32> = offsets.flat().into_iter().flat_map(bits).collect();
    all.extend(bits(slopes.as_flattened()));
    for tensor in field.gradient_tensors(&gradients).values().chain(field.tensors().values()) {
        all.extend(bits(&tensor.data));
    }
    all
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let [one, two, eight] = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(step)
    });
    assert!(one.len() > 300_000);
    assert_eq!(one, two);
    assert_eq!(one, eight);
}
