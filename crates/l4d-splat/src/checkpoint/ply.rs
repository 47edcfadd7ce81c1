//! 3D Gaussians as PLY: the 62 properties of 3DGS, or fewer below degree 3.
//!
//! Written in the one order that every program reads.

use std::collections::TryReserveError;
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::{open_bounded, write_atomic};

use l4d_formats::Fault;
use l4d_formats::ply::{self, ElementDef, Ply};
use l4d_formats::tensor::HINT_NOT_FINITE;

use crate::checkpoint::{MAX_BYTES, check_gaussians};
use crate::gaussians::{Gaussians, ShDegree};

const HINT_FOREIGN: &str =
    "export the model as the PLY of 3DGS (x, y, z, f_dc_*, f_rest_*, opacity, scale_*, rot_*)";

const HINT_COMPRESSED: &str =
    "export it as PLY without compression, or convert it: `splat-transform IN OUT.ply`";

/// Reads a PLY file.
///
/// # Errors
/// A file that cannot be read, and what [`decode`] refuses.
pub fn read(path: &Path) -> Result<Gaussians, DataError> {
    read_from(BufReader::new(open_bounded(path, MAX_BYTES)?)).map_err(|fault| fault.at(path))
}

/// Writes a PLY file, binary little endian.
///
/// # Errors
/// What [`encode`] and the disk refuse.
pub fn write(path: &Path, gaussians: &Gaussians) -> Result<(), DataError> {
    let bytes = encode(gaussians).map_err(|fault| fault.at(path))?;
    write_atomic(path, &bytes)
}

/// Gaussians from the bytes of a PLY file: ascii or binary, `float` or `double`.
///
/// # Errors
/// Lists, other than 0, 9, 24 or 45 `f_rest_*`, sizes that are not the file's, and values that are not finite.
pub fn decode(bytes: &[u8]) -> Result<Gaussians, Fault> {
    read_from(Cursor::new(bytes))
}

fn read_from(source: impl BufRead + Seek) -> Result<Gaussians, Fault> {
    let file = Ply::open(source)?;
    let vertex = file.elements().iter().find(|element| element.name == "vertex").ok_or_else(|| {
        Fault::new("header", "has no element `vertex`, in which Gaussians are stored", HINT_FOREIGN)
    })?;
    if vertex.get_property("packed_position").is_some() {
        return Err(Fault::new("header", "is that of a compressed PLY, which is not read", HINT_COMPRESSED));
    }
    let degree = degree_of(vertex)?;
    let names = parameter_names(degree);
    let mut gaussians = Gaussians { sh_degree: degree, ..Gaussians::default() };
    reserve(&mut gaussians, vertex.count).map_err(|error| {
        let message = format!("{} Gaussians do not fit into memory: {error}", vertex.count);
        Fault::new("header", message, "check that this is the intended file, or allow more memory")
    })?;
    file.rows("vertex", &names, HINT_FOREIGN, |index, row| {
        if let Some((value, name)) = row.iter().zip(&names).find(|(value, _)| !value.is_finite()) {
            return Err(Fault::new(
                format!("Gaussian {index}, property `{name}`"),
                format!("is {value}, but parameters are finite"),
                HINT_NOT_FINITE,
            ));
        }
        push(&mut gaussians, row);
        Ok(())
    })?;
    Ok(gaussians)
}

/// Language features of 4D LangSplat: the columns `f_lang_*` row by row, and how many there are.
///
/// # Errors
/// As [`read`].
pub(super) fn read_language(path: &Path) -> Result<(Vec<f32>, usize), DataError> {
    let source = BufReader::new(open_bounded(path, MAX_BYTES)?);
    let decode = || {
        let file = Ply::open(source)?;
        let vertex = file.elements().iter().find(|element| element.name == "vertex");
        let properties = vertex.into_iter().flat_map(|vertex| &vertex.properties);
        let count = properties.filter(|property| property.name.starts_with("f_lang_")).count();
        let names: Vec<String> = (0..count).map(|index| format!("f_lang_{index}")).collect();
        let mut values = Vec::new();
        file.rows("vertex", &names, HINT_FOREIGN, |index, row| {
            if let Some(value) = row.iter().find(|value| !value.is_finite()) {
                let place = format!("Gaussian {index}, properties `f_lang_*`");
                return Err(Fault::new(place, format!("have {value}"), HINT_NOT_FINITE));
            }
            values.extend_from_slice(row);
            Ok(())
        })?;
        Ok((values, count))
    };
    decode().map_err(|fault: Fault| fault.at(path))
}

