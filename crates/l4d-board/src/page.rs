//! `index.html`: the board as one file that needs no network and no server.
//!
//! It shows what the [`Board`] holds, and beside it pictures and masks of the results, which are media and no part of
//! that document. It computes no number. The page itself is in `assets/page/`.

mod document;
mod embed;
mod masks;
mod overview;
mod scene;

use std::path::{Path, PathBuf};

use l4d_data::store::write_atomic;
use l4d_score::Exam;
use rayon::prelude::*;

pub use masks::LONGEST_SIDE_PX;
pub use scene::Backdrop;

use crate::board::Board;
use crate::error::BoardError;

/// Where the page finds pictures and masks.
pub struct Media<'a> {
    /// The truth.
    pub exam: &'a Exam,
    /// Folder of results; without it the page shows numbers and truth, and no masks of methods.
    pub results: Option<&'a Path>,
    /// Pictures of the held-out camera.
    pub backdrop: &'a Backdrop<'a>,
}

/// Writes `index.html` into `folder`; gives its path.
///
/// # Errors
/// Truth that is damaged, and what the disk refuses.
pub fn publish_page(board: &Board, media: &Media, folder: &Path) -> Result<PathBuf, BoardError> {
    let path = folder.join("index.html");
    write_atomic(&path, page(board, media)?.as_bytes())?;
    Ok(path)
}

fn page(board: &Board, media: &Media) -> Result<String, BoardError> {
    let mut data = vec![("board".to_owned(), "application/json", embed::json(&overview::overview(board)))];
    let places: Vec<usize> = (0..board.scenes.len()).collect();
    let pack = |place: &usize| {
        let value = scene::scene(board, *place, media)?;
        let packed = embed::packed(&value).map_err(|error| BoardError::render("index.html", error))?;
        Ok((format!("scene-{place}"), "text/plain", packed))
    };
    data.extend(places.par_iter().map(pack).collect::<Result<Vec<_>, BoardError>>()?);
    let title = format!("{} {}: leaderboard", board.heading.benchmark, board.heading.on.benchmark_version);
    Ok(document::document(&title, &data))
}
