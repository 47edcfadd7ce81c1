use std::time::Duration;

use l4d_data::Finding;
use l4d_data::digest::sha256_hex;

use super::*;
use crate::fixture::{items, name, noon, round_of, whole};
use crate::line::{SealEvent, Source, write_line};
use crate::vote::{Choice, Event, ShownFrames};

/// A log of `ada` in `r1`, written line by line without a [`crate::Ballot`].
#[derive(Default, Clone)]
struct Log(Vec<Vec<u8>>);

impl Log {
    /// Adds a line that claims to be of another log, number or time.
    fn with(mut self, change: impl FnOnce(&mut (Name, Name, u64, SystemTime)), act: Act) -> Self {
        let seq = self.0.len() as u64;
        let prev = self.0.last().map_or_else(|| NO_LINE.to_owned(), |line| digest_of(line));
        let mut place = (name("r1"), name("ada"), seq, noon() + Duration::from_secs(seq));
        change(&mut place);
        let (round, annotator, seq, at) = place;
        let source = Source { at, ..Source::now() };
        self.0.push(write_line((&round, &annotator), seq, &source, &prev, act));
        self
    }

    fn then(self, act: Act) -> Self {
        self.with(|_| (), act)
    }

    fn raw(mut self, text: &str) -> Self {
        self.0.push(text.as_bytes().to_vec());
        self
    }

    fn sealed(self) -> Self {
        let act = seal(self.0.len() as u64, &sha256_hex(&self.0.concat()));
        self.then(act)
    }

    fn replay(&self) -> Replay {
        replay_bytes(&self.0.concat())
    }
}

fn seal(lines: u64, sha256: &str) -> Act {
    Act::Seal { event: SealEvent::Seal, lines, sha256: sha256.to_owned() }
}

fn round() -> Round {
    round_of(&["ada"], items("room", &["The cat", "The dog"]))
}

fn replay_bytes(bytes: &[u8]) -> Replay {
    replay(Path::new("ada.jsonl"), bytes, &round(), &name("ada"))
}

fn on(item: &str, event: Event) -> Act {
    let item = item.parse().unwrap();
    let digest = round().item(&item).map_or_else(String::new, |item| item.digest.clone());
    Act::On { item, order: 1, digest, event, seen: ShownFrames::default(), elapsed_ms: 0 }
}

fn choose(item: &str) -> Act {
    on(item, Event::Choose(whole(Choice::None)))
}

fn findings(replay: &Replay) -> Vec<Finding> {
    replay.report.clone().into_sorted()
}

/// `L4D510 line 2`, and which of the two items are answered.
fn seen(replay: &Replay) -> (Vec<String>, [bool; 2]) {
    let found = findings(replay).into_iter().map(|finding| format!("{} {}", finding.code, finding.location));
    let round = round();
    (found.collect(), [0, 1].map(|index| replay.history.response(&round.items[index]).answer.is_some()))
}

#[test]
fn what_does_not_count_is_left_out_and_named() {
    let first = || Log::default().then(choose("q0001"));
    let digest = sha256_hex(&first().0[0]);
    let newer = format!("{{\"v\":2,\"seq\":0,\"prev\":\"{NO_LINE}\",\"mood\":\"fine\"}}\n");
    let undated = String::from_utf8(first().0.concat()).unwrap().replace("2023-11-14T", "yesterday ");
    for (log, expected, answered, sealed) in [
        (Log::default(), vec![], [false, false], false),
        (first().then(choose("q0002")).sealed(), vec![], [true, true], true),
        // Lines about something else.
        (
            Log::default().with(|place| place.0 = name("r2"), choose("q0001")),
            vec!["L4D513 line 1"],
            [false; 2],
            false,
        ),
        (
            Log::default().with(|place| place.1 = name("ben"), choose("q0001")),
            vec!["L4D513 line 1"],
            [false; 2],
            false,
        ),
        (first().then(choose("q0009")).then(choose("q0002")), vec!["L4D514 line 2"], [true, true], false),
        (Log::default().then(on("q0001", Event::Undo)), vec!["L4D516 line 1"], [false; 2], false),
        // A clock that goes backwards is forgiven.
        (
            first()
                .with(|place| place.3 = noon() - Duration::from_secs(60), choose("q0002"))
                .then(on("q0002", Event::Skip)),
            vec!["L4D515 line 2"],
            [true, false],
            false,
        ),
        // Another version, another date.
        (Log::default().raw(&newer).then(choose("q0002")), vec!["L4D512 line 1"], [false, true], false),
        (Log::default().raw(&undated), vec!["L4D512 line 1"], [false; 2], false),
        // After the seal; seals that fit no line.
        (first().sealed().then(choose("q0002")), vec!["L4D517 line 3"], [true, false], true),
        (first().sealed().raw("junk\n"), vec!["L4D511 line 3"], [true, false], true),
        (first().then(seal(1, "00")).then(choose("q0002")), vec!["L4D518 line 2"], [true, true], false),
        (first().then(seal(2, &digest)).then(choose("q0002")), vec!["L4D518 line 2"], [true, true], false),
        (first().then(seal(1, &digest)), vec![], [true, false], true),
    ] {
        let replay = log.replay();
        let (found, answers) = seen(&replay);
        assert_eq!(
            (found, answers, replay.sealed),
            (expected.iter().map(ToString::to_string).collect(), answered, sealed)
        );
    }
    assert!(findings(&Log::default().raw(&newer).replay())[0].message.contains("version 2"));
}

