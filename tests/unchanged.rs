//! What the shipped benchmark says, by digest: tracks, truth, queries, and the numbers that baselines get on it.
//!
//! A change of code changes none of these. A change of the benchmark does: `cargo insta review` then shows which.

use std::path::{Path, PathBuf};

use l4d_data::Profile;
use l4d_data::benchmark::Benchmark;
use l4d_data::digest::sha256_file;
use l4d_data::truth::Truth;

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
    let files = ["scenes", "truth/tiny", "truth/small", "truth/full", "queries"]
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

/// The same things are seen at `full` as at `small`, and as much of each, in all views and at all frames that both have.
#[test]
fn truth_of_full_is_that_of_small_in_more_pixels() {
    let bench = Benchmark::open(root().join("benchmark")).unwrap();
    for scene in &bench.manifest.scenes {
        let [small, full] =
            [Profile::Small, Profile::Full].map(|profile| bench.truth(profile, scene).unwrap());
        let pixels = |truth: &Truth| f64::from(truth.width * truth.height);
        let larger = pixels(&full) / pixels(&small);
        let place = |frame: &u32| full.frames.binary_search(frame).unwrap();
        let (mut expected, mut found) = (0.0, 0.0);
        for (view, instances) in &small.visible {
            for (instance, areas) in instances {
                for (frame, &area) in small.frames.iter().zip(areas) {
                    let of_full = f64::from(full.visible[view][instance][place(frame)]) / larger;
                    let area = f64::from(area);
                    // An outline of pixels is wrong by a few times the root of what it encloses at most; what is
                    // larger than a few pixels is in both.
                    let off = (of_full - area).abs() / of_full.max(area).max(1.0).sqrt();
                    assert!(
                        off < 4.0,
                        "{scene} {view} {instance} {frame}: {area} and {of_full} pixels of small"
                    );
                    expected += area;
                    found += of_full;
                }
            }
        }
        assert!((found / expected - 1.0_f64).abs() < 1e-3, "{scene}: {expected} and {found} pixels of small");
    }
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
