//! What a Slurm cluster lets one user submit, as its own commands say it.

use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// What `scontrol` and `sacctmgr` say; none where they are not there, don't answer or say that there is no limit.
#[derive(Debug, Default)]
pub struct Limits {
    /// `MaxArraySize`: concerns arrays alone.
    pub array: Option<u64>,
    /// The least `MaxSubmitJobs` of the user's associations.
    pub submit: Option<u64>,
    /// Whether `scontrol` answered: whether this is a cluster.
    pub has_controller: bool,
    /// Whether `sacctmgr` answered: whether there is accounting.
    pub has_accounting: bool,
}

/// A command of a cluster whose controller is down waits for it.
const PATIENCE: Duration = Duration::from_secs(20);

impl Limits {
    /// Asks the cluster.
    pub fn ask(account: Option<&str>) -> Self {
        let config = said(Command::new("scontrol").args(["show", "config"]));
        let mut associations = Command::new("sacctmgr");
        associations.args([
            "--noheader",
            "--parsable2",
            "show",
            "associations",
            "format=MaxSubmitJobs",
            "where",
        ]);
        for variable in ["USER", "LOGNAME"] {
            if let Ok(user) = std::env::var(variable) {
                associations.arg(format!("user={user}"));
                break;
            }
        }
        account.map(|account| associations.arg(format!("account={account}")));
        let associations = said(&mut associations);
        Self {
            array: config.as_deref().and_then(array_size),
            submit: associations.as_deref().and_then(|text| text.lines().filter_map(number).min()),
            has_controller: config.is_some(),
            has_accounting: associations.is_some(),
        }
    }

    /// So many of the wanted jobs may be submitted at once.
    pub fn at_most(&self, wanted: u64) -> u64 {
        self.submit.map_or(wanted, |limit| wanted.min(limit)).max(1)
    }

    /// A sentence each on what was asked.
    pub fn sentences(&self) -> [String; 2] {
        let array = match (self.array, self.has_controller) {
            (Some(size), _) => {
                format!(
                    "MaxArraySize is {size}: it concerns arrays (workflow/l4d.sbatch), which this workflow does not use"
                )
            }
            (None, true) => "`scontrol show config` has no MaxArraySize".to_owned(),
            (None, false) => {
                "`scontrol show config` does not answer here: MaxArraySize is not known".to_owned()
            }
        };
        let submit = match (self.submit, self.has_accounting) {
            (Some(limit), _) => format!("MaxSubmitJobs is {limit}: `jobs` stays within it"),
            (None, true) => "`sacctmgr` names no MaxSubmitJobs for you".to_owned(),
            (None, false) => {
                "`sacctmgr` does not answer here: MaxSubmitJobs is not known; lower `jobs` if the cluster refuses jobs"
                    .to_owned()
            }
        };
        [array, submit]
    }
}

fn array_size(config: &str) -> Option<u64> {
    config.lines().find_map(|line| {
        let (key, value) = line.split_once('=')?;
        (key.trim() == "MaxArraySize").then(|| number(value))?
    })
}

fn number(text: &str) -> Option<u64> {
    text.trim().parse().ok()
}

/// What a command prints that ends well, and in time.
fn said(command: &mut Command) -> Option<String> {
    let streams = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = streams.spawn().ok()?;
    let end = Instant::now() + PATIENCE;
    while child.try_wait().ok()?.is_none() {
        if Instant::now() > end {
            child.kill().ok();
            child.wait().ok();
            return None;
        }
        thread::sleep(Duration::from_millis(20));
    }
    let output = child.wait_with_output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read_and_kept() {
        let config =
            "Configuration data as of 2026-11-27\nMaxArraySize            = 1001\nMaxJobCount = 10000\n";
        assert_eq!(array_size(config), Some(1001));
        assert_eq!(array_size("MaxJobCount = 10000\n"), None);
        let limits = Limits { submit: Some(40), ..Limits::default() };
        assert_eq!((limits.at_most(100), limits.at_most(7)), (40, 7));
        assert_eq!(Limits::default().at_most(100), 100);
    }

    #[test]
    fn a_command_that_fails_or_is_not_there_says_nothing() {
        assert_eq!(said(&mut Command::new("/nonexistent/scontrol")), None);
        assert_eq!(said(Command::new("sh").args(["-c", "echo 7; exit 1"])), None);
        assert_eq!(said(Command::new("sh").args(["-c", "echo 7"])).as_deref(), Some("7\n"));
    }
}
