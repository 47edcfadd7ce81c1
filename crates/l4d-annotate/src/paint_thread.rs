//! The thread that paints: requests in, pictures out, and the latest request wins.
//!
//! A request voids the one before that is still being painted, but never two in a row: while a key is held down,
//! pictures still pass.

use std::collections::VecDeque;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::thread::JoinHandle;

use crate::error::in_full;
use crate::message::Message;
use crate::painter::Painter;
use crate::picture::{ExportRequest, PictureRequest};

enum Task {
    /// A picture, and frames that are likely to be asked for next.
    Paint(PictureRequest, Vec<u32>),
    Export(ExportRequest),
}

/// A painter on a thread of its own, which ends when this is dropped.
pub(crate) struct PaintThread {
    tasks: Option<mpsc::Sender<Task>>,
    thread: Option<JoinHandle<()>>,
}

impl PaintThread {
    /// Starts the thread; it answers through `send`, and calls `died` if it panics.
    pub(crate) fn open(
        painter: Painter,
        send: impl Fn(Message) + Send + 'static,
        died: impl Fn() + Send + 'static,
    ) -> Self {
        let (tasks, inbox) = mpsc::channel();
        let work = move || {
            let _alarm = Alarm(died);
            let (request, exports) = (None, VecDeque::new());
            Worker { painter, inbox, request, exports, send: &send, gave_up: false }.run();
        };
        Self { tasks: Some(tasks), thread: Some(std::thread::spawn(work)) }
    }

    /// Asks for a picture instead of the one that was asked for before.
    pub(crate) fn paint(&self, request: PictureRequest, ahead: Vec<u32>) {
        self.ask(Task::Paint(request, ahead));
    }

    /// Asks for a file.
    pub(crate) fn export(&self, request: ExportRequest) {
        self.ask(Task::Export(request));
    }

    fn ask(&self, task: Task) {
        // A thread that died has raised the alarm.
        self.tasks.as_ref().map(|tasks| tasks.send(task).ok());
    }
}

impl Drop for PaintThread {
    fn drop(&mut self) {
        self.tasks = None;
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

/// Calls when it is dropped by a panic.
struct Alarm<F: Fn()>(F);

impl<F: Fn()> Drop for Alarm<F> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            (self.0)();
        }
    }
}

struct Worker<'a> {
    painter: Painter,
    inbox: Receiver<Task>,
    /// The latest request, and the exports, that were taken out of the inbox.
    request: Option<(PictureRequest, Vec<u32>)>,
    exports: VecDeque<ExportRequest>,
    send: &'a dyn Fn(Message),
    /// Whether the last request was voided.
    gave_up: bool,
}

impl Worker<'_> {
    fn run(mut self) {
        while self.take_in() {
            if let Some((request, ahead)) = self.request.take() {
                self.paint(&request);
                self.decode_ahead(&request, &ahead);
            } else if let Some(request) = self.exports.pop_front() {
                let outcome = self.export(&request);
                (self.send)(Message::Exported(outcome));
            } else if let Ok(task) = self.inbox.recv() {
                self.sort(task);
            }
        }
    }

    /// Empties the inbox; false when the thread has to end.
    fn take_in(&mut self) -> bool {
        loop {
            match self.inbox.try_recv() {
                Ok(task) => self.sort(task),
                Err(error) => return error == TryRecvError::Empty,
            }
        }
    }

    fn sort(&mut self, task: Task) {
        match task {
            Task::Paint(request, ahead) => self.request = Some((request, ahead)),
            Task::Export(request) => self.exports.push_back(request),
        }
    }

    fn paint(&mut self, request: &PictureRequest) {
        if let Some(picture) = self.painter.recall(request) {
            return (self.send)(Message::Painted(picture));
        }
        let key = (request.scene.clone(), request.view.clone(), request.frame);
        let shown = self.painter.frame(&key).map_err(|error| in_full(&error));
        if !self.gave_up && self.is_void() {
            self.gave_up = true;
            return;
        }
        self.gave_up = false;
        let painted = shown.and_then(|shown| self.painter.paint(request, &shown));
        (self.send)(match painted {
            Ok(picture) => Message::Painted(picture),
            Err(why) => Message::NotPainted(request.clone(), why),
        });
    }

    fn decode_ahead(&mut self, request: &PictureRequest, ahead: &[u32]) {
        for &frame in ahead {
            if self.is_void() {
                return;
            }
            // What cannot be read will be reported when it is asked for.
            self.painter.frame(&(request.scene.clone(), request.view.clone(), frame)).ok();
        }
    }

    /// Whether something else is wanted by now.
    fn is_void(&mut self) -> bool {
        !self.take_in() || self.request.is_some()
    }

    fn export(&mut self, request: &ExportRequest) -> Result<String, String> {
        let path = self.painter.export(request).map_err(|error| in_full(&error))?;
        Ok(match open(&path) {
            true => format!("Opened {}", path.display()),
            false => format!("Wrote {}", path.display()),
        })
    }
}

/// Hands a file to the desktop, if there is one.
fn open(path: &Path) -> bool {
    let has = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let program = if cfg!(target_os = "macos") {
        "open"
    } else if has("DISPLAY") || has("WAYLAND_DISPLAY") {
        "xdg-open"
    } else {
        return false;
    };
    let silent = Stdio::null;
    let child = Command::new(program).arg(path).stdin(silent()).stdout(silent()).stderr(silent()).spawn();
    let Ok(mut child) = child else { return false };
    // Its end has to be waited for, and it may live for hours.
    std::thread::spawn(move || child.wait());
    true
}

#[cfg(test)]
mod tests;
