use std::sync::Arc;
use std::time::Duration;

use l4d_data::layout::SceneDir;
use l4d_masks::mask::PixelBox;
use ratatui::layout::Size;

use super::*;
use crate::look::Colours;
use crate::picture::{Art, Picture};
use crate::testing::{Fixture, look, name};

const WHOLE: PixelBox = PixelBox { first_col: 0, first_row: 0, last_col: 127, last_row: 95 };

fn request_of(frame: u32) -> PictureRequest {
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

fn open_thread(fixture: &Fixture) -> (PaintThread, Receiver<Message>) {
    let (send, news) = mpsc::channel();
    let painter = fixture.painter(look(true, Colours::Full));
    let paint_thread = PaintThread::open(painter, move |message| drop(send.send(message)), || {});
    (paint_thread, news)
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
fn a_request_becomes_a_picture_with_its_numbers() {
    let fixture = Fixture::new();
    let (paint_thread, news) = open_thread(&fixture);
    paint_thread.paint(request_of(0), Vec::new());
    let picture = painted(next(&news));
    assert_eq!(picture.request, request_of(0));
    let Art::Cells { cells, labels } = &picture.art else { panic!("{:?}", picture.art) };
    assert_eq!((cells.len(), labels.len()), (51 * 19, 4));
    // Disc c is centred at pixel (100, 40): cell 100 * 51 / 128, 40 * 19 / 96.
    let c = labels.iter().find(|label| label.id == 3).unwrap();
    assert!(c.at.x.abs_diff(39) <= 1 && c.at.y.abs_diff(7) <= 1, "{c:?}");
}

#[test]
fn of_many_requests_the_last_is_painted_and_not_all_are() {
    let fixture = Fixture::new();
    let (paint_thread, news) = open_thread(&fixture);
    for turn in 0..400 {
        // A different zoom each time, so that none can be recalled.
        let request = PictureRequest {
            region: PixelBox { first_col: turn % 50, ..WHOLE },
            ..request_of(12 * (turn % 9))
        };
        paint_thread.paint(request, Vec::new());
    }
    paint_thread.paint(request_of(96), Vec::new());
    let mut frames = Vec::new();
    while frames.last() != Some(&request_of(96)) {
        frames.push(painted(next(&news)).request.clone());
    }
    assert!(frames.len() < 200, "{} requests were painted", frames.len());
}

#[test]
fn requests_that_keep_coming_do_not_starve_the_screen() {
    let fixture = Fixture::new();
    let (paint_thread, news) = open_thread(&fixture);
    let mut painted = 0;
    let mut turns = 0..40_000_000;
    while painted < 3 {
        let first_row = turns.next().expect("requests never end in a picture") % 40;
        paint_thread
            .paint(PictureRequest { region: PixelBox { first_row, ..WHOLE }, ..request_of(0) }, Vec::new());
        painted += news.try_iter().count();
        std::thread::yield_now();
    }
}

#[test]
fn a_torn_frame_is_reported_with_its_path_and_a_hint() {
    let fixture = Fixture::new();
    let path = SceneDir::new(&fixture.data(), "yard").frame("cam01", 24);
    std::fs::write(&path, b"not an EXR").unwrap();
    let (paint_thread, news) = open_thread(&fixture);
    paint_thread.paint(request_of(24), Vec::new());
    match next(&news) {
        Message::NotPainted(request, why) => {
            assert_eq!(request, request_of(24));
            assert!(why.contains("0024.exr") && why.contains("l4d build-scenes"), "{why}");
        }
        other => panic!("{other:?}"),
    }
    // The next request is none the worse for it.
    paint_thread.paint(request_of(36), vec![24]);
    assert_eq!(painted(next(&news)).request.frame, 36);
}

#[test]
fn an_export_is_a_large_picture_with_outlines_or_says_why_there_is_none() {
    let fixture = Fixture::new();
    let (paint_thread, news) = open_thread(&fixture);
    let export = || {
        let (scene, view, file_name) = (name("yard"), name("cam01"), "q0001.png".to_owned());
        paint_thread.export(ExportRequest { scene, view, frame: 12, chosen: [3].into(), file_name });
        match next(&news) {
            Message::Exported(said) => said,
            other => panic!("{other:?}"),
        }
    };
    assert!(export().unwrap().contains("q0001.png"));
    let bytes = std::fs::read(fixture.exports().join("q0001.png")).unwrap();
    // Width and height are at fixed places of a PNG.
    let side = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!((side(16), side(20)), (1024, 768));
    std::fs::remove_dir_all(fixture.exports()).unwrap();
    std::fs::write(fixture.exports(), "a file, not a folder").unwrap();
    assert!(export().unwrap_err().contains("exports"));
}

#[test]
fn a_panic_of_the_painter_raises_the_alarm() {
    let fixture = Fixture::new();
    let (alarm, raised) = mpsc::channel();
    let painter = fixture.painter(look(true, Colours::Full));
    let paint_thread = PaintThread::open(
        painter,
        |_| panic!("as if the painter had a fault"),
        move || {
            alarm.send(()).unwrap();
        },
    );
    paint_thread.paint(request_of(0), Vec::new());
    raised.recv_timeout(Duration::from_secs(30)).unwrap();
}
