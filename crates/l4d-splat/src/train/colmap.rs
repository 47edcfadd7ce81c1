//! The sparse points of a COLMAP model as a start of training.

use std::path::Path;

use l4d_data::DataError;
use l4d_formats::colmap;

use super::views::unit;

const HINT: &str = "give the points3D.txt or points3D.bin of a COLMAP model";

/// Position (metres) and display colour (0 to 1).
pub(crate) type ColouredPoint = ([f32; 3], [f32; 3]);

/// Positions (metres) and display colours (0 to 1) in `points3D.txt` or `points3D.bin`; the name says which.
pub(crate) fn read_points(path: &Path) -> Result<Vec<ColouredPoint>, DataError> {
    let points = colmap::read_points(path)?;
    if points.is_empty() {
        return Err(DataError::invalid(path, "points", "there are none", HINT));
    }
    let point = |point: colmap::ModelPoint| {
        let position = point.position.as_vec3();
        if position.is_finite() {
            return Ok((position.to_array(), point.rgb.map(unit)));
        }
        let place = format!("point {}", point.id);
        Err(DataError::invalid(path, place, format!("is at {position}"), HINT))
    };
    points.into_iter().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_places_and_colours() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points3D.txt");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_points(&path).map_err(|error| error.to_string())
        };
        let points =
            read("# 3D point list\n1 1 2 3 255 0 51 0.5 1 2 3 4\n\n9 4.0 5 6 255 0 51 0.5\n").unwrap();
        assert_eq!(points, [([1.0, 2.0, 3.0], [1.0, 0.0, 0.2]), ([4.0, 5.0, 6.0], [1.0, 0.0, 0.2])]);
        for (text, said) in [
            ("", "there are none"),
            ("1 2 3", "field `z`: is missing"),
            ("1 2 3 x 0 0 0 0", "field `z`: `x` is no such number"),
            ("1 2 3 4 0 300 0 0", "field `green`: `300` is no such number"),
            ("1 inf 3 4 0 0 0 0", "point 1: is at [inf, 3, 4]"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}
