//! One picture in memory: what the ray through each pixel centre hit first, and the light that came from there.
//!
//! Knows nothing of files; [`crate::exr`] reads and writes them.

use half::f16;
use l4d_data::digest::sha256_hex;
use l4d_data::scene::FrameDigest;

/// Depth and instance of each pixel, row-major: never anti-aliased, never denoised.
#[derive(Debug, Clone, PartialEq)]
pub struct Surfaces {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Planar depth (camera z) at the pixel centre, metres; no hit = +inf.
    pub depth_m: Vec<f32>,
    /// Instance id; 0 = nothing annotated.
    pub id: Vec<u32>,
}

/// [`Surfaces`] with the colour that the camera saw.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Depth and ids.
    pub surfaces: Surfaces,
    /// Linear, scene-referred red, green, blue; row-major.
    pub rgb: Vec<[f16; 3]>,
}

impl Surfaces {
    /// A picture in which nothing was hit.
    pub fn empty(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self { width, height, depth_m: vec![f32::INFINITY; pixels], id: vec![0; pixels] }
    }

    /// Index of a pixel in the lists.
    pub fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.width as usize + column as usize
    }

    /// Digests of the decoded arrays, little-endian, as `scene.json` states them.
    pub fn digest(&self) -> FrameDigest {
        let depth_bytes: Vec<u8> = self.depth_m.iter().flat_map(|depth_m| depth_m.to_le_bytes()).collect();
        let id_bytes: Vec<u8> = self.id.iter().flat_map(|id| id.to_le_bytes()).collect();
        FrameDigest { z: sha256_hex(&depth_bytes), id: sha256_hex(&id_bytes) }
    }

    /// Visible pixels of each id that occurs, ascending by id; 0 left out.
    pub fn visible(&self) -> Vec<(u32, u32)> {
        let mut ids: Vec<u32> = self.id.iter().copied().filter(|&id| id != 0).collect();
        ids.sort_unstable();
        ids.chunk_by(|a, b| a == b).map(|run| (run[0], run.len() as u32)).collect()
    }

    /// The first depth that no camera can see, or id where nothing was hit: its place, and what is wrong.
    pub(crate) fn value_problem(&self) -> Option<(String, String)> {
        let bad_depth = |&index: &usize| self.depth_m[index].is_nan() || self.depth_m[index] <= 0.0;
        let bad_id = |&index: &usize| self.id[index] != 0 && self.depth_m[index] == f32::INFINITY;
        let pixels = || 0..self.id.len();
        let (channel, first, message, count) = if let Some(first) = pixels().find(bad_depth) {
            let message =
                format!("depth is {} m, but a depth is positive (no hit = +inf)", self.depth_m[first]);
            ("Z", first, message, pixels().filter(bad_depth).count())
        } else {
            let first = pixels().find(bad_id)?;
            let message = format!("id is {}, but nothing was hit there", self.id[first]);
            ("id", first, message, pixels().filter(bad_id).count())
        };
        let more = if count > 1 { format!("; {count} pixels in all") } else { String::new() };
        let (column, row) = (first as u32 % self.width, first as u32 / self.width);
        Some((format!("channel `{channel}`, column {column}, row {row}"), format!("{message}{more}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> Surfaces {
        Surfaces { width: 2, height: 2, depth_m: vec![1.0, 2.0, f32::INFINITY, 0.5], id: vec![7, 0, 0, 7] }
    }

    #[test]
    fn visible_counts_leave_out_nothing_and_zero() {
        assert_eq!(two_by_two().visible(), [(7, 2)]);
        assert_eq!(Surfaces::empty(3, 2).visible(), []);
    }

    #[test]
    fn every_impossible_depth_is_found_with_its_place() {
        assert_eq!(two_by_two().value_problem(), None);
        for bad in [f32::NAN, 0.0, -0.0, -1.0, f32::NEG_INFINITY] {
            let mut surfaces = two_by_two();
            surfaces.depth_m[3] = bad;
            let (place, message) = surfaces.value_problem().unwrap();
            assert_eq!(place, "channel `Z`, column 1, row 1");
            assert!(
                message.starts_with(&format!("depth is {bad} m")) && !message.contains("in all"),
                "{message}"
            );
        }
    }

    #[test]
    fn an_id_in_the_sky_is_found() {
        let mut surfaces = two_by_two();
        surfaces.id[2] = 3;
        assert_eq!(surfaces.value_problem().unwrap().1, "id is 3, but nothing was hit there");
    }

    #[test]
    fn digests_are_those_of_little_endian_bytes() {
        // python: hashlib.sha256(struct.pack("<f", 1.0)).hexdigest(), and "<I" of 7.
        let one = Surfaces { width: 1, height: 1, depth_m: vec![1.0], id: vec![7] };
        let digest = one.digest();
        assert_eq!(digest.z, sha256_hex(&[0, 0, 0x80, 0x3f]));
        assert_eq!(digest.id, sha256_hex(&[7, 0, 0, 0]));
    }
}
