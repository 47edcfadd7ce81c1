//! The instances of a scene, and what they do.

use std::collections::BTreeMap;

use l4d_data::scene;
use pyo3::prelude::*;

/// One annotated thing; the same id in every camera, frame and profile.
#[pyclass(frozen, module = "l4d")]
#[derive(Debug)]
pub(crate) struct Instance(scene::Instance);

impl From<&scene::Instance> for Instance {
    fn from(instance: &scene::Instance) -> Self {
        Self(instance.clone())
    }
}

#[pymethods]
impl Instance {
    /// Its value in `Frame.id`: 1 to 999 objects, 1001 to 32767 landmarks.
    #[getter]
    fn id(&self) -> u32 {
        self.0.id
    }

    /// Unique in the scene.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// `"object"` (queries may refer to it) or `"landmark"` (only named in relations).
    #[getter]
    fn role(&self) -> &'static str {
        match self.0.role {
            scene::Role::Object => "object",
            scene::Role::Landmark => "landmark",
        }
    }

    /// Common noun.
    #[getter]
    fn category(&self) -> &str {
        &self.0.category
    }

    /// Visible properties, for example `{"colour": "red"}`.
    #[getter]
    fn attributes(&self) -> BTreeMap<String, String> {
        self.0.attributes.clone()
    }

    /// Axis of its box that points forward (`"-y"`), or None where it has no front.
    #[getter]
    fn front(&self) -> Option<&str> {
        self.0.front.as_deref()
    }

    fn __repr__(&self) -> String {
        format!("Instance({}, '{}', '{}')", self.0.id, self.0.name, self.0.category)
    }
}

/// What an instance does, alone or to another.
#[pyclass(frozen, module = "l4d")]
#[derive(Debug)]
pub(crate) struct Event(scene::Event);

impl From<&scene::Event> for Event {
    fn from(event: &scene::Event) -> Self {
        Self(event.clone())
    }
}

#[pymethods]
impl Event {
    /// Name of who acts.
    #[getter]
    fn subject(&self) -> &str {
        &self.0.subject
    }

    /// What it does, base form.
    #[getter]
    fn verb(&self) -> &str {
        &self.0.verb
    }

    /// Name of whom it is done to; None for actions.
    #[getter]
    fn object(&self) -> Option<&str> {
        self.0.object.as_deref()
    }

    /// First and last canonical frame, both inclusive.
    #[getter]
    fn interval(&self) -> (u32, u32) {
        (self.0.frames.first(), self.0.frames.last())
    }

    fn __repr__(&self) -> String {
        let object = self.0.object.as_ref().map(|object| format!(" {object}")).unwrap_or_default();
        let (first, last) = self.interval();
        format!("Event({} {}{object}, {first} to {last})", self.0.subject, self.0.verb)
    }
}
