//! What of a scene stands still, told from depth and colour alone, or from colour where nobody measured depth
//! (`by_colour`).
//!
//! A standing camera sees, through each pixel, a *ground*: the farthest surface that was there at enough moments.
//! Whatever is nearer at a moment moves, since the ground was seen through the place where it is. A ground moves too
//! if another camera sees through it, and it *flickers* if its colour leaves its usual value beyond the noise, often
//! and far enough to be worth the effort (a shadow falls on it, a picture on a screen changes). What hides a ground
//! for a while says nothing against it.
//! Knows no instances: ids are never looked at.

mod by_colour;

use rayon::prelude::*;

use self::by_colour::Bits;
use super::footage::{Footage, Shot};
use super::place::Placer;

/// How far two depths of one surface may be apart: absolute, metres, and relative.
const TOLERANCE: [f32; 2] = [0.002, 0.003];
/// A colour is unusual beyond this, display units, plus [`NOISES`] times the noise of its pixel.
const UNUSUAL: f32 = 0.04;
const NOISES: f32 = 4.0;
/// Share of calm moments with unusual colour from which on a ground flickers, whatever the threshold says.
const LEAST_FLICKER: f32 = 0.03;
/// A ground that stands still although its colour swings costs the square of this, in display units beyond the noise;
/// the pictures of a rendered scene have noise of that size.
const LEAST_SWING: f32 = 0.03;

/// How the colour of a ground changes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Unrest {
    /// Share of calm moments with unusual colour.
    odd: f32,
    /// Variance over calm moments beyond that of the noise, mean over channels.
    variance: f32,
}

/// What the ground of a pixel does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The same at all times.
    Still,
    /// Stands, but changes colour.
    Flickers,
    /// Another camera saw through it: no ground, but something that rested.
    Moves,
}

/// What a standing camera sees where nothing is in the way, row-major.
#[derive(Debug, Clone, PartialEq)]
pub struct Ground {
    /// Planar depth, metres; +inf where nothing is hit, NaN where it is unknown.
    pub depth_m: Vec<f32>,
    /// Mean display colour over calm moments.
    pub colour: Vec<[f32; 3]>,
    /// What it does.
    pub kind: Vec<Kind>,
}

/// The grounds of all cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// One a camera; none for a camera that moves.
    grounds: Vec<Option<Ground>>,
    /// Nothing is known to stand still.
    everything: bool,
    /// Where depth was not measured: pixels that move, by camera and moment; nothing for cameras without a ground.
    odd: Option<Vec<Vec<Bits>>>,
}

impl Motion {
    /// Looks at all pictures. `threshold` is the share of moments at which something has to be contradicted before it
    /// counts as moving; 0 makes everything dynamic, more than 1 nothing.
    pub fn of(footage: &Footage, threshold: f32) -> Self {
        if !footage.has_depth() {
            return by_colour::motion(footage, threshold);
        }
        let moments = footage.moments();
        let needed = ((threshold * moments as f32).ceil() as usize).clamp(1, moments + 1);
        let grounds: Vec<Option<(Ground, Vec<Unrest>)>> = footage
            .shots()
            .par_iter()
            .map(|shot| shot.stands().then(|| ground_of(shot, footage.size(), needed)))
            .collect();
        let kinds: Vec<Vec<Kind>> = (0..grounds.len())
            .map(|index| match (&grounds[index], threshold > 0.0) {
                (Some((ground, _)), true) => judge(footage, &grounds, index, ground, threshold),
                (Some((ground, _)), false) => vec![Kind::Flickers; ground.depth_m.len()],
                (None, _) => Vec::new(),
            })
            .collect();
        let judged = |(found, kind): (Option<(Ground, Vec<Unrest>)>, Vec<Kind>)| {
            found.map(|(ground, _)| Ground { kind, ..ground })
        };
        let grounds = grounds.into_iter().zip(kinds).map(judged).collect();
        Self { grounds, everything: threshold <= 0.0, odd: None }
    }

    /// Whether anything is known to stand still.
    pub fn tells_apart(&self) -> bool {
        !self.everything
    }

    /// The ground of a camera; none if it moves.
    pub fn ground(&self, shot: usize) -> Option<&Ground> {
        self.grounds.get(shot)?.as_ref()
    }

    /// Whether what a pixel shows at a moment is something that moves; everything is, for a moving camera.
    pub fn moves(&self, footage: &Footage, shot: usize, moment: usize, pixel: usize) -> bool {
        self.ground(shot).is_none_or(|ground| {
            if let Some(odd) = &self.odd {
                return odd[shot][moment].get(pixel);
            }
            let depth_m = footage.shots()[shot].picture(moment).depth_m[pixel].to_f32();
            ground.kind[pixel] == Kind::Moves || !same_depth(depth_m, ground.depth_m[pixel])
        })
    }

