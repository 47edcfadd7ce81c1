//! What `compose` is asked for beside seeds: compositions, scenarios of `propose-scenes`, and secrets.

use std::path::Path;

use l4d_data::composition::{self, Composition};
use l4d_data::digest::sha256;
use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name, Scale, json};
use serde::Deserialize;
use serde_json::Value;

/// Schema tag of a scenario.
const SCENARIO: &str = "l4d/scenario/1";
/// Fewest bytes of a secret that no one guesses.
const LEAST_SECRET: usize = 16;
const MOST_SECRET: u64 = 1 << 16;

/// What seeds of a private set come from.
#[derive(Clone)]
pub struct Secret(Vec<u8>);

impl std::fmt::Debug for Secret {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Secret(..)")
    }
}

impl Secret {
    /// The seed of the scene of this number: 53 bits, so that every reader of JSON keeps them.
    pub fn seed(&self, number: u64) -> u64 {
        let mut message = self.0.clone();
        message.extend(number.to_le_bytes());
        let digest = sha256(&message);
        digest.iter().take(8).fold(0, |seed, &byte| seed << 8 | u64::from(byte)) >> 11
    }
}

/// Reads a secret.
///
/// # Errors
/// A file that cannot be read, or is too short to be one.
pub fn read_secret(path: &Path) -> Result<Secret, DataError> {
    let bytes = read_bounded(path, MOST_SECRET)?;
    if bytes.len() < LEAST_SECRET {
        let message = format!("has {} bytes, but a secret has at least {LEAST_SECRET}", bytes.len());
        return Err(DataError::invalid(path, "file", message, "head -c 32 /dev/urandom > FILE"));
    }
    Ok(Secret(bytes))
}

/// What of a scenario becomes a demand; its story, looks and times are drawn.
#[derive(Debug, Deserialize)]
struct Scenario {
    name: Name,
    scale: Scale,
    groups: Vec<Group>,
    events: Vec<Event>,
}

#[derive(Debug, Deserialize)]
struct Group {
    category: String,
}

#[derive(Debug, Deserialize)]
struct Event {
    verb: String,
}

/// Reads a composition, or a scenario, which becomes one with this seed: its nouns and verbs are demanded.
///
/// # Errors
/// A file that is neither, or asks for nothing.
pub fn read(path: &Path, seed: u64) -> Result<Composition, DataError> {
    let document: Value = json::read(path)?;
    let remedy = "write a composition as `l4d compose` does, or a scenario as `l4d propose-scenes` does";
    match document.get("schema").and_then(Value::as_str) {
        Some(composition::SCHEMA) => json::read_document(path),
        Some(SCENARIO) => {
            let Scenario { name, scale, groups, events } = json::read(path)?;
            if events.is_empty() {
                return Err(DataError::invalid(path, "field `events`", "is empty", "say what happens"));
            }
            let mut composition = Composition::of(name, scale, seed);
            composition.categories = groups.into_iter().map(|group| group.category).collect();
            composition.verbs = events.into_iter().map(|event| event.verb).collect();
            for words in [&mut composition.categories, &mut composition.verbs] {
                words.sort();
                words.dedup();
            }
            Ok(composition)
        }
        found => {
            let found = found.unwrap_or("missing");
            Err(DataError::invalid(path, "field `schema`", format!("is {found}"), remedy))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_of_a_secret_fit_into_json_and_differ() {
        let secret = Secret(vec![7; 32]);
        let seeds: Vec<u64> = (0..100).map(|number| secret.seed(number)).collect();
        assert!(seeds.iter().all(|&seed| seed < 1 << 53));
        let distinct: std::collections::BTreeSet<u64> = seeds.iter().copied().collect();
        assert_eq!(distinct.len(), 100);
        assert_ne!(Secret(vec![8; 32]).seed(0), secret.seed(0));
        assert_eq!(format!("{secret:?}"), "Secret(..)");
    }

    #[test]
    fn a_scenario_becomes_demands() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("room_bakery.json");
        let text = r#"{"schema":"l4d/scenario/1","name":"room_bakery","scale":"room","story":"A baker.",
            "groups":[{"category":"bucket","members":[]}],
            "events":[{"subject":"a","verb":"lift","object":"b","frames":[1,30]},{"subject":"a","verb":"lift","object":"c","frames":[1,30]}]}"#;
        std::fs::write(&path, text).unwrap();
        let composition = read(&path, 1234).unwrap();
        assert_eq!((composition.seed, composition.categories.len(), composition.verbs.len()), (1234, 1, 1));
        std::fs::write(&path, text.replace("l4d/scenario/1", "other")).unwrap();
        let error = read(&path, 1).unwrap_err();
        assert!(error.to_string().contains("schema"), "{error}");
        std::fs::write(&path, text.split("\"events\"").next().unwrap().to_owned() + "\"events\":[]}")
            .unwrap();
        assert!(read(&path, 1).unwrap_err().to_string().contains("events"));
    }
}
