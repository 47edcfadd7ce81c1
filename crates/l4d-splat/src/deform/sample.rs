//! Bilinear lookup in the six planes of one level, for many positions at one time, and its derivative.
//!
//! Corners of the planes are texel centres (`align_corners`), and what lies outside is clamped to the border, where
//! the derivative is zero. All rows share their time, so that each plane with a time axis is first cut along it to
//! a line of texels: two texels per row instead of four, and lines small enough to stay in the nearest cache.

use super::grid::Plane;

/// Channels that are handled together.
const LANES: usize = 8;

/// Numbers of so many channels.
type Lanes = [f32; LANES];

/// Samples whose product is a feature: of the planes (x,y), (x,z), (y,z), then of the lines along x, y, z that the
/// planes (x,t), (y,t), (z,t) are at a time.
pub(super) const FACTORS: usize = 6;

/// Axes of the planes in space.
const AREAS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Where a coordinate falls between two texels of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tap {
    low: usize,
    high: usize,
    /// Weight of `high`, 0 to 1.
    fraction: f32,
    /// Change of the texel index per coordinate, 0 where it is clamped.
    slope: f32,
}

impl Tap {
    pub(super) fn new(coordinate: f32, texels: usize) -> Self {
        let last = (texels - 1) as f32;
        // Clamped first: an infinite coordinate on an axis of one texel would be no number.
        let index = (coordinate.clamp(-1.0, 1.0) + 1.0) / 2.0 * last;
        let inside = index > 0.0 && index < last;
        let low = index as usize;
        let high = (low + 1).min(texels - 1);
        Self { low, high, fraction: index - low as f32, slope: if inside { last / 2.0 } else { 0.0 } }
    }
}

/// Where a position falls along x, y and z.
type Taps = [Tap; 3];

/// The planes of a level with their time axis fixed.
pub(super) struct LevelAt<'a> {
    areas: [&'a Plane; 3],
    lines: [Vec<f32>; 3],
    time: Tap,
    /// Texels along x, y, z.
    texels: [usize; 3],
    channels: usize,
}

impl<'a> LevelAt<'a> {
    pub(super) fn new(planes: &'a [Plane; 6], time_coordinate: f32) -> Self {
        let [x_y, x_z, x_time, y_z, y_time, z_time] = planes;
        let time = Tap::new(time_coordinate, x_time.rows);
        let lines = [x_time, y_time, z_time].map(|plane| {
            let row = plane.columns * plane.channels;
            let low = &plane.texels[time.low * row..][..row];
            let high = &plane.texels[time.high * row..][..row];
            low.iter().zip(high).map(|(low, high)| low + (high - low) * time.fraction).collect()
        });
        let texels = [x_y.columns, x_y.rows, x_z.rows];
        Self { areas: [x_y, x_z, y_z], lines, time, texels, channels: x_y.channels }
    }

    fn taps(&self, coordinates: [f32; 3]) -> Taps {
        std::array::from_fn(|axis| Tap::new(coordinates[axis], self.texels[axis]))
    }

    /// Channels from `channel` on of the four texels that a sample of a plane in space mixes.
    #[inline(always)]
    fn area(&self, area: usize, taps: &Taps, channel: usize) -> [Lanes; 4] {
        let (first, second) = AREAS[area];
        let [a, b, c, d] = corners(taps[first], taps[second]);
        let at = |(column, row)| load(&self.areas[area].texel(column, row)[channel..]);
        [at(a), at(b), at(c), at(d)]
    }

    /// Channels from `channel` on of the two texels that a sample of a line mixes.
    #[inline(always)]
    fn line(&self, axis: usize, tap: Tap, channel: usize) -> [Lanes; 2] {
        let at = |texel: usize| load(&self.lines[axis][texel * self.channels..][channel..self.channels]);
        [at(tap.low), at(tap.high)]
    }

