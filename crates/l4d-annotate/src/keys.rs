//! Keys to messages, and the page that lists them.

use ratatui::crossterm::event::{Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::layout::Size;
use tui_input::InputRequest;

use crate::message::Message;
use crate::model::Mode;

/// More steps back than anything has.
const TO_FIRST: i64 = i64::MIN / 2;
/// More steps forward than anything has.
const TO_LAST: i64 = i64::MAX / 2;

/// A heading of the help page with its keys.
pub type Group = (&'static str, &'static [(&'static str, &'static str)]);

/// Most columns of an explanation on the help page, so that two fit side by side in 80.
pub(crate) const HELP_COLUMNS: usize = 27;

/// The help page.
pub const HELP: &[Group] = &[
    (
        "Answer",
        &[
            ("1 2 3 ..", "object, in or out again"),
            ("n", "none: nothing is meant"),
            ("a", "ambiguous: type why"),
            ("Enter", "go on, then save"),
            ("Backspace", "clear the answer"),
            ("u", "undo"),
            ("s", "skip"),
            ("c", "comment"),
        ],
    ),
    (
        "Time",
        &[
            ("Left Right", "frame"),
            ("Home End", "first, last frame"),
            ("Space", "play, stop"),
            ("[", "so from this frame on"),
            ("]", "so up to this frame"),
            ("w", "so in the whole clip"),
        ],
    ),
    (
        "Look",
        &[
            ("Up Down", "view"),
            ("+ -", "zoom"),
            ("z", "zoom to chosen, and back"),
            ("h j k l", "move the zoomed picture"),
            ("x", "outlines off and on"),
            ("o", "picture as a file, opened"),
        ],
    ),
    (
        "Round",
        &[
            ("< >", "item before, after"),
            ("S", "what is left; seal"),
            ("?", "this page"),
            ("q", "quit; saved stays saved"),
        ],
    ),
];

/// What an event of the terminal means now.
pub(crate) fn message(mode: &Mode, event: Event) -> Option<Message> {
    match event {
        Event::Key(key) if key.kind != KeyEventKind::Release => key_message(mode, key),
        Event::Paste(text) => Some(Message::Paste(text)),
        Event::Resize(width, height) => Some(Message::Resize(Size::new(width, height))),
        _ => None,
    }
}

/// Whether a key ends the session whatever is on the screen.
pub(crate) fn is_interrupt(event: &Event) -> bool {
    matches!(event, Event::Key(KeyEvent { code: KeyCode::Char('c'), modifiers, kind, .. })
        if modifiers.contains(KeyModifiers::CONTROL) && *kind != KeyEventKind::Release)
}

fn key_message(mode: &Mode, key: KeyEvent) -> Option<Message> {
    match mode {
        Mode::Reason(_) | Mode::Comment(_) => text_key(key),
        Mode::Summary { sealing: true, .. } => match key.code {
            // A stray Enter must not seal.
            KeyCode::Char('y') => Some(Message::Accept),
            _ => Some(Message::Back),
        },
        Mode::Leave => match key.code {
            KeyCode::Char('q' | 'y') => Some(Message::Quit),
            _ => Some(Message::Back),
        },
        Mode::Summary { .. } => list_key(key).or_else(|| item_key(key)),
        Mode::Choose | Mode::When => item_key(key),
    }
}

fn list_key(key: KeyEvent) -> Option<Message> {
    Some(match key.code {
        KeyCode::Up | KeyCode::Char('k') => Message::StepLine(-1),
        KeyCode::Down | KeyCode::Char('j') => Message::StepLine(1),
        KeyCode::PageUp => Message::StepLine(-10),
        KeyCode::PageDown => Message::StepLine(10),
        KeyCode::Home => Message::StepLine(TO_FIRST),
        KeyCode::End => Message::StepLine(TO_LAST),
        KeyCode::Char('S') => Message::Seal,
        _ => return None,
    })
}

fn item_key(key: KeyEvent) -> Option<Message> {
    if key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT) {
        return None;
    }
    let shifted = key.modifiers.contains(KeyModifiers::SHIFT);
    Some(match key.code {
        KeyCode::Char(digit @ '0'..='9') => Message::Digit(digit),
        KeyCode::Char('n') => Message::None,
        KeyCode::Char('a') => Message::Ambiguous,
        KeyCode::Enter => Message::Accept,
        KeyCode::Esc => Message::Back,
        KeyCode::Backspace | KeyCode::Delete => Message::Clear,
        KeyCode::Char('[') => Message::HoldsFrom,
        KeyCode::Char(']') => Message::HoldsUntil,
        KeyCode::Char('w') => Message::HoldsAlways,
        KeyCode::Left if shifted => Message::Pan(-1, 0),
        KeyCode::Right if shifted => Message::Pan(1, 0),
        KeyCode::Up if shifted => Message::Pan(0, -1),
        KeyCode::Down if shifted => Message::Pan(0, 1),
        KeyCode::Left => Message::StepFrame(-1),
        KeyCode::Right => Message::StepFrame(1),
        KeyCode::Home => Message::StepFrame(TO_FIRST),
        KeyCode::End => Message::StepFrame(TO_LAST),
        KeyCode::Up => Message::StepView(-1),
        KeyCode::Down => Message::StepView(1),
        KeyCode::Char(' ') => Message::Play,
        KeyCode::Char('+' | '=') => Message::Zoom(1),
        KeyCode::Char('-' | '_') => Message::Zoom(-1),
        KeyCode::Char('z') => Message::ZoomToChosen,
        KeyCode::Char('h') => Message::Pan(-1, 0),
        KeyCode::Char('l') => Message::Pan(1, 0),
        KeyCode::Char('k') => Message::Pan(0, -1),
        KeyCode::Char('j') => Message::Pan(0, 1),
        KeyCode::Char('x') => Message::Outlines,
        KeyCode::Char('o') => Message::Export,
        KeyCode::Char('s') => Message::Skip,
        KeyCode::Char('c') => Message::Comment,
        KeyCode::Char('u') => Message::Undo,
        KeyCode::Char('<') | KeyCode::PageUp => Message::StepItem(-1),
        KeyCode::Char('>') | KeyCode::PageDown => Message::StepItem(1),
        KeyCode::Char('S') => Message::Summary,
        KeyCode::Char('?') | KeyCode::F(1) => Message::Help,
        KeyCode::Char('q') => Message::Quit,
        _ => return None,
    })
}

