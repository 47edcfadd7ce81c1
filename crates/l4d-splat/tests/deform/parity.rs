//! Offsets and gradients against torch modules that were written from the equations alone.

use std::collections::BTreeMap;

use l4d_splat::deform::{DeformConfig, DeformationField, Trace};
use serde::Deserialize;

use crate::fixtures::{Lists, Named, largest_difference, read, relative_difference, tensors};

#[derive(Debug, Deserialize)]
struct Fixture {
    cases: Vec<Case>,
}

#[derive(Debug, Deserialize)]
struct Case {
    name: String,
    config: DeformConfig,
    tensors: BTreeMap<String, Named>,
    positions: Vec<[f32; 3]>,
    time: f32,
    offsets: Lists,
    upstream: Lists,
    gradients: BTreeMap<String, Named>,
    position_gradients: Vec<[f64; 3]>,
}

fn cases() -> Vec<Case> {
    let cases = read::<Fixture>("deform.json").cases;
    assert_eq!(cases.len(), 5);
    cases
}

impl Case {
    fn field(&self) -> DeformationField {
        let tensors = tensors(&self.tensors);
        DeformationField::from_tensors(self.config.clone(), &tensors).unwrap()
    }
}

#[test]
fn offsets_are_those_of_torch_within_1e_5() {
    for case in cases() {
        let offsets = case.field().offsets(&case.positions, case.time).unwrap();
        for ((name, expected), found) in case.offsets.each().into_iter().zip(offsets.flat()) {
            let difference = largest_difference(found, expected);
            assert!(difference < 1.0e-5, "{}: `{name}` differs by {difference:e}", case.name);
        }
    }
}

#[test]
fn tracing_gives_the_same_offsets() {
    for case in cases() {
        let field = case.field();
        let traced = field.trace(&case.positions, case.time, &mut Trace::default()).unwrap();
        assert_eq!(traced, field.offsets(&case.positions, case.time).unwrap(), "{}", case.name);
    }
}

#[test]
fn gradients_are_those_of_torch_within_1e_3() {
    for case in cases() {
        let field = case.field();
        let mut gradients = field.zero_gradients();
        let mut trace = Trace::default();
        field.trace(&case.positions, case.time, &mut trace).unwrap();
        let positions = field.backward(&mut trace, &case.upstream.offsets(), &mut gradients).unwrap();
        let found = field.gradient_tensors(&gradients);
        assert!(found.keys().eq(case.gradients.keys()), "{}", case.name);
        for (name, expected) in &case.gradients {
            assert_eq!(found[name].shape, expected.shape, "{}: `{name}`", case.name);
            let difference = relative_difference(&found[name].data, &expected.data);
            assert!(difference < 1.0e-3, "{}: `{name}` differs by {difference:e}", case.name);
        }
        let expected = case.position_gradients.as_flattened();
        let difference = relative_difference(positions.as_flattened(), expected);
        assert!(difference < 1.0e-3, "{}: positions differ by {difference:e}", case.name);
    }
}

#[test]
fn what_is_read_from_a_checkpoint_is_written_back_unchanged() {
    for case in cases() {
        assert_eq!(case.field().tensors(), tensors(&case.tensors), "{}", case.name);
    }
}
