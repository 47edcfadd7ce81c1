//! The thread that paints: requests in, pictures out, and the latest request wins.
//!
//! A request voids the one before that is still being painted, but never two in a row: while a key is held down,
//! pictures still pass.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use crate::error::in_full;
use crate::message::Message;
use crate::painter::Painter;
use crate::picture::{ExportRequest, PictureRequest};

/// What waits to be done.
#[derive(Default)]
struct Inbox {
    request: Option<(PictureRequest, Vec<u32>)>,
    exports: VecDeque<ExportRequest>,
    stop: bool,
}

#[derive(Default)]
struct Shared {
    inbox: Mutex<Inbox>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Inbox> {
        // The inbox is whole between any two statements that hold the lock.
        self.inbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A painter on a thread of its own.
pub(crate) struct PaintThread {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// One thing to do, taken out of the inbox.
enum Task {
    Paint(PictureRequest, Vec<u32>),
    Export(ExportRequest),
}

impl PaintThread {
    /// Starts the thread; it answers through `send`, and calls `died` if it panics.
    pub(crate) fn open(
        painter: Painter,
        send: impl Fn(Message) + Send + 'static,
        died: impl Fn() + Send + 'static,
    ) -> Self {
        let shared = Arc::new(Shared::default());
        let inbox = Arc::clone(&shared);
        let work = move || {
            let _alarm = Alarm(died);
            Worker { painter, shared: &inbox, send: &send, gave_up: false }.run();
        };
        Self { shared, thread: Some(std::thread::spawn(work)) }
    }

    /// Asks for a picture instead of the one that was asked for before.
    pub(crate) fn paint(&self, request: PictureRequest, ahead: Vec<u32>) {
        self.shared.lock().request = Some((request, ahead));
        self.shared.changed.notify_one();
    }

    /// Asks for a file.
    pub(crate) fn export(&self, request: ExportRequest) {
        self.shared.lock().exports.push_back(request);
        self.shared.changed.notify_one();
    }
}

impl Drop for PaintThread {
    fn drop(&mut self) {
        self.shared.lock().stop = true;
        self.shared.changed.notify_one();
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
    shared: &'a Shared,
    send: &'a dyn Fn(Message),
    /// Whether the last request was voided.
    gave_up: bool,
}

impl Worker<'_> {
    fn run(mut self) {
        while let Some(task) = self.next() {
            match task {
                Task::Paint(request, ahead) => {
                    self.paint(&request);
                    self.decode_ahead(&request, &ahead);
                }
                Task::Export(request) => (self.send)(Message::Exported(self.export(&request))),
            }
        }
    }

    /// Waits for something to do; none when the thread ends.
    fn next(&self) -> Option<Task> {
        let mut inbox = self.shared.lock();
        loop {
            if inbox.stop {
                return None;
            }
            if let Some((request, ahead)) = inbox.request.take() {
                return Some(Task::Paint(request, ahead));
            }
            if let Some(request) = inbox.exports.pop_front() {
                return Some(Task::Export(request));
            }
            inbox = self.shared.changed.wait(inbox).unwrap_or_else(PoisonError::into_inner);
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
    fn is_void(&self) -> bool {
        let inbox = self.shared.lock();
        inbox.stop || inbox.request.is_some()
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
    let path: PathBuf = path.to_owned();
    let silent = Stdio::null;
    let child = Command::new(program).arg(path).stdin(silent()).stdout(silent()).stderr(silent()).spawn();
    let Ok(mut child) = child else { return false };
    // Its end has to be waited for, and it may live for hours.
    std::thread::spawn(move || child.wait());
    true
}

#[cfg(test)]
mod tests;
