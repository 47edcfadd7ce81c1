//! The arrows of ARCHITECTURE.md, checked against what cargo would link.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

use crate::support::{files_below, root};

/// A line a crate: what its normal dependencies must not reach.
const FORBIDDEN: &str = "
    l4d-data: l4d-masks l4d-frames l4d-query l4d-score l4d-board exr image polars plotters
    l4d-masks: l4d-frames exr image
    l4d-formats: l4d-masks l4d-frames l4d-splat l4d-import exr image
    l4d-frames: l4d-query l4d-score l4d-board polars plotters
    l4d-query: l4d-frames l4d-score l4d-board exr image polars plotters
    l4d-compose: l4d-votes l4d-score l4d-solve l4d-splat l4d-board polars plotters ratatui ureq
    l4d-english: l4d-masks l4d-frames l4d-splat l4d-ground l4d-score l4d-board exr image polars plotters
    l4d-score: l4d-frames l4d-query l4d-votes l4d-board l4d-gpu l4d-ground l4d-import l4d-solve exr image \
        polars plotters ratatui ureq
    l4d-ground: l4d-splat l4d-gpu l4d-solve l4d-votes l4d-score l4d-board polars plotters ratatui
    l4d-network: l4d-frames l4d-masks l4d-query l4d-english l4d-ground l4d-splat l4d-score exr image \
        polars plotters ratatui ureq
    l4d-solve: l4d-gpu l4d-votes l4d-score l4d-board wgpu polars plotters ratatui
    l4d-board: l4d-frames l4d-query l4d-votes exr ratatui ureq
    l4d-view: l4d-gpu l4d-query l4d-votes l4d-endpoint l4d-ground l4d-solve l4d-score l4d-board wgpu \
        polars plotters ratatui ureq
    l4d-votes: l4d-annotate l4d-frames l4d-query l4d-score l4d-board exr image polars plotters ratatui \
        ureq
    l4d-annotate: l4d-query l4d-score l4d-board l4d-endpoint l4d-propose polars plotters ureq
    l4d-endpoint: l4d-frames l4d-query l4d-votes l4d-score exr image polars plotters ratatui
    l4d-propose: l4d-votes l4d-annotate l4d-score l4d-board polars plotters ratatui
    l4d-import: l4d-query l4d-votes l4d-annotate l4d-endpoint l4d-ground l4d-solve l4d-splat l4d-score \
        l4d-gpu l4d-board wgpu polars plotters ratatui ureq
    l4d-py: l4d-query l4d-votes l4d-annotate l4d-endpoint l4d-propose l4d-ground l4d-solve l4d-import \
        l4d-gpu l4d-board wgpu polars plotters ratatui ureq
    l4d-release: l4d-frames l4d-query l4d-votes l4d-score l4d-solve l4d-splat l4d-import l4d-board exr \
        image polars plotters ratatui ureq
    l4d-cluster: l4d-frames l4d-query l4d-votes l4d-score l4d-splat l4d-solve l4d-blender polars plotters ratatui ureq
    l4d-blender: l4d-query l4d-votes l4d-score l4d-splat l4d-solve polars plotters ratatui ureq
    l4d-experiments: l4d-gpu l4d-votes l4d-board wgpu polars plotters ratatui
    l4d-splat: l4d-gpu wgpu
    l4d-gpu: l4d-query l4d-votes l4d-annotate l4d-endpoint l4d-score l4d-board polars plotters ratatui \
        ureq
";

/// (heavy dependency, the crates that may name it)
const QUARANTINE: &[(&str, &[&str])] = &[
    ("exr", &["l4d-frames"]),
    ("image", &["l4d-frames", "l4d-board"]),
    ("numpy", &["l4d-py"]),
    ("polars", &["l4d-board"]),
    ("plotters", &["l4d-board"]),
    ("mimalloc", &["l4d-py"]),
    ("pyo3", &["l4d-py"]),
    ("ratatui", &["l4d-annotate"]),
    ("ratatui-image", &["l4d-annotate"]),
    ("rten", &["l4d-network"]),
    ("ureq", &["l4d-endpoint"]),
    ("wgpu", &["l4d-gpu"]),
];

/// All packages and how they depend on each other, as cargo would build the workspace.
static METADATA: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(&cargo(&["metadata", "--format-version", "1", "--filter-platform", "host-tuple"]))
        .unwrap()
});

