//! What the tests of the client share.

use std::fs;
use std::path::Path;

use l4d_endpoint::{Client, Endpoint, Image, Link, Message, Part, Request};

use crate::scripted::{Server, Turn, says, thinks};

/// An endpoint of this URL, with short pauses.
pub(crate) fn patient(url: &str) -> Endpoint {
    let mut endpoint = Endpoint::new(url, "tiny").unwrap();
    endpoint.retry.tries = 3;
    endpoint.retry.first_pause_seconds = 0.002;
    endpoint.timeouts.request_seconds = 20.0;
    endpoint.timeouts.total_seconds = 30.0;
    endpoint
}

/// A client of a scripted server.
pub(crate) fn client(server: &Server) -> Client {
    client_with(server, |_| ())
}

/// The same with an edited endpoint.
pub(crate) fn client_with(server: &Server, edit: impl FnOnce(&mut Endpoint)) -> Client {
    let mut endpoint = patient(&server.url());
    edit(&mut endpoint);
    Client::open(endpoint, &Link::Live).unwrap()
}

pub(crate) fn question(text: &str) -> Request {
    Request::new(vec![Message::user(vec![Part::text(text)])])
}

/// Pictures with their times, and a question about them.
pub(crate) fn with_pictures(images: &[Image]) -> Request {
    let mut parts = Vec::new();
    for (index, image) in images.iter().enumerate() {
        parts.push(Part::text(format!("<{index}.0 seconds>")));
        parts.push(Part::Image(image.clone()));
    }
    parts.push(Part::text("What moves?"));
    Request::new(vec![Message::system("Be brief."), Message::user(parts)])
}

/// A picture of one grey, so that every grey gives other bytes.
pub(crate) fn picture(grey: u8) -> Image {
    plain(40, 30, grey)
}

pub(crate) fn plain(width: u32, height: u32, grey: u8) -> Image {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![grey; (width * height) as usize]).unwrap();
    writer.finish().unwrap();
    Image::new(file).unwrap()
}

/// Answers with what it was asked, so that no answer can be mistaken for another.
pub(crate) fn echo() -> Turn {
    thinks(|seen| says(&seen.json()["messages"][0]["content"].to_string()))
}

/// Paths and contents of all files in a folder.
pub(crate) fn files_under(folder: &Path) -> String {
    let mut contents = String::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        contents += &match path.is_dir() {
            true => files_under(&path),
            false => format!("{}\n{}", path.display(), fs::read_to_string(&path).unwrap()),
        };
    }
    contents
}
