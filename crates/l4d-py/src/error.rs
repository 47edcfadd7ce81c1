//! From errors of the project to the one exception of the package, `l4d.L4dError`: message, path, field, remedy.

use std::error::Error;
use std::fmt::Display;
use std::path::{Path, PathBuf};

use l4d_data::{DataError, Name};
use l4d_frames::exr::FrameError;
use pyo3::PyErr;
use pyo3::import_exception;

import_exception!(l4d._error, L4dError);

/// What a function of this crate gives.
pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// Why Python gets an exception.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Something that the project can explain.
    Details(Box<Details>),
    /// An exception that Python raised itself.
    Python(PyErr),
}

/// The attributes of an `L4dError`.
#[derive(Debug, Default)]
pub(crate) struct Details {
    message: String,
    path: Option<PathBuf>,
    field: Option<String>,
    remedy: Option<String>,
}

impl Failure {
    /// A value that the caller gave and that cannot be.
    pub(crate) fn argument(field: &str, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        let details =
            Details { field: Some(field.to_owned()), ..Details::new(message.into(), remedy.into()) };
        Self::Details(Box::new(details))
    }

    /// Something about a file.
    pub(crate) fn file(path: &Path, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        let details = Details { path: Some(path.to_owned()), ..Details::new(message.into(), remedy.into()) };
        Self::Details(Box::new(details))
    }

    /// An error whose message says everything, causes included.
    pub(crate) fn of_chain(error: &dyn Error) -> Self {
        let mut message = error.to_string();
        let mut source = error.source();
        while let Some(cause) = source {
            message.push_str(&format!(": {cause}"));
            source = cause.source();
        }
        Self::Details(Box::new(Details { message, ..Details::default() }))
    }
}

impl Details {
    fn new(message: String, remedy: String) -> Self {
        Self { message, remedy: Some(remedy), ..Self::default() }
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        let remedy = error.hint();
        let path = Some(error.path().to_owned());
        let (field, message) = match error {
            DataError::Io { action, source, .. } => (None, format!("cannot {action}: {source}")),
            DataError::Format { location, message, .. } | DataError::Invalid { location, message, .. } => {
                (Some(location), message)
            }
        };
        Self::Details(Box::new(Details { message, path, field, remedy }))
    }
}

impl From<FrameError> for Failure {
    fn from(error: FrameError) -> Self {
        DataError::from(error).into()
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Details(details) => {
                let Details { message, path, field, remedy } = *details;
                L4dError::new_err((message, path.map(|path| path.display().to_string()), field, remedy))
            }
            Failure::Python(error) => error,
        }
    }
}

/// A name that becomes a file name.
pub(crate) fn name(field: &str, text: &str) -> Result<Name> {
    let remedy = "choose another name";
    Name::new(text).map_err(|error| Failure::argument(field, error.to_string(), remedy))
}

/// An argument that is none of `known`.
pub(crate) fn unknown(field: &str, given: impl Display, known: &[&str]) -> Failure {
    let given = l4d_data::error::inert(&given.to_string());
    Failure::argument(field, format!("there is no `{given}`"), format!("choose among {}", known.join(", ")))
}
