//! `--grounder-file`: which segmenter is started, any program or one of the workers that come with the project, and
//! how it works together with a model.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use l4d_data::{DataError, toml_file};
use serde::Deserialize;

use crate::vlm::{Coupling, Settings};
use crate::worker::Launch;

/// A grounder's file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrounderFile {
    coupling: NamedCoupling,
    segmenter: SegmenterEntry,
    /// How the model is asked.
    #[serde(default)]
    pub model: Settings,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum NamedCoupling {
    Text,
    Box,
    Pick,
    NoVlm,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmenterEntry {
    /// One of [`OURS`].
    worker: Option<String>,
    /// What runs it, in place of an environment that l4d makes.
    python: Option<PathBuf>,
    /// Folder of the package `l4d_workers` and its requirements.
    package: Option<PathBuf>,
    /// Any other worker.
    program: Option<PathBuf>,
    #[serde(default)]
    arguments: Vec<String>,
    #[serde(default)]
    environment: BTreeMap<String, String>,
    #[serde(default)]
    threshold: f64,
}

/// What a worker of ours needs beside Python.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Needs {
    Nothing,
    /// What `requirements.txt` pins.
    Networks,
    /// An environment of the user's own.
    Checkout,
}

const OURS: [(&str, Needs); 5] = [
    ("null", Needs::Nothing),
    ("box", Needs::Nothing),
    ("sam2-hf", Needs::Networks),
    ("sam3-hf", Needs::Networks),
    ("samwise", Needs::Checkout),
];

impl GrounderFile {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or has another form.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        toml_file::read(path, "see docs/workers.md for the fields of a grounder's file")
    }

    /// How model and segmenter work together; none where no model is asked.
    pub fn coupling(&self) -> Option<Coupling> {
        match self.coupling {
            NamedCoupling::Text => Some(Coupling::Text),
            NamedCoupling::Box => Some(Coupling::Box),
            NamedCoupling::Pick => Some(Coupling::Pick),
            NamedCoupling::NoVlm => None,
        }
    }

    /// Least score of an object that is kept, 0 to 1.
    pub fn threshold(&self) -> f64 {
        self.segmenter.threshold
    }

    /// How the segmenter is started. `path` is that of the file; `ours` is the folder of the project's workers where the
    /// file names none; `python_of` makes the environment of a package of
    /// workers that need networks, on demand.
    ///
    /// # Errors
    /// The fields of `[segmenter]` contradict each other, or name what is not there.
    pub fn launch<E: From<DataError>>(
        &self,
        path: &Path,
        ours: &Path,
        python_of: impl FnOnce(&Path) -> Result<PathBuf, E>,
    ) -> Result<Launch, E> {
        let entry = &self.segmenter;
        let wrong = |field: &str, message: String, hint: &str| -> E {
            DataError::invalid(path, format!("field `segmenter.{field}`"), message, hint).into()
        };
        let worker = match (&entry.worker, &entry.program) {
            (Some(worker), None) => worker,
            (None, Some(program)) => {
                let strays = [("python", entry.python.is_some()), ("package", entry.package.is_some())];
                return match strays.into_iter().find(|(_, is_given)| *is_given) {
                    Some((field, _)) => Err(wrong(
                        field,
                        "means nothing beside `program`".to_owned(),
                        "leave it out, or name one of the project's workers with `worker`",
                    )),
                    None => Ok(Launch {
                        program: program.clone(),
                        arguments: entry.arguments.iter().map(OsString::from).collect(),
                        environment: entry.variables([]),
                    }),
                };
            }
            _ => {
                return Err(wrong(
                    "worker",
                    "is beside `program`, or neither is there".to_owned(),
                    "name one of the project's workers with `worker`, or any other with `program`",
                ));
            }
        };
        let Some((_, needs)) = OURS.into_iter().find(|(name, _)| name == worker) else {
            let known = OURS.map(|(name, _)| name).join(", ");
            let message = format!("is `{}`", worker.escape_debug());
            return Err(wrong("worker", message, &format!("choose among {known}, or name a `program`")));
        };
        let package = entry.package.as_deref().unwrap_or(ours);
        if !package.join("l4d_workers").is_dir() {
            let message = format!("the package of the workers is not there: {}", package.display());
            let hint =
                "run l4d in the project's root folder, or name the folder with `package` below [segmenter]";
            return Err(wrong("package", message, hint));
        }
        let package =
            std::path::absolute(package).map_err(|source| DataError::io(package, "resolve", source))?;
        let program = match (&entry.python, needs) {
            (Some(python), _) => python.clone(),
            (None, Needs::Nothing) => PathBuf::from("python3"),
            (None, Needs::Networks) => python_of(&package)?,
            (None, Needs::Checkout) => {
                let message = format!("is missing, but {worker} runs in the environment of its checkout");
                return Err(wrong("python", message, "name the Python of that environment"));
            }
        };
        let module = ["-m", "l4d_workers", worker].into_iter().map(OsString::from);
        let environment = entry.variables([
            ("PYTHONPATH", package.into_os_string()),
            ("PYTHONDONTWRITEBYTECODE", "1".into()),
            ("PYTHONNOUSERSITE", "1".into()),
        ]);
        let arguments = module.chain(entry.arguments.iter().map(OsString::from)).collect();
        Ok(Launch { program, arguments, environment })
    }
}

impl SegmenterEntry {
    /// Variables of the user's own go over the usual ones.
    fn variables<const N: usize>(&self, usual: [(&str, OsString); N]) -> BTreeMap<String, OsString> {
        let own = self.environment.iter().map(|(name, value)| (name.as_str(), value.into()));
        usual.into_iter().chain(own).map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<GrounderFile, DataError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grounder.toml");
        std::fs::write(&path, text).unwrap();
        GrounderFile::read(&path)
    }

    #[test]
    fn couplings_are_named_and_others_refused() {
        let file =
            read("coupling = \"no-vlm\"\n[segmenter]\nprogram = \"seg\"\narguments = [\"a\"]").unwrap();
        assert_eq!((file.coupling(), file.model), (None, Settings::default()));
        let launch = file
            .launch(Path::new("x"), Path::new("workers"), |_| unreachable!())
            .map_err(|error: DataError| error);
        assert_eq!(launch.unwrap().arguments, ["a"]);
        let error = read("coupling = \"boxes\"\n[segmenter]\nworker = \"box\"").unwrap_err().to_string();
        assert!(error.contains("`boxes`") && error.contains("`no-vlm`"), "{error}");
    }
}
