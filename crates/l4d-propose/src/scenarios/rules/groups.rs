//! Look-alikes: enough of them, and features that they share instead of one for each.

use std::collections::BTreeSet;

use super::super::Draft;
use super::super::spec::{Group, Member};
use crate::listing::excerpt;
use crate::reason::Reason;

const CODE: &str = "L4D573";
const MOST_OBJECTS: usize = 12;
const MOST_LANDMARKS: usize = 24;
const MOST_FEATURES: usize = 6;
const LONGEST_WORD: usize = 40;

pub(super) fn problems(draft: &Draft) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let mut add = |field: String, message: String, hint: &str| {
        reasons.push(Reason::new(CODE, field, message, hint));
    };
    if !draft.groups.iter().any(|group| (3..=5).contains(&group.members.len())) {
        let hint = "let at least three objects be of one category";
        add("groups".to_owned(), "no group has 3 to 5 members".to_owned(), hint);
    }
    let objects = draft.objects().count();
    if objects > MOST_OBJECTS || draft.landmarks.len() > MOST_LANDMARKS {
        let message = format!("{objects} objects and {} landmarks", draft.landmarks.len());
        add("groups".to_owned(), message, "at most 12 objects and 24 landmarks: the rest is scenery");
    }
    let mut nouns = BTreeSet::new();
    let groups = draft.groups.iter().map(|group| &group.category);
    for noun in groups {
        if !nouns.insert(noun) {
            add(excerpt(noun), "two groups have this category".to_owned(), "make one group of them");
        }
    }
    for landmark in draft.landmarks.iter().filter(|landmark| nouns.contains(&landmark.category)) {
        let message = "is a landmark of the category of a group".to_owned();
        add(excerpt(&landmark.name), message, "put it into the group, or call it something else");
    }
    let nouns = nouns.into_iter().chain(draft.landmarks.iter().map(|landmark| &landmark.category));
    for noun in nouns.filter(|noun| !is_plain(noun)) {
        add(excerpt(noun), "is no plain lower-case noun".to_owned(), "use a noun such as `cup`");
    }
    for group in &draft.groups {
        if let Some((message, hint)) = group_problem(group) {
            add(format!("group {}", excerpt(&group.category)), message, hint);
        }
    }
    reasons
}

fn group_problem(group: &Group) -> Option<(String, &'static str)> {
    let members = &group.members;
    if !(2..=5).contains(&members.len()) {
        let message = format!("has {} members", members.len());
        return Some((message, "groups have 2 to 5: a single thing is a landmark or scenery"));
    }
    let keys: BTreeSet<&String> = members.iter().flat_map(|member| member.features.keys()).collect();
    if !(1..=MOST_FEATURES).contains(&keys.len()) {
        return Some((format!("has {} features", keys.len()), "give its members 1 to 6 features"));
    }
    let words = members.iter().flat_map(|member| &member.features).flat_map(|(key, value)| [key, value]);
    if let Some(word) = words.into_iter().find(|word| !is_plain(word)) {
        return Some((format!("a feature says `{}`", excerpt(word)), "use plain lower-case words"));
    }
    for key in &keys {
        if let Some(member) = members.iter().find(|member| !member.features.contains_key(*key)) {
            let message = format!("{} has no `{key}`, but others do", excerpt(&member.name));
            return Some((message, "give every member a value of every feature"));
        }
    }
    if members.len() < 3 {
        return None;
    }
    for key in &keys {
        let partition = partition(members, key);
        let values = partition.iter().max().map_or(0, |most| most + 1);
        if values == 1 {
            return Some((format!("`{key}` is the same for all"), "leave it out, or let it vary"));
        }
        if values == members.len() {
            let message = format!("every member has a `{key}` of its own");
            return Some((message, "let two members share a value, so that it alone is ambiguous"));
        }
    }
    let partitions: BTreeSet<Vec<usize>> = keys.iter().map(|key| partition(members, key)).collect();
    if partitions.len() < 2 && !has_twins(members) {
        return Some((
            "no two features cross".to_owned(),
            "let a and b share one feature, and a and c another",
        ));
    }
    None
}

/// Which members share a value: the same number for the same value, counted from 0 in order.
fn partition(members: &[Member], key: &str) -> Vec<usize> {
    let mut seen: Vec<Option<&String>> = Vec::new();
    let number =
        |value: Option<&'_ String>, seen: &[Option<&String>]| seen.iter().position(|other| *other == value);
    members
        .iter()
        .map(|member| {
            let value = member.features.get(key);
            number(value, &seen).unwrap_or_else(|| {
                seen.push(value);
                seen.len() - 1
            })
        })
        .collect()
}

/// Whether two members look the same.
pub(super) fn has_twins(members: &[Member]) -> bool {
    members
        .iter()
        .enumerate()
        .any(|(index, one)| members[..index].iter().any(|other| other.features == one.features))
}

fn is_plain(word: &str) -> bool {
    let letter = |byte: u8| byte.is_ascii_lowercase() || b"_- ".contains(&byte);
    (1..=LONGEST_WORD).contains(&word.len()) && word.bytes().all(letter)
}
