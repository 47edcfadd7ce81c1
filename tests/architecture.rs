//! The arrows of ARCHITECTURE.md, checked against what cargo would link.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// (crate, what its normal dependencies must not reach)
const FORBIDDEN: &[(&str, &[&str])] = &[
    (
        "l4d-data",
        &[
            "l4d-masks",
            "l4d-frames",
            "l4d-query",
            "l4d-score",
            "l4d-board",
            "exr",
            "image",
            "polars",
            "plotters",
        ],
    ),
    ("l4d-masks", &["l4d-frames", "exr", "image"]),
    ("l4d-formats", &["l4d-masks", "l4d-frames", "l4d-splat", "l4d-import", "exr", "image"]),
    ("l4d-frames", &["l4d-query", "l4d-score", "l4d-board", "polars", "plotters"]),
    ("l4d-query", &["l4d-frames", "l4d-score", "l4d-board", "exr", "image", "polars", "plotters"]),
    (
        "l4d-score",
        &[
            "l4d-frames",
            "l4d-query",
            "l4d-votes",
            "l4d-board",
            "l4d-gpu",
            "l4d-ground",
            "l4d-import",
            "l4d-solve",
            "exr",
            "image",
            "polars",
            "plotters",
            "ratatui",
            "ureq",
        ],
    ),
    (
        "l4d-ground",
        &[
            "l4d-splat",
            "l4d-gpu",
            "l4d-solve",
            "l4d-votes",
            "l4d-score",
            "l4d-board",
            "polars",
            "plotters",
            "ratatui",
        ],
    ),
    (
        "l4d-solve",
        &["l4d-gpu", "l4d-votes", "l4d-score", "l4d-board", "wgpu", "polars", "plotters", "ratatui"],
    ),
    ("l4d-board", &["l4d-frames", "l4d-query", "l4d-votes", "exr", "ratatui", "ureq"]),
    (
        "l4d-votes",
        &[
            "l4d-annotate",
            "l4d-frames",
            "l4d-query",
            "l4d-score",
            "l4d-board",
            "exr",
            "image",
            "polars",
            "plotters",
            "ratatui",
            "ureq",
        ],
    ),
    (
        "l4d-annotate",
        &["l4d-query", "l4d-score", "l4d-board", "l4d-endpoint", "l4d-propose", "polars", "plotters", "ureq"],
    ),
    (
        "l4d-endpoint",
        &[
            "l4d-frames",
            "l4d-query",
            "l4d-votes",
            "l4d-score",
            "exr",
            "image",
            "polars",
            "plotters",
            "ratatui",
        ],
    ),
    (
        "l4d-propose",
        &["l4d-votes", "l4d-annotate", "l4d-score", "l4d-board", "polars", "plotters", "ratatui"],
    ),
    (
        "l4d-import",
        &[
            "l4d-query",
            "l4d-votes",
            "l4d-annotate",
            "l4d-endpoint",
            "l4d-ground",
            "l4d-solve",
            "l4d-splat",
            "l4d-score",
            "l4d-gpu",
            "l4d-board",
            "wgpu",
            "polars",
            "plotters",
            "ratatui",
            "ureq",
        ],
    ),
    (
        "l4d-py",
        &[
            "l4d-query",
            "l4d-votes",
            "l4d-annotate",
            "l4d-endpoint",
            "l4d-propose",
            "l4d-ground",
            "l4d-solve",
            "l4d-import",
            "l4d-gpu",
            "l4d-board",
            "wgpu",
            "polars",
            "plotters",
            "ratatui",
            "ureq",
        ],
    ),
    (
        "l4d-release",
        &[
            "l4d-frames",
            "l4d-query",
            "l4d-votes",
            "l4d-score",
            "l4d-solve",
            "l4d-splat",
            "l4d-import",
            "l4d-board",
            "exr",
            "image",
            "polars",
            "plotters",
            "ratatui",
            "ureq",
        ],
    ),
    (
        "l4d-blender",
        &[
            "l4d-query",
            "l4d-votes",
            "l4d-score",
            "l4d-splat",
            "l4d-solve",
            "polars",
            "plotters",
            "ratatui",
            "ureq",
        ],
    ),
    ("l4d-experiments", &["l4d-gpu", "l4d-votes", "l4d-board", "wgpu", "polars", "plotters", "ratatui"]),
    ("l4d-splat", &["l4d-gpu", "wgpu"]),
    (
        "l4d-gpu",
        &[
            "l4d-query",
            "l4d-votes",
            "l4d-annotate",
            "l4d-endpoint",
            "l4d-score",
            "l4d-board",
            "polars",
            "plotters",
            "ratatui",
            "ureq",
        ],
    ),
];

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
    ("ureq", &["l4d-endpoint"]),
    ("wgpu", &["l4d-gpu"]),
];