/// Gaussians as the bytes of a PLY file: binary little endian, normals zero, the properties in the order of 3DGS.
///
/// # Errors
/// Lists of different lengths and values that are not finite.
pub fn encode(gaussians: &Gaussians) -> Result<Vec<u8>, Fault> {
    check_gaussians(gaussians)?;
    let mut names = parameter_names(gaussians.sh_degree);
    // Normals: every 3DGS file has them, and they are always zero.
    names.splice(3..3, ["nx", "ny", "nz"].map(str::to_owned));
    let mut body = Vec::with_capacity(gaussians.len() * names.len() * size_of::<f32>());
    let mut put = |value: f32| body.extend_from_slice(&value.to_le_bytes());
    for index in 0..gaussians.len() {
        let sh = gaussians.sh_of(index);
        gaussians.means[index].into_iter().for_each(&mut put);
        [0.0; 3].into_iter().for_each(&mut put);
        sh[0].into_iter().for_each(&mut put);
        for channel in 0..3 {
            sh[1..].iter().for_each(|coefficient| put(coefficient[channel]));
        }
        put(gaussians.opacity_logits[index]);
        gaussians.log_scales[index].into_iter().for_each(&mut put);
        gaussians.rotations[index].into_iter().for_each(&mut put);
    }
    let properties = names.iter().map(|name| (name.as_str(), "float"));
    Ok(ply::encode(gaussians.len(), properties, &body))
}

/// Properties that carry parameters, in the order of 3DGS, normals left out.
fn parameter_names(degree: ShDegree) -> Vec<String> {
    let rest = 3 * (degree.coefficients() - 1);
    let numbered = |stem: &'static str, count: usize| (0..count).map(move |index| format!("{stem}{index}"));
    let mut names: Vec<String> = ["x", "y", "z"].map(str::to_owned).into();
    names.extend(numbered("f_dc_", 3));
    names.extend(numbered("f_rest_", rest));
    names.push("opacity".to_owned());
    names.extend(numbered("scale_", 3));
    names.extend(numbered("rot_", 4));
    names
}

fn degree_of(vertex: &ElementDef) -> Result<ShDegree, Fault> {
    let rest = vertex.properties.iter().filter(|property| property.name.starts_with("f_rest_")).count();
    (0..=ShDegree::MAX.get())
        .filter_map(ShDegree::new)
        .find(|degree| 3 * (degree.coefficients() - 1) == rest)
        .ok_or_else(|| {
            Fault::new(
                "header, properties `f_rest_*`",
                format!("are {rest}, but degrees 0 to 3 of the harmonics have 0, 9, 24 or 45"),
                HINT_FOREIGN,
            )
        })
}

fn reserve(gaussians: &mut Gaussians, count: usize) -> Result<(), TryReserveError> {
    gaussians.means.try_reserve_exact(count)?;
    gaussians.sh.try_reserve_exact(count * gaussians.sh_degree.coefficients())?;
    gaussians.opacity_logits.try_reserve_exact(count)?;
    gaussians.log_scales.try_reserve_exact(count)?;
    gaussians.rotations.try_reserve_exact(count)
}

/// Takes one row in the order of [`parameter_names`].
fn push(gaussians: &mut Gaussians, row: &[f32]) {
    let higher = gaussians.sh_degree.coefficients() - 1;
    let (rest, tail) = row[6..].split_at(3 * higher);
    gaussians.means.push([row[0], row[1], row[2]]);
    gaussians.sh.push([row[3], row[4], row[5]]);
    // Channel by channel in the file, coefficient by coefficient in memory.
    gaussians.sh.extend((0..higher).map(|k| [rest[k], rest[higher + k], rest[2 * higher + k]]));
    gaussians.opacity_logits.push(tail[0]);
    gaussians.log_scales.push([tail[1], tail[2], tail[3]]);
    gaussians.rotations.push([tail[4], tail[5], tail[6], tail[7]]);
}
