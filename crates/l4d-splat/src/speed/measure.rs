//! How long a way of drawing takes, and how far its pictures are off.

use std::time::Instant;

use l4d_frames::display::resized;
use rayon::prelude::*;

use super::subject::{Key, Subject};
use super::variants::Variant;
use super::{Result, plain};
use crate::clip::{ClipError, TimeViews};
use crate::raster::{Drawing, RasterSettings, Rasterizer, Reference};
use crate::train::decibels;

/// Views that share the state of a moment in a clip.
pub const CLIP_VIEWS: f64 = 8.0;

/// The unreduced model, drawn by the reference; display colours and median depths per picture.
pub(super) struct Truth {
    pictures: Vec<(Vec<[f32; 3]>, Vec<f32>)>,
}

/// What is known of a way of drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measured {
    pub(super) pictures: usize,
    /// State of a moment; drawing of one picture of it: medians, milliseconds.
    pub(super) deform_ms: f64,
    pub(super) draw_ms: f64,
    /// Mean over held-out pictures, dB.
    pub(super) psnr_db: Option<f64>,
    /// Against the truth, over all pictures, dB.
    pub(super) reference_psnr_db: f64,
    /// Of display colour, which goes from 0 to 1.
    pub(super) error_max: f64,
    pub(super) error_mean: f64,
    /// Of median depth where both have one, metres.
    pub(super) depth_error_mean_m: Option<f64>,
}

impl Truth {
    pub(super) fn draw(subject: &Subject) -> Result<Self> {
        let book = Reference;
        let mut pictures = Vec::new();
        for TimeViews { time, views } in subject.moments(subject.size)? {
            let splats = subject.model.at(time).map_err(plain)?;
            let drawn = views.par_iter().map(|(_, view)| {
                let drawing = book.prepare(&splats, view, &RasterSettings::default());
                let drawing = drawing.and_then(|projected| projected.draw()).map_err(plain)?;
                Ok(shown(&drawing))
            });
            pictures.extend(drawn.collect::<Result<Vec<_>>>()?);
        }
        Ok(Self { pictures })
    }
}

/// Measures all ways of drawing: one pass over all pictures each, which says what they show, then `repeats` timed ones.
/// They take turns, so that a backend that has other things to do for a while does them to all.
pub(super) fn measure(
    subject: &Subject,
    truth: &Truth,
    variants: &[Variant<'_>],
    repeats: u32,
    progress: &dyn Fn(),
) -> Result<Vec<Measured>> {
    let run = |variant: &Variant<'_>| {
        progress();
        let pass = || pass(subject, variant);
        variant.backend.pool.as_ref().map_or_else(pass, |pool| pool.install(pass))
    };
    let mut measured = Vec::new();
    for variant in variants {
        measured.push(measured_of(subject, truth, &run(variant)?.0));
    }
    let mut times: Vec<Times> = variants.iter().map(|_| Times::default()).collect();
    for _ in 0..repeats {
        for (variant, times) in variants.iter().zip(&mut times) {
            let more = run(variant)?.1;
            times.deform_ms.extend(more.deform_ms);
            times.draw_ms.extend(more.draw_ms);
        }
    }
    for (measured, times) in measured.iter_mut().zip(times) {
        measured.deform_ms = median(times.deform_ms);
        measured.draw_ms = median(times.draw_ms);
    }
    Ok(measured)
}

#[derive(Default)]
struct Times {
    deform_ms: Vec<f64>,
    draw_ms: Vec<f64>,
}

/// Draws everything once, picture after picture.
fn pass(subject: &Subject, variant: &Variant<'_>) -> Result<(Vec<(Key, Drawing)>, Times)> {
    let (rasterizer, settings) = (&variant.backend.rasterizer, RasterSettings::default());
    let mut times = Times::default();
    let mut drawings = Vec::new();
    for TimeViews { time, views } in subject.moments(variant.size)? {
        let start = Instant::now();
        let splats = variant.model.at(time).map_err(|source| plain(ClipError::Model { time, source }))?;
        times.deform_ms.push(milliseconds(start));
        for (key, view) in views {
            let start = Instant::now();
            let drawing = rasterizer
                .prepare(&splats, &view, &settings)
                .and_then(|projected| projected.draw())
                .map_err(|source| plain(ClipError::Raster { time, source }))?;
            times.draw_ms.push(milliseconds(start));
            drawings.push((key, drawing));
        }
    }
    Ok((drawings, times))
}

