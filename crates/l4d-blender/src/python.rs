//! Python environments, each made once and kept. An environment is named by the digest of its pinned requirements, so
//! that a changed pin makes a new one; an interrupted installation is never taken for a whole one.

use std::ffi::OsStr;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use l4d_data::digest::sha256_file;
use l4d_data::store::{make_folder, write_atomic};
use l4d_data::{DataError, Progress, StageError};

use crate::Result;

/// The Python that the pins are for.
pub const PYTHON_VERSION: &str = "3.11";

/// An environment, whether or not it exists.
#[derive(Debug, Clone)]
pub struct Environment {
    /// What is installed into it.
    pub requirements: PathBuf,
    /// Folder of all environments of its kind.
    pub kind_folder: PathBuf,
    /// What people call it.
    pub name: &'static str,
    /// What it holds, and how much room that takes.
    pub holds: &'static str,
}

impl Environment {
    /// Its interpreter, whether or not it exists.
    ///
    /// # Errors
    /// Requirements that cannot be read.
    pub fn python(&self) -> Result<PathBuf> {
        Ok(self.folder()?.join("bin").join("python"))
    }

    /// Its interpreter, once everything is installed.
    ///
    /// # Errors
    /// A missing Python, or an installation that fails, with the end of what it said.
    pub fn find_or_make(&self, progress: &dyn Progress) -> Result<PathBuf> {
        let (folder, python) = (self.folder()?, self.python()?);
        let complete = folder.join("complete");
        if complete.exists() {
            return Ok(python);
        }
        let parent = folder.parent().unwrap_or(&self.kind_folder);
        make_folder(parent)?;
        let lock_path = parent.join("lock");
        let lock = File::create(&lock_path).map_err(|error| DataError::io(&lock_path, "create", error))?;
        lock.lock().map_err(|error| DataError::io(&lock_path, "lock", error))?;
        if complete.exists() {
            return Ok(python);
        }
        if folder.exists() {
            std::fs::remove_dir_all(&folder).map_err(|error| DataError::io(&folder, "remove", error))?;
        }
        progress.note(&format_args!("making {} in {} ({})", self.name, folder.display(), self.holds));
        self.install(&folder, &python)?;
        write_atomic(&complete, b"")?;
        Ok(python)
    }

    fn folder(&self) -> Result<PathBuf> {
        let digest = sha256_file(&self.requirements)?;
        let parent = std::path::absolute(&self.kind_folder)
            .map_err(|error| DataError::io(&self.kind_folder, "resolve", error))?;
        Ok(parent.join(&digest[..12]))
    }

    fn install(&self, folder: &Path, python: &Path) -> Result<()> {
        let uv = beside_program_or_on_path("uv");
        if let Some(uv) = uv.iter().find(|uv| runs(uv, ["--version"])) {
            self.step(
                uv,
                [OsStr::new("venv"), "--python".as_ref(), PYTHON_VERSION.as_ref(), folder.as_os_str()],
            )?;
            let install = [
                OsStr::new("pip"),
                "install".as_ref(),
                "--python".as_ref(),
                python.as_os_str(),
                "-r".as_ref(),
                self.requirements.as_os_str(),
            ];
            return self.step(uv, install);
        }
        let base = self.base_python()?;
        self.step(&base, [OsStr::new("-m"), "venv".as_ref(), folder.as_os_str()])?;
        let install = ["-m", "pip", "install", "--disable-pip-version-check", "--no-input", "--quiet", "-r"];
        let install = install.map(OsStr::new).into_iter().chain([self.requirements.as_os_str()]);
        self.step(python, install)
    }

    fn base_python(&self) -> Result<PathBuf> {
        let version = "import sys; sys.exit('%d.%d' % sys.version_info[:2] != sys.argv[1])";
        let is_right = |python: &PathBuf| runs(python, ["-c", version, PYTHON_VERSION]);
        let names = ["python3.11", "python3", "python"].into_iter();
        names.flat_map(beside_program_or_on_path).find(is_right).ok_or_else(|| {
            StageError::new(
                format!("no Python {PYTHON_VERSION} on PATH, which {} is pinned for", self.name),
                "install it (Debian 12: apt-get install python3.11 python3.11-venv), or install uv, which brings its own",
            )
        })
    }

    fn step<'a>(&self, program: &Path, args: impl IntoIterator<Item = &'a OsStr>) -> Result<()> {
        let mut command = Command::new(program);
        command.args(args).stdin(Stdio::null());
        let output = command.output().map_err(|error| DataError::io(program, "run", error))?;
        if output.status.success() {
            return Ok(());
        }
        let talk = [output.stdout, output.stderr].concat();
        let talk = String::from_utf8_lossy(&talk).into_owned();
        let tail: Vec<&str> = talk.lines().rev().take(8).collect();
        let tail: Vec<&str> = tail.into_iter().rev().collect();
        let hint = if talk.contains("ensurepip") {
            "install the venv module (Debian, Ubuntu: apt-get install python3.11-venv), or install uv"
                .to_owned()
        } else if talk.contains("No space left") {
            format!("free some disk ({}), or choose another --work folder", self.holds)
        } else {
            "check the network and the package index, or prepare an environment yourself and name its Python"
                .to_owned()
        };
        Err(StageError::new(
            format!("{} could not make {}:\n{}", program.display(), self.name, tail.join("\n")),
            hint,
        ))
    }
}

/// A program as the environment has it that l4d was installed into, which need not be active, and as it is on the path.
fn beside_program_or_on_path(name: &str) -> Vec<PathBuf> {
    let beside =
        std::env::current_exe().ok().map(|l4d| l4d.with_file_name(name)).filter(|path| path.is_file());
    beside.into_iter().chain([PathBuf::from(name)]).collect()
}

fn runs<const N: usize>(program: &Path, args: [&str; N]) -> bool {
    let silent = Command::new(program)
        .args(args)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    silent.is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use l4d_data::Silent;

    use super::*;

    fn environment(folder: &Path, requirements: &str) -> Environment {
        std::fs::write(folder.join("requirements.txt"), requirements).unwrap();
        Environment {
            requirements: folder.join("requirements.txt"),
            kind_folder: folder.join("work/some-env"),
            name: "a test environment",
            holds: "nothing",
        }
    }

    #[test]
    fn it_is_made_once_and_again_for_other_pins() {
        let folder = tempfile::tempdir().unwrap();
        let first = environment(folder.path(), "# nothing\n");
        let python = first.find_or_make(&Silent).unwrap();
        assert!(runs(&python, ["-c", "import json"]));
        let mark = python.with_file_name("mark");
        std::fs::write(&mark, "").unwrap();
        assert_eq!(first.find_or_make(&Silent).unwrap(), python);
        assert!(mark.exists(), "it was not made again");

        // One that was interrupted is made again from the start.
        std::fs::remove_file(python.parent().unwrap().parent().unwrap().join("complete")).unwrap();
        first.find_or_make(&Silent).unwrap();
        assert!(!mark.exists());
        assert_ne!(environment(folder.path(), "# nothing else\n").python().unwrap(), python);
    }

    #[test]
    fn what_cannot_be_installed_is_told_and_not_taken_for_whole() {
        let folder = tempfile::tempdir().unwrap();
        let broken = environment(folder.path(), "./no/such/package\n");
        let error = broken.find_or_make(&Silent).unwrap_err();
        assert!(error.to_string().contains("could not make a test environment"), "{error:#}");
        assert!(broken.find_or_make(&Silent).is_err());
    }
}
