//! Codes of findings: each that is documented is emitted, and each that is emitted is documented.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::support::root;

/// `"L4D` and three digits.
const DIGITS: std::ops::Range<usize> = 3..6;

#[test]
fn every_code_is_documented_and_emitted() {
    let mut sources = String::new();
    gather(&root().join("crates"), &mut sources);
    let findings = std::fs::read_to_string(root().join("docs/findings.md")).unwrap();
    let documented: BTreeSet<&str> =
        findings.lines().filter_map(|line| code_at(line.strip_prefix("| ")?)).collect();
    let constants: BTreeMap<&str, &str> = sources.lines().filter_map(constant).collect();
    let written: BTreeSet<&str> =
        sources.match_indices("\"L4D").filter_map(|(place, _)| code_at(&sources[place + 1..])).collect();

    let undocumented: Vec<_> = written.difference(&documented).collect();
    assert!(undocumented.is_empty(), "not in docs/findings.md: {undocumented:?}");
    // A constant is written once where it is defined; it has to be named somewhere else as well.
    let is_emitted = |code: &str| {
        let is_named = |name: &&str| words(&sources).filter(|word| word == name).count() > 1;
        written.contains(code) && constants.get(code).is_none_or(is_named)
    };
    let never: Vec<_> = documented.iter().filter(|code| !is_emitted(code)).collect();
    assert!(never.is_empty(), "documented, and never emitted: {never:?}");
}

/// The text of all sources below a folder, without tests.
fn gather(folder: &Path, into: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_dir() {
            if !["tests", "examples", "target"].contains(&name.as_str()) {
                gather(&path, into);
            }
        } else if name.ends_with(".rs") && name != "tests.rs" {
            let text = std::fs::read_to_string(&path).unwrap();
            into.push_str(text.split("#[cfg(test)]").next().unwrap_or_default());
        }
    }
}

/// The code that a text begins with.
fn code_at(text: &str) -> Option<&str> {
    let is_code = text.starts_with("L4D") && text.get(DIGITS)?.bytes().all(|byte| byte.is_ascii_digit());
    is_code.then(|| &text[..DIGITS.end])
}

/// `const NAME: &str = "L4D...";` as code and name.
fn constant(line: &str) -> Option<(&str, &str)> {
    let (head, value) = line.split_once(": &str = \"")?;
    Some((code_at(value)?, head.rsplit(' ').next()?))
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_'))
}
