//! A sentence, what it means and when.

use l4d_data::{self as data, QueryId, Status, Temporal};
use pyo3::prelude::*;

use crate::error::{Failure, Result};

/// One sentence of the benchmark.
#[pyclass(frozen, module = "l4d")]
#[derive(Debug)]
pub(crate) struct Query(pub(crate) data::Query);

#[pymethods]
impl Query {
    /// `<scene>/<nnn>`.
    #[getter]
    fn id(&self) -> String {
        self.0.id.to_string()
    }

    /// Name of its scene.
    #[getter]
    fn scene(&self) -> &str {
        &self.0.id.scene
    }

    /// The sentence.
    #[getter]
    fn text(&self) -> &str {
        &self.0.text
    }

    /// One of `"attribute"`, `"action"`, `"spatial"`, `"interaction"`, or two for a composite.
    #[getter]
    fn categories(&self) -> Vec<&'static str> {
        self.0.categories.iter().map(|category| category.as_str()).collect()
    }

    /// Names of the instances that it means: the answer. A method must not look at them.
    #[getter]
    fn referents(&self) -> Vec<&str> {
        self.0.referents.iter().map(|name| name.as_str()).collect()
    }

    /// `"whole"` (names an identity: the referent counts in the whole clip) or `"while"` (counts only in `intervals`).
    #[getter]
    fn temporal(&self) -> &'static str {
        match self.0.temporal {
            Temporal::Whole => "whole",
            Temporal::While => "while",
        }
    }

    /// When it holds: first and last canonical frames, both inclusive. Part of the answer.
    #[getter]
    fn intervals(&self) -> Vec<(u32, u32)> {
        self.0.frames.iter().map(|interval| (interval.first(), interval.last())).collect()
    }

    /// The machine-readable meaning (docs/queries.md) as dicts and lists, or None. Part of the answer.
    #[getter]
    fn predicate<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>> {
        json_to_python(py, &self.0.predicate)
    }

    /// `"candidate"` (proved by machine), `"verified"` (by people too) or `"rejected"` (by people; never scored).
    #[getter]
    fn status(&self) -> &'static str {
        match self.0.status {
            Status::Candidate => "candidate",
            Status::Verified => "verified",
            Status::Rejected => "rejected",
        }
    }

    /// Whether the sentence holds at a canonical frame.
    fn holds_at(&self, frame: u32) -> bool {
        self.0.holds_at(frame)
    }

    fn __repr__(&self) -> String {
        format!("Query('{}', {:?})", self.0.id, self.0.text)
    }
}

/// A query, or its id as text.
pub(crate) fn query_id(value: &Bound<'_, PyAny>) -> Result<QueryId> {
    if let Ok(query) = value.cast::<Query>() {
        return Ok(query.get().0.id.clone());
    }
    let refuse =
        |message: String| Failure::argument("query", message, "give a Query, or an id like \"room/003\"");
    let Ok(text) = value.extract::<String>() else {
        return Err(refuse(format!("is a {}", value.get_type())));
    };
    text.parse().map_err(|error: data::query::QueryIdError| refuse(error.to_string()))
}

/// A document as Python's own `json` reads it: numbers keep every bit.
pub(crate) fn json_to_python<'py>(
    py: Python<'py>,
    value: &impl serde::Serialize,
) -> Result<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| Failure::of_chain(&error))?;
    Ok(py.import("json")?.call_method1("loads", (text,))?)
}
