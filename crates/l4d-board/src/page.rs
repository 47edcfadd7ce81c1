//! `index.html`: the board as one file that needs no network and no server.
//!
//! Owns what the page is told and how it travels; the page itself stands in `assets/page/`. It computes no number:
//! every value, interval and comparison comes from `l4d-score` and is only looked up by the browser.

mod document;
mod embed;
mod masks;
mod overview;
mod protocols;
mod published;
mod scene;

use std::path::{Path, PathBuf};

use l4d_data::Name;
use l4d_data::store::write_atomic;
use l4d_score::Exam;
use l4d_score::cluster::FEW_SCENES;
use rayon::prelude::*;
use serde_json::{Value, json};

pub use masks::LONGEST_SIDE_PX;
pub use scene::Backdrop;

use crate::detail::{Asked, AskedScene, Detail, Details};
use crate::error::BoardError;
use crate::protocols::ProtocolTable;
use crate::rank::Board;
use crate::statistics::Statistics;

/// What a page is made from.
pub struct Exhibit<'a> {
    /// What is asked.
    pub exam: &'a Exam,
    /// Who stands where.
    pub board: &'a Board,
    /// What its means can tell.
    pub statistics: &'a Statistics,
    /// Seed of the draws behind intervals.
    pub seed: u64,
    /// What they did, query by query.
    pub details: &'a Details<'a>,
    /// What protocols of others say of them.
    pub protocols: &'a [ProtocolTable],
    /// Folder of results; without it the page shows numbers and truth, and no masks of methods.
    pub results: Option<&'a Path>,
    /// Pictures of the held-out camera.
    pub backdrop: &'a Backdrop<'a>,
    /// Version of the software.
    pub software: &'a str,
}

/// Writes `index.html` into `folder`; gives its path.
///
/// # Errors
/// Scores that cannot be read, tables of the paper that are damaged, and what the disk refuses.
pub fn publish_page(exhibit: &Exhibit, folder: &Path) -> Result<PathBuf, BoardError> {
    let page = page(exhibit)?;
    let path = folder.join("index.html");
    write_atomic(&path, page.as_bytes())?;
    Ok(path)
}

fn page(exhibit: &Exhibit) -> Result<String, BoardError> {
    let Exhibit { board, details, .. } = exhibit;
    let Details { asked, methods } = details;
    let first = overview(exhibit)?;
    let mut data = vec![("board".to_owned(), "application/json", embed::json(&first))];
    let names = board.rows().map(|(_, row)| &row.name);
    data.extend(scenes(exhibit, asked, &names.zip(methods).collect::<Vec<_>>())?);
    let title = format!("{} {}: leaderboard", board.heading.benchmark, board.heading.version);
    Ok(document::document(&title, &data))
}

fn overview(exhibit: &Exhibit) -> Result<Value, BoardError> {
    let Exhibit {
        exam,
        board,
        statistics,
        seed,
        protocols,
        software,
        details: Details { asked, methods: details },
        ..
    } = exhibit;
    let heading = &board.heading;
    Ok(json!({
        "software": software,
        "benchmark": heading.benchmark,
        "version": heading.version,
        "truthDigest": heading.truth_digest,
        "protocol": heading.protocol,
        "profile": heading.profile,
        "queries": heading.queries,
        "sceneCount": heading.scenes,
        "verified": heading.verified,
        "rejected": heading.rejected,
        "line": heading.line(),
        "metrics": overview::metrics(),
        "tracks": overview::tracks(),
        "fewScenes": FEW_SCENES,
        "methods": overview::methods(board, asked, details, *seed),
        "comparisons": overview::comparisons(statistics),
        "others": overview::others(board),
        "protocols": protocols::overview(protocols, board, asked),
        "scenes": overview::scenes(asked),
        "published": published::tables(&exam.bench)?,
    }))
}

/// One packed element a scene.
fn scenes(
    exhibit: &Exhibit,
    asked: &Asked,
    methods: &[(&Name, &Detail)],
) -> Result<Vec<(String, &'static str, String)>, BoardError> {
    let mut firsts = Vec::new();
    let mut first = 0;
    for scene in &asked.scenes {
        firsts.push(first);
        first += scene.queries.len();
    }
    let scenes: Vec<_> = asked.scenes.iter().zip(firsts).enumerate().collect();
    let pack = |(index, (scene, first)): &(usize, (&AskedScene, usize))| {
        let Exhibit { exam, results, backdrop, protocols, .. } = exhibit;
        let mut value = scene::scene(exam, scene, *first, methods, *results, *backdrop)?;
        value["protocols"] = protocols::scene(protocols, scene);
        let failed =
            |error: std::io::Error| BoardError::Table { file: "index.html", message: error.to_string() };
        Ok((format!("scene-{index}"), "text/plain", embed::packed(&value).map_err(failed)?))
    };
    scenes.par_iter().map(pack).collect()
}
