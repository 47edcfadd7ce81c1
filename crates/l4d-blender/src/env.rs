//! The Python environment that runs Blender: what it has to hold, and what to do where it does not.
//! bpy 4.5 runs on Python 3.11 alone.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use l4d_data::workspace::SharedWork;
use l4d_data::{DataError, Progress, StageError};
use serde::Deserialize;

use crate::Result;
use crate::python::{Environment, PYTHON_VERSION};

/// Asks an interpreter what it has; import errors are data, not failures.
const PROBE: &str = r#"
import importlib, json, sys
found = {"version": "%d.%d.%d" % sys.version_info[:3], "modules": {}, "errors": {}}
for module in ("bpy", "OpenEXR", "pxr", "numpy"):
    try:
        loaded = importlib.import_module(module)
        if module == "bpy":
            version = loaded.app.version_string
        elif module == "pxr":
            from pxr import Usd
            version = ".".join(map(str, Usd.GetVersion()))
        else:
            version = getattr(loaded, "__version__", "?")
        found["modules"][module] = version
    except BaseException as error:
        found["errors"][module] = "%s: %s" % (type(error).__name__, error)
print("L4D" + json.dumps(found))
sys.stdout.flush()
import os
os._exit(0)
"#;

/// The Python that runs Blender, as the user chose it.
#[derive(Debug, Clone)]
pub struct PythonChoice {
    /// An interpreter with everything installed; none for the project's own environment.
    pub python: Option<PathBuf>,
    /// Folder of the Blender scripts.
    pub scripts: PathBuf,
    /// Folder for what can be remade.
    pub work: SharedWork,
}

/// What an interpreter has.
#[derive(Debug, Clone, Deserialize)]
pub struct Probe {
    pub version: String,
    /// Module -> version.
    pub modules: std::collections::BTreeMap<String, String>,
    /// Module -> why it does not load.
    pub errors: std::collections::BTreeMap<String, String>,
}

/// An interpreter that has everything the Blender scripts import.
#[derive(Debug, Clone)]
pub struct BlenderEnv {
    python: PathBuf,
    scripts: PathBuf,
}

impl BlenderEnv {
    /// The interpreter that the user named, or the project's own environment, made if it is missing.
    ///
    /// # Errors
    /// Scripts that are not there, or an interpreter that cannot import what they need.
    pub fn find_or_make(choice: &PythonChoice, progress: &dyn Progress) -> Result<Self> {
        let scripts = scripts_folder(&choice.scripts)?;
        let python = match &choice.python {
            Some(python) => python.clone(),
            None => environment(&scripts, &choice.work).find_or_make(progress)?,
        };
        require_modules(&python, &scripts)?;
        Ok(Self { python, scripts })
    }

    /// A command that runs the project's Python package.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.python);
        // A fixed hash seed and no user site: the same scripts see the same Python everywhere.
        command
            .env("PYTHONPATH", &self.scripts)
            .env("PYTHONHASHSEED", "0")
            .env("PYTHONNOUSERSITE", "1")
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .args(["-m", "l4d_blender"]);
        command
    }

    /// Folder of the Blender scripts.
    pub fn scripts(&self) -> &Path {
        &self.scripts
    }
}

/// Where the project's own environment is, whether or not it exists.
///
/// # Errors
/// Requirements that cannot be read.
pub fn environment_python(scripts: &Path, work: &SharedWork) -> Result<PathBuf> {
    environment(scripts, work).python()
}

/// Asks an interpreter for its version and modules.
///
/// # Errors
/// An interpreter that does not run or does not answer.
pub fn probe(python: &Path) -> Result<Probe> {
    let refuse = |message: String| {
        let hint = format!("name a working Python {PYTHON_VERSION} with --python, or leave it out");
        StageError::new(message, hint)
    };
    let output = Command::new(python)
        .env("PYTHONNOUSERSITE", "1")
        .args(["-c", PROBE])
        .stdin(Stdio::null())
        .output()
        .map_err(|error| refuse(format!("{}: cannot run: {error}", python.display())))?;
    let stdout = String::from_utf8_lossy(&output.stdout);
    let line = stdout.lines().find_map(|line| line.strip_prefix("L4D"));
    line.and_then(|line| serde_json::from_str(line).ok()).ok_or_else(|| {
        let said = String::from_utf8_lossy(&output.stderr);
        refuse(format!("{} did not answer: {}", python.display(), said.trim()))
    })
}

/// What to do about a module that does not load.
pub fn import_hint(module: &str, error: &str, scripts: &Path) -> String {
    if let Some(library) = missing_library(error) {
        let package = debian_package(library);
        return format!("install the system library {library} (Debian, Ubuntu: apt-get install {package})");
    }
    let install = format!("pip install -r {}", scripts.join("requirements.txt").display());
    if module == "bpy" && error.contains("No module named") {
        return format!(
            "bpy needs Python {PYTHON_VERSION}; leave out --python and l4d makes an environment, or {install} there"
        );
    }
    format!("{install} in that environment, or leave out --python")
}

/// The folder of the Blender scripts, absolute.
///
/// # Errors
/// A folder that does not hold them.
pub fn scripts_folder(scripts: &Path) -> Result<PathBuf> {
    if !scripts.join("l4d_blender").is_dir() {
        return Err(StageError::new(
            format!("{}: the folder of the Blender scripts is not there", scripts.display()),
            "run l4d in the project's root folder, or name the folder with --blender-scripts",
        ));
    }
    // Workers run elsewhere on a relative path's behalf, so it is made absolute once.
    Ok(std::path::absolute(scripts).map_err(|error| DataError::io(scripts, "resolve", error))?)
}

/// The project's own environment.
fn environment(scripts: &Path, work: &SharedWork) -> Environment {
    Environment {
        requirements: scripts.join("requirements.txt"),
        kind_folder: work.blender_environments(),
        name: "the Blender environment",
        holds: "bpy, usd-core, OpenEXR; about 1 GB, and 2 GB while it is made",
    }
}

fn require_modules(python: &Path, scripts: &Path) -> Result<()> {
    let probe = probe(python)?;
    match probe.errors.first_key_value() {
        None => Ok(()),
        Some((module, error)) => Err(StageError::new(
            format!("{} (Python {}) cannot import {module}: {error}", python.display(), probe.version),
            import_hint(module, error, scripts),
        )),
    }
}

fn missing_library(error: &str) -> Option<&str> {
    let (before, _) = error.split_once(": cannot open shared object file")?;
    before.rsplit([' ', ':']).next()
}

fn debian_package(library: &str) -> &'static str {
    let known = [
        ("libX11", "libx11-6"),
        ("libXrender", "libxrender1"),
        ("libXfixes", "libxfixes3"),
        ("libXi", "libxi6"),
        ("libXxf86vm", "libxxf86vm1"),
        ("libxkbcommon", "libxkbcommon0"),
        ("libEGL", "libegl1"),
        ("libGL", "libgl1"),
    ];
    known
        .into_iter()
        .find(|(stem, _)| library.starts_with(stem))
        .map_or("libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libgl1", |(_, package)| package)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_system_library_names_its_package() {
        let error = "ImportError: libXfixes.so.3: cannot open shared object file: No such file or directory";
        assert!(import_hint("bpy", error, Path::new("scripts")).contains("apt-get install libxfixes3"));
    }

    #[test]
    fn a_wrong_interpreter_is_told_from_a_missing_one() {
        assert!(probe(Path::new("/nonexistent/python")).unwrap_err().to_string().contains("cannot run"));
        assert!(probe(Path::new("/bin/true")).unwrap_err().to_string().contains("did not answer"));
    }
}