    /// Whether what a pixel shows at a moment moves, or has not the colour that its ground usually has.
    pub fn changes(&self, footage: &Footage, shot: usize, moment: usize, pixel: usize) -> bool {
        self.moves(footage, shot, moment, pixel)
            || self.everything
            || self.ground(shot).is_some_and(|ground| {
                let around = || neighbourhood(pixel, footage.size());
                let differs = || {
                    let now = mean_colour(&footage.shots()[shot], moment, around());
                    let usual = mean(around().map(|pixel| ground.colour[pixel])).unwrap_or_default();
                    std::iter::zip(now, usual).any(|(now, usual)| (now - usual).abs() > UNUSUAL)
                };
                ground.kind[pixel] == Kind::Flickers && differs()
            })
    }
}

/// Metres by which two depths of one surface may differ.
pub(super) fn tolerance(depth_m: f32) -> f32 {
    TOLERANCE[0] + TOLERANCE[1] * depth_m
}

fn same_depth(a_m: f32, b_m: f32) -> bool {
    a_m == b_m || (a_m - b_m).abs() < tolerance(a_m.min(b_m))
}

/// The ground of a standing camera with all kinds still open, and how restless it is.
fn ground_of(shot: &Shot, size: [u32; 2], needed: usize) -> (Ground, Vec<Unrest>) {
    let pixels = size[0] as usize * size[1] as usize;
    let moments = shot.pictures().len();
    let depth_m: Vec<f32> = (0..pixels)
        .map(|pixel| {
            let mut depths: Vec<f32> =
                shot.pictures().iter().map(|picture| picture.depth_m[pixel].to_f32()).collect();
            let rank = needed.min(moments) - 1;
            *depths.select_nth_unstable_by(rank, |a, b| b.total_cmp(a)).1
        })
        .collect();
    // Moments at which a pixel shows its ground.
    let bare: Vec<Vec<bool>> = shot
        .pictures()
        .iter()
        .map(|picture| {
            std::iter::zip(&picture.depth_m, &depth_m)
                .map(|(depth_m, &ground_m)| same_depth(depth_m.to_f32(), ground_m))
                .collect()
        })
        .collect();
    let mut colour = Vec::with_capacity(pixels);
    let mut unrest = Vec::with_capacity(pixels);
    let mut calm = Vec::with_capacity(moments);
    for pixel in 0..pixels {
        let around = neighbourhood(pixel, size);
        calm.clear();
        for (moment, bare) in bare.iter().enumerate() {
            // Where something passes next to the pixel, its edge is mixed into the colour.
            if around.clone().all(|neighbour| bare[neighbour]) {
                calm.push((moment, mean_colour(shot, moment, around.clone())));
            }
        }
        let Usual { colour: usual, noise } = Usual::of(&calm);
        let unusual = |colour: &[f32; 3]| {
            (0..3).any(|channel| (colour[channel] - usual[channel]).abs() > UNUSUAL + NOISES * noise[channel])
        };
        let steady = calm.iter().filter(|(_, colour)| !unusual(colour)).map(|&(moment, _)| moment);
        let bare_at = (0..moments).filter(|&moment| bare[moment][pixel]);
        let mean = mean_of(shot, pixel, steady).or_else(|| mean_of(shot, pixel, bare_at));
        colour.push(mean.unwrap_or(usual));
        let odd = calm.iter().filter(|(_, colour)| unusual(colour)).count();
        unrest.push(Unrest { odd: odd as f32 / calm.len().max(1) as f32, variance: variance(&calm, &noise) });
    }
    (Ground { depth_m, colour, kind: Vec::new() }, unrest)
}

/// What a pixel mostly shows.
struct Usual {
    /// Median.
    colour: [f32; 3],
    /// Standard deviation of what has nothing to do with the scene.
    noise: [f32; 3],
}

impl Usual {
    fn of(calm: &[(usize, [f32; 3])]) -> Self {
        let median = |values: &mut Vec<f32>| match values.len() {
            0 => 0.0,
            count => *values.select_nth_unstable_by(count / 2, f32::total_cmp).1,
        };
        let colour = |channel: usize| median(&mut calm.iter().map(|(_, colour)| colour[channel]).collect());
        let noise = |channel: usize| {
            let steps = calm.windows(2).map(|pair| (pair[1].1[channel] - pair[0].1[channel]).abs());
            // From the median absolute difference of two to the standard deviation of one.
            median(&mut steps.collect()) * 1.4826 / std::f32::consts::SQRT_2
        };
        Self { colour: std::array::from_fn(colour), noise: std::array::from_fn(noise) }
    }
}

