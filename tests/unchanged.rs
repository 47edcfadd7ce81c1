//! What the shipped benchmark says, by digest: tracks, truth, queries, and the numbers that baselines get on it.
//!
//! A change of code changes none of these. A change of the benchmark does: `cargo insta review` then shows which.

use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_file;

use crate::support::{Dir, files_below, root};

const TABLES: [&str; 8] = [
    "leaderboard.csv",
    "comparisons.csv",
    "groups.csv",
    "per_category.csv",
    "per_scale.csv",
    "per_scene.csv",
    "reported.csv",
    "taken.csv",
];

#[test]
fn the_shipped_benchmark_is_what_it_was() {
    let files = ["scenes", "truth/tiny", "truth/small", "queries"]
        .iter()
        .flat_map(|folder| files_below(&root().join("benchmark").join(folder)));
    insta::assert_snapshot!(digests(root(), files));
}

#[test]
fn baselines_get_the_numbers_that_they_got() {
    let dir = Dir::new();
    let bench = root().join("benchmark");
    let bench = bench.to_str().unwrap();
    dir.succeed(format!("baseline --bench {bench} -q"));
    // Two that are ranked: the same masks from methods that are no baselines.
    for (baseline, method) in [("random-look-alike", "guess"), ("look-alike-union", "union")] {
        dir.contestant(baseline, method);
    }
    dir.succeed(format!("score results --bench {bench} -q"));
    dir.succeed(format!("leaderboard --bench {bench} -q"));

    let counts = ["all", "guess", "none", "oracle", "time-agnostic", "union"]
        .map(|method| dir.path(format!("scores/{method}/counts.csv")));
    let tables = TABLES.map(|table| dir.path("leaderboard").join(table));
    insta::assert_snapshot!(digests(&dir.path(""), counts.into_iter().chain(tables)));
}

/// A line per file: digest and path, as `sha256sum` prints them.
fn digests(base: &Path, files: impl Iterator<Item = PathBuf>) -> String {
    files
        .map(|path| {
            let name = path.strip_prefix(base).unwrap().display();
            format!("{}  {name}\n", sha256_file(&path).unwrap())
        })
        .collect()
}
