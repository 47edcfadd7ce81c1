//! Paths with named fields: how the files of a method are found, and what their names say.
//!
//! ```text
//! {scene}_{level}/test/ours_{iteration}/renders_npy/{position:05}.npy
//! {frame+1:05}/chosen_{text}.png
//! ```
//!
//! `{name}` takes some characters of one folder or file name, `{name:05}` takes digits, padded with zeros to five, and
//! `{frame+1:05}` says that the number in the name is one more than the frame. A field that comes twice has to say the
//! same twice. Links are refused, since they could lead out of the folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use l4d_data::store::list_folder;
use l4d_data::{DataError, Report};

use super::codes;

/// What the fields of a template were found to be, numbers without padding and offset.
pub(super) type Captures = BTreeMap<String, String>;

/// Files that a template may find.
const MOST_FILES: usize = 1 << 21;
/// Fields within one name, so that trying all ways to read it stays cheap.
const MOST_FIELDS: usize = 4;
/// Fields that are numbers, whatever their format.
const NUMBERS: [&str; 4] = ["frame", "position", "level", "image"];

/// A path with fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Template {
    source: String,
    names: Vec<Vec<Piece>>,
    /// Scenes that a name is read as before anything else: `{scene}_{view}` alone does not say where one ends.
    scenes: BTreeSet<String>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Piece {
    Literal(String),
    Text(String),
    Number { field: String, digits: usize, offset: i64 },
}

/// A file that a template found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Hit {
    /// Where it is.
    pub(super) path: PathBuf,
    /// What its path says.
    pub(super) captures: Captures,
}

impl Hit {
    /// A field that is a number.
    pub(super) fn number(&self, field: &str) -> Option<u64> {
        self.captures.get(field)?.parse().ok()
    }

    pub(super) fn text(&self, field: &str) -> Option<&str> {
        self.captures.get(field).map(String::as_str)
    }
}

impl Template {
    /// Reads a template.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let fault = |message: String| format!("template `{}`: {message}", l4d_data::error::inert(text));
        let mut names = Vec::new();
        for name in text.split('/') {
            if matches!(name, "" | "." | "..") {
                let message = "must be a path below the given folder, without `.`, `..` or a slash too many";
                return Err(fault(message.to_owned()));
            }
            let pieces = pieces(name).map_err(fault)?;
            let is_field = |piece: &&Piece| !matches!(piece, Piece::Literal(_));
            if pieces.iter().filter(is_field).count() > MOST_FIELDS {
                return Err(fault(format!("`{name}` has more than {MOST_FIELDS} fields")));
            }
            let both_text = |pair: &[Piece]| matches!(pair, [Piece::Text(_), Piece::Text(_)]);
            if pieces.windows(2).any(both_text) {
                return Err(fault(format!("`{name}` has two fields with nothing between them")));
            }
            names.push(pieces);
        }
        Ok(Self { source: text.to_owned(), names, scenes: BTreeSet::new() })
    }

    /// The same, for files of these scenes.
    pub(super) fn of_scenes(self, scenes: impl IntoIterator<Item = String>) -> Self {
        Self { scenes: scenes.into_iter().collect(), ..self }
    }

    /// Names of the fields, in the order of the path, each once.
    pub(super) fn fields(&self) -> Vec<&str> {
        let mut fields = Vec::new();
        for piece in self.names.iter().flatten() {
            if let Piece::Text(field) | Piece::Number { field, .. } = piece
                && !fields.contains(&field.as_str())
            {
                fields.push(field);
            }
        }
        fields
    }

    /// The path with all fields filled in; none where one is not known.
    pub(super) fn fill(&self, root: &Path, captures: &Captures) -> Option<PathBuf> {
        let mut path = root.to_owned();
        for name in &self.names {
            let parts: Option<Vec<String>> = name.iter().map(|piece| piece.filled(captures)).collect();
            path.push(parts?.concat());
        }
        Some(path)
    }

    /// All files below `root` that fit, sorted by path. `bound` says what fields have to be.
    pub(super) fn find(
        &self,
        root: &Path,
        bound: &Captures,
        report: &mut Report,
    ) -> Result<Vec<Hit>, DataError> {
        list_folder(root)?;
        let mut hits = Vec::new();
        self.walk(root, 0, bound, &mut hits, report)?;
        Ok(hits)
    }

    fn walk(
        &self,
        folder: &Path,
        depth: usize,
        captures: &Captures,
        hits: &mut Vec<Hit>,
        report: &mut Report,
    ) -> Result<(), DataError> {
        let pieces = &self.names[depth];
        let names = match pieces.as_slice() {
            [Piece::Literal(name)] => vec![name.clone()],
            _ => list_folder(folder)?,
        };
        for name in names {
            let mut found = captures.clone();
            let is_found = fits(pieces, &name, &mut found, &self.scenes)
                || fits(pieces, &name, &mut found, &BTreeSet::new());
            if !is_found {
                continue;
            }
            let path = folder.join(&name);
            let Ok(metadata) = fs::symlink_metadata(&path) else { continue };
            let is_last = depth + 1 == self.names.len();
            if metadata.is_symlink() {
                let message = "is a link, which could lead out of the folder";
                report.error(codes::LINK, &path, "", message, "put the real file or folder there");
            } else if metadata.is_dir() && !is_last {
                self.walk(&path, depth + 1, &found, hits, report)?;
            } else if metadata.is_file() && is_last {
                if hits.len() == MOST_FILES {
                    let message = format!("holds more than {MOST_FILES} files that fit `{self}`");
                    let hint = "give the folder of one method";
                    return Err(DataError::invalid(folder, "folder", message, hint));
                }
                hits.push(Hit { path, captures: found });
            }
        }
        Ok(())
    }
}

