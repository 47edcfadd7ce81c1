use l4d_splat::checkpoint::ply;
use l4d_splat::{Gaussians, ShDegree};
use proptest::prelude::*;

use super::{bytes, ply_file};

/// The number that the fixtures have in a row and a column of the usual order, normals left out.
fn value(row: usize, column: usize) -> f32 {
    64.0 * (row as f32 + 1.0) + column as f32 - 99.5
}

fn expected(degree: u8, rows: usize) -> Gaussians {
    let sh_degree = ShDegree::new(degree).unwrap();
    let higher = sh_degree.coefficients() - 1;
    let mut gaussians = Gaussians { sh_degree, ..Gaussians::default() };
    for row in 0..rows {
        let three = |first: usize| std::array::from_fn(|axis| value(row, first + axis));
        gaussians.means.push(three(0));
        gaussians.sh.push(three(3));
        for k in 0..higher {
            gaussians.sh.push(std::array::from_fn(|channel| value(row, 6 + channel * higher + k)));
        }
        let after = 6 + 3 * higher;
        gaussians.opacity_logits.push(value(row, after));
        gaussians.log_scales.push(three(after + 1));
        gaussians.rotations.push(std::array::from_fn(|axis| value(row, after + 4 + axis)));
    }
    gaussians
}

#[test]
fn ascii_doubles_big_endian_and_foreign_orders_give_the_same_numbers() {
    for (file, degree) in
        [("degree1_ascii_double", 1), ("degree0_big_endian", 0), ("degree2_backwards_crlf", 2)]
    {
        assert_eq!(ply::read(&ply_file(&format!("{file}.ply"))).unwrap(), expected(degree, 3), "{file}");
    }
}

#[test]
fn what_plyfile_wrote_is_written_again_byte_by_byte() {
    let written = bytes("model/point_cloud/iteration_7/point_cloud.ply");
    let decoded = ply::decode(&written).unwrap();
    assert!(ply::encode(&decoded).unwrap() == written, "the bytes differ");
}

#[test]
fn bits_survive_for_every_degree() {
    let odd = [-0.0, f32::MIN_POSITIVE, 1e-45, f32::MAX, -f32::MAX, 1.0 + f32::EPSILON];
    for degree in 0..=3 {
        let mut gaussians = expected(degree, 6);
        gaussians.sh.iter_mut().flatten().zip(odd.iter().cycle()).for_each(|(number, &odd)| *number = odd);
        gaussians.opacity_logits.copy_from_slice(&odd);
        let decoded = ply::decode(&ply::encode(&gaussians).unwrap()).unwrap();
        let bits = |gaussians: &Gaussians| -> Vec<u32> {
            gaussians
                .sh
                .iter()
                .flatten()
                .chain(&gaussians.opacity_logits)
                .map(|number| number.to_bits())
                .collect()
        };
        assert_eq!(bits(&decoded), bits(&gaussians));
        assert_eq!(decoded, gaussians);
    }
    let none = expected(3, 0);
    assert_eq!(ply::decode(&ply::encode(&none).unwrap()).unwrap(), none);
}

#[test]
fn values_that_are_not_finite_are_named() {
    for (number, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let mut file = ply::encode(&expected(3, 4)).unwrap();
        // Row 2, property f_rest_17: 3 centres, 3 normals, 3 constants before the rest.
        let at = file.len() - 4 * 248 + 2 * 248 + 4 * (9 + 17);
        file[at..at + 4].copy_from_slice(&number.to_le_bytes());
        let fault = ply::decode(&file).unwrap_err();
        assert_eq!(
            fault.to_string(),
            format!("Gaussian 2, property `f_rest_17`: is {shown}, but parameters are finite")
        );
        assert!(fault.hint.contains("earlier checkpoint"), "{fault:?}");
    }
    let ascii = std::fs::read(ply_file("degree1_ascii_double.ply")).unwrap();
    let ascii = replaced(&ascii, "92.5", "1e300");
    assert_eq!(ply::decode(&ascii).unwrap_err().place, "Gaussian 2, property `x`");
    let mut poisoned = expected(1, 2);
    poisoned.log_scales[1][0] = f32::NAN;
    assert_eq!(ply::encode(&poisoned).unwrap_err().place, "Gaussian 1, field `log_scales`");
    poisoned.log_scales.pop();
    assert_eq!(ply::encode(&poisoned).unwrap_err().place, "field `log_scales`");
}

#[test]
fn properties_that_are_no_gaussians_are_named() {
    let file = ply::encode(&expected(1, 2)).unwrap();
    for (from, to, why) in [
        ("vertex", "point", "header: has no element `vertex`, in which Gaussians are stored"),
        (
            "float opacity",
            "int opacity",
            "header, property `opacity`: is of type `int32`, but parameters are",
        ),
        ("float opacity", "float alpha", "header, property `opacity`: is missing"),
        ("f_rest_8", "f_rest_9", "header, property `f_rest_8`: is missing"),
        ("f_rest_8", "confidence", "header, properties `f_rest_*`: are 8, but degrees 0 to 3"),
    ] {
        let error = ply::decode(&replaced(&file, from, to)).unwrap_err().to_string();
        assert!(error.starts_with(why), "{error}");
    }
}

fn replaced(file: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at =
        file.windows(from.len()).position(|window| window == from.as_bytes()).expect("the text is there");
    [&file[..at], to.as_bytes(), &file[at + from.len()..]].concat()
}

proptest! {
    #[test]
    fn any_gaussians_come_back(degree in 0_u8..4, seed in prop::collection::vec(any::<u32>(), 1..80), rows in 0_usize..5) {
        let mut gaussians = expected(degree, rows);
        let numbers = gaussians.means.iter_mut().flatten().chain(gaussians.sh.iter_mut().flatten());
        for (number, &bits) in numbers.zip(seed.iter().cycle()) {
            let odd = f32::from_bits(bits);
            *number = if odd.is_finite() { odd } else { 0.5 };
        }
        prop_assert_eq!(ply::decode(&ply::encode(&gaussians).unwrap()).unwrap(), gaussians);
    }
}
