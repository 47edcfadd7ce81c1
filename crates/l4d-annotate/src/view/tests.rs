use ratatui::layout::Size;
use ratatui::style::{Color, Modifier};

use crate::look::Colours;
use crate::message::Message;
use crate::testing::{Driver, Fixture, look};

fn driver(unicode: bool, colours: Colours, width: u16, height: u16) -> Driver {
    Fixture::new().drive_with(look(unicode, colours), Size::new(width, height))
}

#[test]
fn an_item_at_80x24() {
    let mut driver = driver(true, Colours::Full, 80, 24);
    let number = driver.number("disc_c");
    driver.keys(&format!("{number}<Right>"));
    insta::assert_snapshot!(driver.text());
}

#[test]
fn the_time_is_asked_at_160x48() {
    let mut driver = driver(true, Colours::Full, 160, 48);
    driver.keys("12<Enter><Right>[<End><Left>]");
    insta::assert_snapshot!(driver.text());
}

#[test]
fn an_item_without_colours() {
    let mut driver = driver(true, Colours::None, 80, 24);
    driver.keys("2");
    insta::assert_snapshot!(driver.text());
    let buffer = driver.buffer();
    assert!(buffer.content.iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
    // What is chosen stands out all the same.
    let reversed = buffer.content.iter().filter(|cell| cell.modifier.contains(Modifier::REVERSED));
    let text: String = reversed.map(|cell| cell.symbol()).collect();
    assert_eq!(text, "[2][2]");
}

#[test]
fn an_item_in_ascii_without_colours() {
    let mut driver = driver(false, Colours::None, 80, 24);
    driver.keys("<Right>");
    let text = driver.text();
    assert!(text.is_ascii(), "{text}");
    insta::assert_snapshot!(text);
}

#[test]
fn in_ascii_the_picture_is_made_of_colours() {
    let driver = driver(false, Colours::Palette, 80, 24);
    assert!(driver.text().is_ascii());
    let picture = driver.model.screen().unwrap().picture;
    let buffer = driver.buffer();
    let is_painted = |column: u16, row: u16| matches!(buffer[(column, row)].bg, Color::Indexed(_));
    assert!((picture.y..picture.bottom()).all(|row| is_painted(picture.x, row)));
}

#[test]
fn the_reason_is_typed() {
    let mut driver = driver(true, Colours::Full, 80, 24);
    driver.keys("aboth discs roll, and one of them is only half in the picture<Left><Left>");
    insta::assert_snapshot!(panel(&driver));
}

#[test]
fn the_summary_lists_what_is_left() {
    let mut driver = driver(true, Colours::Full, 80, 24);
    driver.keys("s1<Enter><Enter>S<Down>");
    insta::assert_snapshot!(driver.text());
    driver.keys("<Esc>n<Enter>n<Enter>S");
    insta::assert_snapshot!(driver.text());
}

#[test]
fn the_keys_fit_into_every_screen() {
    let mut usual = driver(true, Colours::Full, 80, 24);
    usual.keys("?");
    insta::assert_snapshot!(usual.text());
    for (width, height) in [(80, 20), (81, 60), (160, 48)] {
        let mut driver = driver(true, Colours::Full, width, height);
        driver.keys("?");
        let text = driver.text();
        let all = crate::keys::HELP.iter().flat_map(|(_, keys)| *keys);
        all.for_each(|(_, what)| assert!(text.contains(what), "{what} is missing at {width}x{height}"));
    }
}

#[test]
fn nothing_of_the_truth_is_on_the_screen() {
    let mut driver = driver(true, Colours::Full, 160, 48);
    let mut screens = driver.text();
    for keys in ["12", "<Enter>", "<Esc>ax", "<Esc>S", "<Esc>?"] {
        driver.keys(keys);
        screens.push_str(&driver.text());
    }
    for secret in ["disc_", "ball_d", "floor", "yard", "cam01", "cam02"] {
        assert!(!screens.contains(secret), "{secret} is shown");
    }
}

#[test]
fn a_prompt_cannot_draw_outside_of_its_lines() {
    let fixture = Fixture::new();
    let mut questions = fixture.questions();
    questions[0].text = format!(
        "The \u{1b}[2J\u{1b}]0;x\u{7}cat\nIGNORE ALL RULES {} 猫 e\u{301} \u{202e}",
        "long ".repeat(300)
    );
    let look = look(true, Colours::Full);
    let model = fixture.model(look, Size::new(80, 24), questions);
    let area = ratatui::layout::Rect::new(0, 0, 80, 24);
    let mut buffer = ratatui::buffer::Buffer::empty(area);
    super::draw(&model, area, &mut buffer);
    let symbols: String = buffer.content.iter().map(|cell| cell.symbol()).collect();
    assert!(!symbols.contains(char::is_control), "{symbols:?}");
    assert!(symbols.contains("enlarge the terminal to read on"));
}

#[test]
fn a_message_outweighs_the_keys() {
    let mut driver = driver(true, Colours::Full, 80, 20);
    driver.tell(Message::Exported(Err("it went wrong ".repeat(20))));
    let text = panel(&driver);
    assert!(text.contains("it went wrong") && !text.contains("? all keys"), "{text}");
}

#[test]
fn every_size_can_be_drawn() {
    let mut driver = driver(true, Colours::Full, 80, 24);
    for (width, height) in [(0, 0), (1, 1), (80, 20), (81, 200), (500, 20), (200, 61), (80, 24)] {
        for keys in ["?", "<Esc>S", "<Esc>a", "<Esc>1<Enter>", "<Esc>"] {
            driver.keys(keys);
            driver.tell(Message::Resize(Size::new(width, height)));
            driver.text();
        }
    }
}

/// The text beside the picture.
fn panel(driver: &Driver) -> String {
    let area = driver.model.screen().unwrap().panel;
    let buffer = driver.buffer();
    let line = |row: u16| {
        let symbols: String = (area.x..area.right()).map(|column| buffer[(column, row)].symbol()).collect();
        symbols.trim_end().to_owned() + "\n"
    };
    (area.y..area.bottom()).map(line).collect()
}
