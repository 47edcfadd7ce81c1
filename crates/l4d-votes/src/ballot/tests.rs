use super::*;
use crate::fixture::{folder, items, name, objects, round_of, whole};
use crate::line::{NO_LINE, Source};

fn round() -> Round {
    round_of(&["ada", "ben"], items("room", &["The cat", "The dog", "The toy"]))
}

fn open(dir: &RoundDir) -> Result<(Ballot, Vec<Finding>), DataError> {
    Ballot::open(dir, &round(), &name("ada"))
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
fn two_windows_of_one_annotator_refuse_each_other() {
    let (_folder, dir) = folder();
    let (mut first, _) = open(&dir).unwrap();
    record(&mut first, 2, choose("tabby")).unwrap();
    let error = open(&dir).unwrap_err();
    assert!(error.to_string().contains("another window"), "{error}");
    assert!(!error.hint().is_empty());
    assert!(Ballot::open(&dir, &round(), &name("ben")).is_ok());
    drop(first);
    let (again, notices) = open(&dir).unwrap();
    assert_eq!((chosen(&again, 2).as_deref(), again.open_count(), notices), (Some("tabby"), 2, Vec::new()));
    assert_eq!(again.undoable(), Some(&id(2)));
}

#[test]
fn a_torn_line_is_cut_off_and_said() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    drop(ballot);
    let whole = bytes(&dir);
    for torn in [1, whole.len() / 2, whole.len() - 1] {
        fs::write(dir.ballot(&name("ada")), [&whole, &whole[..torn]].concat()).unwrap();
        let (mut ballot, notices) = open(&dir).unwrap();
        assert_eq!(notices.iter().map(|notice| notice.code).collect::<Vec<_>>(), ["L4D510"]);
        assert_eq!(bytes(&dir), whole);
        record(&mut ballot, 2, choose("rex")).unwrap();
        drop(ballot);
        assert_eq!(open(&dir).unwrap().1, []);
    }
}

#[test]
fn what_is_edited_or_no_file_is_refused_and_left_alone() {
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
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    assert!(open(&dir).unwrap_err().to_string().contains("not a regular file"));
}

#[test]
fn a_file_that_changes_underneath_is_noticed() {
    let (_folder, dir) = folder();
    let path = dir.ballot(&name("ada"));
    let (mut ballot, _) = open(&dir).unwrap();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    let copy = bytes(&dir);
    fs::remove_file(&path).unwrap();
    assert!(record(&mut ballot, 2, choose("rex")).unwrap_err().to_string().contains("is not as it was left"));
    fs::write(&path, &copy).unwrap();
    assert!(record(&mut ballot, 2, choose("rex")).is_err(), "a vote went into a file that no one will read");
    drop(ballot);
    let (mut ballot, _) = open(&dir).unwrap();
    fs::write(&path, [&copy[..], b"{}\n"].concat()).unwrap();
    assert!(record(&mut ballot, 2, choose("rex")).is_err());
}

#[test]
fn a_seal_needs_every_item_and_the_file_as_it_was_written() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    let refused = |ballot: &mut Ballot| ballot.seal().unwrap_err().to_string();
    record(&mut ballot, 1, choose("tabby")).unwrap();
    record(&mut ballot, 2, Event::Skip).unwrap();
    assert!(refused(&mut ballot).contains("1 item is not answered"));
    record(&mut ballot, 3, choose("mouse")).unwrap();
    let written = String::from_utf8(bytes(&dir)).unwrap();
    fs::write(dir.ballot(&name("ada")), written.replacen("tabby", "ginge", 1)).unwrap();
    assert!(refused(&mut ballot).contains("not what was written"));
    fs::write(dir.ballot(&name("ada")), written).unwrap();
    ballot.seal().unwrap();
    let sealed = bytes(&dir);
    assert!(record(&mut ballot, 1, Event::Undo).unwrap_err().to_string().contains("sealed"));
    drop(ballot);
    let (mut ballot, notices) = open(&dir).unwrap();
    assert!(ballot.is_sealed() && notices.is_empty() && refused(&mut ballot).contains("already"));
    assert_eq!(bytes(&dir), sealed);
}

#[test]
fn unknown_items_and_odd_remarks_are_refused() {
    let (_folder, dir) = folder();
    let (mut ballot, _) = open(&dir).unwrap();
    for (number, event) in [
        (9, Event::Skip),
        (1, Event::Comment { text: " ".to_owned() }),
        (1, Event::Choose(whole(objects(&[])))),
    ] {
        assert!(record(&mut ballot, number, event).is_err());
    }
    assert_eq!(bytes(&dir), b"");
}

#[test]
fn a_clock_that_stands_behind_the_last_event_is_said() {
    let (_folder, dir) = folder();
    let tomorrow = SystemTime::now() + Duration::from_secs(86400);
    let (round, ada) = (round(), name("ada"));
    let act = Act::On {
        item: id(1),
        order: 1,
        digest: round.items[0].digest.clone(),
        event: choose("tabby"),
        seen: ShownFrames::default(),
        elapsed_ms: 0,
    };
    fs::create_dir_all(dir.votes()).unwrap();
    let source = Source { at: tomorrow, ..Source::now() };
    fs::write(dir.ballot(&ada), write_line((&round.name, &ada), 0, &source, NO_LINE, act)).unwrap();
    let (mut ballot, notices) = open(&dir).unwrap();
    assert_eq!(notices.iter().map(|notice| notice.code).collect::<Vec<_>>(), ["L4D515"]);
    record(&mut ballot, 2, choose("rex")).unwrap();
    assert_eq!((chosen(&ballot, 1).as_deref(), chosen(&ballot, 2).as_deref()), (Some("tabby"), Some("rex")));
}
