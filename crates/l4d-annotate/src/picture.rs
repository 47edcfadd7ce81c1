//! What is asked of the painter and what comes back.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::UVec2;
use l4d_data::Name;
use l4d_masks::mask::PixelBox;
use ratatui::buffer::Cell;
use ratatui::layout::{Position, Size};
use ratatui_image::protocol::Protocol;

/// A part of a picture, for so many cells.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct PictureRequest {
    pub(crate) scene: Name,
    pub(crate) view: Name,
    /// Canonical frame.
    pub(crate) frame: u32,
    /// Shown pixels.
    pub(crate) region: PixelBox,
    /// Columns and rows on the screen.
    pub(crate) cells: Size,
    /// Ids of the objects that stand out.
    pub(crate) chosen: BTreeSet<u32>,
    /// Whether objects have outlines and numbers.
    pub(crate) outlines: bool,
}

/// A whole picture with outlines and numbers, for a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ExportRequest {
    pub(crate) scene: Name,
    pub(crate) view: Name,
    /// Canonical frame.
    pub(crate) frame: u32,
    /// Ids of the objects that stand out.
    pub(crate) chosen: BTreeSet<u32>,
    /// Name of the file, without folder.
    pub(crate) file_name: String,
}

/// The ids of a whole picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Ids {
    /// Columns and rows.
    pub(crate) size: UVec2,
    /// Row-major.
    pub(crate) ids: Vec<u32>,
}

/// A number on the screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Label {
    pub(crate) number: usize,
    pub(crate) id: u32,
    /// Cell of its middle, relative to the picture.
    pub(crate) at: Position,
}

/// How a picture is put on the screen.
pub(crate) enum Art {
    /// Characters, row by row; the numbers are written over them.
    Cells {
        /// Row-major.
        cells: Vec<Cell>,
        labels: Vec<Label>,
    },
    /// Pixels, by the terminal's own means; the numbers are part of them.
    Pixels(Box<Protocol>),
}

#[derive(Debug)]
pub(crate) struct Picture {
    pub(crate) request: PictureRequest,
    /// The whole picture's ids: which objects can be seen, and where.
    pub(crate) source: Arc<Ids>,
    pub(crate) art: Art,
}

impl std::fmt::Debug for Art {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Cells { cells, labels } => write!(formatter, "Cells({}, {labels:?})", cells.len()),
            Self::Pixels(_) => write!(formatter, "Pixels"),
        }
    }
}

impl Ids {
    /// Ids that occur in a part of the picture.
    pub(crate) fn visible(&self, region: PixelBox) -> BTreeSet<u32> {
        self.rows(region).flatten().copied().filter(|&id| id != 0).collect()
    }

    /// Box around all pixels of some ids.
    pub(crate) fn box_around(&self, ids: &BTreeSet<u32>) -> Option<PixelBox> {
        let pixels = || {
            let places = self.ids.iter().enumerate().filter(|(_, id)| ids.contains(id));
            places.map(|(index, _)| UVec2::new(index as u32 % self.size.x, index as u32 / self.size.x))
        };
        let first = pixels().reduce(UVec2::min)?;
        let last = pixels().reduce(UVec2::max)?;
        Some(PixelBox { first_col: first.x, first_row: first.y, last_col: last.x, last_row: last.y })
    }

    fn rows(&self, region: PixelBox) -> impl Iterator<Item = &[u32]> {
        let last_col = region.last_col.min(self.size.x - 1) as usize;
        let first_col = (region.first_col as usize).min(last_col);
        let rows = region.first_row..=region.last_row.min(self.size.y - 1);
        rows.map(move |row| {
            let start = row as usize * self.size.x as usize;
            &self.ids[start + first_col..=start + last_col]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids() -> Ids {
        Ids { size: UVec2::new(4, 2), ids: vec![0, 7, 7, 0, 0, 7, 8, 8] }
    }

    #[test]
    fn boxes_and_counts_are_those_of_the_pixels() {
        let all = PixelBox { first_col: 0, first_row: 0, last_col: 99, last_row: 99 };
        assert_eq!(ids().visible(all), [7, 8].into());
        let eight = PixelBox { first_col: 2, first_row: 1, last_col: 3, last_row: 1 };
        assert_eq!(ids().box_around(&[8].into()), Some(eight));
        assert_eq!(ids().box_around(&[9].into()), None);
    }
}
