use std::collections::BTreeSet;
use std::io;
use std::sync::{Arc, Mutex};

use l4d_data::Interval;

use super::*;
use crate::event::Choice;
use crate::fixture::{items, name, noon, round_of};

fn round() -> Round {
    round_of(&["ada", "ben"], items("room", &["The cat", "The dog", "The toy"]))
}

fn open(dir: &RoundDir) -> Result<(Ballot, Vec<Notice>), DataError> {
    Ballot::open_at(dir, &round(), &name("ada"), noon)
}

fn id(number: usize) -> ItemId {
    ItemId::numbered(number, 3)
}

fn choose(object: &str) -> Event {
    let choice = Choice::Objects(BTreeSet::from([name(object)]));
    Event::Choose(Answer { choice, frames: Interval::WHOLE })
}

fn record(ballot: &mut Ballot, number: usize, event: Event) -> Result<(), DataError> {
    ballot.record(&id(number), event, Seen::default(), Duration::from_millis(900))
}

fn chosen(ballot: &Ballot, number: usize) -> Option<String> {
    ballot.answer(&id(number)).map(|answer| answer.choice.label())
}

fn bytes(dir: &RoundDir) -> Vec<u8> {
    fs::read(dir.ballot(&name("ada"))).unwrap()
}

fn folder() -> (tempfile::TempDir, RoundDir) {
    let folder = tempfile::tempdir().unwrap();
    let dir = RoundDir::new(folder.path().join("r1"));
    (folder, dir)
}

#[test]
fn a_ballot_resumes_where_it_was_left() {
    let (_folder, dir) = folder();
    let (mut ballot, notices) = open(&dir).unwrap();
    assert_eq!(notices, []);
    assert_eq!(ballot.next_open(), ballot.order().first());
    record(&mut ballot, 1, choose("tabby")).unwrap();
    record(&mut ballot, 2, Event::Skip).unwrap();
    record(&mut ballot, 2, Event::Comment("too dark".to_owned())).unwrap();
    assert_eq!(ballot.undoable(), Some(&id(2)));
    drop(ballot);

    let (ballot, notices) = open(&dir).unwrap();
    assert_eq!(notices, []);
    assert_eq!(chosen(&ballot, 1).as_deref(), Some("tabby"));
    assert_eq!(ballot.skipped(), [&id(2)]);
    assert_eq!(ballot.comments(&id(2)), ["too dark"]);
    assert_eq!((ballot.next_open(), ballot.open_count()), (Some(&id(3)), 1));
    assert_eq!(ballot.undoable(), Some(&id(2)));
}

#[test]
fn an_undo_goes_through_the_log() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    record(&mut ballot, 1, choose("ginger")).unwrap();
    record(&mut ballot, 1, Event::Undo).unwrap();
    assert_eq!(chosen(&ballot, 1).as_deref(), Some("tabby"));
    record(&mut ballot, 1, Event::Undo).unwrap();
    let before = bytes(&dir);
    let error = record(&mut ballot, 1, Event::Undo).unwrap_err().to_string();
    assert!(error.contains("nothing is left to undo"), "{error}");
    assert_eq!(bytes(&dir), before);
    assert_eq!(ballot.undoable(), None);
    assert_eq!(before.iter().filter(|&&byte| byte == b'\n').count(), 4);
}

#[test]
fn two_windows_of_one_annotator_refuse_each_other() {
    let (_folder, dir) = folder();
    let first = open(&dir).unwrap();
    let error = open(&dir).unwrap_err();
    assert!(error.to_string().contains("another window"), "{error}");
    assert!(error.hint().is_some());
    assert!(Ballot::open(&dir, &round(), &name("ben")).is_ok());
    drop(first);
    assert!(open(&dir).is_ok());
}

