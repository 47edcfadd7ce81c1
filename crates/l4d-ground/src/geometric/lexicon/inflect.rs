//! How regular English words change: plurals, third person, -ing, past.

fn is_vowel(letter: char) -> bool {
    "aeiou".contains(letter)
}

fn ends_in_consonant_y(word: &str) -> bool {
    let mut letters = word.chars().rev();
    letters.next() == Some('y') && letters.next().is_some_and(|letter| !is_vowel(letter))
}

fn hisses(word: &str) -> bool {
    ["s", "x", "z", "ch", "sh"].iter().any(|ending| word.ends_with(ending))
}

/// "walks".
pub(super) fn third(word: &str) -> String {
    match word {
        "go" | "do" => format!("{word}es"),
        _ => plural(word),
    }
}

/// "cups", "cups of tea".
pub(super) fn plural(word: &str) -> String {
    if let Some((head, rest)) = word.split_once(" of ") {
        return format!("{} of {rest}", plural(head));
    }
    if ends_in_consonant_y(word) {
        format!("{}ies", &word[..word.len() - 1])
    } else if hisses(word) {
        format!("{word}es")
    } else {
        format!("{word}s")
    }
}

/// Whether the last consonant may double: "bat", "pet", "nod".
fn may_double(word: &str) -> bool {
    let letters: Vec<char> = word.chars().rev().take(3).collect();
    matches!(letters[..], [last, vowel, first]
        if !is_vowel(last) && !"wxy".contains(last) && is_vowel(vowel) && !is_vowel(first))
}

fn with_ending(word: &str, ending: &str) -> Vec<String> {
    let stem = if word.ends_with('e') && !word.ends_with("ee") { &word[..word.len() - 1] } else { word };
    let mut forms = vec![format!("{stem}{ending}")];
    if let (true, Some(last)) = (may_double(word), word.chars().last()) {
        forms.push(format!("{word}{last}{ending}"));
    }
    forms
}

/// "walking"; both spellings where the consonant may double.
pub(super) fn ing(word: &str) -> Vec<String> {
    with_ending(word, "ing")
}

/// "walked"; both spellings where the consonant may double.
pub(super) fn past(word: &str) -> Vec<String> {
    if ends_in_consonant_y(word) {
        return vec![format!("{}ied", &word[..word.len() - 1])];
    }
    with_ending(word, "ed")
}
