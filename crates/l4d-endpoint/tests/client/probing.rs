//! What a probe says about good and poor servers, and which convention a calibration finds.

use l4d_endpoint::calibration::{Calibrations, Sample, Score, calibrate};
use l4d_endpoint::probe::{Line, State, probe};
use l4d_endpoint::{BoxPx, Client, Convention, Endpoint, Link};
use serde_json::{Value, json};

use crate::common::{client, patient, picture, plain};
use crate::scripted::{self, Seen, Server, ok, says, status, thinks};

fn lines(server: &Server) -> Vec<Line> {
    probe(&client(server), (&picture(200), "grey"), |_| ())
}

fn states(lines: &[Line]) -> Vec<(&'static str, State)> {
    lines.iter().map(|line| (line.name, line.state)).collect()
}

fn text_of(seen: &Seen) -> String {
    seen.json()["messages"].to_string()
}

#[test]
fn a_good_server_is_called_good() {
    let server = Server::start(vec![thinks(|seen| {
        let body = seen.json();
        let text = text_of(seen);
        if seen.line.starts_with("GET") {
            ok(&json!({"data": [{"id": "other"}, {"id": "tiny"}]}))
        } else if !body["response_format"].is_null() {
            says(r#"{"sky": "clear", "warm": true}"#)
        } else if text.contains("random") {
            says(&format!("word {}", body["seed"]))
        } else if text.contains("How many pictures") {
            let mut said = scripted::completion("3");
            said["usage"]["prompt_tokens"] = 900.into();
            ok(&said)
        } else if text.contains("Which colour") {
            says("Grey.")
        } else {
            says("ready")
        }
    })]);
    let lines = lines(&server);
    let expected = ["key", "models", "chat", "usage", "picture", "pictures", "schema", "seed"];
    assert_eq!(states(&lines), expected.map(|name| (name, State::Ok)), "{lines:#?}");
    assert!(lines.iter().all(|line| line.hint.is_empty()));
}

#[test]
fn a_poor_server_is_told_apart_line_by_line() {
    let server = Server::start(vec![thinks(|seen| {
        let body = seen.json();
        let text = text_of(seen);
        if seen.line.starts_with("GET") {
            ok(&json!({"data": [{"id": "other"}]}))
        } else if text.matches("image_url").count() > 2 {
            status(400, &json!({"error": {"message": "At most 1 image(s) may be provided"}}))
        } else if body["temperature"] != 0.0 {
            status(400, &json!({"error": {"message": "unsupported", "param": "temperature"}}))
        } else {
            let mut said = scripted::completion("I am a small model.");
            said["usage"] = Value::Null;
            ok(&said)
        }
    })]);
    let lines = lines(&server);
    let expected = [
        ("key", State::Ok),
        ("models", State::Unclear),
        ("chat", State::Ok),
        ("usage", State::Lacking),
        ("picture", State::Unclear),
        ("pictures", State::Lacking),
        ("schema", State::Lacking),
        ("seed", State::Lacking),
    ];
    assert_eq!(states(&lines), expected, "{lines:#?}");
    assert!(lines.iter().skip(3).all(|line| !line.hint.is_empty()), "{lines:#?}");
    assert!(lines[1].hint.contains("other"));
}

#[test]
fn a_server_that_is_down_is_looked_at_no_longer_than_needed() {
    let server = Server::start(vec![status(401, &json!({"error": "who are you?"}))]);
    let lines = lines(&server);
    let expected = [("key", State::Ok), ("models", State::Lacking), ("chat", State::Failed)];
    assert_eq!(states(&lines), expected);
    assert!(lines[2].hint.contains("api_key_env"), "{lines:#?}");
}

#[test]
fn a_key_in_the_clear_is_warned_about() {
    let server = Server::start(vec![says("ready")]);
    let mut endpoint = patient(&server.url());
    endpoint.api_key_env = Some("A_KEY".to_owned());
    endpoint.base_url = "http://gpu-box.invalid:8000/v1".parse().unwrap();
    let key = |_: &str| Some("0123456789".into());
    let client = Client::open_in(endpoint, &Link::Live, &key).unwrap();
    let line = probe(&client, (&picture(1), "grey"), |_| ()).remove(0);
    assert_eq!(line.state, State::Lacking);
    assert!(line.hint.contains("https"));
}

const SIZE: (u32, u32) = (714, 490);

#[test]
fn a_convention_is_asked_for_by_its_own_field_name_and_half_the_squares_will_do() {
    let square = |colour: &str, x: f64, y: f64| {
        (colour.to_owned(), BoxPx { x0: x, y0: y, x1: x + 100.0, y1: y + 100.0 })
    };
    let squares = vec![square("red", 40.0, 350.0), square("blue", 580.0, 60.0)];
    let sample = Sample { image: plain(SIZE.0, SIZE.1, 1), squares };
    for convention in Convention::all() {
        // The numbers are rounded, as models write them.
        let numbers =
            convention.numbers(sample.squares[0].1, SIZE).map(|number| (number * 1e3).round() / 1e3);
        let boxes = json!({ "detections": [{ convention.key.clone(): numbers, "label": "a red square" }] });
        let server = Server::start(vec![thinks(move |seen| {
            let is_its_own = text_of(seen).contains(&format!("\\\"{}\\\"", convention.key));
            says(&if is_its_own { boxes.to_string() } else { "I do not know that field.".to_owned() })
        })]);
        let found = calibrate(&client(&server), std::slice::from_ref(&sample), 512).unwrap();
        let best = &found.scores[0];
        assert_eq!((&best.convention, &best.key), (&convention.name, &convention.key), "{found:#?}");
        assert!((0.49..0.51).contains(&best.mean_iou) && found.rival().is_none(), "{found:#?}");
        assert_eq!((found.scores.len(), found.squares, found.failures.len()), (6, 2, 2));
    }
}

#[test]
fn a_winner_is_remembered_for_its_endpoint_and_model_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("work/endpoints.json");
    let first = Endpoint::new("http://localhost:1/v1", "tiny").unwrap();
    let winner = Score { convention: "rel1000_xyxy".to_owned(), key: "bbox_2d".to_owned(), mean_iou: 1.0 };
    let mut calibrations = Calibrations::read(&path).unwrap();
    assert!(first.convention(&calibrations).unwrap_err().hint().contains("calibrate"));
    calibrations.note(&first, Some(&winner), SIZE);
    calibrations.write(&path).unwrap();
    let calibrations = Calibrations::read(&path).unwrap();
    assert_eq!(first.convention(&calibrations).unwrap().name, "rel1000_xyxy");
    let mut other = Endpoint { model: "another".to_owned(), ..first };
    assert!(other.convention(&calibrations).is_err());
    other.coordinates = Some("rel1_xyxy".to_owned());
    assert_eq!(other.convention(&calibrations).unwrap().name, "rel1_xyxy");
}
