//! `wide.toml`, `nouns.txt` and `common.txt`: what people say besides the words of `lexicon.toml`, indexed by first word.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::sync::LazyLock;

use serde::Deserialize;

use super::{event, place, property, verb_phrase};
use crate::inflect;
use crate::lexicon::{Form, Way, is_article, lexicon};

static DATA: LazyLock<Data> = LazyLock::new(|| {
    let file: File = toml::from_str(include_str!("wide.toml"))
        .unwrap_or_else(|error| panic!("the wide lexicon that is compiled in is broken: {error}"));
    Data::index(file)
});

/// Everything that is known of everyday wordings.
pub(super) fn data() -> &'static Data {
    &DATA
}

/// Sequences of words by their first, with what they mean.
#[derive(Debug)]
pub(super) struct Phrases<T>(HashMap<String, Vec<(Vec<String>, T)>>);

impl<T> Default for Phrases<T> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<T> Phrases<T> {
    fn insert(&mut self, words: Vec<String>, meaning: T) {
        if let Some(first) = words.first() {
            self.0.entry(first.clone()).or_default().push((words, meaning));
        }
    }

    /// What the words at the start may mean, and how many words that takes.
    pub(super) fn at<'p>(&'p self, words: &[String]) -> impl Iterator<Item = (&'p T, usize)> {
        let found = words.first().and_then(|word| self.0.get(word)).map_or(&[][..], Vec::as_slice);
        found
            .iter()
            .filter(|(phrase, _)| words.starts_with(phrase))
            .map(|(phrase, meaning)| (meaning, phrase.len()))
    }

    /// The same, of the longest phrases alone.
    pub(super) fn longest<'p>(&'p self, words: &[String]) -> (Vec<&'p T>, usize) {
        let found: Vec<(&T, usize)> = self.at(words).collect();
        let length = found.iter().map(|(_, length)| *length).max().unwrap_or(0);
        (
            found.into_iter().filter(|(_, other)| *other == length).map(|(meaning, _)| meaning).collect(),
            length,
        )
    }
}

/// Categories that a word may name, with how far they are from it.
#[derive(Debug, Clone)]
pub(super) struct Naming {
    pub(super) categories: Vec<(String, u32)>,
    pub(super) is_plural: bool,
}

/// A verb phrase and the verbs that it may mean.
#[derive(Debug)]
pub(super) struct Doing {
    pub(super) before: Vec<String>,
    pub(super) after: Vec<String>,
    pub(super) takes_object: bool,
    pub(super) verbs: Vec<String>,
    /// How far it is from the usual words.
    pub(super) cost: u32,
}

/// All of it.
#[derive(Debug)]
pub(super) struct Data {
    pub(super) preambles: Phrases<()>,
    pub(super) contrasts: Phrases<()>,
    pub(super) endings: Vec<Vec<String>>,
    pub(super) background: Vec<String>,
    pub(super) rewrites: Phrases<Vec<String>>,
    pub(super) nouns: Phrases<Naming>,
    pub(super) near: BTreeMap<String, Vec<String>>,
    /// Values with how well the words say them.
    pub(super) values: Phrases<(String, u32)>,
    pub(super) parts: Phrases<Vec<String>>,
    pub(super) bare: Vec<String>,
    pub(super) worn: Vec<String>,
    pub(super) doings: Vec<Doing>,
    heads: HashMap<String, Vec<(Form, usize)>>,
    function: HashSet<String>,
    common: HashSet<&'static str>,
    known: BTreeSet<String>,
}

impl Data {
    /// Verb phrases that may begin with this word, and the form in which it is.
    pub(super) fn doings_at(&self, word: &str) -> impl Iterator<Item = (Form, &Doing)> {
        let found = self.heads.get(word).map_or(&[][..], Vec::as_slice);
        found.iter().map(|(form, index)| (*form, &self.doings[*index]))
    }

    pub(super) fn is_function(&self, word: &str) -> bool {
        self.function.contains(word) || word.starts_with('@')
    }

    /// Whether it means something here.
    pub(super) fn is_known(&self, word: &str) -> bool {
        self.known.contains(word) || self.is_function(word)
    }

    /// Whether it is an English word, and so no misspelling.
    pub(super) fn is_english(&self, word: &str) -> bool {
        let is_base = |word: &str| self.common.contains(word);
        let ends = ["s", "es", "ed", "d", "ing", "er", "ly", "est", "ness"];
        let stems = ends.iter().filter_map(|end| word.strip_suffix(end)).filter(|stem| stem.len() > 2);
        let is_inflected = |stem: &str| {
            let doubled =
                stem.len() > 3 && stem.as_bytes()[stem.len() - 1] == stem.as_bytes()[stem.len() - 2];
            is_base(stem) || is_base(&format!("{stem}e")) || doubled && is_base(&stem[..stem.len() - 1])
        };
        self.is_known(word) || is_base(word) || stems.into_iter().any(is_inflected)
    }