impl fmt::Display for Template {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.source)
    }
}

impl Piece {
    fn filled(&self, captures: &Captures) -> Option<String> {
        match self {
            Self::Literal(text) => Some(text.clone()),
            // A value that would leave the folder fills nothing.
            Self::Text(field) => captures.get(field).filter(|value| is_name(value)).cloned(),
            Self::Number { field, digits, offset } => {
                let number: i64 = captures.get(field)?.parse().ok()?;
                Some(format!("{:0digits$}", number.checked_add(*offset)?))
            }
        }
    }
}

fn is_name(value: &str) -> bool {
    !value.is_empty() && value != "." && value != ".." && !value.contains(['/', '\\', '\0'])
}

fn pieces(name: &str) -> Result<Vec<Piece>, String> {
    let mut pieces = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let (literal, after) = rest.split_at(rest.find('{').unwrap_or(rest.len()));
        if literal.contains('}') {
            return Err("has a `}` without its `{`".to_owned());
        }
        if !literal.is_empty() {
            pieces.push(Piece::Literal(literal.to_owned()));
        }
        let Some(after) = after.strip_prefix('{') else { break };
        let (field, after) = after.split_once('}').ok_or("has a `{` without its `}`")?;
        pieces.push(field_piece(field)?);
        rest = after;
    }
    Ok(pieces)
}

