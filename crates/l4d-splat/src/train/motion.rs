//! Which pixels are static, by depth and colour alone, or by colour where there is no depth
//! (`by_colour`).
//!
//! A static camera sees, through each pixel, a *background*: the farthest surface that was there at enough moments.
//! Whatever is nearer at a moment moves, since the background was seen through the place where it is. A background moves too
//! if another camera sees through it, and it *flickers* if its colour leaves its usual value beyond the noise, often
//! and far enough to be worth the effort (a shadow falls on it, a picture on a screen changes). What hides a background
//! for a while says nothing against it.
//! Knows no instances: ids are never looked at.

mod by_colour;

use rayon::prelude::*;

pub(super) use self::by_colour::Bits;
use super::pinhole::Pinhole;
use super::views::{TrainingCamera, TrainingViews};

/// How far two depths of one surface may be apart: absolute, metres, and relative.
const TOLERANCE: [f32; 2] = [0.002, 0.003];
/// A colour is unusual beyond this, display units, plus [`NOISES`] times the noise of its pixel.
const UNUSUAL: f32 = 0.04;
const NOISES: f32 = 4.0;
/// Share of calm moments with unusual colour from which on a background flickers, whatever the threshold says.
const LEAST_FLICKER: f32 = 0.03;
/// A static background whose colour swings costs the square of this, in display units beyond the noise;
/// the pictures of a rendered scene have noise of that size.
const LEAST_SWING: f32 = 0.03;

/// How the colour of a background changes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct ColourChange {
    /// Share of calm moments with unusual colour.
    odd: f32,
    /// Variance over calm moments beyond that of the noise, mean over channels.
    variance: f32,
}

/// What the background of a pixel does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SurfaceKind {
    /// The same at all times.
    Static,
    /// Stands, but changes colour.
    Flickering,
    /// Another camera saw through it: no background, but something that rested.
    Moving,
}

/// What a static camera sees where nothing is in the way, row-major.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Background {
    /// Planar depth, metres; +inf where nothing is hit, NaN where it is unknown.
    pub(crate) depth_m: Vec<f32>,
    /// Mean display colour over calm moments.
    pub(crate) colour: Vec<[f32; 3]>,
    pub(crate) kind: Vec<SurfaceKind>,
}

/// The backgrounds of all cameras.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    /// One per camera; none for a camera that moves.
    backgrounds: Vec<Option<Background>>,
    /// Nothing is known to stand still.
    everything: bool,
    /// Where depth was not measured: pixels that move, by camera and moment; nothing for cameras without a background.
    odd: Option<Vec<Vec<Bits>>>,
}

impl Motion {
    /// Looks at all pictures. `threshold` is the share of moments at which something has to be contradicted before it
    /// counts as moving; 0 makes everything dynamic, more than 1 nothing.
    pub(crate) fn of(views: &TrainingViews, threshold: f32) -> Self {
        if !views.has_depth() {
            return by_colour::motion(views, threshold);
        }
        let moments = views.moments();
        let needed = ((threshold * moments as f32).ceil() as usize).clamp(1, moments + 1);
        let backgrounds: Vec<Option<(Background, Vec<ColourChange>)>> = views
            .cameras()
            .par_iter()
            .map(|camera| camera.is_static().then(|| background_of(camera, views.size(), needed)))
            .collect();
        let kinds: Vec<Vec<SurfaceKind>> = (0..backgrounds.len())
            .map(|index| match (&backgrounds[index], threshold > 0.0) {
                (Some((background, _)), true) => classify(views, &backgrounds, index, background, threshold),
                (Some((background, _)), false) => vec![SurfaceKind::Flickering; background.depth_m.len()],
                (None, _) => Vec::new(),
            })
            .collect();
        let judged = |(found, kind): (Option<(Background, Vec<ColourChange>)>, Vec<SurfaceKind>)| {
            found.map(|(background, _)| Background { kind, ..background })
        };
        let backgrounds = backgrounds.into_iter().zip(kinds).map(judged).collect();
        Self { backgrounds, everything: threshold <= 0.0, odd: None }
    }

    /// Whether anything is known to stand still.
    pub(crate) fn tells_apart(&self) -> bool {
        !self.everything
    }

    /// The background of a camera; none if it moves.
    pub(crate) fn background(&self, camera: usize) -> Option<&Background> {
        self.backgrounds.get(camera)?.as_ref()
    }

