//! The words that the parser knows, and what perception may expect of them: `lexicon.toml`, indexed by surface form.
//!
//! Knows no grammar and guesses nothing: a word that isn't here is unknown.

mod inflect;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use l4d_data::digest::sha256_hex;
use serde::Deserialize;

use self::inflect::{ing, past, plural, third};

/// The shipped words.
static SHIPPED: LazyLock<Result<Lexicon, toml::de::Error>> =
    LazyLock::new(|| toml::from_str(SHIPPED_TEXT).map(Lexicon::index));

const SHIPPED_TEXT: &str = include_str!("lexicon.toml");

/// A kind of thing.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Noun {
    /// Longest side of such a thing: from, to; metres.
    pub(crate) size: [f64; 2],
    /// Its height as it usually stands: from, to; metres.
    pub(crate) tall: [f64; 2],
    /// Whether it moves by itself.
    #[serde(default)]
    pub(crate) live: bool,
    #[serde(default)]
    words: Vec<String>,
    plural: Option<String>,
}

/// What something done looks like from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Motion {
    /// Goes somewhere.
    Travel,
    /// Goes somewhere fast.
    Dash,
    /// Up and down again.
    Hop,
    /// Upwards.
    Rise,
    /// Downwards.
    Sink,
    /// Turns in its place.
    Turn,
    /// Parts of it move, the whole stays.
    Stir,
    /// Any motion.
    Move,
    /// None.
    Still,
    /// In contact all the time.
    Holding,
    /// In contact, and both go along.
    Carrying,
    /// In contact, and the other rises.
    Lifting,
    /// In contact, and the other sinks.
    Lowering,
    /// In contact at some time.
    Touching,
    /// Above it and close.
    Pouring,
    /// Goes the same way behind it.
    Following,
    /// Comes closer.
    Approaching,
    /// Sees it: nothing that geometry shows but where it faces.
    Watching,
}

impl Motion {
    /// Whether it takes two.
    pub(crate) fn is_mutual(self) -> bool {
        self >= Self::Holding
    }
}

/// Something that is done.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Verb {
    /// Base form as predicates spell it.
    pub(crate) name: String,
    /// What it looks like.
    pub(crate) motion: Motion,
}

/// Form of a verb.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Form {
    /// walk, walks
    Finite,
    /// walking
    Ing,
    /// walked, held, taken
    Past,
}

/// A reading of a word as the head of a verb.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VerbReading {
    /// Index into [`Lexicon::verb`].
    pub(crate) verb: usize,
    /// Particles that must follow, at once or after the object.
    pub(crate) particles: Vec<String>,
    /// Form of the head.
    pub(crate) form: Form,
}

/// What pictures show of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Look {
    /// Colour.
    Colour,
    /// How much the colour varies.
    Pattern,
    /// Colour and its variation.
    Material,
    /// Proportions of the box.
    Shape,
    /// Size among its like.
    Size,
    /// Nothing that is measured here.
    None,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    nouns: BTreeMap<String, Noun>,
    materials: Words,
    grammar: Words,
    verbs: BTreeMap<String, VerbEntry>,
    attributes: BTreeMap<String, AttributeEntry>,
    parts: BTreeMap<String, Vec<String>>,
    colours: BTreeMap<String, Vec<[u8; 3]>>,
    colour_words: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
struct Words {
    words: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct VerbEntry {
    motion: Motion,
    words: Vec<String>,
    #[serde(default)]
    irregular: Vec<String>,
    name: Option<String>,
}

#[derive(Debug, Deserialize)]
struct AttributeEntry {
    look: Look,
    #[serde(flatten)]
    values: BTreeMap<String, Vec<String>>,
}

/// All words, by surface form.
#[derive(Debug)]
pub(crate) struct Lexicon {
    nouns: BTreeMap<String, Noun>,
    noun_forms: BTreeMap<String, (String, bool)>,
    verbs: Vec<Verb>,
    verb_heads: BTreeMap<String, Vec<VerbReading>>,
    attributes: BTreeMap<String, (String, String)>,
    looks: BTreeMap<String, Look>,
    parts: BTreeMap<String, String>,
    materials: Vec<String>,
    grammar: BTreeSet<String>,
    colours: BTreeMap<String, Vec<[u8; 3]>>,
    colour_words: BTreeMap<String, String>,
}

impl Lexicon {
    /// The words that come with the crate; the text of the mistake where the file is damaged.
    pub(crate) fn shipped() -> Result<&'static Self, String> {
        SHIPPED.as_ref().map_err(ToString::to_string)
    }

