//! What is asked of the painter and what comes back.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::UVec2;
use l4d_data::Name;
use l4d_masks::mask::PixelBox;
use ratatui::layout::{Position, Size};
use ratatui_image::protocol::Protocol;

/// A part of a picture, for so many cells.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct PictureRequest {
    /// Scene.
    pub(crate) scene: Name,
    /// View.
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
    /// Scene.
    pub(crate) scene: Name,
    /// View.
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
    /// The number.
    pub(crate) number: usize,
    /// Its id.
    pub(crate) id: u32,
    /// Cell of its middle, relative to the picture.
    pub(crate) at: Position,
}

/// A cell of a picture that is made of characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ArtCell {
    /// Character.
    pub(crate) symbol: char,
    /// Its colour; none leaves the terminal's own.
    pub(crate) ink: Option<[u8; 3]>,
    /// Colour behind it; none leaves the terminal's own.
    pub(crate) paper: Option<[u8; 3]>,
}

/// How a picture is put on the screen.
pub(crate) enum Art {
    /// Characters, row by row; the numbers are written over them.
    Cells {
        /// Row-major.
        cells: Vec<ArtCell>,
        /// Where numbers go.
        labels: Vec<Label>,
    },
    /// Pixels, by the terminal's own means; the numbers are part of them.
    Pixels(Box<Protocol>),
}

/// A painted picture.
#[derive(Debug)]
pub(crate) struct Picture {
    /// What was asked.
    pub(crate) request: PictureRequest,
    /// The whole picture's ids: what a click hits, and which objects can be seen.
    pub(crate) source: Arc<Ids>,
    /// What to draw.
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

    /// The id among `candidates` with most pixels in a part of the picture.
    pub(crate) fn most_frequent(&self, region: PixelBox, candidates: &BTreeSet<u32>) -> Option<u32> {
        let count = |id: u32| self.rows(region).flatten().filter(|&&other| other == id).count();
        let counts = candidates.iter().map(|&id| (count(id), id)).filter(|(count, _)| *count > 0);
        counts.max_by_key(|&(count, id)| (count, std::cmp::Reverse(id))).map(|(_, id)| id)
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

impl Picture {
    /// The part of the whole picture that a cell shows.
    pub(crate) fn under_cell(&self, column: u16, row: u16) -> PixelBox {
        let region = self.request.region;
        let cells = self.request.cells;
        let along = |first: u32, last: u32, cell: u16, count: u16| {
            let extent = u64::from(last - first + 1);
            let edge = |cell: u64| first + (cell * extent / u64::from(count.max(1))) as u32;
            let start = edge(u64::from(cell)).min(last);
            (start, edge(u64::from(cell) + 1).saturating_sub(1).clamp(start, last))
        };
        let (first_col, last_col) = along(region.first_col, region.last_col, column, cells.width);
        let (first_row, last_row) = along(region.first_row, region.last_row, row, cells.height);
        PixelBox { first_col, first_row, last_col, last_row }
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
        assert_eq!(ids().most_frequent(all, &[7, 8].into()), Some(7));
        assert_eq!(ids().most_frequent(eight, &[7, 8].into()), Some(8));
        assert_eq!(ids().most_frequent(eight, &[7].into()), None);
    }
}
