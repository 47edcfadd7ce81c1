//! What moves where nobody measured depth: pixels that have another colour than they usually have.
//!
//! The ground of a pixel is what it mostly shows, as far away as comparing the grounds of all standing cameras tells. What
//! has another colour at a moment moves. A ground that has another colour at enough moments flickers: it may be a thing
//! that rests for most of the clip, so that its Gaussians must be able to go.

use rayon::prelude::*;

use super::super::footage::{Footage, Shot};
use super::super::stereo::{Look, depths};
use super::{
    Ground, Kind, LEAST_FLICKER, Motion, NOISES, UNUSUAL, Usual, mean_colour, mean_of, neighbourhood,
};

/// Odd pixels with fewer odd ones among the nine around them are noise.
const LEAST_ODD: usize = 4;

/// One bit a pixel, row-major.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Bits(Vec<u64>);

impl Bits {
    fn of(marks: &[bool]) -> Self {
        let word = |marks: &[bool]| {
            marks.iter().enumerate().fold(0, |word, (place, &mark)| word | u64::from(mark) << place)
        };
        Self(marks.chunks(64).map(word).collect())
    }

    pub(super) fn get(&self, pixel: usize) -> bool {
        self.0.get(pixel / 64).is_some_and(|word| word >> (pixel % 64) & 1 == 1)
    }
}

/// Looks at all pictures; `threshold` as in [`Motion::of`].
pub(super) fn motion(footage: &Footage, threshold: f32) -> Motion {
    let size = footage.size();
    // A camera that saw less of the clip cannot tell what it usually shows.
    let is_told = |shot: &Shot| shot.stands() && 2 * seen(shot).count() >= footage.moments();
    let found: Vec<Option<(Ground, Vec<Bits>)>> = footage
        .shots()
        .par_iter()
        .map(|shot| is_told(shot).then(|| ground_of(shot, size, threshold)))
        .collect();
    let (mut grounds, odd): (Vec<Option<Ground>>, Vec<Vec<Bits>>) = found
        .into_iter()
        .map(|found| found.map_or((None, Vec::new()), |(ground, odd)| (Some(ground), odd)))
        .unzip();
    measure(footage, &mut grounds);
    Motion { grounds, everything: threshold <= 0.0, odd: Some(odd) }
}

fn seen(shot: &Shot) -> impl Iterator<Item = usize> {
    (0..shot.pictures().len()).filter(|&moment| shot.saw(moment))
}

/// The ground of a standing camera, its depth still unknown, and what is odd at each moment.
fn ground_of(shot: &Shot, size: [u32; 2], threshold: f32) -> (Ground, Vec<Bits>) {
    let pixels = size[0] as usize * size[1] as usize;
    let moments: Vec<usize> = seen(shot).collect();
    // By moment; none for those that it did not see.
    let mut marks = vec![Vec::new(); shot.pictures().len()];
    let (mut colour, mut kind) = (Vec::with_capacity(pixels), Vec::with_capacity(pixels));
    let mut around = Vec::with_capacity(moments.len());
    for pixel in 0..pixels {
        around.clear();
        around.extend(
            moments.iter().map(|&moment| (moment, mean_colour(shot, moment, neighbourhood(pixel, size)))),
        );
        let Usual { colour: usual, noise } = Usual::of(&around);
        let is_odd = |colour: &[f32; 3]| {
            (0..3).any(|channel| (colour[channel] - usual[channel]).abs() > UNUSUAL + NOISES * noise[channel])
        };
        let odd: Vec<bool> = around.iter().map(|(_, colour)| is_odd(colour)).collect();
        let at = || around.iter().map(|&(moment, _)| moment).zip(odd.iter().copied());
        at().for_each(|(moment, odd)| marks[moment].push(odd));
        let steady = at().filter(|(_, odd)| !odd).map(|(moment, _)| moment);
        colour.push(mean_of(shot, pixel, steady).unwrap_or(usual));
        let share = odd.iter().filter(|odd| **odd).count() as f32 / moments.len().max(1) as f32;
        let flickers = threshold <= 0.0 || share >= threshold.max(LEAST_FLICKER);
        kind.push(if flickers { Kind::Flickers } else { Kind::Still });
    }
    let clean = |marks: &Vec<bool>| {
        let has_company = |pixel: usize| {
            marks[pixel] && neighbourhood(pixel, size).filter(|&pixel| marks[pixel]).count() >= LEAST_ODD
        };
        Bits::of(&(0..marks.len()).map(has_company).collect::<Vec<bool>>())
    };
    let odd = marks.iter().map(clean).collect();
    (Ground { depth_m: vec![f32::NAN; pixels], colour, kind }, odd)
}

