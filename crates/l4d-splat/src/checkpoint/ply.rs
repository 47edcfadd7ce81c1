//! 3D Gaussians as PLY: the 62 properties of 3DGS, or fewer below degree 3.
//!
//! Read by name, so that order, extra properties and number types may differ; written in the one order that every
//! program reads. The format is so small that parsing it here costs less than steering a general crate: those hand
//! over rows or maps by name where columns are needed, and make room for as many rows as a header claims.

mod header;
mod rows;

use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::{read_bounded, write_atomic};

use crate::checkpoint::fault::{Fault, quoted};
use crate::checkpoint::{MAX_BYTES, REMEDY_NOT_FINITE, check_gaussians};
use crate::gaussians::{Gaussians, ShDegree};
use header::{Element, Header, Scalar};
use rows::Column;

const REMEDY_FOREIGN: &str =
    "export the model as the PLY of 3DGS (x, y, z, f_dc_*, f_rest_*, opacity, scale_*, rot_*)";

/// Gaussians that came from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// The raw parameters.
    pub gaussians: Gaussians,
    /// What the file had beside them, or had differently: for people, a sentence each.
    pub notes: Vec<String>,
}

/// Reads a PLY file.
pub fn read(path: &Path) -> Result<Decoded, DataError> {
    decode(&read_bounded(path, MAX_BYTES)?).map_err(|fault| fault.at(path))
}

/// Writes a PLY file, binary little endian.
pub fn write(path: &Path, gaussians: &Gaussians) -> Result<(), DataError> {
    let bytes = encode(gaussians).map_err(|fault| fault.at(path))?;
    write_atomic(path, &bytes)
}

/// Gaussians from the bytes of a PLY file: ascii or binary, `float` or `double`.
///
/// Refuses lists, other than 0, 9, 24 or 45 `f_rest_*`, sizes that are not the file's, and values that are not finite.
pub fn decode(bytes: &[u8]) -> Result<Decoded, Fault> {
    let header = Header::parse(bytes)?;
    let vertex = header.elements.iter().find(|element| element.name == "vertex").ok_or_else(|| {
        Fault::new("header", "has no element `vertex`, in which Gaussians are stored", REMEDY_FOREIGN)
    })?;
    let degree = degree_of(vertex)?;
    let columns = columns_of(vertex, degree)?;
    let notes = notes_of(&header, vertex, &columns);

    let mut gaussians = Gaussians { sh_degree: degree, ..Gaussians::default() };
    rows::check_size(&header, bytes)?;
    reserve(&mut gaussians, vertex.count);
    rows::read(&header, bytes, &columns, |index, row| {
        if let Some((value, column)) = row.iter().zip(&columns).find(|(value, _)| !value.is_finite()) {
            return Err(Fault::new(
                format!("Gaussian {index}, property `{}`", column.name),
                format!("is {value}, but parameters are finite"),
                REMEDY_NOT_FINITE,
            ));
        }
        push(&mut gaussians, row);
        Ok(())
    })?;
    Ok(Decoded { gaussians, notes })
}

/// Gaussians as the bytes of a PLY file: binary little endian, normals zero, the properties in the order of 3DGS.
///
/// Refuses lists of different lengths and values that are not finite.
pub fn encode(gaussians: &Gaussians) -> Result<Vec<u8>, Fault> {
    check_gaussians(gaussians)?;
    let names = written_names(gaussians.sh_degree);
    let mut file = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", gaussians.len());
    for name in &names {
        file.push_str("property float ");
        file.push_str(name);
        file.push('\n');
    }
    file.push_str("end_header\n");

    let mut bytes = file.into_bytes();
    bytes.reserve_exact(gaussians.len() * names.len() * size_of::<f32>());
    let mut put = |value: f32| bytes.extend_from_slice(&value.to_le_bytes());
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
    Ok(bytes)
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

fn written_names(degree: ShDegree) -> Vec<String> {
    let mut names = parameter_names(degree);
    names.splice(3..3, NORMALS.map(str::to_owned));
    names
}

/// Every 3DGS file has them, and they are always zero.
const NORMALS: [&str; 3] = ["nx", "ny", "nz"];

fn degree_of(vertex: &Element) -> Result<ShDegree, Fault> {
    let rest = vertex.properties.iter().filter(|property| property.name.starts_with("f_rest_")).count();
    (0..=ShDegree::MAX.get())
        .filter_map(ShDegree::new)
        .find(|degree| 3 * (degree.coefficients() - 1) == rest)
        .ok_or_else(|| {
            Fault::new(
                "header, properties `f_rest_*`",
                format!("are {rest}, but degrees 0 to 3 of the harmonics have 0, 9, 24 or 45"),
                REMEDY_FOREIGN,
            )
        })
}

fn columns_of(vertex: &Element, degree: ShDegree) -> Result<Vec<Column>, Fault> {
    let find = |name: String| {
        let mut offset = 0;
        for (word, property) in vertex.properties.iter().enumerate() {
            let scalar = property.scalar;
            if property.name != name {
                offset += scalar.size();
                continue;
            }
            if matches!(scalar, Scalar::F32 | Scalar::F64) {
                return Ok(Column { name, offset, word, scalar });
            }
            return Err(Fault::new(
                format!("header, property `{name}`"),
                format!("is of type `{}`, but parameters are `float` or `double`", scalar.name()),
                REMEDY_FOREIGN,
            ));
        }
        Err(Fault::new(format!("header, property `{name}`"), "is missing", REMEDY_FOREIGN))
    };
    parameter_names(degree).into_iter().map(find).collect()
}

fn notes_of(header: &Header, vertex: &Element, columns: &[Column]) -> Vec<String> {
    let listed = |what: &str, names: Vec<&str>| {
        let shown: Vec<String> = names.iter().take(8).map(|name| quoted(name)).collect();
        let more = if names.len() > shown.len() { " and more" } else { "" };
        (!names.is_empty()).then(|| format!("{what}: {}{more}", shown.join(", ")))
    };
    let known = |name: &str| NORMALS.contains(&name) || columns.iter().any(|column| column.name == name);
    let extra = vertex.properties.iter().map(|property| property.name.as_str()).filter(|name| !known(name));
    let others = header.elements.iter().map(|element| element.name.as_str()).filter(|name| *name != "vertex");
    let narrowed =
        columns.iter().filter(|column| column.scalar == Scalar::F64).map(|column| column.name.as_str());
    [
        listed("ignored properties", extra.collect()),
        listed("ignored elements", others.collect()),
        listed("rounded from double to float", narrowed.collect()),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn reserve(gaussians: &mut Gaussians, count: usize) {
    gaussians.means.reserve_exact(count);
    gaussians.log_scales.reserve_exact(count);
    gaussians.rotations.reserve_exact(count);
    gaussians.opacity_logits.reserve_exact(count);
    gaussians.sh.reserve_exact(count * gaussians.sh_degree.coefficients());
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
