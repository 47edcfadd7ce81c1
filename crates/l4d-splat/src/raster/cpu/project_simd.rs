//! Gaussians to splats2d, four at a time in f64.

use fearless_simd::{f64x4, prelude::*};

use super::Kernel;
use super::projection::{HALF_LOG2_E, Projection, Splat2d, sh_colour};
use crate::gaussians::BadValue;
use crate::raster::{LARGEST, TILE};
use crate::splats::Splats;

/// Gaussians that are computed at once.
const LANES: usize = 4;

/// The visible ones of the Gaussians from `first` on, `count` of them, in the order of the splats.
pub(super) struct Project<'a> {
    pub(super) projection: &'a Projection,
    pub(super) splats: &'a Splats,
    pub(super) first: usize,
    pub(super) count: usize,
}

impl Kernel for Project<'_> {
    type Output = Result<Vec<Splat2d>, BadValue>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let end = self.first + self.count;
        let mut splats2d = Vec::with_capacity(self.count);
        let mut first = self.first;
        while first < end {
            let four = FourGaussians::new(simd, self.projection, self.splats, first, end - 1);
            for lane in 0..LANES.min(end - first) {
                splats2d.extend(four.splat2d(self.projection, self.splats, first + lane, lane)?);
            }
            first += LANES;
        }
        Ok(splats2d)
    }
}

/// What is computed of four Gaussians at once: an entry each.
struct FourGaussians {
    /// From the camera, world axes, metres.
    offset: [[f64; LANES]; 3],
    depth: [f64; LANES],
    mean: [[f64; LANES]; 2],
    conic_factor: [[f64; LANES]; 3],
    determinant: [f64; LANES],
    radius: [f64; LANES],
    /// First column, end, first row, end; whole numbers in the range of the picture.
    tiles: [[f64; LANES]; 4],
}

impl FourGaussians {
    /// Of the Gaussians from `first` on, `last` in place of those that come after it.
    #[inline(always)]
    fn new<S: Simd>(simd: S, projection: &Projection, splats: &Splats, first: usize, last: usize) -> Self {
        let indices = [first, last.min(first + 1), last.min(first + 2), last.min(first + 3)];
        let means = splats.means();
        let [x, y, z] = lanes(simd, means, indices);
        let [left, top, back] = projection.centre;
        let offset = [x - left, y - top, z - back];
        let [right, below, ahead] = projection.rotation;
        let z = along(simd, ahead, offset);
        let per_z = f64x4::splat(simd, 1.0) / z;
        let (tan_x, tan_y) = (along(simd, right, offset) * per_z, along(simd, below, offset) * per_z);
        let mean_x = tan_x * projection.focal[0] + (projection.principal[0] - 0.5);
        let mean_y = tan_y * projection.focal[1] + (projection.principal[1] - 0.5);
        let slope_x = tan_x.max(projection.slopes[0][0]).min(projection.slopes[0][1]);
        let slope_y = tan_y.max(projection.slopes[1][0]).min(projection.slopes[1][1]);

        // Rows of the map from own, scaled axes to the picture.
        let own = rotation(simd, splats, indices);
        let scales = splats.scales();
        let scale = lanes(simd, scales, indices);
        let across = row(simd, [right, ahead], slope_x, per_z * projection.focal[0], own, scale);
        let down = row(simd, [below, ahead], slope_y, per_z * projection.focal[1], own, scale);

        let (xx, xy, yy) = (dot(across, across), dot(across, down), dot(down, down));
        let (a, c) = (xx + projection.blur, yy + projection.blur);
        // Lagrange's identity: a sum of squares, where xx yy - xy^2 would cancel.
        let area = [
            across[1] * down[2] - across[2] * down[1],
            across[2] * down[0] - across[0] * down[2],
            across[0] * down[1] - across[1] * down[0],
        ];
        let determinant = dot(area, area) + ((xx + yy) + projection.blur) * projection.blur;
        let (middle, difference) = ((a + c) * 0.5, (a - c) * 0.5);
        let spread = (difference * difference + xy * xy).max(0.1).sqrt();
        let radius = ((middle + spread).sqrt() * projection.sigmas).ceil();
        let stretch = (c / determinant * HALF_LOG2_E).sqrt();
        let reach = radius + (TILE as f64 - 1.0);
        Self {
            offset: [offset[0].into(), offset[1].into(), offset[2].into()],
            depth: z.into(),
            mean: [mean_x.into(), mean_y.into()],
            conic_factor: [
                stretch.into(),
                (-(xy / c) * stretch).into(),
                (f64x4::splat(simd, HALF_LOG2_E) / c).sqrt().into(),
            ],
            determinant: determinant.into(),
            radius: radius.into(),
            tiles: [
                tile(mean_x - radius, projection.tiles[0]).into(),
                tile(mean_x + reach, projection.tiles[0]).into(),
                tile(mean_y - radius, projection.tiles[1]).into(),
                tile(mean_y + reach, projection.tiles[1]).into(),
            ],
        }
    }

