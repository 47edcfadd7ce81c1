//! `lexicon.toml`: the words of scenes, indexed by what is said and by what is read. Knows no grammar and no scene.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use serde::Deserialize;

use crate::inflect;

/// The shipped words.
static SHIPPED: LazyLock<Lexicon> = LazyLock::new(|| {
    let file: File = toml::from_str(include_str!("lexicon.toml"))
        .unwrap_or_else(|error| panic!("the lexicon that is compiled in is broken: {error}"));
    Lexicon::index(file)
});

/// The shipped words.
pub(crate) fn lexicon() -> &'static Lexicon {
    &SHIPPED
}

/// How one says that something has a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Way {
    /// Before the noun, or after "is".
    Adjective,
    /// Before the noun alone.
    Before,
    /// Instead of the noun.
    Noun,
    /// After "with" or "has".
    Has,
    Lacks,
    /// After "in" or "wearing".
    Wears,
    /// After the noun or "is".
    Is,
    /// After the noun and "of".
    Contents,
}

/// A wording of a property.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Wording {
    pub(crate) key: String,
    pub(crate) value: String,
    pub(crate) way: Way,
    /// With its article.
    pub(crate) text: String,
    /// What the noun is that it says instead.
    pub(crate) category: Option<String>,
    /// Whether it is only for people, only for others, or for all.
    pub(crate) people: Option<bool>,
    /// Whether the realiser uses it.
    pub(crate) is_said: bool,
}

#[derive(Debug, Clone)]
pub(crate) struct Noun {
    pub(crate) singular: String,
    pub(crate) plural: String,
    /// "he", "she", "they"; none of things.
    pub(crate) person: Option<String>,
    /// Moves by itself.
    pub(crate) is_alive: bool,
    /// Names several things.
    pub(crate) is_many: bool,
    pub(crate) is_mass: bool,
    /// Other names, read and never said.
    pub(crate) also: Vec<String>,
}

impl Noun {
    /// Whether "a" may go before it.
    pub(crate) fn counts(&self) -> bool {
        !self.is_many && !self.is_mass
    }
}

/// "pick up *": a verb, what goes with it, and where the object is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Pattern {
    pub(crate) head: String,
    /// Between the head and the object.
    pub(crate) before: Vec<String>,
    /// After the object.
    pub(crate) after: Vec<String>,
    pub(crate) takes_object: bool,
    /// Whether the realiser uses it.
    pub(crate) is_said: bool,
}

/// A verb of the predicate language.
#[derive(Debug, Clone)]
pub(crate) struct Verb {
    pub(crate) patterns: Vec<Pattern>,
    /// Whether the realiser says it in the passive.
    pub(crate) has_passive: bool,
    pub(crate) is_state: bool,
    /// Whether its -ing form goes before a noun.
    pub(crate) goes_before: bool,
}

impl Verb {
    /// What is said, with or without an object.
    pub(crate) fn said(&self, with_object: bool) -> impl Iterator<Item = &Pattern> {
        self.patterns.iter().filter(move |pattern| pattern.is_said && pattern.takes_object == with_object)
    }
}

/// Form of a verb.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Form {
    /// lift
    Base,
    /// lifts
    Third,
    /// lifting
    Ing,
    /// lifted: as in "it lifted"
    Past,
    /// lifted: as in "it is lifted"
    Participle,
}

impl Form {
    pub(crate) const ALL: [Self; 5] = [Self::Base, Self::Third, Self::Ing, Self::Past, Self::Participle];
}

/// A sequence of words and what it may be.
type Phrases<T> = BTreeMap<String, Vec<(Vec<String>, T)>>;

#[derive(Debug)]
pub(crate) struct Lexicon {
    nouns: BTreeMap<String, Noun>,
    verbs: BTreeMap<String, Verb>,
    wordings: Vec<Wording>,
    unsaid: Unsaid,
    irregular: BTreeMap<String, [String; 4]>,
    spelling: BTreeMap<String, String>,
    singulars: Phrases<String>,
    plurals: Phrases<String>,
    properties: BTreeMap<Way, Phrases<usize>>,
    heads: BTreeMap<(Form, String), Vec<(String, usize)>>,
}

impl Lexicon {
    /// How a category is called.
    pub(crate) fn noun(&self, category: &str) -> Option<&Noun> {
        self.nouns.get(category)
    }

    /// All categories and how they are called.
    pub(crate) fn nouns(&self) -> impl Iterator<Item = (&str, &Noun)> {
        self.nouns.iter().map(|(category, noun)| (category.as_str(), noun))
    }

    pub(crate) fn verbs(&self) -> impl Iterator<Item = (&str, &Verb)> {
        self.verbs.iter().map(|(name, verb)| (name.as_str(), verb))
    }

