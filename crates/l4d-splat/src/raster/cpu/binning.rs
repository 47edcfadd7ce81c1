//! Depth sort, and the lists of Gaussians by tile.

use std::ops::Range;

use rayon::prelude::*;

use super::Cpu;
use super::blend::Limits;
use super::pixel_mask::PixelMask;
use super::project_simd::Project;
use super::projection::{Projection, Splat2d};
use crate::gaussians::BadValue;
use crate::raster::{RasterError, TILE};
use crate::splats::Splats;
use crate::view::View;

/// Gaussians projected by one task.
const CHUNK: usize = 512;
/// Pairs of a tile and a Gaussian that one picture may have: 2 GiB of lists.
const MOST_PAIRS: u64 = 1 << 29;
/// Pairs whose sums are held at once.
const BATCH: usize = 1 << 20;

/// The visible Gaussians by depth; equal depths in the order of their indices.
pub(super) fn front_to_back(
    cpu: Cpu,
    projection: &Projection,
    splats: &Splats,
    mask: &PixelMask,
) -> Result<Vec<Splat2d>, RasterError> {
    let chunks: Vec<Result<Vec<Splat2d>, BadValue>> = (0..splats.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let first = chunk * CHUNK;
            let count = CHUNK.min(splats.len() - first);
            let mut splats2d = cpu.run(Project { projection, splats, first, count })?;
            splats2d.retain(|splat2d| mask.may_cover(splat2d));
            Ok(splats2d)
        })
        .collect();
    // Chunks come in order, so the first error is that of the lowest index, whatever thread met it.
    let chunks = chunks.into_iter().collect::<Result<Vec<_>, _>>().map_err(RasterError::Overflow)?;
    let mut keys = Vec::with_capacity(chunks.iter().map(Vec::len).sum());
    for (chunk, splats2d) in chunks.iter().enumerate() {
        keys.extend(splats2d.iter().enumerate().map(|(position, splat2d)| {
            // Depths are positive, so their bits are in their order.
            (splat2d.depth.to_bits(), (chunk * CHUNK + position) as u32)
        }));
    }
    // The place breaks ties, so that an unstable sort is deterministic.
    keys.par_sort_unstable();
    Ok(keys
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(|(_, place)| chunks[place as usize / CHUNK][place as usize % CHUNK].clone())
        .collect())
}

/// For each tile the Gaussians that may leave a trace in it, front to back.
#[derive(Debug)]
pub(super) struct TileBins {
    /// Tiles in a row.
    pub(super) columns: usize,
    /// Tile t owns `ranks[offsets[t]..offsets[t + 1]]`; tiles row-major.
    offsets: Vec<u32>,
    /// Positions in front-to-back order.
    ranks: Vec<u32>,
}

/// Tiles of one row that a Gaussian touches.
struct TileSpan {
    rank: u32,
    row: u16,
    columns: [u16; 2],
}

