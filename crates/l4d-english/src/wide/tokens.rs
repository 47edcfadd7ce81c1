//! Normalises a sentence to plain words: expands contractions, repairs misspellings, rewrites idioms, marks the ends of
//! the clip, and drops what no predicate holds (requests, adverbs). Knows no grammar.

use std::collections::BTreeSet;

use super::data::data;

/// Words of at most so many letters are not repaired.
const SHORT: usize = 2;
/// Words of at least so many letters may be repaired by two edits instead of one.
const LONG: usize = 6;
/// Most rounds of rewriting: what an idiom is rewritten to may be part of another.
const ROUNDS: usize = 4;

/// A sentence made plain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Plain {
    pub(super) words: Vec<String>,
    /// Misspelled words and what they were repaired to.
    pub(super) repairs: Vec<(String, String)>,
    /// Words that are not English and resemble no known word.
    pub(super) unknown: Vec<String>,
    /// Number of words before any was dropped, without commas.
    pub(super) length: usize,
}

/// Normalises a text. A misspelling is repaired to one of `preferred`, the words of the scene, before others.
pub(super) fn plain(text: &str, preferred: &BTreeSet<String>) -> Plain {
    let mut words = Vec::new();
    for word in spelled(text) {
        contract(&word, &mut words);
    }
    let length = words.iter().filter(|word| *word != ",").count();
    let mut repairs = Vec::new();
    let mut unknown = Vec::new();
    for word in &mut words {
        if word == ","
            || word.ends_with("ly")
            || word.contains('\'')
            || data().is_english(word)
            || word.chars().any(|letter| letter.is_ascii_digit())
        {
            continue;
        }
        match repaired(word, preferred) {
            Some(other) => {
                repairs.push((word.clone(), other.clone()));
                *word = other;
            }
            None => unknown.push(word.clone()),
        }
    }
    // Adverbs of manner: no predicate says how something is done.
    let is_adverb = |word: &String| word.len() > 4 && word.ends_with("ly") && !data().is_known(word);
    words.retain(|word| !is_adverb(word));
    Plain {
        words: without_contrast(rewritten(without_contrast(with_edges(without_ending(words))))),
        repairs,
        unknown,
        length,
    }
}

/// Lower-case words, and "," for every punctuation mark between them.
fn spelled(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut word = String::new();
    let finish = |word: &mut String, found: &mut Vec<String>| {
        let trimmed = word.trim_matches('\'').to_owned();
        word.clear();
        if !trimmed.is_empty() {
            found.push(trimmed);
        }
    };
    for letter in text.chars() {
        match letter {
            '’' | '‘' | '\'' => word.push('\''),
            letter if letter.is_alphanumeric() => word.extend(letter.to_lowercase()),
            letter => {
                finish(&mut word, &mut found);
                let is_pause = matches!(letter, ',' | ';' | ':' | '.' | '?' | '!' | '(' | ')' | '—' | '–');
                if is_pause && found.last().is_some_and(|last| last != ",") {
                    found.push(",".to_owned());
                }
            }
        }
    }
    finish(&mut word, &mut found);
    if found.last().is_some_and(|last| last == ",") {
        found.pop();
    }
    found
}

/// Expands a contraction: "doesn't" is two words, "it's" too.
fn contract(word: &str, words: &mut Vec<String>) {
    let mut push = |parts: &[&str]| words.extend(parts.iter().map(|part| (*part).to_owned()));
    match word {
        "can't" | "cannot" => return push(&["can", "not"]),
        "won't" => return push(&["will", "not"]),
        "i'm" | "im" => return push(&["i", "am"]),
        "let's" => return push(&["let", "us"]),
        "doesnt" | "isnt" | "didnt" | "wasnt" | "arent" => return push(&[&word[..word.len() - 2], "not"]),
        "thats" => return push(&["that", "is"]),
        "ain't" => return push(&["is", "not"]),
        _ => {}
    }
    for (end, full) in [("n't", "not"), ("'re", "are"), ("'ve", "have"), ("'d", "would"), ("'ll", "will")] {
        if let Some(start) = word.strip_suffix(end) {
            return push(&[start, full]);
        }
    }
    const SUBJECTS: [&str; 20] = [
        "it",
        "that",
        "who",
        "he",
        "she",
        "there",
        "what",
        "which",
        "where",
        "one",
        "here",
        "this",
        "everything",
        "nothing",
        "how",
        "else",
        "other",
        "whichever",
        "whoever",
        "all",
    ];
    match word.strip_suffix("'s") {
        Some(start) if SUBJECTS.contains(&start) => push(&[start, "is"]),
        Some(start) => push(&[start, "'s"]),
        None => push(&[word]),
    }
}

