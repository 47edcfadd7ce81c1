//! What moves where there is no depth: pixels that have another colour than they usually have.
//!
//! The background of a pixel is what it mostly shows, as far away as comparing the backgrounds of all static cameras tells. What
//! has another colour at a moment moves. A background that has another colour at enough moments flickers: it may be a thing
//! that rests for most of the clip, so that its Gaussians must be able to go.

use rayon::prelude::*;

use super::super::stereo::{StereoImage, depths};
use super::super::views::{TrainingCamera, TrainingViews};
use super::{
    Background, LEAST_FLICKER, Motion, NOISES, SurfaceKind, UNUSUAL, UsualColour, mean_colour, mean_of,
    neighbourhood,
};

/// Odd pixels with fewer odd ones among the nine around them are noise.
const LEAST_ODD: usize = 4;

/// One bit per pixel, row-major.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::train) struct Bits(Vec<u64>);

impl Bits {
    pub(in crate::train) fn of(marks: &[bool]) -> Self {
        let word = |marks: &[bool]| {
            marks.iter().enumerate().fold(0, |word, (place, &mark)| word | u64::from(mark) << place)
        };
        Self(marks.chunks(64).map(word).collect())
    }

    pub(in crate::train) fn get(&self, pixel: usize) -> bool {
        self.0.get(pixel / 64).is_some_and(|word| word >> (pixel % 64) & 1 == 1)
    }
}

/// Looks at all pictures; `threshold` as in [`Motion::of`].
pub(super) fn motion(views: &TrainingViews, threshold: f32) -> Motion {
    let size = views.size();
    // A camera that saw less of the clip cannot tell what it usually shows.
    let sees_enough =
        |camera: &TrainingCamera| camera.is_static() && 2 * seen(camera).count() >= views.moments();
    let found: Vec<Option<(Background, Vec<Bits>)>> = views
        .cameras()
        .par_iter()
        .map(|camera| sees_enough(camera).then(|| background_of(camera, size, threshold)))
        .collect();
    let (mut backgrounds, odd): (Vec<Option<Background>>, Vec<Vec<Bits>>) = found
        .into_iter()
        .map(|found| found.map_or((None, Vec::new()), |(background, odd)| (Some(background), odd)))
        .unzip();
    measure(views, &mut backgrounds);
    Motion { backgrounds, everything: threshold <= 0.0, odd: Some(odd) }
}

fn seen(camera: &TrainingCamera) -> impl Iterator<Item = usize> {
    (0..camera.pictures().len()).filter(|&moment| camera.has_picture(moment))
}

/// The background of a static camera, its depth still unknown, and what is odd at each moment.
fn background_of(camera: &TrainingCamera, size: [u32; 2], threshold: f32) -> (Background, Vec<Bits>) {
    let pixels = size[0] as usize * size[1] as usize;
    let moments: Vec<usize> = seen(camera).collect();
    // By moment; none for those that it did not see.
    let mut marks = vec![Vec::new(); camera.pictures().len()];
    let (mut colour, mut kind) = (Vec::with_capacity(pixels), Vec::with_capacity(pixels));
    let mut around = Vec::with_capacity(moments.len());
    for pixel in 0..pixels {
        around.clear();
        around.extend(
            moments.iter().map(|&moment| (moment, mean_colour(camera, moment, neighbourhood(pixel, size)))),
        );
        let UsualColour { colour: usual, noise } = UsualColour::of(&around);
        let is_odd = |colour: &[f32; 3]| {
            (0..3).any(|channel| (colour[channel] - usual[channel]).abs() > UNUSUAL + NOISES * noise[channel])
        };
        let odd: Vec<bool> = around.iter().map(|(_, colour)| is_odd(colour)).collect();
        let at = || around.iter().map(|&(moment, _)| moment).zip(odd.iter().copied());
        at().for_each(|(moment, odd)| marks[moment].push(odd));
        let steady = at().filter(|(_, odd)| !odd).map(|(moment, _)| moment);
        colour.push(mean_of(camera, pixel, steady).unwrap_or(usual));
        let share = odd.iter().filter(|odd| **odd).count() as f32 / moments.len().max(1) as f32;
        let flickers = threshold <= 0.0 || share >= threshold.max(LEAST_FLICKER);
        kind.push(if flickers { SurfaceKind::Flickering } else { SurfaceKind::Static });
    }
    let clean = |marks: &Vec<bool>| {
        let has_company = |pixel: usize| {
            marks[pixel] && neighbourhood(pixel, size).filter(|&pixel| marks[pixel]).count() >= LEAST_ODD
        };
        Bits::of(&(0..marks.len()).map(has_company).collect::<Vec<bool>>())
    };
    let odd = marks.iter().map(clean).collect();
    (Background { depth_m: vec![f32::NAN; pixels], colour, kind }, odd)
}

