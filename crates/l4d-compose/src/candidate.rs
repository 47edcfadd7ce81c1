//! A query without a sentence: what it means, of whom, when.

use l4d_data::query::{Provenance, Source, text_digest};
use l4d_data::{Category, Interval, Name, Query, QueryId, Status, Temporal};
use l4d_query::Predicate;
use l4d_query::prove::Kind;

/// A predicate that a scene may be asked about.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// What it is expected to be.
    pub kind: Kind,
    /// What it means.
    pub predicate: Predicate,
    /// The object meant; none of an absent one.
    pub referent: Option<Name>,
    /// How it binds time.
    pub temporal: Temporal,
    /// When it holds.
    pub frames: Vec<Interval>,
    /// The forms of its clauses: `at_end relation on`.
    pub shapes: Vec<String>,
    /// What its clauses are about, whatever their forms: `on tray`.
    pub cores: Vec<String>,
    /// How long or strange its sentence gets; the plainest cost 1.
    pub price: f64,
}

impl Candidate {
    /// The kinds of reasoning that it asks for.
    pub fn categories(&self) -> Vec<Category> {
        self.predicate.categories()
    }

    /// The line of the benchmark's file that it becomes with a sentence.
    ///
    /// # Errors
    /// A predicate that is no JSON.
    pub fn query(&self, id: QueryId, text: &str) -> Result<Query, serde_json::Error> {
        let predicate = serde_json::to_value(&self.predicate)?;
        Ok(Query {
            id,
            text: text.to_owned(),
            categories: self.categories(),
            referents: self.referent.iter().cloned().collect(),
            temporal: self.temporal,
            frames: self.frames.clone(),
            text_digest: text_digest(text, Some(&predicate)),
            predicate: Some(predicate),
            provenance: Provenance { source: Source::Composed, note: String::new() },
            status: Status::Candidate,
        })
    }
}
