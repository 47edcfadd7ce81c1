use std::time::Duration;

use l4d_data::Finding;
use l4d_data::digest::sha256_hex;

use super::*;
use crate::fixture::{items, name, noon, round_of, whole};
use crate::line::write_line;
use crate::vote::{Choice, Event, ShownFrames};

/// A log of `ada` in `r1`, written line by line without a [`crate::Ballot`].
#[derive(Default)]
struct Log {
    lines: Vec<Vec<u8>>,
}

impl Log {
    /// Adds a line that claims to be of another log, number or time.
    fn with(mut self, change: impl FnOnce(&mut (Name, Name, u64, SystemTime)), act: Act) -> Self {
        let seq = self.lines.len() as u64;
        let prev = self.lines.last().map_or_else(|| NO_LINE.to_owned(), |line| digest_of(line));
        let mut place = (name("r1"), name("ada"), seq, noon() + Duration::from_secs(seq));
        change(&mut place);
        let (round, annotator, seq, at) = place;
        self.lines.push(write_line((&round, &annotator), seq, at, &prev, &act));
        self
    }

    fn then(self, act: Act) -> Self {
        self.with(|_| (), act)
    }

    fn raw(mut self, text: &str) -> Self {
        self.lines.push(text.as_bytes().to_vec());
        self
    }

    fn sealed(self) -> Self {
        let act = Act::Seal { lines: self.lines.len() as u64, sha256: sha256_hex(&self.lines.concat()) };
        self.then(act)
    }

    fn replay(&self) -> Replay {
        replay_bytes(&self.lines.concat())
    }
}

fn round() -> Round {
    round_of(&["ada"], items("room", &["The cat", "The dog"]))
}

fn replay_bytes(bytes: &[u8]) -> Replay {
    replay(Path::new("ada.jsonl"), bytes, &round(), &name("ada"))
}

fn on(item: &str, event: Event) -> Act {
    let id: ItemId = item.parse().unwrap();
    let digest = round().item(&id).map_or_else(String::new, |item| item.digest.clone());
    Act::On { item: id, order: 1, digest, event, seen: ShownFrames::default(), elapsed: Duration::ZERO }
}

fn choose(item: &str) -> Act {
    on(item, Event::Choose(whole(Choice::None)))
}

fn findings(replay: &Replay) -> Vec<Finding> {
    replay.report.clone().into_sorted()
}

fn codes_and_places(replay: &Replay) -> Vec<(&'static str, String)> {
    findings(replay).into_iter().map(|finding| (finding.code, finding.location)).collect()
}

fn answers(replay: &Replay) -> [bool; 2] {
    let round = round();
    [0, 1].map(|index| replay.history.response(&round.items[index]).answer.is_some())
}

#[test]
fn a_whole_log_adds_up() {
    let replay = Log::default().then(choose("q0001")).then(choose("q0002")).sealed().replay();
    assert_eq!(findings(&replay), []);
    assert_eq!((answers(&replay), replay.sealed, replay.lines), ([true, true], true, 3));
}

#[test]
fn nothing_at_all_is_an_empty_log() {
    let replay = replay_bytes(b"");
    assert_eq!((findings(&replay), replay.last.as_str(), replay.whole), (Vec::new(), NO_LINE, 0));
}

#[test]
fn every_torn_tail_leaves_the_lines_before_it() {
    let log = Log::default().then(choose("q0001")).then(choose("q0002"));
    let bytes = log.lines.concat();
    let first = log.lines[0].len();
    for length in first + 1..bytes.len() {
        let replay = replay_bytes(&bytes[..length]);
        assert_eq!(replay.whole, first);
        assert_eq!(answers(&replay), [true, false]);
        assert_eq!(codes_and_places(&replay), [(codes::TORN_LINE, "line 2".to_owned())]);
    }
    let zeroed = [&bytes[..first], &[0; 100]].concat();
    assert_eq!(replay_bytes(&zeroed).whole, first);
}

#[test]
fn nothing_counts_from_an_edited_line_on() {
    let log = Log::default().then(choose("q0001")).then(choose("q0002")).then(on("q0001", Event::Undo));
    for (number, from, to) in [(1, "q0001", "q0002"), (2, "none", "NONE"), (2, "l4d ", "l4e ")] {
        let mut edited = Log { lines: log.lines.clone() };
        let line = String::from_utf8(edited.lines[number - 1].clone()).unwrap();
        edited.lines[number - 1] = line.replace(from, to).into_bytes();
        let replay = edited.replay();
        assert_eq!(replay.edited.as_ref().map(|(line, _)| *line), Some(number), "{from}");
        assert_eq!(answers(&replay), [number > 1, false]);
        assert_eq!(codes_and_places(&replay), [(codes::EDITED, format!("line {number}"))]);
    }
}

