//! What the tests of the client share.

#![allow(dead_code, clippy::allow_attributes, reason = "each test target uses its own part of it")]

use l4d_endpoint::{Client, Endpoint, Image, Link, Message, Part, Request};

use crate::scripted::Server;

/// An endpoint in front of a scripted server, with short pauses.
pub(crate) fn endpoint(server: &Server) -> Endpoint {
    patient(&server.url())
}

pub(crate) fn patient(url: &str) -> Endpoint {
    let mut endpoint = Endpoint::new(url, "tiny").unwrap();
    endpoint.retry.tries = 3;
    endpoint.retry.first_pause_seconds = 0.002;
    endpoint.timeouts.request_seconds = 20.0;
    endpoint.timeouts.total_seconds = 30.0;
    endpoint
}

pub(crate) fn client(server: &Server) -> Client {
    Client::open(endpoint(server), &Link::Live).unwrap()
}

pub(crate) fn question(text: &str) -> Request {
    Request::new(vec![Message::user(vec![Part::text(text)])])
}

/// A picture of one grey, so that every grey gives other bytes.
pub(crate) fn picture(grey: u8) -> Image {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 40, 30);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[grey; 40 * 30]).unwrap();
    writer.finish().unwrap();
    Image::new(file).unwrap()
}