    /// The splat2d of one of them; none if it isn't visible.
    #[inline(always)]
    fn splat2d(
        &self,
        projection: &Projection,
        splats: &Splats,
        index: usize,
        lane: usize,
    ) -> Result<Option<Splat2d>, BadValue> {
        let opacity = splats.opacities()[index];
        let depth = self.depth[lane];
        // Not <=: a depth that is not a number is an overflow, which is reported below.
        if opacity < projection.alpha_min || depth <= projection.near {
            return Ok(None);
        }
        let overflow = |field, value| BadValue { field, index, value };
        let mean = [self.mean[0][lane], self.mean[1][lane]];
        if !(mean[0].is_finite() && mean[1].is_finite() && depth <= f64::from(LARGEST)) {
            return Err(overflow("means", largest(splats.means()[index])));
        }
        let conic_factor =
            [self.conic_factor[0][lane], self.conic_factor[1][lane], self.conic_factor[2][lane]];
        if !(self.determinant[lane].is_finite() && conic_factor[1].is_finite()) {
            return Err(overflow("scales", largest(splats.scales()[index])));
        }
        let [first_column, end_column, first_row, end_row] = self.tiles;
        let tiles = [first_column, end_column, first_row, end_row].map(|edges| edges[lane] as u16);
        if tiles[0] >= tiles[1] || tiles[2] >= tiles[3] {
            return Ok(None);
        }
        let offset = [self.offset[0][lane], self.offset[1][lane], self.offset[2][lane]];
        let colour = sh_colour(splats, index, offset);
        if let Some(value) = colour.into_iter().find(|value| value.is_nan() || value.abs() > LARGEST) {
            return Err(overflow("sh", value));
        }
        Ok(Some(Splat2d {
            mean,
            conic_factor,
            log_opacity: opacity.log2(),
            colour: [colour[0].max(0.0), colour[1].max(0.0), colour[2].max(0.0)],
            depth: depth as f32,
            index: index as u32,
            radius: self.radius[lane] as f32,
            tiles,
        }))
    }
}

/// The coordinate that is farthest from 0.
fn largest(row: [f32; 3]) -> f32 {
    row.into_iter().fold(0.0, |most: f32, value| if value.abs() > most.abs() { value } else { most })
}

/// The coordinates of four rows.
#[inline(always)]
fn lanes<S: Simd, const N: usize>(simd: S, rows: &[[f32; N]], indices: [usize; LANES]) -> [f64x4<S>; N] {
    let [a, b, c, d] = indices.map(|index| rows[index]);
    let mut axes = [f64x4::splat(simd, 0.0); N];
    for (axis, lanes) in axes.iter_mut().enumerate() {
        let values = [f64::from(a[axis]), f64::from(b[axis]), f64::from(c[axis]), f64::from(d[axis])];
        *lanes = f64x4::simd_from(simd, values);
    }
    axes
}

/// Four vectors along one axis.
#[inline(always)]
fn along<S: Simd>(simd: S, axis: [f64; 3], vectors: [f64x4<S>; 3]) -> f64x4<S> {
    let [a, b, c] = axis;
    vectors[0].mul_add(f64x4::splat(simd, a), vectors[1].mul_add(f64x4::splat(simd, b), vectors[2] * c))
}

/// One row of the map from own, scaled axes to the picture: `axes` are that of the row and the optical one, `slope`
/// the tangent along the row, `scale` own standard deviations.
#[inline(always)]
fn row<S: Simd>(
    simd: S,
    axes: [[f64; 3]; 2],
    slope: f64x4<S>,
    pixels_per_metre: f64x4<S>,
    own: [[f64x4<S>; 3]; 3],
    scale: [f64x4<S>; 3],
) -> [f64x4<S>; 3] {
    let [axis, ahead] = axes;
    let world = [
        (f64x4::splat(simd, axis[0]) - slope * ahead[0]) * pixels_per_metre,
        (f64x4::splat(simd, axis[1]) - slope * ahead[1]) * pixels_per_metre,
        (f64x4::splat(simd, axis[2]) - slope * ahead[2]) * pixels_per_metre,
    ];
    [
        dot(world, [own[0][0], own[1][0], own[2][0]]) * scale[0],
        dot(world, [own[0][1], own[1][1], own[2][1]]) * scale[1],
        dot(world, [own[0][2], own[1][2], own[2][2]]) * scale[2],
    ]
}

/// Index of the tile of a position, held within the picture.
#[inline(always)]
fn tile<S: Simd>(edge: f64x4<S>, count: usize) -> f64x4<S> {
    (edge * (1.0 / TILE as f64)).floor().max(0.0).min(count as f64)
}

#[inline(always)]
fn dot<S: Simd>(a: [f64x4<S>; 3], b: [f64x4<S>; 3]) -> f64x4<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// Own to world axes: rows of the matrices of four quaternions.
#[inline(always)]
fn rotation<S: Simd>(simd: S, splats: &Splats, indices: [usize; LANES]) -> [[f64x4<S>; 3]; 3] {
    let [w, x, y, z] = lanes(simd, splats.rotations(), indices);
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (xx, yy, zz) = (x * x2, y * y2, z * z2);
    let (xy, xz, yz) = (x * y2, x * z2, y * z2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    let one = f64x4::splat(simd, 1.0);
    [
        [one - (yy + zz), xy - wz, xz + wy],
        [xy + wz, one - (xx + zz), yz - wx],
        [xz - wy, yz + wx, one - (xx + yy)],
    ]
}
