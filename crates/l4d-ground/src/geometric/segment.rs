//! A frame -> segments: sets of pixels that hang together, at several levels of detail.
//!
//! Knows nothing of time but the backdrop, and keeps nothing from frame to frame.

use glam::DVec3;
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;

use super::lab::distance;
use super::perceive::Glimpse;
use super::settings::{
    COLOUR_K, GAP_FOOTPRINTS, LEAST_PX, LEAST_SHARE, MOST_SEGMENTS, MOST_SHARE, MOVING_SHARE,
};
use super::surface::{Backdrop, Surface, precise};

/// What holds a segment together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    /// Depth alone: whatever touches is one.
    Lump,
    /// Depth and colour: evenly coloured parts, coarse.
    Part,
    /// What is in front of the background.
    Mover,
    /// Depth and colour of what is in front of the background.
    MovingPart,
}

impl Level {
    pub(crate) const ALL: [Self; 4] = [Self::Lump, Self::Part, Self::Mover, Self::MovingPart];
}

/// Points and colours that are kept of a segment.
const SAMPLES: usize = 40;
/// Share of points left out on either side of a box.
const OUTLIERS: f64 = 0.02;
/// Steps of the edge weights; weights beyond count as the last.
const WEIGHT_STEPS: usize = 256;
/// Edge weight of one L*a*b* unit.
const STEPS_A_UNIT: f32 = 4.0;

/// The segments of a frame at a level.
pub(crate) fn segments(surface: &Surface, backdrop: &Backdrop, level: Level, footprint: f32) -> Vec<Glimpse> {
    let pixels = surface.points.len();
    let moves = matches!(level, Level::Mover | Level::MovingPart);
    if moves && backdrop.depth_m.is_none() {
        return Vec::new();
    }
    let is_thing = |index: usize| {
        surface.is_known(index)
            && (if moves {
                backdrop.is_before(surface, index, MOVING_SHARE)
            } else {
                !backdrop.is_support(surface, index)
            })
    };
    let things: Vec<bool> = (0..pixels).map(is_thing).collect();
    let labels = match level {
        Level::Lump | Level::Mover => lumps(surface, &things, footprint),
        Level::Part | Level::MovingPart => parts(surface, &things, footprint),
    };
    let mut found = gather(surface, &labels);
    let ends = Ends { surface, backdrop, reach: GAP_FOOTPRINTS * footprint };
    found.iter_mut().for_each(|glimpse| glimpse.closed = ends.share(&glimpse.mask));
    found
}

/// Sets that grow together.
struct Forest {
    parent: Vec<u32>,
    size: Vec<u32>,
    spread: Vec<f32>,
}

impl Forest {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), size: vec![1; count], spread: vec![0.0; count] }
    }

    fn root(&mut self, index: u32) -> u32 {
        let mut index = index;
        while self.parent[index as usize] != index {
            let above = self.parent[self.parent[index as usize] as usize];
            self.parent[index as usize] = above;
            index = above;
        }
        index
    }

    fn join(&mut self, a: u32, b: u32, weight: f32) {
        let (a, b) = if self.size[a as usize] >= self.size[b as usize] { (a, b) } else { (b, a) };
        self.parent[b as usize] = a;
        self.size[a as usize] += self.size[b as usize];
        self.spread[a as usize] = weight;
    }

    fn labels(mut self, things: &[bool]) -> Vec<u32> {
        (0..things.len() as u32)
            .map(|index| if things[index as usize] { self.root(index) + 1 } else { 0 })
            .collect()
    }
}

/// Neighbouring pixels of things whose surface goes on from one to the other.
fn neighbours(surface: &Surface, things: &[bool], footprint: f32) -> Vec<(u32, u32)> {
    let (width, height) = (surface.width, surface.height);
    let mut pairs = Vec::new();
    for row in 0..height {
        for column in 0..width {
            let here = row * width + column;
            if !things[here] {
                continue;
            }
            let mut link = |there: usize| {
                let reach = GAP_FOOTPRINTS * footprint * surface.depth_m[here].min(surface.depth_m[there]);
                if things[there] && surface.points[here].distance(surface.points[there]) <= reach {
                    pairs.push((here as u32, there as u32));
                }
            };
            if column + 1 < width {
                link(here + 1);
            }
            if row + 1 < height {
                link(here + width);
            }
        }
    }
    pairs
}

fn lumps(surface: &Surface, things: &[bool], footprint: f32) -> Vec<u32> {
    let mut forest = Forest::new(things.len());
    for (here, there) in neighbours(surface, things, footprint) {
        let (a, b) = (forest.root(here), forest.root(there));
        if a != b {
            forest.join(a, b, 0.0);
        }
    }
    forest.labels(things)
}

/// Felzenszwalb and Huttenlocher 2004: two sets join if their difference is not above the spread within both plus a
/// slack that fades with size.
fn parts(surface: &Surface, things: &[bool], footprint: f32) -> Vec<u32> {
    let pairs = neighbours(surface, things, footprint);
    let mut by_weight: Vec<Vec<(u32, u32)>> = vec![Vec::new(); WEIGHT_STEPS];
    for (here, there) in pairs {
        let difference = distance(surface.colours[here as usize], surface.colours[there as usize]);
        let step = ((difference * STEPS_A_UNIT) as usize).min(WEIGHT_STEPS - 1);
        by_weight[step].push((here, there));
    }
    let mut forest = Forest::new(things.len());
    for (step, pairs) in by_weight.iter().enumerate() {
        let weight = step as f32 / STEPS_A_UNIT;
        for &(here, there) in pairs {
            let (a, b) = (forest.root(here), forest.root(there));
            let slack =
                |root: u32| forest.spread[root as usize] + COLOUR_K / forest.size[root as usize] as f32;
            if a != b && weight <= slack(a).min(slack(b)) {
                forest.join(a, b, weight);
            }
        }
    }
    forest.labels(things)
}

