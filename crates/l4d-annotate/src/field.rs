//! One line of typed text.

use tui_input::{Input, InputRequest};

/// Longest text that is taken, in characters.
pub(crate) const MAX_LENGTH: usize = 400;

/// Text with a cursor. Control characters never enter; line breaks become spaces.
#[derive(Debug, Clone, Default)]
pub(crate) struct Field(Input);

impl PartialEq for Field {
    fn eq(&self, other: &Self) -> bool {
        self.parts() == other.parts()
    }
}

impl Eq for Field {}

impl Field {
    /// The cursor is behind the text.
    pub(crate) fn new(text: &str) -> Self {
        let mut field = Self::default();
        field.paste(text);
        field
    }

    /// What was typed, without spaces around it.
    pub(crate) fn text(&self) -> String {
        self.0.value().trim().to_owned()
    }

    /// The parts before and after the cursor.
    pub(crate) fn parts(&self) -> (&str, &str) {
        let text = self.0.value();
        let cursor = text.char_indices().nth(self.0.cursor()).map_or(text.len(), |(at, _)| at);
        text.split_at(cursor)
    }

    pub(crate) fn paste(&mut self, text: &str) {
        text.chars().for_each(|letter| self.edit(InputRequest::InsertChar(letter)));
    }

    pub(crate) fn edit(&mut self, edit: InputRequest) {
        let edit = match edit {
            InputRequest::InsertChar(letter) if letter.is_whitespace() => InputRequest::InsertChar(' '),
            InputRequest::InsertChar(letter) if letter.is_control() => return,
            edit => edit,
        };
        let is_full = self.0.value().chars().count() >= MAX_LENGTH;
        if !(is_full && matches!(edit, InputRequest::InsertChar(_))) {
            self.0.handle(edit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cursor_goes_where_it_is_sent() {
        let mut field = Field::new("two cats");
        field.edit(InputRequest::GoToPrevChar);
        assert_eq!(field.parts(), ("two cat", "s"));
        field.edit(InputRequest::DeletePrevWord);
        assert_eq!(field.parts(), ("two ", "s"));
    }

    #[test]
    fn control_characters_and_floods_stay_out() {
        let mut field = Field::new("a\u{1b}[2Jb\nc");
        assert_eq!(field.text(), "a[2Jb c");
        field.paste(&"x".repeat(2 * MAX_LENGTH));
        assert_eq!(field.text().chars().count(), MAX_LENGTH);
    }
}
