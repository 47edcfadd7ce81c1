//! `[segmenter]` of a grounder's file: any program, or one of the workers that come with the project.
//!
//! Ours that need networks run in an environment that is made on demand and kept. Nothing else needs it.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use l4d_blender::python::Environment;
use l4d_data::DataError;
use l4d_data::workspace::SharedWork;
use l4d_ground::worker::Launch;
use serde::Deserialize;

use crate::out::{Printer, refusal};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SegmenterEntry {
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
    pub(super) threshold: f64,
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

/// Where the package stands, seen from the project's root folder.
const PACKAGE: &str = "crates/l4d-ground/workers";

impl SegmenterEntry {
    /// How it is started. `path` is the file that it is in, `work` the folder for what can be remade.
    pub(super) fn launch(&self, path: &Path, work: &SharedWork, out: &Printer) -> Result<Launch> {
        match (&self.worker, &self.program) {
            (Some(worker), None) => self.launch_ours(worker, path, work, out),
            (None, Some(program)) => {
                let strays = [("python", self.python.is_some()), ("package", self.package.is_some())];
                match strays.into_iter().find(|(_, is_given)| *is_given) {
                    Some((field, _)) => Err(wrong(
                        path,
                        field,
                        "says nothing to `program`".to_owned(),
                        "leave it out, or name one of the project's workers with `worker`",
                    )),
                    None => Ok(Launch {
                        program: program.clone(),
                        arguments: self.arguments.iter().map(OsString::from).collect(),
                        environment: self.variables(BTreeMap::new()),
                    }),
                }
            }
            _ => Err(wrong(
                path,
                "worker",
                "is beside `program`, or neither is there".to_owned(),
                "name one of the project's workers with `worker`, or any other with `program`",
            )),
        }
    }

    fn launch_ours(&self, worker: &str, path: &Path, work: &SharedWork, out: &Printer) -> Result<Launch> {
        let Some((_, needs)) = OURS.into_iter().find(|(name, _)| *name == worker) else {
            let known = OURS.map(|(name, _)| name).join(", ");
            let message = format!("is `{}`", worker.escape_debug());
            return Err(wrong(
                path,
                "worker",
                message,
                &format!("choose among {known}, or name a `program`"),
            ));
        };
        let package = self.package.as_deref().unwrap_or(Path::new(PACKAGE));
        if !package.join("l4d_workers").is_dir() {
            return Err(refusal(
                format!("{}: the package of the segmenter workers is not there", package.display()),
                "run l4d in the project's root folder, or name the folder with `package` below [segmenter]",
            ));
        }
        let package =
            std::path::absolute(package).with_context(|| format!("cannot resolve {}", package.display()))?;
        let program = match (&self.python, needs) {
            (Some(python), _) => python.clone(),
            (None, Needs::Nothing) => PathBuf::from("python3"),
            (None, Needs::Networks) => environment(&package, work).find_or_make(out)?,
            (None, Needs::Checkout) => {
                return Err(wrong(
                    path,
                    "python",
                    format!("is missing, but {worker} runs in the environment of its checkout"),
                    "name the Python of that environment",
                ));
            }
        };
        let arguments = ["-m", "l4d_workers", worker].into_iter().map(OsString::from);
        let usual = [
            ("PYTHONPATH", package.into_os_string()),
            ("PYTHONDONTWRITEBYTECODE", "1".into()),
            ("PYTHONNOUSERSITE", "1".into()),
        ];
        let usual = usual.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        Ok(Launch {
            program,
            arguments: arguments.chain(self.arguments.iter().map(OsString::from)).collect(),
            environment: self.variables(usual),
        })
    }

    /// Variables of the user's own go over the usual ones.
    fn variables(&self, mut usual: BTreeMap<String, OsString>) -> Vec<(String, OsString)> {
        usual.extend(self.environment.iter().map(|(name, value)| (name.clone(), OsString::from(value))));
        usual.into_iter().collect()
    }
}

fn environment(package: &Path, work: &SharedWork) -> Environment {
    Environment {
        requirements: package.join("requirements.txt"),
        kind_folder: work.worker_environments(),
        name: "the environment of the segmenter workers",
        holds: "torch, transformers; about 6 GB",
    }
}

fn wrong(path: &Path, field: &str, message: String, remedy: &str) -> anyhow::Error {
    DataError::invalid(path, format!("field `segmenter.{field}`"), message, remedy).into()
}
