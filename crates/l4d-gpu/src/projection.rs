//! From splats in space to lists of Gaussians by tile, front to back.

use l4d_splat::gaussians::BadValue;
use l4d_splat::raster::{RasterError, RasterSettings, TILE};
use l4d_splat::splats::Splats;
use l4d_splat::view::View;
use wgpu::{BindingResource, Buffer};

use crate::commands::{Commands, groups_of, whole};
use crate::constants::{Depths, SceneConstants};
use crate::device::Gpu;
use crate::error::{Failure, GpuError};
use crate::shaders::{LANES, MOST_TILES, Pass, WINDOW};
use crate::sort::{Entries, bits_of, scan, sort};
use crate::upload::Uploaded;

/// What the adapter says if no Gaussian overflows.
const NO_OVERFLOW: u32 = u32::MAX;
const SPLAT2D_BYTES: u64 = 48;
/// Bytes that a pixel takes on its way in and out: eight floats.
pub(crate) const PIXEL_BYTES: u64 = 32;

/// Splats as one view sees them, in the adapter's memory.
#[derive(Debug)]
pub(crate) struct Projection<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) splats: &'a Splats,
    pub(crate) view: View,
    pub(crate) settings: RasterSettings,
    pub(crate) constants: Buffer,
    pub(crate) gaussians: Buffer,
    pub(crate) sh: Buffer,
    pub(crate) splats2d: Buffer,
    /// Gaussians front to back, and where the pairs of each start; one more offset ends the last.
    pub(crate) order: Buffer,
    pub(crate) offsets: Buffer,
    /// Pairs of tile and Gaussian: by tile, and front to back in each.
    pub(crate) pairs: Buffer,
    pub(crate) pair_count: u32,
    /// The Gaussian of each pair.
    pub(crate) owners: Buffer,
    /// Of each tile the first and the end of its pairs: there, and here.
    pub(crate) bounds: Buffer,
    pub(crate) ranges: Vec<[u32; 2]>,
}

/// Gaussians on the picture plane, not yet assigned to tiles.
struct ProjectedGaussians {
    constants: Buffer,
    splats2d: Buffer,
    rects: Buffer,
    overflow: Buffer,
    entries: Entries,
    key_bits: u32,
}

impl<'a> Projection<'a> {
    pub(crate) fn new(
        uploaded: &Uploaded<'a>,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<Self, Failure> {
        let (gpu, splats) = (uploaded.gpu, uploaded.splats);
        let tiles = [view.width(), view.height()].map(|side| side.div_ceil(TILE as u32));
        let tile_count = tiles[0] * tiles[1];
        if tile_count > MOST_TILES {
            let (needs, has) = (tile_count.into(), MOST_TILES.into());
            return Err(GpuError::TooLarge { what: "a picture", needs, limit: "number of tiles", has }.into());
        }
        let count = splats.len() as u32;

        let mut commands = gpu.commands();
        let projected = project(&mut commands, uploaded, view, settings)?;
        let order = sort(&mut commands, projected.entries, count, projected.key_bits)?.values;
        let offsets = gpu.buffer("offsets of pairs", 4 * (u64::from(count) + 1))?;
        commands.run(
            Pass::Count,
            groups_of(u64::from(count) + 1, LANES),
            &[count],
            &[whole(&order), whole(&projected.rects), whole(&offsets)],
        )?;
        scan(&mut commands, &offsets, count + 1)?;
        let total = commands.copy_out(&offsets, 4 * u64::from(count), 4)?;
        let overflow = commands.copy_out(&projected.overflow, 0, 4)?;
        commands.submit();
        let packed: Vec<u32> = gpu.read_back(&overflow)?;
        if let Some(bad) = packed.first().and_then(|&packed| overflowing_value(splats, packed)) {
            return Err(RasterError::Overflow(bad).into());
        }
        let pair_count = gpu.read_back(&total)?.first().copied().unwrap_or(0);

        let mut commands = gpu.commands();
        let entries = Entries::new(&commands, "pairs of tile and Gaussian", pair_count)?;
        let owners = gpu.buffer("owners of pairs", 4 * u64::from(pair_count))?;
        commands.run(
            Pass::Emit,
            groups_of(count.into(), LANES),
            &[count, tiles[0]],
            &[
                whole(&order),
                whole(&projected.rects),
                whole(&offsets),
                whole(&entries.keys),
                whole(&entries.values),
                whole(&owners),
            ],
        )?;
        let sorted = sort(&mut commands, entries, pair_count, bits_of(tile_count - 1))?;
        let bounds = gpu.buffer("bounds of tiles", 8 * u64::from(tile_count))?;
        commands.run(
            Pass::Ranges,
            groups_of(pair_count.into(), LANES),
            &[pair_count],
            &[whole(&sorted.keys), whole(&bounds)],
        )?;
        let ranges = commands.copy_out(&bounds, 0, 8 * u64::from(tile_count))?;
        commands.submit();
        let ranges = gpu.read_back(&ranges)?;

        Ok(Self {
            gpu,
            splats,
            view: *view,
            settings: *settings,
            constants: projected.constants,
            gaussians: uploaded.gaussians.clone(),
            sh: uploaded.sh.clone(),
            splats2d: projected.splats2d,
            order,
            offsets,
            pairs: sorted.values,
            pair_count,
            owners,
            bounds,
            ranges,
        })
    }

