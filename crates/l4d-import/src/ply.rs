//! Points with a colour as PLY: binary little endian, with the normals that 3DGS readers ask for.

use glam::DVec3;

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColouredPoint {
    /// World, metres.
    pub position: DVec3,
    /// Display colour.
    pub rgb: [u8; 3],
}

/// The bytes of a PLY file. Normals are zero: nobody reads them, and readers fail without.
pub fn encode(points: &[ColouredPoint]) -> Vec<u8> {
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", points.len());
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        header.push_str(&format!("property float {name}\n"));
    }
    for name in ["red", "green", "blue"] {
        header.push_str(&format!("property uchar {name}\n"));
    }
    header.push_str("end_header\n");
    let mut bytes = header.into_bytes();
    for point in points {
        for value in point.position.to_array().into_iter().chain([0.0; 3]) {
            bytes.extend((value as f32).to_le_bytes());
        }
        bytes.extend(point.rgb);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_27_bytes_after_the_header() {
        let point = ColouredPoint { position: DVec3::new(1.0, -2.0, 0.5), rgb: [1, 2, 255] };
        let bytes = encode(&[point, point]);
        let header = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        assert_eq!(bytes.len() - header, 2 * 27);
        assert_eq!(bytes[header..header + 4], 1.0_f32.to_le_bytes());
        assert_eq!(bytes[header + 24..header + 27], [1, 2, 255]);
    }
}
