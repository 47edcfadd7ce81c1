//! What is demanded of the complete set, and how far it is.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Category, Name, Query, Role, Scale, Status, Temporal};
use serde::Serialize;

use crate::ast::{Clause, Predicate};
use crate::eval::{answer_whole, clause_times};
use crate::probes::COLOURS;
use crate::prove::{SceneSet, predicate_of};
use crate::summary::SetSummary;
use crate::times::any_of;
use crate::verbs;
use crate::world::World;

/// A demand on the complete set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Rule {
    /// What is counted.
    pub name: &'static str,
    /// How many there are.
    pub found: usize,
    /// Fewest that there must be.
    pub at_least: usize,
    /// Most that there may be, if there is a bound.
    pub at_most: Option<usize>,
    /// How many more there would be if people had rejected no query.
    pub rejected: usize,
    /// What was counted, where a reader would ask: queries or scenes.
    pub which: Vec<String>,
}

impl Rule {
    /// Whether the set keeps it.
    pub fn is_met(&self) -> bool {
        self.allows(self.found)
    }

    /// Whether nothing is amiss but that people rejected queries.
    pub fn is_met_as_written(&self) -> bool {
        self.allows(self.found + self.rejected)
    }

    fn allows(&self, count: usize) -> bool {
        count >= self.at_least && self.at_most.is_none_or(|most| count <= most)
    }

    /// The demand in words: `exactly 100`, `at least 40`, `at most 6`.
    pub fn demand(&self) -> String {
        match (self.at_least, self.at_most) {
            (least, Some(most)) if least == most => format!("exactly {least}"),
            (0, Some(most)) => format!("at most {most}"),
            (least, Some(most)) => format!("{least} to {most}"),
            (least, None) => format!("at least {least}"),
        }
    }
}

/// Counts everything that is demanded of the complete set.
pub fn measure(sets: &[SceneSet], summary: &SetSummary) -> Vec<Rule> {
    let mut rules = measure_some(sets, summary, |query| query.status != Status::Rejected);
    if summary.rejected > 0 {
        let written = measure_some(sets, &SetSummary::count_as_written(sets), |_| true);
        for (rule, written) in rules.iter_mut().zip(written) {
            rule.rejected = written.found.saturating_sub(rule.found);
        }
    }
    rules
}

fn measure_some(sets: &[SceneSet], summary: &SetSummary, counts: fn(&Query) -> bool) -> Vec<Rule> {
    let rule = |name, which: Vec<String>, found, at_least, at_most| Rule {
        name,
        found,
        at_least,
        at_most,
        rejected: 0,
        which,
    };
    let exactly = |name, found, count| rule(name, Vec::new(), found, count, Some(count));
    let at_least = |name, found, count| rule(name, Vec::new(), found, count, None);
    let listed = |name, which: Vec<String>, least, most| {
        let found = which.len();
        rule(name, which, found, least, most)
    };
    let scenes = |scale: Scale| summary.scales.get(scale.as_str()).copied().unwrap_or_default();
    let queries = |category: Category| summary.queries.get(category.as_str()).copied().unwrap_or_default();
    let fewest = summary.composites.values().copied().min().unwrap_or_default();
    let with_absent = sets.iter().filter(|set| set.absents.iter().any(counts)).count();
    let scored = || {
        let all = sets.iter().flat_map(|set| set.queries.iter().map(move |query| (set, query)));
        let kept = all.filter(|(_, query)| counts(query));
        kept.filter_map(|(set, query)| Some((set, query, predicate_of(query)?)))
    };
    let of = |category: Category| scored().filter(move |(_, query, _)| query.categories == [category]);
    let worlds: BTreeMap<&Name, World<'_>> =
        sets.iter().map(|set| (&set.scene, World::new(&set.tracks))).collect();
    let events = || of(Category::Action).chain(of(Category::Interaction));
    vec![
        exactly("outdoor scenes", scenes(Scale::Outdoor), 8),
        exactly("room scenes", scenes(Scale::Room), 6),
        exactly("tabletop scenes", scenes(Scale::Tabletop), 7),
        exactly("objects", summary.instances, 108),
        exactly("attribute queries", queries(Category::Attribute), 100),
        exactly("action queries", queries(Category::Action), 61),
        exactly("spatial queries", queries(Category::Spatial), 72),
        exactly("interaction queries", queries(Category::Interaction), 56),
        at_least("composites of the rarest pair", fewest, 10),
        at_least("scenes with an absent sentence", with_absent, 21),
        listed(
            "attribute queries beyond plain colour",
            ids(&mut of(Category::Attribute)
                .filter(|(set, _, predicate)| !is_plain_colour(&worlds[&set.scene], predicate))),
            40,
            None,
        ),
        listed(
            "actions and interactions in part of the clip",
            ids(&mut events()
                .filter(|(set, query, predicate)| is_partial(&worlds[&set.scene], query, predicate))),
            60,
            None,
        ),
        listed(
            "actions that are mere states",
            ids(&mut of(Category::Action).filter(|(_, _, predicate)| is_mere_state(predicate))),
            0,
            Some(6),
        ),
        listed("scenes with twins", names(sets, has_twins), 14, None),
        listed("scenes in which a role changes hands", names(sets, has_role_change), 8, None),
    ]
}

fn ids(queries: &mut dyn Iterator<Item = (&SceneSet, &Query, Predicate)>) -> Vec<String> {
    queries.map(|(_, query, _)| query.id.to_string()).collect()
}

fn names(sets: &[SceneSet], test: fn(&SceneSet) -> bool) -> Vec<String> {
    sets.iter().filter(|set| test(set)).map(|set| set.scene.to_string()).collect()
}