    /// SHA-256 of the words that come with the crate.
    pub(crate) fn shipped_digest() -> String {
        sha256_hex(SHIPPED_TEXT.as_bytes())
    }

    fn index(file: File) -> Self {
        let mut lexicon = Self {
            noun_forms: BTreeMap::new(),
            verbs: Vec::new(),
            verb_heads: BTreeMap::new(),
            attributes: BTreeMap::new(),
            looks: BTreeMap::new(),
            parts: BTreeMap::new(),
            materials: file.materials.words,
            grammar: file.grammar.words.into_iter().collect(),
            colours: file.colours,
            colour_words: file.colour_words,
            nouns: BTreeMap::new(),
        };
        for (name, noun) in &file.nouns {
            let spellings = std::iter::once(name.replace('_', " ")).chain(noun.words.iter().cloned());
            for spelling in spellings {
                let plural = plural(&spelling);
                lexicon.noun_forms.entry(plural).or_insert((name.clone(), true));
                lexicon.noun_forms.insert(spelling, (name.clone(), false));
            }
            if let Some(plural) = &noun.plural {
                lexicon.noun_forms.insert(plural.clone(), (name.clone(), true));
            }
        }
        lexicon.nouns = file.nouns;
        for (key, entry) in file.verbs {
            lexicon.add_verb(key, entry);
        }
        for (key, entry) in file.attributes {
            for (value, words) in entry.values {
                for word in words {
                    lexicon.attributes.insert(word, (key.clone(), value.clone()));
                }
            }
            lexicon.looks.insert(key, entry.look);
        }
        for (group, words) in file.parts {
            for word in words {
                lexicon.parts.insert(word, group.clone());
            }
        }
        lexicon
    }

    fn add_verb(&mut self, key: String, entry: VerbEntry) {
        let verb = self.verbs.len();
        let name = entry.name.unwrap_or(key);
        self.verbs.push(Verb { name, motion: entry.motion });
        for phrase in &entry.words {
            let mut words = phrase.split(' ').map(str::to_owned);
            let Some(head) = words.next() else { continue };
            let particles: Vec<String> = words.collect();
            let irregular = entry.irregular.iter().filter_map(|line| line.split_once(' '));
            let irregular: Vec<&str> =
                irregular.filter(|(_, base)| *base == head).map(|(form, _)| form).collect();
            let mut forms = vec![(head.clone(), Form::Finite), (third(&head), Form::Finite)];
            forms.extend(ing(&head).into_iter().map(|form| (form, Form::Ing)));
            for form in &irregular {
                let kind = if form.ends_with("ing") { Form::Ing } else { Form::Past };
                forms.push(((*form).to_owned(), kind));
            }
            if !irregular.iter().any(|form| !form.ends_with("ing")) {
                forms.extend(past(&head).into_iter().map(|form| (form, Form::Past)));
            }
            for (surface, form) in forms {
                let reading = VerbReading { verb, particles: particles.clone(), form };
                self.verb_heads.entry(surface).or_default().push(reading);
            }
        }
    }

    /// The noun that stands at the beginning of `words`, as its name, whether it is a plural, and its length in words.
    pub(crate) fn noun_at(&self, words: &[String]) -> Option<(&str, bool, usize)> {
        (1..=words.len().min(4)).rev().find_map(|length| {
            let (name, is_plural) = self.noun_forms.get(&words[..length].join(" "))?;
            Some((name.as_str(), *is_plural, length))
        })
    }

    /// What is known of a kind of thing.
    pub(crate) fn noun(&self, name: &str) -> Option<&Noun> {
        self.nouns.get(name)
    }

    /// How many kinds of things are known.
    pub(crate) fn kind_count(&self) -> usize {
        self.nouns.len()
    }

    /// How many verbs are known; "move" and "move something" are two.
    pub(crate) fn verb_count(&self) -> usize {
        self.verbs.len()
    }