#[test]
fn somebody_else_is_told_who_may_vote() {
    let (_folder, dir) = folder();
    let error = Ballot::open(&dir, &round(), &name("eve")).unwrap_err();
    assert!(error.to_string().contains("does not name `eve`"), "{error}");
    assert_eq!(error.hint().as_deref(), Some("vote as one of ada, ben"));
    assert!(!dir.votes().exists());
}

#[test]
fn a_torn_line_is_cut_off_and_said() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    let whole = bytes(&dir);
    record(&mut ballot, 2, choose("rex")).unwrap();
    drop(ballot);
    let all = bytes(&dir);
    for length in whole.len() + 1..all.len() {
        fs::write(dir.ballot(&name("ada")), &all[..length]).unwrap();
        let (mut ballot, notices) = open(&dir).unwrap();
        assert_eq!(notices.iter().map(|notice| notice.code).collect::<Vec<_>>(), [codes::TORN_LINE]);
        assert_eq!(bytes(&dir), whole);
        assert_eq!((chosen(&ballot, 1).as_deref(), chosen(&ballot, 2)), (Some("tabby"), None));
        record(&mut ballot, 2, choose("rex")).unwrap();
        assert_eq!(bytes(&dir), all);
    }
}

#[test]
fn an_edited_log_is_refused_and_left_alone() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    record(&mut ballot, 2, choose("rex")).unwrap();
    drop(ballot);
    let path = dir.ballot(&name("ada"));
    let edited = fs::read_to_string(&path).unwrap().replace("tabby", "ginge");
    fs::write(&path, &edited).unwrap();
    let error = open(&dir).unwrap_err();
    assert!(error.to_string().contains("line 1: is not what was written"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), edited);
}

#[test]
fn a_file_that_changes_underneath_is_noticed() {
    let (_folder, dir) = folder();
    let path = dir.ballot(&name("ada"));
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    let copy = bytes(&dir);
    fs::remove_file(&path).unwrap();
    assert!(record(&mut ballot, 2, choose("rex")).unwrap_err().to_string().contains("another program"));
    fs::write(&path, &copy).unwrap();
    assert!(record(&mut ballot, 2, choose("rex")).is_err(), "a vote went into a file that nobody will read");
    drop(ballot);
    let (mut ballot, _) = open(&dir).unwrap();
    fs::write(&path, [&copy[..], b"{}\n"].concat()).unwrap();
    assert!(record(&mut ballot, 2, choose("rex")).is_err());
}

#[test]
fn what_is_no_file_is_no_ballot() {
    let (_folder, dir) = folder();
    fs::create_dir_all(dir.ballot(&name("ada"))).unwrap();
    assert!(open(&dir).unwrap_err().to_string().contains("not a regular file"));
}

#[test]
fn a_seal_needs_every_item_and_ends_the_ballot() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    record(&mut ballot, 2, Event::Skip).unwrap();
    let error = ballot.seal().unwrap_err().to_string();
    assert!(error.contains("1 item is not answered"), "{error}");
    record(&mut ballot, 3, choose("mouse")).unwrap();
    ballot.seal().unwrap();
    assert!(ballot.is_sealed());
    let sealed = bytes(&dir);
    assert!(record(&mut ballot, 1, Event::Undo).unwrap_err().to_string().contains("sealed"));
    assert!(ballot.seal().is_err());
    drop(ballot);
    let (mut ballot, notices) = open(&dir).unwrap();
    assert!(ballot.is_sealed() && notices.is_empty());
    assert!(record(&mut ballot, 1, Event::Undo).is_err());
    assert_eq!(bytes(&dir), sealed);
}

#[test]
fn a_seal_looks_at_the_file_again() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    for number in 1..=3 {
        record(&mut ballot, number, choose("tabby")).unwrap();
    }
    let edited = String::from_utf8(bytes(&dir)).unwrap().replacen("tabby", "ginge", 1);
    fs::write(dir.ballot(&name("ada")), edited).unwrap();
    assert!(ballot.seal().unwrap_err().to_string().contains("not what was written"));
}