fn field_piece(text: &str) -> Result<Piece, String> {
    let (name, format) = match text.split_once(':') {
        Some((name, format)) => (name, Some(format)),
        None => (text, None),
    };
    let (name, offset) = match name.find(['+', '-']) {
        Some(at) => {
            let offset: i64 =
                name[at..].parse().map_err(|_number| format!("`{{{text}}}` has no number to add"))?;
            if offset.abs() > 1_000_000 {
                return Err(format!("`{{{text}}}` adds more than any clip is long"));
            }
            (&name[..at], Some(offset))
        }
        None => (name, None),
    };
    if name.is_empty() || !name.chars().all(|character| character.is_ascii_alphanumeric() || character == '_')
    {
        return Err(format!("`{{{text}}}` has no name of letters, digits and `_`"));
    }
    let digits = match format {
        None => 0,
        Some(format) => match format.strip_prefix('0').and_then(|digits| digits.parse().ok()) {
            Some(digits @ 1..=12) => digits,
            _ => return Err(format!("`{{{text}}}` has a format other than :01 to :012")),
        },
    };
    let field = name.to_owned();
    if format.is_some() || offset.is_some() || NUMBERS.contains(&name) {
        return Ok(Piece::Number { field, digits, offset: offset.unwrap_or(0) });
    }
    Ok(Piece::Text(field))
}

/// Reads a name piece by piece, the shortest text first; true if all of it fits, and then `captures` says how. A scene is
/// one of `scenes`, unless there are none.
fn fits(pieces: &[Piece], name: &str, captures: &mut Captures, scenes: &BTreeSet<String>) -> bool {
    let Some((piece, rest)) = pieces.split_first() else { return name.is_empty() };
    match piece {
        Piece::Literal(text) => {
            name.strip_prefix(text.as_str()).is_some_and(|after| fits(rest, after, captures, scenes))
        }
        Piece::Number { field, digits, offset } => {
            let longest = name.bytes().take_while(u8::is_ascii_digit).count().min(18);
            let lengths = ((*digits).max(1)..=longest).rev();
            for length in
                lengths.filter(|&length| *digits == 0 || length == *digits || !name.starts_with('0'))
            {
                let Some(number) = name[..length].parse::<i64>().ok().map(|number| number - offset) else {
                    continue;
                };
                if number >= 0
                    && bind(field, &number.to_string(), captures, |captures| {
                        fits(rest, &name[length..], captures, scenes)
                    })
                {
                    return true;
                }
            }
            false
        }
        Piece::Text(field) => {
            let ends = name.char_indices().map(|(at, character)| at + character.len_utf8());
            // A number takes all of its digits.
            let is_cut = |value: &str| {
                matches!(rest.first(), Some(Piece::Number { .. }))
                    && value.ends_with(|c: char| c.is_ascii_digit())
            };
            let may_be = |value: &str| {
                !is_cut(value) && (field != "scene" || scenes.is_empty() || scenes.contains(value))
            };
            for end in ends.filter(|&end| may_be(&name[..end])).collect::<Vec<_>>() {
                if bind(field, &name[..end], captures, |captures| fits(rest, &name[end..], captures, scenes))
                {
                    return true;
                }
            }
            false
        }
    }
}