    /// Readings of a word as a verb.
    pub(crate) fn verbs_at(&self, word: &str) -> &[VerbReading] {
        self.verb_heads.get(word).map_or(&[], Vec::as_slice)
    }

    /// A verb of a reading.
    pub(crate) fn verb(&self, index: usize) -> Option<&Verb> {
        self.verbs.get(index)
    }

    /// What a verb of a predicate looks like; `mutual` tells "move" from "move something".
    pub(crate) fn motion(&self, name: &str, mutual: bool) -> Option<Motion> {
        let named = self.verbs.iter().filter(|verb| verb.name == name);
        named.map(|verb| verb.motion).find(|motion| motion.is_mutual() == mutual)
    }

    /// Property and value that an adjective means.
    pub(crate) fn attribute(&self, word: &str) -> Option<(&str, &str)> {
        self.attributes.get(word).map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// What can be seen of a property.
    pub(crate) fn look(&self, key: &str) -> Look {
        self.looks.get(key).copied().unwrap_or(Look::None)
    }

    /// The group of a word for a part of something, or for something worn.
    pub(crate) fn part(&self, word: &str) -> Option<&str> {
        self.parts.get(word).map(String::as_str).filter(|group| *group != "qualities")
    }

    /// Whether it is an adjective that is said of parts alone.
    pub(crate) fn is_quality(&self, word: &str) -> bool {
        self.parts.get(word).is_some_and(|group| group == "qualities")
            || matches!(word, "long" | "short" | "tall" | "round" | "wide" | "open" | "low" | "high")
    }

    /// Whether it is a word of the grammar itself.
    pub(crate) fn is_grammar(&self, word: &str) -> bool {
        self.grammar.contains(word)
    }

    /// Whether it is something that flows or fills.
    pub(crate) fn is_material(&self, word: &str) -> bool {
        self.materials.iter().any(|material| material == word)
    }

    /// Name of a colour: "grey" of "gray", "cream" of "cream-coloured".
    pub(crate) fn colour(&self, word: &str) -> Option<&str> {
        let word = word.trim_end_matches("-coloured").trim_end_matches("-colored").replace('-', "_");
        let name = self.colour_words.get(&word).unwrap_or(&word);
        self.colours.get_key_value(name).map(|(name, _)| name.as_str())
    }

    /// Typical specimens of a colour, sRGB.
    pub(crate) fn specimens(&self, colour: &str) -> &[[u8; 3]] {
        self.colours.get(colour).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_words_are_sound() {
        let lexicon = Lexicon::shipped().unwrap();
        for (name, noun) in &lexicon.nouns {
            assert!(noun.size[0] < noun.size[1] && noun.tall[0] < noun.tall[1], "{name}");
            assert!(noun.tall[1] <= noun.size[1] * 1.01, "{name} is taller than it is long");
        }
        for (alias, name) in &lexicon.colour_words {
            assert!(lexicon.colours.contains_key(name), "{alias} means {name}, which is no colour");
        }
    }

    #[test]
    fn words_inflect() {
        let lexicon = Lexicon::shipped().unwrap();
        let has = |surface: &str, name: &str, form: Form| {
            let readings = lexicon.verbs_at(surface).iter();
            readings.clone().any(|reading| lexicon.verbs[reading.verb].name == name && reading.form == form)
        };
        assert!(has("carries", "carry", Form::Finite) && has("carried", "carry", Form::Past));
        assert!(has("patting", "pet", Form::Ing) && has("stroking", "pet", Form::Ing));
        assert!(has("held", "hold", Form::Past) && has("lying", "lie", Form::Ing));
        assert!(has("running", "run", Form::Ing) && has("catches", "catch", Form::Finite));
        assert!(!has("holded", "hold", Form::Past));
        assert_eq!(lexicon.noun_at(&["toy", "cars", "roll"].map(str::to_owned)), Some(("toy_car", true, 2)));
        assert_eq!(lexicon.noun_at(&["teddies".to_owned()]), Some(("teddy", true, 1)));
        assert_eq!(lexicon.colour("cream-coloured"), Some("cream"));
        assert_eq!(lexicon.motion("move", true), Some(Motion::Carrying));
        assert_eq!(lexicon.motion("move", false), Some(Motion::Move));
    }
}
