//! Writing a board: everything is made in memory first, so that a refusal leaves the folder as it was.

use std::path::{Path, PathBuf};

use l4d_data::layout::BenchDir;
use l4d_data::store::write_atomic;
use rayon::prelude::*;

use crate::detail::Details;
use crate::error::BoardError;
use crate::figures::{self, Figure};
use crate::protocols::ProtocolTable;
use crate::rank::Board;
use crate::statistics::Statistics;
use crate::{latex, layout, markdown, table};

/// Writes tables, page and figures into `folder`, each file through a temporary neighbour and rename; gives the
/// paths in order. Files of other names stay. `bench` has what papers report.
pub fn publish(
    board: &Board,
    statistics: &Statistics,
    details: &Details,
    protocols: &[ProtocolTable],
    bench: &BenchDir,
    folder: &Path,
) -> Result<Vec<PathBuf>, BoardError> {
    let mut files = vec![
        ("leaderboard.csv".to_owned(), table::leaderboard(board)?),
        ("per_category.csv".to_owned(), table::per_category(board)?),
        ("per_scale.csv".to_owned(), table::per_scale(board)?),
        ("per_scene.csv".to_owned(), table::per_scene(board)?),
        ("groups.csv".to_owned(), table::groups(board, statistics)?),
        ("comparisons.csv".to_owned(), table::comparisons(board, statistics)?),
        ("reported.csv".to_owned(), table::reported(board)?),
        ("taken.csv".to_owned(), table::taken(board, details)?),
    ];
    for table in layout::all(board, statistics, bench)? {
        let file = |extension: &str| format!("tables/{}.{extension}", table.name);
        files.push((file("csv"), table::layout(board, &table)?));
        files.push((file("tex"), latex::tabular(&table, board).into_bytes()));
        files.push((file("md"), table.markdown(board).into_bytes()));
    }
    let mut apart = Vec::new();
    for table in protocols {
        let page = format!("protocols/{}.md", table.protocol);
        files.push((format!("protocols/{}.csv", table.protocol), table::protocol(board, table)?));
        files.push((page.clone(), table.markdown(board).into_bytes()));
        apart.push((page, table.protocol.as_str()));
    }
    let mut figures = figures::all(board, statistics);
    figures.extend(figures::detailed(board, details));
    let painted: Vec<_> = figures.par_iter().map(Figure::files).collect::<Result<_, BoardError>>()?;
    files.extend(painted.into_iter().flatten().map(|(name, bytes)| (format!("figures/{name}"), bytes)));
    let on_page = figures.iter().filter(|figure| figure.is_on_page);
    let shown: Vec<(String, &str)> =
        on_page.map(|figure| (format!("figures/{}.svg", figure.name), figure.caption.as_str())).collect();
    // The page comes last: when it is new, so is everything that it shows.
    files.push(("leaderboard.md".to_owned(), markdown::page(board, statistics, &apart, &shown).into_bytes()));

    let mut paths = Vec::new();
    for (name, bytes) in files {
        let path = folder.join(name);
        write_atomic(&path, &bytes)?;
        paths.push(path);
    }
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    fn bench() -> BenchDir {
        BenchDir::new("nowhere")
    }

    fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
        let mut files = Vec::new();
        for part in ["", "figures", "protocols", "tables"].map(|part| folder.join(part)) {
            for entry in std::fs::read_dir(part).unwrap() {
                let path = entry.unwrap().path();
                if path.is_file() {
                    files.push((path.clone(), std::fs::read(path).unwrap()));
                }
            }
        }
        files.sort();
        files
    }

    #[test]
    fn a_second_run_replaces_files_with_the_same_bytes_and_leaves_others() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("leaderboard.csv"), "old").unwrap();
        std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
        let mut paths = publish(
            &sample::hand_made(),
            &sample::statistics(&sample::hand_made()),
            &sample::details(),
            &[sample::protocol()],
            &bench(),
            folder.path(),
        )
        .unwrap();
        let first = files(folder.path());
        publish(
            &sample::hand_made(),
            &sample::statistics(&sample::hand_made()),
            &sample::details(),
            &[sample::protocol()],
            &bench(),
            folder.path(),
        )
        .unwrap();
        assert_eq!(files(folder.path()), first);
        paths.push(folder.path().join("notes.txt"));
        paths.sort();
        assert_eq!(first.iter().map(|(path, _)| path.clone()).collect::<Vec<_>>(), paths);
        assert_eq!(paths.len(), 17 + 3 + 8 + 2);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("file");
        std::fs::write(&blocked, "a file").unwrap();
        let error = publish(
            &sample::hand_made(),
            &sample::statistics(&sample::hand_made()),
            &sample::details(),
            &[sample::protocol()],
            &bench(),
            &blocked,
        )
        .unwrap_err();
        assert!(error.to_string().contains("file"), "{error}");
    }
}
