//! Regular English morphology. Exceptions are data (`lexicon.toml`).

const VOWELS: &str = "aeiou";

/// "walks", "catches", "carries".
pub(crate) fn third(base: &str) -> String {
    with_s(base)
}

pub(crate) fn ing(base: &str) -> String {
    match base.strip_suffix('e') {
        Some(stem) if !stem.ends_with('e') => format!("{stem}ing"),
        _ => format!("{base}ing"),
    }
}

/// "walked", "carried", "raised".
pub(crate) fn past(base: &str) -> String {
    match base.strip_suffix('y') {
        _ if base.ends_with('e') => format!("{base}d"),
        Some(stem) if !stem.ends_with(is_vowel) => format!("{stem}ied"),
        _ => format!("{base}ed"),
    }
}

/// Of the last word: "lamp posts", "boxes", "puppies".
pub(crate) fn plural(noun: &str) -> String {
    with_s(noun)
}

/// Whether "an" goes before this word.
pub(crate) fn takes_an(word: &str) -> bool {
    word.starts_with(is_vowel) && !word.starts_with("one") && !word.starts_with("uni")
}

fn with_s(word: &str) -> String {
    let hisses = ["s", "x", "z", "ch", "sh"].iter().any(|end| word.ends_with(end));
    match word.strip_suffix('y') {
        Some(stem) if !stem.ends_with(is_vowel) => format!("{stem}ies"),
        _ if hisses || word.ends_with("go") || word.ends_with("do") => format!("{word}es"),
        _ => format!("{word}s"),
    }
}

fn is_vowel(letter: char) -> bool {
    VOWELS.contains(letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_words() {
        assert_eq!([third("push"), third("carry"), third("play")], ["pushes", "carries", "plays"]);
        assert_eq!([ing("take"), ing("pull"), ing("carry")], ["taking", "pulling", "carrying"]);
        assert_eq!([past("raise"), past("carry"), past("play")], ["raised", "carried", "played"]);
        assert_eq!([plural("lamp post"), plural("box"), plural("tray")], ["lamp posts", "boxes", "trays"]);
        assert!(takes_an("apple") && !takes_an("one-eyed") && !takes_an("cup"));
    }
}