impl TileBins {
    pub(super) fn new(
        splats2d: &[Splat2d],
        limits: &Limits,
        mask: &PixelMask,
        view: &View,
    ) -> Result<Self, RasterError> {
        let columns = (view.width() as usize).div_ceil(TILE);
        let rows = (view.height() as usize).div_ceil(TILE);
        let spans: Vec<Vec<TileSpan>> = splats2d
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, splats2d)| {
                let mut spans = Vec::with_capacity(2 * splats2d.len());
                for (position, splat2d) in splats2d.iter().enumerate() {
                    touched((chunk * CHUNK + position) as u32, splat2d, limits, &mut spans);
                }
                spans
            })
            .collect();
        let pairs: u64 =
            spans.iter().flatten().map(|span| u64::from(span.columns[1] - span.columns[0])).sum();
        if pairs > MOST_PAIRS {
            return Err(RasterError::Invalid(format!(
                "the splats touch {pairs} tiles in all, at most {MOST_PAIRS} can be drawn: draw a smaller picture or \
                 remove Gaussians that fill it"
            )));
        }
        let mut offsets = vec![0_u32; columns * rows + 1];
        for span in spans.iter().flatten() {
            let first = usize::from(span.row) * columns;
            for column in span.columns[0]..span.columns[1] {
                let tile = first + usize::from(column);
                offsets[tile + 1] += u32::from(mask.has_tile(tile));
            }
        }
        for tile in 1..offsets.len() {
            offsets[tile] += offsets[tile - 1];
        }
        let mut next = offsets.clone();
        let mut ranks = vec![0_u32; offsets[columns * rows] as usize];
        for span in spans.iter().flatten() {
            let first = usize::from(span.row) * columns;
            let tiles = span.columns.map(|column| first + usize::from(column));
            for tile in (tiles[0]..tiles[1]).filter(|&tile| mask.has_tile(tile)) {
                let place = &mut next[tile];
                ranks[*place as usize] = span.rank;
                *place += 1;
            }
        }
        Ok(Self { columns, offsets, ranks })
    }

    /// Number of tiles.
    pub(super) fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Positions in front-to-back order of the Gaussians of a tile.
    pub(super) fn of(&self, tile: usize) -> &[u32] {
        &self.ranks[self.offsets[tile] as usize..self.offsets[tile + 1] as usize]
    }

    /// Upper left pixel of a tile: column, row.
    pub(super) fn origin(&self, tile: usize) -> [usize; 2] {
        [tile % self.columns * TILE, tile / self.columns * TILE]
    }

    /// Sums over tiles of what `fill` writes: it is given a tile and `width` numbers, all 0, for each Gaussian of that
    /// tile. The result has `width` sums for each of `count` Gaussians, always added in the order of the tiles.
    pub(super) fn sums(
        &self,
        width: usize,
        count: usize,
        fill: impl Fn(usize, &mut [f32]) + Sync,
    ) -> Vec<f64> {
        let mut totals = vec![0.0; count * width];
        let mut numbers = Vec::new();
        for tiles in self.batches() {
            let pairs = (self.offsets[tiles.end] - self.offsets[tiles.start]) as usize;
            numbers.clear();
            numbers.resize(pairs * width, 0.0);
            let mut rest = numbers.as_mut_slice();
            let mut apart = Vec::with_capacity(tiles.len());
            for tile in tiles.clone() {
                let (own, others) = std::mem::take(&mut rest).split_at_mut(self.of(tile).len() * width);
                apart.push((tile, own));
                rest = others;
            }
            apart.into_par_iter().for_each(|(tile, own)| fill(tile, own));
            self.add(tiles, &numbers, width, &mut totals);
        }
        totals
    }

    /// Consecutive tiles, so many together that their pairs stay few.
    fn batches(&self) -> Vec<Range<usize>> {
        let mut batches = Vec::new();
        let mut first = 0;
        for tile in 0..self.len() {
            if tile + 1 == self.len() || (self.offsets[tile + 2] - self.offsets[first]) as usize > BATCH {
                batches.push(first..tile + 1);
                first = tile + 1;
            }
        }
        batches
    }

    fn add(&self, tiles: Range<usize>, numbers: &[f32], width: usize, totals: &mut [f64]) {
        let start = self.offsets[tiles.start] as usize;
        // How many Gaussians a task takes does not change the order of the sums.
        let chunk = (totals.len() / width).div_ceil(4 * rayon::current_num_threads()).max(CHUNK);
        totals.par_chunks_mut(chunk * width).enumerate().for_each(|(task, totals)| {
            let first = (task * chunk) as u32;
            for tile in tiles.clone() {
                let ranks = self.of(tile);
                let from = ranks.partition_point(|&rank| rank < first);
                let pairs = self.offsets[tile] as usize - start + from..;
                for (pair, &rank) in pairs.zip(&ranks[from..]) {
                    let place = (rank - first) as usize * width;
                    if place >= totals.len() {
                        break;
                    }
                    for (total, &number) in totals[place..].iter_mut().zip(&numbers[pair * width..][..width])
                    {
                        *total += f64::from(number);
                    }
                }
            }
        });
    }
}

/// Tiles of the square in which the Gaussian is drawn that may also meet the ellipse outside of which its alpha is too
/// small to be blended: exactly those where there are many, those of its bounding box where there are few.
fn touched(rank: u32, splat2d: &Splat2d, limits: &Limits, spans: &mut Vec<TileSpan>) {
    let reach = f64::from(splat2d.log_opacity) + f64::from(limits.span);
    if reach <= 0.0 {
        return;
    }
    let ellipse = Ellipse::new(splat2d, reach);
    let [first_column, end_column, first_row, end_row] = splat2d.tiles;
    let rows = tiles(splat2d.mean[1], [-ellipse.half_height, ellipse.half_height], [first_row, end_row]);
    let columns =
        tiles(splat2d.mean[0], [-ellipse.half_width, ellipse.half_width], [first_column, end_column]);
    let width = columns[1].saturating_sub(columns[0]);
    let few = width <= 2 || rows[1].saturating_sub(rows[0]) <= 2;
    for row in rows[0]..rows[1] {
        let columns = if few {
            columns
        } else {
            let top = f64::from(row) * TILE as f64 - splat2d.mean[1];
            tiles(splat2d.mean[0], ellipse.extent([top, top + TILE as f64 - 1.0]), columns)
        };
        if columns[0] < columns[1] {
            spans.push(TileSpan { rank, row, columns });
        }
    }
}

/// Those of the tiles `within` (first, end) with the centre of a pixel between `extent` from `centre`.
fn tiles(centre: f64, extent: [f64; 2], within: [u16; 2]) -> [u16; 2] {
    let side = TILE as f64;
    // Casts cut off fractions and saturate; the end of an empty range may lie before its start.
    let first = ((centre + extent[0]) / side + 1.0 / side).max(0.0) as u16;
    let end = ((centre + extent[1]) / side + 1.0).max(0.0) as u16;
    [first.max(within[0]), end.min(within[1])]
}

