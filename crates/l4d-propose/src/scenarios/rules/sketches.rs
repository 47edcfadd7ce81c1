//! Queries in outline: the sentences of a scenario must be worth asking, as far as a spec can show it.

use std::collections::BTreeSet;

use l4d_data::{Category, Temporal};
use l4d_query::prove::{form_problem, says_when, words};

use super::super::Draft;
use super::super::spec::{Group, Sketch};
use crate::listing::excerpt;
use crate::quote::is_hidden;
use crate::reason::Reason;

const CODE: &str = "L4D575";
const MOST: usize = 60;
const WORDS: std::ops::RangeInclusive<usize> = 3..=20;

pub(super) fn problems(draft: &Draft) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let asked: BTreeSet<Category> = draft.queries.iter().map(|sketch| sketch.category).collect();
    for category in Category::ALL.into_iter().filter(|category| !asked.contains(category)) {
        let message = format!("none is of category {}", category.as_str());
        reasons.push(Reason::new(CODE, "queries", message, "sketch at least one of each category"));
    }
    if draft.queries.len() > MOST {
        let message = format!("there are {}", draft.queries.len());
        reasons.push(Reason::new(CODE, "queries", message, "sketch at most 60"));
    }
    let mut sentences = BTreeSet::new();
    for sketch in draft.queries.iter().take(MOST) {
        let place = format!("query \"{}\"", excerpt(&sketch.text));
        let mut found: Vec<(String, &str)> = text_problem(sketch).into_iter().collect();
        if !sentences.insert(words(&sketch.text)) {
            found.push(("occurs twice".to_owned(), "say something else"));
        }
        found.extend(referent_problem(draft, sketch));
        reasons
            .extend(found.into_iter().map(|(message, hint)| Reason::new(CODE, place.clone(), message, hint)));
    }
    reasons
}

fn text_problem(sketch: &Sketch) -> Option<(String, &'static str)> {
    let text = &sketch.text;
    if !WORDS.contains(&words(text).len()) || text.chars().any(is_hidden) || text.len() > 500 {
        return Some(("is not one line of 3 to 20 words".to_owned(), "write a noun phrase"));
    }
    if let Some(problem) = form_problem(text.trim_end_matches('.')) {
        return Some((problem, "speak of landmarks and objects"));
    }
    (sketch.temporal == Temporal::While && !says_when(text)).then(|| {
        let message = "temporal is `while`, but the sentence doesn't say when".to_owned();
        (message, "say when, or call it `whole`")
    })
}

fn referent_problem(draft: &Draft, sketch: &Sketch) -> Option<(String, &'static str)> {
    let found = draft.objects().find(|(_, member)| member.name == sketch.referent);
    let Some((group, referent)) = found else {
        return Some((
            format!("`{}` is no object of a group", excerpt(&sketch.referent)),
            "refer to an object",
        ));
    };
    let twin =
        group.members.iter().find(|other| other.name != referent.name && other.features == referent.features);
    match (sketch.category, twin) {
        (Category::Attribute, Some(twin)) => {
            let message = format!("{} looks the same as {}", excerpt(&referent.name), excerpt(&twin.name));
            Some((message, "tell twins apart by what they do or where they are"))
        }
        (Category::Action, _) if !takes_part(draft, group, false) => {
            let message = format!("no {} acts in any event", excerpt(&group.category));
            Some((message, "let one of the group do something"))
        }
        (Category::Interaction, _) if !takes_part(draft, group, true) => {
            let message = format!("no {} takes part in an event of two", excerpt(&group.category));
            Some((message, "let one of the group do something to somebody, or undergo it"))
        }
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