    /// Whether what a pixel shows at a moment is something that moves; everything is, for a moving camera.
    pub(crate) fn moves(&self, views: &TrainingViews, camera: usize, moment: usize, pixel: usize) -> bool {
        self.background(camera).is_none_or(|background| {
            if let Some(odd) = &self.odd {
                return odd[camera][moment].get(pixel);
            }
            let depth_m = views.cameras()[camera].picture(moment).depth_m[pixel].to_f32();
            background.kind[pixel] == SurfaceKind::Moving || !same_depth(depth_m, background.depth_m[pixel])
        })
    }

    /// Whether what a pixel shows at a moment moves, or has not the colour that its background usually has.
    pub(crate) fn changes(&self, views: &TrainingViews, camera: usize, moment: usize, pixel: usize) -> bool {
        self.moves(views, camera, moment, pixel)
            || self.everything
            || self.background(camera).is_some_and(|background| {
                let around = || neighbourhood(pixel, views.size());
                let differs = || {
                    let now = mean_colour(&views.cameras()[camera], moment, around());
                    let usual = mean(around().map(|pixel| background.colour[pixel])).unwrap_or_default();
                    std::iter::zip(now, usual).any(|(now, usual)| (now - usual).abs() > UNUSUAL)
                };
                background.kind[pixel] == SurfaceKind::Flickering && differs()
            })
    }
}

/// Relative errors of the depths of backgrounds found by comparing pictures, where nothing ever moves; 1 where nothing
/// was found.
#[cfg(test)]
pub(crate) fn background_errors(truth: &TrainingViews) -> Vec<f32> {
    let (known, found) = (Motion::of(truth, 0.05), Motion::of(&truth.of_colour(), 0.05));
    let mut errors = Vec::new();
    for camera in 0..truth.cameras().len() {
        let (Some(known_m), Some(found_m)) = (known.background(camera), found.background(camera)) else {
            continue;
        };
        let rests =
            |pixel: &usize| (0..truth.moments()).all(|moment| !known.moves(truth, camera, moment, *pixel));
        let is_hit = |pixel: &usize| known_m.depth_m[*pixel].is_finite();
        for pixel in (0..truth.pixel_count()).filter(is_hit).filter(rests) {
            let [known_m, found_m] = [known_m, found_m].map(|background| background.depth_m[pixel]);
            let error = (found_m - known_m).abs() / known_m;
            errors.push(if error.is_finite() { error.min(1.0) } else { 1.0 });
        }
    }
    errors
}

/// Metres by which two depths of one surface may differ.
pub(super) fn tolerance(depth_m: f32) -> f32 {
    TOLERANCE[0] + TOLERANCE[1] * depth_m
}

fn same_depth(a_m: f32, b_m: f32) -> bool {
    a_m == b_m || (a_m - b_m).abs() < tolerance(a_m.min(b_m))
}

/// The background of a static camera with all kinds still open, and how restless it is.
fn background_of(camera: &TrainingCamera, size: [u32; 2], needed: usize) -> (Background, Vec<ColourChange>) {
    let pixels = size[0] as usize * size[1] as usize;
    let moments = camera.pictures().len();
    let depth_m: Vec<f32> = (0..pixels)
        .map(|pixel| {
            let mut depths: Vec<f32> =
                camera.pictures().iter().map(|picture| picture.depth_m[pixel].to_f32()).collect();
            let rank = needed.min(moments) - 1;
            *depths.select_nth_unstable_by(rank, |a, b| b.total_cmp(a)).1
        })
        .collect();
    // Moments at which a pixel shows its background.
    let bare: Vec<Vec<bool>> = camera
        .pictures()
        .iter()
        .map(|picture| {
            std::iter::zip(&picture.depth_m, &depth_m)
                .map(|(depth_m, &background_m)| same_depth(depth_m.to_f32(), background_m))
                .collect()
        })
        .collect();
    let mut colour = Vec::with_capacity(pixels);
    let mut change = Vec::with_capacity(pixels);
    let mut calm = Vec::with_capacity(moments);
    for pixel in 0..pixels {
        let around = neighbourhood(pixel, size);
        calm.clear();
        for (moment, bare) in bare.iter().enumerate() {
            // Where something passes next to the pixel, its edge is mixed into the colour.
            if around.clone().all(|neighbour| bare[neighbour]) {
                calm.push((moment, mean_colour(camera, moment, around.clone())));
            }
        }
        let UsualColour { colour: usual, noise } = UsualColour::of(&calm);
        let unusual = |colour: &[f32; 3]| {
            (0..3).any(|channel| (colour[channel] - usual[channel]).abs() > UNUSUAL + NOISES * noise[channel])
        };
        let steady = calm.iter().filter(|(_, colour)| !unusual(colour)).map(|&(moment, _)| moment);
        let bare_at = (0..moments).filter(|&moment| bare[moment][pixel]);
        let mean = mean_of(camera, pixel, steady).or_else(|| mean_of(camera, pixel, bare_at));
        colour.push(mean.unwrap_or(usual));
        let odd = calm.iter().filter(|(_, colour)| unusual(colour)).count();
        change.push(ColourChange {
            odd: odd as f32 / calm.len().max(1) as f32,
            variance: variance(&calm, &noise),
        });
    }
    (Background { depth_m, colour, kind: Vec::new() }, change)
}

