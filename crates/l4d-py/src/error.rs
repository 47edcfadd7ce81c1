//! From errors of the project to the one exception of the package, `l4d.L4dError`: message, path, field, hint.

use std::error::Error;
use std::fmt::Display;
use std::path::{Path, PathBuf};

use l4d_data::{DataError, Name};
use l4d_frames::exr::FrameError;
use pyo3::{PyErr, import_exception};
use serde::de::DeserializeOwned;

import_exception!(l4d._error, L4dError);

/// What a function of this crate gives.
pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// Why Python gets an exception.
pub(crate) enum Failure {
    /// Something that the project can explain.
    Details(Box<Details>),
    /// An exception that Python raised itself.
    Python(PyErr),
}

/// The attributes of an `L4dError`.
#[derive(Default)]
pub(crate) struct Details {
    message: String,
    path: Option<PathBuf>,
    field: Option<String>,
    hint: Option<String>,
}

impl Failure {
    /// A value that the caller gave and that cannot be.
    pub(crate) fn argument(field: &str, message: impl Into<String>, hint: impl Into<String>) -> Self {
        let (field, hint) = (Some(field.to_owned()), Some(hint.into()));
        Details { message: message.into(), path: None, field, hint }.into()
    }

    /// Something about a file.
    pub(crate) fn file(path: &Path, message: &str, hint: &str) -> Self {
        let (path, hint) = (Some(path.to_owned()), Some(hint.to_owned()));
        Details { message: message.to_owned(), path, field: None, hint }.into()
    }

    /// An error whose message says everything, causes included.
    pub(crate) fn of_chain(error: &dyn Error) -> Self {
        let causes = std::iter::successors(Some(error), |&error| error.source());
        let message = causes.map(|cause| cause.to_string()).collect::<Vec<_>>().join(": ");
        Details { message, ..Details::default() }.into()
    }
}

impl From<Details> for Failure {
    fn from(details: Details) -> Self {
        Self::Details(Box::new(details))
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        let hint = Some(error.hint().to_owned());
        let path = Some(error.path().to_owned());
        let (field, message) = match error {
            DataError::Io { action, source, .. } => (None, format!("cannot {action}: {source}")),
            DataError::Format { location, message, .. } | DataError::Invalid { location, message, .. } => {
                (Some(location), message)
            }
        };
        Details { message, path, field, hint }.into()
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
                let Details { message, path, field, hint } = *details;
                L4dError::new_err((message, path.map(|path| path.display().to_string()), field, hint))
            }
            Failure::Python(error) => error,
        }
    }
}

/// A name that becomes a file name.
pub(crate) fn name(field: &str, text: &str) -> Result<Name> {
    Name::new(text).map_err(|error| Failure::argument(field, error.to_string(), "choose another name"))
}

/// The value that one of the words `known` means in files.
pub(crate) fn choice<T: DeserializeOwned>(field: &str, given: &str, known: &[&str]) -> Result<T> {
    serde_json::from_value(given.into()).ok().ok_or_else(|| unknown(field, given, known))
}

/// An argument that is none of `known`.
pub(crate) fn unknown(field: &str, given: impl Display, known: &[&str]) -> Failure {
    let given = l4d_data::error::inert(&given.to_string());
    Failure::argument(field, format!("there is no `{given}`"), format!("choose among {}", known.join(", ")))
}
