//! What `compose` is asked for: which seeds a split has, what compositions, scenarios of `propose-scenes` and secrets say.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use l4d_data::benchmark::SetSplit;
use l4d_data::composition::{self, Composition, MOST_SEED};
use l4d_data::digest::{sha256, sha256_hex};
use l4d_data::layout::BenchDir;
use l4d_data::store::read_bounded;
use l4d_data::{Benchmark, DataError, Name, Scale, StageError, json};
use serde::Deserialize;
use serde_json::Value;

/// Schema tag of a scenario.
const SCENARIO: &str = "l4d/scenario/1";
/// Seeds below are those of development sets.
pub const FIRST_TRAINING_SEED: u64 = 1000;
/// Fewest bytes of a secret that no one guesses, and how many of them differ at least: of 16 random ones nearly always
/// 14 and more.
const LEAST_SECRET: usize = 16;
const LEAST_DISTINCT: usize = 8;
const MOST_SECRET: u64 = 1 << 16;

/// What is composed.
#[derive(Debug)]
pub struct Ask<'a> {
    /// What the set may be used for.
    pub split: SetSplit,
    /// Seed of the first scene; of a private set its number.
    pub first: u64,
    /// How many scenes, where no file says it.
    pub count: u32,
    /// Of all scenes; in turn where there is none.
    pub scale: Option<Scale>,
    /// A scene each.
    pub specs: &'a [PathBuf],
    /// Of a private set.
    pub secret: Option<&'a Secret>,
}

impl Ask<'_> {
    /// A composition for each scene, each of the next seed of the split.
    ///
    /// # Errors
    /// Seeds of another split, a file that is no demand, or one of a set of another split.
    pub fn wishes(&self) -> Result<Vec<Composition>, StageError> {
        let count = if self.specs.is_empty() { u64::from(self.count) } else { self.specs.len() as u64 };
        self.check_seeds(count)?;
        let mut wishes = Vec::new();
        for (place, number) in (self.first..self.first + count).enumerate() {
            let seed = self.secret.map_or(number, |secret| secret.seed(number));
            let drawn = || self.scale.unwrap_or(Scale::ALL[(number % 3) as usize]);
            let spec = match self.specs.get(place) {
                Some(path) => read(path, self.split)?,
                None => Spec::of(drawn()),
            };
            let mark = if self.secret.is_some() { "p" } else { "" };
            let by_number = || Name::new(format!("{}_{mark}{number:04}", spec.scale.as_str()));
            let scene = spec.name.clone().map_or_else(by_number, Ok)?;
            wishes.push(Composition {
                place: spec.place,
                theme: spec.theme,
                categories: spec.categories,
                verbs: spec.verbs,
                ..Composition::of(scene, spec.scale, seed)
            });
        }
        let mut scenes = BTreeSet::new();
        match wishes.iter().find(|wish| !scenes.insert(&wish.scene)) {
            Some(wish) => Err(StageError::new(
                format!("two scenes would be called `{}`", wish.scene),
                "compose them one after the other, or give a scenario another `name`",
            )),
            None => Ok(wishes),
        }
    }

    fn check_seeds(&self, count: u64) -> Result<(), StageError> {
        let refuse = |message: String, hint: String| Err(StageError::new(message, hint));
        let last = self.first.saturating_add(count - 1);
        if last > MOST_SEED {
            let message = format!("seed {last} is above {MOST_SEED} (2^53)");
            return refuse(message, "readers of JSON round such numbers: take a lower --seed".to_owned());
        }
        match self.split {
            SetSplit::Private if self.secret.is_none() => refuse(
                "a private set needs a secret: its scenes are a function of it".to_owned(),
                "write 16 or more random bytes into a file (head -c 32 /dev/urandom > FILE) and name it with --secret".to_owned(),
            ),
            SetSplit::Train if self.first < FIRST_TRAINING_SEED => refuse(
                format!("seed {} belongs to the development set", self.first),
                format!("training seeds begin with {FIRST_TRAINING_SEED}"),
            ),
            SetSplit::Dev if last >= FIRST_TRAINING_SEED => refuse(
                format!("seeds from {FIRST_TRAINING_SEED} on belong to training"),
                "a development set has lower ones".to_owned(),
            ),
            _ => Ok(()),
        }
    }
}

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

    /// What a set keeps of it: says whether another secret is the same, and nothing of the seeds.
    pub fn digest(&self) -> String {
        sha256_hex(&[b"l4d compose --secret", self.0.as_slice()].concat())
    }
}