/// What a pixel mostly shows.
struct UsualColour {
    colour: [f32; 3],
    /// Standard deviation of what has nothing to do with the scene.
    noise: [f32; 3],
}

impl UsualColour {
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

fn mean_colour(camera: &TrainingCamera, moment: usize, around: impl Iterator<Item = usize>) -> [f32; 3] {
    let (mut sum, mut count) = ([0_u32; 3], 0_u32);
    for pixel in around {
        let colour = camera.picture(moment).colour[pixel];
        for (sum, byte) in sum.iter_mut().zip(colour) {
            *sum += u32::from(byte);
        }
        count += 1;
    }
    sum.map(|sum| sum as f32 / (255 * count.max(1)) as f32)
}

fn mean_of(camera: &TrainingCamera, pixel: usize, moments: impl Iterator<Item = usize>) -> Option<[f32; 3]> {
    mean(moments.map(|moment| camera.picture(moment).colour_of(pixel)))
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

/// Asks all static cameras about the background of one of them.
fn classify(
    views: &TrainingViews,
    backgrounds: &[Option<(Background, Vec<ColourChange>)>],
    index: usize,
    background: &Background,
    threshold: f32,
) -> Vec<SurfaceKind> {
    let size = views.size();
    let pinholes: Vec<Option<Pinhole>> = views
        .cameras()
        .iter()
        .zip(backgrounds)
        .map(|(camera, background)| background.as_ref().map(|_| Pinhole::new(camera.view(0))))
        .collect();
    let Some(own) = &pinholes[index] else { return Vec::new() };
    (0..background.depth_m.len())
        .into_par_iter()
        .with_min_len(1 << 12)
        .map(|pixel| {
            let depth_m = background.depth_m[pixel];
            let (mut sum, mut witnesses) = (ColourChange::default(), 0_u32);
            if !depth_m.is_finite() {
                // What is infinitely far cannot be seen through.
                let change = backgrounds[index].as_ref().map(|(_, change)| change[pixel]);
                return kind_of(change.unwrap_or_default(), threshold);
            }
            let point = own.world(own.centre_of(pixel), depth_m);
            for (pinhole, found) in pinholes.iter().zip(backgrounds) {
                let (Some(pinhole), Some((other, change))) = (pinhole, found) else { continue };
                let Some((seen, z_m)) = pinhole.pixel(point) else { continue };
                let nearest =
                    neighbourhood(seen, size).map(|pixel| other.depth_m[pixel]).fold(f32::INFINITY, f32::min);
                if nearest > z_m + 2.0 * tolerance(z_m) {
                    return SurfaceKind::Moving;
                }
                if (other.depth_m[seen] - z_m).abs() < 2.0 * tolerance(z_m) {
                    sum.odd += change[seen].odd;
                    sum.variance += change[seen].variance;
                    witnesses += 1;
                }
            }
            let share = 1.0 / witnesses.max(1) as f32;
            kind_of(ColourChange { odd: share * sum.odd, variance: share * sum.variance }, threshold)
        })
        .collect()
}

fn kind_of(change: ColourChange, threshold: f32) -> SurfaceKind {
    let often = change.odd >= threshold.max(LEAST_FLICKER);
    if often && change.variance >= LEAST_SWING * LEAST_SWING {
        SurfaceKind::Flickering
    } else {
        SurfaceKind::Static
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::test_world::World;

    /// Share of the backgrounds of all cameras that are of a kind.
    fn share(motion: &Motion, kind: SurfaceKind) -> f64 {
        let kinds: Vec<SurfaceKind> =
            (0..3).flat_map(|camera| motion.background(camera).unwrap().kind.clone()).collect();
        kinds.iter().filter(|found| **found == kind).count() as f64 / kinds.len() as f64
    }

    #[test]
    fn nothing_moves_where_nothing_happens() {
        let views = World::EMPTY.views(12);
        let motion = Motion::of(&views, 0.1);
        assert_eq!(share(&motion, SurfaceKind::Static), 1.0);
        assert!((0..views.pixel_count()).all(|pixel| !motion.changes(&views, 1, 5, pixel)));
        assert_eq!(motion.background(0).unwrap().depth_m[7], 4.0);
    }

    #[test]
    fn what_passes_moves_and_what_it_hides_does_not() {
        let card = |moment: usize, moments: usize| Some(-1.5 + 2.4 * moment as f64 / moments as f64);
        let views = World { card, ..World::EMPTY }.views(12);
        let motion = Motion::of(&views, 0.1);
        assert_eq!(share(&motion, SurfaceKind::Static), 1.0);
        for moment in [0, 5, 11] {
            for pixel in 0..views.pixel_count() {
                let on_card = views.cameras()[1].picture(moment).depth_m[pixel].to_f32() == 3.0;
                assert_eq!(motion.moves(&views, 1, moment, pixel), on_card, "{moment} {pixel}");
            }
        }
    }

    #[test]
    fn what_rests_and_then_goes_moves_all_the_time() {
        let card = |moment: usize, moments: usize| (4 * moment < 3 * moments).then_some(-0.3);
        let views = World { card, ..World::EMPTY }.views(12);
        let seen = |motion: &Motion| {
            (0..views.pixel_count()).filter(|&pixel| motion.moves(&views, 1, 0, pixel)).count()
        };
        assert!(seen(&Motion::of(&views, 0.1)) > 30);
        // Gone for a quarter of the clip only: not enough for so high a threshold.
        assert_eq!(seen(&Motion::of(&views, 0.5)), 0);
    }

    #[test]
    fn a_shadow_flickers_and_passing_noise_does_not() {
        let dusk = |moment: usize, moments: usize| if 2 * moment < moments { 1.0 } else { 0.5 };
        let views = World { light: dusk, ..World::EMPTY }.views(12);
        let lower = share(&Motion::of(&views, 0.1), SurfaceKind::Flickering);
        assert!((0.4..0.6).contains(&lower), "{lower}");
        let grain = |moment: usize, _| 1.0 + 0.02 * ((moment * 7 % 5) as f64 - 2.0);
        let views = World { light: grain, ..World::EMPTY }.views(12);
        assert_eq!(share(&Motion::of(&views, 0.1), SurfaceKind::Flickering), 0.0);
    }

    #[test]
    fn a_ground_that_flickers_changes_only_while_it_does() {
        let dusk = |moment: usize, _| if moment < 4 { 0.4 } else { 1.0 };
        let views = World { light: dusk, ..World::EMPTY }.views(12);
        let motion = Motion::of(&views, 0.1);
        let changing = |moment| {
            let changes = (0..views.pixel_count()).filter(|&pixel| motion.changes(&views, 1, moment, pixel));
            changes.count() as f64 / views.pixel_count() as f64
        };
        assert!((0.4..0.6).contains(&changing(2)), "{}", changing(2));
        assert_eq!(changing(8), 0.0);
        assert!(
            (0..views.pixel_count())
                .all(|pixel| { Motion::of(&World::EMPTY.views(2), 0.0).changes(&views, 1, 0, pixel) })
        );
    }

    #[test]
    fn a_faint_swing_is_not_worth_a_field() {
        // Half of the time 0.05 darker at most: a standard deviation of 0.025.
        let faint = |moment: usize, _| if moment.is_multiple_of(4) { 0.92 } else { 1.0 };
        let views = World { light: faint, ..World::EMPTY }.views(12);
        assert_eq!(share(&Motion::of(&views, 0.1), SurfaceKind::Flickering), 0.0);
    }

    #[test]
    fn the_threshold_makes_everything_dynamic_or_nothing() {
        let card = |moment: usize, moments: usize| (2 * moment < moments).then_some(-0.3);
        let views = World { card, ..World::EMPTY }.views(12);
        assert_eq!(share(&Motion::of(&views, 0.0), SurfaceKind::Flickering), 1.0);
        let frozen = Motion::of(&views, 1.1);
        assert_eq!(share(&frozen, SurfaceKind::Static), 1.0);
        let moving = |moment| (0..views.pixel_count()).any(|pixel| frozen.moves(&views, 1, moment, pixel));
        assert!(!moving(0));
    }
}
