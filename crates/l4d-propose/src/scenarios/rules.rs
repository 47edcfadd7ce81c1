//! What a scenario must keep to before a person reads it. Geometry is not among it: a spec has none.

use std::collections::BTreeSet;

use l4d_data::error::is_hidden;
use l4d_data::timeline::{LAST_FRAME, MIN_INTERVAL};
use l4d_data::{Category, Interval, Name, Temporal};
use l4d_query::prove::{form_problem, says_when, words};
use l4d_query::verbs::{is_moving, is_state};

use super::Known;
use super::spec::{Draft, DraftEvent, Group, Member, Sketch};
use crate::answer::Reason;
use crate::quote::excerpt;

const LONGEST_TEXT: usize = 600;
/// Words that say nothing about a thing.
const EMPTY_WORDS: [&str; 6] = ["object", "thing", "item", "instance", "entity", "scene"];
const LONGEST_WORD: usize = 40;
const MOST_OBJECTS: usize = 12;
const MOST_LANDMARKS: usize = 24;
const MOST_FEATURES: usize = 6;
const FEWEST_EVENTS: usize = 3;
/// Of events and of queries.
const MOST: usize = 60;
/// Events that last for only a part of the clip.
const FEWEST_IN_TIME: usize = 2;
/// No declared motion repeats faster: 24 frames a second could not show it.
const FASTEST_LOOP_HZ: f64 = 3.0;

/// What is wrong with one thing, and what to do about it.
type Fault = (String, &'static str);

fn fault(message: impl Into<String>, hint: &'static str) -> Option<Fault> {
    Some((message.into(), hint))
}

/// Everything that is wrong with a scenario.
pub(super) fn problems(draft: &Draft, known: &Known) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let mut add = |code: &'static str, field: &str, faults: Vec<Fault>| {
        reasons.extend(faults.into_iter().map(|(message, hint)| Reason::new(code, field, message, hint)));
    };
    let environment = &draft.environment;
    for (field, text) in [
        ("story", &draft.story),
        ("environment.place", &environment.place),
        ("environment.light", &environment.light),
        ("environment.ground", &environment.ground),
    ] {
        add("L4D571", field, text_problem(text).into_iter().collect());
    }
    add("L4D572", "name", scene_problem(draft, known).into_iter().collect());
    let mut taken = BTreeSet::new();
    let objects = draft.objects().map(|(_, member)| (&member.name, 2));
    for (name, fewest_words) in objects.chain(draft.landmarks.iter().map(|landmark| (&landmark.name, 1))) {
        let hint = "say what it is and what becomes of it, such as `cup_by_lamp`";
        let mut faults: Vec<Fault> =
            name_problem(name, fewest_words).map(|message| (message, hint)).into_iter().collect();
        if !taken.insert(name.as_str()) {
            faults.extend(fault("is the name of two things", "rename one of them"));
        }
        add("L4D572", &excerpt(name), faults);
    }
    add("L4D573", "groups", counts_of_groups(draft));
    for (noun, faults) in nouns(draft) {
        add("L4D573", &excerpt(noun), faults);
    }
    for group in &draft.groups {
        let field = format!("group {}", excerpt(&group.category));
        add("L4D573", &field, group_problem(group).into_iter().collect());
    }
    add("L4D574", "events", counts_of_events(&draft.events));
    for (index, event) in draft.events.iter().take(MOST).enumerate() {
        let mut faults = event_problems(event, &taken, known);
        faults.extend(contradiction(event, &draft.events[..index]));
        add("L4D574", &event.place(), faults);
    }
    add("L4D575", "queries", counts_of_queries(&draft.queries));
    let mut sentences = BTreeSet::new();
    for sketch in draft.queries.iter().take(MOST) {
        let mut faults: Vec<Fault> = sentence_problem(sketch).into_iter().collect();
        if !sentences.insert(words(&sketch.text)) {
            faults.extend(fault("occurs twice", "say something else"));
        }
        faults.extend(referent_problem(draft, sketch));
        add("L4D575", &format!("query \"{}\"", excerpt(&sketch.text)), faults);
    }
    reasons
}