#[test]
fn unknown_items_and_odd_remarks_are_refused() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    for (number, event) in [
        (9, Event::Skip),
        (1, Event::Comment(" ".to_owned())),
        (1, Event::Choose(Answer { choice: Choice::Objects(BTreeSet::new()), frames: Interval::WHOLE })),
    ] {
        assert!(record(&mut ballot, number, event).is_err());
    }
    assert_eq!(bytes(&dir), b"");
}

#[test]
fn a_clock_that_stands_behind_the_last_event_is_said() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    drop(ballot);
    let early = || noon() - Duration::from_secs(3600);
    let (mut ballot, notices) = Ballot::open_at(&dir, &round(), &name("ada"), early).unwrap();
    assert_eq!(notices.iter().map(|notice| notice.code).collect::<Vec<_>>(), [codes::CLOCK_BACKWARDS]);
    record(&mut ballot, 2, choose("rex")).unwrap();
    assert_eq!(chosen(&ballot, 2).as_deref(), Some("rex"));
}

/// A disk that fails on command.
#[derive(Debug, Default)]
struct Disk {
    bytes: Vec<u8>,
    /// How much of the next append arrives before it fails.
    append_fails_after: Option<usize>,
    cut_fails: bool,
}

#[derive(Debug, Clone, Default)]
struct FlakyJournal(Arc<Mutex<Disk>>);

impl FlakyJournal {
    fn disk(&self) -> std::sync::MutexGuard<'_, Disk> {
        self.0.lock().unwrap()
    }

    fn open(&self) -> Ballot {
        let length = self.disk().bytes.len() as u64;
        Ballot::resume("ada.jsonl".into(), &round(), &name("ada"), Box::new(self.clone()), length, noon)
            .unwrap()
            .0
    }
}

impl Journal for FlakyJournal {
    fn is_intact(&self, length: u64) -> bool {
        self.disk().bytes.len() as u64 == length
    }

    fn append(&mut self, length: u64, bytes: &[u8]) -> io::Result<()> {
        let mut disk = self.disk();
        let arrived = disk.append_fails_after.unwrap_or(bytes.len()).min(bytes.len());
        disk.bytes.truncate(length as usize);
        disk.bytes.extend_from_slice(&bytes[..arrived]);
        match disk.append_fails_after {
            Some(_) => Err(io::Error::from(io::ErrorKind::StorageFull)),
            None => Ok(()),
        }
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        let mut disk = self.disk();
        if disk.cut_fails {
            return Err(io::Error::from(io::ErrorKind::Other));
        }
        disk.bytes.truncate(length as usize);
        Ok(())
    }

    fn read(&mut self, length: u64) -> io::Result<Vec<u8>> {
        Ok(self.disk().bytes[..length as usize].to_vec())
    }
}

#[test]
fn a_vote_that_cannot_be_written_is_not_taken_wherever_the_disk_fails() {
    let journal = FlakyJournal::default();
    let mut ballot = journal.open();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    let before = journal.disk().bytes.clone();
    // 0: nothing arrives; the whole line and its newline arrive, and only the sync fails.
    for arrives in 0..500 {
        journal.disk().append_fails_after = Some(arrives);
        let error = record(&mut ballot, 2, choose("rex")).unwrap_err();
        assert!(error.to_string().contains("does not count"), "{error}");
        assert!(error.hint().unwrap().contains("free some disk space"));
        assert_eq!(journal.disk().bytes, before, "{arrives} bytes");
        assert_eq!(chosen(&ballot, 2), None);
        let seal = ballot.seal();
        assert!(seal.is_err() && !ballot.is_sealed());
    }
    journal.disk().append_fails_after = None;
    record(&mut ballot, 2, choose("rex")).unwrap();
    let again = journal.open();
    assert_eq!((chosen(&again, 1).as_deref(), chosen(&again, 2).as_deref()), (Some("tabby"), Some("rex")));
}

