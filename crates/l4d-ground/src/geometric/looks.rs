//! How much a track looks like what an adjective says: colour, pattern, material, shape.

use super::lab::lab_of;
use super::lexicon::{Lexicon, Look};
use super::perceive::Track;
use super::settings::COLOUR_DEVIATION;

/// Colours that are looked at of a track.
const SAMPLES: usize = 400;
/// Lightness counts less than hue: a red thing has shades.
const LIGHTNESS_WEIGHT: f32 = 0.5;

/// Whether anything is measured that tells of this property.
pub(crate) fn is_visible(lexicon: &Lexicon, key: &str, value: &str) -> bool {
    colours_of(lexicon, value).is_some()
        || match lexicon.look(key) {
            Look::Pattern | Look::Size | Look::Colour => true,
            Look::Material => material_colours(value).is_some(),
            Look::Shape => matches!(value, "tall" | "wide" | "flat" | "slim" | "deep"),
            Look::None => false,
        }
}

/// Whether the likeness is that of a colour, 0 to 1, which needs nothing to be compared with.
pub(crate) fn tells_colour(lexicon: &Lexicon, key: &str, value: &str) -> bool {
    colours_of(lexicon, value).is_some() || lexicon.look(key) == Look::Material
}

/// How much a track looks like it; unless it is a colour, only the order among rivals means something.
pub(crate) fn likeness(track: &Track, lexicon: &Lexicon, key: &str, value: &str) -> f64 {
    if let Some(colours) = colours_of(lexicon, value) {
        // The colour of a part need not be everywhere.
        let share = if key == "colour" && colours.len() == 1 { 0.7 } else { 0.3 };
        let samples = samples(track);
        let worth = colours.iter().map(|colour| coloured(&samples, &[*colour], lexicon, share));
        return worth.product::<f64>().powf(1.0 / colours.len() as f64);
    }
    let ratio = || {
        track.median(|seen| {
            let sides = seen.high - seen.low;
            sides.z / sides.x.max(sides.y).max(1e-6)
        })
    };
    let volume =
        || track.median(|seen| (seen.high - seen.low).max(glam::DVec3::splat(1e-3)).element_product());
    match (lexicon.look(key), value) {
        (Look::Pattern, "plain") => 1.0 / (5.0 + variety(&samples(track))),
        (Look::Pattern, _) => variety(&samples(track)),
        (Look::Material, _) => {
            let names = material_colours(value).unwrap_or_default();
            coloured(&samples(track), names, lexicon, 0.6)
        }
        (Look::Shape, "tall" | "slim" | "deep") => ratio(),
        (Look::Shape, _) => 1.0 / ratio().max(0.05),
        (Look::Size, "small") => 1.0 / volume(),
        (Look::Size, _) => volume(),
        _ => 1.0,
    }
}

/// The colours that a value names: one, or two of "black_and_white".
fn colours_of<'v>(lexicon: &Lexicon, value: &'v str) -> Option<Vec<&'v str>> {
    let names: Vec<&str> = value.split("_and_").collect();
    names.iter().all(|name| !lexicon.specimens(name).is_empty()).then_some(names)
}

/// Colours that a material usually has; none where it may have any.
fn material_colours(material: &str) -> Option<&'static [&'static str]> {
    match material {
        "steel" | "metal" => Some(&["grey", "silver"]),
        "wood" => Some(&["brown", "golden", "beige"]),
        "wicker" => Some(&["golden", "beige", "brown"]),
        "paper" => Some(&["white", "cream"]),
        _ => None,
    }
}

fn samples(track: &Track) -> Vec<[f32; 3]> {
    let all: Vec<[f32; 3]> = track.seen().flat_map(|(_, seen)| seen.colours.iter().copied()).collect();
    let step = all.len().div_ceil(SAMPLES).max(1);
    all.into_iter().step_by(step).collect()
}

/// How near the best `share` of the samples is to any specimen of the colours.
fn coloured(samples: &[[f32; 3]], names: &[&str], lexicon: &Lexicon, share: f64) -> f64 {
    let specimens: Vec<[f32; 3]> =
        names.iter().flat_map(|name| lexicon.specimens(name)).map(|rgb| lab_of(*rgb)).collect();
    let near = |sample: &[f32; 3]| {
        let off = |specimen: &[f32; 3]| {
            let [l, a, b] = [0, 1, 2].map(|axis| sample[axis] - specimen[axis]);
            ((LIGHTNESS_WEIGHT * l).powi(2) + a * a + b * b).sqrt()
        };
        let nearest = specimens.iter().map(off).fold(f32::INFINITY, f32::min);
        (-(f64::from(nearest) / COLOUR_DEVIATION).powi(2)).exp()
    };
    let mut worth: Vec<f64> = samples.iter().map(near).collect();
    worth.sort_by(|a, b| b.total_cmp(a));
    let count = ((worth.len() as f64 * share) as usize).max(1);
    worth.iter().take(count).sum::<f64>() / count as f64
}

/// Mean distance of the colours from their mean.
fn variety(samples: &[[f32; 3]]) -> f64 {
    let count = samples.len().max(1) as f32;
    let mut mean = [0.0_f32; 3];
    samples.iter().for_each(|sample| (0..3).for_each(|axis| mean[axis] += sample[axis] / count));
    samples.iter().map(|sample| f64::from(super::lab::distance(*sample, mean))).sum::<f64>()
        / f64::from(count)
}
