//! One line of typed text.

/// Longest text that is taken, in characters.
pub const MAX_LENGTH: usize = 400;

/// Text with a cursor. Control characters never enter.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Field {
    before: String,
    after: String,
}

/// A key that edits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edit {
    /// A typed character.
    Type(char),
    /// Backspace.
    Erase,
    /// Delete.
    EraseNext,
    /// Back to the start of the word.
    EraseWord,
    /// The whole line.
    EraseAll,
    /// Cursor.
    Left,
    /// Cursor.
    Right,
    /// Cursor.
    Start,
    /// Cursor.
    End,
}

impl Field {
    /// The cursor stands behind the text.
    pub fn new(text: &str) -> Self {
        let mut field = Self::default();
        field.paste(text);
        field
    }

    /// What was typed, without spaces around it.
    pub fn text(&self) -> String {
        let whole = [self.before.as_str(), self.after.as_str()].concat();
        whole.trim().to_owned()
    }

    /// The parts before and after the cursor.
    pub fn parts(&self) -> (&str, &str) {
        (&self.before, &self.after)
    }

    /// Enters text; line breaks become spaces.
    pub fn paste(&mut self, text: &str) {
        text.chars().for_each(|letter| self.edit(Edit::Type(letter)));
    }

    /// Obeys a key.
    pub fn edit(&mut self, edit: Edit) {
        match edit {
            Edit::Type(letter) => self.insert(letter),
            Edit::Erase => drop(self.before.pop()),
            Edit::EraseNext => {
                let mut rest = self.after.chars();
                rest.next();
                self.after = rest.as_str().to_owned();
            }
            Edit::EraseWord => {
                let kept = self.before.trim_end().rfind(' ').map_or(0, |space| space + 1);
                self.before.truncate(kept);
            }
            Edit::EraseAll => *self = Self::default(),
            Edit::Left => self.after.extend_front(self.before.pop()),
            Edit::Right => {
                let mut rest = self.after.chars();
                self.before.extend(rest.next());
                self.after = rest.as_str().to_owned();
            }
            Edit::Start => {
                *self = Self { before: String::new(), after: [&*self.before, &*self.after].concat() }
            }
            Edit::End => {
                *self = Self { before: [&*self.before, &*self.after].concat(), after: String::new() }
            }
        }
    }

    fn insert(&mut self, letter: char) {
        let letter = if letter.is_whitespace() { ' ' } else { letter };
        let length = self.before.chars().count() + self.after.chars().count();
        if !letter.is_control() && length < MAX_LENGTH {
            self.before.push(letter);
        }
    }
}

trait ExtendFront {
    fn extend_front(&mut self, letter: Option<char>);
}

impl ExtendFront for String {
    fn extend_front(&mut self, letter: Option<char>) {
        if let Some(letter) = letter {
            self.insert(0, letter);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(text: &str, edits: &[Edit]) -> (String, String) {
        let mut field = Field::new(text);
        edits.iter().for_each(|&edit| field.edit(edit));
        (field.before, field.after)
    }

    fn parts(before: &str, after: &str) -> (String, String) {
        (before.to_owned(), after.to_owned())
    }

    #[test]
    fn the_cursor_goes_where_it_is_sent() {
        use Edit::{End, Erase, EraseAll, EraseNext, EraseWord, Left, Right, Start, Type};
        assert_eq!(typed("two cats", &[Left, Left]), parts("two ca", "ts"));
        assert_eq!(typed("two cats", &[Start, Right, Erase, Erase]), parts("", "wo cats"));
        assert_eq!(typed("two cats", &[Start, EraseNext, End, Type('!')]), parts("wo cats!", ""));
        assert_eq!(typed("two cats ", &[EraseWord]), parts("two ", ""));
        assert_eq!(typed("cats", &[EraseWord, EraseWord]), parts("", ""));
        assert_eq!(typed("two cats", &[Left, EraseAll, Left, Right]), parts("", ""));
        assert_eq!(typed("zwei Bären", &[Left, Left, Left, Left, Erase, Type('Ä')]), parts("zwei Ä", "ären"));
    }

    #[test]
    fn control_characters_and_floods_stay_out() {
        let mut field = Field::new("a\u{1b}[2Jb\nc");
        assert_eq!(field.text(), "a[2Jb c");
        field.paste(&"x".repeat(2 * MAX_LENGTH));
        assert_eq!(field.text().chars().count(), MAX_LENGTH);
    }
}