/// Finds how far away grounds are.
fn measure(footage: &Footage, grounds: &mut [Option<Ground>]) {
    let told: Vec<usize> = (0..grounds.len()).filter(|&shot| grounds[shot].is_some()).collect();
    let bytes = |ground: &Ground| -> Vec<[u8; 3]> {
        ground.colour.iter().map(|colour| colour.map(|value| (255.0 * value).round() as u8)).collect()
    };
    let colours: Vec<Vec<[u8; 3]>> =
        told.iter().filter_map(|&shot| grounds[shot].as_ref()).map(bytes).collect();
    let looks: Vec<Look<'_>> = told
        .iter()
        .zip(&colours)
        .map(|(&shot, colour)| Look { view: footage.shots()[shot].view(0), colour })
        .collect();
    let wanted = vec![vec![true; footage.pixel_count()]; told.len()];
    for (shot, depth_m) in told.iter().zip(depths(&looks, &wanted)) {
        if let Some(ground) = &mut grounds[*shot] {
            ground.depth_m = depth_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::fake::World;

    #[test]
    fn what_has_another_colour_than_usual_moves() {
        let card = |moment: usize, moments: usize| Some(-1.5 + 2.4 * moment as f64 / moments as f64);
        let measured = World { card, ..World::EMPTY }.footage(12);
        let footage = World { card, ..World::EMPTY }.bare_footage(12);
        let motion = Motion::of(&footage, 0.5);
        let (mut right, mut wrong) = (0, 0);
        for moment in [2, 5, 9] {
            for pixel in 0..footage.pixel_count() {
                let on_card = measured.shots()[1].picture(moment).depth_m[pixel].to_f32() == 3.0;
                let moves = motion.moves(&footage, 1, moment, pixel);
                right += usize::from(on_card && moves);
                wrong += usize::from(on_card != moves);
            }
        }
        println!("{right} right, {wrong} wrong");
        // Means over nine pixels widen what moves by one.
        assert!(right > 200 && wrong < 3 * right / 4, "{right} right, {wrong} wrong");
        let ground = motion.ground(1).unwrap();
        assert!(ground.kind.iter().all(|kind| *kind == Kind::Still));
        let near = |depth_m: &&f32| (**depth_m - 4.0).abs() < 0.3;
        assert!(ground.depth_m.iter().filter(near).count() > footage.pixel_count() / 2);
    }

    #[test]
    fn a_ground_that_is_often_odd_flickers() {
        let light = |moment: usize, moments: usize| if 3 * moment < moments { 0.5 } else { 1.0 };
        let footage = World { light, ..World::EMPTY }.bare_footage(12);
        let share = |threshold: f32| {
            let motion = Motion::of(&footage, threshold);
            let kinds = &motion.ground(1).unwrap().kind;
            kinds.iter().filter(|kind| **kind == Kind::Flickers).count() as f64 / kinds.len() as f64
        };
        assert!((share(0.2) - 0.5).abs() < 0.1, "{}", share(0.2));
        assert_eq!((share(0.4), share(0.0)), (0.0, 1.0));
    }
}
