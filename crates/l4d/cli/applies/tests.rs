use std::collections::{BTreeMap, BTreeSet};

use clap::CommandFactory as _;

use super::*;
use crate::cli::Cli;

/// Options that mean the same whatever else is chosen, by verb. One that some choice has no use for belongs into the rules.
const ALWAYS: &[(&str, &str)] = &[
    ("quickstart", "out bench scene python blender_scripts work"),
    ("doctor", "tests json"),
    (
        "build-scenes",
        "bench profile scenes python blender_scripts work data tracks_only jobs update_benchmark",
    ),
    ("check-scenes", "bench profile scenes data json"),
    ("sheet", "bench profile data out frames force"),
    ("compose", "list python blender_scripts work json"),
    ("arrange", "out seed count view_count samples jobs python blender_scripts work json"),
    ("check-queries", "bench profile scenes against public json"),
    ("stats", "bench profile scenes out json"),
    (
        "propose-prompts",
        "bench profile scenes endpoint base_url vlm server link cache refresh max_cost max_tokens_total repeat \
         answer_tokens dry_run data out per_category frames view_count width jobs shard force json",
    ),
    (
        "propose-scenes",
        "bench endpoint base_url vlm server link cache refresh max_cost max_tokens_total repeat answer_tokens dry_run \
         out scales per_scale force json",
    ),
    ("open-round", "bench rounds pack force"),
    ("import-ballot", "rounds data"),
    ("verify-prompts", "annotator rounds data picture work"),
    ("verdict", "rounds bench check json"),
    (
        "train-splats",
        "profile bench data work out points preset gaussians sh_degree dynamic_threshold coarse unfold fine \
         views_per_iteration patience seed checkpoint_seconds adapter force json",
    ),
    (
        "render-splats",
        "profile data work splats reader sh_degree near cameras times size depth depth_format background out language \
         preview adapter force",
    ),
    ("view", "bench profile data work splats reader sh_degree near methods out force"),
    (
        "solve",
        "bench profile scenes grounder preset view_count view_seed clip_size clip_every no_consensus lift adapter data work set \
         queries name results answers jobs shard used_depth reader sh_degree near force json",
    ),
    ("query", "profile grounder data work bench"),
    (
        "serve",
        "bench profile data work splats reader sh_degree near methods grounder preset view_count view_seed clip_size \
         clip_every no_consensus lift adapter port",
    ),
    (
        "ablate",
        "bench profile scenes preset view_seed clip_size clip_every lift adapter data work out seed jobs force json",
    ),
    ("export", "format out profile data work bench json"),
    ("import-scene", "name out json"),
    (
        "import",
        "bench profile scenes name method_version results test_view used_depth template choices ignore codec frames images \
         resize claims partial force json",
    ),
    ("baseline", "bench profile scenes results force"),
    (
        "init-results",
        "bench profile results method_version link used_depth used_truth used_test_view seconds force",
    ),
    ("check-results", "bench profile scenes set max_megabytes json"),
    ("score", "bench profile scenes set protocol scores resize max_megabytes verified_only force json"),
    ("leaderboard", "bench profile scenes set out seed html with_answers force json"),
    ("bench splats", "profile data work sweeps view_count times repeats out force json"),
    ("bench lift", "profile bench data work noise view_count queries quick adapter out force json"),
    ("release", "bench check json"),
    (
        "cluster init",
        "bench profile scenes python blender_scripts work data results scores leaderboard workflow engine jobs runtime \
         install force",
    ),
    ("man", "out force"),
    ("download", "scenes splits parts data work bench verify_only json"),
    ("host codabench", "bench profile rounds out force json date until track url creators wheel"),
    ("host huggingface", "bench profile rounds out force json dataset"),
];

/// Choices that clap does not know the values of, since libraries read them.
const CHOICES: &[(&str, &str)] = &[
    ("profile", "tiny small full real"),
    (
        "format",
        "4dgaussians coco lerf-ovs ply usd-splats langsplat langsplat-masks refersplat mevis-rle davis own.toml",
    ),
    ("engine", "slurm local kubernetes"),
    ("source", "neu3d interdigital hypernerf colmap nerfstudio"),
    ("inside", "mask selected"),
    ("link", "live record:kept replay:kept"),
];

