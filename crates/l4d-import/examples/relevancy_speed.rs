//! Relevancy of latents from files to masks, timed: the Rust side of `perf/relevancy.py`.
//!
//! ```text
//! relevancy_speed DECODER.npz TEXTS.npz box30|pool29 LEVEL.npy... [-- LEVEL.npy...]
//! ```
//!
//! Every group of levels is a frame. Prints a JSON line: seconds for all frames, from reading files to masks, and the
//! run lengths of every mask.

use std::path::Path;
use std::time::Instant;

use l4d_data::DataError;
use l4d_formats::arrays;
use l4d_import::results::relevancy::{
    Decoder, Engine, Latents, Rules, Smoothing, TextEmbeddingsFile, answer,
};
use std::io::Write as _;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [decoder, texts, smoothing, frames @ ..] = arguments.as_slice() else {
        return Err("usage: relevancy_speed DECODER TEXTS box30|pool29 LEVEL... [-- LEVEL...]".into());
    };
    let smoothing = if smoothing == "box30" { Smoothing::Box30 } else { Smoothing::Pool29 };
    let rules = Rules { smoothing, threshold: 0.4, stretch_positive: false };
    let decoder = Decoder::read(Path::new(decoder))?;
    let texts = TextEmbeddingsFile::read(Path::new(texts))?.texts;
    let engine = Engine::new(&decoder, &texts).ok_or("the decoder does not end in the width of the texts")?;
    let start = Instant::now();
    let mut masks = Vec::new();
    for frame in frames.split(|argument| argument == "--") {
        let read = |path: &String| arrays::read(Path::new(path), None);
        let levels = frame.iter().map(read).collect::<Result<Vec<_>, DataError>>()?;
        let pictures: Vec<Latents<'_>> = levels
            .iter()
            .map(|level| Latents {
                width: level.shape[1] as u32,
                height: level.shape[0] as u32,
                channels: level.shape[2],
                data: &level.data,
            })
            .collect();
        masks.extend(answer(&engine, &pictures, &rules).into_iter().map(|chosen| chosen.found.mask.to_rle()));
    }
    let seconds = start.elapsed().as_secs_f64();
    writeln!(std::io::stdout(), "{}", serde_json::json!({ "seconds": seconds, "masks": masks }))?;
    Ok(())
}
