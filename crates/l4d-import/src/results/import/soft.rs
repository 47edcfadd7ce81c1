//! Relevancy beside masks: `soft/`, one grey picture a query and frame, for `l4d score --sweep`.
//!
//! Maps are too many to be kept until it is known whether anything is wrong. They are written to a folder beside that of
//! the method as they come, which takes its place with the masks, or goes.

use std::fs;
use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::store::{make_folder, remove_folder};
use l4d_data::{DataError, Name, QueryId};
use l4d_masks::mask::nearest;
use l4d_masks::png;

/// Relevancy on its way into results; what has not been put in place is removed with it.
#[derive(Debug)]
pub struct SoftStage {
    dir: ResultsDir,
}

impl SoftStage {
    /// An empty stage for a method below a folder of methods. What a killed import left is removed.
    ///
    /// # Errors
    /// A folder that cannot be removed.
    pub fn open(results: &Path, name: &Name) -> Result<Self, DataError> {
        // No list of methods shows what begins with a dot.
        let dir = ResultsDir::new(results.join(format!(".{name}.soft")));
        remove_folder(dir.root())?;
        Ok(Self { dir })
    }

    /// Keeps the map of a query in a frame, as PNG.
    pub(super) fn keep(&self, query: &QueryId, frame: u32, picture: &[u8]) -> Result<(), DataError> {
        make_folder(&self.dir.soft_folder(query))?;
        let path = self.dir.soft_png(query, frame);
        fs::write(&path, picture).map_err(|source| DataError::io(&path, "write", source))
    }

    /// Moves all maps into the results of a method, which have none.
    pub(super) fn put(&self, results: &ResultsDir) -> Result<(), DataError> {
        let soft = self.dir.soft();
        if !soft.exists() {
            return Ok(());
        }
        fs::rename(&soft, results.soft()).map_err(|source| DataError::io(&results.soft(), "create", source))
    }
}

impl Drop for SoftStage {
    fn drop(&mut self) {
        // The next import removes what cannot be removed now.
        let _ = remove_folder(self.dir.root());
    }
}

/// A map as PNG at the size of the profile; the nearest pixel where it has another, as for masks.
pub(super) fn picture(map: &[u8], size: (u32, u32), wanted: (u32, u32)) -> Vec<u8> {
    let row = |row: u32| &map[(nearest(row, size.1, wanted.1) * size.0) as usize..][..size.0 as usize];
    let values: Vec<u8> = (0..wanted.1)
        .flat_map(|at| (0..wanted.0).map(move |col| row(at)[nearest(col, size.0, wanted.0) as usize]))
        .collect();
    png::encode_grey(&values, wanted.0, wanted.1)
}

#[cfg(test)]
mod tests {
    use l4d_masks::Mask;

    use super::*;

    #[test]
    fn maps_are_resized_as_masks_are() {
        let map: Vec<u8> = (0..35).map(|index| index * 7).collect();
        let cut = |map: &[u8], width: u32, height: u32| {
            Mask::from_fn(width, height, |col, row| map[(row * width + col) as usize] > 99)
        };
        for wanted in [(7, 5), (14, 10), (3, 2), (21, 15)] {
            let resized = png::decode_grey(&picture(&map, (7, 5), wanted), wanted.0, wanted.1).unwrap();
            assert_eq!(
                cut(&resized, wanted.0, wanted.1),
                cut(&map, 7, 5).resized_nearest(wanted.0, wanted.1)
            );
        }
    }
}