fn text_problem(text: &str) -> Option<Fault> {
    let is_sound = (1..=LONGEST_TEXT).contains(&text.trim().chars().count()) && !text.chars().any(is_hidden);
    if is_sound {
        return None;
    }
    fault(format!("must be one line of 1 to {LONGEST_TEXT} letters"), "describe it in a sentence")
}

fn scene_problem(Draft { name, scale, .. }: &Draft, known: &Known) -> Option<Fault> {
    let scale = scale.as_str();
    if let Some(message) = name_problem(name, 2) {
        return fault(format!("`{}` {message}", excerpt(name)), "write `<scale>_<what>`");
    }
    if name.split('_').next() != Some(scale) {
        return fault(format!("`{name}` does not begin with `{scale}_`"), "write `<scale>_<what>`");
    }
    known.scenes.contains(name).then(|| (format!("`{name}` exists already"), "invent another scene"))
}

/// A name is lower-case words joined by `_`, none of them a single letter or empty of meaning.
fn name_problem(name: &str, fewest_words: usize) -> Option<String> {
    let words: Vec<&str> = name.split('_').collect();
    let is_word = |word: &&str| word.len() >= 2 && word.bytes().all(|byte| byte.is_ascii_lowercase());
    if Name::new(name).is_err() || !words.iter().all(is_word) {
        return Some("is not made of lower-case words joined by `_`".to_owned());
    }
    if words.len() < fewest_words {
        return Some(format!("has fewer than {fewest_words} words"));
    }
    let empty = words.iter().find(|word| EMPTY_WORDS.contains(word))?;
    Some(format!("says `{empty}`, which explains nothing"))
}

fn counts_of_groups(draft: &Draft) -> Vec<Fault> {
    let mut faults = Vec::new();
    if !draft.groups.iter().any(|group| (3..=5).contains(&group.members.len())) {
        faults.extend(fault("no group has 3 to 5 members", "let at least three objects be of one category"));
    }
    let (objects, landmarks) = (draft.objects().count(), draft.landmarks.len());
    if objects > MOST_OBJECTS || landmarks > MOST_LANDMARKS {
        let message = format!("{objects} objects and {landmarks} landmarks");
        faults.extend(fault(message, "at most 12 objects and 24 landmarks: the rest is scenery"));
    }
    faults
}

/// What is wrong with the categories of groups and landmarks.
fn nouns(draft: &Draft) -> Vec<(&str, Vec<Fault>)> {
    let mut of_groups = BTreeSet::new();
    let mut all = Vec::new();
    let plain = |noun: &str| {
        (!is_plain(noun)).then(|| ("is no plain lower-case noun".to_owned(), "use a noun such as `cup`"))
    };
    for Group { category, .. } in &draft.groups {
        let mut faults: Vec<Fault> = plain(category).into_iter().collect();
        if !of_groups.insert(category) {
            faults.extend(fault("two groups have this category", "make one group of them"));
        }
        all.push((category.as_str(), faults));
    }
    for landmark in &draft.landmarks {
        let mut faults: Vec<Fault> = plain(&landmark.category).into_iter().collect();
        if of_groups.contains(&landmark.category) {
            let message = "is a landmark of the category of a group";
            faults.extend(fault(message, "put it into the group, or call it something else"));
        }
        all.push((&landmark.name, faults));
    }
    all
}

