//! What a scenario must keep to before a person reads it. Geometry is not among it: a spec has none.

mod events;
mod groups;
mod names;
mod sketches;

use std::collections::BTreeSet;

use l4d_data::Benchmark;
use l4d_query::verbs::lexicon;

use super::Draft;
use crate::quote::is_hidden;
use crate::reason::Reason;

const LONGEST_TEXT: usize = 600;

/// What a new scenario must fit to.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// Names of scenes that exist.
    pub scenes: BTreeSet<String>,
    /// Verbs that l4d knows: those with a meaning for geometry, and those of the scenes that exist.
    pub verbs: BTreeSet<String>,
}

impl Known {
    /// What a benchmark has. Scenes whose tracks cannot be read lend no verbs.
    pub fn of(bench: &Benchmark) -> Self {
        let mut verbs: BTreeSet<String> = lexicon().into_iter().map(str::to_owned).collect();
        for scene in &bench.manifest.scenes {
            if let Ok(tracks) = bench.tracks(scene) {
                verbs.extend(tracks.events.into_iter().map(|event| event.verb));
            }
        }
        let scenes = bench.manifest.scenes.iter().map(ToString::to_string).collect();
        Self { scenes, verbs }
    }
}

/// Everything that is wrong with a scenario.
pub fn problems(draft: &Draft, known: &Known) -> Vec<Reason> {
    let mut reasons = text_problems(draft);
    reasons.extend(names::problems(draft, known));
    reasons.extend(groups::problems(draft));
    reasons.extend(events::problems(draft, known));
    reasons.extend(sketches::problems(draft));
    reasons
}

fn text_problems(draft: &Draft) -> Vec<Reason> {
    let environment = &draft.environment;
    let texts = [
        ("story", &draft.story),
        ("environment.place", &environment.place),
        ("environment.light", &environment.light),
        ("environment.ground", &environment.ground),
    ];
    let is_wrong = |text: &str| {
        text.trim().is_empty() || text.chars().count() > LONGEST_TEXT || text.chars().any(is_hidden)
    };
    let wrong = texts.into_iter().filter(|(_, text)| is_wrong(text));
    wrong
        .map(|(field, _)| {
            let message = format!("must be one line of 1 to {LONGEST_TEXT} letters");
            Reason::new("L4D571", field, message, "describe it in a sentence")
        })
        .collect()
}

#[cfg(test)]
mod tests;