/// The known word that this one is most likely meant to be.
fn repaired(word: &str, preferred: &BTreeSet<String>) -> Option<String> {
    let letters: Vec<char> = word.chars().collect();
    if letters.len() <= SHORT {
        return None;
    }
    // "Teddys".
    let plural = word.strip_suffix("ys").map(|stem| format!("{stem}ies"));
    if let Some(plural) = plural.filter(|plural| data().is_known(plural)) {
        return Some(plural);
    }
    let max_distance = if letters.len() >= LONG { 2 } else { 1 };
    /// Edit distance, whether the scene lacks the word, whether the first letter differs, difference in length.
    type Rank = (usize, bool, bool, usize);
    let mut best: Option<(Rank, &str)> = None;
    for other in data().known() {
        let length = other.chars().count();
        if length <= SHORT || length.abs_diff(letters.len()) > max_distance {
            continue;
        }
        let others: Vec<char> = other.chars().collect();
        let distance = edit_distance(&letters, &others);
        let starts_alike = letters[0] == others[0];
        // "Teh" is "the". Any other edit of three letters reaches too many words, unless it gives a longer one of the
        // scene.
        let is_anagram = {
            let (mut a, mut b) = (letters.clone(), others.clone());
            a.sort_unstable();
            b.sort_unstable();
            a == b
        };
        if distance > max_distance
            || (letters.len() <= 3 && !is_anagram && !(preferred.contains(other) && length > letters.len()))
            || (!starts_alike && distance > 1)
        {
            continue;
        }
        let rank = (distance, !preferred.contains(other), !starts_alike, length.abs_diff(letters.len()));
        if best.is_none_or(|(best_rank, _)| rank < best_rank) {
            best = Some((rank, other));
        }
    }
    best.map(|(_, other)| other.to_owned())
}

/// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, substitutions, swaps of neighbours.
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            rows[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let substituted = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let mut least = substituted.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    least = least.min(rows[i - 2][j - 2] + 1);
                }
                least
            };
        }
    }
    rows[a.len()][b.len()]
}

/// Without preambles, with idioms and "'s" rewritten, until nothing changes.
fn rewritten(mut words: Vec<String>) -> Vec<String> {
    for _ in 0..ROUNDS {
        words = without_preamble(words);
        let mut found: Vec<String> = Vec::new();
        let mut at = 0;
        while at < words.len() {
            let next = words.get(at + 1).map_or("", String::as_str);
            // "The cook's got".
            if words[at] == "'s" && (next == "got" || next == "been") {
                found.push("has".to_owned());
                at += if next == "got" { 2 } else { 1 };
                continue;
            }
            // "A hand's writing".
            if words[at] == "'s"
                && (next.ends_with("ing")
                    || matches!(
                        next,
                        "the"
                            | "a"
                            | "not"
                            | "on"
                            | "in"
                            | "first"
                            | "last"
                            | "closest"
                            | "nearest"
                            | "farthest"
                            | "furthest"
                            | "next"
                            | "beside"
                            | "between"
                            | "behind"
                            | "never"
                            | "always"
                            | "highest"
                            | "lowest"
                            | "facing"
                            | "@first"
                            | "@last"
                    ))
            {
                found.push("is".to_owned());
                at += 1;
                continue;
            }
            // "Does the cheering".
            if matches!(words[at].as_str(), "doing" | "does")
                && (next.ends_with("ing")
                    || matches!(next, "the" | "some")
                        && words.get(at + 2).is_some_and(|word| word.ends_with("ing")))
            {
                at += 1;
                continue;
            }
            // "It's got" was expanded to "it is got".
            if words[at] == "is" && words.get(at + 1).is_some_and(|next| next == "got") {
                found.push("has".to_owned());
                at += 2;
                continue;
            }
            match data().rewrites.longest(&words[at..]) {
                (_, 0) => {
                    found.push(words[at].clone());
                    at += 1;
                }
                (to, length) => {
                    found.extend(to[0].iter().cloned());
                    at += length;
                }
            }
        }
        if found == words {
            break;
        }
        words = found;
    }
    words
}

