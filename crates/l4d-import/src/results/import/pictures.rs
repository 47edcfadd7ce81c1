//! The held-out pictures of a scene: which frames there are, which of them are judged, and how large masks must be.

use l4d_data::{Benchmark, DataError, Name, Profile};

/// What masks of a scene must fit.
#[derive(Debug, Clone)]
pub(super) struct Pictures {
    /// Frames of the clip, ascending: the n-th picture of a render shows the n-th of them.
    pub(super) clip: Vec<u32>,
    /// Those that no one annotated, ascending: answers for them are left out, since nothing judges them.
    pub(super) unannotated: Vec<u32>,
    /// Columns and rows.
    pub(super) size: (u32, u32),
    profile: Profile,
}

impl Pictures {
    pub(super) fn read(bench: &Benchmark, profile: Profile, scene: &Name) -> Result<Self, DataError> {
        if profile.is_rendered() {
            let size = (profile.width(), profile.height());
            return Ok(Self { clip: profile.frames().collect(), unannotated: Vec::new(), size, profile });
        }
        let truth = bench.truth(profile, scene)?;
        let size = (truth.width, truth.height);
        Ok(Self { clip: truth.clip(), unannotated: truth.unannotated, size, profile })
    }

    /// Whether an answer for a frame of the clip is judged.
    pub(super) fn is_asked(&self, frame: u32) -> bool {
        self.unannotated.binary_search(&frame).is_err()
    }

    /// Frames that have to be answered, ascending.
    pub(super) fn asked(&self) -> impl Iterator<Item = u32> {
        self.clip.iter().copied().filter(|frame| self.is_asked(*frame))
    }

    /// What frames there are, in words.
    pub(super) fn frames_in_words(&self) -> String {
        match (self.profile.is_rendered(), self.clip.as_slice()) {
            (false, [first, .., last]) => format!("no frame of the capture ({first} to {last})"),
            _ => format!("no frame of profile {} (every {}th from 0)", self.profile, self.profile.stride()),
        }
    }

    /// Whose pictures they are, in words.
    pub(super) fn owner(&self) -> String {
        if self.profile.is_rendered() {
            format!("profile {}", self.profile)
        } else {
            "the capture".to_owned()
        }
    }
}
