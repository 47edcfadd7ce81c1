//! The folders and the profile that a command line named, and commands in hints with the same ones: what a hint says can
//! be pasted.

use std::sync::LazyLock;

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command, CommandFactory as _};

use super::Cli;

/// What belongs to the place where somebody works, rather than to one command.
const CARRIED: [&str; 4] = ["bench", "profile", "data", "work"];
/// Who has this keeps environments under `--work`, others models: these folders need not be the same.
const KEEPS_ENVIRONMENTS: &str = "blender_scripts";

/// Made once: a report may complete the hints of thousands of findings.
static GRAMMAR: LazyLock<Command> = LazyLock::new(Cli::command);

/// Such options of a command line.
#[derive(Debug, Default)]
pub(crate) struct Given {
    options: Vec<(&'static str, String)>,
    keeps_environments: bool,
}

impl Given {
    pub(super) fn of(root: &Command, matches: &ArgMatches) -> Self {
        let (mut command, mut matches) = (root, matches);
        while let Some((name, below)) = matches.subcommand() {
            let Some(found) = command.find_subcommand(name) else { break };
            (command, matches) = (found, below);
        }
        let value = |id: &'static str| {
            let is_typed = has(command, id) && matches.value_source(id) == Some(ValueSource::CommandLine);
            let raw = is_typed.then(|| matches.get_raw(id)).flatten()?.next()?;
            Some((id, raw.to_str()?.to_owned()))
        };
        Self {
            options: CARRIED.into_iter().filter_map(value).collect(),
            keeps_environments: has(command, KEEPS_ENVIRONMENTS),
        }
    }

    /// A text in which every `l4d` command in backticks has these options too, where its verb has them.
    pub(crate) fn complete(&self, text: &str) -> String {
        if self.options.is_empty() {
            return text.to_owned();
        }
        let parts = text.split('`').enumerate().map(|(place, part)| match part.strip_prefix("l4d ") {
            Some(words) if place % 2 == 1 => format!("l4d {}", self.completed(words)),
            _ => part.to_owned(),
        });
        parts.collect::<Vec<_>>().join("`")
    }

    fn completed(&self, line: &str) -> String {
        let mut verb: &Command = &GRAMMAR;
        for word in line.split_whitespace() {
            let Some(below) = verb.find_subcommand(word) else { break };
            verb = below;
        }
        let names = |id: &str| line.split_whitespace().position(|word| word == format!("--{id}"));
        let profile = self.options.iter().find(|(id, _)| *id == "profile").map(|(_, value)| value.as_str());
        let of_profile = names("profile").and_then(|place| line.split_whitespace().nth(place + 1));
        let is_elsewhere = of_profile.is_some_and(|other| profile != Some(other));
        let mut line = line.to_owned();
        for (id, value) in &self.options {
            let fits = match *id {
                "data" => !is_elsewhere,
                "work" => has(verb, KEEPS_ENVIRONMENTS) == self.keeps_environments,
                _ => true,
            };
            if fits && has(verb, id) && !line.split_whitespace().any(|word| word == format!("--{id}")) {
                line.push_str(&format!(" --{id} {}", quoted(value)));
            }
        }
        line
    }
}

fn has(command: &Command, id: &str) -> bool {
    command.get_arguments().any(|argument: &Arg| argument.get_id() == id && argument.get_long().is_some())
}

/// A value as a shell takes it for one word.
fn quoted(value: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./:=+,@%".contains(letter);
    match !value.is_empty() && value.chars().all(is_plain) {
        true => value.to_owned(),
        false => format!("'{}'", value.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(line: &str) -> Given {
        let root = Cli::command();
        let matches = root.clone().try_get_matches_from(line.split(' ')).unwrap();
        Given::of(&root, &matches)
    }

    #[test]
    fn commands_in_hints_have_the_folders_that_were_named() {
        let solve = given("l4d solve --bench b --profile tiny --data d --work w");
        for (hint, completed) in [
            (
                "run `l4d train-splats ball --profile tiny` first, or `l4d doctor`",
                "run `l4d train-splats ball --profile tiny --bench b --data d --work w` first, or `l4d doctor`",
            ),
            // Environments are not where models are.
            ("run `l4d build-scenes`", "run `l4d build-scenes --bench b --profile tiny --data d`"),
            // The pictures of another profile are in another folder.
            ("`l4d check-scenes --profile small`", "`l4d check-scenes --profile small --bench b`"),
            ("l4d score is no command here", "l4d score is no command here"),
            ("`l4d man`, `no command`", "`l4d man`, `no command`"),
        ] {
            assert_eq!(solve.complete(hint), completed);
        }
        let spaced = Given { options: vec![("bench", "my 'bench'".to_owned())], keeps_environments: false };
        assert_eq!(spaced.complete("`l4d score`"), r"`l4d score --bench 'my '\''bench'\'''`");
        assert_eq!(given("l4d score").complete("`l4d score`"), "`l4d score`");
    }
}
