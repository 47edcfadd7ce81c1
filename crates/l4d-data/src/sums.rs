//! `SHA256SUMS`: `<64 hex digits>  <path relative to the folder>` a line, as `sha256sum -c` reads it.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use crate::error::DataError;
use crate::store::read_bounded;

/// No list is larger.
pub const MAX_BYTES: u64 = 64 << 20;

/// Digest and relative path of a line; none if it is no such line, or if its path leads out of the folder.
pub fn parse_line(line: &str) -> Option<(&str, &str)> {
    let (digest, file) = line.split_once(' ')?;
    let file = file.strip_prefix([' ', '*'])?;
    let is_digest =
        digest.len() == 64 && digest.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
    let stays_inside = Path::new(file).components().all(|part| matches!(part, Component::Normal(_)));
    (is_digest && !file.is_empty() && stays_inside).then_some((digest, file))
}

/// Reads a list: relative path -> digest.
///
/// # Errors
/// A file that cannot be read.
pub fn read(path: &Path) -> Result<BTreeMap<String, String>, DataError> {
    let text = String::from_utf8_lossy(&read_bounded(path, MAX_BYTES)?).into_owned();
    let mut sums = BTreeMap::new();
    for (index, line) in text.lines().enumerate() {
        let refuse = |message: String| DataError::format(path, format!("line {}", index + 1), message);
        let (digest, file) = parse_line(line).ok_or_else(|| {
            // As much of it as a person wants to see.
            let shown: String = line.chars().take(100).collect();
            refuse(format!("`{shown}` is not `<sha256>  <relative path>`"))
        })?;
        if sums.insert(file.to_owned(), digest.to_owned()).is_some() {
            return Err(refuse(format!("lists {file} a second time")));
        }
    }
    Ok(sums)
}

/// The list as text, sorted by path.
pub fn to_text(sums: &BTreeMap<String, String>) -> String {
    sums.iter().map(|(file, digest)| format!("{digest}  {file}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_sha256sum_and_nothing_that_leaves_the_folder() {
        let digest = "ab".repeat(32);
        assert_eq!(
            parse_line(&format!("{digest}  frames/cam00/0000.exr")),
            Some((digest.as_str(), "frames/cam00/0000.exr"))
        );
        assert_eq!(parse_line(&format!("{digest} *scene.json")), Some((digest.as_str(), "scene.json")));
        for bad in [
            "",
            "zz  a",
            &format!("{digest}  "),
            &format!("{digest}  ../a"),
            &format!("{digest}  /etc/passwd"),
        ] {
            assert_eq!(parse_line(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_list_round_trips_and_a_bad_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("SHA256SUMS");
        let sums = BTreeMap::from([("a b".to_owned(), "0".repeat(64)), ("c/d".to_owned(), "f".repeat(64))]);
        std::fs::write(&path, to_text(&sums)).unwrap();
        assert_eq!(read(&path).unwrap(), sums);
        std::fs::write(&path, format!("{}nonsense\n", to_text(&sums))).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("line 3"));
        std::fs::write(&path, format!("{}{}  c/d\n", to_text(&sums), "0".repeat(64))).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("c/d a second time"));
        std::fs::write(&path, "x".repeat(1000)).unwrap();
        assert!(read(&path).unwrap_err().to_string().len() < 300);
    }
}
