//! The same bytes on any number of threads.

use l4d_solve::lift::{Answer, ClosedSettings, DistilSettings, FieldSettings, LiftSettings, Lifted};

use crate::fixture::{Scene, as_it_is};

fn lifted(threads: usize, settings: &LiftSettings) -> Lifted {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let scene = Scene::new();
        scene.lift(&scene.evidence(3, as_it_is), settings).unwrap()
    })
}

#[test]
fn one_two_and_five_threads_give_the_same_bytes() {
    let field = FieldSettings { iterations: 8, width: 24, sampled: 60, ..FieldSettings::paper() };
    for settings in [
        LiftSettings::Closed(ClosedSettings::robust()),
        LiftSettings::Field(field),
        LiftSettings::Distil(DistilSettings { field, rows: 300, ..DistilSettings::usual() }),
    ] {
        let one = lifted(1, &settings);
        assert!([2, 5].into_iter().all(|threads| lifted(threads, &settings) == one), "{settings:?}");
    }
}

#[test]
fn another_seed_is_another_field() {
    let field = FieldSettings { iterations: 3, width: 24, ..FieldSettings::paper() };
    let other = FieldSettings { seed: 1, ..field };
    let [Answer::Field(one), Answer::Field(other)] =
        [field, other].map(|field| lifted(2, &LiftSettings::Field(field)).answer)
    else {
        panic!("fields");
    };
    assert_ne!(one, other);
}
