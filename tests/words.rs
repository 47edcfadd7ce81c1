//! Plain words: idioms that readers of other tools do not know stay out of docs, comments and messages.

use std::path::{Path, PathBuf};

use crate::support::root;

/// What not to write, and what says the same.
const BANNED: [(&str, &str); 12] = [
    ("nobody", "no one"),
    ("whoever", "who; any annotator, user, ..."),
    ("strangers", "untrusted input"),
    ("is told", "gets, has, sees"),
    ("are told", "get, have, see"),
    ("stands in", "is in"),
    ("stand in", "are in"),
    ("stands there", "is there"),
    ("stands beside", "is beside"),
    ("stands for", "means"),
    ("stands alone", "is self-contained"),
    ("for those who look", "say what it is"),
];

/// Texts that speak of things that stand, and not of files and numbers: language models read them, or they are a lexicon.
const EXEMPT: [&str; 8] = [
    "crates/l4d-ground/src/vlm/prompts",
    "crates/l4d-ground/src/geometric",
    "crates/l4d-propose/briefs",
    "crates/l4d-ground/tests/geometric_reading.rs",
    "crates/l4d-propose/src",
    "crates/l4d-query/src",
    "tests/page.rs",
    "tests/words.rs",
];

#[test]
fn docs_and_messages_use_plain_words() {
    let mut files: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|file| root().join(file)).into();
    for folder in ["annotation", "benchmark", "crates", "docs", "tests"] {
        gather(&root().join(folder), &mut files);
    }
    let found: Vec<String> = files.iter().flat_map(|file| findings(file)).collect();
    assert!(found.is_empty(), "{} places:\n{}", found.len(), found.join("\n"));
}

/// Sources and docs below a folder, less those that are exempt.
fn gather(folder: &Path, into: &mut Vec<PathBuf>) {
    let is_exempt = |path: &Path| EXEMPT.iter().any(|exempt| path.starts_with(root().join(exempt)));
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    for path in entries.filter(|path| !is_exempt(path)) {
        if path.is_dir() {
            gather(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "md") {
            into.push(path);
        }
    }
}

fn findings(file: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(file).unwrap();
    let name = file.strip_prefix(root()).unwrap().display();
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, padded(line)));
    lines
        .flat_map(|(number, line)| {
            let banned = BANNED.iter().filter(move |(idiom, _)| line.contains(&format!(" {idiom} ")));
            banned.map(move |(idiom, instead)| format!("{number}: `{idiom}` ({instead})"))
        })
        .map(|finding| format!("{name}:{finding}"))
        .collect()
}

/// The words of a line in small letters, a space before and after each; an identifier is one word.
fn padded(line: &str) -> String {
    let words = line.split(|letter: char| !(letter.is_alphanumeric() || "_'".contains(letter)));
    words.filter(|word| !word.is_empty()).fold(" ".to_owned(), |line, word| line + &word.to_lowercase() + " ")
}
