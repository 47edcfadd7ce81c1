//! The truth of a scene as prompts with masks, which is what the evaluators of other methods read. Writes no format
//! itself.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::truth::Truth;
use l4d_data::{DataError, Query, Temporal};
use l4d_masks::Mask;
use l4d_masks::target;

/// Queries of a scene with the truth that their answers are compared with.
#[derive(Debug, Clone)]
pub struct QueriesWithTruth<'a> {
    truth: &'a Truth,
    prompts: Vec<Prompt<'a>>,
}

/// A query with the pixels of what it means, in the held-out view.
#[derive(Debug, Clone)]
pub(super) struct Prompt<'a> {
    pub(super) query: &'a Query,
    /// Pixels of all referents, by canonical frame; frames in which none is visible are absent.
    pub(super) masks: BTreeMap<u32, Mask>,
}

impl<'a> QueriesWithTruth<'a> {
    /// Decodes the masks of the queries' referents; `path` is that of the truth, for errors.
    ///
    /// # Errors
    /// Referents that the truth does not have, and damaged masks.
    pub fn new(path: &Path, truth: &'a Truth, queries: &'a [Query]) -> Result<Self, DataError> {
        let prompt = |query| Ok(Prompt { query, masks: masks_of(path, truth, query)? });
        Ok(Self { truth, prompts: queries.iter().map(prompt).collect::<Result<_, DataError>>()? })
    }

    pub(crate) fn truth(&self) -> &Truth {
        self.truth
    }

    pub(super) fn prompts(&self) -> &[Prompt<'a>] {
        &self.prompts
    }
}

impl Prompt<'_> {
    /// Whether the sentence holds at some times only.
    pub(super) fn is_gated(&self) -> bool {
        self.query.temporal == Temporal::While
    }

    /// Name of the base object, under which 4D LangSplat lists gated sentences.
    pub(super) fn base(&self) -> String {
        base_object(self.query)
    }
}

/// The object that a sentence is about, without its times: the names of its referents as words, joined by "and".
pub(crate) fn base_object(query: &Query) -> String {
    let names: Vec<String> = query.referents.iter().map(|name| name.replace('_', " ")).collect();
    names.join(" and ")
}

fn masks_of(path: &Path, truth: &Truth, query: &Query) -> Result<BTreeMap<u32, Mask>, DataError> {
    if let Some(name) = query.referents.iter().find(|name| truth.instance(name).is_none()) {
        let hint = "give the truth and the queries of one benchmark";
        return Err(DataError::invalid(path, format!("instance {name}"), "is not in the truth", hint));
    }
    let mask = |&frame: &u32| Some((frame, target::union(truth, &query.referents, frame)?));
    Ok(truth.frames.iter().filter_map(mask).collect())
}
