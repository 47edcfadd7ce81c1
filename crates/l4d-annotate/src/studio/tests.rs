use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

use l4d_data::layout::SceneDir;
use l4d_frames::mask::PixelBox;
use ratatui::layout::Size;

use super::*;
use crate::look::Colours;
use crate::picture::{Art, Picture};
use crate::testing::{Fixture, look, name};

const WHOLE: PixelBox = PixelBox { first_col: 0, first_row: 0, last_col: 127, last_row: 95 };

fn wish(frame: u32) -> PictureRequest {
    PictureRequest {
        scene: name("yard"),
        view: name("cam01"),
        frame,
        region: WHOLE,
        cells: Size::new(51, 19),
        chosen: [2].into(),
        outlines: true,
    }
}

fn open_studio(fixture: &Fixture) -> (Studio, Receiver<Message>) {
    let (send, news) = mpsc::channel();
    let painter = fixture.painter(look(true, Colours::Full));
    let studio = Studio::open(painter, move |message| drop(send.send(message)), || {});
    (studio, news)
}

fn next(news: &Receiver<Message>) -> Message {
    news.recv_timeout(Duration::from_secs(30)).unwrap()
}

fn painted(message: Message) -> Arc<Picture> {
    match message {
        Message::Painted(picture) => picture,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_wish_becomes_a_picture_with_its_numbers() {
    let fixture = Fixture::new();
    let (studio, news) = open_studio(&fixture);
    studio.paint(wish(0), Vec::new());
    let picture = painted(next(&news));
    assert_eq!(picture.request, wish(0));
    let Art::Cells { cells, labels } = &picture.art else { panic!("{:?}", picture.art) };
    assert_eq!((cells.len(), labels.len()), (51 * 19, 4));
    // Disc c is centred at pixel (100, 40): cell 100 * 51 / 128, 40 * 19 / 96.
    let c = labels.iter().find(|label| label.id == 3).unwrap();
    assert!(c.at.x.abs_diff(39) <= 1 && c.at.y.abs_diff(7) <= 1, "{c:?}");
}

#[test]
fn of_many_wishes_the_last_is_fulfilled_and_not_all_are() {
    let fixture = Fixture::new();
    let (studio, news) = open_studio(&fixture);
    for turn in 0..400 {
        // A different zoom each time, so that none can be recalled.
        let request =
            PictureRequest { region: PixelBox { first_col: turn % 50, ..WHOLE }, ..wish(12 * (turn % 9)) };
        studio.paint(request, Vec::new());
    }
    studio.paint(wish(96), Vec::new());
    let mut frames = Vec::new();
    while frames.last() != Some(&wish(96)) {
        frames.push(painted(next(&news)).request.clone());
    }
    assert!(frames.len() < 200, "{} wishes were fulfilled", frames.len());
}

#[test]
fn wishes_that_keep_coming_do_not_starve_the_screen() {
    let fixture = Fixture::new();
    let (studio, news) = open_studio(&fixture);
    let mut painted = 0;
    let started = std::time::Instant::now();
    for turn in 0.. {
        studio.paint(
            PictureRequest { region: PixelBox { first_row: turn % 40, ..WHOLE }, ..wish(0) },
            Vec::new(),
        );
        painted += news.try_iter().count();
        if painted >= 3 {
            return;
        }
        assert!(started.elapsed() < Duration::from_secs(30), "only {painted} pictures");
        std::thread::yield_now();
    }
}

#[test]
fn a_torn_frame_is_reported_with_its_path_and_a_remedy() {
    let fixture = Fixture::new();
    let path = SceneDir::new(&fixture.data(), "yard").frame("cam01", 24);
    std::fs::write(&path, b"not an EXR").unwrap();
    let (studio, news) = open_studio(&fixture);
    studio.paint(wish(24), Vec::new());
    match next(&news) {
        Message::NotPainted(request, why) => {
            assert_eq!(request, wish(24));
            assert!(why.contains("0024.exr") && why.contains("l4d build-scenes"), "{why}");
        }
        other => panic!("{other:?}"),
    }
    // The next wish is none the worse for it.
    studio.paint(wish(36), vec![24]);
    assert_eq!(painted(next(&news)).request.frame, 36);
}

#[test]
fn an_export_is_a_large_picture_with_outlines() {
    let fixture = Fixture::new();
    let (studio, news) = open_studio(&fixture);
    let file_name = "q0001-view1-frame0012.png".to_owned();
    let (scene, view, chosen) = (name("yard"), name("cam01"), [3].into());
    studio.export(ExportRequest { scene, view, frame: 12, chosen, file_name: file_name.clone() });
    match next(&news) {
        Message::Exported(Ok(text)) => assert!(text.contains(&file_name), "{text}"),
        other => panic!("{other:?}"),
    }
    let bytes = std::fs::read(fixture.exports().join(file_name)).unwrap();
    // Width and height stand at fixed places of a PNG.
    let side = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!((side(16), side(20)), (1024, 768));
}

#[test]
fn an_export_that_cannot_be_written_says_why() {
    let fixture = Fixture::new();
    std::fs::write(fixture.exports(), "a file, not a folder").unwrap();
    let (studio, news) = open_studio(&fixture);
    let (scene, view) = (name("yard"), name("cam01"));
    let file_name = "q0001.png".to_owned();
    studio.export(ExportRequest { scene, view, frame: 12, chosen: [].into(), file_name });
    match next(&news) {
        Message::Exported(Err(why)) => assert!(why.contains("exports"), "{why}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_panic_of_the_painter_raises_the_alarm() {
    let fixture = Fixture::new();
    let (alarm, raised) = mpsc::channel();
    let painter = fixture.painter(look(true, Colours::Full));
    let studio = Studio::open(
        painter,
        |_| panic!("as if the painter had a fault"),
        move || {
            alarm.send(()).unwrap();
        },
    );
    studio.paint(wish(0), Vec::new());
    raised.recv_timeout(Duration::from_secs(30)).unwrap();
}