/// What may be the value of an argument; the first that its parser takes is.
const SAMPLES: [&str; 12] =
    ["x", "3", "0.5", "512", "256x192", "2/8", "x=1", "2026-01-31", "3-4", "black", "depth", "colour"];

/// A verb that has none below it, by all of its words.
pub(in crate::cli) struct Verb {
    pub(in crate::cli) name: String,
    pub(in crate::cli) command: Command,
}

pub(in crate::cli) fn verbs() -> Vec<Verb> {
    fn gather(before: &str, command: &Command, found: &mut Vec<Verb>) {
        for verb in command.get_subcommands() {
            let name = format!("{before} {}", verb.get_name()).trim().to_owned();
            match verb.has_subcommands() {
                true => gather(&name, verb, found),
                false => found.push(Verb { name, command: verb.clone() }),
            }
        }
    }
    let mut root = Cli::command();
    root.build();
    let mut found = Vec::new();
    gather("", &root, &mut found);
    found.retain(|verb| !verb.name.starts_with("help") && !verb.name.contains(" help"));
    found
}

impl Verb {
    /// What has a name and is of the verb itself.
    fn options(&self) -> impl Iterator<Item = &Arg> {
        let is_shared = |id: &str| ["help", "version", "quiet", "verbose"].contains(&id);
        self.command
            .get_arguments()
            .filter(move |argument| argument.get_long().is_some() && !is_shared(argument.get_id().as_str()))
    }

    fn argument(&self, id: &str) -> &Arg {
        let found = self.command.get_arguments().find(|argument| argument.get_id() == id);
        found.unwrap_or_else(|| panic!("{} has no argument {id}", self.name))
    }

    /// What an argument may be, more than one for a choice.
    fn values(&self, argument: &Arg) -> Vec<String> {
        if !argument.get_action().takes_values() {
            return Vec::new();
        }
        let known = argument.get_possible_values();
        if !known.is_empty() {
            return known.iter().map(|value| value.get_name().to_owned()).collect();
        }
        let id = argument.get_id().as_str();
        let listed =
            CHOICES.iter().filter(|(choice, _)| *choice == id).flat_map(|(_, values)| values.split(' '));
        let taken: Vec<String> = listed.filter(|value| takes(argument, value)).map(str::to_owned).collect();
        if !taken.is_empty() {
            return taken;
        }
        let sample = SAMPLES.into_iter().find(|value| takes(argument, value));
        vec![sample.unwrap_or_else(|| panic!("{} {id}: SAMPLES has nothing for it", self.name)).to_owned()]
    }

    /// Outcome of a line in which these arguments have these values, and those that clap demands some.
    fn outcome(&self, wanted: &BTreeMap<&str, String>) -> Outcome {
        let demanded = self.command.get_arguments().filter(|argument| argument.is_required_set());
        let mut given: BTreeMap<&str, String> =
            demanded.map(|argument| (argument.get_id().as_str(), self.first(argument))).collect();
        given.extend(wanted.iter().map(|(id, value)| (*id, value.clone())));
        // What clap wants beside a choice comes in as it says so.
        loop {
            match self.command.clone().try_get_matches_from(self.line(&given)) {
                Ok(matches) => match check_verb(&self.name, &self.command, &matches) {
                    Ok(()) => return Outcome::Taken,
                    Err(error) => return Outcome::Refused(error.to_string()),
                },
                Err(error) => {
                    let missing = error.to_string();
                    let is_missing = |argument: &&Arg| {
                        let id = argument.get_id().as_str();
                        let name = argument.get_long().map_or_else(
                            || format!("<{}>", id.to_uppercase()),
                            |long| format!("\n  --{long} "),
                        );
                        !given.contains_key(id) && missing.contains(&name)
                    };
                    let Some(lacking) = self.command.get_arguments().find(is_missing) else {
                        panic!("{} {given:?}: {error}", self.name)
                    };
                    given.insert(lacking.get_id().as_str(), self.first(lacking));
                }
            }
        }
    }

    fn first(&self, argument: &Arg) -> String {
        self.values(argument).into_iter().next().unwrap_or_default()
    }