#[test]
fn no_crate_reaches_what_it_must_not() {
    let names: BTreeMap<&str, &str> =
        list(&METADATA["packages"]).map(|package| (text(&package["id"]), text(&package["name"]))).collect();
    let is_normal = |dependency: &&Value| list(&dependency["dep_kinds"]).any(|kind| kind["kind"].is_null());
    let needs =
        |node: &'static Value| list(&node["deps"]).filter(is_normal).map(|one| names[text(&one["pkg"])]);
    let graph: BTreeMap<&str, BTreeSet<&str>> = list(&METADATA["resolve"]["nodes"])
        .map(|node| (names[text(&node["id"])], needs(node).collect()))
        .collect();
    for line in FORBIDDEN.lines().filter(|line| !line.trim().is_empty()) {
        let (package, forbidden) = line.trim().split_once(": ").unwrap();
        let (mut reached, mut next) = (BTreeSet::new(), vec![package]);
        while let Some(name) = next.pop() {
            next.extend(graph[name].iter().filter(|name| reached.insert(**name)));
        }
        assert!(reached.contains("serde"), "{package} reaches too little");
        let wrong: Vec<&str> = forbidden.split(' ').filter(|name| reached.contains(name)).collect();
        assert!(wrong.is_empty(), "{package} reaches {wrong:?}");
    }
}

#[test]
fn without_default_features_nothing_heavy_is_linked() {
    let words = ["tree", "--package", "l4d", "--edges", "normal", "--prefix", "none", "--format", "{p}"];
    let tree = cargo(&[&words[..], &["--no-default-features"]].concat());
    let reached: BTreeSet<&str> = tree.lines().filter_map(|line| line.split(' ').next()).collect();
    assert!(reached.contains("l4d-score"), "cargo tree lists too little");
    for heavy in ["polars", "plotters", "wgpu", "ratatui"] {
        assert!(!reached.contains(heavy), "{heavy} is linked");
    }
}

#[test]
fn heavy_dependencies_are_behind_their_crate() {
    let ours = || list(&METADATA["packages"]).filter(|package| package["source"].is_null());
    for (heavy, owners) in QUARANTINE {
        let names = |dependency: &Value| dependency["kind"].is_null() && dependency["name"] == *heavy;
        let users = ours().filter(|package| list(&package["dependencies"]).any(names));
        let users: Vec<&str> = users.map(|package| text(&package["name"])).collect();
        assert!(!users.is_empty(), "no crate uses {heavy}");
        let is_owned = users.iter().all(|user| owners.contains(user));
        assert!(is_owned, "{heavy} is named by {users:?}, allowed: {owners:?}");
    }
}

#[test]
fn verbs_import_no_verbs() {
    let verbs = root().join("crates/l4d/commands");
    let mut wrong = Vec::new();
    for path in files_below(&verbs) {
        let text = std::fs::read_to_string(&path).unwrap();
        // A module of a verb's folder may name its siblings; a verb names no other verb.
        let outside = if path.parent() == Some(&verbs) { "super::" } else { "super::super::" };
        let is_import = |line: &&str| {
            let line = line.trim();
            line.contains("commands::") || (line.contains(outside) && !line.starts_with("use super::*"))
        };
        wrong.extend(text.lines().filter(is_import).map(|line| format!("{}: {line}", path.display())));
    }
    assert!(
        wrong.is_empty(),
        "move what is shared to a library, or to a module beside commands/: {wrong:#?}"
    );
}

/// Lines of all sources with their tests. Who adds to one says here why it has to grow, or finds what can go: Rust grew by
/// 1500 for depth from pictures alone (`l4d-splat/src/train/stereo`) and for results and sums of two more evaluations,
/// by 150 for the settings of 4DGaussians and SSIM, by which others compare, and by 160 for what brought models from
/// colour alone a decibel: planes of stereo that reach what cameras turn to, and dropout.
const BUDGETS: [(&str, &[&str], usize); 2] =
    [("rs", &["crates", "tests", "fuzz"], 151_610), ("py", &["blender_scripts"], 58_000)];

#[test]
fn sources_stay_within_their_budget() {
    for (end, folders, budget) in BUDGETS {
        let files = folders.iter().flat_map(|folder| files_below(&root().join(folder)));
        let sources = files.filter(|file| file.extension().is_some_and(|found| found == end));
        let lines: usize = sources.map(|file| std::fs::read_to_string(file).unwrap().lines().count()).sum();
        println!("{lines} lines of {end}, of {budget}");
        assert!(lines <= budget, "{lines} lines of {end}, but the budget is {budget}");
    }
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().unwrap().iter()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

fn cargo(args: &[&str]) -> String {
    let output = Command::new(env!("CARGO")).args(args).current_dir(root()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
