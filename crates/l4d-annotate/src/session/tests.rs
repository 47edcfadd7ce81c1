use std::io;
use std::sync::mpsc;
use std::time::Duration;

use ratatui::backend::TestBackend;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Size;

use super::*;
use crate::look::Colours;
use crate::testing::{Fixture, PROMPTS, look};

fn key(code: KeyCode) -> Input {
    Input::Event(TerminalEvent::Key(KeyEvent::new(code, KeyModifiers::NONE)))
}

fn session(fixture: &Fixture, send: &Sender) -> Session {
    let look = look(true, Colours::Full);
    let model = fixture.model(look, Size::new(80, 24), fixture.questions());
    Session::new(model, fixture.ballot(), paint_thread(fixture.painter(look), send))
}

#[test]
fn a_session_ends_with_q_and_its_pictures_come_by_themselves() {
    let fixture = Fixture::new();
    let (send, inputs) = mpsc::channel();
    for code in [KeyCode::Char('1'), KeyCode::Enter, KeyCode::Enter, KeyCode::Char('n'), KeyCode::Enter] {
        send.send(key(code)).unwrap();
    }
    let look = look(true, Colours::Full);
    // The person quits when a picture is there.
    let news = send.clone();
    let painted = move |message| {
        news.send(Input::Message(message)).ok();
        news.send(key(KeyCode::Char('q'))).ok();
    };
    let paint_thread = PaintThread::open(fixture.painter(look), painted, || {});
    let model = fixture.model(look, Size::new(80, 24), fixture.questions());
    let mut session = Session::new(model, fixture.ballot(), paint_thread);
    session.serve(&mut Terminal::new(TestBackend::new(80, 24)).unwrap(), &inputs).unwrap();
    assert_eq!(session.model.progress(), (2, 0));
    assert!(session.model.picture().is_some());
}

#[test]
fn signals_and_a_lost_terminal_end_the_session_with_a_reason() {
    let fixture = Fixture::new();
    let cases = [
        (Input::Signal("SIGTERM"), "ended by SIGTERM"),
        (Input::Lost(io::Error::from(io::ErrorKind::BrokenPipe)), "the terminal cannot be used"),
        (Input::PainterDied, "the painter of the pictures failed"),
    ];
    for (input, expected) in cases {
        let (send, inputs) = mpsc::channel();
        let mut session = session(&fixture, &send);
        send.send(input).unwrap();
        let error =
            session.serve(&mut Terminal::new(TestBackend::new(80, 24)).unwrap(), &inputs).unwrap_err();
        assert!(error.to_string().starts_with(expected), "{error}");
        assert!(error.hint().contains("goes on where it stopped"));
    }
}

#[test]
fn a_terminal_of_another_size_than_expected_is_drawn_in_its_own() {
    let fixture = Fixture::new();
    let (send, inputs) = mpsc::channel();
    let mut session = session(&fixture, &send);
    let mut terminal = Terminal::new(TestBackend::new(120, 40)).unwrap();
    send.send(key(KeyCode::Char('q'))).unwrap();
    session.serve(&mut terminal, &inputs).unwrap();
    assert_eq!(session.model.size, Size::new(120, 40));
}

#[test]
fn a_ballot_keeps_what_was_shown_as_saved() {
    let fixture = Fixture::new();
    let mut ballot = fixture.ballot();
    let asked = questions(&fixture.round, &ballot);
    assert_eq!(asked.len(), PROMPTS.len());
    let item = &asked[2].id;
    let answer = l4d_votes::Answer { choice: l4d_votes::Choice::None, frames: l4d_data::Interval::WHOLE };
    let seen = ShownFrames::default();
    let recorded =
        record(&mut ballot, item.clone(), Event::Choose(answer), seen, Duration::from_secs(1)).unwrap();
    assert!(recorded.response.answer.is_some() && recorded.undoable.as_ref() == Some(item));
    drop(ballot);
    assert_eq!(questions(&fixture.round, &fixture.ballot())[2].response, recorded.response);
}

/// The painter is stuck with the first picture until the session is over.
#[test]
fn keys_do_not_wait_for_pictures() {
    let fixture = Fixture::new();
    let (send, inputs) = mpsc::channel();
    let (unblock, blocked) = mpsc::channel::<()>();
    let look = look(true, Colours::Full);
    let paint_thread =
        PaintThread::open(fixture.painter(look), move |_| blocked.recv().unwrap_or_default(), || {});
    let model = fixture.model(look, Size::new(80, 24), fixture.questions());
    let mut session = Session::new(model, fixture.ballot(), paint_thread);
    for letter in "1\r\rn\rq".chars() {
        send.send(key(if letter == '\r' { KeyCode::Enter } else { KeyCode::Char(letter) })).unwrap();
    }
    session.serve(&mut Terminal::new(TestBackend::new(80, 24)).unwrap(), &inputs).unwrap();
    assert_eq!((session.model.progress(), session.model.picture().is_none()), ((2, 0), true));
    drop(unblock);
}