    fn line(&self, given: &BTreeMap<&str, String>) -> Vec<String> {
        let mut line = vec![self.name.clone()];
        for argument in self.command.get_arguments() {
            let Some(value) = given.get(argument.get_id().as_str()) else { continue };
            match argument.get_long() {
                None => line.push(value.clone()),
                Some(long) if argument.get_action().takes_values() => line.push(format!("--{long}={value}")),
                Some(long) => line.push(format!("--{long}")),
            }
        }
        line
    }

    fn rules_of(&self, option: &str) -> Vec<&'static When> {
        let of_it = |rule: &&Rule| rule.verbs.contains(&&*self.name) && rule.options.contains(&option);
        RULES.iter().filter(of_it).map(|rule| &rule.when).collect()
    }
}

#[derive(Debug, PartialEq)]
enum Outcome {
    Taken,
    Refused(String),
}

fn takes(argument: &Arg, value: &str) -> bool {
    let alone =
        Command::new("one").arg(Arg::new("it").long("it").value_parser(argument.get_value_parser().clone()));
    alone.try_get_matches_from(["one", &format!("--it={value}")]).is_ok()
}

fn always(verb: &str) -> BTreeSet<&'static str> {
    let listed = ALWAYS.iter().filter(|(name, _)| *name == verb).flat_map(|(_, ids)| ids.split_whitespace());
    listed.collect()
}

fn choices_of(when: &When) -> Vec<&'static str> {
    match when {
        When::Is(choice, _) | When::With(choice) | When::Without(choice) => vec![choice],
        When::Any(ways) => ways.iter().flat_map(choices_of).collect(),
    }
}

/// An argument with which a rule holds.
fn met(when: &When, verb: &Verb) -> Option<(&'static str, String)> {
    match when {
        When::Is(choice, patterns) => {
            let values = verb.values(verb.argument(choice));
            let fitting = values.iter().find(|value| patterns.iter().any(|pattern| fits(value, pattern)));
            let fitting = fitting.unwrap_or_else(|| panic!("{} {choice}: none is {patterns:?}", verb.name));
            Some((choice, fitting.clone()))
        }
        When::With(other) => Some((other, verb.first(verb.argument(other)))),
        When::Without(_) => None,
        When::Any(ways) => ways.first().and_then(|way| met(way, verb)),
    }
}

/// Adds what the rules of the wanted arguments ask for, and the rules of those.
fn add_what_is_needed<'a>(verb: &'a Verb, wanted: &mut BTreeMap<&'a str, String>) {
    let mut before = 0;
    while before < wanted.len() {
        before = wanted.len();
        let rules: Vec<&When> = wanted.keys().flat_map(|id| verb.rules_of(id)).collect();
        for (needed, value) in rules.into_iter().filter_map(|when| met(when, verb)) {
            wanted.entry(needed).or_insert(value);
        }
    }
}

/// Whether a rule lets an option stand beside arguments that are given.
fn admits(when: &When, given: &BTreeMap<&str, String>) -> bool {
    match when {
        When::Is(choice, patterns) => {
            given.get(choice).is_some_and(|value| patterns.iter().any(|pattern| fits(value, pattern)))
        }
        When::With(other) => given.contains_key(other),
        When::Without(other) => !given.contains_key(other),
        When::Any(ways) => ways.iter().any(|way| admits(way, given)),
    }
}

#[test]
fn every_option_is_said_to_apply_always_or_by_rule() {
    let verbs = verbs();
    let known: BTreeSet<&str> = verbs.iter().map(|verb| verb.name.as_str()).collect();
    let named = RULES.iter().flat_map(|rule| rule.verbs).chain(ALWAYS.iter().map(|(verb, _)| verb));
    named.for_each(|verb| assert!(known.contains(verb), "there is no verb {verb}"));
    for verb in &verbs {
        let always = always(&verb.name);
        let here = RULES.iter().filter(|rule| rule.verbs.contains(&verb.name.as_str()));
        let ruled: BTreeSet<&str> = here.clone().flat_map(|rule| rule.options).copied().collect();
        ruled.iter().chain(&always).for_each(|id| assert!(verb.argument(id).get_long().is_some(), "{id}"));
        for choice in here.flat_map(|rule| choices_of(&rule.when)) {
            verb.argument(choice);
        }
        for option in verb.options().map(|option| option.get_id().as_str()) {
            let (is_ruled, is_always) = (ruled.contains(option), always.contains(option));
            assert!(
                is_ruled != is_always,
                "`{option}` of {}: say in applies/rules.rs which choices it applies to, or that it always does in \
                 applies/tests.rs (ruled: {is_ruled}, always: {is_always})",
                verb.name
            );
        }
    }
}