/// What pictures say; times are left at 0.
fn measured_of(subject: &Subject, truth: &Truth, drawings: &[(Key, Drawing)]) -> Measured {
    let (mut largest, mut sum, mut squares, mut count) = (0.0_f64, 0.0, 0.0, 0_u64);
    let (mut depth_sum, mut depth_count) = (0.0, 0_u64);
    let mut held_out = Vec::new();
    for (key, drawing) in drawings {
        let (colour, depth_m) = enlarged(drawing, subject.size);
        if let Some((true_colour, true_depth_m)) = truth.pictures.get(subject.place(*key)) {
            for (a, b) in colour.as_flattened().iter().zip(true_colour.as_flattened()) {
                let error = f64::from((a - b).abs());
                largest = largest.max(error);
                sum += error;
                squares += error * error;
                count += 1;
            }
            let both = depth_m.iter().zip(true_depth_m).filter(|(a, b)| a.is_finite() && b.is_finite());
            for (a, b) in both {
                depth_sum += f64::from((a - b).abs());
                depth_count += 1;
            }
        }
        // The held-out camera is the first.
        let seen = subject.seen.as_ref().filter(|_| key.camera == 0);
        if let Some(seen) = seen.and_then(|seen| seen.get(key.time)) {
            let error = |(value, &byte): (&f32, &u8)| f64::from(value - f32::from(byte) / 255.0).powi(2);
            let squares: f64 = colour.as_flattened().iter().zip(seen).map(error).sum();
            held_out.push(decibels(squares / seen.len() as f64));
        }
    }
    let mean = |sum: f64, count: u64| sum / count.max(1) as f64;
    Measured {
        pictures: drawings.len(),
        deform_ms: 0.0,
        draw_ms: 0.0,
        psnr_db: (!held_out.is_empty()).then(|| held_out.iter().sum::<f64>() / held_out.len() as f64),
        reference_psnr_db: decibels(mean(squares, count)),
        error_max: largest,
        error_mean: mean(sum, count),
        depth_error_mean_m: (depth_count > 0).then(|| mean(depth_sum, depth_count)),
    }
}

fn shown(drawing: &Drawing) -> (Vec<[f32; 3]>, Vec<f32>) {
    let colour = drawing.colour.iter().map(|pixel| pixel.map(|value| value.clamp(0.0, 1.0))).collect();
    let depth_m = drawing.quantiles.as_ref().map(|quantiles| quantiles.median_m.clone());
    (colour, depth_m.unwrap_or_default())
}

/// A drawing in another size: colours blended between pixel centres, depths of the nearest one.
fn enlarged(drawing: &Drawing, [width, height]: [u32; 2]) -> (Vec<[f32; 3]>, Vec<f32>) {
    let (colour, depth_m) = shown(drawing);
    if [drawing.width, drawing.height] == [width, height] {
        return (colour, depth_m);
    }
    let colour = resized(colour, [drawing.width, drawing.height], [width, height]);
    let near = |place: u32, from: u32, to: u32| ((2 * place + 1) * from / (2 * to)) as usize;
    let depth_m = (0..height * width).filter_map(|pixel| {
        let row = near(pixel / width, drawing.height, height);
        depth_m.get(row * drawing.width as usize + near(pixel % width, drawing.width, width)).copied()
    });
    let depth_m = depth_m.collect();
    (colour, depth_m)
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

/// The middle of the values, or the mean of the two in the middle; 0 without values.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => 0.0,
        count if count % 2 == 1 => values[middle],
        _ => (values[middle - 1] + values[middle]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::DepthQuantiles;

    #[test]
    fn medians_by_hand() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median(Vec::new()), 0.0);
    }

    #[test]
    fn enlarging_keeps_ramps_and_blends_between_centres() {
        let quantiles = DepthQuantiles { median_m: vec![1.0, 2.0], ..DepthQuantiles::default() };
        let colour = vec![[0.0; 3], [1.0; 3]];
        let drawing =
            Drawing { width: 2, height: 1, colour, quantiles: Some(quantiles), ..Drawing::default() };
        let (colour, depth_m) = enlarged(&drawing, [4, 2]);
        let row: Vec<f32> = colour[..4].iter().map(|pixel| pixel[0]).collect();
        assert_eq!(row, [0.0, 0.25, 0.75, 1.0]);
        assert_eq!(&colour[4..], &colour[..4]);
        assert_eq!(&depth_m[..4], [1.0, 1.0, 2.0, 2.0]);
        assert_eq!(enlarged(&drawing, [2, 1]), shown(&drawing));
    }
}