/// Finds how far away backgrounds are.
fn measure(views: &TrainingViews, backgrounds: &mut [Option<Background>]) {
    let known: Vec<usize> = (0..backgrounds.len()).filter(|&camera| backgrounds[camera].is_some()).collect();
    let bytes = |background: &Background| -> Vec<[u8; 3]> {
        background.colour.iter().map(|colour| colour.map(|value| (255.0 * value).round() as u8)).collect()
    };
    let colours: Vec<Vec<[u8; 3]>> =
        known.iter().filter_map(|&camera| backgrounds[camera].as_ref()).map(bytes).collect();
    let images: Vec<StereoImage<'_>> = known
        .iter()
        .zip(&colours)
        .map(|(&camera, colour)| StereoImage { view: views.cameras()[camera].view(0), colour })
        .collect();
    let wanted = vec![vec![true; views.pixel_count()]; known.len()];
    for (camera, depth_m) in known.iter().zip(depths(&images, &wanted)) {
        if let Some(background) = &mut backgrounds[*camera] {
            background.depth_m = depth_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::test_world::World;

    #[test]
    fn what_has_another_colour_than_usual_moves() {
        let card = |moment: usize, moments: usize| Some(-1.5 + 2.4 * moment as f64 / moments as f64);
        let measured = World { card, ..World::EMPTY }.views(12);
        let views = World { card, ..World::EMPTY }.views_without_depth(12);
        let motion = Motion::of(&views, 0.5);
        let (mut right, mut wrong) = (0, 0);
        for moment in [2, 5, 9] {
            for pixel in 0..views.pixel_count() {
                let on_card = measured.cameras()[1].picture(moment).depth_m[pixel].to_f32() == 3.0;
                let moves = motion.moves(&views, 1, moment, pixel);
                right += usize::from(on_card && moves);
                wrong += usize::from(on_card != moves);
            }
        }
        println!("{right} right, {wrong} wrong");
        // Means over nine pixels widen what moves by one.
        assert!(right > 200 && wrong < 3 * right / 4, "{right} right, {wrong} wrong");
        let background = motion.background(1).unwrap();
        assert!(background.kind.iter().all(|kind| *kind == SurfaceKind::Static));
        let near = |depth_m: &&f32| (**depth_m - 4.0).abs() < 0.3;
        assert!(background.depth_m.iter().filter(near).count() > views.pixel_count() / 2);
    }

    #[test]
    fn a_ground_that_is_often_odd_flickers() {
        let light = |moment: usize, moments: usize| if 3 * moment < moments { 0.5 } else { 1.0 };
        let views = World { light, ..World::EMPTY }.views_without_depth(12);
        let share = |threshold: f32| {
            let motion = Motion::of(&views, threshold);
            let kinds = &motion.background(1).unwrap().kind;
            kinds.iter().filter(|kind| **kind == SurfaceKind::Flickering).count() as f64 / kinds.len() as f64
        };
        assert!((share(0.2) - 0.5).abs() < 0.1, "{}", share(0.2));
        assert_eq!((share(0.4), share(0.0)), (0.0, 1.0));
    }
}