/// Look-alikes: enough of them, and features that they share instead of one for each.
fn group_problem(Group { members, .. }: &Group) -> Option<Fault> {
    if !(2..=5).contains(&members.len()) {
        let message = format!("has {} members", members.len());
        return fault(message, "groups have 2 to 5: a single thing is a landmark or scenery");
    }
    let keys: BTreeSet<&String> = members.iter().flat_map(|member| member.features.keys()).collect();
    if !(1..=MOST_FEATURES).contains(&keys.len()) {
        return fault(format!("has {} features", keys.len()), "give its members 1 to 6 features");
    }
    let mut words = members.iter().flat_map(|member| &member.features).flat_map(|(key, value)| [key, value]);
    if let Some(word) = words.find(|word| !is_plain(word)) {
        return fault(format!("a feature says `{}`", excerpt(word)), "use plain lower-case words");
    }
    for key in &keys {
        if let Some(member) = members.iter().find(|member| !member.features.contains_key(*key)) {
            let message = format!("{} has no `{key}`, but others do", excerpt(&member.name));
            return fault(message, "give every member a value of every feature");
        }
    }
    if members.len() < 3 {
        return None;
    }
    let partitions: Vec<Vec<usize>> = keys.iter().map(|key| partition(members, key)).collect();
    for (key, partition) in keys.iter().zip(&partitions) {
        let values = partition.iter().collect::<BTreeSet<_>>().len();
        if values == 1 {
            return fault(format!("`{key}` is the same for all"), "leave it out, or let it vary");
        }
        if values == members.len() {
            let message = format!("every member has a `{key}` of its own");
            return fault(message, "let two members share a value, so that it alone is ambiguous");
        }
    }
    let has_twins = members
        .iter()
        .enumerate()
        .any(|(index, one)| members[..index].iter().any(|other| other.features == one.features));
    let cross = partitions.iter().collect::<BTreeSet<_>>().len() > 1;
    if cross || has_twins {
        return None;
    }
    fault("no two features cross", "let a and b share one feature, and a and c another")
}

/// Which members share a value: for each, the first one that has its value.
fn partition(members: &[Member], key: &str) -> Vec<usize> {
    let value = |member: &Member| member.features.get(key).cloned();
    let first = |member| members.iter().position(|other| value(other) == value(member)).unwrap_or(0);
    members.iter().map(first).collect()
}

fn is_plain(word: &str) -> bool {
    let letter = |byte: u8| byte.is_ascii_lowercase() || b"_- ".contains(&byte);
    (1..=LONGEST_WORD).contains(&word.len()) && word.bytes().all(letter)
}

fn counts_of_events(events: &[DraftEvent]) -> Vec<Fault> {
    let mut faults = Vec::new();
    if !(FEWEST_EVENTS..=MOST).contains(&events.len()) {
        faults.extend(fault(format!("there are {}", events.len()), "a scene has 3 to 60 events"));
    }
    let passing = events.iter().filter(|event| event.frames != Interval::WHOLE).count();
    if passing < FEWEST_IN_TIME {
        let message = format!("{passing} of them last for only a part of the clip");
        faults.extend(fault(message, "let at least two begin or end inside the clip"));
    }
    faults
}

/// What happens has known parties, a known verb, and a time that every profile can see.
fn event_problems(event: &DraftEvent, things: &BTreeSet<&str>, known: &Known) -> Vec<Fault> {
    let mut found = Vec::new();
    for name in std::iter::once(&event.subject).chain(&event.object) {
        if !things.contains(name.as_str()) {
            found.extend(fault(
                format!("`{}` is no object or landmark", excerpt(name)),
                "name what the scene has",
            ));
        }
    }
    if event.object.as_ref() == Some(&event.subject) {
        found.extend(fault("is done by something to itself", "leave the object empty"));
    }
    if !known.verbs.contains(&event.verb) {
        let hint =
            "use a known verb, or add it to crates/l4d-query/src/verbs.rs if it means something for geometry";
        found.extend(fault(format!("`{}` is not in the lexicon", excerpt(&event.verb)), hint));
    }
    let (first, last) = (event.frames.first(), event.frames.last());
    if last > LAST_FRAME || event.frames.frame_count() < MIN_INTERVAL {
        let message = format!(
            "[{first}, {last}] must lie in 0 to {LAST_FRAME} and be at least {MIN_INTERVAL} frames long"
        );
        found.extend(fault(message, "every profile must sample it"));
    }
    if !(0.0..=FASTEST_LOOP_HZ).contains(&event.loop_hz) {
        let message = format!("repeats {} times a second", event.loop_hz);
        found.extend(fault(
            message,
            "nothing repeats faster than 3 times a second; 0 is for what happens once",
        ));
    }
    found
}

