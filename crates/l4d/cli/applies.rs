//! Which options apply to which choice of a verb: the one place that says so, and refuses the others.
//!
//! Clap says which options a verb has and what is required. That an option means nothing beside a choice (`--noise`
//! without the oracle, `--shard` of a build that renders nothing) is said here, by rule, so that nothing that is typed is
//! ignored. Folders (`--bench`, `--data`, `--work`, ...) and what only says what a dry run is about are no such options:
//! they are taken whatever is chosen.

mod rules;

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use l4d_data::StageError;

use self::rules::RULES;

/// When options apply.
#[derive(Debug)]
enum When {
    /// A choice is one of these; `stem*` and `*.end` stand for all that begin or end so. Of a choice of several, one is.
    Is(&'static str, &'static [&'static str]),
    /// Another argument is given.
    With(&'static str),
    /// Another argument is not given.
    Without(&'static str),
    /// One of these holds.
    Any(&'static [When]),
}

/// Options of verbs, and when they apply. Where several rules name an option, all of them have to hold.
#[derive(Debug)]
struct Rule {
    verbs: &'static [&'static str],
    options: &'static [&'static str],
    when: When,
}

/// Refuses an option that does not apply to what was chosen beside it.
///
/// # Errors
/// The first such option, with what it needs.
pub(super) fn check(root: &Command, matches: &ArgMatches) -> Result<(), StageError> {
    let (mut verb, mut command, mut matches) = (Vec::new(), root, matches);
    while let Some((name, below)) = matches.subcommand() {
        let Some(found) = command.find_subcommand(name) else { break };
        verb.push(name);
        (command, matches) = (found, below);
    }
    check_verb(&verb.join(" "), command, matches)
}

fn check_verb(verb: &str, command: &Command, matches: &ArgMatches) -> Result<(), StageError> {
    let rules = RULES.iter().filter(|rule| rule.verbs.contains(&verb));
    let pairs = rules.flat_map(|rule| rule.options.iter().map(move |option| (*option, &rule.when)));
    let given = Given { command, matches };
    for (option, when) in pairs {
        if given.has(option) && !given.fulfils(when) {
            let option = given.name(option);
            let message = format!("{option} does not apply {}", given.because(when));
            return Err(StageError::new(message, format!("{}, or leave out {option}", given.hint(when))));
        }
    }
    Ok(())
}

/// What was typed after a verb.
struct Given<'a> {
    command: &'a Command,
    matches: &'a ArgMatches,
}

impl Given<'_> {
    fn has(&self, id: &str) -> bool {
        self.matches.value_source(id) == Some(ValueSource::CommandLine)
    }

    /// What a choice is, by default too.
    fn values(&self, id: &str) -> Vec<String> {
        let raw = self.matches.get_raw(id).into_iter().flatten();
        // A list that clap takes apart is raw as a whole.
        let listed =
            raw.flat_map(|value| value.to_string_lossy().split(',').map(str::to_owned).collect::<Vec<_>>());
        listed.collect()
    }

    fn fulfils(&self, when: &When) -> bool {
        match when {
            When::Is(choice, patterns) => {
                self.values(choice).iter().any(|value| patterns.iter().any(|pattern| fits(value, pattern)))
            }
            When::With(other) => self.has(other),
            When::Without(other) => !self.has(other),
            When::Any(ways) => ways.iter().any(|way| self.fulfils(way)),
        }
    }

    /// `--noise`, or `the grid` of what has no dashes.
    fn name(&self, id: &str) -> String {
        let argument = self.command.get_arguments().find(|argument| argument.get_id() == id);
        argument.and_then(Arg::get_long).map_or_else(|| format!("the {id}"), |long| format!("--{long}"))
    }

    /// Why an option does not apply that needs this.
    fn because(&self, when: &When) -> String {
        match when {
            When::Is(choice, _) => match self.values(choice) {
                values if values.is_empty() => format!("without {}", self.name(choice)),
                values => format!("to {} {}", self.name(choice), values.join(",")),
            },
            When::With(other) => format!("without {}", self.name(other)),
            When::Without(other) => format!("beside {}", self.name(other)),
            When::Any(ways) => ways.first().map_or_else(String::new, |way| self.because(way)),
        }
    }

    /// What makes it apply.
    fn hint(&self, when: &When) -> String {
        match when {
            When::Is(choice, patterns) => format!("choose {} {}", self.name(choice), patterns.join(" or ")),
            When::With(other) => format!("add {}", self.name(other)),
            When::Without(other) => format!("leave out {}", self.name(other)),
            When::Any(ways) => ways.iter().map(|way| self.hint(way)).collect::<Vec<_>>().join(", or "),
        }
    }
}

fn fits(value: &str, pattern: &str) -> bool {
    match (pattern.strip_suffix('*'), pattern.strip_prefix('*')) {
        (Some(stem), _) => value.starts_with(stem),
        (_, Some(end)) => value.ends_with(end),
        _ => value == pattern,
    }
}

#[cfg(test)]
pub(super) mod tests;
