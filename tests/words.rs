//! Plain words: idioms that readers of other tools do not know stay out of docs, comments and messages.

use std::path::{Path, PathBuf};

use crate::support::{files_below, root};

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
    "crates/l4d-english/src/wide",
    "crates/l4d-english/src/wide.rs",
    "crates/l4d-ground/src/vlm/prompts",
    "crates/l4d-propose/briefs",
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
        files.extend(files_below(&root().join(folder)));
    }
    let is_text = |file: &&PathBuf| file.extension().is_some_and(|end| end == "rs" || end == "md");
    let is_exempt = |file: &PathBuf| EXEMPT.iter().any(|exempt| file.starts_with(root().join(exempt)));
    let read = files.iter().filter(is_text).filter(|file| !is_exempt(file));
    let found: Vec<String> = read.flat_map(|file| findings(file)).collect();
    assert!(found.is_empty(), "{} places:\n{}", found.len(), found.join("\n"));
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
