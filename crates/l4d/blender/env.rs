//! The Python environment that runs Blender: found, or made once and kept.
//!
//! bpy 4.5 runs on Python 3.11 alone. The environment is named by the digest of the pinned requirements, so a
//! changed pin makes a new one and an interrupted installation is never taken for a whole one.

use std::ffi::OsStr;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result};
use l4d_data::digest::sha256_file;
use l4d_data::store::{make_folder, write_atomic};
use serde::Deserialize;

use crate::cli::PythonArgs;
use crate::out::{Printer, refusal};

const PYTHON_VERSION: &str = "3.11";
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
            None => make_environment(&scripts, &args.work, out)?,
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
    Ok(environment_folder(scripts, work)?.join("bin").join("python"))
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

fn environment_folder(scripts: &Path, work: &Path) -> Result<PathBuf> {
    let digest = sha256_file(&scripts.join("requirements.txt"))?;
    let work = std::path::absolute(work).with_context(|| format!("cannot resolve {}", work.display()))?;
    Ok(work.join("blender-env").join(&digest[..12]))
}

fn make_environment(scripts: &Path, work: &Path, out: &Printer) -> Result<PathBuf> {
    let folder = environment_folder(scripts, work)?;
    let python = folder.join("bin").join("python");
    let complete = folder.join("complete");
    if complete.exists() {
        return Ok(python);
    }
    let parent = folder.parent().unwrap_or(work);
    make_folder(parent)?;
    let lock_path = parent.join("lock");
    let lock = File::create(&lock_path).with_context(|| format!("cannot create {}", lock_path.display()))?;
    lock.lock().with_context(|| format!("cannot lock {}", lock_path.display()))?;
    if complete.exists() {
        return Ok(python);
    }
    if folder.exists() {
        std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    out.note(format!(
        "making the Blender environment in {} (bpy, usd-core, OpenEXR; about 1 GB)",
        folder.display()
    ));
    install(&folder, &scripts.join("requirements.txt"))?;
    write_atomic(&complete, b"")?;
    Ok(python)
}

fn install(folder: &Path, requirements: &Path) -> Result<()> {
    let python = folder.join("bin").join("python");
    if runs("uv", ["--version"]) {
        run_step(
            "uv",
            [OsStr::new("venv"), "--python".as_ref(), PYTHON_VERSION.as_ref(), folder.as_os_str()],
        )?;
        let install = [
            OsStr::new("pip"),
            "install".as_ref(),
            "--python".as_ref(),
            python.as_os_str(),
            "-r".as_ref(),
            requirements.as_os_str(),
        ];
        return run_step("uv", install);
    }
    let base = base_python()?;
    run_step(&base, [OsStr::new("-m"), "venv".as_ref(), folder.as_os_str()])?;
    let install = ["-m", "pip", "install", "--disable-pip-version-check", "--no-input", "--quiet", "-r"];
    run_step(&python.to_string_lossy(), install.map(OsStr::new).into_iter().chain([requirements.as_os_str()]))
}

fn base_python() -> Result<String> {
    let version = "import sys; sys.exit(sys.version_info[:2] != (3, 11))";
    let found = ["python3.11", "python3", "python"].into_iter().find(|python| runs(python, ["-c", version]));
    found.map(str::to_owned).ok_or_else(|| {
        refusal(
            format!("no Python {PYTHON_VERSION} on PATH, and bpy 4.5 runs on no other"),
            "install it (Debian 12: apt-get install python3.11 python3.11-venv), or install uv, which brings its own",
        )
    })
}

fn runs<const N: usize>(program: &str, args: [&str; N]) -> bool {
    let silent = Command::new(program)
        .args(args)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    silent.is_ok_and(|status| status.success())
}

fn run_step<'a>(program: &str, args: impl IntoIterator<Item = &'a OsStr>) -> Result<()> {
    let mut command = Command::new(program);
    command.args(args).stdin(Stdio::null());
    let output = command.output().with_context(|| format!("cannot run {program}"))?;
    if output.status.success() {
        return Ok(());
    }
    let talk = [output.stdout, output.stderr].concat();
    let talk = String::from_utf8_lossy(&talk).into_owned();
    let tail: Vec<&str> = talk.lines().rev().take(8).collect();
    let tail: Vec<&str> = tail.into_iter().rev().collect();
    let hint = if talk.contains("ensurepip") {
        "install the venv module (Debian, Ubuntu: apt-get install python3.11-venv), or install uv"
    } else if talk.contains("No space left") {
        "free about 2 GB of disk, or choose another --work folder"
    } else {
        "check the network and the package index, or prepare an environment yourself and name it with --python"
    };
    Err(refusal(format!("{program} could not make the Blender environment:\n{}", tail.join("\n")), hint))
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
