//! Every way in which a reply was seen to go wrong, as data: `replies.jsonl`. Four pictures of 200x100 were sent, of
//! the frames 0, 32, 64 and 96 of a clip of 100x50.

use l4d_endpoint::{Convention, Finish, Reply};
use serde::Deserialize;

use super::*;
use crate::grounder::Outcome;

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
    expression: Option<String>,
    noun_phrase: Option<String>,
    note: Option<String>,
}

fn reply(text: &str, finish: Finish) -> Reply {
    // The client takes thinking away before a reply is read.
    let text = text.rfind("</think>").map_or(text, |end| &text[end + "</think>".len()..]).trim();
    let text = if text.starts_with("<think>") { "" } else { text };
    Reply { finish, ..Reply::saying(text) }
}

fn reading(reply: &Reply, sent: usize, convention: &str, wanted: Wanted) -> (Outcome, GroundingPlan) {
    let clock = Clock([0, 32, 64, 96][..sent].to_vec());
    let convention = Convention::named(convention).unwrap();
    let pictures = SentPictures { clock: &clock, size: (200, 100), clip: (100, 50), convention };
    read(reply, wanted, &pictures)
}

#[test]
fn every_known_shape_of_a_reply_is_read_or_told() {
    let corpus = include_str!("../../tests/vlm/replies.jsonl");
    let cases: Vec<Case> = corpus.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(cases.len() > 50, "the corpus is cut");
    for case in &cases {
        let finish = match case.finish.as_str() {
            "stop" => Finish::Stop,
            "length" => Finish::Length,
            "refused" => Finish::Refused("content filter".to_owned()),
            other => panic!("{other}"),
        };
        let wanted = if case.wanted == "boxes" { Wanted::Boxes } else { Wanted::Words };
        let (outcome, plan) = reading(&reply(&case.text, finish), case.sent, &case.convention, wanted);
        let (name, expect) = (&case.name, &case.expect);
        assert_eq!(outcome.word(), expect.outcome, "{name}: {outcome:?} {plan:?}");
        let boxes = plan.keyframes.iter().map(|Keyframe { frame, object, place }| {
            let BoxPx { x0, y0, x1, y1 } = *place;
            // Rounded, since conventions divide and multiply.
            (*frame, *object, [x0, y0, x1, y1].map(|side| (side * 1e6).round() / 1e6))
        });
        let boxes: Vec<_> = boxes.collect();
        assert!(expect.boxes.as_ref().is_none_or(|expected| boxes == *expected), "{name}: {plan:?}");
        for (found, expected) in
            [(&plan.expression, &expect.expression), (&plan.noun_phrase, &expect.noun_phrase)]
        {
            assert!(expected.as_ref().is_none_or(|expected| found == expected), "{name}: {found}");
        }
        let is_noted = |note: &String| plan.notes.iter().any(|said| said.contains(note.as_str()));
        assert!(expect.note.as_ref().is_none_or(is_noted), "{name}: {:?}", plan.notes);
    }
}

#[test]
fn endless_replies_are_read_in_part() {
    let many = vec![r#"{"time":0,"bbox_2d":[1,2,3,4]}"#; 100_000].join(",");
    let endless = reply(&format!("[{many}]"), Finish::Stop);
    let (_, plan) = reading(&endless, 1, "rel1000_xyxy", Wanted::Boxes);
    assert_eq!(plan.keyframes.len(), 1);
    assert!(plan.notes.iter().any(|note| note.starts_with("only 1024 of 100000")), "{:?}", plan.notes);
}
