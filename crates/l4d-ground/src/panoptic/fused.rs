//! The grounder that looks at all views of a scene before it answers in any.
//!
//! What the paper's consensus has to reconcile afterwards is put together before the sentence is judged: one scene, one
//! answer, shown in each view. A rival of grounding view by view, and reported apart from it.

use std::collections::BTreeMap;
use std::sync::Arc;

use l4d_data::StageError;
use l4d_data::digest::sha256_hex;
use serde_json::{Value, json};

use super::believe::Scene;
use super::fuse::{Member, group, together};
use super::look::{Looked, look};
use super::{Panoptic, Seen};
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};
use crate::unreadable::Unreadable;

/// The panoptic grounder about one scene, whose views it knows together.
pub struct Fused {
    panoptic: Arc<Panoptic>,
    views: Vec<Looked>,
    /// Digest of a clip -> number of its view.
    number_of: BTreeMap<String, usize>,
    groups: Vec<Vec<Member>>,
    /// Nothing of no views.
    seen: Option<Seen>,
}

impl Fused {
    /// Looks at the views of a scene.
    ///
    /// # Errors
    /// Weights that cannot be run.
    pub fn new(panoptic: Arc<Panoptic>, clips: &[ViewClip]) -> Result<Self, StageError> {
        let looked = |clip| look(clip, &panoptic.network, &panoptic.table);
        let views: Vec<Looked> = clips.iter().map(looked).collect::<Result<_, _>>().map_err(|error| {
            StageError::new(
                format!("looking at the views: {error}"),
                "docs/network.md says how weights are made",
            )
        })?;
        let number_of = clips.iter().enumerate().map(|(number, clip)| (clip.digest(), number)).collect();
        let groups = group(&views);
        let seen = together(&views, &groups)
            .map(|looked| Seen { scene: Scene::of(&looked, panoptic.network.description()), looked });
        Ok(Self { panoptic, views, number_of, groups, seen })
    }

    fn answer(&self, clip: &ViewClip, question: &Question) -> Result<Grounding, Outcome> {
        let reading = self.panoptic.read(&question.text).map_err(Outcome::Unsupported)?;
        let (Some(&view), Some(seen)) = (self.number_of.get(&clip.digest()), &self.seen) else {
            return Err(Outcome::Error("this view was not among those that were looked at".to_owned()));
        };
        let judged = self.panoptic.judge(seen, &reading)?;
        let group = judged.best.as_ref().and_then(|best| seen.looked.number(&best.name));
        let members = group.into_iter().flat_map(|group| &self.groups[group]);
        let tracks: Vec<usize> = members.filter(|member| member.0 == view).map(|member| member.1).collect();
        Ok(judged.shown(clip, &self.views[view], &tracks, question))
    }
}

impl Grounder for Fused {
    fn identity(&self) -> Value {
        let clips: Vec<&str> = self.number_of.keys().map(String::as_str).collect();
        json!({
            "kind": "panoptic-fused",
            "version": 1,
            "weights": self.panoptic.network.description().sha256,
            "views": sha256_hex(clips.concat().as_bytes()),
        })
    }

    fn reads(&self, text: &str) -> Result<(), Unreadable> {
        self.panoptic.reads(text)
    }

    fn knows(&self) -> Option<String> {
        self.panoptic.knows()
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        self.answer(clip, question).unwrap_or_else(Grounding::without_answer)
    }
}