    pub(super) fn known(&self) -> impl Iterator<Item = &str> {
        self.known.iter().map(String::as_str)
    }

    fn index(file: File) -> Self {
        let mut data = Self {
            preambles: Phrases::default(),
            contrasts: Phrases::default(),
            endings: file.endings.iter().map(|text| split(text)).collect(),
            background: file.background,
            rewrites: Phrases::default(),
            nouns: Phrases::default(),
            near: BTreeMap::new(),
            values: Phrases::default(),
            parts: Phrases::default(),
            bare: file.bare,
            worn: file.worn,
            doings: Vec::new(),
            heads: HashMap::new(),
            function: file.function.into_iter().collect(),
            common: include_str!("common.txt").lines().collect(),
            known: GRAMMAR.split_whitespace().map(str::to_owned).collect(),
        };
        for text in file.contrasts {
            data.contrasts.insert(split(&text), ());
        }
        let phrases = [verb_phrase::PHRASES, place::PHRASES, property::PHRASES, event::PHRASES].concat();
        phrases.iter().for_each(|words| data.know(&split(&words.replace('|', " "))));
        data.index_rewrites(&file.preambles, &file.fillers, &file.rewrites);
        data.index_nouns(&file.nouns, &file.near);
        data.index_properties(&file.values, file.parts);
        data.index_verbs(file.verbs);
        data
    }

    fn know(&mut self, words: &[String]) {
        self.known.extend(
            words
                .iter()
                .filter(|word| word.chars().all(|letter| letter.is_alphabetic() || letter == '-'))
                .cloned(),
        );
    }

    fn index_rewrites(
        &mut self,
        preambles: &[String],
        fillers: &[String],
        rewrites: &BTreeMap<String, String>,
    ) {
        for text in preambles {
            self.preambles.insert(split(text), ());
        }
        let edges = clip_edges();
        let edges = edges.iter().map(|(from, to)| (from.as_str(), *to));
        let fillers = fillers.iter().map(|from| (from.as_str(), ""));
        let plain = rewrites.iter().map(|(from, to)| (from.as_str(), to.as_str()));
        for (from, to) in edges.chain(fillers).chain(plain) {
            let (from, to) = (split(from), split(to));
            self.know(&from);
            if from != to {
                self.rewrites.insert(from, to);
            }
        }
    }

    fn index_nouns(&mut self, by_hand: &BTreeMap<String, Vec<String>>, near: &[Vec<String>]) {
        let mut meaning: BTreeMap<(String, bool), BTreeMap<String, u32>> = BTreeMap::new();
        let mut add = |text: &str, plural: Option<&str>, category: &str, distance: u32| {
            let forms = [
                (text.to_owned(), false),
                (plural.map_or_else(|| inflect::plural(text), str::to_owned), true),
            ];
            for form in forms {
                let own = meaning.entry(form).or_default().entry(category.to_owned()).or_insert(distance);
                *own = (*own).min(distance);
            }
        };
        for (category, noun) in lexicon().nouns() {
            add(&noun.singular, Some(&noun.plural), category, 0);
            add(&category.replace('_', " "), None, category, 0);
            noun.also.iter().for_each(|text| add(text, None, category, 1));
        }
        for (text, categories) in by_hand {
            for (at, category) in categories.iter().enumerate() {
                add(text, None, category, if at == 0 { 1 } else { 2 });
            }
        }
        for line in include_str!("nouns.txt").lines() {
            let Some((text, categories)) = line.split_once('\t') else { continue };
            for pair in categories.split(' ') {
                let Some((category, distance)) = pair.split_once(':') else { continue };
                add(text, None, category, distance.parse().unwrap_or(9));
            }
        }
        for ((text, is_plural), categories) in meaning {
            let words = split(&text);
            self.know(&words);
            self.nouns.insert(words, Naming { categories: categories.into_iter().collect(), is_plural });
        }
        for group in near {
            for one in group {
                let others = group.iter().filter(|other| *other != one).cloned();
                self.near.entry(one.clone()).or_default().extend(others);
            }
        }
    }

