//! What the terminal can show: characters, colours, pictures. Read once from the environment, then a value.

use glam::UVec2;
use ratatui::layout::Size;
use ratatui_image::FontSize;
use ratatui_image::picker::cap_parser::QueryStdioOptions;
use ratatui_image::picker::{Picker, ProtocolType};

use crate::error::AnnotateError;

/// Width and height of a cell where the terminal does not say, pixels.
const USUAL_CELL: FontSize = FontSize { width: 10, height: 20 };

/// Which colours the terminal takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Colours {
    /// None, because of NO_COLOR or the terminal.
    None,
    /// The 256 of xterm.
    Palette,
    Full,
}

/// What the terminal can show.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    /// Whether more than ASCII is understood.
    pub(crate) unicode: bool,
    pub(crate) colours: Colours,
    /// Whether pictures are pixels, by a protocol of the terminal, and not characters.
    pub(crate) pixels: bool,
    /// Pixels of a cell; only their ratio matters for characters.
    pub(crate) cell: FontSize,
}

/// The variables that decide, so that tests can set them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Environment {
    /// `LC_ALL`, `LC_CTYPE` or `LANG`, whichever is set first.
    pub(crate) locale: String,
    pub(crate) term: String,
    pub(crate) colorterm: String,
    pub(crate) no_color: String,
    pub(crate) tmux: String,
}

impl Environment {
    pub(crate) fn of_process() -> Self {
        let var = |name: &str| std::env::var(name).unwrap_or_default();
        let locale = ["LC_ALL", "LC_CTYPE", "LANG"].map(var).into_iter().find(|value| !value.is_empty());
        Self {
            locale: locale.unwrap_or_default(),
            term: var("TERM"),
            colorterm: var("COLORTERM"),
            no_color: var("NO_COLOR"),
            tmux: var("TMUX"),
        }
    }

    /// What can be shown without asking the terminal.
    ///
    /// # Errors
    /// The terminal cannot place text.
    pub(crate) fn look(&self) -> Result<Look, AnnotateError> {
        if self.term.is_empty() || self.term == "dumb" {
            return Err(AnnotateError::DumbTerminal(self.term.clone()));
        }
        let locale = self.locale.to_lowercase();
        Ok(Look {
            // The console of Linux has room for few letters.
            unicode: (locale.contains("utf-8") || locale.contains("utf8")) && self.term != "linux",
            colours: self.colours(),
            pixels: false,
            cell: USUAL_CELL,
        })
    }

    fn colours(&self) -> Colours {
        let is_monochrome =
            self.term.starts_with("vt") || self.term.contains("mono") || self.term.ends_with("-m");
        let is_full = ["truecolor", "24bit"].contains(&self.colorterm.as_str())
            || ["direct", "kitty", "ghostty", "foot", "alacritty", "wezterm"]
                .iter()
                .any(|name| self.term.contains(name))
            // tmux takes all colours and translates them for the terminal outside.
            || !self.tmux.is_empty();
        match (self.no_color.is_empty(), is_monochrome, is_full) {
            (false, _, _) | (_, true, _) => Colours::None,
            (_, _, true) => Colours::Full,
            (_, _, false) => Colours::Palette,
        }
    }
}

impl Look {
    /// Asks the terminal what it can do; gives what encodes pixels, where pixels are shown. The terminal has to be in
    /// raw mode, and nothing else may read from it meanwhile.
    pub(crate) fn ask(mut self) -> (Self, Option<Picker>) {
        // Compressing takes the painter a moment; not compressing takes a slow line many.
        let questions = QueryStdioOptions { kitty_compression: true, ..QueryStdioOptions::default() };
        let Ok(picker) = Picker::from_query_stdio_with_options(questions) else { return (self, None) };
        let font = picker.font_size();
        if font.width > 0 && font.height > 0 {
            self.cell = font;
        }
        let kind = picker.protocol_type();
        // Kitty's pictures are behind characters that are not ASCII.
        self.pixels = kind != ProtocolType::Halfblocks && (kind != ProtocolType::Kitty || self.unicode);
        (self, self.pixels.then_some(picker))
    }

    /// How many times as many cells wide as high a picture of so many pixels is.
    pub(crate) fn aspect(&self, picture: UVec2) -> f64 {
        let [width, height] = [picture.x, picture.y].map(|side| f64::from(side.max(1)));
        width / height * f64::from(self.cell.height) / f64::from(self.cell.width)
    }

    /// The most cells inside an area that have the shape of a picture.
    pub(crate) fn fit(&self, picture: UVec2, area: Size) -> Size {
        let aspect = self.aspect(picture);
        let (width, height) = (f64::from(area.width), f64::from(area.height));
        let fitted = (width.min(height * aspect), height.min(width / aspect));
        Size::new((fitted.0.round() as u16).max(1), (fitted.1.round() as u16).max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn environment(term: &str, colorterm: &str, locale: &str) -> Environment {
        let [term, colorterm, locale] = [term, colorterm, locale].map(str::to_owned);
        Environment { term, colorterm, locale, ..Environment::default() }
    }

    #[test]
    fn the_environment_decides_over_characters_and_colours() {
        let seen = |term: &str, colorterm: &str, locale: &str| {
            let look = environment(term, colorterm, locale).look().unwrap();
            (look.unicode, look.colours)
        };
        assert_eq!(seen("xterm-256color", "truecolor", "en_GB.UTF-8"), (true, Colours::Full));
        assert_eq!(seen("xterm-kitty", "", "C.utf8"), (true, Colours::Full));
        assert_eq!(seen("xterm-256color", "", "de_DE@euro"), (false, Colours::Palette));
        assert_eq!(seen("linux", "", "C.UTF-8"), (false, Colours::Palette));
        assert_eq!(seen("vt100", "", ""), (false, Colours::None));
        let refused = Environment { no_color: "1".to_owned(), ..environment("xterm", "truecolor", "C") };
        assert_eq!(refused.look().unwrap().colours, Colours::None);
        let in_tmux = Environment { tmux: "socket".to_owned(), ..environment("screen-256color", "", "C") };
        assert_eq!(in_tmux.look().unwrap().colours, Colours::Full);
        for term in ["", "dumb"] {
            assert!(matches!(environment(term, "", "C").look(), Err(AnnotateError::DumbTerminal(_))));
        }
    }

    #[test]
    fn pictures_keep_their_shape() {
        let look = environment("xterm", "", "C").look().unwrap();
        // 4:3 in cells twice as high as wide is 8:3.
        for (area, fitted) in
            [([51, 19], [51, 19]), ([80, 19], [51, 19]), ([32, 40], [32, 12]), ([1, 1], [1, 1])]
        {
            let [area, fitted] = [area, fitted].map(|[width, height]| Size::new(width, height));
            assert_eq!(look.fit(UVec2::new(256, 192), area), fitted);
        }
    }
}
