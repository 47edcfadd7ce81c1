use std::collections::BTreeMap;

use l4d_splat::Tensor;
use l4d_splat::checkpoint::pickle::{self, Numbers, Value};

use super::{bytes, digest, fixture};

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
fn a_training_checkpoint_is_read_as_plain_data() {
    let Value::Tuple(outer) = pickle::read(&fixture("pth/chkpnt.pth")).unwrap() else { panic!("no tuple") };
    let [Value::Tuple(captured), Value::Int(9000)] = outer.as_slice() else { panic!("{outer:?}") };
    let [
        Value::Int(2),
        Value::Tensor(weight),
        Value::Dict(_),
        Value::Tensor(zeros),
        Value::Dict(optimizer),
        Value::Float(1.5),
    ] = captured.as_slice()
    else {
        panic!("{captured:?}")
    };
    assert_eq!((weight.shape.as_slice(), zeros.data.as_slice()), ([3, 3].as_slice(), [0.0; 3].as_slice()));
    let entry = |entries: &[(Value, Value)], key: &Value| -> Value {
        entries
            .iter()
            .find(|(known, _)| known == key)
            .map(|(_, value)| value.clone())
            .expect("the key is there")
    };
    let name = |text: &str| Value::Text(text.to_owned());
    let Value::List(groups) = entry(optimizer, &name("param_groups")) else { panic!("{optimizer:?}") };
    let [Value::Dict(group)] = groups.as_slice() else { panic!("{groups:?}") };
    assert_eq!(entry(group, &name("lr")), Value::Float(0.01));
    assert_eq!(entry(group, &name("betas")), Value::Tuple(vec![Value::Float(0.9), Value::Float(0.999)]));
    assert_eq!(entry(group, &name("name")), name("xyz"));
    let Value::Dict(states) = entry(optimizer, &name("state")) else { panic!("{optimizer:?}") };
    let Value::Dict(state) = entry(&states, &Value::Int(0)) else { panic!("{states:?}") };
    assert!(matches!(entry(&state, &name("exp_avg")), Value::Tensor(moment) if moment.shape == [3, 3]));
}

#[test]
fn what_torch_pickled_is_pickled_again_byte_by_byte() {
    for (file, name) in [("pth/many.pth", "many"), ("pth/one.pth", "one")] {
        let tensors = pickle::read_state_dict(&fixture(file)).unwrap();
        // Their dict stands in the order of the layers; ours is sorted, so that it is compared in parts.
        let in_order = if name == "one" { tensors.clone() } else { renamed(&tensors) };
        let ours = pickle::encode_state_dict(name, &in_order).unwrap();
        let theirs = data_pkl(&bytes(file));
        let expected = if name == "one" { theirs } else { with_sorted_names(&theirs) };
        assert!(data_pkl(&ours) == expected, "{file}: the pickles differ");
        assert_eq!(pickle::decode(&ours).unwrap().into_state_dict().unwrap(), in_order);
    }
    let four_axes = pickle::read_tensor(&fixture("pth/tensor.pth")).unwrap();
    assert_eq!(four_axes.shape, [2, 3, 4, 5]);
    let ours = pickle::encode_tensor("tensor", &four_axes.shape, Numbers::F32(&four_axes.data)).unwrap();
    assert!(data_pkl(&ours) == data_pkl(&bytes("pth/tensor.pth")), "the pickles differ");
    let ours = pickle::encode_tensor("bools", &[3], Numbers::Bool(&[true, false, true])).unwrap();
    assert!(data_pkl(&ours) == data_pkl(&bytes("pth/bools.pth")), "the pickles differ");
}

/// `layer.7.weight` becomes `layer.07weight`: as long, and sorted as it was made.
fn renamed(tensors: &BTreeMap<String, Tensor>) -> BTreeMap<String, Tensor> {
    tensors.iter().map(|(name, tensor)| (sorted_name(name), tensor.clone())).collect()
}

fn sorted_name(name: &str) -> String {
    let number = name.trim_start_matches("layer.").trim_end_matches(".weight");
    if number.len() == 1 { format!("layer.0{number}weight") } else { name.to_owned() }
}

fn with_sorted_names(pickle: &[u8]) -> Vec<u8> {
    let mut pickle = pickle.to_vec();
    for number in 0..10 {
        let name = format!("layer.{number}.weight");
        let at = pickle.windows(name.len()).position(|window| window == name.as_bytes()).unwrap();
        pickle[at..at + name.len()].copy_from_slice(sorted_name(&name).as_bytes());
    }
    pickle
}