    /// All wordings of properties.
    pub(crate) fn all_wordings(&self) -> &[Wording] {
        &self.wordings
    }

    pub(crate) fn is_person(&self, category: &str) -> bool {
        self.noun(category).is_some_and(|noun| noun.person.is_some())
    }

    pub(crate) fn verb(&self, verb: &str) -> Option<&Verb> {
        self.verbs.get(verb)
    }

    /// Every way to say this property of such a thing, best first.
    pub(crate) fn wordings(&self, category: &str, key: &str, value: &str) -> Vec<&Wording> {
        let person = self.is_person(category);
        let fits = |wording: &&Wording| {
            (wording.key == key && wording.value == value)
                && wording.people.is_none_or(|people| people == person)
                && wording.category.as_ref().is_none_or(|noun| noun == category)
        };
        self.wordings.iter().filter(fits).collect()
    }

    /// Whether sentences never mention this, whatever it is.
    pub(crate) fn is_unsaid(&self, key: &str, value: &str) -> bool {
        self.unsaid.keys.iter().any(|unsaid| unsaid == key)
            || self.unsaid.values.iter().any(|unsaid| unsaid == value)
    }

    /// The word in this form.
    pub(crate) fn inflected(&self, base: &str, form: Form) -> String {
        let irregular = self.irregular.get(base);
        match form {
            Form::Base => base.to_owned(),
            Form::Third => irregular.map_or_else(|| inflect::third(base), |forms| forms[0].clone()),
            Form::Ing => irregular.map_or_else(|| inflect::ing(base), |forms| forms[1].clone()),
            Form::Past => irregular.map_or_else(|| inflect::past(base), |forms| forms[2].clone()),
            Form::Participle => irregular.map_or_else(|| inflect::past(base), |forms| forms[3].clone()),
        }
    }

    /// The usual spelling of a word.
    pub(crate) fn spelled<'w>(&'w self, word: &'w str) -> &'w str {
        self.spelling.get(word).map_or(word, String::as_str)
    }

    /// Categories that the words at the start may name in the singular, and how many words that takes.
    pub(crate) fn singular_at(&'static self, words: &[String]) -> Vec<(&'static str, usize)> {
        starts(&self.singulars, words).map(|(category, length)| (category.as_str(), length)).collect()
    }

    /// The same in the plural.
    pub(crate) fn plural_at(&'static self, words: &[String]) -> Vec<(&'static str, usize)> {
        starts(&self.plurals, words).map(|(category, length)| (category.as_str(), length)).collect()
    }

    /// Properties that the words at the start may say; articles are not looked at.
    pub(crate) fn properties_at(&'static self, way: Way, words: &[String]) -> Vec<(&'static Wording, usize)> {
        let Some(phrases) = self.properties.get(&way) else { return Vec::new() };
        starts(phrases, words).map(|(&index, length)| (&self.wordings[index], length)).collect()
    }

    /// Verbs and their patterns whose head is this word in this form.
    pub(crate) fn heads(&self, form: Form, word: &str) -> impl Iterator<Item = (&str, usize, &Pattern)> {
        let found = self.heads.get(&(form, word.to_owned())).map_or(&[][..], Vec::as_slice);
        found.iter().map(|(verb, index)| (verb.as_str(), *index, &self.verbs[verb].patterns[*index]))
    }

    /// Every word that is read as part of a noun, a verb or a property.
    pub(crate) fn content_words(&self) -> BTreeSet<String> {
        let mut found = self.said_words();
        let phrases = self.singulars.values().chain(self.plurals.values()).flatten().map(|(words, _)| words);
        found.extend(phrases.flatten().cloned());
        found.extend(self.wordings.iter().flat_map(|wording| tokens(&wording.text)));
        for verb in self.verbs.values() {
            for pattern in &verb.patterns {
                found.extend(Form::ALL.map(|form| self.inflected(&pattern.head, form)));
                found.extend(pattern.before.iter().chain(&pattern.after).cloned());
            }
        }
        found
    }

