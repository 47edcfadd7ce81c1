//! A terminal for programs that want one: tmux, on a server of its own, with a fresh configuration.

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(60);

/// A tmux server; it and everything in it ends with this value.
pub(crate) struct Tmux {
    folder: tempfile::TempDir,
}

impl Tmux {
    pub(crate) fn new() -> Self {
        let version = Command::new("tmux").arg("-V").output();
        assert!(
            version.is_ok_and(|output| output.status.success()),
            "tmux is missing, and the annotation screen is tested in it: apt-get install tmux, brew install tmux"
        );
        let folder = tempfile::tempdir().unwrap();
        // A finished program stays on the screen, so that its last words can be read, and so does the server.
        let settings =
            "set -g status off\nset -g remain-on-exit on\nset -sg escape-time 0\nset -sg exit-empty off\n";
        std::fs::write(folder.path().join("tmux.conf"), settings).unwrap();
        Self { folder }
    }

    /// Runs a shell command in a new terminal.
    pub(crate) fn start(&self, name: &str, size: (u16, u16), folder: &Path, command: &str) {
        let (columns, rows) = (size.0.to_string(), size.1.to_string());
        let folder = folder.to_str().unwrap();
        let new = ["new-session", "-d", "-s", name, "-x", &columns, "-y", &rows, "-c", folder, command];
        self.succeed(&new);
    }

    /// What is on the screen.
    pub(crate) fn screen(&self, name: &str) -> String {
        self.succeed(&["capture-pane", "-p", "-t", name])
    }

    /// Presses keys by tmux's names (`Enter`, `Left`, `a`).
    pub(crate) fn keys(&self, name: &str, keys: &[&str]) {
        self.succeed(&[&["send-keys", "-t", name], keys].concat());
    }

    /// Types text as it is.
    pub(crate) fn text(&self, name: &str, text: &str) {
        self.succeed(&["send-keys", "-l", "-t", name, text]);
    }

    /// A value that tmux knows of a terminal (`alternate_on`, `pane_pid`).
    pub(crate) fn value(&self, name: &str, variable: &str) -> String {
        self.succeed(&["display-message", "-p", "-t", name, &format!("#{{{variable}}}")]).trim().to_owned()
    }

    /// Waits until the screen is as it should be.
    pub(crate) fn wait(&self, name: &str, what: &str, is_there: impl Fn(&str) -> bool) -> String {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let screen = self.screen(name);
            if is_there(&screen) {
                return screen;
            }
            assert!(Instant::now() < deadline, "{name}: waited in vain for {what}:\n{screen}");
            std::thread::sleep(Duration::from_millis(15));
        }
    }

    /// Waits until the program has ended.
    pub(crate) fn wait_for_end(&self, name: &str) {
        let deadline = Instant::now() + PATIENCE;
        while self.value(name, "pane_dead") != "1" {
            assert!(Instant::now() < deadline, "{name} does not end:\n{}", self.screen(name));
            std::thread::sleep(Duration::from_millis(15));
        }
    }

    pub(crate) fn close(&self, name: &str) {
        self.succeed(&["kill-session", "-t", name]);
    }

    fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "tmux {arguments:?}: {stderr}");
        String::from_utf8(output.stdout).unwrap()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new("tmux")
            .arg("-u")
            .arg("-f")
            .arg(self.folder.path().join("tmux.conf"))
            .args(["-S", self.folder.path().join("socket").to_str().unwrap()])
            .args(arguments)
            .env_remove("TMUX")
            .env_remove("NO_COLOR")
            .output()
            .unwrap()
    }
}

impl Drop for Tmux {
    fn drop(&mut self) {
        self.run(&["kill-server"]);
    }
}
