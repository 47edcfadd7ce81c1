//! `kill -9` at any moment loses no vote that was acknowledged, and a full disk takes none.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use l4d_data::{Finding, Interval, Temporal};

use crate::fixture::{folder, interval, meaning, name, objects, round_and_key, save};
use crate::{Answer, Ballot, Event, Round, RoundDir, ShownFrames};

const ROUND_FOLDER: &str = "L4D_TEST_VOTE_UNTIL_KILLED";

/// A folder with a round of one item for `ada`.
fn round() -> (tempfile::TempDir, RoundDir, Round) {
    let (folder, dir) = folder();
    let cat = meaning(&["a"], Temporal::Whole, Interval::WHOLE);
    let (round, key) = round_and_key(&["ada"], vec![("room".to_owned(), "The cat".to_owned(), cat)]);
    save(&dir, &round, &key);
    (folder, dir, round)
}

/// A process that votes until it is killed or refused; `command` starts it.
fn voter(mut command: Command, dir: &RoundDir) -> (Child, impl Iterator<Item = String>) {
    let mut child = command
        .args(["--exact", "--ignored", "--nocapture", "ballot::kill::an_annotator_votes_until_killed"])
        .env(ROUND_FOLDER, dir.root())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    (child, lines)
}

fn acknowledged(line: &str) -> Option<u32> {
    line.strip_prefix("took ").map(|number| number.parse().unwrap())
}

/// The last vote that is on the disk.
fn kept(dir: &RoundDir, round: &Round) -> (u32, Vec<Finding>) {
    let (ballot, notices) = Ballot::open(dir, round, &name("ada")).unwrap();
    assert!(!ballot.is_sealed());
    (ballot.response(&round.items[0].id).unwrap().answer.unwrap().frames.first(), notices)
}

#[test]
fn no_acknowledged_vote_is_lost() {
    let (_folder, dir, round) = round();
    let mut before = 0;
    for kill in 0..12 {
        let (mut child, mut lines) = voter(Command::new(std::env::current_exe().unwrap()), &dir);
        let first = lines.find_map(|line| acknowledged(&line)).unwrap();
        std::thread::sleep(Duration::from_micros(1700 * kill));
        child.kill().unwrap();
        let last = lines.filter_map(|line| acknowledged(&line)).last().unwrap_or(first);
        child.wait().unwrap();
        let (kept, _) = kept(&dir, &round);
        // The vote whose acknowledgement was on its way may be there as well.
        assert!(kept == last || kept == last + 1, "{kept} is on the disk, {last} was acknowledged");
        assert!(last > before, "nothing happened in run {kill}");
        before = kept;
    }
}

/// A limit on the size of files acts as a disk that is full in the middle of a line.
#[cfg(unix)]
#[test]
fn a_full_disk_takes_neither_vote_nor_seal_and_the_file_stays_whole() {
    let (_folder, dir, round) = round();
    let mut command = Command::new("sh");
    command
        .args(["-c", "trap '' XFSZ; ulimit -f 5; exec \"$0\" \"$@\""])
        .arg(std::env::current_exe().unwrap());
    let (mut child, lines) = voter(command, &dir);
    let lines: Vec<String> = lines.collect();
    assert!(child.wait().unwrap().success(), "{lines:?}");
    let refused = lines.iter().find(|line| line.contains("so it does not count")).unwrap();
    assert!(refused.ends_with("sealed: false"), "{refused}");
    let last = lines.iter().rev().find_map(|line| acknowledged(line)).unwrap();
    assert_eq!(kept(&dir, &round), (last, Vec::new()));
}

/// Votes for frame after frame and says so only when it is taken.
#[test]
#[ignore = "the process that the tests above start"]
fn an_annotator_votes_until_killed() {
    let dir = RoundDir::new(std::env::var_os(ROUND_FOLDER).unwrap());
    let round = Round::open(&dir).unwrap();
    let (mut ballot, _) = Ballot::open(&dir, &round, &name("ada")).unwrap();
    let item = round.items[0].id.clone();
    let mut out = std::io::stdout();
    let first = ballot.response(&item).unwrap().answer.map_or(0, |answer| answer.frames.first());
    for frame in first + 1..first + 1_000_000 {
        let answer = Answer { choice: objects(&["a"]), frames: interval(frame, frame) };
        let taken = ballot.record(&item, Event::Choose(answer), ShownFrames::default(), Duration::ZERO);
        match taken {
            Ok(()) => writeln!(out, "took {frame}").unwrap(),
            Err(error) => {
                ballot.seal().ok();
                return writeln!(out, "{error}; sealed: {}", ballot.is_sealed()).unwrap();
            }
        }
    }
}
