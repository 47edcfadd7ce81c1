//! What an import writes down of itself: assumptions in words, and digests of what it read.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;

use super::super::relevancy::Smoothing;
use super::super::template::Hit;
use super::Request;

/// One digest of all files of a scene, by their paths below the root.
pub(super) fn digest(root: &Path, hits: &[Hit]) -> Result<String, DataError> {
    let mut digest = l4d_data::digest::RunningDigest::default();
    for hit in hits {
        let path = hit.path.strip_prefix(root).unwrap_or(&hit.path).display();
        digest.add(format!("{}  {path}\n", l4d_data::digest::sha256_file(&hit.path)?).as_bytes());
    }
    Ok(digest.hex())
}

/// What was taken for granted, in words.
pub(super) fn assumptions(request: &Request<'_>) -> BTreeMap<String, String> {
    let mut assumptions = BTreeMap::new();
    let mut say = |topic: &str, text: String| {
        assumptions.insert(topic.to_owned(), text);
    };
    say("template", request.preset.template.clone());
    say("frames", request.order.to_string());
    say("codec", request.preset.codec.as_str().to_owned());
    if let Some(latents) = &request.preset.latents {
        let rules = latents.rules;
        let name = if rules.smoothing == Smoothing::Box30 { "box of 30 x 30" } else { "pool of 29 x 29" };
        say("smoothing", format!("{name}, then the majority of 7 x 7"));
        say("threshold", format!("above {:.3} of the range of its own map", (1.0 + rules.threshold) / 2.0));
        say("level", format!("of {:?}, the one with the highest smoothed relevancy", latents.levels));
        let is_gated = request.encoders.time_texts.is_some();
        let gate = if is_gated { "queries that hold at some times, by mean similarity" } else { "none" };
        say("time gate", gate.to_owned());
    } else {
        say("inside", request.reading.inside.to_string());
    }
    if request.soft.is_some() {
        let range = if request.reading.inside.is_smoothed() || request.preset.latents.is_some() {
            "smoothed, over its own range; no majority"
        } else {
            "over its own range"
        };
        say("relevancy", format!("{range}, 0 to 255"));
    }
    let resize = if request.resize { "nearest, predictions only, proportions within 1 %" } else { "refused" };
    say("other sizes", resize.to_owned());
    for (field, value) in &request.choices {
        say(&format!("field {field}"), value.clone());
    }
    assumptions
}
