//! Codes of findings: each that is documented is emitted, and each that is emitted is documented.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::support::{files_below, root, shipped};

/// `"L4D` and three digits.
const DIGITS: std::ops::Range<usize> = 3..6;

#[test]
fn every_code_is_documented_and_emitted() {
    let sources = sources();
    let findings = shipped("docs/findings.md");
    let documented: BTreeSet<&str> =
        findings.lines().filter_map(|line| code_at(line.strip_prefix("| ")?)).collect();
    let constants: BTreeMap<&str, &str> = sources.lines().filter_map(constant).collect();
    let written: BTreeSet<&str> =
        sources.match_indices("\"L4D").filter_map(|(place, _)| code_at(&sources[place + 1..])).collect();

    let undocumented: Vec<_> = written.difference(&documented).collect();
    assert!(undocumented.is_empty(), "not in docs/findings.md: {undocumented:?}");
    let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
    for word in sources.split(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_')) {
        *uses.entry(word).or_default() += 1;
    }
    // A constant is written once where it is defined; it has to be named somewhere else as well.
    let is_emitted =
        |code: &str| written.contains(code) && constants.get(code).is_none_or(|name| uses[name] > 1);
    let never: Vec<_> = documented.iter().filter(|code| !is_emitted(code)).collect();
    assert!(never.is_empty(), "documented, and never emitted: {never:?}");
}

/// The text of all sources, without tests.
fn sources() -> String {
    let is_source = |path: &Path| {
        let is_apart =
            ["tests", "examples", "target"].iter().any(|folder| path.iter().any(|part| part == *folder));
        path.extension().is_some_and(|end| end == "rs") && !is_apart && !path.ends_with("tests.rs")
    };
    let crates = root().join("crates");
    let files = files_below(&crates).into_iter();
    let files = files.filter(|path| is_source(path.strip_prefix(&crates).unwrap()));
    let text = |path| std::fs::read_to_string(path).unwrap();
    files.map(|path| text(path).split("#[cfg(test)]").next().unwrap_or_default().to_owned()).collect()
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