/// What cannot be true together with an earlier event.
fn contradiction(event: &DraftEvent, before: &[DraftEvent]) -> Option<Fault> {
    let meets = |other: &&DraftEvent| {
        other.subject == event.subject
            && other.frames.first() <= event.frames.last()
            && event.frames.first() <= other.frames.last()
    };
    let moves = |event: &DraftEvent| is_moving(&event.verb);
    let rests = |event: &DraftEvent| is_state(&event.verb);
    before.iter().filter(meets).find_map(|other| {
        if other.verb == event.verb && other.object == event.object {
            return fault("occurs twice at the same time", "make one event of both");
        }
        let at_odds = (moves(event) && rests(other)) || (rests(event) && moves(other));
        at_odds.then(|| {
            let [one, two] = [event, other].map(|event| excerpt(&event.verb));
            (format!("cannot {one} and {two} at the same time"), "let the one begin when the other ends")
        })
    })
}

fn counts_of_queries(queries: &[Sketch]) -> Vec<Fault> {
    let asked: BTreeSet<Category> = queries.iter().map(|sketch| sketch.category).collect();
    let missing = Category::ALL.into_iter().filter(|category| !asked.contains(category));
    let mut faults: Vec<Fault> = missing
        .filter_map(|category| {
            let message = format!("none is of category {}", category.as_str());
            fault(message, "sketch at least one of each category")
        })
        .collect();
    if queries.len() > MOST {
        faults.extend(fault(format!("there are {}", queries.len()), "sketch at most 60"));
    }
    faults
}

fn sentence_problem(Sketch { text, temporal, .. }: &Sketch) -> Option<Fault> {
    if !(3..=20).contains(&words(text).len()) || text.chars().any(is_hidden) || text.len() > 500 {
        return fault("is not one line of 3 to 20 words", "write a noun phrase");
    }
    if let Some(problem) = form_problem(text.trim_end_matches('.')) {
        return fault(problem, "speak of landmarks and objects");
    }
    if *temporal == Temporal::While && !says_when(text) {
        let message = "temporal is `while`, but the sentence doesn't say when";
        return fault(message, "say when, or call it `whole`");
    }
    None
}

fn referent_problem(draft: &Draft, sketch: &Sketch) -> Option<Fault> {
    let Some((group, referent)) = draft.objects().find(|(_, member)| member.name == sketch.referent) else {
        let message = format!("`{}` is no object of a group", excerpt(&sketch.referent));
        return fault(message, "refer to an object");
    };
    let is_twin = |other: &&Member| other.name != referent.name && other.features == referent.features;
    match (sketch.category, group.members.iter().find(is_twin)) {
        (Category::Attribute, Some(twin)) => fault(
            format!("{} looks the same as {}", excerpt(&referent.name), excerpt(&twin.name)),
            "tell twins apart by what they do or where they are",
        ),
        (Category::Action, _) if !takes_part(draft, group, false) => fault(
            format!("no {} acts in any event", excerpt(&group.category)),
            "let one of the group do something",
        ),
        (Category::Interaction, _) if !takes_part(draft, group, true) => fault(
            format!("no {} takes part in an event of two", excerpt(&group.category)),
            "let one of the group do something to somebody, or undergo it",
        ),
        _ => None,
    }
}

/// Whether one of the group acts, or has a part in an event of two roles.
fn takes_part(draft: &Draft, group: &Group, of_two: bool) -> bool {
    let is_member = |name: &String| group.members.iter().any(|member| member.name == *name);
    draft.events.iter().any(|event| match (&event.object, of_two) {
        (Some(object), true) => is_member(&event.subject) || is_member(object),
        (None, true) => false,
        (_, false) => is_member(&event.subject),
    })
}

#[cfg(test)]
mod tests;