    fn index_properties(
        &mut self,
        values: &BTreeMap<String, Vec<String>>,
        parts: BTreeMap<String, Vec<String>>,
    ) {
        let mut cues: BTreeMap<(String, String), u32> = BTreeMap::new();
        let mut add = |text: &str, value: &str, rank: u32| {
            let own = cues.entry((text.to_owned(), value.to_owned())).or_insert(rank);
            *own = (*own).min(rank);
        };
        for wording in lexicon().all_wordings() {
            add(&wording.value.replace('_', " "), &wording.value, 0);
            if matches!(wording.way, Way::Adjective | Way::Contents) {
                add(&wording.text, &wording.value, 0);
            }
        }
        for (value, texts) in values {
            add(&value.replace('_', " "), value, 0);
            texts.iter().enumerate().for_each(|(at, text)| add(text, value, 1 + at as u32));
        }
        for ((text, value), rank) in cues {
            let words: Vec<String> = split(&text).into_iter().filter(|word| !is_article(word)).collect();
            if !["yes", "no", "none"].contains(&text.as_str()) {
                self.know(&words);
                self.values.insert(words, (value, rank));
            }
        }
        for (text, keys) in parts {
            let words = split(&text);
            self.know(&words);
            self.parts.insert(words, keys);
        }
    }

    fn index_verbs(&mut self, by_hand: BTreeMap<String, Vec<String>>) {
        for (verb, entry) in lexicon().verbs() {
            for pattern in &entry.patterns {
                let verbs = vec![verb.to_owned()];
                let cost = if pattern.is_said { 0 } else { 2 };
                let words = (pattern.before.clone(), pattern.after.clone());
                self.index_verb(&pattern.head, words, pattern.takes_object, verbs, cost);
            }
        }
        for (text, verbs) in by_hand {
            let mut words = split(&text);
            let head = words.remove(0);
            let object = words.iter().position(|word| word == "*");
            let after = object.map(|at| words.split_off(at + 1)).unwrap_or_default();
            words.retain(|word| word != "*");
            self.index_verb(&head, (words, after), object.is_some(), verbs, 0);
        }
    }

    fn index_verb(
        &mut self,
        head: &str,
        words: (Vec<String>, Vec<String>),
        takes_object: bool,
        verbs: Vec<String>,
        cost: u32,
    ) {
        let plain =
            |words: Vec<String>| words.into_iter().filter(|word| !is_article(word)).collect::<Vec<_>>();
        let (before, after) = (plain(words.0), plain(words.1));
        self.know(&before);
        self.know(&after);
        for form in Form::ALL {
            let word = lexicon().inflected(head, form);
            self.know(std::slice::from_ref(&word));
            self.heads.entry(word).or_default().push((form, self.doings.len()));
        }
        self.doings.push(Doing { before, after, takes_object, verbs, cost });
    }
}

/// Words of the grammar that are worth repairing others into.
const GRAMMAR: &str = "the that which who whose with without from next between closest nearest farthest furthest beside behind front \
    another other others than after before while whenever never always start starts beginning begins finish finishes ends \
    first last initially finally smallest largest tallest highest lowest biggest smaller larger taller higher lower wearing dressed \
    holding touching facing being does neither whichever until during under underneath inside onto having located standing sitting lying";

