//! From question to masks, with a server that says what a test makes it say and workers that need nothing but Python.

#[path = "../../../l4d-endpoint/tests/scripted/mod.rs"]
mod scripted;

use std::path::{Path, PathBuf};
use std::time::Duration;

use l4d_endpoint::{CacheUse, Link};
use l4d_masks::Mask;

use self::scripted::{Seen, Server, Turn, says, status, thinks};
use super::*;
use crate::testing::{asked_from, clip, sentence};
use crate::worker::{FrameStore, Launch, Worker, WorkerTimeouts};

/// A server that answers each question like this.
fn serve(think: impl Fn(&Value) -> Turn + Send + Sync + 'static) -> Server {
    Server::start(vec![thinks(move |seen| think(&seen.json()))])
}

fn questions(server: &Server) -> Vec<Value> {
    server.seen().iter().map(Seen::json).collect()
}

/// The words of a question.
fn words(question: &Value) -> String {
    match &question["messages"][0]["content"] {
        Value::String(text) => text.clone(),
        parts => {
            let texts = parts.as_array().unwrap().iter().filter_map(|part| part["text"].as_str());
            texts.collect::<Vec<_>>().join("\n")
        }
    }
}

const FRAMES: [u32; 5] = [0, 24, 48, 72, 96];

fn endpoint(url: &str) -> Endpoint {
    let mut endpoint = Endpoint::new(url, "tiny-vl").unwrap();
    endpoint.coordinates = Some("rel1000_xyxy".to_owned());
    endpoint.retry.tries = 1;
    endpoint
}

/// A worker of the package, or the scripted one, which finds two seen objects for the phrase `things`.
fn segmenter(name: &str, folder: &Path) -> Arc<Segmenter> {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let arguments = match name {
        "scripted" => vec![here.join("tests/worker/scripted.py").into_os_string(), "plain".into()],
        name => vec!["-m".into(), "l4d_workers".into(), name.into()],
    };
    let environment = [
        ("PYTHONPATH".to_owned(), here.join("workers").into_os_string()),
        ("PYTHONDONTWRITEBYTECODE".to_owned(), "1".into()),
    ]
    .into();
    let launch = Launch { program: "python3".into(), arguments, environment };
    let timeouts = WorkerTimeouts { answer: Duration::from_secs(60), ..WorkerTimeouts::default() };
    let worker = Worker::start(launch, timeouts).unwrap();
    Arc::new(Segmenter::new(worker, FrameStore::new(folder.join("frames")), 0.0))
}

fn small() -> Settings {
    Settings { keyframes: 3, picture_pixels: 1 << 12, ..Settings::default() }
}

fn vlm(client: Client, worker: &str, coupling: Coupling, settings: Settings, folder: &Path) -> Vlm {
    Vlm::new(client, segmenter(worker, folder), coupling, settings).unwrap()
}

fn live(server: &Server) -> Client {
    Client::open(endpoint(&server.url()), &Link::Live).unwrap()
}

fn view() -> ViewClip {
    clip(32, 24, &FRAMES)
}

/// The picture of frame 48 shows the target in its left half.
const PLAN: &str = r#"{"visible":true,"expression":"the cup that tips over","noun_phrase":"cup","boxes":[{"time":1.0,"bbox_2d":[0,0,500,1000]}]}"#;

fn left_half() -> Mask {
    Mask::from_fn(32, 24, |column, _| column < 16)
}