    /// Every word of a noun, a verb or a property that the realiser may say.
    pub(crate) fn said_words(&self) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        for noun in self.nouns.values() {
            found.extend(tokens(&noun.singular));
            found.extend(tokens(&noun.plural));
        }
        for wording in self.wordings.iter().filter(|wording| wording.is_said) {
            found.extend(tokens(&wording.text));
        }
        for verb in self.verbs.values() {
            for pattern in verb.patterns.iter().filter(|pattern| pattern.is_said) {
                found.extend(
                    [Form::Base, Form::Third, Form::Ing].map(|form| self.inflected(&pattern.head, form)),
                );
                if pattern.takes_object && verb.has_passive {
                    found.insert(self.inflected(&pattern.head, Form::Participle));
                }
                found.extend(pattern.before.iter().chain(&pattern.after).cloned());
            }
        }
        found
    }

    fn index(file: File) -> Self {
        let nouns: BTreeMap<String, Noun> = file
            .nouns
            .into_iter()
            .map(|(category, entry)| (category.clone(), entry.noun(&category)))
            .collect();
        let mut singulars = Phrases::new();
        let mut plurals = Phrases::new();
        for (category, noun) in &nouns {
            insert(&mut singulars, &noun.singular, category.clone());
            insert(&mut plurals, &noun.plural, category.clone());
            for other in &noun.also {
                insert(&mut singulars, other, category.clone());
                insert(&mut plurals, &inflect::plural(other), category.clone());
            }
        }
        let wordings = wordings(&file.attribute, &file.tables, &file.reads);
        let mut properties: BTreeMap<Way, Phrases<usize>> = BTreeMap::new();
        for (index, wording) in wordings.iter().enumerate() {
            insert(properties.entry(wording.way).or_default(), &wording.text, index);
        }
        let verbs: BTreeMap<String, Verb> =
            file.verbs.into_iter().map(|(name, entry)| (name, entry.verb())).collect();
        let mut lexicon = Self {
            nouns,
            verbs,
            wordings,
            unsaid: file.unsaid,
            irregular: file.irregular,
            spelling: file.spelling,
            singulars,
            plurals,
            properties,
            heads: BTreeMap::new(),
        };
        let mut heads: BTreeMap<(Form, String), Vec<(String, usize)>> = BTreeMap::new();
        for (name, verb) in &lexicon.verbs {
            for (index, pattern) in verb.patterns.iter().enumerate() {
                for form in Form::ALL {
                    let word = lexicon.inflected(&pattern.head, form);
                    heads.entry((form, word)).or_default().push((name.clone(), index));
                }
            }
        }
        lexicon.heads = heads;
        lexicon
    }
}

/// Lower-case words of a phrase.
pub(crate) fn tokens(text: &str) -> Vec<String> {
    l4d_query::prove::words(text)
}

pub(crate) fn is_article(word: &str) -> bool {
    matches!(word, "a" | "an" | "the" | "its" | "his" | "her" | "their")
}

fn insert<T>(phrases: &mut Phrases<T>, text: &str, meaning: T) {
    let words: Vec<String> = tokens(text).into_iter().filter(|word| !is_article(word)).collect();
    if let Some(first) = words.first() {
        phrases.entry(first.clone()).or_default().push((words, meaning));
    }
}

/// Phrases that the words start with, whatever articles are among them.
fn starts<'p, T>(phrases: &'p Phrases<T>, words: &[String]) -> impl Iterator<Item = (&'p T, usize)> {
    let articles = words.iter().take_while(|word| is_article(word)).count();
    let found = words.get(articles).and_then(|word| phrases.get(word)).map_or(&[][..], Vec::as_slice);
    found.iter().filter_map(|(phrase, meaning)| Some((meaning, match_length(phrase, words)?)))
}

