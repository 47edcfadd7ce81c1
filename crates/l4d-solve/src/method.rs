//! A method as users choose it: preset, views, consensus, lift, and the name that its results have by default.

use l4d_data::{Interval, QuerySet};
use serde::Deserialize;

use crate::consensus::Preset;
use crate::consensus::settings::Undecided;
use crate::lift::{ClosedSettings, FieldSettings, LiftSettings};
use crate::scene::ClipSettings;
use crate::solve::SolveSettings;

/// Views that the presets look at (paper, section 5).
const USUAL_VIEWS: usize = 8;

/// How masks become an answer in four dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LiftChoice {
    /// The closed form of the preset `robust`: SIRT, a graph, time.
    Closed,
    /// Sums of blend weights and a threshold.
    Vote,
    /// The identity field of the paper.
    Field,
}

impl LiftChoice {
    fn word(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Vote => "vote",
            Self::Field => "field",
        }
    }

    fn settings(self) -> LiftSettings {
        match self {
            Self::Closed => LiftSettings::Closed(ClosedSettings::robust()),
            Self::Vote => LiftSettings::Closed(ClosedSettings::vote()),
            Self::Field => LiftSettings::Field(FieldSettings::paper()),
        }
    }
}

/// Everything about a method but its grounder.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodChoice {
    /// Rules and constants that belong together.
    pub preset: Preset,
    /// Views at most: the paper's V.
    pub views: usize,
    /// Seed of the first of them.
    pub view_seed: u64,
    /// Width and height of the clips, pixels; none for those of the training pictures.
    pub clip_size: Option<[u32; 2]>,
    /// Every so many frames; none for those of the training pictures.
    pub clip_every: Option<u32>,
    /// Whether views have to agree.
    pub consensus: bool,
    /// Give no answer where the votes decide nothing.
    pub abstain: bool,
    /// How masks become an answer; none for that of the preset.
    pub lift: Option<LiftChoice>,
}

impl MethodChoice {
    /// Consensus and lifting.
    pub fn solve_settings(&self) -> SolveSettings {
        let preset = self.preset.solve_settings();
        let mut consensus = if self.consensus { preset.consensus } else { Preset::Off.settings() };
        if self.abstain {
            consensus.undecided = Undecided::Abstain;
        }
        SolveSettings { consensus, lift: self.lift.map_or(preset.lift, LiftChoice::settings) }
    }

    /// Which clips are looked at.
    pub fn clip_settings(&self, range: Option<Interval>) -> ClipSettings {
        let usual = self.preset.clip_settings(self.views, self.view_seed);
        ClipSettings { range, size: self.clip_size, every: self.clip_every, ..usual }
    }

    /// `panopticquery-<grounder>`, what differs from the preset robust, and the set of sentences if it is not the
    /// queries: a folder of results holds answers to one set.
    pub fn default_name(&self, grounder: &str, has_noise: bool, set: QuerySet) -> String {
        let usual = |is_usual: bool, part: &str| (!is_usual).then(|| part.to_owned());
        let parts = [
            usual(!has_noise, "noise"),
            usual(self.preset != Preset::Paper, "paper"),
            usual(self.views == USUAL_VIEWS, &format!("v{}", self.views)),
            self.clip_size.map(|[width, height]| format!("{width}x{height}")),
            self.clip_every.map(|every| format!("every-{every}")),
            usual(self.consensus, "no-mvsc"),
            usual(!self.abstain, "abstain"),
            self.lift.map(|lift| lift.word().to_owned()),
            usual(set == QuerySet::Queries, set.as_str()),
        ];
        let mut name = format!("panopticquery-{grounder}");
        for part in parts.into_iter().flatten() {
            name.push('-');
            name.push_str(&part);
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_what_differs_from_the_default() {
        let usual = MethodChoice {
            preset: Preset::Robust,
            views: 8,
            view_seed: 0,
            clip_size: None,
            clip_every: None,
            consensus: true,
            abstain: false,
            lift: None,
        };
        assert_eq!(usual.default_name("panoptic", false, QuerySet::Queries), "panopticquery-panoptic");
        let other = MethodChoice {
            preset: Preset::Paper,
            views: 4,
            clip_size: Some([64, 48]),
            clip_every: Some(2),
            consensus: false,
            lift: Some(LiftChoice::Vote),
            ..usual
        };
        assert_eq!(
            other.default_name("oracle", true, QuerySet::Absents),
            "panopticquery-oracle-noise-paper-v4-64x48-every-2-no-mvsc-vote-absents"
        );
        assert!(!other.solve_settings().consensus.is_on);
    }
}
