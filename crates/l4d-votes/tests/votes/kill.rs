//! `kill -9` at any moment loses no vote that was acknowledged: this test runs itself as the annotator.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use l4d_data::{Interval, Temporal};
use l4d_votes::{Ballot, Event, Round, RoundDir, Seen};

use crate::support::{self, Asked, interval, meaning, name, objects};

const INSIDE: &str = "L4D_TEST_VOTE_UNTIL_KILLED";

#[test]
fn no_acknowledged_vote_is_lost() {
    if let Some(dir) = std::env::var_os(INSIDE) {
        return vote_forever(Path::new(&dir));
    }
    let folder = tempfile::tempdir().unwrap();
    let dir = RoundDir::new(folder.path().join("r1"));
    let asked = Asked {
        scene: "room".to_owned(),
        text: "The cat".to_owned(),
        category: "action",
        meaning: meaning(&["a"], Temporal::Whole, Interval::WHOLE),
    };
    support::write(&dir, &["ada"], "unanimous:1", "any", &[asked]);
    let round = Round::open(&dir).unwrap();
    let mut before = 0;
    for kill in 0..12 {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "--nocapture", "kill::no_acknowledged_vote_is_lost"])
            .env(INSIDE, dir.root())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        let acknowledged =
            |line: &String| line.strip_prefix("took ").map(|number| number.parse::<u32>().unwrap());
        let mut last = lines.find_map(|line| acknowledged(&line)).unwrap();
        std::thread::sleep(Duration::from_micros(1700 * kill));
        child.kill().unwrap();
        last = lines.filter_map(|line| acknowledged(&line)).last().unwrap_or(last);
        child.wait().unwrap();

        let (ballot, _) = Ballot::open(&dir, &round, &name("ada")).unwrap();
        let kept = ballot.answer(&round.items[0].id).unwrap().frames.first();
        // The vote whose acknowledgement was on its way may be there as well.
        assert!(kept == last || kept == last + 1, "{kept} is on the disk, {last} was acknowledged");
        assert!(last > before, "nothing happened in run {kill}");
        before = kept;
    }
}

/// Votes for frame after frame and says so only when it is taken.
fn vote_forever(dir: &Path) {
    let dir = RoundDir::new(dir);
    let round = Round::open(&dir).unwrap();
    let (mut ballot, _) = Ballot::open(&dir, &round, &name("ada")).unwrap();
    let item = round.items[0].id.clone();
    let mut out = std::io::stdout();
    let first = ballot.answer(&item).map_or(0, |answer| answer.frames.first());
    for frame in first + 1..first + 1_000_000 {
        let answer = l4d_votes::Answer { choice: objects(&["a"]), frames: interval(frame, frame) };
        ballot.record(&item, Event::Choose(answer), Seen::default(), Duration::ZERO).unwrap();
        writeln!(out, "took {frame}").unwrap();
    }
}