/// Reads a secret.
///
/// # Errors
/// A file that cannot be read, is too short to be one, or is not random.
pub fn read_secret(path: &Path) -> Result<Secret, DataError> {
    let bytes = read_bounded(path, MOST_SECRET)?;
    let refuse = |message| Err(DataError::invalid(path, "file", message, "head -c 32 /dev/urandom > FILE"));
    let distinct = bytes.iter().collect::<BTreeSet<_>>().len();
    match bytes.len() {
        count if count < LEAST_SECRET => {
            refuse(format!("has {count} bytes, but a secret has at least {LEAST_SECRET}"))
        }
        count if distinct < LEAST_DISTINCT => {
            refuse(format!("is not random: its {count} bytes have {distinct} values"))
        }
        _ => Ok(Secret(bytes)),
    }
}

/// What a file demands of a scene. Its seed is never taken: that is what keeps the splits apart.
#[derive(Debug)]
struct Spec {
    /// None of a composition, whose name says its seed.
    name: Option<Name>,
    scale: Scale,
    place: Option<String>,
    theme: Option<String>,
    categories: Vec<String>,
    verbs: Vec<String>,
}

impl Spec {
    fn of(scale: Scale) -> Self {
        Self { name: None, scale, place: None, theme: None, categories: Vec::new(), verbs: Vec::new() }
    }
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

/// Reads what a composition of this split, or a scenario, demands.
fn read(path: &Path, split: SetSplit) -> Result<Spec, StageError> {
    let document: Value = json::read(path)?;
    match document.get("schema").and_then(Value::as_str) {
        Some(composition::SCHEMA) => {
            let composition: Composition = json::read_document(path)?;
            let own = split_of(path, &composition)?;
            if own != split {
                return Err(StageError::new(
                    format!("{} is a recipe of split {}, not {}", path.display(), called(own), called(split)),
                    "say with --scale, --category and --verb what is wanted, or name a recipe of this split",
                ));
            }
            let Composition { scale, place, theme, categories, verbs, .. } = composition;
            Ok(Spec { place, theme, categories, verbs, ..Spec::of(scale) })
        }
        Some(SCENARIO) => {
            let Scenario { name, scale, groups, events } = json::read(path)?;
            if events.is_empty() {
                let hint = "say what happens";
                return Err(DataError::invalid(path, "field `events`", "is empty", hint).into());
            }
            let distinct = |words: BTreeSet<String>| words.into_iter().collect();
            Ok(Spec {
                name: Some(name),
                categories: distinct(groups.into_iter().map(|group| group.category).collect()),
                verbs: distinct(events.into_iter().map(|event| event.verb).collect()),
                ..Spec::of(scale)
            })
        }
        found => {
            let found = format!("is {}", found.unwrap_or("missing"));
            let hint =
                "write a composition as `l4d compose` does, or a scenario as `l4d propose-scenes` does";
            Err(DataError::invalid(path, "field `schema`", found, hint).into())
        }
    }
}

/// The split of the set that a recipe lies in; of one that lies elsewhere, the split that has its seed.
fn split_of(path: &Path, composition: &Composition) -> Result<SetSplit, DataError> {
    let path = std::fs::canonicalize(path).map_err(|source| DataError::io(path, "find", source))?;
    let set = path.parent().and_then(Path::parent).filter(|set| BenchDir::new(*set).manifest().exists());
    Ok(match set {
        Some(set) => Benchmark::open(set)?.manifest.split,
        None if composition.seed < FIRST_TRAINING_SEED => SetSplit::Dev,
        None => SetSplit::Train,
    })
}

/// A split as files and options spell it.
pub(crate) fn called(split: SetSplit) -> String {
    format!("{split:?}").to_lowercase()
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

    fn ask(split: SetSplit, first: u64, specs: &[PathBuf]) -> Ask<'_> {
        Ask { split, first, count: 1, scale: None, specs, secret: None }
    }

    fn refused(ask: &Ask<'_>) -> String {
        ask.wishes().unwrap_err().to_string()
    }