/// Tells where surfaces end.
struct Ends<'s> {
    surface: &'s Surface,
    backdrop: &'s Backdrop,
    reach: f32,
}

impl Ends<'_> {
    /// Share of the outline of a mask beyond which there is another surface, a support or nothing.
    fn share(&self, mask: &Mask) -> f64 {
        let (width, height) = mask.size();
        let (mut outline, mut open) = (0_u32, 0_u32);
        for (column, row) in mask.pixels() {
            let here = (row * width + column) as usize;
            let beside = [
                (column.wrapping_sub(1), row),
                (column + 1, row),
                (column, row.wrapping_sub(1)),
                (column, row + 1),
            ];
            for (column, row) in beside {
                if column >= width || row >= height || mask.get(column, row) {
                    continue;
                }
                outline += 1;
                let there = (row * width + column) as usize;
                let surface = self.surface;
                let goes_on = surface.is_known(there)
                    && !self.backdrop.is_support(surface, there)
                    && surface.points[here].distance(surface.points[there])
                        <= self.reach * surface.depth_m[here].min(surface.depth_m[there]);
                open += u32::from(goes_on);
            }
        }
        if outline == 0 { 0.0 } else { 1.0 - f64::from(open) / f64::from(outline) }
    }
}

/// Labels -> glimpses, the largest first.
fn gather(surface: &Surface, labels: &[u32]) -> Vec<Glimpse> {
    let pixels = labels.len();
    let least = LEAST_PX.max((pixels as f64 * LEAST_SHARE) as usize);
    let most = (pixels as f64 * MOST_SHARE) as usize;
    let mut counts = vec![0_u32; pixels + 1];
    labels.iter().for_each(|&label| counts[label as usize] += 1);
    let mut members: Vec<Vec<u32>> = Vec::new();
    let mut slots = vec![u32::MAX; pixels + 1];
    for (index, &label) in labels.iter().enumerate() {
        let count = counts[label as usize] as usize;
        if label == 0 || count < least || count > most {
            continue;
        }
        if slots[label as usize] == u32::MAX {
            slots[label as usize] = members.len() as u32;
            members.push(Vec::with_capacity(count));
        }
        members[slots[label as usize] as usize].push(index as u32);
    }
    // The sort is stable: among equals the one that begins farther up comes first.
    members.sort_by_key(|members| std::cmp::Reverse(members.len()));
    members.truncate(MOST_SEGMENTS);
    members.iter().map(|members| glimpse(surface, members)).collect()
}

/// What a set of pixels shows.
pub(crate) fn glimpse(surface: &Surface, members: &[u32]) -> Glimpse {
    let (width, height) = (surface.width as u32, surface.height as u32);
    let mut mask = Mask::empty(width, height);
    let mut bounds = PixelBox { first_col: u32::MAX, first_row: u32::MAX, last_col: 0, last_row: 0 };
    let mut colour = [0.0; 3];
    for &index in members {
        let (column, row) = (index % width, index / width);
        mask.set(column, row, true);
        bounds.first_col = bounds.first_col.min(column);
        bounds.last_col = bounds.last_col.max(column);
        bounds.first_row = bounds.first_row.min(row);
        bounds.last_row = bounds.last_row.max(row);
        let [l, a, b] = surface.colours[index as usize];
        colour = [colour[0] + l, colour[1] + a, colour[2] + b];
    }
    let colour = colour.map(|sum| sum / members.len() as f32);
    let is_cut = bounds.first_col == 0
        || bounds.first_row == 0
        || bounds.last_col + 1 == width
        || bounds.last_row + 1 == height;
    let mut axes = [0, 1, 2]
        .map(|axis| members.iter().map(|&index| surface.points[index as usize][axis]).collect::<Vec<f32>>());
    let ranks = |share: f64| ((members.len() as f64 - 1.0) * share).round() as usize;
    let mut at = |share: f64| {
        let rank = ranks(share).min(members.len().saturating_sub(1));
        let mut coordinates = [0.0; 3];
        for (coordinate, values) in coordinates.iter_mut().zip(&mut axes) {
            *coordinate = f64::from(*values.select_nth_unstable_by(rank, f32::total_cmp).1);
        }
        DVec3::from_array(coordinates)
    };
    let (low, centre, high) = (at(OUTLIERS), at(0.5), at(1.0 - OUTLIERS));
    let step = members.len().div_ceil(SAMPLES).max(1);
    let samples = || members.iter().skip(step / 2).step_by(step).map(|&index| index as usize);
    Glimpse {
        number: 0,
        mask,
        area_px: members.len() as u64,
        bounds,
        colour,
        centre: (centre + (low + high) * 0.5) * 0.5,
        low,
        high,
        points: samples().map(|index| precise(surface.points[index])).collect(),
        colours: samples().map(|index| surface.colours[index]).collect(),
        is_cut,
        closed: 1.0,
    }
}
