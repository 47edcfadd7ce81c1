//! `l4d.toml` in the working folder: folders and profile that a project always means, in place of the built-in defaults.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use clap::Command;
use l4d_data::name::choose_among;
use l4d_data::{DataError, toml_file};

const FILE: &str = "l4d.toml";
/// Options that a project may have a default of its own for.
const KNOWN: [&str; 9] =
    ["bench", "profile", "data", "work", "results", "scores", "rounds", "python", "blender-scripts"];

/// The grammar with the defaults of the working folder, if it has any.
///
/// # Errors
/// A file that is no table of known options and texts.
pub(super) fn with_defaults(root: Command) -> Result<Command> {
    let path = Path::new(FILE);
    if !path.is_file() {
        return Ok(root);
    }
    let hint = "write lines like `profile = \"tiny\"`; docs/formats.md has the options";
    let defaults: BTreeMap<String, String> = toml_file::read(path, hint)?;
    if let Some(unknown) = defaults.keys().find(|key| !KNOWN.contains(&key.as_str())) {
        let message = "is no option that has a default here";
        return Err(
            DataError::invalid(path, format!("`{unknown}`"), message, choose_among(unknown, &KNOWN)).into()
        );
    }
    Ok(defaults.iter().fold(root, |root, (name, value)| set(root, name, value)))
}

/// Every verb that has the option, the verbs below it included.
fn set(command: Command, name: &str, value: &str) -> Command {
    let id = name.replace('-', "_");
    let has = command.get_arguments().any(|argument| argument.get_id() == id.as_str());
    let command = match has {
        true => command.mut_arg(&id, |argument| argument.default_value(value.to_owned())),
        false => command,
    };
    command.mut_subcommands(|verb| set(verb, name, value))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::Cli;

    #[test]
    fn known_options_are_options() {
        for name in KNOWN {
            let id = name.replace('-', "_");
            let has = |verb: &Command| verb.get_arguments().any(|argument| argument.get_id() == id.as_str());
            assert!(Cli::command().get_subcommands().any(has), "{name}");
        }
    }

    #[test]
    fn a_default_holds_unless_the_option_is_given() {
        let root = set(Cli::command(), "profile", "tiny");
        let profile = |line: &[&str]| {
            let matches = root.clone().try_get_matches_from(line).unwrap();
            let (_, verb) = matches.subcommand().unwrap();
            verb.get_raw("profile").unwrap().next().unwrap().to_str().unwrap().to_owned()
        };
        assert_eq!(profile(&["l4d", "solve"]), "tiny");
        assert_eq!(profile(&["l4d", "solve", "--profile", "full"]), "full");
    }
}