/// A colour alone tells the referent, whatever else is said.
fn is_plain_colour(world: &World<'_>, predicate: &Predicate) -> bool {
    predicate.discriminating().filter(|clause| is_colour(clause)).any(|clause| {
        let noun = Clause::Category(predicate.noun().to_owned());
        answer_whole(world, &Predicate(vec![noun, clause.clone()])).len() == 1
    })
}

fn is_colour(clause: &Clause) -> bool {
    match clause {
        Clause::Attribute { key, value } => {
            key.contains("colour") || value.split(['_', '-']).all(|part| COLOURS.contains(&part))
        }
        _ => false,
    }
}

/// What it speaks of happens only in a part of the clip.
fn is_partial(world: &World<'_>, query: &Query, predicate: &Predicate) -> bool {
    if query.temporal == Temporal::While {
        return query.frames != [l4d_data::Interval::WHOLE];
    }
    let happens = |clause: &&Clause| matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. });
    let referents: Vec<_> = query.referents.iter().filter_map(|name| world.instance(name)).collect();
    predicate.discriminating().filter(|clause| !matches!(clause, Clause::Not(_))).any(|clause| {
        let inner = if happens(&clause) { std::slice::from_ref(clause) } else { clause.inner() };
        let times = |event: &Clause| any_of(referents.iter().map(|who| clause_times(world, event, who)));
        inner.iter().filter(happens).any(|event| times(event).any() && !times(event).all())
    })
}

/// All that it speaks of is standing, sitting and the like, or something that does not happen.
fn is_mere_state(predicate: &Predicate) -> bool {
    predicate.discriminating().all(|clause| match clause {
        Clause::Does { verb, .. } => verbs::is_state(verb),
        Clause::Not(_) => true,
        _ => false,
    })
}

/// Two objects of one category that look the same.
fn has_twins(set: &SceneSet) -> bool {
    let mut looks = BTreeSet::new();
    let mut objects = set.tracks.instances.iter().filter(|instance| instance.role == Role::Object);
    objects.any(|object| !looks.insert((&object.category, &object.attributes)))
}

/// Somebody stops doing (or having done to it) what another of its category begins later.
fn has_role_change(set: &SceneSet) -> bool {
    let category = |name: &Name| {
        let instance = set.tracks.instance(name);
        instance.filter(|found| found.role == Role::Object).map(|found| found.category.as_str())
    };
    let events = || set.tracks.events.iter().filter(|event| !verbs::is_state(&event.verb));
    let change = |earlier: &Name, later: &Name| {
        earlier != later && category(earlier).is_some() && category(earlier) == category(later)
    };
    events().any(|before| {
        events().filter(|after| after.verb == before.verb && after.frames.first() > before.frames.last()).any(
            |after| {
                let objects = before.object.as_ref().zip(after.object.as_ref());
                change(&before.subject, &after.subject)
                    || objects.is_some_and(|(earlier, later)| change(earlier, later))
            },
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::tests::{standing, tracks};

    fn parse(clauses: &str) -> Predicate {
        let text = format!(r#"[{{"category":"cup"}},{clauses}]"#);
        Predicate::from_json(&serde_json::from_str(&text).unwrap()).unwrap()
    }

    #[test]
    fn plain_colour_is_a_colour_that_alone_tells_the_referent() {
        let cup = |id: u32, name: &str, attributes: &str| {
            standing(id, name, "cup", [f64::from(id), 0., 0.], [0.1; 3])
                .replace(r#""colour":"grey""#, attributes)
        };
        let cups = [
            cup(1, "a", r#""glaze":"dark_red","pattern":"plain""#),
            cup(2, "b", r#""glaze":"blue","pattern":"striped""#),
            cup(3, "c", r#""glaze":"blue","pattern":"plain""#),
        ];
        let tracks = tracks(&cups, "", "");
        let world = World::new(&tracks);
        let is_plain = |clauses: &str| is_plain_colour(&world, &parse(clauses));
        let has = |key: &str, value: &str| format!(r#"{{"attribute":{{"key":"{key}","value":"{value}"}}}}"#);
        assert!(is_plain(&has("glaze", "dark_red")));
        assert!(!is_plain(&has("pattern", "striped")));
        assert!(!is_plain(r#"{"superlative":"largest"}"#));
        // Both properties are needed here; there the colour would do.
        assert!(!is_plain(&format!("{},{}", has("glaze", "blue"), has("pattern", "plain"))));
        assert!(is_plain(&format!("{},{}", has("glaze", "dark_red"), has("pattern", "plain"))));
    }

    #[test]
    fn states_are_not_actions() {
        assert!(is_mere_state(&parse(r#"{"does":{"verb":"stand"}}"#)));
        assert!(is_mere_state(&parse(r#"{"not":{"does":{"verb":"walk"}}}"#)));
        assert!(!is_mere_state(&parse(r#"{"does":{"verb":"walk"}},{"not":{"does":{"verb":"sit"}}}"#)));
        assert!(!is_mere_state(&parse(r#"{"first":{"does":{"verb":"sit"}}}"#)));
    }

    #[test]
    fn demands_in_words() {
        let rule = |at_least, at_most| Rule {
            name: "x",
            found: 6,
            at_least,
            at_most,
            rejected: 1,
            which: Vec::new(),
        };
        assert_eq!(rule(6, Some(6)).demand(), "exactly 6");
        assert_eq!(rule(0, Some(6)).demand(), "at most 6");
        assert_eq!(rule(7, None).demand(), "at least 7");
        assert!(rule(6, Some(6)).is_met() && !rule(7, None).is_met() && !rule(0, Some(5)).is_met());
        assert!(rule(7, Some(7)).is_met_as_written() && !rule(8, None).is_met_as_written());
    }
}