#[test]
fn boxes_of_a_reply_become_masks() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(|_| says(PLAN));
    let vlm = vlm(live(&server), "box", Coupling::Box, small(), folder.path());
    let grounding = vlm.ground(&view(), &sentence("the cup that \"tips\" 🥤"));
    assert_eq!(grounding.outcome, Outcome::Found, "{:?}", grounding.notes);
    assert!(grounding.masks.keys().eq(&FRAMES));
    assert!(grounding.masks.values().all(|mask| *mask == left_half()));
    let notes = grounding.notes.join("\n");
    for words in
        ["tiny-vl", "box_v1", "3 pictures, 40 tokens, and 2", "tips over", "places in 1 of 3 pictures"]
    {
        assert!(notes.contains(words), "{words}: {notes}");
    }

    let [asked] = &questions(&server)[..] else { panic!("one question per view") };
    let parts = asked["messages"][0]["content"].as_array().unwrap();
    let labels: Vec<&Value> = parts[..6].iter().step_by(2).map(|part| &part["text"]).collect();
    assert_eq!(labels, ["<0.0 seconds>", "<1.0 seconds>", "<2.0 seconds>"]);
    let is_picture =
        |part: &Value| part["image_url"]["url"].as_str().unwrap().starts_with("data:image/jpeg;base64,");
    assert!(parts[1..6].iter().step_by(2).all(is_picture));
    let text = parts[6]["text"].as_str().unwrap();
    assert_eq!(parts.len(), 7, "the words come last");
    assert!(text.contains(r#"the query "the cup that \"tips\" 🥤""#), "{text}");
    assert!(text.contains("3 moments") && text.contains("4.0 seconds"), "{text}");
    assert!(
        !text.contains("{count}") && text.contains(r#""boxes":[{"time":0.0,"bbox_2d":[400,400,600,600]}]"#)
    );
    let schema = &asked["response_format"]["json_schema"]["schema"];
    assert_eq!(schema["required"], json!(["visible", "expression", "noun_phrase", "boxes"]));
}

#[test]
fn only_what_is_asked_about_is_shown_and_answered() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(|_| says(PLAN));
    let vlm = vlm(live(&server), "box", Coupling::Box, small(), folder.path());
    let grounding = vlm.ground(&view(), &asked_from(sentence("the cup"), 20, 80));
    let seen: Vec<u32> =
        grounding.masks.iter().filter(|(_, mask)| !mask.is_empty()).map(|(frame, _)| *frame).collect();
    assert_eq!((seen, grounding.masks.len()), (vec![24, 48, 72], 5));
}

#[test]
fn outcomes_without_masks_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(|question| {
        let text = words(question);
        let reply = |word: &str| text.contains(&format!("\"{word}\""));
        if reply("absent") {
            says(r#"{"visible":false,"expression":"","noun_phrase":"","boxes":[]}"#)
        } else if reply("prose") {
            says("It is on the left.")
        } else if reply("points") {
            says(r#"[{"time":1,"point_2d":[500,500]}]"#)
        } else if reply("cut") {
            says(&PLAN[..PLAN.len() - 9])
        } else if reply("refused") {
            says("I'm sorry, I cannot do that.")
        } else {
            status(500, &json!({ "error": { "message": "no memory" } }))
        }
    });
    let vlm = vlm(live(&server), "box", Coupling::Box, small(), folder.path());
    let ask = |text: &str| vlm.ground(&view(), &sentence(text));
    let absent = ask("absent");
    assert_eq!((absent.outcome, absent.masks.len()), (Outcome::Absent, 5));
    for (text, word) in [
        ("prose", "unparsed"),
        ("cut", "truncated"),
        ("refused", "refused"),
        ("points", "unparsed"),
        ("down", "error"),
    ] {
        let Grounding { outcome, masks, notes, .. } = ask(text);
        assert_eq!((outcome.word(), masks.len()), (word, 0), "{text}: {outcome:?}");
        assert!(!notes.is_empty());
    }
    let Outcome::Error(message) = ask("down").outcome else { panic!("no error") };
    assert!(message.contains("HTTP 500") && !message.contains("no memory"), "{message}");
    assert!(matches!(ask("").outcome, Outcome::Unsupported(_)));
}

#[test]
fn answers_are_kept_and_replies_without_sense_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(|question| match words(question).contains("\"prose\"") {
        true => says("Nothing but prose."),
        false => says(PLAN),
    });
    let client = live(&server).with_cache(&folder.path().join("cache"), CacheUse::Take);
    let vlm = vlm(client, "box", Coupling::Box, small(), folder.path());
    let first = vlm.ground(&view(), &sentence("the cup"));
    assert_eq!(vlm.ground(&view(), &sentence("the cup")), first, "the cache leaves no trace in an answer");
    assert_eq!(server.seen().len(), 1);
    for _ in 0..2 {
        assert_eq!(vlm.ground(&view(), &sentence("prose")).outcome.word(), "unparsed");
    }
    assert_eq!(server.seen().len(), 3, "a reply without sense is asked for again");
}

#[test]
fn words_go_to_a_segmenter_of_text() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(|_| says(r#"{"visible":true,"expression":"two cups","noun_phrase":"things"}"#));
    let vlm = vlm(live(&server), "scripted", Coupling::Text, small(), folder.path());
    let grounding = vlm.ground(&view(), &sentence("the cups that touch"));
    assert_eq!(grounding.outcome, Outcome::Found);
    let expected = Mask::from_fn(32, 24, |column, _| column < 4 || (10..20).contains(&column));
    assert!(grounding.masks.values().all(|mask| *mask == expected));
    let notes = grounding.notes.join("\n");
    assert!(notes.contains("was given: things") && notes.contains("left out: hole filling"), "{notes}");
}

/// Answers both questions of `pick`: the phrase, then the choice.
fn chooses(phrase: &'static str, choice: &'static str) -> Server {
    serve(move |question| match words(question).contains("candidates") {
        true => says(choice),
        false => says(&json!({ "visible": true, "expression": "x", "noun_phrase": phrase }).to_string()),
    })
}

#[test]
fn a_choice_among_numbered_candidates_becomes_masks() {
    let folder = tempfile::tempdir().unwrap();
    let server = chooses("things", r#"{"numbers":[2]}"#);
    let vlm = vlm(live(&server), "scripted", Coupling::Pick, small(), folder.path());
    let grounding = vlm.ground(&view(), &sentence("the cup that is pushed"));
    assert_eq!(grounding.outcome, Outcome::Found, "{:?}", grounding.notes);
    let expected = Mask::from_fn(32, 24, |column, _| (10..20).contains(&column));
    assert!(grounding.masks.values().all(|mask| *mask == expected));
    let seen = questions(&server);
    assert_eq!(seen.len(), 2);
    assert!(seen[0]["messages"][0]["content"].is_string(), "words alone");
    assert!(words(&seen[1]).contains("2 candidates are outlined and numbered 1 to 2"));
    let schema = &seen[1]["response_format"]["json_schema"]["schema"]["properties"]["numbers"];
    assert_eq!(schema["items"]["maximum"], 2, "what is never seen is no candidate");
}

#[test]
fn a_choice_of_nothing_is_absent_and_one_of_others_has_no_sense() {
    for (phrase, choice, word, questions) in [
        ("things", r#"{"numbers":[]}"#, "absent", 2),
        ("things", r#"{"numbers":[7]}"#, "unparsed", 2),
        ("nothing", "", "absent", 1),
        ("refuse", "", "unparsed", 1),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let server = chooses(phrase, choice);
        let vlm = vlm(live(&server), "scripted", Coupling::Pick, small(), folder.path());
        let grounding = vlm.ground(&view(), &sentence("the cup"));
        assert_eq!(
            (grounding.outcome.word(), server.seen().len()),
            (word, questions),
            "{phrase}: {grounding:?}"
        );
    }
}

#[test]
fn an_identity_names_everything_that_answers_depend_on() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(|_| says(PLAN));
    let open =
        |coupling, worker, settings| vlm(live(&server), worker, coupling, settings, folder.path()).identity();
    let identity = open(Coupling::Box, "box", small());
    assert_eq!(identity["model"], "tiny-vl");
    assert_eq!(identity["prompts"][0]["name"], "box_v1");
    assert_eq!(identity["coordinates"], "rel1000_xyxy");
    assert_eq!(identity["segmenter"]["worker"]["name"], "box");
    assert!(!identity.to_string().contains("127.0.0.1"), "{identity}");
    for other in [
        open(Coupling::Box, "box", Settings { seed: Some(1), ..small() }),
        open(Coupling::Box, "null", small()),
        open(Coupling::Pick, "null", small()),
    ] {
        assert_ne!(other, identity);
    }
}

#[test]
fn what_cannot_work_is_told_before_anything_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(|_| says(PLAN));
    let open = |client: Client, worker, coupling, settings| {
        Vlm::new(client, segmenter(worker, folder.path()), coupling, settings).unwrap_err()
    };
    let error = open(live(&server), "box", Coupling::Text, small());
    assert!(matches!(error, VlmError::Worker(_)) && error.to_string().contains("not text"), "{error}");
    let mut unknown = endpoint(&server.url());
    unknown.coordinates = None;
    let error = open(Client::open(unknown, &Link::Live).unwrap(), "box", Coupling::Box, small());
    assert!(error.to_string().contains("tiny-vl") && error.hint().contains("coordinates"), "{error}");
    let error = open(live(&server), "box", Coupling::Box, Settings { keyframes: 0, ..small() });
    assert!(error.to_string().starts_with("keyframes"), "{error}");
}

/// A real server with a tiny random model: `L4D_VLM_URL=http://127.0.0.1:8801/v1` of `tests/endpoint_server/serve.py`.
#[test]
#[ignore = "needs L4D_VLM_URL, a running model server"]
fn a_real_model_of_random_weights_gets_an_outcome() {
    let url = std::env::var("L4D_VLM_URL").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut endpoint = Endpoint::new(&url, "tiny").unwrap();
    endpoint.coordinates = Some("rel1000_xyxy".to_owned());
    let client = Client::open(endpoint, &Link::Live).unwrap();
    let settings = Settings { answer_tokens: 400, ..small() };
    let vlm = vlm(client, "box", Coupling::Box, settings, folder.path());
    let ask = |text: &str| vlm.ground(&view(), &sentence(text));
    let grounding = ask("the cup that tips over");
    assert!(!matches!(grounding.outcome, Outcome::Error(_)), "{grounding:?}");
    assert!(grounding.notes.iter().any(|note| note.starts_with("question ")), "{grounding:?}");
    assert_eq!(ask("the cup that tips over"), grounding, "the same question, another answer");
}