    #[test]
    fn a_secret_is_long_and_random_and_its_digest_is_no_seed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("secret");
        for (bytes, reason) in [(vec![0; 16], "not random"), ((0..15).collect(), "at least 16")] {
            std::fs::write(&path, bytes).unwrap();
            let error = read_secret(&path).unwrap_err().to_string();
            assert!(error.contains(reason), "{error}");
        }
        std::fs::write(&path, (0..16).collect::<Vec<u8>>()).unwrap();
        let secret = read_secret(&path).unwrap();
        assert_ne!(secret.digest(), Secret(vec![8; 32]).digest());
        assert_ne!(secret.digest(), sha256_hex(&secret.0));
    }

    #[test]
    fn a_scenario_becomes_demands() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("room_bakery.json");
        let text = r#"{"schema":"l4d/scenario/1","name":"room_bakery","scale":"room","story":"A baker.",
            "groups":[{"category":"bucket","members":[]}],
            "events":[{"subject":"a","verb":"lift","object":"b","frames":[1,30]},{"subject":"a","verb":"lift","object":"c","frames":[1,30]}]}"#;
        std::fs::write(&path, text).unwrap();
        let specs = [path.clone()];
        let composition = ask(SetSplit::Train, 1234, &specs).wishes().unwrap().remove(0);
        assert_eq!((composition.seed, composition.scene.as_str()), (1234, "room_bakery"));
        assert_eq!((composition.categories.len(), composition.verbs.len()), (1, 1));
        let twice = [path.clone(), path.clone()];
        assert!(refused(&ask(SetSplit::Train, 1234, &twice)).contains("two scenes"));
        std::fs::write(&path, text.replace("l4d/scenario/1", "other")).unwrap();
        assert!(refused(&ask(SetSplit::Train, 1234, &specs)).contains("schema"));
        std::fs::write(&path, text.split("\"events\"").next().unwrap().to_owned() + "\"events\":[]}")
            .unwrap();
        assert!(refused(&ask(SetSplit::Train, 1234, &specs)).contains("events"));
    }

    #[test]
    fn a_recipe_gives_demands_and_no_seed_and_no_other_split_takes_it() {
        let folder = tempfile::tempdir().unwrap();
        let set = BenchDir::new(folder.path());
        let name = Name::new("room_1001").unwrap();
        let mut recipe = Composition::of(name.clone(), Scale::Room, 1001);
        recipe.draw = 3;
        recipe.verbs = vec!["lift".to_owned()];
        let path = set.composition(&name);
        json::write(&path, &recipe).unwrap();
        let specs = [path.clone()];
        let wish = ask(SetSplit::Train, 1500, &specs).wishes().unwrap().remove(0);
        assert_eq!((wish.scene.as_str(), wish.seed, wish.draw), ("room_1500", 1500, 0));
        assert_eq!((wish.scale, &wish.verbs), (Scale::Room, &recipe.verbs));

        let secret = Secret(vec![7; 32]);
        let private = Ask { secret: Some(&secret), ..ask(SetSplit::Private, 1, &specs) };
        assert!(refused(&private).contains("split train, not private"));
        assert!(refused(&ask(SetSplit::Dev, 1, &specs)).contains("split train, not dev"));
        // The set that a recipe lies in says more than its seed.
        let manifest =
            "name = \"P\"\nversion = \"1.0.0\"\nlicence = \"CC0-1.0\"\nsplit = \"private\"\nscenes = []\n";
        std::fs::write(set.manifest(), manifest).unwrap();
        assert!(refused(&ask(SetSplit::Train, 1500, &specs)).contains("split private, not train"));
        let wish = private.wishes().unwrap().remove(0);
        assert_eq!((wish.scene.as_str(), wish.seed), ("room_p0001", secret.seed(1)));
        // A recipe of a development seed makes no training set, wherever it lies.
        recipe.seed = 501;
        let stray = folder.path().join("stray.json");
        json::write(&stray, &recipe).unwrap();
        assert!(refused(&ask(SetSplit::Train, 1500, &[stray])).contains("split dev, not train"));
    }

    #[test]
    fn a_split_has_its_seeds() {
        let of = |split, first, count| Ask { count, ..ask(split, first, &[]) };
        let last = of(SetSplit::Train, MOST_SEED, 1).wishes().unwrap();
        assert_eq!(last[0].seed, MOST_SEED);
        assert!(refused(&of(SetSplit::Train, MOST_SEED, 2)).contains("2^53"));
        assert!(refused(&of(SetSplit::Train, u64::MAX, 2)).contains("2^53"));
        assert!(refused(&of(SetSplit::Train, 999, 1)).contains("development set"));
        assert!(refused(&of(SetSplit::Dev, 999, 2)).contains("belong to training"));
        assert!(refused(&of(SetSplit::Private, 1, 1)).contains("needs a secret"));
        assert_eq!(of(SetSplit::Dev, 998, 2).wishes().unwrap().len(), 2);
    }
}
