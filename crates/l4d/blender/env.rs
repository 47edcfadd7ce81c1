//! The Python environment that runs Blender: what it has to hold, and what to do where it does not.
//!
//! bpy 4.5 runs on Python 3.11 alone. How the environment is made is not known here.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result};
use serde::Deserialize;

use crate::cli::scenes::PythonArgs;
use crate::out::{Printer, refusal};
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

/// What an interpreter has.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Probe {
    pub(crate) version: String,
    pub(crate) modules: std::collections::BTreeMap<String, String>,
    pub(crate) errors: std::collections::BTreeMap<String, String>,
}

/// An interpreter that has everything the Blender scripts import.
#[derive(Debug, Clone)]
pub(crate) struct BlenderEnv {
    python: PathBuf,
    scripts: PathBuf,
}

impl BlenderEnv {
    /// The interpreter that the user named, or the project's own environment, made if it is missing.
    pub(crate) fn find_or_make(args: &PythonArgs, out: &Printer) -> Result<Self> {
        let scripts = scripts_folder(&args.blender_scripts)?;
        let python = match &args.python {
            Some(python) => python.clone(),
            None => environment(&scripts, &args.work).find_or_make(out)?,
        };
        require_modules(&python)?;
        Ok(Self { python, scripts })
    }

    /// A command that runs the project's Python package.
    pub(crate) fn command(&self) -> Command {
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
    pub(crate) fn scripts(&self) -> &Path {
        &self.scripts
    }
}

/// Where the project's own environment stands (whether or not it exists).
pub(crate) fn environment_python(scripts: &Path, work: &Path) -> Result<PathBuf> {
    environment(scripts, work).python()
}

/// Asks an interpreter for its version and modules.
pub(crate) fn probe(python: &Path) -> Result<Probe> {
    let output = Command::new(python)
        .env("PYTHONNOUSERSITE", "1")
        .args(["-c", PROBE])
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("cannot run {}", python.display()))?;
    let stdout = String::from_utf8_lossy(&output.stdout);
    let line = stdout.lines().find_map(|line| line.strip_prefix("L4D"));
    let line = line.with_context(|| {
        format!("{} did not answer: {}", python.display(), String::from_utf8_lossy(&output.stderr).trim())
    })?;
    Ok(serde_json::from_str(line)?)
}

/// What to do about a module that does not load.
pub(crate) fn import_remedy(module: &str, error: &str) -> String {
    if let Some(library) = missing_library(error) {
        let package = debian_package(library);
        return format!("install the system library {library} (Debian, Ubuntu: apt-get install {package})");
    }
    if module == "bpy" && error.contains("No module named") {
        return format!(
            "bpy needs Python {PYTHON_VERSION}; leave out --python and l4d makes an environment, or pip install -r blender_scripts/requirements.txt there"
        );
    }
    "pip install -r blender_scripts/requirements.txt in that environment, or leave out --python".to_owned()
}

/// The folder of the Blender scripts, absolute.
pub(crate) fn scripts_folder(scripts: &Path) -> Result<PathBuf> {
    if !scripts.join("l4d_blender").is_dir() {
        return Err(refusal(
            format!("{}: the folder of the Blender scripts is not there", scripts.display()),
            "run l4d in the project's root folder, or name the folder with --blender-scripts",
        ));
    }
    // Workers run elsewhere on a relative path's behalf, so it is made absolute once.
    std::path::absolute(scripts).with_context(|| format!("cannot resolve {}", scripts.display()))
}

/// The project's own environment.
fn environment(scripts: &Path, work: &Path) -> Environment {
    Environment {
        requirements: scripts.join("requirements.txt"),
        kind_folder: work.join("blender-env"),
        name: "the Blender environment",
        holds: "bpy, usd-core, OpenEXR; about 1 GB, and 2 GB while it is made",
    }
}

fn require_modules(python: &Path) -> Result<()> {
    let probe = probe(python).map_err(|error| {
        refusal(
            format!("{error:#}"),
            format!("name a working Python {PYTHON_VERSION} with --python, or leave it out"),
        )
    })?;
    match probe.errors.first_key_value() {
        None => Ok(()),
        Some((module, error)) => Err(refusal(
            format!("{} (Python {}) cannot import {module}: {error}", python.display(), probe.version),
            import_remedy(module, error),
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
        assert!(import_remedy("bpy", error).contains("apt-get install libxfixes3"));
    }

    #[test]
    fn a_wrong_interpreter_is_told_from_a_missing_one() {
        assert!(probe(Path::new("/nonexistent/python")).unwrap_err().to_string().contains("cannot run"));
        assert!(probe(Path::new("/bin/true")).unwrap_err().to_string().contains("did not answer"));
    }
}