#[test]
fn removed_inserted_and_swapped_lines_are_edits() {
    let log = Log::default().then(choose("q0001")).then(choose("q0002")).then(choose("q0001"));
    let edit = |change: &dyn Fn(&mut Vec<Vec<u8>>)| {
        let mut lines = log.lines.clone();
        change(&mut lines);
        Log { lines }.replay().edited.map(|(line, _)| line)
    };
    assert_eq!(edit(&|lines| drop(lines.remove(0))), Some(1));
    assert_eq!(edit(&|lines| drop(lines.remove(1))), Some(1));
    assert_eq!(edit(&|lines| lines.swap(0, 1)), Some(1));
    assert_eq!(edit(&|lines| lines.swap(1, 2)), Some(1));
    assert_eq!(edit(&|lines| lines.insert(1, b"\n".to_vec())), Some(2));
    assert_eq!(edit(&|lines| lines.insert(0, b"\xff\xfe\n".to_vec())), Some(1));
    assert_eq!(edit(&|lines| lines.push(b"[1, 2]\n".to_vec())), Some(4));
    assert_eq!(edit(&|lines| lines.push(lines[2].clone())), Some(3));
}

#[test]
fn a_line_that_skips_a_number_is_an_edit() {
    let replay = Log::default().then(choose("q0001")).with(|place| place.2 = 5, choose("q0002")).replay();
    assert_eq!(replay.edited.map(|(line, _)| line), Some(2));
}

#[test]
fn lines_about_something_else_are_left_out_one_by_one() {
    let replay = Log::default()
        .with(|place| place.0 = name("r2"), choose("q0001"))
        .with(|place| place.1 = name("ben"), choose("q0001"))
        .then(choose("q0009"))
        .then(on("q0001", Event::Undo))
        .then(choose("q0002"))
        .replay();
    assert_eq!(answers(&replay), [false, true]);
    let expected = [(codes::FOREIGN_LINE, 1), (codes::UNKNOWN_ITEM, 3), (codes::IDLE_UNDO, 4)];
    assert_eq!(codes_and_places(&replay), expected.map(|(code, line)| (code, format!("line {line}"))));
    assert!(findings(&replay)[0].message.contains("and 1 more line)"), "{:?}", findings(&replay)[0]);
}

#[test]
fn a_clock_that_goes_backwards_is_said_and_forgiven() {
    let replay = Log::default()
        .then(choose("q0001"))
        .with(|place| place.3 = noon() - Duration::from_secs(60), choose("q0002"))
        .then(on("q0002", Event::Skip))
        .replay();
    assert_eq!(answers(&replay), [true, false]);
    assert_eq!(codes_and_places(&replay), [(codes::CLOCK_BACKWARDS, "line 2".to_owned())]);
}

#[test]
fn lines_of_another_version_are_kept_and_named() {
    let newer = format!("{{\"v\":2,\"seq\":0,\"prev\":\"{NO_LINE}\",\"mood\":\"fine\"}}\n");
    let odd = Log::default().raw(&newer).then(choose("q0002"));
    let replay = odd.replay();
    assert_eq!(answers(&replay), [false, true]);
    assert_eq!(codes_and_places(&replay), [(codes::UNREADABLE_LINE, "line 1".to_owned())]);
    assert!(findings(&replay)[0].message.contains("version 2"));
    let date = String::from_utf8(Log::default().then(choose("q0001")).lines.concat()).unwrap();
    let replay = replay_bytes(date.replace("2023-11-14T", "yesterday ").as_bytes());
    assert_eq!(codes_and_places(&replay), [(codes::UNREADABLE_LINE, "line 1".to_owned())]);
}

#[test]
fn nothing_counts_after_the_seal() {
    let replay = Log::default().then(choose("q0001")).sealed().then(choose("q0002")).sealed().replay();
    assert!(replay.sealed);
    assert_eq!(answers(&replay), [true, false]);
    assert_eq!(codes_and_places(&replay), [(codes::AFTER_SEAL, "line 3".to_owned())]);
    let junk = Log::default().then(choose("q0001")).sealed().raw("junk\n").replay();
    assert!(junk.sealed);
}

#[test]
fn a_seal_that_does_not_fit_seals_nothing() {
    let seal = |lines, sha256: &str| Act::Seal { lines, sha256: sha256.to_owned() };
    let first = Log::default().then(choose("q0001"));
    let digest = sha256_hex(&first.lines[0]);
    for wrong in [seal(1, "00"), seal(2, &digest)] {
        let replay = Log { lines: first.lines.clone() }.then(wrong).then(choose("q0002")).replay();
        assert!(!replay.sealed);
        assert_eq!(answers(&replay), [true, true]);
        assert_eq!(codes_and_places(&replay), [(codes::BROKEN_SEAL, "line 2".to_owned())]);
    }
    assert!(first.then(seal(1, &digest)).replay().sealed);
}

#[test]
fn garbage_is_read_no_further_than_its_first_line_and_reaches_no_terminal() {
    let replay = replay_bytes(&vec![b'\n'; 64 << 20]);
    assert_eq!((replay.edited.map(|(line, _)| line), replay.lines), (Some(1), 0));
    let deep = format!("{}\n", "[".repeat(1 << 20));
    assert!(replay_bytes(deep.as_bytes()).edited.is_some());
    let escape = format!("{{\"v\":1,\"seq\":0,\"prev\":\"{NO_LINE}\",\"\\u001b[2J\":0}}\n");
    let replay = replay_bytes(escape.as_bytes());
    let finding = findings(&replay).remove(0);
    assert_eq!(finding.code, codes::UNREADABLE_LINE);
    assert!(!finding.message.contains('\u{1b}'), "{:?}", finding.message);
}
