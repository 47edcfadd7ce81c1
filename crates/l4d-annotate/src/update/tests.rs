use std::time::Duration;

use l4d_data::Interval;
use l4d_votes::{Answer, Choice, Event};
use ratatui::layout::Size;

use crate::look::Colours;
use crate::message::Message;
use crate::model::Mode;
use crate::testing::{Driver, Fixture, look, name};

/// Where the session is after each step, one line per step: item, mode, draft, notice, and what was logged meanwhile.
fn transcript(driver: &mut Driver, steps: &[&str]) -> String {
    let mut lines = String::new();
    for step in steps {
        let before = driver.events.len();
        match *step {
            "disk full" => driver.disk_is_full = true,
            "disk free" => driver.disk_is_full = false,
            keys => driver.keys(keys),
        }
        let model = &driver.model;
        let mode = match &model.mode {
            Mode::Choose => "choose".to_owned(),
            Mode::When => "when".to_owned(),
            Mode::Reason(field) => format!("reason {:?}", field.text()),
            Mode::Comment(field) => format!("comment {:?}", field.text()),
            Mode::Summary { selected, sealing } => {
                format!("summary {selected}{}", if *sealing { " sealing" } else { "" })
            }
            Mode::Leave => "leave".to_owned(),
        };
        let draft = model.draft.answer(model.scene()).map_or("nothing".to_owned(), |answer| said(&answer));
        let (answered, skipped) = model.progress();
        let question = &model.question().id;
        let flags =
            [(model.help, " HELP"), (driver.ballot.is_sealed(), " SEALED"), (driver.is_over, " OVER")];
        let flags: String = flags.into_iter().filter(|(is_set, _)| *is_set).map(|(_, word)| word).collect();
        lines.push_str(&format!(
            "{step}\n    {question} {mode}, draft {draft}, {answered} answered, {skipped} skipped{flags}\n"
        ));
        if !driver.notice().is_empty() {
            lines.push_str(&format!("    \"{}\"\n", driver.notice()));
        }
        for (item, event, _, _) in &driver.events[before..] {
            let event = match event {
                Event::Choose(answer) => format!("choose {}", said(answer)),
                Event::Comment { text } => format!("comment {text:?}"),
                other => format!("{other:?}").to_lowercase(),
            };
            lines.push_str(&format!("    log {item}: {event}\n"));
        }
    }
    lines
}

fn said(answer: &Answer) -> String {
    let choice = match &answer.choice {
        Choice::Ambiguous { reason } => format!("(ambiguous: {reason})"),
        choice => choice.label(),
    };
    format!("{choice} {}..{}", answer.frames.first(), answer.frames.last())
}

/// Snapshots of a session of its own for each list of steps.
macro_rules! transcripts {
    ($($name:ident: [$($step:expr),+ $(,)?];)+) => {$(
        #[test]
        fn $name() {
            insta::assert_snapshot!(transcript(&mut Fixture::new().drive(), &[$($step),+]));
        }
    )+};
}

