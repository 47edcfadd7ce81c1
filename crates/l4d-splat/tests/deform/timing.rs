//! How long the field takes: `cargo test --release -p l4d-splat --test deform -- --ignored timing --nocapture`.

use std::hint::black_box;
use std::time::Instant;

use l4d_splat::deform::{DeformConfig, Trace};
use l4d_splat::optimise::{
    Adam, AdamSettings, Group, GroupUpdate, LearningRate, PlaneWeights, dssim, plane_penalty,
};

use crate::fixtures::{positions, small_field};

fn best_ms(mut work: impl FnMut()) -> f64 {
    let once = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1.0e3
    };
    (0..12).map(once).fold(f64::INFINITY, f64::min)
}

#[test]
#[ignore = "a measurement, not a check"]
fn timing_of_ten_thousand_rows() {
    let rows = 10_000;
    let positions = positions(rows, 1);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut field = small_field(DeformConfig::dynerf(), 0);
            let forward = best_ms(|| drop(black_box(field.offsets(&positions, 0.4).unwrap())));
            let mut trace = Trace::default();
            let traced = best_ms(|| drop(black_box(field.trace(&positions, 0.4, &mut trace).unwrap())));
            let mut gradients = field.zero_gradients();
            let both = best_ms(|| {
                let offsets = field.trace(&positions, 0.4, &mut trace).unwrap();
                black_box(field.backward(&mut trace, &offsets, &mut gradients).unwrap());
            });
            let penalty = best_ms(|| {
                black_box(plane_penalty(&field, &PlaneWeights::default(), &mut gradients).unwrap());
            });
            println!(
                "{rows} rows, {threads} threads: forward {forward:.1} ms, with trace {traced:.1}, forward and \
                 backward {both:.1}; plane penalties {penalty:.1}"
            );

            let rate = LearningRate::constant(1.0e-4).unwrap();
            gradients.clear();
            let offsets = field.trace(&positions, 0.4, &mut trace).unwrap();
            field.backward(&mut trace, &offsets, &mut gradients).unwrap();
            let lists = gradients.lists();
            let lengths = |lists: &[&[f32]]| lists.iter().map(|list| list.len()).collect::<Vec<_>>();
            let groups = vec![Group::new("planes", rate, &lengths(&lists.planes))];
            let mut adam = Adam { settings: AdamSettings::default(), groups };
            let step = best_ms(|| {
                let parameters = field.parameters_mut().planes;
                adam.step(1, vec![GroupUpdate { parameters, gradients: lists.planes.clone() }]).unwrap();
            });
            let picture = vec![0.4; 256 * 192 * 3];
            let target = vec![0.5; picture.len()];
            let mut gradient = vec![0.0; picture.len()];
            let similarity = best_ms(|| {
                black_box(dssim(&picture, &target, 256, 3, 1.0, &mut gradient).unwrap());
            });
            println!("{threads} threads: Adam on the planes {step:.1} ms, D-SSIM of 256x192 {similarity:.1} ms");
        });
    }
}
