//! From splats in space to lists of Gaussians by tile, front to back.

use l4d_splat::gaussians::BadValue;
use l4d_splat::raster::{RasterError, RasterSettings, TILE};
use l4d_splat::splats::Splats;
use l4d_splat::view::View;
use wgpu::Buffer;

use crate::commands::{Commands, groups_of, whole};
use crate::constants::{Depths, SceneConstants};
use crate::device::Gpu;
use crate::error::{Failure, GpuError};
use crate::shaders::{LANES, MOST_TILES, Pass};
use crate::sort::{Entries, bits_of, scan, sort};
use crate::upload::{Piece, Uploaded};

/// What the adapter says if no Gaussian overflows.
const NO_OVERFLOW: u32 = u32::MAX;
pub(crate) const FOOTPRINT_BYTES: u64 = 48;

/// Splats as one view sees them, in the adapter's memory.
#[derive(Debug)]
pub(crate) struct Projection<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) splats: &'a Splats,
    pub(crate) view: View,
    pub(crate) settings: RasterSettings,
    /// Tiles in a row and in a column.
    pub(crate) tiles: [u32; 2],
    pub(crate) constants: Buffer,
    pub(crate) gaussians: Buffer,
    pub(crate) sh: Buffer,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) footprints: Buffer,
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
    footprints: Buffer,
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
        let pieces = uploaded.pieces()?;
        let tiles = [view.width(), view.height()].map(|side| side.div_ceil(TILE as u32));
        let tile_count = tiles[0] * tiles[1];
        if tile_count > MOST_TILES {
            let (needs, has) = (tile_count.into(), MOST_TILES.into());
            return Err(GpuError::TooLarge { what: "a picture", needs, limit: "number of tiles", has }.into());
        }
        let count = splats.len() as u32;

        let mut commands = gpu.commands();
        let projected = project(&mut commands, uploaded, &pieces, view, settings)?;
        let order = sort(&mut commands, projected.entries, count, projected.key_bits)?.values;
        let offsets = gpu.buffer("offsets of pairs", 4 * (u64::from(count) + 1))?;
        commands.run(
            Pass::Count,
            groups_of(u64::from(count) + 1, LANES),
            &[count, 0, 0, 0],
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
            &[count, tiles[0], 0, 0],
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
            &[pair_count, 0, 0, 0],
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
            tiles,
            constants: projected.constants,
            gaussians: uploaded.gaussians.clone(),
            sh: uploaded.sh.clone(),
            pieces,
            footprints: projected.footprints,
            order,
            offsets,
            pairs: sorted.values,
            pair_count,
            owners,
            bounds,
            ranges,
        })
    }
}

fn project(
    commands: &mut Commands<'_>,
    uploaded: &Uploaded<'_>,
    pieces: &[Piece],
    view: &View,
    settings: &RasterSettings,
) -> Result<ProjectedGaussians, GpuError> {
    let (gpu, splats) = (uploaded.gpu, uploaded.splats);
    let count = splats.len() as u64;
    let depths = Depths::new(view, settings, splats);
    let constants = gpu.uniform("scene", &[SceneConstants::new(view, settings, splats, &depths)])?;
    let metres = gpu.filled("depths", &depths.metres)?;
    let footprints = gpu.buffer("footprints", FOOTPRINT_BYTES * count)?;
    let rects = gpu.buffer("tiles of Gaussians", 8 * count)?;
    let overflow = gpu.filled("overflow", &[NO_OVERFLOW])?;
    let entries = Entries::new(commands, "order of Gaussians", count as u32)?;
    for run in pieces {
        commands.run(
            Pass::Project,
            groups_of(run.len(), LANES),
            &run.part(),
            &[
                whole(&constants),
                whole(&uploaded.gaussians),
                run.of_sh(&uploaded.sh),
                whole(&metres),
                whole(&footprints),
                whole(&rects),
                whole(&entries.keys),
                whole(&entries.values),
                whole(&overflow),
            ],
        )?;
    }
    Ok(ProjectedGaussians { constants, footprints, rects, overflow, entries, key_bits: depths.key_bits() })
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