fn text_key(key: KeyEvent) -> Option<Message> {
    let control = key.modifiers.contains(KeyModifiers::CONTROL);
    let edit = match key.code {
        KeyCode::Enter => return Some(Message::Accept),
        KeyCode::Esc => return Some(Message::Back),
        KeyCode::Char('u') if control => InputRequest::DeleteLine,
        KeyCode::Char('w') if control => InputRequest::DeletePrevWord,
        KeyCode::Char('a') if control => InputRequest::GoToStart,
        KeyCode::Char('e') if control => InputRequest::GoToEnd,
        KeyCode::Char('h') if control => InputRequest::DeletePrevChar,
        KeyCode::Char(_) if control || key.modifiers.contains(KeyModifiers::ALT) => return None,
        KeyCode::Char(letter) => InputRequest::InsertChar(letter),
        KeyCode::Backspace => InputRequest::DeletePrevChar,
        KeyCode::Delete => InputRequest::DeleteNextChar,
        KeyCode::Left => InputRequest::GoToPrevChar,
        KeyCode::Right => InputRequest::GoToNextChar,
        KeyCode::Home => InputRequest::GoToStart,
        KeyCode::End => InputRequest::GoToEnd,
        _ => return None,
    };
    Some(Message::Edit(edit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Field;

    fn press(mode: &Mode, code: KeyCode) -> Option<Message> {
        message(mode, Event::Key(KeyEvent::new(code, KeyModifiers::NONE)))
    }

    #[test]
    fn every_key_of_the_help_page_does_something() {
        let code = |name: &str| match name {
            "Enter" => KeyCode::Enter,
            "Backspace" => KeyCode::Backspace,
            "Left" => KeyCode::Left,
            "Right" => KeyCode::Right,
            "Up" => KeyCode::Up,
            "Down" => KeyCode::Down,
            "Home" => KeyCode::Home,
            "End" => KeyCode::End,
            "Space" => KeyCode::Char(' '),
            letter => KeyCode::Char(letter.chars().next().unwrap()),
        };
        let keys = HELP.iter().flat_map(|(_, keys)| *keys);
        for name in keys.flat_map(|(names, _)| names.split(' ')).filter(|name| *name != "..") {
            assert!(press(&Mode::Choose, code(name)).is_some(), "{name} does nothing");
        }
    }

    #[test]
    fn explanations_fit_their_column() {
        for (keys, what) in HELP.iter().flat_map(|(_, keys)| *keys) {
            assert!(what.len() <= HELP_COLUMNS, "{keys}: {what}");
        }
    }

    #[test]
    fn in_text_every_letter_is_a_letter() {
        let mode = Mode::Comment(Field::default());
        for letter in "q n1?S< ".chars() {
            assert!(matches!(
                press(&mode, KeyCode::Char(letter)),
                Some(Message::Edit(InputRequest::InsertChar(typed))) if typed == letter
            ));
        }
    }

    #[test]
    fn only_y_seals() {
        let sealing = Mode::Summary { selected: 0, sealing: true };
        assert!(matches!(press(&sealing, KeyCode::Char('y')), Some(Message::Accept)));
        for code in [KeyCode::Enter, KeyCode::Char('S'), KeyCode::Char(' '), KeyCode::Esc] {
            assert!(matches!(press(&sealing, code), Some(Message::Back)));
        }
    }

    #[test]
    fn released_keys_do_nothing_and_interrupts_are_known() {
        let mut key = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert!(is_interrupt(&Event::Key(key)));
        assert!(message(&Mode::Choose, Event::Key(key)).is_none());
        key.kind = KeyEventKind::Release;
        assert!(!is_interrupt(&Event::Key(key)) && message(&Mode::Choose, Event::Key(key)).is_none());
    }
}