#[test]
fn every_torn_tail_leaves_the_lines_before_it() {
    let log = Log::default().then(choose("q0001")).then(choose("q0002"));
    let (bytes, first) = (log.0.concat(), log.0[0].len());
    let torn = (first + 1..bytes.len()).map(|length| bytes[..length].to_vec());
    for bytes in torn.chain([[&bytes[..first], &[0; 100]].concat()]) {
        let replay = replay_bytes(&bytes);
        assert_eq!(replay.whole, first);
        assert_eq!(seen(&replay), (vec!["L4D510 line 2".to_owned()], [true, false]));
    }
}

#[test]
fn nothing_counts_from_an_edited_line_on() {
    let log = Log::default().then(choose("q0001")).then(choose("q0002")).then(on("q0001", Event::Undo));
    for (number, from, to) in [(1, "q0001", "q0002"), (2, "none", "NONE"), (2, "l4d ", "l4e ")] {
        let mut edited = log.clone();
        let line = String::from_utf8(edited.0[number - 1].clone()).unwrap();
        edited.0[number - 1] = line.replace(from, to).into_bytes();
        let expected = (vec![format!("L4D511 line {number}")], [number > 1, false]);
        assert_eq!(seen(&edited.replay()), expected, "{from}");
    }
    let edit = |change: &dyn Fn(&mut Vec<Vec<u8>>)| {
        let mut log = log.clone();
        change(&mut log.0);
        log.replay().edited.map(|(line, _)| line)
    };
    assert_eq!(edit(&|lines| drop(lines.remove(0))), Some(1));
    assert_eq!(edit(&|lines| drop(lines.remove(1))), Some(1));
    assert_eq!(edit(&|lines| lines.swap(0, 1)), Some(1));
    assert_eq!(edit(&|lines| lines.swap(1, 2)), Some(1));
    assert_eq!(edit(&|lines| lines.insert(1, b"\n".to_vec())), Some(2));
    assert_eq!(edit(&|lines| lines.insert(0, b"\xff\xfe\n".to_vec())), Some(1));
    assert_eq!(edit(&|lines| lines.push(b"[1, 2]\n".to_vec())), Some(4));
    assert_eq!(edit(&|lines| lines.push(lines[2].clone())), Some(3));
    let skips_a_number = Log::default().then(choose("q0001")).with(|place| place.2 = 5, choose("q0002"));
    assert_eq!(skips_a_number.replay().edited.map(|(line, _)| line), Some(2));
}

#[test]
fn garbage_is_read_no_further_than_its_first_line_and_reaches_no_terminal() {
    let replay = replay_bytes(&vec![b'\n'; 64 << 20]);
    assert_eq!((replay.edited.map(|(line, _)| line), replay.lines), (Some(1), 0));
    let deep = format!("{}\n", "[".repeat(1 << 20));
    assert!(replay_bytes(deep.as_bytes()).edited.is_some());
    let escape = format!("{{\"v\":1,\"seq\":0,\"prev\":\"{NO_LINE}\",\"\\u001b[2J\":0}}\n");
    let finding = findings(&replay_bytes(escape.as_bytes())).remove(0);
    assert!(finding.code == "L4D512" && !finding.message.contains('\u{1b}'), "{:?}", finding.message);
}
