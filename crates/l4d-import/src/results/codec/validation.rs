//! `validation.json` of HyperGaussian: when a sentence is said to hold, with a picture a frame beside it.
//!
//! `refergaussian/semantics/query_render.py` and `scripts/evaluate_ours_benchmark.py` at 5a12135.

use std::path::{Path, PathBuf};

use l4d_data::json;
use l4d_data::store::read_bounded;
use serde::Deserialize;

use super::{Piece, Place, Problem, Reading, maps};

const MAX_BYTES: u64 = 64 << 20;

#[derive(Deserialize)]
struct Validation {
    frames: Vec<Frame>,
}

#[derive(Deserialize)]
struct Frame {
    frame_index: usize,
    query_active: bool,
}

fn frames(path: &Path) -> Result<Vec<Frame>, Problem> {
    let validation: Validation = json::parse(path, None, &read_bounded(path, MAX_BYTES)?)?;
    Ok(validation.frames)
}

fn picture(path: &Path, frame: &Frame) -> PathBuf {
    path.with_file_name("binary_masks").join(format!("{:05}.png", frame.frame_index))
}

pub(super) fn read(path: &Path, reading: &Reading) -> Result<Vec<Piece>, Problem> {
    let mut pieces = Vec::new();
    for frame in frames(path)? {
        let place = Some(Place::Position(frame.frame_index));
        if !frame.query_active {
            pieces.push(Piece { name: None, place, mask: None });
            continue;
        }
        let of_frame = |problem: Problem| Problem {
            place: format!("binary_masks/{:05}.png: {}", frame.frame_index, problem.place),
            ..problem
        };
        let read = maps::read_picture(&picture(path, &frame), reading).map_err(of_frame)?;
        pieces.extend(read.into_iter().map(|piece| Piece { place, ..piece }));
    }
    Ok(pieces)
}

/// The pictures that [`read`] opens, those that are there.
pub(super) fn pictures(path: &Path) -> Vec<PathBuf> {
    let frames = frames(path).unwrap_or_default();
    let active = frames.iter().filter(|frame| frame.query_active);
    active.map(|frame| picture(path, frame)).filter(|path| path.exists()).collect()
}