/// The pickle in the archive: it starts with its protocol, and torch and l4d put it first.
fn data_pkl(file: &[u8]) -> Vec<u8> {
    let archive = rawzip::ZipArchive::from_slice(file).unwrap();
    let mut entries = archive.entries();
    let first = entries.next_entry().unwrap().unwrap();
    assert!(first.file_path().as_bytes().ends_with(b"/data.pkl"));
    archive.get_entry(first.wayfinder()).unwrap().data().to_vec()
}

#[test]
fn what_is_written_is_stored_aligned_and_always_the_same() {
    let tensors = pickle::read_state_dict(&fixture("pth/many.pth")).unwrap();
    let file = pickle::encode_state_dict("many", &tensors).unwrap();
    assert!(file == pickle::encode_state_dict("many", &tensors).unwrap());
    let archive = rawzip::ZipArchive::from_slice(&file).unwrap();
    let mut names = Vec::new();
    for record in archive.entries() {
        let record = record.unwrap();
        let entry = archive.get_entry(record.wayfinder()).unwrap();
        assert_eq!(entry.compressed_data_range().0 % 64, 0, "{:?}", record.file_path());
        names.push(String::from_utf8(record.file_path().as_bytes().to_vec()).unwrap());
    }
    assert_eq!(names[..3], ["many/data.pkl", "many/byteorder", "many/data/0"]);
    assert_eq!(names.last().unwrap(), "many/version");
}

#[test]
fn odd_numbers_keep_their_bits_and_odd_shapes_their_axes() {
    let odd = [-0.0, f32::MIN_POSITIVE, 1e-45, f32::MAX, 1.0 + f32::EPSILON, -1e-45];
    let tensors: BTreeMap<String, Tensor> = [
        ("bits", tensor(&[3, 2], &odd)),
        ("none", tensor(&[2, 0, 3], &[])),
        ("number", tensor(&[], &[4.0])),
        ("axes", tensor(&[1, 1, 2, 1, 1], &[1.0, 2.0])),
        ("long", tensor(&[70_000], &vec![0.25; 70_000])),
        ("na\u{ef}ve", tensor(&[1], &[0.0])),
    ]
    .map(|(name, tensor)| (name.to_owned(), tensor))
    .into();
    let decoded = pickle::decode(&pickle::encode_state_dict("x", &tensors).unwrap())
        .unwrap()
        .into_state_dict()
        .unwrap();
    assert_eq!(decoded, tensors);
    assert_eq!(digest(&decoded["bits"].data), digest(&odd));
    let empty = BTreeMap::new();
    assert_eq!(
        pickle::decode(&pickle::encode_state_dict("x", &empty).unwrap()).unwrap(),
        Value::Dict(vec![])
    );
    let misshapen = [("w".to_owned(), tensor(&[3], &[0.0]))].into();
    assert_eq!(pickle::encode_state_dict("x", &misshapen).unwrap_err().place, "w");
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    let error = pickle::read_tensor(&fixture("pth/nan.pth")).unwrap_err().to_string();
    assert!(error.ends_with("nan.pth: tensor, number 1: is NaN, but parameters are finite"), "{error}");
    let poisoned: BTreeMap<String, Tensor> = [("w".to_owned(), tensor(&[2], &[0.0, f32::INFINITY]))].into();
    let file = pickle::encode_state_dict("x", &poisoned).unwrap();
    let fault = pickle::decode(&file).unwrap().into_state_dict().unwrap_err();
    assert_eq!(fault.to_string(), "`w`, number 1: is inf, but parameters are finite");
}

#[test]
fn values_of_the_wrong_kind_are_named() {
    let refused = |file: &str| pickle::read_state_dict(&fixture(file)).unwrap_err().to_string();
    assert!(refused("pth/bools.pth").ends_with("top level: is a tensor, but a state dict is a dict"));
    assert!(refused("pth/chkpnt.pth").ends_with("top level: is a tuple, but a state dict is a dict"));
    let error = pickle::read_tensor(&fixture("pth/many.pth")).unwrap_err().to_string();
    assert!(error.ends_with("top level: is a dict, but a tensor belongs here"), "{error}");
}
