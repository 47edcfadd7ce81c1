//! Results of a method: the card (`method.json`) and the masks of each query.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::error::DataError;
use crate::json;
use crate::name::Name;
use crate::rle::Rle;
use crate::store::read_bounded;
use crate::timeline::Profile;

/// What a method looked at beyond the training views and the sentence.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Used {
    /// Ground truth of any kind: such results are shown but never ranked.
    pub ground_truth: bool,
    /// Pictures of the held-out view.
    pub test_view: bool,
    /// Rendered depth of the training views, directly or through a model that learned from it. Cards of before there was
    /// the field do not say it.
    #[serde(default)]
    pub depth: bool,
    /// Model servers that were asked.
    #[serde(default)]
    pub endpoints: Vec<String>,
}

impl Used {
    /// With whom the method is ranked.
    pub fn track(&self) -> Track {
        Track::of_depth(self.depth)
    }
}

/// Methods that are ranked with each other. Rendered depth is exact, which no camera measures, so that who learned from
/// it is not ranked with who did not.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Track {
    /// Colour alone: the headline.
    #[default]
    #[serde(rename = "colour")]
    Colour,
    /// Colour and rendered depth.
    #[serde(rename = "colour+depth")]
    ColourDepth,
}

impl Track {
    /// The headline first.
    pub const ALL: [Self; 2] = [Self::Colour, Self::ColourDepth];

    /// That of a method which saw rendered depth, or did not.
    pub fn of_depth(saw_depth: bool) -> Self {
        if saw_depth { Self::ColourDepth } else { Self::Colour }
    }

    /// In files and on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Colour => "colour",
            Self::ColourDepth => "colour+depth",
        }
    }

    pub fn title(self) -> &'static str {
        match self {
            Self::Colour => "colour",
            Self::ColourDepth => "colour + depth",
        }
    }
}

/// `results/<method>/method.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MethodCard {
    /// Equals the folder's name.
    pub name: Name,
    /// Version of the method.
    pub version: String,
    /// Paper or code, may be empty.
    #[serde(default)]
    pub link: String,
    /// Version of the benchmark (`panoptic-l4d.toml`).
    pub benchmark_version: String,
    /// [`crate::Benchmark::truth_digest`] of the profile.
    pub truth_digest: String,
    /// Profile of the masks.
    pub profile: Profile,
    /// Mask width, pixels; 0 for real scenes, whose sizes differ, and then left out of the file.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub width: u32,
    /// Mask height, pixels; as the width.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub height: u32,
    /// Canonical frames that the masks cover, ascending; none for real scenes, whose timelines differ.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<u32>,
    /// Protocol that the masks were made for (`l4d`).
    pub protocol: String,
    /// What the method looked at.
    pub used: Used,
    /// A baseline, which is there for the scale: shown, never ranked. Left out of the file where it is not so.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub baseline: bool,
    /// Wall seconds that the method took for all queries; null where it was not measured.
    pub seconds: Option<f64>,
    /// Numbers that the method reports of itself, or that its own evaluation wrote: what is measured -> value. They are
    /// shown beside what is counted here and never become a score. Percent, where the name is that of a metric
    /// (`miou`, `tube_iou`) or of a group and a metric (`action miou`, `room_gym macc`).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reported: BTreeMap<String, f64>,
    /// How foreign files became these masks; none for results that were written as such.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub import: Option<Import>,
}

fn is_zero(side: &u32) -> bool {
    *side == 0
}

/// What an import read and took for granted, so that two people get the same masks.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Import {
    /// Preset of `l4d import`.
    pub format: String,
    /// Topic -> what was assumed, in words.
    pub assumptions: BTreeMap<String, String>,
    /// What was read -> SHA-256.
    pub inputs: BTreeMap<String, String>,
}

/// The protocol of this project's judge: masks of the whole clip of the held-out view.
pub const PROTOCOL: &str = "l4d";

impl MethodCard {
    /// Of masks for a profile of a benchmark, by its version and the digest of its truth. What the method looked at and
    /// reports is still to be said.
    pub fn new(
        name: Name,
        version: impl Into<String>,
        benchmark_version: &str,
        truth_digest: impl Into<String>,
        profile: Profile,
    ) -> Self {
        Self {
            name,
            version: version.into(),
            link: String::new(),
            benchmark_version: benchmark_version.to_owned(),
            truth_digest: truth_digest.into(),
            profile,
            width: profile.width(),
            height: profile.height(),
            frames: profile.frames().collect(),
            protocol: PROTOCOL.to_owned(),
            used: Used::default(),
            baseline: false,
            seconds: None,
            reported: BTreeMap::new(),
            import: None,
        }
    }

