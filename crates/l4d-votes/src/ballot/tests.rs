use std::io;
use std::sync::{Arc, Mutex};

use super::*;
use crate::fixture::{folder, items, name, noon, objects, round_of, whole};

fn round() -> Round {
    round_of(&["ada", "ben"], items("room", &["The cat", "The dog", "The toy"]))
}

fn open(dir: &RoundDir) -> Result<(Ballot, Vec<Finding>), DataError> {
    Ballot::open_at(dir, &round(), &name("ada"), noon)
}

fn id(number: usize) -> ItemId {
    ItemId::numbered(number, 3)
}

fn choose(object: &str) -> Event {
    Event::Choose(whole(objects(&[object])))
}

fn record(ballot: &mut Ballot, number: usize, event: Event) -> Result<(), DataError> {
    ballot.record(&id(number), event, ShownFrames::default(), Duration::from_millis(900))
}

fn chosen(ballot: &Ballot, number: usize) -> Option<String> {
    ballot.response(&id(number)).unwrap().answer.map(|answer| answer.choice.label())
}

fn bytes(dir: &RoundDir) -> Vec<u8> {
    fs::read(dir.ballot(&name("ada"))).unwrap()
}

#[test]
fn a_ballot_resumes_where_it_was_left() {
    let (_folder, dir) = folder();
    let (mut ballot, notices) = open(&dir).unwrap();
    assert_eq!(notices, []);
    assert_eq!(ballot.open_count(), 3);
    record(&mut ballot, 1, choose("tabby")).unwrap();
    record(&mut ballot, 2, Event::Skip).unwrap();
    record(&mut ballot, 2, Event::Comment("too dark".to_owned())).unwrap();
    assert_eq!(ballot.undoable(), Some(&id(2)));
    drop(ballot);

    let (ballot, notices) = open(&dir).unwrap();
    assert_eq!(notices, []);
    assert_eq!(chosen(&ballot, 1).as_deref(), Some("tabby"));
    let second = ballot.response(&id(2)).unwrap();
    assert_eq!((second.skipped, second.comments), (true, vec!["too dark".to_owned()]));
    assert_eq!(ballot.open_count(), 1);
    assert_eq!(ballot.undoable(), Some(&id(2)));
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
fn an_unknown_annotator_gets_the_list_of_those_who_may_vote() {
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
    assert!(record(&mut ballot, 2, choose("rex")).is_err(), "a vote went into a file that no one will read");
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
    for (number, event) in
        [(9, Event::Skip), (1, Event::Comment(" ".to_owned())), (1, Event::Choose(whole(objects(&[]))))]
    {
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
struct FlakyFile(Arc<Mutex<Disk>>);

impl FlakyFile {
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

impl LogFile for FlakyFile {
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
    let file = FlakyFile::default();
    let mut ballot = file.open();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    let before = file.disk().bytes.clone();
    // 0: nothing arrives; the whole line and its newline arrive, and only the sync fails.
    for arrives in 0..500 {
        file.disk().append_fails_after = Some(arrives);
        let error = record(&mut ballot, 2, choose("rex")).unwrap_err();
        assert!(error.to_string().contains("does not count"), "{error}");
        assert!(error.hint().unwrap().contains("free some disk space"));
        assert_eq!(file.disk().bytes, before, "{arrives} bytes");
        assert_eq!(chosen(&ballot, 2), None);
        let seal = ballot.seal();
        assert!(seal.is_err() && !ballot.is_sealed());
    }
    file.disk().append_fails_after = None;
    record(&mut ballot, 2, choose("rex")).unwrap();
    let again = file.open();
    assert_eq!((chosen(&again, 1).as_deref(), chosen(&again, 2).as_deref()), (Some("tabby"), Some("rex")));
}

#[test]
fn a_seal_that_cannot_be_written_is_no_seal() {
    let file = FlakyFile::default();
    let mut ballot = file.open();
    for number in 1..=3 {
        record(&mut ballot, number, Event::Skip).unwrap();
    }
    file.disk().append_fails_after = Some(40);
    assert!(ballot.seal().is_err());
    file.disk().append_fails_after = None;
    record(&mut ballot, 1, choose("tabby")).unwrap();
    ballot.seal().unwrap();
    assert!(file.open().is_sealed());
}

#[test]
fn a_ballot_that_cannot_even_be_cut_back_refuses_everything_until_it_is_opened_anew() {
    let file = FlakyFile::default();
    let mut ballot = file.open();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    let before = file.disk().bytes.clone();
    file.disk().append_fails_after = Some(30);
    file.disk().cut_fails = true;
    assert!(record(&mut ballot, 2, choose("rex")).is_err());
    assert_eq!(file.disk().bytes.len(), before.len() + 30);
    file.disk().append_fails_after = None;
    file.disk().cut_fails = false;
    let error = record(&mut ballot, 3, choose("rex")).unwrap_err().to_string();
    assert!(error.contains("neither be written nor cut off"), "{error}");
    drop(ballot);
    let again = file.open();
    assert_eq!((chosen(&again, 1).as_deref(), chosen(&again, 2)), (Some("tabby"), None));
    assert_eq!(file.disk().bytes, before);
}

/// `/dev/full` takes no byte and cannot be cut back: the real thing behind the tests above.
#[cfg(target_os = "linux")]
#[test]
fn a_device_that_is_full_takes_no_vote() {
    let path = PathBuf::from("/dev/full");
    let file = OpenOptions::new().read(true).write(true).open(&path).unwrap();
    let error = LockedFile::new(file, path).append(0, b"{}\n").unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}