#[test]
fn a_seal_that_cannot_be_written_is_no_seal() {
    let journal = FlakyJournal::default();
    let mut ballot = journal.open();
    for number in 1..=3 {
        record(&mut ballot, number, Event::Skip).unwrap();
    }
    journal.disk().append_fails_after = Some(40);
    assert!(ballot.seal().is_err());
    journal.disk().append_fails_after = None;
    record(&mut ballot, 1, choose("tabby")).unwrap();
    ballot.seal().unwrap();
    assert!(journal.open().is_sealed());
}

#[test]
fn a_ballot_that_cannot_even_be_cut_back_refuses_everything_until_it_is_opened_anew() {
    let journal = FlakyJournal::default();
    let mut ballot = journal.open();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    let before = journal.disk().bytes.clone();
    journal.disk().append_fails_after = Some(30);
    journal.disk().cut_fails = true;
    assert!(record(&mut ballot, 2, choose("rex")).is_err());
    assert_eq!(journal.disk().bytes.len(), before.len() + 30);
    journal.disk().append_fails_after = None;
    journal.disk().cut_fails = false;
    let error = record(&mut ballot, 3, choose("rex")).unwrap_err().to_string();
    assert!(error.contains("neither be written nor cut off"), "{error}");
    drop(ballot);
    let again = journal.open();
    assert_eq!((chosen(&again, 1).as_deref(), chosen(&again, 2)), (Some("tabby"), None));
    assert_eq!(journal.disk().bytes, before);
}

/// `/dev/full` takes no byte and cannot be cut back: the real thing behind the test above.
#[cfg(target_os = "linux")]
#[test]
fn a_device_that_is_full_takes_no_vote() {
    let path = PathBuf::from("/dev/full");
    let file = OpenOptions::new().read(true).write(true).open(&path).unwrap();
    let mut journal = FileJournal::new(file, path);
    let error = journal.append(0, b"{}\n").unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}

/// A disk of 64 KiB in a namespace of its own, filled up: this test runs itself again inside.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_takes_no_vote_and_loses_none() {
    const INSIDE: &str = "L4D_TEST_FULL_DISK";
    if let Some(disk) = std::env::var_os(INSIDE) {
        return vote_until_full(Path::new(&disk));
    }
    let folder = tempfile::tempdir().unwrap();
    let test = std::env::current_exe().unwrap();
    let output = std::process::Command::new("unshare")
        .args(["--user", "--map-root-user", "--mount", "sh", "-c"])
        .arg("mount -t tmpfs -o size=64k none \"$0\" || exit 77; exec \"$1\" --exact --nocapture \"$2\"")
        .arg(folder.path())
        .arg(&test)
        .arg("ballot::tests::a_full_disk_takes_no_vote_and_loses_none")
        .env(INSIDE, folder.path())
        .output();
    match output {
        Ok(output) if output.status.success() => {
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(said.contains("1 passed") && said.contains("the disk was full"), "{said}");
        }
        Ok(output) if output.status.code() == Some(101) => {
            panic!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        }
        other => eprintln!("not tested on a full disk: this machine allows no mount of its own ({other:?})"),
    }
}

#[cfg(target_os = "linux")]
fn vote_until_full(disk: &Path) {
    let dir = RoundDir::new(disk.join("r1"));
    let (mut ballot, _) = open(&dir).unwrap();
    let mut taken = 0;
    let error = loop {
        match record(&mut ballot, 1, choose(&format!("object_{taken}"))) {
            Ok(()) => taken += 1,
            Err(error) => break error,
        }
        assert!(taken < 1000, "the disk never fills");
    };
    assert!(error.hint().unwrap().contains("disk space"), "{error}");
    let last = format!("object_{}", taken - 1);
    assert_eq!(chosen(&ballot, 1).as_ref(), Some(&last));
    drop(ballot);
    let (ballot, notices) = open(&dir).unwrap();
    assert_eq!((notices, chosen(&ballot, 1).as_ref()), (Vec::new(), Some(&last)));
    println!("the disk was full after {taken} votes");
}