#[test]
fn every_option_beside_every_choice_is_taken_or_refused_by_name() {
    let (mut taken, mut refused) = (0, 0);
    for verb in verbs() {
        let always = always(&verb.name);
        let choices = verb.command.get_arguments().filter(|argument| verb.values(argument).len() > 1);
        let pairs =
            choices.flat_map(|choice| verb.values(choice).into_iter().map(move |value| (choice, value)));
        for (choice, value) in pairs {
            for option in verb.options().filter(|option| option.get_id() != choice.get_id()) {
                let (id, beside) = (option.get_id().as_str(), choice.get_id().as_str());
                let mut wanted = BTreeMap::from([(beside, value.clone()), (id, verb.first(option))]);
                // So that this choice alone decides.
                add_what_is_needed(&verb, &mut wanted);
                let flag = format!("--{}", option.get_long().unwrap_or_default());
                let decides = |when: &&When| choices_of(when).contains(&beside);
                let fits = verb.rules_of(id).into_iter().filter(decides).all(|when| admits(when, &wanted));
                let choice_fits = choice.get_long().is_none()
                    || verb.rules_of(beside).into_iter().all(|when| admits(when, &wanted));
                match verb.outcome(&wanted) {
                    Outcome::Taken => {
                        assert!(fits && choice_fits, "{} {wanted:?}: {flag} is ignored", verb.name);
                        taken += 1;
                    }
                    Outcome::Refused(message) => {
                        let is_named = message.contains(&format!("{flag} does not apply"));
                        let is_of_choice = message.contains(&format!("--{beside}").replace('_', "-"));
                        // What the option needs may have no use for what the choice needs.
                        let mut needed = wanted.keys().filter(|other| ![id, beside].contains(other));
                        let is_of_needed =
                            needed.any(|other| message.contains(&format!("--{other}").replace('_', "-")));
                        assert!(!always.contains(id) || is_of_choice, "{} {wanted:?}: {message}", verb.name);
                        assert!(
                            is_named || is_of_choice || is_of_needed,
                            "{} {wanted:?}: {message}",
                            verb.name
                        );
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(taken > 1000 && refused > 150, "{taken} taken, {refused} refused");
}

#[test]
fn every_rule_refuses_something_and_takes_something() {
    for verb in verbs() {
        let here = RULES.iter().filter(|rule| rule.verbs.contains(&verb.name.as_str()));
        for (rule, option) in here.flat_map(|rule| rule.options.iter().map(move |option| (rule, *option))) {
            let (flag, sample) = (verb.argument(option).get_long(), verb.first(verb.argument(option)));
            let mut wanted = BTreeMap::from([(option, sample)]);
            add_what_is_needed(&verb, &mut wanted);
            assert_eq!(verb.outcome(&wanted), Outcome::Taken, "{} {wanted:?}", verb.name);
            break_rule(&rule.when, &verb, &mut wanted);
            let Outcome::Refused(message) = verb.outcome(&wanted) else {
                panic!("{} {wanted:?}: --{flag:?} is ignored", verb.name)
            };
            assert!(message.contains("does not apply"), "{message}");
        }
    }
}

fn break_rule<'a>(when: &When, verb: &'a Verb, wanted: &mut BTreeMap<&'a str, String>) {
    match when {
        When::Is(choice, patterns) => {
            let argument = verb.argument(choice);
            let values = verb.values(argument);
            let other = values.iter().find(|value| !patterns.iter().any(|pattern| fits(value, pattern)));
            wanted.insert(choice, other.unwrap_or_else(|| panic!("{choice} is always so")).clone());
        }
        When::With(other) => drop(wanted.remove(other)),
        When::Without(other) => drop(wanted.entry(other).or_insert_with(|| verb.first(verb.argument(other)))),
        When::Any(ways) => ways.iter().for_each(|way| break_rule(way, verb, wanted)),
    }
}