fn match_length(phrase: &[String], words: &[String]) -> Option<usize> {
    let mut at = 0;
    for wanted in phrase {
        while words.get(at).is_some_and(|word| is_article(word)) {
            at += 1;
        }
        if words.get(at)? != wanted {
            return None;
        }
        at += 1;
    }
    Some(at)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    nouns: BTreeMap<String, NounEntry>,
    tables: BTreeMap<String, BTreeMap<String, Words>>,
    reads: BTreeMap<String, Words>,
    attribute: Vec<AttributeEntry>,
    unsaid: Unsaid,
    verbs: BTreeMap<String, VerbEntry>,
    irregular: BTreeMap<String, [String; 4]>,
    spelling: BTreeMap<String, String>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum Words {
    One(String),
    Several(Vec<String>),
}

impl Words {
    fn list(&self) -> &[String] {
        match self {
            Self::One(word) => std::slice::from_ref(word),
            Self::Several(words) => words,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[derive(Default)]
struct NounEntry {
    say: Option<String>,
    plural: Option<String>,
    also: Vec<String>,
    person: Option<String>,
    animal: bool,
    many: bool,
    mass: bool,
}

impl NounEntry {
    fn noun(self, category: &str) -> Noun {
        let singular = self.say.unwrap_or_else(|| category.replace('_', " "));
        let is_plain = self.many && self.plural.is_none() || self.mass;
        let plural = match self.plural {
            Some(plural) => plural,
            None if is_plain => singular.clone(),
            None => inflect::plural(&singular),
        };
        // "A row of chairs" is one.
        let is_many = self.many && plural == singular;
        let is_alive = self.animal || self.person.is_some();
        Noun { singular, plural, person: self.person, is_alive, is_many, is_mass: self.mass, also: self.also }
    }
}

#[derive(Debug, Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct AttributeEntry {
    key: String,
    people: bool,
    category: Option<String>,
    adjective: Vec<String>,
    before: Vec<String>,
    noun: Vec<String>,
    has: Vec<String>,
    lacks: Vec<String>,
    wears: Vec<String>,
    is: Vec<String>,
    contents: Vec<String>,
    table: Option<String>,
    values: BTreeMap<String, Words>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Unsaid {
    keys: Vec<String>,
    values: Vec<String>,
}

#[derive(Debug, Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct VerbEntry {
    alone: Vec<String>,
    to: Vec<String>,
    also: Vec<String>,
    passive: Option<bool>,
    state: bool,
    before: bool,
}

impl VerbEntry {
    fn verb(self) -> Verb {
        let said = self.alone.iter().chain(&self.to).map(|text| pattern(text, true));
        let read = self.also.iter().map(|text| pattern(text, false));
        Verb {
            patterns: said.chain(read).collect(),
            has_passive: self.passive.unwrap_or(true),
            is_state: self.state,
            goes_before: self.before,
        }
    }
}

fn pattern(text: &str, is_said: bool) -> Pattern {
    let mut words = text.split_whitespace().map(str::to_owned);
    let head = words.next().unwrap_or_default();
    let rest: Vec<String> = words.collect();
    let object = rest.iter().position(|word| word == "*");
    let (before, after) = match object {
        Some(at) => (rest[..at].to_vec(), rest[at + 1..].to_vec()),
        None => (rest, Vec::new()),
    };
    Pattern { head, before, after, takes_object: object.is_some(), is_said }
}

fn wordings(
    entries: &[AttributeEntry],
    tables: &BTreeMap<String, BTreeMap<String, Words>>,
    reads: &BTreeMap<String, Words>,
) -> Vec<Wording> {
    let has_own: BTreeSet<&str> =
        entries.iter().filter(|entry| entry.people).map(|entry| entry.key.as_str()).collect();
    let mut found = Vec::new();
    for entry in entries {
        let people = has_own.contains(entry.key.as_str()).then_some(entry.people);
        let ways = [
            (Way::Adjective, &entry.adjective),
            (Way::Before, &entry.before),
            (Way::Noun, &entry.noun),
            (Way::Has, &entry.has),
            (Way::Lacks, &entry.lacks),
            (Way::Wears, &entry.wears),
            (Way::Is, &entry.is),
            (Way::Contents, &entry.contents),
        ];
        let table = entry.table.as_ref().and_then(|name| tables.get(name));
        let said = entry.values.iter().chain(table.into_iter().flatten()).map(|pair| (pair, true));
        let read =
            reads.iter().filter(|_| entry.table.as_deref() == Some("colours")).map(|pair| (pair, false));
        for ((value, words), is_said) in said.chain(read) {
            for (way, templates) in ways {
                for template in templates {
                    for word in words.list() {
                        found.push(Wording {
                            key: entry.key.clone(),
                            value: value.clone(),
                            way,
                            text: template.replace("{}", word),
                            category: entry.category.clone(),
                            people,
                            is_said,
                        });
                    }
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verbs_have_forms_and_patterns() {
        let words = lexicon();
        assert_eq!(words.inflected("spin", Form::Ing), "spinning");
        let heads: Vec<&str> = words.heads(Form::Participle, "picked").map(|(verb, ..)| verb).collect();
        assert!(heads.contains(&"lift") && heads.contains(&"pick_up"));
        assert_eq!(pattern("put * down", true).after, ["down"]);
    }

    #[test]
    fn properties_are_found_whatever_the_article() {
        let words = tokens("the red ribbon and more");
        let found = lexicon().properties_at(Way::Has, &words);
        assert!(found.iter().any(|(wording, length)| wording.key == "ribbon" && *length == 3));
    }

    #[test]
    fn people_wear_their_colours() {
        let ways = |category| {
            let found = lexicon().wordings(category, "colour", "red");
            found.iter().map(|wording| wording.way).collect::<Vec<_>>()
        };
        assert_eq!(ways("child"), [Way::Wears]);
        assert_eq!(ways("cup"), [Way::Adjective]);
    }

    #[test]
    fn every_verb_that_implies_geometry_is_said() {
        let unknown: Vec<&str> =
            l4d_query::verbs::lexicon().into_iter().filter(|verb| lexicon().verb(verb).is_none()).collect();
        assert_eq!(unknown, [""; 0]);
    }
}
