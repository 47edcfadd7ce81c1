//! What the geometric grounder can read, for people: in a line, and in full for the documentation.

use super::lexicon::Lexicon;

/// Verbs that show what kind of verbs are known.
const EXAMPLES: [&str; 5] = ["walk", "run", "jump", "carry", "lift"];
/// Where all words are listed.
const FULL_LIST: &str = "docs/panopticquery.md#words";

/// Kinds of words, how many, and a few of them.
pub(super) fn summary(lexicon: &Lexicon) -> String {
    let (kinds, verbs) = (lexicon.kinds().count(), lexicon.verbs().len());
    format!(
        "colours, patterns, materials, shapes, sizes, places, {kinds} kinds of things and {verbs} verbs such as {} ({FULL_LIST})",
        EXAMPLES.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::super::looks::is_visible;
    use super::super::parse::place_words;
    use super::*;

    const MARKS: [&str; 2] = ["<!-- words -->\n", "<!-- /words -->"];

    fn page() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/panopticquery.md")
    }

    /// "cup (mug, teacup)"
    fn with_synonyms(name: &str, words: &[impl AsRef<str>]) -> String {
        let name = name.replace('_', " ");
        let others: Vec<&str> = words.iter().map(AsRef::as_ref).filter(|word| *word != name).collect();
        if others.is_empty() { name } else { format!("{name} ({})", others.join(", ")) }
    }

    fn of_colour(lexicon: &Lexicon, name: &str) -> String {
        let others = lexicon.colour_words().iter().filter(|(_, meant)| *meant == name);
        with_synonyms(name, &others.map(|(word, _)| word).collect::<Vec<_>>())
    }

    fn rows(lexicon: &Lexicon) -> Vec<(String, String)> {
        let join = |words: Vec<String>| words.join(", ");
        let kinds = lexicon.kinds().map(|(name, words)| with_synonyms(name, words)).collect();
        let mutual = |is_mutual: bool| {
            let verbs = lexicon.verbs().iter().filter(|verb| verb.motion.is_mutual() == is_mutual);
            join(verbs.map(|verb| with_synonyms(&verb.words[0], &verb.words[1..])).collect())
        };
        let mut rows = vec![
            ("kinds of things".to_owned(), join(kinds)),
            ("verbs of one".to_owned(), mutual(false)),
            ("verbs of two".to_owned(), mutual(true)),
            (
                "colours".to_owned(),
                join(lexicon.colours().map(|(name, _)| of_colour(lexicon, name)).collect()),
            ),
        ];
        for (key, values) in lexicon.properties() {
            let seen = values.iter().filter(|(value, _)| is_visible(lexicon, key, value));
            let words: Vec<String> = seen.map(|(value, words)| with_synonyms(value, words)).collect();
            if !words.is_empty() {
                rows.push((key.to_owned(), join(words)));
            }
        }
        rows.push(("places".to_owned(), join(place_words().map(str::to_owned).collect())));
        rows
    }

    #[test]
    fn the_line_is_short_and_true() {
        let lexicon = Lexicon::shipped().unwrap();
        assert!(summary(lexicon).len() < 200, "{}", summary(lexicon));
        for example in EXAMPLES {
            assert!(lexicon.verbs().iter().any(|verb| verb.name == example), "{example}");
        }
    }

    #[test]
    fn the_documentation_lists_all_words() {
        let text = std::fs::read_to_string(page()).unwrap();
        let (before, rest) = text.split_once(MARKS[0]).unwrap();
        let (table, after) = rest.split_once(MARKS[1]).unwrap();
        let mut wanted = "\n| | words |\n|---|---|\n".to_owned();
        for (what, words) in rows(Lexicon::shipped().unwrap()) {
            wanted += &format!("| {what} | {words} |\n");
        }
        wanted += "\n";
        if table == wanted {
            return;
        }
        if std::env::var_os("UPDATE_DOCS").is_some() {
            std::fs::write(page(), [before, MARKS[0], &wanted, MARKS[1], after].concat()).unwrap();
            return;
        }
        panic!("the words have changed: run `UPDATE_DOCS=1 cargo test -p l4d-ground --lib vocabulary`");
    }
}
