//! What a probe says about good and poor servers, and which convention a calibration finds.

use l4d_endpoint::calibration::{Calibration, Calibrations, Sample, calibrate};
use l4d_endpoint::probe::{Line, State, probe};
use l4d_endpoint::{BoxPx, Client, Convention, Link};
use serde_json::{Value, json};

use crate::common::{client, patient, picture, plain};
use crate::scripted::{self, Seen, Server, Turn, ok, says, status, thinks};

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
    assert!(lines.iter().all(|line| line.remedy.is_empty()));
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
    assert!(lines.iter().skip(3).all(|line| !line.remedy.is_empty()), "{lines:#?}");
    assert!(lines[1].remedy.contains("other"));
}

#[test]
fn a_server_that_is_down_is_looked_at_no_longer_than_needed() {
    let server = Server::start(vec![status(401, &json!({"error": "who are you?"}))]);
    let lines = lines(&server);
    let expected = [("key", State::Ok), ("models", State::Lacking), ("chat", State::Failed)];
    assert_eq!(states(&lines), expected);
    assert!(lines[2].remedy.contains("api_key_env"), "{lines:#?}");
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
    assert!(line.remedy.contains("https"));
}

const SIZE: (u32, u32) = (714, 490);

/// Two pictures; what is drawn on them does not matter, since the server knows the places.
fn samples() -> Vec<Sample> {
    let square = |colour: &str, x: f64, y: f64| {
        (colour.to_owned(), BoxPx { x0: x, y0: y, x1: x + 100.0, y1: y + 100.0 })
    };
    vec![
        Sample {
            image: plain(SIZE.0, SIZE.1, 1),
            squares: vec![square("red", 40.0, 350.0), square("blue", 580.0, 60.0)],
        },
        Sample {
            image: plain(SIZE.0, SIZE.1, 2),
            squares: vec![square("red", 590.0, 370.0), square("blue", 300.0, 20.0)],
        },
    ]
}

/// A model that writes boxes in a convention, but only under the field name that it was trained with.
fn model(convention: &'static Convention, wrap: fn(Vec<Value>) -> String) -> Turn {
    thinks(move |seen| {
        let text = text_of(seen);
        if !text.contains(&format!("\\\"{}\\\"", convention.key)) {
            return says("I do not know that field.");
        }
        let samples = samples();
        let shown = samples.iter().find(|sample| {
            let bytes = base64::Engine::encode(&base64::prelude::BASE64_STANDARD, sample.image.bytes());
            text.contains(&bytes)
        });
        let boxes = shown.unwrap().squares.iter().map(|(colour, place)| {
            // As a model writes them: rounded, where a convention counts pixels or thousandths.
            let numbers = convention.numbers(*place, SIZE);
            let is_fine = convention.name == "rel1_xyxy";
            let numbers =
                numbers.map(|number| if is_fine { (number * 1e3).round() / 1e3 } else { number.round() });
            json!({ convention.key.clone(): numbers, "label": format!("{colour} square") })
        });
        says(&wrap(boxes.collect()))
    })
}

fn run(turn: Turn) -> Calibration {
    let server = Server::start(vec![turn]);
    calibrate(&client(&server), &samples(), 512).unwrap()
}

#[test]
fn each_convention_is_found_from_the_boxes_that_it_makes() {
    for convention in Convention::all() {
        let found = run(model(convention, |boxes| format!("```json\n{}\n```", Value::from(boxes))));
        let winner = found.winner().unwrap();
        assert_eq!((&winner.convention, &winner.key), (&convention.name, &convention.key), "{found:#?}");
        assert!(winner.mean_iou > 0.97, "{found:#?}");
        assert!(found.rival().is_none(), "{found:#?}");
        assert_eq!((found.scores.len(), found.squares), (Convention::all().len(), 4));
    }
}

#[test]
fn a_model_that_sees_half_the_squares_is_still_understood() {
    let convention = Convention::named("rel1000_yxyx").unwrap();
    let found = run(model(convention, |boxes| json!({"detections": boxes[..1]}).to_string()));
    // One of two squares in each picture, exact up to rounding: one half, which is the least that counts.
    let best = &found.scores[0];
    assert_eq!(best.convention, "rel1000_yxyx");
    assert!((0.48..0.51).contains(&best.mean_iou), "{found:#?}");
}

#[test]
fn a_model_that_guesses_fits_no_convention() {
    let guess = r#"[{"bbox_2d": [10, 10, 30, 30], "label": "red"}, {"bbox_2d": [900, 10, 901, 990], "label": "blue"}]"#;
    let found = run(says(guess));
    assert!(found.winner().is_none() && found.failures.is_empty(), "{found:#?}");
    let found = run(says("There are squares."));
    assert!(found.winner().is_none());
    assert_eq!(found.failures.len(), 6);
    assert!(found.scores.iter().all(|score| score.mean_iou.to_bits() == 0));
}

#[test]
fn a_winner_is_remembered_for_its_endpoint_and_model_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("work/endpoints.json");
    let server = Server::start(vec![model(&Convention::all()[0], |boxes| Value::from(boxes).to_string())]);
    let first = patient(&server.url());
    let found = calibrate(&client(&server), &samples(), 512).unwrap();
    let mut calibrations = Calibrations::read(&path).unwrap();
    assert!(first.convention(&calibrations).unwrap_err().hint().contains("calibrate"));
    calibrations.note(&first, found.winner(), SIZE);
    calibrations.write(&path).unwrap();
    let mut calibrations = Calibrations::read(&path).unwrap();
    assert_eq!(first.convention(&calibrations).unwrap().name, "rel1000_xyxy");
    assert_eq!(calibrations.of(&first).unwrap().size, SIZE);
    let mut other = first.clone();
    other.model = "another".to_owned();
    assert!(other.convention(&calibrations).is_err());
    other.coordinates = Some("rel1_xyxy".to_owned());
    assert_eq!(other.convention(&calibrations).unwrap().name, "rel1_xyxy");
    calibrations.note(&first, None, SIZE);
    assert!(calibrations.of(&first).is_none());
}
