//! A picture in bands of whole rows of tiles, each small enough for the adapter.

use l4d_splat::raster::TILE;
use wgpu::{BindingResource, Buffer};

use crate::commands::{Commands, whole};
use crate::error::GpuError;
use crate::projection::Projection;
use crate::shaders::{Pass, WINDOW};

/// Bytes that pixels take on their way in and out: eight floats.
pub(crate) const PIXEL_BYTES: u64 = 32;

/// Rows of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Band {
    first_tile: u32,
    end_tile: u32,
    /// Pixels, counted row by row from the top.
    pub(crate) first_pixel: usize,
    pub(crate) end_pixel: usize,
}

impl Band {
    pub(crate) fn pixels(&self) -> u64 {
        (self.end_pixel - self.first_pixel) as u64
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.pixels() * PIXEL_BYTES
    }

    /// The band that holds a tile, as one of its own.
    fn of_tile(tile: u32) -> Self {
        Self { first_tile: tile, end_tile: tile + 1, first_pixel: 0, end_pixel: 0 }
    }
}

/// Bands of a picture of `width` x `height` pixels, none of which takes more than `room` bytes.
fn bands(width: u32, height: u32, limits: u64) -> Result<Vec<Band>, GpuError> {
    let side = TILE as u32;
    let (columns, rows) = (width.div_ceil(side), height.div_ceil(side));
    let row_bytes = u64::from(side) * u64::from(width) * PIXEL_BYTES;
    let most = (limits / row_bytes).min(u64::from(rows)) as u32;
    if most == 0 {
        let limit = "max_storage_buffer_binding_size";
        return Err(GpuError::TooLarge { what: "a row of tiles", needs: row_bytes, limit, has: limits });
    }
    let pixel_at = |row: u32| (row * side).min(height) as usize * width as usize;
    let band = |first: u32| {
        let end = rows.min(first + most);
        Band {
            first_tile: first * columns,
            end_tile: end * columns,
            first_pixel: pixel_at(first),
            end_pixel: pixel_at(end),
        }
    };
    Ok((0..rows).step_by(most as usize).map(band).collect())
}

impl Projection<'_> {
    pub(crate) fn bands(&self) -> Result<Vec<Band>, GpuError> {
        bands(self.view.width(), self.view.height(), self.gpu.limits.binding)
    }

    /// BufferLimits for the transmittance of a band's pixels, which goes from one window to the next.
    pub(crate) fn transmittances(&self, band: Band) -> Result<Buffer, GpuError> {
        self.gpu.buffer("transmittance", 4 * band.pixels())
    }

    /// Runs a pass over the Gaussians of the tiles of a band, window by window. `pairs` are those whose sums it
    /// keeps.
    pub(crate) fn over_tiles(
        &self,
        commands: &mut Commands<'_>,
        pass: Pass,
        band: Band,
        pairs: [u32; 2],
        own: &[&Buffer],
    ) -> Result<(), GpuError> {
        let bindings: Vec<BindingResource<'_>> =
            [&self.constants, &self.bounds, &self.pairs, &self.owners, &self.footprints]
                .into_iter()
                .chain(own.iter().copied())
                .map(whole)
                .collect();
        let tiles = band.first_tile as usize..band.end_tile as usize;
        let longest = self.ranges[tiles.clone()].iter().map(|[first, end]| end - first).max().unwrap_or(0);
        // One window even without Gaussians: it leaves the pixels as they are then.
        for first in (0..longest.max(1)).step_by(WINDOW as usize) {
            let window = [first, first.saturating_add(WINDOW)];
            let part = [band.first_tile, band.end_tile, pairs[0], pairs[1], window[0], window[1], 0, 0];
            commands.run(pass, tiles.len() as u64, &part, &bindings)?;
        }
        Ok(())
    }

    /// Runs a pass over the Gaussians of one tile, in one lane; the part names a pixel in place of pairs.
    pub(crate) fn over_tile(
        &self,
        commands: &mut Commands<'_>,
        pass: Pass,
        pixel: [u32; 2],
        own: &Buffer,
    ) -> Result<(), GpuError> {
        let tile = self.tile_of(pixel);
        // Pixels count from the start of the tile's row of tiles.
        let transmittances =
            self.gpu.buffer("transmittance", 4 * u64::from(self.view.width()) * TILE as u64)?;
        self.over_tiles(commands, pass, Band::of_tile(tile), pixel, &[&transmittances, own])
    }

    /// The tile in which a pixel lies.
    pub(crate) fn tile_of(&self, [column, row]: [u32; 2]) -> u32 {
        row / TILE as u32 * self.tiles[0] + column / TILE as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_the_picture_once() {
        // 40 x 50 pixels are 3 x 4 tiles; a row of tiles takes 16 * 40 * 32 bytes.
        let row = 16 * 40 * PIXEL_BYTES;
        for (limits, count) in [(row, 4), (2 * row, 2), (3 * row + 1, 2), (100 * row, 1)] {
            let bands = bands(40, 50, limits).unwrap();
            assert_eq!(bands.len(), count);
            assert_eq!((bands[0].first_tile, bands[0].first_pixel), (0, 0));
            assert!(bands.windows(2).all(|two| {
                two[0].end_tile == two[1].first_tile && two[0].end_pixel == two[1].first_pixel
            }));
            let last = bands[count - 1];
            assert_eq!((last.end_tile, last.end_pixel), (12, 2000));
            assert!(bands.iter().all(|band| band.bytes() <= limits));
        }
        assert!(bands(40, 50, row - 1).unwrap_err().to_string().contains("max_storage_buffer_binding_size"));
    }
}
