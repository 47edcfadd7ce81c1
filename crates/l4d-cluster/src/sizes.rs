//! What a job takes: the table `sizes` of `workflow/config.yaml`, which is the one place of these figures.

use std::collections::BTreeMap;

use l4d_data::{Profile, StageError};
use serde::Deserialize;

use crate::Result;
use crate::settings::CONFIG;

/// What the pictures, models and answers of a profile take.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Size {
    /// Pictures of a view.
    pub frames: usize,
    /// Views of a scene.
    pub views: usize,
    /// Seconds of a picture on [`CORES`].
    pub picture: f64,
    /// Of a picture on disk, at most.
    pub picture_mb: f64,
    /// Seconds of a scene's model.
    pub train: f64,
    /// Seconds of an answer.
    pub query: f64,
    /// Memory asked for.
    pub render_mb: u32,
    /// Memory asked for.
    pub train_mb: u32,
    /// Memory asked for.
    pub solve_mb: u32,
    /// Jobs that share a scene's pictures, where nothing else is said.
    pub render_blocks: usize,
    /// Jobs that share a scene's queries, where nothing else is said.
    pub solve_blocks: usize,
    /// Names of the fields above that were not measured.
    pub guessed: Vec<String>,
}

/// On so many cores the seconds were measured.
pub const CORES: usize = 2;

impl Size {
    /// The row of a profile.
    ///
    /// # Errors
    /// A profile that has none: captures are not rendered.
    pub fn of(profile: Profile) -> Result<Self> {
        #[derive(Deserialize)]
        struct Config {
            sizes: BTreeMap<String, Size>,
        }
        let wrong = |message: String| {
            StageError::new(
                format!("workflow/config.yaml: {message}"),
                "choose --profile tiny, small or full",
            )
        };
        let mut config: Config = serde_yaml_ng::from_str(CONFIG).map_err(|error| wrong(error.to_string()))?;
        config.sizes.remove(profile.as_str()).ok_or_else(|| wrong(format!("`sizes` has no `{profile}`")))
    }

    /// Whether a field was not measured.
    pub fn is_guessed(&self, field: &str) -> bool {
        self.guessed.iter().any(|name| name == field)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_those_of_the_profiles() {
        for profile in Profile::ALL {
            let size = Size::of(profile).unwrap();
            assert_eq!(size.frames, profile.frames().count(), "{profile}");
            assert_eq!(size.views, profile.training_views() + 1, "{profile}");
            let pixels = f64::from(profile.width() * profile.height());
            // 18 bytes a pixel, rounded up.
            assert!((size.picture_mb * 1e6 / pixels - 18.0).abs() < 1.0, "{profile}");
        }
        assert!(Size::of(Profile::Real).is_err());
    }
}