/// Tries a value for a field; takes it back if what follows does not fit.
fn bind(field: &str, value: &str, captures: &mut Captures, rest: impl FnOnce(&mut Captures) -> bool) -> bool {
    if let Some(known) = captures.get(field) {
        return known == value && rest(captures);
    }
    captures.insert(field.to_owned(), value.to_owned());
    let found = rest(captures);
    if !found {
        captures.remove(field);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(template: &str, name: &str) -> Option<Captures> {
        let template = Template::parse(template).unwrap();
        let mut captures = Captures::new();
        fits(&template.names[0], name, &mut captures, &template.scenes).then_some(captures)
    }

    fn field(template: &str, name: &str, field: &str) -> Option<String> {
        read(template, name)?.remove(field)
    }

    #[test]
    fn names_are_read_as_they_were_written() {
        let chosen = "chosen_{text}.png";
        assert_eq!(field(chosen, "chosen_the red cup.png", "text").unwrap(), "the red cup");
        assert_eq!(field(chosen, "chosen_.png", "text"), None);
        assert_eq!(field("{frame+1:05}", "00042", "frame").unwrap(), "41");
        assert_eq!(field("{frame+1:05}", "00000", "frame"), None, "no frame is before the first");
        assert_eq!(field("{frame:05}", "0042", "frame"), None, "four digits are not five");
        assert_eq!(field("{frame:04}", "12345", "frame").unwrap(), "12345");
        assert_eq!(field("{frame:04}", "012345", "frame"), None);
        let pair = read("{scene}_{level}", "room_living_cats_3").unwrap();
        assert_eq!((pair["scene"].as_str(), pair["level"].as_str()), ("room_living_cats", "3"));
        let glued = read("{frame:05}{text}.npy", "00019a red cup.npy").unwrap();
        assert_eq!((glued["frame"].as_str(), glued["text"].as_str()), ("19", "a red cup"));
        let named = "{picture}{frame}_{text}.png";
        let found = read(named, "cam_00053_a red cup.png").unwrap();
        let fields = ["picture", "frame", "text"].map(|field| found[field].as_str());
        assert_eq!(fields, ["cam_", "53", "a red cup"]);
        assert_eq!(read(named, "12_a red cup.png"), None, "a number is not cut in two");
    }

    #[test]
    fn a_field_that_comes_twice_says_the_same() {
        assert!(read("{scene}-{scene}", "a-a").is_some());
        assert!(read("{scene}-{scene}", "a-b").is_none());
    }

    #[test]
    fn a_known_scene_is_found_before_shorter_names() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["room_cats_cam_01", "yard_cam_01"] {
            fs::create_dir_all(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name).join("0.png"), "x").unwrap();
        }
        let template = Template::parse("{scene}_{view}/{position}.png").unwrap();
        let template = template.of_scenes(["room_cats".to_owned()]);
        let hits = template.find(folder.path(), &Captures::new(), &mut Report::default()).unwrap();
        let scenes: Vec<&str> = hits.iter().filter_map(|hit| hit.text("scene")).collect();
        assert_eq!(scenes, ["room_cats", "yard"]);
        assert_eq!(hits[0].text("view"), Some("cam_01"));
    }

    #[test]
    fn what_is_no_template_says_why() {
        for (text, reason) in [
            ("a/../b", "below the given folder"),
            ("/a", "below the given folder"),
            ("{a", "without its `}`"),
            ("a}", "without its `{`"),
            ("{}", "no name"),
            ("{frame:5d}", "format"),
            ("{frame+x}", "no number"),
            ("{frame+99999999}", "more than any clip is long"),
            ("{a}{b}", "nothing between"),
            ("{a}-{b}-{c}-{d}-{e}", "more than 4"),
        ] {
            let error = Template::parse(text).unwrap_err();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }

    #[test]
    fn files_are_found_and_links_are_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        for name in
            ["cats_1/renders/00000.npy", "cats_2/renders/00000.npy", "cats_2/renders/notes.txt", "dogs/x"]
        {
            fs::create_dir_all(root.join(name).parent().unwrap()).unwrap();
            fs::write(root.join(name), "x").unwrap();
        }
        std::os::unix::fs::symlink(root.join("cats_1"), root.join("cats_3")).unwrap();
        let template = Template::parse("{scene}_{level}/renders/{position:05}.npy").unwrap();
        let mut report = Report::default();
        let hits = template.find(root, &Captures::new(), &mut report).unwrap();
        let levels: Vec<Option<u64>> = hits.iter().map(|hit| hit.number("level")).collect();
        assert_eq!(levels, [Some(1), Some(2)]);
        let findings = report.into_sorted();
        assert_eq!((findings.len(), findings[0].code), (1, codes::LINK));
        let bound = Captures::from([("level".to_owned(), "2".to_owned())]);
        assert_eq!(template.find(root, &bound, &mut Report::default()).unwrap().len(), 1);
        assert_eq!(template.fill(root, &hits[0].captures).unwrap(), hits[0].path);
        let leaving = Captures::from([("scene".to_owned(), "..".to_owned())]);
        assert_eq!(Template::parse("{scene}/x").unwrap().fill(root, &leaving), None);
    }
}
