//! Where things are on the screen: a function of its size, the prompt and the shape of the picture.

use ratatui::layout::{Rect, Size};
use ratatui::text::Span;

/// Below this nothing useful fits.
pub(crate) const SMALLEST: Size = Size { width: 80, height: 20 };
/// The panel's least and most columns.
const PANEL_WIDTH: (u16, u16) = (28, 48);
/// Screens with this many rows can spare some for air.
const ROOMY_ROWS: u16 = 32;
/// Narrower screens keep two lines for the prompt, so that the picture does not change its size from item to item.
const WIDE_COLUMNS: u16 = 100;
const TIMELINE_ROWS: u16 = 2;

/// The areas of the screen of an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Screen {
    /// Round, annotator, progress.
    pub(crate) header: Rect,
    pub(crate) prompt: Rect,
    /// The picture, which may fill less of it.
    pub(crate) picture: Rect,
    /// Answer, messages, keys.
    pub(crate) panel: Rect,
    /// Current frame, and when the answer holds.
    pub(crate) timeline: Rect,
}

/// The areas for a prompt and a picture that is `aspect` times as many cells wide as high.
pub(crate) fn screen(size: Size, prompt: &str, aspect: f64) -> Option<Screen> {
    if size.width < SMALLEST.width || size.height < SMALLEST.height {
        return None;
    }
    let Size { width, height } = size;
    let air = u16::from(height >= ROOMY_ROWS);
    let least = if width < WIDE_COLUMNS { 2 } else { 1 };
    let lines = wrap(prompt, width - 2).len().clamp(least, usize::from(height / 4)) as u16;
    let prompt_top = 1 + air;
    let body_top = prompt_top + lines + air;
    let body_height = height - body_top - TIMELINE_ROWS;
    let ideal = (f64::from(body_height) * aspect).round() as u16;
    let picture_width = ideal.min(width - PANEL_WIDTH.0 - 1);
    let panel_width = (width - picture_width - 1).min(PANEL_WIDTH.1);
    Some(Screen {
        header: Rect::new(0, 0, width, 1),
        prompt: Rect::new(1, prompt_top, width - 2, lines),
        picture: Rect::new(0, body_top, picture_width, body_height),
        panel: Rect::new(picture_width + 1, body_top, panel_width, body_height),
        timeline: Rect::new(0, height - TIMELINE_ROWS, width, TIMELINE_ROWS),
    })
}

/// The bar of the timeline: column 0 of it is the first frame, its last column the last one.
pub(crate) fn timeline_bar(timeline: Rect) -> Rect {
    /// Room for what is beside the bar: a sign on the left, frame and time on the right.
    const BESIDE: (u16, u16) = (3, 20);
    let width = timeline.width.saturating_sub(BESIDE.0 + BESIDE.1);
    Rect::new(timeline.x + BESIDE.0, timeline.y, width, timeline.height)
}

/// Breaks text between words so that no line is wider than `columns`; longer words are cut.
pub(crate) fn wrap(text: &str, columns: u16) -> Vec<String> {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    textwrap::wrap(&text, usize::from(columns.max(1))).into_iter().map(String::from).collect()
}

pub(crate) fn width(text: &str) -> usize {
    Span::raw(text).width()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASPECT: f64 = 8.0 / 3.0;

    #[test]
    fn the_areas_tile_the_screen() {
        for (width, height) in [(80, 20), (80, 24), (100, 30), (160, 48), (300, 90), (81, 90), (400, 20)] {
            let size = Size::new(width, height);
            let screen = screen(size, &"word ".repeat(40), ASPECT).unwrap();
            let whole = Rect::new(0, 0, width, height);
            let areas = [screen.header, screen.prompt, screen.picture, screen.panel, screen.timeline];
            for (index, area) in areas.iter().enumerate() {
                assert_eq!(area.intersection(whole), *area, "{size}");
                assert!(area.area() > 0, "{size}");
                assert!(areas[..index].iter().all(|other| !other.intersects(*area)), "{size}");
            }
        }
    }

    #[test]
    fn at_80x24_the_picture_gets_what_is_left() {
        let screen = screen(Size::new(80, 24), "The cat", ASPECT).unwrap();
        assert_eq!(screen.picture, Rect::new(0, 3, 51, 19));
        assert_eq!(screen.panel, Rect::new(52, 3, 28, 19));
    }

    #[test]
    fn small_screens_are_refused() {
        assert_eq!(screen(Size::new(79, 24), "x", ASPECT), None);
        assert_eq!(screen(Size::new(80, 19), "x", ASPECT), None);
        assert_eq!(screen(Size::new(0, 0), "x", ASPECT), None);
    }

    #[test]
    fn text_breaks_between_words_and_long_words_are_cut() {
        assert_eq!(wrap("the cat that runs", 8), ["the cat", "that", "runs"]);
        assert_eq!(wrap("a pneumonoultramicro b", 8), ["a", "pneumono", "ultramic", "ro b"]);
        assert_eq!(wrap("", 8), [""]);
        assert_eq!(wrap("日本語", 4), ["日本", "語"]);
    }
}
