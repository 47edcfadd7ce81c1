//! Writing a board: tables and figures are made in memory first, so that a refusal leaves the folder as it was. The
//! document, which is as large as the board, is written as it is made.

use std::path::{Path, PathBuf};

use l4d_data::DataError;
use l4d_data::store::{AtomicFile, Claim, Earlier, write_atomic};
use rayon::prelude::*;

use crate::board::Board;
use crate::error::BoardError;
use crate::figures;
use crate::page::{self, Media, PAGE};
use crate::{latex, layout, markdown, tables};

const DOCUMENT: &str = "board.json";
const TAKEN: &str = "taken.csv";

/// What a board says of the answers to the queries.
#[derive(Clone, Copy)]
pub enum Answers<'a> {
    /// Nothing from which one follows: numbers alone, for a set whose truth is private.
    Withheld,
    /// Their names, in the document and in `taken.csv`.
    Named,
    /// Their masks too, on the page.
    Shown(&'a Media<'a>),
}

/// Writes the document, tables, figures and, where there are `media`, the page into `folder`, each file through a
/// temporary neighbour and rename; gives the paths in order. Files of other names stay.
///
/// # Errors
/// Files of these names that l4d did not write, unless `force`; a folder that another run writes into; damaged truth; and
/// what polars, plotters or the disk refuses.
pub fn publish(
    board: &Board,
    folder: &Path,
    answers: Answers<'_>,
    force: bool,
) -> Result<Vec<PathBuf>, BoardError> {
    let (media, is_withheld) = match answers {
        Answers::Withheld => (None, true),
        Answers::Named => (None, false),
        Answers::Shown(media) => (Some(media), false),
    };
    let mut files = vec![
        ("leaderboard.csv".to_owned(), tables::leaderboard(board)?),
        ("per_category.csv".to_owned(), tables::per_group(board, "category")?),
        ("per_scale.csv".to_owned(), tables::per_group(board, "scale")?),
        ("per_scene.csv".to_owned(), tables::per_group(board, "scene")?),
        ("groups.csv".to_owned(), tables::groups(board)?),
        ("comparisons.csv".to_owned(), tables::comparisons(board)?),
        ("reported.csv".to_owned(), tables::reported(board)?),
    ];
    if !is_withheld {
        files.push((TAKEN.to_owned(), tables::taken(board)?));
    }
    for table in layout::all(board) {
        let file = |extension: &str| format!("tables/{}.{extension}", table.name);
        files.push((file("csv"), tables::layout(board, &table)?));
        files.push((file("tex"), latex::tabular(&table, board).into_bytes()));
        files.push((file("md"), table.markdown(board).into_bytes()));
    }
    for table in &board.protocols {
        let file = |extension: &str| format!("protocols/{}.{extension}", table.protocol);
        files.push((file("csv"), tables::protocol(board, table)?));
        files.push((file("md"), table.markdown(&board.heading).into_bytes()));
    }
    let figures = figures::all(board);
    let drawn: Vec<_> =
        figures.par_iter().map(|figure| (figure.draw)()).collect::<Result<_, BoardError>>()?;
    files.extend(drawn.into_iter().flatten().map(|(name, bytes)| (format!("figures/{name}"), bytes)));
    // The page comes last: when it is new, so is everything that it shows.
    files.push(("leaderboard.md".to_owned(), markdown::page(board, &figures).into_bytes()));

    let page = media.map(|_| PAGE).into_iter().chain([DOCUMENT]).map(str::to_owned);
    let mut names: Vec<String> = files.iter().map(|(name, _)| name.clone()).chain(page).collect();
    if is_withheld {
        names.extend([TAKEN, PAGE].map(str::to_owned));
    }
    let earlier = Earlier { file: DOCUMENT, says: "\"l4d/board/" };
    let _claim = Claim::take(folder, names, Some(earlier), force)?;
    let mut paths = Vec::new();
    match is_withheld {
        false => paths.push(publish_document(board, folder.join(DOCUMENT))?),
        // What an earlier board said of them goes too.
        true => [DOCUMENT, TAKEN, PAGE].iter().try_for_each(|name| remove(&folder.join(name)))?,
    }
    for (name, bytes) in files {
        let path = folder.join(name);
        write_atomic(&path, &bytes)?;
        paths.push(path);
    }
    if let Some(media) = media {
        paths.push(page::write(board, media, folder)?);
    }
    Ok(paths)
}

fn remove(path: &Path) -> Result<(), BoardError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(DataError::io(path, "remove", error).into())
        }
        _ => Ok(()),
    }
}

fn publish_document(board: &Board, path: PathBuf) -> Result<PathBuf, BoardError> {
    let mut file = AtomicFile::create(&path)?;
    serde_json::to_writer(file.writer(), board).map_err(|error| BoardError::write(&path, error))?;
    file.write(b"\n")?;
    file.commit()?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_second_run_gives_the_same_bytes_and_leaves_other_files() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
        let board = sample::answered(sample::hand_made());
        let publish = || {
            let paths = publish(&board, folder.path(), Answers::Named, false).unwrap();
            paths.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect::<Vec<_>>()
        };
        let first = publish();
        assert!(first == publish());
        assert_eq!(std::fs::read_to_string(folder.path().join("notes.txt")).unwrap(), "mine");
        let names: Vec<String> = first
            .iter()
            .map(|(path, _)| path.strip_prefix(folder.path()).unwrap().display().to_string())
            .collect();
        insta::assert_snapshot!(names.join("\n"));
    }

    #[test]
    fn the_document_reads_back_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let board = sample::answered(sample::hand_made());
        publish(&board, folder.path(), Answers::Named, false).unwrap();
        let path = folder.path().join("board.json");
        assert_eq!(Board::read(&path).unwrap(), board);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replacen("l4d/board/2", "l4d/board/0", 1)).unwrap();
        let error = Board::read(&path).unwrap_err().to_string();
        assert!(error.contains("board.json") && error.contains("field `schema`"), "{error}");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("file");
        std::fs::write(&blocked, "a file").unwrap();
        let error = publish(&sample::board(1), &blocked, Answers::Named, false).unwrap_err();
        assert!(error.to_string().contains("file"), "{error}");
    }
}
