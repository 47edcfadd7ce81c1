//! Scene-referred light to the bytes that a screen shows: clamp(sRGB_OETF(exposure * linear)).
//!
//! The one such function of the project: sheets, PNG exports, clips for grounders and PSNR all use it.

use half::f16;
use image::imageops::{FilterType, resize};
use image::{Rgb, Rgb32FImage, RgbImage};

use crate::frame::Frame;

/// The sRGB transfer function on linear light; clamps to 0..=1, and shows what is no number as black.
pub fn srgb_oetf(linear: f32) -> f32 {
    // `max` gives 0 for NaN, where `clamp` would give NaN.
    let linear = linear.max(0.0);
    if linear >= 1.0 {
        return 1.0;
    }
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The transform at one exposure, tabulated over all half floats.
#[derive(Debug, Clone)]
pub struct Display {
    byte_of_half: Vec<u8>,
}

impl Display {
    /// Exposure as in `scene.json`: a factor on linear light.
    pub fn new(exposure: f64) -> Self {
        let exposure = exposure as f32;
        let byte = |bits: u16| {
            let shown = srgb_oetf(exposure * f16::from_bits(bits).to_f32());
            (shown * 255.0).round() as u8
        };
        Self { byte_of_half: (0..=u16::MAX).map(byte).collect() }
    }

    /// One channel value.
    pub fn byte(&self, linear: f16) -> u8 {
        self.byte_of_half[usize::from(linear.to_bits())]
    }

    /// A whole frame.
    pub fn picture(&self, frame: &Frame) -> RgbImage {
        let mut pixels = frame.rgb.iter();
        RgbImage::from_fn(frame.surfaces.width, frame.surfaces.height, |_, _| {
            Rgb(pixels.next().map_or([0; 3], |pixel| pixel.map(|linear| self.byte(linear))))
        })
    }
}

/// Display colours, row by row, at another size (width, height): blended linearly between pixel centres.
pub fn resized(colour: Vec<[f32; 3]>, [width, height]: [u32; 2], to: [u32; 2]) -> Vec<[f32; 3]> {
    let picture = Rgb32FImage::from_raw(width, height, colour.into_flattened()).unwrap_or_default();
    resize(&picture, to[0], to[1], FilterType::Triangle).into_raw().as_chunks().0.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_points_of_the_curve() {
        // IEC 61966-2-1: linear 0.214041 shows as one half, 0.0031308 is the knee.
        assert!((srgb_oetf(0.214_041_14) - 0.5).abs() < 1e-6);
        assert!((srgb_oetf(0.003_130_8) - 0.040_449_94).abs() < 1e-6);
        assert_eq!([srgb_oetf(-1.0), srgb_oetf(f32::NAN), srgb_oetf(9.0)], [0.0, 0.0, 1.0]);
    }

    #[test]
    fn exposure_multiplies_light_before_the_curve() {
        let twice = Display::new(2.0);
        // 255 * (1.055 * 0.25^(1 / 2.4) - 0.055) = 136.96
        assert_eq!(
            [Display::new(1.0).byte(f16::from_f32(0.25)), twice.byte(f16::from_f32(0.125))],
            [137, 137]
        );
        assert_eq!(
            [twice.byte(f16::NAN), twice.byte(f16::INFINITY), twice.byte(f16::NEG_INFINITY)],
            [0, 255, 0]
        );
    }
}