/// With "@start" and "@end" in place of phrases for the ends of the clip ("when the recording gets going", "right at
/// the very end"), and "while" in place of those for a part of it ("during the part where").
fn with_edges(words: Vec<String>) -> Vec<String> {
    const CLIP: &str = " clip video scene film footage action recording sequence movie animation shot everything things camera all it story tape ";
    const STARTS: &str = " start starts started begin begins began beginning open opens opening opened outset going underway rolling onset kicks commences starting ";
    const ENDS: &str = " end ends ended finish finishes finished stop stops stopped close closes closing over done settles settled conclusion ending concludes finale rest wraps ";
    let is_in = |list: &str, at: usize| words.get(at).is_some_and(|word| list.contains(&format!(" {word} ")));
    let skip = |list: &str, mut at: usize| {
        while is_in(list, at) {
            at += 1;
        }
        at
    };
    let edge_at = |at: usize| {
        if is_in(STARTS, at) {
            Some("@start")
        } else if is_in(ENDS, at) {
            Some("@end")
        } else {
            None
        }
    };
    let mut found = Vec::new();
    let mut at = 0;
    while at < words.len() {
        // "During the part of the clip where", "at the times it".
        let link = skip(" but only just ", at);
        let is_bare = is_in(" the those these ", link)
            && (at == 0
                || is_in(" me see want find of ", at.wrapping_sub(1))
                || words.get(at.wrapping_sub(1)).is_some_and(|word| word == ","));
        if is_bare || is_in(" at during in for throughout over from through within ", link) {
            let noun = skip(" right just only the those these all of whole entire very that few ", link + 1);
            if is_in(
                " time times moment moments part parts stretch period bit span interval seconds frames phase section portion stage instant while point length duration window ",
                noun,
            ) {
                let mut end = noun + 1;
                if is_in(" of ", end) {
                    end = skip(" of the clip video scene film footage recording ", end);
                }
                // "At the time of its walk".
                if is_in(" of ", noun + 1) && is_in(" its her his their ", noun + 2) {
                    found.extend(["during".to_owned(), words[noun + 2].clone()]);
                    at = noun + 3;
                    continue;
                }
                let tail = skip(" when while that where in which during for ", end);
                let is_while = tail > end || !is_bare && is_in(" it she he they ", end);
                if is_while {
                    // "Show me the part where the cat walks."
                    found.push("while".to_owned());
                    at = tail;
                    continue;
                }
            }
        }
        // "Before anyone moves a thing".
        let is_any = is_in(" anyone anybody anything things ", at + 1) && !is_in(" else ", at + 2);
        if is_in(" before ", at) && is_any {
            let end = skip(
                " anyone anybody anything things moves move happens happen starts start gets get going has have a thing to or at all does do is begins begin moved happened started around budges even ",
                at + 1,
            );
            found.push("@start".to_owned());
            at = end;
            continue;
        }
        // "When the clip gets going".
        if is_in(" when as once while until till after before by ", at) {
            let start = skip(" just right the time moment point very ", at + 1);
            let thing = skip(" the this whole entire whole ", start);
            if is_in(CLIP, thing) && (thing > start || !is_in(" it all ", thing) || is_in(" all ", thing + 1))
            {
                let verb = skip(
                    " all this that has have is are s gets get comes come to a an up first just finally really 's been and coming an 'll will had ",
                    thing + 1,
                );
                if let Some(edge) = edge_at(verb) {
                    let end = skip(" up out off down moving playing happening rolling ", verb + 1);
                    found.push(edge.to_owned());
                    at = end;
                    continue;
                }
            }
        }
        // "Right at the very start of the recording".
        let link = skip(" right just only all already back even ", at);
        if is_in(" at by in from toward towards near until till to for ", link) {
            let noun = skip(" the very absolute actual its that a this total ", link + 1);
            if noun > link + 1
                && let Some(edge) = edge_at(noun).filter(|_| {
                    !is_in(" open opens close closes over done going rolling stop stops rest ", noun)
                })
            {
                let of = skip(" of ", noun + 1);
                let thing = skip(" the this all our ", of);
                let is_of_clip = of > noun + 1 && is_in(CLIP, thing);
                // "At the end of the table" is a place.
                if of == noun + 1 || is_of_clip {
                    found.push(edge.to_owned());
                    at = if is_of_clip { skip(" all ", thing + 1) } else { of };
                    continue;
                }
            }
        }
        found.push(words[at].clone());
        at += 1;
    }
    found
}