    /// Runs a pass over the Gaussians of all tiles, window by window; gives the transmittance that is left of each
    /// pixel, negative where the pixel is finished.
    pub(crate) fn over_tiles(
        &self,
        commands: &mut Commands<'_>,
        pass: Pass,
        own: &[&Buffer],
    ) -> Result<Buffer, GpuError> {
        let left = self.gpu.buffer("transmittance", 4 * self.view.pixel_count() as u64)?;
        let bindings: Vec<BindingResource<'_>> =
            [&self.constants, &self.bounds, &self.pairs, &self.owners, &self.splats2d, &left]
                .into_iter()
                .chain(own.iter().copied())
                .map(whole)
                .collect();
        let longest = self.ranges.iter().map(|[first, end]| end - first).max().unwrap_or(0);
        // One window even without Gaussians: it leaves the pixels as they are then.
        for first in (0..longest.max(1)).step_by(WINDOW as usize) {
            let window = [first, first.saturating_add(WINDOW)];
            commands.run(pass, self.ranges.len() as u64, &window, &bindings)?;
        }
        Ok(left)
    }
}

fn project(
    commands: &mut Commands<'_>,
    uploaded: &Uploaded<'_>,
    view: &View,
    settings: &RasterSettings,
) -> Result<ProjectedGaussians, GpuError> {
    let (gpu, splats) = (uploaded.gpu, uploaded.splats);
    let count = splats.len() as u64;
    let depths = Depths::new(view, settings, splats);
    let constants = gpu.uniform("scene", &[SceneConstants::new(view, settings, splats, &depths)])?;
    let metres = gpu.filled("depths", &depths.metres)?;
    let splats2d = gpu.buffer("splats2d", SPLAT2D_BYTES * count)?;
    let rects = gpu.buffer("tiles of Gaussians", 8 * count)?;
    let overflow = gpu.filled("overflow", &[NO_OVERFLOW])?;
    let entries = Entries::new(commands, "order of Gaussians", count as u32)?;
    commands.run(
        Pass::Project,
        groups_of(count, LANES),
        &[count as u32],
        &[
            whole(&constants),
            whole(&uploaded.gaussians),
            whole(&uploaded.sh),
            whole(&metres),
            whole(&splats2d),
            whole(&rects),
            whole(&entries.keys),
            whole(&entries.values),
            whole(&overflow),
        ],
    )?;
    Ok(ProjectedGaussians { constants, splats2d, rects, overflow, entries, key_bits: depths.key_bits() })
}

/// What `project.wgsl` complains about.
fn overflowing_value(splats: &Splats, overflow: u32) -> Option<BadValue> {
    if overflow == NO_OVERFLOW {
        return None;
    }
    let index = overflow as usize / 4;
    let largest =
        |values: &[f32]| values.iter().copied().fold(0.0, |a: f32, b| if b.abs() > a.abs() { b } else { a });
    let (field, value) = match overflow % 4 {
        0 => ("means", largest(&splats.means()[index])),
        1 => ("scales", largest(&splats.scales()[index])),
        _ => ("sh", largest(splats.sh_of(index).as_flattened())),
    };
    Some(BadValue { field, index, value })
}
