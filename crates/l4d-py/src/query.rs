//! Sentences, and the instances and events of scenes.

use std::collections::BTreeMap;

use l4d_data::{self as data, QueryId, scene};
use pyo3::prelude::*;
use serde::Serialize;
use serde_json::Value;

use crate::error::{Failure, Result};

/// One sentence of the benchmark.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Query {
    /// `<scene>/<nnn>`.
    #[pyo3(get)]
    id: String,
    /// Name of its scene.
    #[pyo3(get)]
    scene: String,
    /// The sentence.
    #[pyo3(get)]
    text: String,
    /// One of `"attribute"`, `"action"`, `"spatial"`, `"interaction"`, or two for a composite.
    #[pyo3(get)]
    categories: Vec<&'static str>,
    /// Names of the instances that it means: the answer. A method must not look at them.
    #[pyo3(get)]
    referents: Vec<String>,
    /// `"whole"` (names an identity: the referent counts in the whole clip) or `"while"` (counts only in `intervals`).
    #[pyo3(get)]
    temporal: String,
    /// When it holds: first and last canonical frames, both inclusive. Part of the answer.
    #[pyo3(get)]
    intervals: Vec<(u32, u32)>,
    /// `"candidate"` (proved by machine), `"verified"` (by people too) or `"rejected"` (by people; never scored).
    #[pyo3(get)]
    status: &'static str,
    query: data::Query,
}

impl From<data::Query> for Query {
    fn from(query: data::Query) -> Self {
        Self {
            id: query.id.to_string(),
            scene: query.id.scene.to_string(),
            text: query.text.clone(),
            categories: query.categories.iter().map(|category| category.as_str()).collect(),
            referents: query.referents.iter().map(|name| name.to_string()).collect(),
            temporal: word(&query.temporal),
            intervals: query.frames.iter().map(|interval| (interval.first(), interval.last())).collect(),
            status: query.status.as_str(),
            query,
        }
    }
}

#[pymethods]
impl Query {
    /// The machine-readable meaning (docs/queries.md) as dicts and lists, or None. Part of the answer.
    #[getter]
    fn predicate<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>> {
        json_to_python(py, &self.query.predicate)
    }

    /// Whether the sentence holds at a canonical frame.
    fn holds_at(&self, frame: u32) -> bool {
        self.query.holds_at(frame)
    }

    fn __repr__(&self) -> String {
        format!("Query('{}', {:?})", self.id, self.text)
    }
}

/// A query, or its id as text.
pub(crate) fn query_id(value: &Bound<'_, PyAny>) -> Result<QueryId> {
    if let Ok(query) = value.cast::<Query>() {
        return Ok(query.get().query.id.clone());
    }
    let refuse =
        |message: String| Failure::argument("query", message, "give a Query, or an id like \"room/003\"");
    let Ok(text) = value.extract::<String>() else {
        return Err(refuse(format!("is a {}", value.get_type())));
    };
    text.parse().map_err(|error: data::query::QueryIdError| refuse(error.to_string()))
}

/// A document as Python's own `json` reads it: numbers keep every bit.
pub(crate) fn json_to_python<'py>(py: Python<'py>, value: &impl Serialize) -> Result<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| Failure::of_chain(&error))?;
    Ok(py.import("json")?.call_method1("loads", (text,))?)
}

/// The word that means a value in files.
pub(crate) fn word(value: &impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(Value::String(word)) => word,
        _ => String::new(),
    }
}

/// One annotated thing; the same id in every camera, frame and profile.
#[pyclass(frozen, get_all, module = "l4d")]
pub(crate) struct Instance {
    /// Its value in `Frame.id`: 1 to 999 objects, 1001 to 32767 landmarks.
    id: u32,
    /// Unique in the scene.
    name: String,
    /// `"object"` (queries may refer to it) or `"landmark"` (only named in relations).
    role: String,
    /// Common noun.
    category: String,
    /// Visible properties, for example `{"colour": "red"}`.
    attributes: BTreeMap<String, String>,
    /// Axis of its box that points forward (`"-y"`), or None where it has no front.
    front: Option<String>,
}

impl From<&scene::Instance> for Instance {
    fn from(instance: &scene::Instance) -> Self {
        let scene::Instance { id, name, role, category, attributes, front } = instance.clone();
        Self { id, name: name.to_string(), role: word(&role), category, attributes, front }
    }
}

#[pymethods]
impl Instance {
    fn __repr__(&self) -> String {
        format!("Instance({}, '{}', '{}')", self.id, self.name, self.category)
    }
}

/// What an instance does, alone or to another.
#[pyclass(frozen, get_all, module = "l4d")]
pub(crate) struct Event {
    /// Name of who acts.
    subject: String,
    /// What it does, base form.
    verb: String,
    /// Name of whom it is done to; None for actions.
    object: Option<String>,
    /// First and last canonical frame, both inclusive.
    interval: (u32, u32),
}

impl From<&scene::Event> for Event {
    fn from(event: &scene::Event) -> Self {
        Self {
            subject: event.subject.to_string(),
            verb: event.verb.clone(),
            object: event.object.as_ref().map(|name| name.to_string()),
            interval: (event.frames.first(), event.frames.last()),
        }
    }
}

#[pymethods]
impl Event {
    fn __repr__(&self) -> String {
        let object = self.object.as_ref().map(|object| format!(" {object}")).unwrap_or_default();
        let (first, last) = self.interval;
        format!("Event({} {}{object}, {first} to {last})", self.subject, self.verb)
    }
}
