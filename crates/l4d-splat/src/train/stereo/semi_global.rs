//! Semi-global matching: along paths through the picture a change of plane costs something, little for the next plane,
//! more for any other, less where the colour changes too. The plane with the smallest sum over all paths wins.

use super::{PlaneSweep, StereoImage, difference};

/// Dearer matches, bytes, are none.
const WORST_MATCH: u8 = 42;

/// What a step to the next plane costs, bytes of colour, and the most that any other step does.
const NEXT: u16 = 5;
const JUMP: u16 = 40;
/// Difference of colour that halves the latter, bytes.
const EDGE: u16 = 16;
/// Directions of the paths: columns and rows from one pixel to the next.
const DIRECTIONS: [[i32; 2]; 8] = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];

/// Planar depth of each pixel, metres: +inf on the first plane, NaN without a match.
pub(super) fn matched(
    volume: &[u8],
    image: &StereoImage<'_>,
    sweep: &PlaneSweep,
    wanted: &[bool],
) -> Vec<f32> {
    let planes = sweep.planes;
    let mut sums = vec![0_u16; volume.len()];
    for direction in DIRECTIONS {
        add_path(&mut sums, volume, image, planes, wanted, direction);
    }
    let depth = |(pixel, sums): (usize, &[u16])| {
        if !wanted[pixel] {
            return f32::NAN;
        }
        let Some(best) = (0..planes).min_by_key(|&plane| sums[plane]) else { return f32::NAN };
        match best {
            _ if volume[pixel * planes + best] > WORST_MATCH => f32::NAN,
            0 => f32::INFINITY,
            // Whatever is nearer than the nearest plane would be found there.
            _ if best + 1 == planes => f32::NAN,
            _ => 1.0 / sweep.inverse_depth(best as f32 + between(&sums[best - 1..=best + 1])),
        }
    };
    sums.chunks_exact(planes).enumerate().map(depth).collect()
}

/// Where between its neighbours the least of three sums lies, -1/2 to 1/2.
fn between(sums: &[u16]) -> f32 {
    let [before, least, after] = [0, 1, 2].map(|at| f32::from(sums[at]));
    let bend = before - 2.0 * least + after;
    if bend > 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 }
}

fn add_path(
    sums: &mut [u16],
    volume: &[u8],
    image: &StereoImage<'_>,
    planes: usize,
    wanted: &[bool],
    [dx, dy]: [i32; 2],
) {
    let (width, height) = (image.view.width() as i32, image.view.height() as i32);
    let mut rows = [vec![0_u16; width as usize * planes], vec![0_u16; width as usize * planes]];
    for place in 0..height {
        let row = if dy < 0 { height - 1 - place } else { place };
        for step in 0..width {
            let column = if dx < 0 { width - 1 - step } else { step };
            let pixel = (row * width + column) as usize;
            if !wanted[pixel] {
                continue;
            }
            let costs = &volume[pixel * planes..][..planes];
            let (from_column, from_row) = (column - dx, row - dy);
            let is_inside = (0..width).contains(&from_column) && (0..height).contains(&from_row);
            let from = (from_row * width + from_column) as usize;
            let begins = !is_inside || !wanted[from];
            let [before, now] = &mut rows;
            let now = if begins {
                let now = &mut now[column as usize * planes..][..planes];
                now.iter_mut().zip(costs).for_each(|(now, &cost)| *now = u16::from(cost));
                now
            } else {
                let jump = jump(image.colour[pixel], image.colour[from]);
                let place = from_column as usize * planes;
                if dy == 0 {
                    // The previous pixel is in the same row.
                    before[..planes].copy_from_slice(&now[place..][..planes]);
                    let now = &mut now[column as usize * planes..][..planes];
                    follow(now, &before[..planes], costs, jump);
                    now
                } else {
                    let now = &mut now[column as usize * planes..][..planes];
                    follow(now, &before[place..][..planes], costs, jump);
                    now
                }
            };
            for (sum, &now) in sums[pixel * planes..][..planes].iter_mut().zip(&*now) {
                *sum += now;
            }
        }
        if dy != 0 {
            rows.swap(0, 1);
        }
    }
}

fn jump(colour: [u8; 3], from: [u8; 3]) -> u16 {
    (JUMP * EDGE / (EDGE + u16::from(difference(colour, from)))).max(NEXT + 1)
}

fn follow(now: &mut [u16], before: &[u16], costs: &[u8], jump: u16) {
    let least = before.iter().copied().min().unwrap_or_default();
    for (plane, (now, &cost)) in now.iter_mut().zip(costs).enumerate() {
        let mut cheapest = before[plane].min(least + jump);
        if plane > 0 {
            cheapest = cheapest.min(before[plane - 1] + NEXT);
        }
        if let Some(next) = before.get(plane + 1) {
            cheapest = cheapest.min(next + NEXT);
        }
        *now = u16::from(cost) + cheapest - least;
    }
}
