use l4d_ground::Word;

use super::*;
use crate::account::Account;
use crate::consensus::{Preset, consensus};

fn solved(outcomes: &[Outcome], evidence: &[usize], preset: Preset) -> Solved {
    let mut agreed = consensus(&[], &preset.settings());
    agreed.evidence = evidence.to_vec();
    Solved {
        groundings: outcomes.iter().cloned().map(Grounding::without_answer).collect(),
        consensus: agreed,
        lifted: None,
        account: Account::default(),
    }
}

fn missing(outcomes: &[Outcome]) -> (Status, String) {
    let unread = |unread: &Unread| Answer::new(Status::Unread, &format!("no answer: {unread}"));
    let answer = Answer::missing(&solved(outcomes, &[], Preset::Robust), unread).unwrap();
    assert!(!answer.is_there());
    (answer.status, answer.message)
}

fn error(why: &str) -> Outcome {
    Outcome::Error(why.to_owned())
}

#[test]
fn without_evidence_it_says_why() {
    use Outcome::{Absent, Found, Truncated, Unsupported};
    let unread =
        || Unsupported(Unread::words(Reason::Unknown, [&Word { text: "flurb".into(), bytes: [0, 5] }]));
    let cases = [
        (vec![Found, Found, Absent], Status::Disagreement, "no answer: the views disagree"),
        (vec![Found, error("gone")], Status::Disagreement, "no answer: the views disagree"),
        (vec![Absent, Absent], Status::Absent, "no answer: no view shows it"),
        (vec![Absent, unread()], Status::Absent, "no answer: no view shows it"),
        (vec![unread(), unread()], Status::Unread, "no answer: cannot read \"flurb\""),
        (vec![error("no route"), Truncated], Status::Failed, "no answer: 2 of 2 views failed: no route"),
        (vec![Truncated], Status::Failed, "no answer: 1 of 1 views failed: truncated"),
        (
            vec![Absent, error("no\u{1b}[2J route\nand more")],
            Status::Failed,
            "no answer: 1 of 2 views failed, and no other shows it: no\u{fffd}[2J route",
        ),
    ];
    for (outcomes, status, message) in cases {
        assert_eq!(missing(&outcomes), (status, message.to_owned()), "{outcomes:?}");
    }
    assert!(missing(&[error(&"x".repeat(5000))]).1.len() < 300);
}

fn view(name: &str, is_held_out: bool, seen: usize, most_px: u64) -> CameraView {
    CameraView { camera: l4d_data::Name::new(name).unwrap(), is_held_out, seen, frames: 9, most_px }
}

#[test]
fn with_evidence_it_says_what_the_cameras_see() {
    let held_out = |seen, most_px| view("cam04", true, seen, most_px);
    let other = |seen, most_px| view("cam01", false, seen, most_px);
    let all = solved(&[Outcome::Found, Outcome::Found, error("gone")], &[0, 1], Preset::Robust);
    let message = |views: &[CameraView], solved: &Solved| {
        assert_eq!(Answer::missing(solved, |_| unreachable!()), None);
        let answer = Answer::seen(views, solved, Path::new("asked/sheet.png"));
        assert!(answer.is_there());
        answer.message
    };
    assert_eq!(
        message(&[held_out(8, 143)], &all),
        "answer: seen in 8 of 9 frames of the held-out camera cam04, at most 143 pixels \
         (2 of 3 views agree, 1 failed); picture: asked/sheet.png"
    );
    assert!(
        message(&[held_out(0, 0)], &all)
            .starts_with("answer: found, but the held-out camera cam04 never shows it (")
    );
    let two = [held_out(8, 143), other(9, 99)];
    assert!(message(&two, &all).contains("seen in 17 of 18 frames of 2 cameras, at most 143 pixels"));
    let two = [held_out(0, 0), other(0, 0)];
    assert!(message(&two, &all).contains("found, but none of 2 cameras shows it"));
    let alone = solved(&[Outcome::Found, Outcome::Absent], &[0], Preset::Robust);
    assert!(message(&[other(1, 1)], &alone).contains("camera cam01, at most 1 pixels (1 of 2 views alone)"));
    let unvoted = solved(&[Outcome::Found, Outcome::Found], &[0, 1], Preset::Off);
    assert!(message(&[other(1, 1)], &unvoted).contains("(2 of 2 views show it, unchecked)"));
}