/// Without requests at the end (", which one is it"), as long as more than two words remain.
fn without_ending(mut words: Vec<String>) -> Vec<String> {
    while let Some(ending) =
        data().endings.iter().filter(|ending| words.ends_with(ending)).max_by_key(|ending| ending.len())
        && words.len() > ending.len() + 2
    {
        words.truncate(words.len() - ending.len());
    }
    words
}

/// Without a contrast with other things at the end: "rather than the green one", "since the rest are wide".
fn without_contrast(mut words: Vec<String>) -> Vec<String> {
    let at = (3..words.len()).find(|at| data().contrasts.longest(&words[*at..]).1 > 0);
    words.truncate(at.unwrap_or(words.len()));
    words
}

/// Without requests at the start: "show me", "who is".
pub(super) fn without_preamble(mut words: Vec<String>) -> Vec<String> {
    // "Not a white duck but the black one."
    if words.first().is_some_and(|word| word == "not")
        && let Some(but) = words.iter().position(|word| word == "but")
    {
        words.drain(..=but);
    }
    loop {
        // "Who is the cook that" describes the cook; "who kicks the ball" asks for anyone who does.
        if words.first().is_some_and(|word| word == "who") {
            let next = words.get(2).map_or("", String::as_str);
            if words.get(1).is_some_and(|word| word == "is")
                && matches!(next, "the" | "a" | "that" | "first" | "last")
            {
                words.drain(..2);
                continue;
            }
            words[0] = "whoever".to_owned();
        }
        let length = data().preambles.longest(&words).1;
        if length == 0 {
            let pause = usize::from(words.first().is_some_and(|word| word == ","));
            return words.split_off(pause);
        }
        words = words.split_off(length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> String {
        plain(text, &BTreeSet::new()).words.join(" ")
    }

    #[test]
    fn misspellings_are_repaired() {
        assert_eq!(words("teh baskte that waddels"), "the basket that waddles");
        assert_eq!(words("two teddys"), "two teddies");
        assert_eq!(words("the strpied ball"), "the striped ball");
        assert_eq!(plain("teh cup", &BTreeSet::new()).repairs, [("teh".to_owned(), "the".to_owned())]);
    }

    #[test]
    fn idioms_requests_and_ends_of_the_clip_are_rewritten() {
        assert_eq!(
            words("Show me the dog that's fast asleep when the clip ends, please"),
            "the dog that is sleeping @end ,"
        );
        assert_eq!(words("the ball furthest away from the gate"), "the ball farthest from the gate");
    }
}