    /// Reads a card and checks it against its folder.
    ///
    /// # Errors
    /// A card that is missing, damaged or of another folder.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        Self::parse(path, &read_bounded(path, json::MAX_BYTES)?)
    }

    /// Parses and checks bytes that came from `path`, and says of every field what is wrong with it, not of the first alone.
    ///
    /// # Errors
    /// One for each field that is missing, wrong or unknown; one for bytes that are no card at all.
    pub fn parse_all(path: &Path, bytes: &[u8]) -> Result<Self, Vec<DataError>> {
        let first = match Self::parse(path, bytes) {
            Ok(card) => return Ok(card),
            Err(error) => error,
        };
        let (Ok(given), Ok(Value::Object(sound))) =
            (json::parse::<Map<String, Value>>(path, None, bytes), serde_json::to_value(Self::sound()))
        else {
            return Err(vec![first]);
        };
        // Each field by itself in a card that is sound otherwise: a field is needed without which there is none.
        let is_needed = |field: &&String| {
            let mut rest = sound.clone();
            rest.remove(*field);
            serde_json::from_value::<Self>(Value::Object(rest)).is_err()
        };
        let lacking = sound.keys().filter(is_needed).filter(|field| !given.contains_key(*field));
        let mut errors: Vec<DataError> =
            lacking.map(|field| invalid(path, field, "is missing".to_owned())).collect();
        for (field, value) in &given {
            let mut card = sound.clone();
            card.insert(field.clone(), value.clone());
            if let Err(error) = serde_path_to_error::deserialize::<_, Self>(Value::Object(card)) {
                let place = error.path().to_string();
                let place = if place.starts_with(field.as_str()) { &place } else { field };
                errors.push(invalid(path, place, error.inner().to_string()));
            }
        }
        Err(if errors.is_empty() { vec![first] } else { errors })
    }

    /// A card with every field that has to be there.
    fn sound() -> Option<Self> {
        Some(Self::new(Name::new("method").ok()?, "1", "1", "", Profile::Tiny))
    }

    /// Parses and checks bytes that came from `path`.
    ///
    /// # Errors
    /// Bytes that are no such card.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, DataError> {
        let card: Self = json::parse(path, None, bytes)?;
        let folder =
            path.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned();
        if card.name.as_str() != folder {
            return Err(DataError::invalid(
                path,
                "field `name`",
                format!("is `{}`, but the folder is `{folder}`", card.name),
                "rename the folder or the method",
            ));
        }
        if card.seconds.is_some_and(|seconds| !(seconds.is_finite() && seconds >= 0.0)) {
            return Err(DataError::invalid(
                path,
                "field `seconds`",
                "must be a time",
                "write seconds or null",
            ));
        }
        Ok(card)
    }
}

fn invalid(path: &Path, field: &str, message: String) -> DataError {
    let hint = "write method.json as docs/formats.md says, or let `l4d init-results` write it";
    DataError::invalid(path, format!("field `{field}`"), message, hint)
}

/// `results/<method>/masks/<scene>/<nnn>.json`: the masks of one query in the held-out view.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaskFile {
    /// `[height, width]`, pixels.
    pub size: [u32; 2],
    /// Four-digit frame -> mask, null = the method says absent. A missing key is a missing answer.
    pub frames: BTreeMap<String, Option<Rle>>,
}

impl MaskFile {
    /// Parses bytes that came from `path`, and checks that every mask has the stated size.
    ///
    /// # Errors
    /// Bytes that are no such file.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, DataError> {
        let file: Self = json::parse(path, None, bytes)?;
        let [height, width] = file.size;
        for (frame, mask) in &file.frames {
            if let Some(error) = mask.as_ref().and_then(|mask| mask.misfit(width, height)) {
                let place = format!("frame {frame}");
                return Err(DataError::invalid(path, place, error.to_string(), error.hint()));
            }
        }
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_fields_that_are_wrong_are_said_at_once() {
        let bytes = br#"{"name": "m", "version": 1, "profile": "huge", "used": {"truth": true}, "colour": 3, "frames": [0]}"#;
        let errors = MethodCard::parse_all(Path::new("results/m/method.json"), bytes).unwrap_err();
        let said: Vec<String> = errors.iter().map(DataError::to_string).collect();
        let fields =
            ["benchmark_version", "truth_digest", "protocol", "colour", "profile", "used.truth", "version"];
        for field in fields {
            assert!(said.iter().any(|line| line.contains(&format!("field `{field}`"))), "{field}: {said:?}");
        }
        assert_eq!(said.len(), fields.len(), "{said:?}");
        assert_eq!(MethodCard::parse_all(Path::new("m/method.json"), b"[]").unwrap_err().len(), 1);
    }

    #[test]
    fn cards_of_before_there_was_depth_are_of_the_headline_track() {
        let old: Used = serde_json::from_str(r#"{"ground_truth": false, "test_view": false}"#).unwrap();
        assert_eq!((old.depth, old.track()), (false, Track::Colour));
        let new = Used { depth: true, ..old };
        assert_eq!(serde_json::to_value(new.track()).unwrap(), new.track().as_str());
        let text = serde_json::to_string(&new).unwrap();
        assert!(text.contains("\"depth\":true"), "{text}");
        assert_eq!(serde_json::from_str::<Used>(&text).unwrap(), new);
    }
}