    /// Product of the six samples, for every channel.
    pub(super) fn product(&self, coordinates: [f32; 3], product: &mut [f32]) {
        let taps = self.taps(coordinates);
        for (group, product) in product.chunks_mut(LANES).enumerate() {
            let mut lanes = [1.0; LANES];
            for (area, (first, second)) in AREAS.into_iter().enumerate() {
                let [a, b, c, d] = self.area(area, &taps, group * LANES);
                let [low, high] = [lerp(a, b, taps[first].fraction), lerp(c, d, taps[first].fraction)];
                lanes = times(lanes, lerp(low, high, taps[second].fraction));
            }
            for (axis, tap) in taps.into_iter().enumerate() {
                let [a, b] = self.line(axis, tap, group * LANES);
                lanes = times(lanes, lerp(a, b, tap.fraction));
            }
            product.copy_from_slice(&lanes[..product.len()]);
        }
    }

    /// From the gradient of the product to that of each sample (`gradients`, factor after factor) and, added to
    /// `along`, to those of the three coordinates.
    pub(super) fn backward(
        &self,
        coordinates: [f32; 3],
        upstream: &[f32],
        gradients: &mut [f32],
        along: &mut [f32; 3],
    ) {
        let taps = self.taps(coordinates);
        let mut slopes = [[0.0; LANES]; 3];
        for (group, upstream) in upstream.chunks(LANES).enumerate() {
            let channel = group * LANES;
            let mut samples = [[0.0; LANES]; FACTORS];
            let mut by_index = [[[0.0; LANES]; 2]; FACTORS];
            for (area, (first, second)) in AREAS.into_iter().enumerate() {
                let (first, second) = (taps[first].fraction, taps[second].fraction);
                let [a, b, c, d] = self.area(area, &taps, channel);
                let [low, high] = [lerp(a, b, first), lerp(c, d, first)];
                samples[area] = lerp(low, high, second);
                by_index[area] = [lerp(minus(b, a), minus(d, c), second), minus(high, low)];
            }
            for (axis, tap) in taps.into_iter().enumerate() {
                let [a, b] = self.line(axis, tap, channel);
                samples[3 + axis] = lerp(a, b, tap.fraction);
                by_index[3 + axis][0] = minus(b, a);
            }

            let by_sample = products_of_others(load(upstream), &samples);
            for (factor, gradient) in by_sample.iter().enumerate() {
                gradients[factor * self.channels + channel..][..upstream.len()]
                    .copy_from_slice(&gradient[..upstream.len()]);
            }
            for (area, (first, second)) in AREAS.into_iter().enumerate() {
                let [by_first, by_second] = by_index[area];
                add_scaled(&mut slopes[first], times(by_first, by_sample[area]), taps[first].slope);
                add_scaled(&mut slopes[second], times(by_second, by_sample[area]), taps[second].slope);
            }
            for (axis, tap) in taps.into_iter().enumerate() {
                let by_tap = times(by_index[3 + axis][0], by_sample[3 + axis]);
                add_scaled(&mut slopes[axis], by_tap, tap.slope);
            }
        }
        for (along, slope) in along.iter_mut().zip(slopes) {
            *along += sum(slope);
        }
    }
}

/// Texels (column, row) at (low, low), (high, low), (low, high), (high, high) of two axes.
fn corners(first: Tap, second: Tap) -> [(usize, usize); 4] {
    let ([left, right], [top, bottom]) = ([first.low, first.high], [second.low, second.high]);
    [(left, top), (right, top), (left, bottom), (right, bottom)]
}

/// The gradient of each factor: upstream times the product of all others. Dividing the whole product by the factor
/// would fail where it is zero.
fn products_of_others(upstream: Lanes, factors: &[Lanes; FACTORS]) -> [Lanes; FACTORS] {
    let mut gradients = [upstream; FACTORS];
    let mut before = upstream;
    for (gradient, &factor) in gradients.iter_mut().zip(factors) {
        *gradient = before;
        before = times(before, factor);
    }
    let mut after = [1.0; LANES];
    for (gradient, &factor) in gradients.iter_mut().zip(factors).rev() {
        *gradient = times(*gradient, after);
        after = times(after, factor);
    }
    gradients
}

