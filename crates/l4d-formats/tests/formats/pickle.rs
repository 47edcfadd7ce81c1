use std::collections::BTreeMap;

use l4d_formats::Tensor;
use l4d_formats::pickle;

use super::fixture;

fn tensor(shape: &[usize], data: &[f32]) -> Tensor {
    Tensor { shape: shape.to_vec(), data: data.to_vec() }
}

#[test]
fn every_type_stride_and_offset_that_torch_saves_is_read() {
    for file in ["pth/types.pth", "pth/protocol4.pth"] {
        let tensors = pickle::read_state_dict(&fixture(file)).unwrap();
        let expected: [(&str, &[usize], &[f32]); 16] = [
            ("double", &[2], &[0.5, -2.0]),
            ("half", &[2], &[0.5, -2.0]),
            ("bfloat16", &[2], &[0.5, -2.0]),
            ("long", &[2], &[7.0, -8.0]),
            ("int", &[2], &[7.0, -8.0]),
            ("short", &[2], &[7.0, -8.0]),
            ("char", &[2], &[7.0, -8.0]),
            ("byte", &[2], &[7.0, 248.0]),
            ("bool", &[2], &[1.0, 0.0]),
            ("scalar", &[], &[3.5]),
            ("empty", &[0, 3], &[]),
            ("whole", &[12], &[0., 1., 2., 3., 4., 5., 6., 7., 8., 9., 10., 11.]),
            ("transposed", &[4, 3], &[0., 4., 8., 1., 5., 9., 2., 6., 10., 3., 7., 11.]),
            ("sliced", &[3], &[5., 7., 9.]),
            ("expanded", &[3], &[2., 2., 2.]),
            ("parameter", &[1], &[1.25]),
        ];
        let expected: BTreeMap<String, Tensor> =
            expected.into_iter().map(|(name, shape, data)| (name.to_owned(), tensor(shape, data))).collect();
        assert_eq!(tensors, expected, "{file}");
    }
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    let error = pickle::read_tensor(&fixture("pth/nan.pth")).unwrap_err().to_string();
    assert!(error.ends_with("nan.pth: tensor, number 1: is NaN, but parameters are finite"), "{error}");
}

#[test]
fn values_of_the_wrong_kind_are_named() {
    let refused = |file: &str| pickle::read_state_dict(&fixture(file)).unwrap_err().to_string();
    assert!(refused("pth/bools.pth").ends_with("top level: is a tensor, but a state dict is a dict"));
    assert!(
        refused("pth/chkpnt.pth")
            .ends_with("top level: is a tuple, but a tensor or a dict of tensors belongs here")
    );
    let error = pickle::read_tensor(&fixture("pth/many.pth")).unwrap_err().to_string();
    assert!(error.ends_with("top level: is a dict, but a tensor belongs here"), "{error}");
}
