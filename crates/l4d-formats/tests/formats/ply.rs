use l4d_formats::Fault;
use l4d_formats::ply::{Ply, Scalar, encode};

use super::bytes;

/// All rows of the vertices, those columns that are `float` or `double`.
pub(crate) fn rows(bytes: &[u8]) -> Result<Vec<Vec<f32>>, Fault> {
    let file = Ply::open(bytes)?;
    let vertex = file.elements().iter().find(|element| element.name == "vertex");
    let vertex = vertex.ok_or_else(|| Fault::new("header", "has no vertices", "add some"))?;
    let floats =
        vertex.properties.iter().filter(|property| matches!(property.scalar, Scalar::F32 | Scalar::F64));
    let names: Vec<String> = floats.map(|property| property.name.clone()).collect();
    let mut rows = Vec::new();
    file.rows(vertex, &names, "write it again", |_, row| {
        rows.push(row.to_vec());
        Ok(())
    })?;
    Ok(rows)
}

/// Two rows of four columns.
fn small() -> Vec<u8> {
    let body: Vec<u8> = (0..8).flat_map(|number| (number as f32).to_le_bytes()).collect();
    encode(2, ["x", "y", "z", "w"].map(|name| (name, Scalar::F32)), &body)
}

#[test]
fn what_is_written_is_read() {
    assert_eq!(rows(&small()).unwrap(), [[0.0, 1.0, 2.0, 3.0], [4.0, 5.0, 6.0, 7.0]]);
    let file = Ply::open(&[]).map(drop);
    assert!(file.is_err());
}

#[test]
fn columns_of_another_type_are_refused() {
    let file = replaced(&small(), "float w", "uint w");
    let file = Ply::open(&file).unwrap();
    let wanted = |name: &str| file.rows(&file.elements()[0], &[name.to_owned()], "", |_, _| Ok(()));
    let said = "is of type `uint`, but parameters are `float` or `double`";
    assert_eq!(wanted("w").unwrap_err().to_string(), format!("header, property `w`: {said}"));
    assert_eq!(wanted("v").unwrap_err().to_string(), "header, property `v`: is missing");
}

#[test]
fn a_file_of_the_wrong_length_is_refused_before_memory_is_allocated() {
    let whole = small();
    let refused = |file: &[u8]| rows(file).unwrap_err().to_string();
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
}

#[test]
fn headers_that_cannot_be_are_refused_with_their_line() {
    let file = small();
    for (from, to, why) in [
        ("ply\n", "plx\n", "first line: is not `ply`: this is no PLY file"),
        ("1.0", "1.1", "header, line 2: has version `1.1`, but only 1.0 exists"),
        ("little", "middle", "header, line 2: has no such format as `binary_middle_endian`"),
        ("vertex 2", "vertex -2", "header, line 3: has the count `-2`, which is no number of rows"),
        (
            "vertex 2",
            "vertex 2 2",
            "header, line 3: is `element vertex 2 2`, which is no line of a PLY header",
        ),
        ("element vertex 2\n", "", "header, line 3: precedes any element"),
        ("float y", "float x", "header, line 5: repeats property `x`"),
        ("float y", "real y", "header, line 5: has no such type as `real`"),
        ("property float x", "property list uchar int x", "header, line 4: is a list property"),
        ("end_header\n", "element vertex 2\nend_header\n", "header, line 8: repeats element `vertex`"),
        ("end_header\n", "element face 2\nend_header\n", "header: element `face` has no properties"),
        ("end_header\n", "format ascii 1.0\nend_header\n", "header, line 8: states the format twice"),
        ("format binary_little_endian 1.0\n", "", "header: has no `format` line"),
        ("format", "comment \u{1b}[2J\nfromat", "header, line 3: is `fromat"),
    ] {
        let error = rows(&replaced(&file, from, to)).unwrap_err().to_string();
        assert!(error.starts_with(why), "{error}");
    }
    let endless = [b"ply\n".as_slice(), b"comment x\n".repeat(10_000).as_slice()].concat();
    assert!(rows(&endless).unwrap_err().to_string().contains("has not come to `end_header`"));
    assert!(rows(b"ply\nformat ascii 1.0\n").unwrap_err().to_string().contains("line 3: is cut"));
}

#[test]
fn ascii_rows_are_refused_with_their_line() {
    let file = bytes("ply/degree1_ascii_double.ply");
    for (from, to, why) in [
        ("92.5 ", "", "line 31: has 22 numbers, but the header names 23 properties"),
        ("92.5 ", "92.5 1 ", "line 31: has more than 23 numbers, but the header names 23 properties"),
        ("92.5 ", "92,5 ", "line 31: property `x` is `92,5`, which is no number"),
        ("vertex 3", "vertex 2", "line 31: follows the last row that the header claims"),
        ("vertex 3", "vertex 4", "end of file: 3 of 4 rows of `vertex` are there"),
    ] {
        assert_eq!(rows(&replaced(&file, from, to)).unwrap_err().to_string(), why);
    }
    let blank_lines = replaced(&file, "\n92.5 ", "\n\n  \n92.5 ");
    assert_eq!(rows(&blank_lines).unwrap(), rows(&file).unwrap());
}

fn replaced(file: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at =
        file.windows(from.len()).position(|window| window == from.as_bytes()).expect("the text is there");
    [&file[..at], to.as_bytes(), &file[at + from.len()..]].concat()
}
