//! Presets: what is known of the files that methods leave, as data.
//!
//! A preset says where files are, what they hold and which rule of their own evaluation makes a mask of them. The
//! built-in ones are in `presets/` beside this crate; any file of that form can take their place.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::{DataError, toml_file};
use serde::{Deserialize, Serialize};

use super::codec::Codec;
use super::inside::Inside;
use super::relevancy::Rules;
use super::template::Template;

const HINT: &str = "see docs/import/presets.md";

/// What is known of a method's files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// What `l4d import` calls it.
    pub name: String,
    /// Paper or code.
    #[serde(default)]
    pub link: String,
    /// Where files are.
    pub template: String,
    /// Which of several things a field of a template is: the first that is there.
    #[serde(default)]
    pub prefer: BTreeMap<String, Vec<String>>,
    /// Pictures that the export for the method has: those beyond the clip repeat its last frame.
    #[serde(default)]
    pub padded_to: Option<usize>,
    /// Which picture the image of a COCO file is.
    #[serde(default)]
    pub images: Option<ImagesPreset>,
    /// What they hold.
    pub codec: Codec,
    /// What of a picture or array is inside.
    #[serde(default = "mask")]
    pub inside: Inside,
    /// Names that fit the template and are something else begin so.
    #[serde(default)]
    pub ignore: Vec<String>,
    /// Which array of a file with several.
    #[serde(default)]
    pub key: Option<String>,
    /// Whether masks of another size are brought to ours, as the method's own evaluation does.
    #[serde(default)]
    pub resize: bool,
    /// What latents need.
    #[serde(default)]
    pub latents: Option<LatentsPreset>,
    /// Where the method writes numbers of its own.
    #[serde(default)]
    pub claims: Option<Claims>,
    /// What someone who compares should know: a sentence each.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// How latents become masks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatentsPreset {
    /// Levels, in the order in which equals win.
    pub levels: Vec<u64>,
    pub rules: Rules,
    /// Where the weights of the autoencoder may be, if none are given.
    #[serde(default)]
    pub decoder: Vec<String>,
    /// Where latents of time are.
    #[serde(default)]
    pub time_template: Option<String>,
    /// Where the weights of the autoencoder of time may be, if none are given.
    #[serde(default)]
    pub time_decoder: Vec<String>,
}

/// Annotations whose image ids name folders.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImagesPreset {
    /// Where they are, if none are given; `{dataset}` is the kind of data set.
    pub template: String,
    /// The number that the first image's name begins with, by kind of data set.
    pub first: BTreeMap<String, u32>,
}

/// Files with numbers that a method claims.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claims {
    /// Where they are.
    pub template: String,
}

fn mask() -> Inside {
    Inside::Mask
}

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../presets/", $name, ".toml")))),*]
    };
}

/// Name and text of the built-in presets.
const BUILT_IN: &[(&str, &str)] = built_in![
    "langsplat",
    "langsplat-per-frame",
    "langsplat-masks",
    "langsplat-per-frame-masks",
    "4d-langsplat",
    "4d-langsplat-masks",
    "gaussian-grouping",
    "opengaussian",
    "refersplat",
    "mevis",
    "mevis-rle",
    "davis",
    "r4d",
    "votsr",
    "generic",
];

impl Preset {
    /// A built-in preset by its name, or the one in a file.
    ///
    /// # Errors
    /// A name that is neither, and files that are no preset.
    pub fn find(name: &str) -> Result<Self, DataError> {
        if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
            return Self::parse(Path::new(name), text);
        }
        let path = Path::new(name);
        if path.extension().is_some_and(|extension| extension == "toml") {
            return toml_file::read(path, HINT).and_then(|preset| Self::checked(path, preset));
        }
        let known: Vec<&str> = BUILT_IN.iter().map(|(name, _)| *name).collect();
        let hint = format!("give a .toml file, or one of: {}", known.join(", "));
        Err(DataError::invalid(path, "format", "is no known format and no .toml file", hint))
    }

    fn parse(path: &Path, text: &str) -> Result<Self, DataError> {
        toml_file::parse(path, text, HINT).and_then(|preset| Self::checked(path, preset))
    }

    fn checked(path: &Path, preset: Self) -> Result<Self, DataError> {
        let invalid = |place: &str, message: String| DataError::invalid(path, place, message, HINT);
        let claims = preset.claims.iter().map(|claims| &claims.template);
        let images = preset.images.iter().map(|images| &images.template);
        let of_latents = preset.latents.iter().flat_map(|latents| {
            latents.decoder.iter().chain(&latents.time_template).chain(&latents.time_decoder)
        });
        for template in [&preset.template].into_iter().chain(claims).chain(images).chain(of_latents) {
            Template::parse(template).map_err(|error| invalid("template", error))?;
        }
        if (preset.codec == Codec::Latents) != preset.latents.is_some() {
            let message = "belongs to the codec `latents`, and to no other";
            return Err(invalid("table `latents`", message.to_owned()));
        }
        Ok(preset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_preset_reads_and_is_called_what_its_file_is_called() {
        for (name, _) in BUILT_IN {
            let preset = Preset::find(name).unwrap();
            assert_eq!(preset.name, *name);
            assert!(!preset.notes.is_empty(), "{name} says nothing of itself");
        }
        let error = Preset::find("nothing").unwrap_err();
        assert!(error.hint().contains("langsplat"));
    }

    #[test]
    fn what_is_no_preset_says_why() {
        let base = "name = 'x'\ntemplate = '{text}.png'\ncodec = 'picture'\n";
        assert!(Preset::parse(Path::new("x"), base).is_ok());
        for (more, reason) in [
            ("inside = 'above'", "no rule"),
            ("colour = 'red'", "unknown field"),
            ("[claims]\ntemplate = '../x'", "below the given folder"),
            (
                "[latents]\nlevels = [1]\nrules = { smoothing = 'box30', threshold = 0.4 }",
                "belongs to the codec",
            ),
        ] {
            let error = Preset::parse(Path::new("x"), &format!("{base}{more}\n")).unwrap_err().to_string();
            assert!(error.contains(reason), "{more}: {error}");
        }
    }
}
