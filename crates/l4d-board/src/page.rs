//! `index.html`: the board as one file that needs no network and no server.
//!
//! It shows what the [`Board`] holds, and beside it pictures and masks of the results, which are media and no part of
//! that document. It computes no number. The page itself is in `assets/page/`.

mod document;
mod embed;
mod masks;
mod overview;
mod scene;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use l4d_data::Report;
use l4d_data::store::AtomicFile;
use l4d_score::EvalSet;
use rayon::prelude::*;

pub use masks::LONGEST_SIDE_PX;
pub use scene::Backdrop;

use self::document::Page;
use self::overview::Overview;
use crate::board::Board;
use crate::error::BoardError;

pub(crate) const PAGE: &str = "index.html";

/// Where the page finds pictures and masks.
pub struct Media<'a> {
    pub eval_set: &'a EvalSet,
    /// Folder of results; without it the page shows numbers and truth, and no masks of methods.
    pub results: Option<&'a Path>,
    /// Pictures of the held-out camera.
    pub backdrop: &'a Backdrop<'a>,
    /// What is wrong with masks that are not shown.
    pub found: &'a Mutex<Report>,
}

/// Writes it into `folder`; gives its path. Scenes are made as they are written, as many at once as there are
/// threads.
///
/// # Errors
/// Truth that is damaged, and what the disk refuses.
pub(crate) fn write(board: &Board, media: &Media, folder: &Path) -> Result<PathBuf, BoardError> {
    let path = folder.join(PAGE);
    let mut file = AtomicFile::create(&path)?;
    let failed = |error: io::Error| BoardError::write(&path, error);
    let title = format!("{} {}: leaderboard", board.heading.benchmark, board.heading.on.benchmark_version);
    let mut page = Page::begin(file.writer(), &title).map_err(failed)?;
    page.json("board", &Overview(board)).map_err(failed)?;
    let places: Vec<usize> = (0..board.scenes.len()).collect();
    for places in places.chunks(rayon::current_num_threads()) {
        let pack = |place: &usize| -> Result<[String; 2], BoardError> {
            let scene = scene::scene(board, *place, media)?;
            let thumbnail = embed::packed(&scene.thumbnail()).map_err(failed)?;
            Ok([thumbnail, embed::packed(&scene).map_err(failed)?])
        };
        let packed: Vec<[String; 2]> = places.par_iter().map(pack).collect::<Result<_, BoardError>>()?;
        for (place, [thumbnail, scene]) in places.iter().zip(packed) {
            page.text(&format!("thumbnail-{place}"), &thumbnail).map_err(failed)?;
            page.text(&format!("scene-{place}"), &scene).map_err(failed)?;
        }
    }
    page.end().map_err(failed)?;
    file.commit()?;
    Ok(path)
}