/// Adds the gradients of one factor's samples, row after row, to the gradient of the plane that it comes from.
pub(super) fn scatter_add<'g>(
    level: &LevelAt<'_>,
    factor: usize,
    rows: impl Iterator<Item = ([f32; 3], &'g [f32])>,
    into: &mut Plane,
) {
    let tap = |coordinates: [f32; 3], axis: usize| Tap::new(coordinates[axis], level.texels[axis]);
    if let Some(&(first, second)) = AREAS.get(factor) {
        for (coordinates, gradient) in rows {
            let (first, second) = (tap(coordinates, first), tap(coordinates, second));
            let (a, b) = (first.fraction, second.fraction);
            let weights = [(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b];
            for ((column, row), weight) in corners(first, second).into_iter().zip(weights) {
                add(into.texel_mut(column, row), gradient, weight);
            }
        }
        return;
    }
    let channels = into.channels;
    let mut line = vec![0.0; into.columns * channels];
    for (coordinates, gradient) in rows {
        let tap = tap(coordinates, factor - AREAS.len());
        add(&mut line[tap.low * channels..][..channels], gradient, 1.0 - tap.fraction);
        add(&mut line[tap.high * channels..][..channels], gradient, tap.fraction);
    }
    let (row, time) = (line.len(), level.time);
    add(&mut into.texels[time.low * row..][..row], &line, 1.0 - time.fraction);
    add(&mut into.texels[time.high * row..][..row], &line, time.fraction);
}

fn add(into: &mut [f32], gradient: &[f32], weight: f32) {
    for (into, gradient) in into.iter_mut().zip(gradient) {
        *into += weight * gradient;
    }
}

/// The first channels of a list, zeros where it is shorter.
#[inline(always)]
fn load(values: &[f32]) -> Lanes {
    match values.first_chunk() {
        Some(lanes) => *lanes,
        None => load_part(values),
    }
}

/// Apart, so that the common case stays a single vector instruction.
#[cold]
fn load_part(values: &[f32]) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (lane, value) in lanes.iter_mut().zip(values) {
        *lane = *value;
    }
    lanes
}

fn times(a: Lanes, b: Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

fn minus(a: Lanes, b: Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] - b[lane])
}

/// `a` where the fraction is 0, `b` where it is 1.
fn lerp(a: Lanes, b: Lanes, fraction: f32) -> Lanes {
    std::array::from_fn(|lane| a[lane] + (b[lane] - a[lane]) * fraction)
}

fn add_scaled(into: &mut Lanes, values: Lanes, scale: f32) {
    for (into, value) in into.iter_mut().zip(values) {
        *into += scale * value;
    }
}

fn sum([a, b, c, d, e, f, g, h]: Lanes) -> f32 {
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinate_falls_between_texel_centres() {
        let tap = |coordinate, texels| Tap::new(coordinate, texels);
        assert_eq!(tap(0.0, 5), Tap { low: 2, high: 3, fraction: 0.0, slope: 2.0 });
        assert_eq!(tap(-0.25, 5), Tap { low: 1, high: 2, fraction: 0.5, slope: 2.0 });
    }

    #[test]
    fn borders_and_what_lies_beyond_are_clamped_and_flat() {
        let first = Tap { low: 0, high: 1, fraction: 0.0, slope: 0.0 };
        let last = Tap { low: 4, high: 4, fraction: 0.0, slope: 0.0 };
        for coordinate in [-1.0, -1.5, f32::MIN, f32::NEG_INFINITY] {
            assert_eq!(Tap::new(coordinate, 5), first);
        }
        for coordinate in [1.0, 7.0, f32::MAX, f32::INFINITY] {
            assert_eq!(Tap::new(coordinate, 5), last);
        }
        for coordinate in [-1.0, 0.3, 1.0, f32::MAX, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(Tap::new(coordinate, 1), Tap { low: 0, high: 0, fraction: 0.0, slope: 0.0 });
        }
    }

    #[test]
    fn a_factor_of_zero_gets_the_product_of_the_others() {
        let factors = [2.0, 3.0, 0.0, 5.0, -1.0, 0.5].map(|factor| [factor; LANES]);
        let gradients = products_of_others([10.0; LANES], &factors);
        assert_eq!(gradients.map(|lanes| lanes[0]), [0.0, 0.0, -150.0, 0.0, 0.0, 0.0]);
        let factors = [2.0, 3.0, 1.0, 5.0, -1.0, 0.5].map(|factor| [factor; LANES]);
        let gradients = products_of_others([1.0; LANES], &factors);
        assert_eq!(gradients.map(|lanes| lanes[LANES - 1]), [-7.5, -5.0, -15.0, -3.0, 15.0, -30.0]);
    }
}
