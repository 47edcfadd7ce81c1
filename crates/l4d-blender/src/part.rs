//! Which pictures of a scene are asked for: some views, some frames, a shard of them.

use std::collections::BTreeSet;
use std::str::FromStr;

use l4d_data::timeline::LAST_FRAME;
use l4d_data::tracks::Tracks;
use l4d_data::{Profile, Shard, StageError};

use crate::Result;
use crate::render::Image;

/// Canonical frames as people write them: `0-24`, `0,12,48`, `0-48:4`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameList(Vec<Span>);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Span {
    first: u32,
    last: u32,
    step: usize,
}

/// A part of each scene; by default all of it.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// Views by name; none for all that the profile renders.
    pub views: Vec<String>,
    /// None for all that the profile renders.
    pub frames: Option<FrameList>,
    /// Which share of these pictures.
    pub shard: Option<Shard>,
}

impl Part {
    /// Whether no picture is left out.
    pub fn is_all(&self) -> bool {
        self.views.is_empty() && self.frames.is_none() && self.shard.is_none()
    }

    /// Refuses views that a scene does not have, and frames that the profile does not render.
    ///
    /// # Errors
    /// The first of them, with those that there are.
    pub fn check(&self, tracks: &Tracks, profile: Profile) -> Result<()> {
        self.asked_frames(profile)?;
        let known: Vec<&str> = tracks.views(profile).map(|camera| camera.name.as_str()).collect();
        match self.views.iter().find(|view| !known.contains(&view.as_str())) {
            None => Ok(()),
            Some(view) => Err(StageError::new(
                format!("--views: {} has no view `{}` at {profile}", tracks.scene, view.escape_debug()),
                format!("choose among {}", known.join(", ")),
            )),
        }
    }

    /// Those of all pictures of a profile that belong to the part. The views of a frame stay together: shard i of n
    /// has every n-th of the frames that are asked for.
    pub(crate) fn of(&self, mut images: Vec<Image>, profile: Profile) -> Result<Vec<Image>> {
        let mut frames = self.asked_frames(profile)?;
        if let Some(shard) = self.shard {
            shard.keep(&mut frames);
        }
        images.retain(|image| {
            let is_view = self.views.is_empty() || self.views.iter().any(|view| *view == *image.view);
            is_view && frames.binary_search(&image.frame).is_ok()
        });
        Ok(images)
    }

    /// Ascending.
    fn asked_frames(&self, profile: Profile) -> Result<Vec<u32>> {
        let Some(FrameList(spans)) = &self.frames else { return Ok(profile.frames().collect()) };
        let rendered: BTreeSet<u32> = profile.frames().collect();
        let mut asked = BTreeSet::new();
        for span in spans {
            let Span { first, last, step } = *span;
            let found: Vec<u32> =
                (first..=last).step_by(step).filter(|frame| rendered.contains(frame)).collect();
            if found.is_empty() {
                return Err(StageError::new(
                    format!("--frames: {profile} renders no frame of `{first}-{last}:{step}`"),
                    format!("its frames are 0-{LAST_FRAME}:{}", profile.stride()),
                ));
            }
            asked.extend(found);
        }
        Ok(asked.into_iter().collect())
    }
}

impl FromStr for FrameList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.split(',').map(span).collect::<Result<_, _>>().map(Self)
    }
}

fn span(text: &str) -> Result<Span, String> {
    let parse = || {
        let (range, step) = text.split_once(':').unwrap_or((text, "1"));
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        Some(Span { first: first.parse().ok()?, last: last.parse().ok()?, step: step.parse().ok()? })
    };
    match parse() {
        Some(span) if span.first <= span.last && span.last <= LAST_FRAME && span.step > 0 => Ok(span),
        _ => Err(format!(
            "`{text}` are no frames of 0 to {LAST_FRAME}: write 12, 0-24 or 0-48:4, several with commas between"
        )),
    }
}

#[cfg(test)]
mod tests {
    use l4d_data::Name;

    use super::*;

    fn images(profile: Profile) -> Vec<Image> {
        let of_frame = |frame| ["a", "b"].map(move |view| Image { frame, view: Name::new(view).unwrap() });
        profile.frames().flat_map(of_frame).collect()
    }

    fn frames(text: &str, profile: Profile) -> Vec<u32> {
        let part = Part { frames: Some(text.parse().unwrap()), ..Part::default() };
        part.asked_frames(profile).unwrap()
    }

    #[test]
    fn shards_partition_the_pictures_and_keep_frames_whole() {
        for asked in [None, Some("0-48:4")] {
            let of = |shard| {
                let frames = asked.map(|text| text.parse().unwrap());
                Part { frames, shard, ..Part::default() }.of(images(Profile::Small), Profile::Small).unwrap()
            };
            let whole = of(None);
            let parts: Vec<Vec<Image>> = (1..=2).map(|index| of(Some(Shard { index, count: 2 }))).collect();
            let mut all: Vec<Image> = parts.concat();
            all.sort();
            assert_eq!(all, whole);
            // Also of every fourth frame, which are all even.
            assert!(parts.iter().all(|part| part.len() >= whole.len() / 2 - 2 && part.len() % 2 == 0));
        }
    }

    #[test]
    fn frames_are_those_of_the_list_that_the_profile_renders() {
        assert_eq!(frames("0,12,48", Profile::Tiny), [0, 12, 48]);
        assert_eq!(frames("0-24", Profile::Tiny), [0, 12, 24]);
        assert_eq!(frames("0-48:4", Profile::Tiny), [0, 12, 24, 36, 48]);
        assert_eq!(frames("5-8,2,6-7", Profile::Small), [2, 6, 8]);
        let none = Part { frames: Some("13".parse().unwrap()), ..Part::default() };
        let error = none.of(images(Profile::Tiny), Profile::Tiny).unwrap_err();
        assert!(error.hint().contains("0-96:12"), "{error}");
    }

    #[test]
    fn what_is_no_list_of_frames_is_refused() {
        for wrong in ["", "a", "3-", "-3", "5-4", "0-97", "0-4:0", "0-4:", "1,,2", "1-2-3", "4294967296"] {
            assert!(wrong.parse::<FrameList>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn views_are_chosen_by_name() {
        let part =
            Part { views: vec!["b".to_owned()], frames: Some("12".parse().unwrap()), ..Part::default() };
        let chosen = part.of(images(Profile::Tiny), Profile::Tiny).unwrap();
        assert_eq!(chosen, [Image { frame: 12, view: Name::new("b").unwrap() }]);
        assert!(!part.is_all());
    }
}