/// u^2 + v^2 <= reach with v = yy dy and u = xx dx + skew v, (dx, dy) being the offset from the centre in pixels.
struct Ellipse {
    reach: f64,
    skew: f64,
    yy: f64,
    /// One over xx.
    per_u: f64,
    half_width: f64,
    half_height: f64,
}

impl Ellipse {
    fn new(splat2d: &Splat2d, reach: f64) -> Self {
        let [xx, xy, yy] = splat2d.conic_factor;
        let (skew, per_u) = (xy / yy, 1.0 / xx);
        Self {
            reach,
            skew,
            yy,
            per_u,
            half_width: (reach * (1.0 + skew * skew)).sqrt() * per_u,
            half_height: reach.sqrt() / yy,
        }
    }

    /// Least and largest dx where dy lies in a range that meets the ellipse.
    fn extent(&self, [top, bottom]: [f64; 2]) -> [f64; 2] {
        let limit = self.half_height * self.yy;
        let (low, high) = ((top * self.yy).max(-limit), (bottom * self.yy).min(limit).max(-limit));
        // The rightmost point of the ellipse has v = -skew tip, the leftmost is opposite.
        let tip = (self.reach / (1.0 + self.skew * self.skew)).sqrt();
        let half = |v: f64| (self.reach - v * v).max(0.0).sqrt();
        let left = (self.skew * tip).max(low).min(high);
        let right = (-self.skew * tip).max(low).min(high);
        [(-half(left) - self.skew * left) * self.per_u, (half(right) - self.skew * right) * self.per_u]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Gaussian whose alpha is large enough to be blended where u^2 + v^2 <= 6.25.
    fn splat2d(mean: [f64; 2], conic_factor: [f64; 3]) -> (Splat2d, Limits) {
        let limits = Limits { alpha_min: 0.0, alpha_max: 1.0, transmittance_min: 0.0, span: 6.25 };
        let tiles = [0, 40, 0, 30];
        let splat2d = Splat2d {
            mean,
            conic_factor,
            log_opacity: 0.0,
            colour: [0.0; 3],
            depth: 1.0,
            index: 0,
            radius: 1e3,
            tiles,
        };
        (splat2d, limits)
    }

    #[test]
    fn no_tile_is_missed_and_of_many_none_is_listed_in_vain() {
        let shapes = [
            ([100.3, 200.7], [0.05, 0.02, 0.03]),
            ([320.0, 240.0], [0.8, -0.6, 0.004]),
            ([-30.0, 500.0], [0.01, 0.004, 0.02]),
            ([15.5, 15.5], [1.0, 0.0, 1.0]),
            ([630.0, 2.0], [0.02, 0.7, 0.7]),
        ];
        for (mean, conic_factor) in shapes {
            let (splat2d, limits) = splat2d(mean, conic_factor);
            let mut spans = Vec::new();
            touched(0, &splat2d, &limits, &mut spans);
            let listed = |column: u16, row: u16| {
                spans.iter().any(|s| s.row == row && (s.columns[0]..s.columns[1]).contains(&column))
            };
            let [xx, xy, yy] = conic_factor;
            for row in 0..30_u16 {
                for column in 0..40_u16 {
                    let inside = (0..256).any(|pixel| {
                        let dx = f64::from(column * 16 + pixel % 16) - mean[0];
                        let dy = f64::from(row * 16 + pixel / 16) - mean[1];
                        let (u, v) = (xx * dx + xy * dy, yy * dy);
                        u * u + v * v <= 6.25
                    });
                    assert!(!inside || listed(column, row), "{mean:?} misses {column} {row}");
                }
            }
            // Lines between pixel centres may be touched where no centre is: a few tiles, not a whole box.
            let exact = spans.iter().map(|s| usize::from(s.columns[1] - s.columns[0])).sum::<usize>();
            assert!(conic_factor != [0.8, -0.6, 0.004] || exact < 130, "{exact}");
        }
    }

    #[test]
    fn sums_over_tiles_are_those_of_a_plain_loop() {
        // Two tiles with more pairs than a batch holds, and one small one.
        let many: Vec<u32> = (0..BATCH as u32 - 5).collect();
        let lists = [many.clone(), vec![3, 7], many, vec![]];
        let mut offsets = vec![0];
        for list in &lists {
            offsets.push(offsets.last().unwrap() + list.len() as u32);
        }
        let bins = TileBins { columns: 2, offsets, ranks: lists.concat() };
        assert_eq!(bins.batches(), [0..2, 2..4]);
        let sums = bins.sums(2, BATCH, |tile, numbers| {
            for pair in numbers.as_chunks_mut().0 {
                *pair = [tile as f32, 1.0];
            }
        });
        assert_eq!(sums[2 * 3..2 * 3 + 2], [3.0, 3.0]);
        assert_eq!(sums[2 * 8..2 * 8 + 2], [2.0, 2.0]);
        assert_eq!(sums[2 * (BATCH - 1)..], [0.0, 0.0]);
    }
}
