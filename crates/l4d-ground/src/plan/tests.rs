//! Every way in which a reply was seen to go wrong, as data: `replies.jsonl`. Four pictures of 200x100 were sent, of
//! the frames 0, 32, 64 and 96 of a clip of 100x50.

use l4d_endpoint::{Convention, Finish, Reply};
use serde::Deserialize;

use super::*;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    name: String,
    wanted: String,
    convention: String,
    finish: String,
    text: String,
    sent: usize,
    expect: Expected,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Expected {
    outcome: String,
    boxes: Option<Vec<(u32, u32, [f64; 4])>>,
    #[serde(default)]
    points: Vec<(u32, u32, [f64; 2])>,
    expression: Option<String>,
    noun_phrase: Option<String>,
    #[serde(default)]
    intervals: Vec<[u32; 2]>,
    note: Option<String>,
}

fn reply(text: &str, finish: Finish) -> Reply {
    // The client takes thinking away before a reply is read.
    let text = text.rfind("</think>").map_or(text, |end| &text[end + "</think>".len()..]).trim();
    let text = if text.starts_with("<think>") { "" } else { text };
    Reply { finish, ..Reply::saying(text) }
}

fn reading(case: &Case) -> Reading {
    let finish = match case.finish.as_str() {
        "stop" => Finish::Stop,
        "length" => Finish::Length,
        "refused" => Finish::Refused("content filter".to_owned()),
        other => panic!("{other}"),
    };
    let clock = Clock::new([0, 32, 64, 96][..case.sent].to_vec(), Interval::WHOLE);
    let convention = Convention::named(&case.convention).unwrap();
    let pictures = SentPictures { clock: &clock, size: (200, 100), clip: (100, 50), convention };
    let wanted = if case.wanted == "boxes" { Wanted::Boxes } else { Wanted::Words };
    read(&reply(&case.text, finish), wanted, &pictures)
}

#[test]
fn every_known_shape_of_a_reply_is_read_or_told() {
    let corpus = include_str!("../../tests/vlm/replies.jsonl");
    let cases: Vec<Case> = corpus.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(cases.len() > 50, "the corpus is cut");
    for case in &cases {
        let Reading { outcome, plan } = reading(case);
        let (name, expect) = (&case.name, &case.expect);
        assert_eq!(outcome.word(), expect.outcome, "{name}: {outcome:?} {plan:?}");
        let boxes = plan.keyframes.iter().filter_map(|key| Some((key.frame, key.object, key.box_px?)));
        let boxes: Vec<(u32, u32, [f64; 4])> = boxes.collect();
        if let Some(expected) = &expect.boxes {
            assert_eq!(boxes.len(), expected.len(), "{name}: {plan:?}");
            for (found, expected) in boxes.iter().zip(expected) {
                assert_eq!((found.0, found.1), (expected.0, expected.1), "{name}: {plan:?}");
                let near =
                    found.2.iter().zip(expected.2).all(|(found, expected)| (found - expected).abs() < 1e-9);
                assert!(near, "{name}: {found:?}, {expected:?}");
            }
        }
        let points = plan
            .keyframes
            .iter()
            .flat_map(|key| key.points_px.iter().map(|point| (key.frame, key.object, *point)));
        assert_eq!(points.collect::<Vec<_>>(), expect.points, "{name}");
        for (found, expected) in
            [(&plan.expression, &expect.expression), (&plan.noun_phrase, &expect.noun_phrase)]
        {
            assert!(expected.as_ref().is_none_or(|expected| found == expected), "{name}: {found}");
        }
        let intervals: Vec<[u32; 2]> = plan.intervals.iter().map(|interval| (*interval).into()).collect();
        assert_eq!(intervals, expect.intervals, "{name}");
        let is_noted = |note: &String| plan.notes.iter().any(|said| said.contains(note.as_str()));
        assert!(expect.note.as_ref().is_none_or(is_noted), "{name}: {:?}", plan.notes);
    }
}

#[test]
fn endless_replies_are_read_in_part() {
    let clock = Clock::new(vec![0], Interval::WHOLE);
    let convention = Convention::named("rel1000_xyxy").unwrap();
    let pictures = SentPictures { clock: &clock, size: (200, 100), clip: (100, 50), convention };
    let many = vec![r#"{"time":0,"bbox_2d":[1,2,3,4]}"#; 100_000].join(",");
    let Reading { plan, .. } = read(&reply(&format!("[{many}]"), Finish::Stop), Wanted::Boxes, &pictures);
    assert_eq!(plan.keyframes.len(), 1);
    assert!(plan.notes.iter().any(|note| note.starts_with("only 1024 of 100000")), "{:?}", plan.notes);
}