transcripts! {
    numbers_then_time_then_the_next_item: ["14<Enter>", "<Enter>"];
    the_time_is_that_of_the_frames_where_the_keys_were_pressed: [
        "1<Enter><Right><Right>[<End><Left>]", "<Enter>",
        // An end before the start moves the start, and the other way round.
        "1<Enter><End>[<Home>]", "<Enter>",
        "1<Enter><Right>]w", "<Enter>",
    ];
    none_and_ambiguous_are_asked_for_no_time: ["12<Right>]n", "<Enter>", "a<Enter>", "  two q of 3 <Enter>"];
    enter_without_an_answer_saves_nothing: ["<Enter>", "1<Enter><Backspace>", "<Enter>", "nn<Enter>", "9", "<Enter>"];
    what_the_log_refuses_is_not_taken_and_stays_in_the_editor: [
        "disk full", "2<Enter><Right>[<Enter>", "s", "csome words<Enter>", "<Esc>a", "several<Enter>",
        // Once there is room again the same answer can be saved.
        "disk free", "<Enter>",
    ];
    a_seal_needs_nothing_open_and_a_yes: [
        "1<Enter><Enter>", "s", "1<Enter><Enter>", "SS", "<Esc>1<Enter><Enter>", "S<Enter>", "disk full", "Sy",
        "disk free", "Sy",
        // Nothing can be opened any more.
        "<Enter><Esc>u", "q",
    ];
    undo_takes_back_what_was_not_saved_then_this_item_then_the_latest: [
        "1<Enter><Enter>", "2<Enter><Enter>", "3u", "u", "4<Enter><Enter>", "<<u", "u",
    ];
    undo_of_a_skip_and_a_comment_say_so: ["s", "u", "chello<Enter>", "u", "u"];
    drafts_wait_where_they_were_left_and_leaving_asks: ["13>2<", ">", "q", "x", "qq"];
    leaving_without_a_draft_asks_nothing: ["1<Enter><Enter>q"];
    items_end_where_they_end: ["<", ">>>", ">"];
    after_the_last_item_come_the_open_ones_before_it: [">>>n<Enter>"];
    changing_an_answer_replaces_it_and_saving_it_again_writes_nothing: ["n<Enter>", "<<Enter>", "<n1<Enter><Enter>"];
    any_key_closes_the_help_page_and_does_nothing_else: ["?", "s"];
}

#[test]
fn numbers_are_drawn_by_lot_and_stay() {
    let fixture = Fixture::new();
    let again = crate::scene::load(&fixture.data(), &fixture.round, &name("ada")).unwrap();
    assert_eq!(again, *fixture.scenes);
    let order = |annotator: &str| {
        let scenes = crate::scene::load(&fixture.data(), &fixture.round, &name(annotator)).unwrap();
        scenes[&name("yard")].objects.iter().map(|object| object.id).collect::<Vec<u32>>()
    };
    let orders: std::collections::BTreeSet<Vec<u32>> =
        ["ada", "ben", "cyd", "dan", "eve"].into_iter().map(order).collect();
    assert!(orders.len() > 2, "{orders:?}");
}

#[test]
fn views_are_the_held_out_one_and_those_far_from_it() {
    let fixture = Fixture::new();
    // Cameras stand at 0, 1 (held out) and 5 metres.
    assert_eq!(fixture.scenes[&name("yard")].views, [name("cam01"), name("cam02")]);
}

#[test]
fn a_session_goes_on_at_the_first_open_item() {
    let fixture = Fixture::new();
    let mut questions = fixture.questions();
    questions[0].response.answer = Some(Answer { choice: Choice::None, frames: Interval::WHOLE });
    questions[1].response.skipped = true;
    let look = look(true, Colours::Full);
    let model = fixture.model(look, Size::new(80, 24), questions.clone());
    assert_eq!((model.at, &model.mode), (2, &Mode::Choose));
    for question in &mut questions {
        question.response.skipped = true;
    }
    assert!(matches!(fixture.model(look, Size::new(80, 24), questions).mode, Mode::Summary { .. }));
}

#[test]
fn only_painted_pictures_count_as_seen() {
    let mut driver = Fixture::new().drive();
    driver.paints = false;
    driver.keys("<Right><Right>");
    driver.paint();
    driver.keys("<Down>");
    driver.paint();
    driver.now = Duration::from_secs(5);
    driver.keys("n<Enter>");
    let (_, _, seen, elapsed) = &driver.events[0];
    assert_eq!(seen.frames, [0, 24].into());
    assert_eq!(seen.views, [name("cam01"), name("cam02")].into());
    assert_eq!(*elapsed, Duration::from_secs(5));
    // The next item starts anew.
    assert!(driver.model.seen.frames.is_empty() && driver.model.frame == 0 && driver.model.view == 0);
}