/// "when the clip starts", "by the end of the video", and what each is.
fn clip_edges() -> Vec<(String, &'static str)> {
    let mut found = Vec::new();
    let things = [
        "clip",
        "video",
        "scene",
        "film",
        "footage",
        "action",
        "recording",
        "sequence",
        "movie",
        "animation",
        "shot",
    ];
    for thing in things {
        for (verbs, to) in [
            (
                &[
                    "starts",
                    "begins",
                    "opens",
                    "kicks off",
                    "starts out",
                    "starts up",
                    "began",
                    "started",
                    "opened",
                    "gets going",
                    "gets under way",
                ][..],
                "@start",
            ),
            (
                &[
                    "ends",
                    "finishes",
                    "stops",
                    "is over",
                    "closes",
                    "is done",
                    "comes to an end",
                    "has ended",
                    "runs out",
                    "ended",
                    "finished",
                    "was over",
                ],
                "@end",
            ),
        ] {
            for verb in verbs {
                for link in [
                    "when",
                    "as",
                    "once",
                    "just as",
                    "right as",
                    "right when",
                    "by the time",
                    "just when",
                    "at the moment",
                ] {
                    found.push((format!("{link} the {thing} {verb}"), to));
                }
            }
        }
        for (nouns, to) in [
            (&["start", "beginning", "opening", "outset"][..], "@start"),
            (&["end", "close", "finish", "ending", "conclusion"], "@end"),
        ] {
            for noun in nouns {
                for link in [
                    "at the",
                    "by the",
                    "in the",
                    "from the",
                    "at the very",
                    "right at the",
                    "by the very",
                    "toward the",
                    "near the",
                ] {
                    found.push((format!("{link} {noun} of the {thing}"), to));
                    for all in ["it all", "it", "everything", "all this", "things"] {
                        found.push((format!("{link} {noun} of {all}"), to));
                    }
                }
            }
        }
    }
    for link in ["in", "at", "during", "from", "by", "near", "toward", "for", "on", "within"] {
        for article in ["the", "its", "the very", "her", "his"] {
            for (adjectives, to) in [
                (&["opening", "first", "initial", "starting"][..], "@start"),
                (&["final", "last", "closing", "ending", "concluding"], "@end"),
            ] {
                for adjective in adjectives {
                    for noun in [
                        "moment", "moments", "frame", "frames", "second", "seconds", "instant", "shot",
                        "part", "position", "stage", "bit", "place",
                    ] {
                        found.push((format!("{link} {article} {adjective} {noun}"), to));
                    }
                }
            }
        }
    }
    for thing in ["everything", "it all", "it", "things", "all this"] {
        for link in ["when", "as", "once", "just as", "right when", "just when"] {
            for verb in ["begins", "starts", "began", "started", "gets going", "kicks off"] {
                found.push((format!("{link} {thing} {verb}"), "@start"));
            }
        }
    }
    found.extend(faces());
    for link in ["once", "when", "after", "by the time", "as soon as"] {
        for thing in [
            "everything",
            "it all",
            "all",
            "it",
            "things",
            "the motion",
            "the movement",
            "everyone",
            "everybody",
            "all the motion",
            "all motion",
        ] {
            for verb in [
                "has stopped",
                "has settled",
                "has finished",
                "has ended",
                "has come to rest",
                "is done",
                "have stopped",
                "have settled",
                "have finished",
                "settles",
                "settles down",
                "comes to rest",
                "has settled down",
                "is finished",
                "is stopped",
                "is settled",
                "is at rest",
                "comes to a stop",
                "comes to an end",
                "ends",
                "stops",
                "is over",
                "stops moving",
                "has stopped moving",
                "is still",
            ] {
                found.push((format!("{link} {thing} {verb}"), "@end"));
            }
        }
    }
    found
}

/// "with its nose turned towards", "has its front pointing at", "whose spout points at".
fn faces() -> Vec<(String, &'static str)> {
    let mut found = Vec::new();
    for part in [
        "front",
        "face",
        "nose",
        "spout",
        "head",
        "eyes",
        "body",
        "front end",
        "beak",
        "bonnet",
        "hood",
        "headlights",
        "bill",
        "snout",
        "muzzle",
        "front side",
    ] {
        for to in ["at", "to", "toward", "towards", "in the direction of", "on", "straight at"] {
            for verb in ["pointing", "pointed", "turned", "aimed", "directed", "facing", "looking", "fixed"] {
                for owner in ["its", "his", "her", "their"] {
                    found.push((format!("with {owner} {part} {verb} {to}"), "facing"));
                    found.push((format!("has {owner} {part} {verb} {to}"), "is facing"));
                    found.push((format!("having {owner} {part} {verb} {to}"), "facing"));
                    found.push((format!("keeps {owner} {part} {verb} {to}"), "is facing"));
                    found.push((format!("{owner} {part} is {verb} {to}"), "it is facing"));
                }
                found.push((format!("whose {part} is {verb} {to}"), "that is facing"));
                found.push((format!("whose {part} are {verb} {to}"), "that is facing"));
            }
            if to.starts_with("toward") || to == "to" {
                for owner in ["its", "his", "her", "their"] {
                    found.push((format!("with {owner} {part} {to}"), "facing"));
                    found.push((format!("has {owner} {part} {to}"), "is facing"));
                }
            }
            for verb in ["points", "faces", "looks", "point", "is"] {
                found.push((format!("whose {part} {verb} {to}"), "that is facing"));
            }
        }
        found.push((format!("whose {part} faces"), "that is facing"));
    }
    found
}

/// Lower-case words, as sentences are split too.
fn split(text: &str) -> Vec<String> {
    let hyphens_apart = text.replace('-', " ").replace("'s", " 's");
    hyphens_apart.split_whitespace().map(str::to_owned).collect()
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    preambles: Vec<String>,
    contrasts: Vec<String>,
    endings: Vec<String>,
    background: Vec<String>,
    fillers: Vec<String>,
    function: Vec<String>,
    bare: Vec<String>,
    worn: Vec<String>,
    near: Vec<Vec<String>>,
    rewrites: BTreeMap<String, String>,
    nouns: BTreeMap<String, Vec<String>>,
    values: BTreeMap<String, Vec<String>>,
    parts: BTreeMap<String, Vec<String>>,
    verbs: BTreeMap<String, Vec<String>>,
}