/// Variance of colours beyond that of their noise, mean over channels.
fn variance(calm: &[(usize, [f32; 3])], noise: &[f32; 3]) -> f32 {
    let count = calm.len().max(1) as f32;
    let beyond = |channel: usize| {
        let mean = calm.iter().map(|(_, colour)| colour[channel]).sum::<f32>() / count;
        let squares = calm.iter().map(|(_, colour)| (colour[channel] - mean).powi(2)).sum::<f32>();
        (squares / count - noise[channel].powi(2)).max(0.0)
    };
    (0..3).map(beyond).sum::<f32>() / 3.0
}

fn mean_colour(shot: &Shot, moment: usize, around: impl Iterator<Item = usize>) -> [f32; 3] {
    let (mut sum, mut count) = ([0_u32; 3], 0_u32);
    for pixel in around {
        let colour = shot.picture(moment).colour[pixel];
        for (sum, byte) in sum.iter_mut().zip(colour) {
            *sum += u32::from(byte);
        }
        count += 1;
    }
    sum.map(|sum| sum as f32 / (255 * count.max(1)) as f32)
}

fn mean_of(shot: &Shot, pixel: usize, moments: impl Iterator<Item = usize>) -> Option<[f32; 3]> {
    mean(moments.map(|moment| shot.picture(moment).colour_of(pixel)))
}

fn mean(colours: impl Iterator<Item = [f32; 3]>) -> Option<[f32; 3]> {
    let (mut sum, mut count) = ([0.0; 3], 0_u32);
    for colour in colours {
        for (sum, value) in sum.iter_mut().zip(colour) {
            *sum += value;
        }
        count += 1;
    }
    (count > 0).then(|| sum.map(|sum| sum / count as f32))
}

/// Indices of the 3 x 3 pixels around one, within the picture.
fn neighbourhood(pixel: usize, size: [u32; 2]) -> impl Iterator<Item = usize> + Clone {
    let [width, height] = size.map(|side| side as usize);
    let (row, column) = (pixel / width, pixel % width);
    (row.saturating_sub(1)..(row + 2).min(height)).flat_map(move |row| {
        (column.saturating_sub(1)..(column + 2).min(width)).map(move |column| row * width + column)
    })
}

/// Asks all standing cameras about the ground of one of them.
fn judge(
    footage: &Footage,
    grounds: &[Option<(Ground, Vec<Unrest>)>],
    index: usize,
    ground: &Ground,
    threshold: f32,
) -> Vec<Kind> {
    let size = footage.size();
    let placers: Vec<Option<Placer>> = footage
        .shots()
        .iter()
        .zip(grounds)
        .map(|(shot, ground)| ground.as_ref().map(|_| Placer::new(shot.view(0))))
        .collect();
    let Some(own) = &placers[index] else { return Vec::new() };
    (0..ground.depth_m.len())
        .into_par_iter()
        .with_min_len(1 << 12)
        .map(|pixel| {
            let depth_m = ground.depth_m[pixel];
            let (mut sum, mut witnesses) = (Unrest::default(), 0_u32);
            if !depth_m.is_finite() {
                // What is infinitely far cannot be seen through.
                let unrest = grounds[index].as_ref().map(|(_, unrest)| unrest[pixel]);
                return kind_of(unrest.unwrap_or_default(), threshold);
            }
            let point = own.world(own.centre_of(pixel), depth_m);
            for (placer, found) in placers.iter().zip(grounds) {
                let (Some(placer), Some((other, unrest))) = (placer, found) else { continue };
                let Some((seen, z_m)) = placer.pixel(point) else { continue };
                let nearest =
                    neighbourhood(seen, size).map(|pixel| other.depth_m[pixel]).fold(f32::INFINITY, f32::min);
                if nearest > z_m + 2.0 * tolerance(z_m) {
                    return Kind::Moves;
                }
                if (other.depth_m[seen] - z_m).abs() < 2.0 * tolerance(z_m) {
                    sum.odd += unrest[seen].odd;
                    sum.variance += unrest[seen].variance;
                    witnesses += 1;
                }
            }
            let share = 1.0 / witnesses.max(1) as f32;
            kind_of(Unrest { odd: share * sum.odd, variance: share * sum.variance }, threshold)
        })
        .collect()
}