#[test]
fn requests_follow_what_is_looked_at_and_are_not_repeated() {
    let mut driver = Fixture::new().drive();
    assert_eq!(driver.requests.len(), 1);
    driver.keys("<Left>w[<Esc>");
    assert_eq!(driver.requests.len(), 1);
    driver.keys("<Right>x+");
    assert_eq!(driver.requests.len(), 4);
    let last = driver.requests.last().unwrap();
    assert!(last.frame == 12 && !last.outlines && last.region.last_col - last.region.first_col < 100);
}

#[test]
fn a_picture_that_cannot_be_shown_says_why_and_the_next_one_is_tried() {
    let mut driver = Fixture::new().drive();
    driver.paints = false;
    driver.keys("<Right>");
    let request = driver.requests.last().unwrap().clone();
    driver.tell(Message::NotPainted(request, "it is torn".to_owned()));
    assert!(driver.text().contains("it is torn"));
    assert!(!driver.model.is_loading());
    driver.paints = true;
    driver.keys("<Right>");
    assert!(!driver.text().contains("torn"));
}

#[test]
fn playing_waits_for_pictures_and_starts_over_at_the_end() {
    let mut driver = Fixture::new().drive();
    let step = driver.model.frame_time();
    // Every twelfth of 24 frames a second.
    assert_eq!(step.as_millis(), 499);
    driver.keys(" ");
    driver.tell(Message::Tick);
    assert_eq!(driver.model.frame_number(), 0);
    driver.paints = false;
    driver.now += step;
    driver.tell(Message::Tick);
    assert_eq!((driver.model.frame_number(), driver.model.wakes_at()), (12, None));
    driver.now += step;
    driver.tell(Message::Tick);
    assert_eq!(driver.model.frame_number(), 12);
    driver.paint();
    driver.paints = true;
    let mut passed = Vec::new();
    for _ in 0..9 {
        driver.now += step;
        driver.tell(Message::Tick);
        passed.push(driver.model.frame_number());
    }
    assert_eq!(passed, [24, 36, 48, 60, 72, 84, 96, 0, 12]);
    driver.keys(" ");
    assert_eq!(driver.model.wakes_at(), None);
}

#[test]
fn while_the_time_is_asked_for_only_that_time_plays() {
    let mut driver = Fixture::new().drive();
    driver.keys("1<Enter><Right>[<Right><Right>] ");
    let mut passed = Vec::new();
    for _ in 0..4 {
        driver.now += driver.model.frame_time();
        driver.tell(Message::Tick);
        passed.push(driver.model.frame_number());
    }
    assert_eq!(passed, [12, 24, 36, 12]);
}

#[test]
fn zoom_goes_to_what_is_chosen_and_back() {
    let mut driver = Fixture::new().drive();
    let c = driver.number("disc_c");
    driver.keys(&format!("{c}z"));
    let region = driver.requests.last().unwrap().region;
    // Disc c spans columns 87 to 113 and rows 27 to 53, 27 of 96: 1.4 times as large it fills two fifths.
    assert!((30..87).contains(&region.first_col) && region.last_col > 113, "{region:?}");
    assert!((1..27).contains(&region.first_row) && (54..80).contains(&region.last_row), "{region:?}");
    driver.keys("z");
    assert!(driver.model.viewport.is_whole());
}

#[test]
fn an_export_names_item_view_and_frame_only() {
    let mut driver = Fixture::new().drive();
    driver.keys("<Down><Right>o");
    assert_eq!(driver.exported[0].file_name, "q0001-view2-frame0012.png");
    driver.tell(Message::Exported(Ok("Wrote here".to_owned())));
    assert_eq!(driver.notice(), "Wrote here");
}

#[test]
fn pictures_of_another_scene_or_of_before_are_not_shown_as_new() {
    let mut driver = Fixture::new().drive();
    driver.paints = false;
    driver.keys("<Right>");
    assert!(driver.model.is_loading() && driver.model.picture().is_some());
    driver.keys(">");
    assert!(driver.model.picture().is_none());
    assert!(driver.text().contains("loading ..."));
}
