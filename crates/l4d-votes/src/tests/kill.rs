//! `kill -9` at any moment loses no vote that was acknowledged.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Command, Stdio};
use std::time::Duration;

use l4d_data::{Interval, Temporal};

use crate::fixture::{folder, interval, meaning, name, objects, round_and_key, save};
use crate::{Answer, Ballot, Event, Round, RoundDir, ShownFrames};

const ROUND_FOLDER: &str = "L4D_TEST_VOTE_UNTIL_KILLED";

#[test]
fn no_acknowledged_vote_is_lost() {
    let (_folder, dir) = folder();
    let cat = meaning(&["a"], Temporal::Whole, Interval::WHOLE);
    let (round, key) = round_and_key(&["ada"], vec![("room".to_owned(), "The cat".to_owned(), cat)]);
    save(&dir, &round, &key);
    let mut before = 0;
    for kill in 0..12 {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "--ignored", "--nocapture", "tests::kill::an_annotator_votes_until_killed"])
            .env(ROUND_FOLDER, dir.root())
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
        let kept = ballot.response(&round.items[0].id).unwrap().answer.unwrap().frames.first();
        // The vote whose acknowledgement was on its way may be there as well.
        assert!(kept == last || kept == last + 1, "{kept} is on the disk, {last} was acknowledged");
        assert!(last > before, "nothing happened in run {kill}");
        before = kept;
    }
}

/// Votes for frame after frame and says so only when it is taken.
#[test]
#[ignore = "the process that the test above kills"]
fn an_annotator_votes_until_killed() {
    let dir = RoundDir::new(std::env::var_os(ROUND_FOLDER).unwrap());
    let round = Round::open(&dir).unwrap();
    let (mut ballot, _) = Ballot::open(&dir, &round, &name("ada")).unwrap();
    let item = round.items[0].id.clone();
    let mut out = std::io::stdout();
    let first = ballot.response(&item).unwrap().answer.map_or(0, |answer| answer.frames.first());
    for frame in first + 1..first + 1_000_000 {
        let answer = Answer { choice: objects(&["a"]), frames: interval(frame, frame) };
        ballot.record(&item, Event::Choose(answer), ShownFrames::default(), Duration::ZERO).unwrap();
        writeln!(out, "took {frame}").unwrap();
    }
}