#[test]
fn no_crate_reaches_what_it_must_not() {
    for (package, forbidden) in FORBIDDEN {
        let reached = tree(package);
        assert!(reached.contains("serde"), "cargo tree of {package} lists nothing");
        let wrong: Vec<&&str> = forbidden.iter().filter(|name| reached.contains(**name)).collect();
        assert!(wrong.is_empty(), "{package} reaches {wrong:?}");
    }
}

#[test]
fn without_default_features_nothing_heavy_is_linked() {
    let reached = packages(&cargo(&[
        "tree",
        "--package",
        "l4d",
        "--no-default-features",
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--format",
        "{p}",
    ]));
    assert!(reached.contains("l4d-score"), "cargo tree lists too little");
    for heavy in ["polars", "plotters", "wgpu", "ratatui"] {
        assert!(!reached.contains(heavy), "{heavy} is linked");
    }
}

#[test]
fn heavy_dependencies_stand_behind_their_crate() {
    let named = named_dependencies();
    for (heavy, owners) in QUARANTINE {
        let users: Vec<&str> = named
            .iter()
            .filter(|(_, dependencies)| dependencies.contains(*heavy))
            .map(|(package, _)| package.as_str())
            .collect();
        assert!(!users.is_empty(), "no crate uses {heavy}");
        assert!(
            users.iter().all(|user| owners.contains(user)),
            "{heavy} is named by {users:?}, allowed: {owners:?}"
        );
    }
}

#[test]
fn verbs_import_no_verbs() {
    let verbs = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/l4d/commands");
    let mut wrong = Vec::new();
    for path in rust_files(&verbs) {
        let text = std::fs::read_to_string(&path).unwrap();
        // A module of a verb's folder may name its siblings; a verb names no other verb.
        let outside = if path.parent() == Some(&verbs) { "super::" } else { "super::super::" };
        let is_import = |line: &str| {
            let line = line.trim();
            line.contains("commands::") || (line.contains(outside) && !line.starts_with("use super::*"))
        };
        wrong.extend(
            text.lines().filter(|line| is_import(line)).map(|line| format!("{}: {line}", path.display())),
        );
    }
    assert!(
        wrong.is_empty(),
        "move what is shared to a library, or to a module beside commands/: {wrong:#?}"
    );
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else {
            files.push(path);
        }
    }
    files
}

/// Everything that a package links by itself, with its own default features.
fn tree(package: &str) -> BTreeSet<String> {
    let output =
        cargo(&["tree", "--package", package, "--edges", "normal", "--prefix", "none", "--format", "{p}"]);
    packages(&output)
}

fn packages(tree: &str) -> BTreeSet<String> {
    tree.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

/// Package -> the normal dependencies that its manifest names.
fn named_dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let metadata: Value =
        serde_json::from_str(&cargo(&["metadata", "--format-version", "1", "--no-deps"])).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let normal = |package: &Value| {
        let dependencies = package["dependencies"].as_array().unwrap().clone();
        dependencies.into_iter().filter(|d| d["kind"].is_null()).map(|d| text(&d["name"])).collect()
    };
    packages.iter().map(|package| (text(&package["name"]), normal(package))).collect()
}

fn cargo(args: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO")).args(args).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
