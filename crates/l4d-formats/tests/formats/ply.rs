use std::io::Cursor;

use l4d_formats::Fault;
use l4d_formats::ply::{Ply, PropertyType, ScalarType, encode};

use super::bytes;

/// All rows of the vertices, those columns that are `float` or `double`.
pub(crate) fn rows(bytes: &[u8]) -> Result<Vec<Vec<f32>>, Fault> {
    let file = Ply::open(Cursor::new(bytes))?;
    let vertex = file.elements().iter().find(|element| element.name == "vertex");
    let properties = vertex.map(|vertex| vertex.properties.clone()).unwrap_or_default();
    let is_float =
        |kind: &PropertyType| matches!(kind, PropertyType::Scalar(ScalarType::F32 | ScalarType::F64));
    let floats = properties.into_iter().filter(|property| is_float(&property.property_type));
    let names: Vec<String> = floats.map(|property| property.name).collect();
    let mut rows = Vec::new();
    file.rows("vertex", &names, "write it again", |_, row| {
        rows.push(row.to_vec());
        Ok(())
    })?;
    Ok(rows)
}

/// Two rows of four columns.
fn small() -> Vec<u8> {
    let body: Vec<u8> = (0..8).flat_map(|number| (number as f32).to_le_bytes()).collect();
    encode(2, ["x", "y", "z", "w"].map(|name| (name, "float")), &body)
}

fn refused(file: &[u8]) -> String {
    rows(file).unwrap_err().to_string()
}

#[test]
fn what_is_written_is_read() {
    assert_eq!(rows(&small()).unwrap(), [[0.0, 1.0, 2.0, 3.0], [4.0, 5.0, 6.0, 7.0]]);
}

#[test]
fn columns_of_another_type_are_refused() {
    let file = replaced(&small(), "float w", "uint w");
    let wanted = |name: &str| {
        Ply::open(Cursor::new(&file))
            .unwrap()
            .rows("vertex", &[name.to_owned()], "", |_, _| Ok(()))
            .unwrap_err()
            .to_string()
    };
    let said = "is of type `uint32`, but parameters are `float` or `double`";
    assert_eq!(wanted("w"), format!("header, property `w`: {said}"));
    assert_eq!(wanted("v"), "header, property `v`: is missing");
}

#[test]
fn a_file_of_the_wrong_length_is_refused_before_memory_is_allocated() {
    let whole = small();
    let said = "size: the header claims 2 rows of `vertex`, which need 32 bytes, but 31 follow it";
    assert_eq!(refused(&whole[..whole.len() - 1]), said);
    assert!(refused(&[whole.clone(), vec![0]].concat()).ends_with("need 32 bytes, but 33 follow it"));
    let ascii = bytes("ply/degree1_ascii_double.ply");
    for count in ["18446744073709551615", "74382980134554820", "4000000000"] {
        for (file, vertex) in [(&whole, "vertex 2"), (&ascii, "vertex 3")] {
            let error = refused(&replaced(file, vertex, &format!("vertex {count}")));
            assert!(error.starts_with("size: the header claims"), "{error}");
        }
    }
    for (from, to, found) in [
        ("92.5 ", "", 68),
        ("92.5 ", "92.5 1 ", 70),
        ("vertex 3", "vertex 2", 69),
        ("vertex 3", "vertex 4", 69),
    ] {
        let error = refused(&replaced(&ascii, from, to));
        assert!(error.ends_with(&format!(" numbers, but {found} follow it")), "{error}");
    }
}

#[test]
fn headers_and_rows_that_cannot_be_are_refused() {
    let file = small();
    for (from, to, why) in [
        ("ply\n", "plx\n", "header: `File must start with 'ply'`"),
        ("little", "middle", "header: `Unknown format: binary_middle_endian`"),
        ("vertex 2", "vertex -2", "header: `Invalid element count: -2`"),
        ("element vertex 2\n", "", "header: `Property without element`"),
        ("float y", "float x", "header: repeats `x`"),
        ("float y", "real y", "header: `Unknown scalar type: real`"),
        ("float x", "list uchar int x", "header: `x` is a list, but points have none"),
        ("end_header\n", "element vertex 0\nend_header\n", "header: repeats `vertex`"),
        ("end_header\n", "element face 2\nend_header\n", "size: the header claims"),
        ("format binary_little_endian 1.0\n", "", "header: `Missing format"),
        ("format", "comment \u{1b}[2J\nfromat", "header: "),
        ("\nend_header", "\nno_header", "header: has no line `end_header`: is this a PLY file?"),
    ] {
        let error = refused(&replaced(&file, from, to));
        assert!(error.starts_with(why), "{error}");
    }
    let file = bytes("ply/degree1_ascii_double.ply");
    assert!(refused(&replaced(&file, "92.5 ", "92,5 ")).starts_with("rows of `vertex`: `Failed to parse"));
    let blank_lines = replaced(&file, "\n92.5 ", "\n\n  \n92.5 ");
    assert_eq!(rows(&blank_lines).unwrap(), rows(&file).unwrap());
}

fn replaced(file: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at =
        file.windows(from.len()).position(|window| window == from.as_bytes()).expect("the text is there");
    [&file[..at], to.as_bytes(), &file[at + from.len()..]].concat()
}
