//! One worker: a child process that speaks JSON Lines on stdout and logs to a file on stderr.

use std::fs::{File, OpenOptions};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use l4d_data::store::make_folder;
use l4d_data::{DataError, StageError};
use serde::Deserialize;

use crate::Result;

/// What a worker says.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub(crate) enum WorkerEvent {
    /// It is up, on this device.
    Start {
        #[serde(default)]
        device: String,
    },
    /// A picture is on disk.
    Image { view: String, frame: u32 },
    /// Worth telling the user.
    Warning { message: String },
    /// It gives up, and why.
    Error {
        message: String,
        #[serde(default)]
        hint: String,
    },
    /// A draw of a composition was thrown away.
    Rejected { draw: u32, reason: String },
    /// A draw of a composition became a scene.
    Composed { draw: u32 },
    /// All layouts of an arrangement are on disk, by this worker or before.
    Arranged { seed: u64, made: bool },
    /// What compositions draw from.
    Theme { scale: String, name: String, places: Vec<String>, categories: Vec<String>, verbs: Vec<String> },
    /// Everything that was asked for is done.
    Done,
    /// An event that this version does not know.
    #[serde(other)]
    Other,
}

/// How a worker ended.
#[derive(Debug)]
pub(crate) enum WorkerEnd {
    /// It did everything.
    Done,
    /// The caller stopped it.
    Stopped,
    /// It gave up with a reason of its own: trying again would end the same way.
    Refused(StageError),
    /// It ended without an error event (killed, out of memory, crashed).
    Died(StageError),
}

/// Kills the child when the supervisor leaves early.
struct Reaper(Child);

impl Drop for Reaper {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// Runs a worker to its end. `on_event` sees each event and says whether to go on.
pub(crate) fn run(
    mut command: Command,
    log: &Path,
    on_event: &mut dyn FnMut(&WorkerEvent) -> bool,
) -> Result<WorkerEnd> {
    // The worker holds the other end of its stdin: when this process dies, it reads the end and leaves.
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(open_log(log)?);
    let program = PathBuf::from(command.get_program());
    let failed = |action| move |error| DataError::io(&program, action, error);
    let mut child = Reaper(command.spawn().map_err(failed.clone()("start"))?);
    let stdout = child.0.stdout.take();
    let mut reason = None;
    let mut done = false;
    for line in stdout.into_iter().flat_map(|stdout| BufReader::new(stdout).lines()) {
        // A line that is cut or no JSON comes from a library; the exit status says how the worker ended.
        let line = line.map_err(failed.clone()("read from"))?;
        let Ok(event) = serde_json::from_str(&line) else { continue };
        match &event {
            WorkerEvent::Error { message, hint } => {
                reason = Some(StageError::new(message.clone(), hint.clone()));
            }
            WorkerEvent::Done => done = true,
            _ => {}
        }
        if !on_event(&event) {
            return Ok(WorkerEnd::Stopped);
        }
    }
    let status = child.0.wait().map_err(failed("wait for"))?;
    Ok(match reason {
        Some(reason) => WorkerEnd::Refused(reason),
        None if status.success() && done => WorkerEnd::Done,
        None => WorkerEnd::Died(StageError::new(
            format!("the Blender worker ended early ({status}); the end of its log:\n{}", tail(log)),
            format!("see {}; if memory ran out, use fewer --jobs; what is rendered is kept", log.display()),
        )),
    })
}

fn open_log(log: &Path) -> Result<File> {
    make_folder(log.parent().unwrap_or(Path::new(".")))?;
    let open = OpenOptions::new().create(true).append(true).open(log);
    Ok(open.map_err(|error| DataError::io(log, "open", error))?)
}

fn tail(log: &Path) -> String {
    let text = std::fs::read(log).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(8)..].join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run_shell(script: &str) -> (WorkerEnd, Vec<WorkerEvent>) {
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        let mut events = Vec::new();
        let end = run(command, &folder.path().join("worker.log"), &mut |event| {
            events.push(event.clone());
            true
        });
        (end.unwrap(), events)
    }

    #[test]
    fn events_are_read_and_foreign_lines_skipped() {
        let script = r#"echo '{"event":"start","device":"CPU"}'; echo 'Fra:1 Mem:2'; echo '{"event":"image","view":"cam00","frame":4,"seconds":0.5}'; echo '{"event":"news"}'; echo '{"event":"done"}'"#;
        let (end, events) = run_shell(script);
        assert!(matches!(end, WorkerEnd::Done), "{end:?}");
        assert_eq!(events[1], WorkerEvent::Image { view: "cam00".into(), frame: 4 });
        assert_eq!(events.len(), 4);
    }

    #[test]
    fn a_worker_that_dies_differs_from_one_that_refuses() {
        let (end, _) = run_shell("echo 'out of memory' >&2; kill -9 $$");
        assert!(
            matches!(&end, WorkerEnd::Died(error) if error.to_string().contains("out of memory")),
            "{end:?}"
        );
        let (end, _) = run_shell(r#"echo '{"event":"error","message":"no such scene","hint":"x"}'; exit 2"#);
        assert!(matches!(&end, WorkerEnd::Refused(error) if error.to_string() == "no such scene"), "{end:?}");
    }

    #[test]
    fn an_exit_without_done_is_no_success() {
        let (end, _) = run_shell("exit 0");
        assert!(matches!(end, WorkerEnd::Died(_)), "{end:?}");
    }
}