fn kind_of(unrest: Unrest, threshold: f32) -> Kind {
    let often = unrest.odd >= threshold.max(LEAST_FLICKER);
    if often && unrest.variance >= LEAST_SWING * LEAST_SWING { Kind::Flickers } else { Kind::Still }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::fake::World;

    /// Share of the grounds of all cameras that are of a kind.
    fn share(motion: &Motion, kind: Kind) -> f64 {
        let kinds: Vec<Kind> = (0..3).flat_map(|shot| motion.ground(shot).unwrap().kind.clone()).collect();
        kinds.iter().filter(|found| **found == kind).count() as f64 / kinds.len() as f64
    }

    #[test]
    fn nothing_moves_where_nothing_happens() {
        let footage = World::EMPTY.footage(12);
        let motion = Motion::of(&footage, 0.1);
        assert_eq!(share(&motion, Kind::Still), 1.0);
        assert!((0..footage.pixel_count()).all(|pixel| !motion.changes(&footage, 1, 5, pixel)));
        assert_eq!(motion.ground(0).unwrap().depth_m[7], 4.0);
    }

    #[test]
    fn what_passes_moves_and_what_it_hides_does_not() {
        let card = |moment: usize, moments: usize| Some(-1.5 + 2.4 * moment as f64 / moments as f64);
        let footage = World { card, ..World::EMPTY }.footage(12);
        let motion = Motion::of(&footage, 0.1);
        assert_eq!(share(&motion, Kind::Still), 1.0);
        for moment in [0, 5, 11] {
            for pixel in 0..footage.pixel_count() {
                let on_card = footage.shots()[1].picture(moment).depth_m[pixel].to_f32() == 3.0;
                assert_eq!(motion.moves(&footage, 1, moment, pixel), on_card, "{moment} {pixel}");
            }
        }
    }

    #[test]
    fn what_rests_and_then_goes_moves_all_the_time() {
        let card = |moment: usize, moments: usize| (4 * moment < 3 * moments).then_some(-0.3);
        let footage = World { card, ..World::EMPTY }.footage(12);
        let seen = |motion: &Motion| {
            (0..footage.pixel_count()).filter(|&pixel| motion.moves(&footage, 1, 0, pixel)).count()
        };
        assert!(seen(&Motion::of(&footage, 0.1)) > 30);
        // Gone for a quarter of the clip only: not enough for so high a threshold.
        assert_eq!(seen(&Motion::of(&footage, 0.5)), 0);
    }

    #[test]
    fn a_shadow_flickers_and_passing_noise_does_not() {
        let dusk = |moment: usize, moments: usize| if 2 * moment < moments { 1.0 } else { 0.5 };
        let footage = World { light: dusk, ..World::EMPTY }.footage(12);
        let lower = share(&Motion::of(&footage, 0.1), Kind::Flickers);
        assert!((0.4..0.6).contains(&lower), "{lower}");
        let grain = |moment: usize, _| 1.0 + 0.02 * ((moment * 7 % 5) as f64 - 2.0);
        let footage = World { light: grain, ..World::EMPTY }.footage(12);
        assert_eq!(share(&Motion::of(&footage, 0.1), Kind::Flickers), 0.0);
    }

    #[test]
    fn a_ground_that_flickers_changes_only_while_it_does() {
        let dusk = |moment: usize, _| if moment < 4 { 0.4 } else { 1.0 };
        let footage = World { light: dusk, ..World::EMPTY }.footage(12);
        let motion = Motion::of(&footage, 0.1);
        let changing = |moment| {
            let changes =
                (0..footage.pixel_count()).filter(|&pixel| motion.changes(&footage, 1, moment, pixel));
            changes.count() as f64 / footage.pixel_count() as f64
        };
        assert!((0.4..0.6).contains(&changing(2)), "{}", changing(2));
        assert_eq!(changing(8), 0.0);
        assert!(
            (0..footage.pixel_count())
                .all(|pixel| { Motion::of(&World::EMPTY.footage(2), 0.0).changes(&footage, 1, 0, pixel) })
        );
    }

    #[test]
    fn a_faint_swing_is_not_worth_a_field() {
        // Half of the time 0.05 darker at most: a standard deviation of 0.025.
        let faint = |moment: usize, _| if moment.is_multiple_of(4) { 0.92 } else { 1.0 };
        let footage = World { light: faint, ..World::EMPTY }.footage(12);
        assert_eq!(share(&Motion::of(&footage, 0.1), Kind::Flickers), 0.0);
    }

    #[test]
    fn the_threshold_makes_everything_dynamic_or_nothing() {
        let card = |moment: usize, moments: usize| (2 * moment < moments).then_some(-0.3);
        let footage = World { card, ..World::EMPTY }.footage(12);
        assert_eq!(share(&Motion::of(&footage, 0.0), Kind::Flickers), 1.0);
        let frozen = Motion::of(&footage, 1.1);
        assert_eq!(share(&frozen, Kind::Still), 1.0);
        let moving =
            |moment| (0..footage.pixel_count()).any(|pixel| frozen.moves(&footage, 1, moment, pixel));
        assert!(!moving(0));
    }
}
