//! Relevancy against a plain reference, and against masks that the originals' evaluation found (`fixture.py`).

use std::path::{Path, PathBuf};

use l4d_formats::{Tensor, arrays};
use l4d_import::results::relevancy::decoder::Layer;
use l4d_import::results::relevancy::{
    Decoder, Engine, Latents, Rules, Smoothing, TextEmbeddings, answer, gate,
};
use l4d_masks::Mask;
use proptest::prelude::*;

use crate::reference::Plain;

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/results/fixtures/relevancy.npz")
}

fn array(name: &str) -> Tensor {
    arrays::read(&fixture(), Some(name)).unwrap()
}

fn rules(smoothing: Smoothing) -> Rules {
    Rules { smoothing, threshold: 0.4, stretch_positive: false }
}

/// Masks of an array of sentences, rows and columns.
fn masks(name: &str) -> Vec<Mask> {
    let array = array(name);
    let (height, width) = (array.shape[1] as u32, array.shape[2] as u32);
    let picture = |values: &[f32]| {
        let inside: Vec<bool> = values.iter().map(|&value| value != 0.0).collect();
        Mask::from_bools(width, height, &inside).unwrap()
    };
    array.data.chunks_exact((width * height) as usize).map(picture).collect()
}

/// The originals' masks, levels and peaks, and their scores to 1e-4.
#[test]
fn the_originals_find_the_same() {
    let decoder = Decoder::read(&fixture()).unwrap();
    assert_eq!(decoder.widths(), "3 -> 16 -> 32 -> 64 -> 48");
    let width = decoder.outputs();
    let texts = TextEmbeddings::new(width, array("positives").data, array("negatives").data).unwrap();
    let engine = Engine::new(&decoder, &texts).unwrap();
    let levels = array("levels");
    let [_, height, width, channels] = levels.shape[..] else { panic!("{:?}", levels.shape) };
    let pictures: Vec<Latents<'_>> = levels
        .data
        .chunks_exact(height * width * channels)
        .map(|data| Latents { width: width as u32, height: height as u32, channels, data })
        .collect();
    for (name, smoothing) in [("box30", Smoothing::Box30), ("pool29", Smoothing::Pool29)] {
        let chosen = answer(&engine, &pictures, &rules(smoothing));
        let expected = masks(&format!("{name}.mask"));
        let unsmoothed = masks(&format!("{name}.unsmoothed"));
        let truth = masks(&format!("{name}.truth"));
        let range = array(&format!("{name}.range"));
        let (levels, ious) = (array(&format!("{name}.level")), array(&format!("{name}.iou")));
        assert_eq!(chosen.len(), expected.len());
        for (sentence, chosen) in chosen.iter().enumerate() {
            assert_eq!(chosen.level, levels.data[sentence] as usize, "{name}, sentence {sentence}");
            let [floor, peak] = [range.data[2 * sentence], range.data[2 * sentence + 1]];
            assert!((chosen.found.peak - peak).abs() < 1e-5 && (chosen.found.floor - floor).abs() < 1e-5);
            assert_eq!(
                chosen.found.unsmoothed, unsmoothed[sentence],
                "{name}, sentence {sentence}, unsmoothed"
            );
            assert_eq!(chosen.found.mask, expected[sentence], "{name}, sentence {sentence}");
            let iou = chosen.found.mask.and_count(&truth[sentence]) as f64
                / chosen.found.mask.or_count(&truth[sentence]) as f64;
            assert!((iou - f64::from(ious.data[sentence])).abs() < 1e-4);
        }
    }
}

/// Numbers from -1 to 1 that look like chance and come again.
fn noise(count: usize, seed: u64) -> Vec<f32> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    (0..count).map(next).collect()
}

fn decoder(widths: &[usize], seed: u64) -> Decoder {
    let layer = |(index, pair): (usize, &[usize])| {
        let scale = 1.0 / (pair[0] as f32).sqrt();
        let weight =
            noise(pair[0] * pair[1], seed + index as u64).iter().map(|value| 2.0 * scale * value).collect();
        Layer { inputs: pair[0], outputs: pair[1], weight, bias: noise(pair[1], seed + 100 + index as u64) }
    };
    Decoder::new(widths.windows(2).enumerate().map(layer).collect()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any sizes, any widths (narrowing ones included): cosines agree to rounding, masks wherever rounding cannot decide.
    #[test]
    fn the_reference_finds_the_same(
        (width, height) in (1..40_u32, 1..36_u32),
        widths in proptest::collection::vec(1..90_usize, 1..4),
        (channels, sentences, phrases) in (1..7_usize, 1..4_usize, 1..5_usize),
        is_box in any::<bool>(),
        seed in 1..1_000_000_u64,
    ) {
        let widths: Vec<usize> = std::iter::once(channels).chain(widths).collect();
        let decoder = decoder(&widths, seed);
        let out = decoder.outputs();
        let texts = TextEmbeddings::new(out, noise(out * sentences, seed + 1), noise(out * phrases, seed + 2)).unwrap();
        let data = noise((width * height) as usize * channels, seed + 3);
        let latents = Latents { width, height, channels, data: &data };
        let engine = Engine::new(&decoder, &texts).unwrap();
        let plain = Plain::new(decoder, texts);
        for (fast, slow) in engine.cosines(latents).iter().flatten().zip(plain.cosines(latents).iter().flatten()) {
            prop_assert!((fast - slow).abs() < 2e-4, "{} and {}", fast, slow);
        }
        let rules = rules(if is_box { Smoothing::Box30 } else { Smoothing::Pool29 });
        for (fast, slow) in engine.level(latents, &rules).iter().zip(plain.level(latents, &rules)) {
            prop_assert!((fast.peak - slow.peak).abs() < 2e-3 && (fast.floor - slow.floor).abs() < 2e-3);
            prop_assert!((fast.summit.height - slow.summit.height).abs() < 2e-3);
            // A map without a range is cut by rounding alone.
            if slow.peak - slow.floor > 0.05 {
                let different = fast.unsmoothed.or_count(&slow.unsmoothed) - fast.unsmoothed.and_count(&slow.unsmoothed);
                prop_assert!(different * 50 <= u64::from(width * height).max(50), "{} pixels differ", different);
            }
        }
    }
}

#[test]
fn frames_without_a_negative_number_are_stretched_where_the_rules_say_so() {
    let decoder = decoder(&[3, 8, 12], 5);
    let texts = TextEmbeddings::new(12, noise(12, 1), noise(24, 2)).unwrap();
    let engine = Engine::new(&decoder, &texts).unwrap();
    let positive: Vec<f32> = noise(20 * 20 * 3, 9).iter().map(|value| 0.5 + 0.49 * value).collect();
    let stretched: Vec<f32> = positive.iter().map(|value| value * 2.0 - 1.0).collect();
    let picture = |data| Latents { width: 20, height: 20, channels: 3, data };
    let rules = Rules { stretch_positive: true, ..rules(Smoothing::Pool29) };
    let plain = Rules { stretch_positive: false, ..rules };
    let by_rule = answer(&engine, &[picture(&positive)], &rules);
    assert_eq!(by_rule, answer(&engine, &[picture(&stretched)], &plain));
    assert_ne!(by_rule, answer(&engine, &[picture(&positive)], &plain));
}

#[test]
fn the_first_of_equal_levels_answers() {
    let decoder = decoder(&[3, 8, 12], 5);
    let texts = TextEmbeddings::new(12, noise(12, 1), noise(24, 2)).unwrap();
    let engine = Engine::new(&decoder, &texts).unwrap();
    let data = noise(10 * 10 * 3, 4);
    let level = Latents { width: 10, height: 10, channels: 3, data: &data };
    assert_eq!(answer(&engine, &[level, level], &rules(Smoothing::Box30))[0].level, 0);
}

#[test]
fn the_gate_averages_cosines_of_the_mask_s_pixels() {
    let decoder = decoder(&[6, 20, 40], 5);
    let texts = TextEmbeddings::new(40, noise(80, 1), Vec::new()).unwrap();
    let data = noise(9 * 7 * 6, 4);
    let latents = Latents { width: 9, height: 7, channels: 6, data: &data };
    let mask = Mask::from_fn(9, 7, |col, row| (col + row) % 3 == 0);
    let engine = Engine::new(&decoder, &texts).unwrap();
    let found = gate::similarities(&engine, latents, &mask).unwrap();
    let all = Plain::new(decoder, texts).cosines(latents);
    for (found, picture) in found.iter().zip(all) {
        let inside: Vec<f64> =
            mask.pixels().map(|(col, row)| f64::from(picture[(row * 9 + col) as usize])).collect();
        let mean = inside.iter().sum::<f64>() / inside.len() as f64;
        assert!((found - mean).abs() < 1e-5);
    }
    assert_eq!(gate::similarities(&engine, latents, &Mask::empty(9, 7)), None);
}
