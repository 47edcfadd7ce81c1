//! What came of the sentence: one line for people, fields for scripts, and the exit code.

use std::path::Path;

use l4d_data::error::inert;
use l4d_ground::{Grounder, Grounding, Outcome, Reason, Unreadable};
use serde::Serialize;

use super::known::Known;
use super::sureness::Sureness;
use super::views::CameraView;
use crate::consensus::Decision;
use crate::solve::Solved;

/// Longest reason of a failure that is repeated, characters.
const LONGEST_REASON: usize = 200;

/// How it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Some view goes on.
    Answered,
    /// The grounder cannot read the sentence.
    Unread,
    /// Every view that answered says that it is not there.
    Absent,
    /// Views found something, and none goes on.
    Disagreement,
    /// Views failed, and no other found anything.
    Failed,
}

/// `answer` of `--json`; its message is the last line otherwise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// How it ended.
    pub status: Status,
    pub message: String,
    /// How sure the grounder is; none where there is no answer, or where it does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    sureness: Option<Sureness>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unread_words: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest: Option<String>,
}

impl Answer {
    fn new(status: Status, message: &str) -> Self {
        // Of whatever it is made, it stays one line.
        Self { status, message: inert(message), sureness: None, unread_words: Vec::new(), nearest: None }
    }

    /// Why there is none; nothing where there is one.
    pub(super) fn missing(solved: &Solved, unread: impl FnOnce(&Unreadable) -> Self) -> Option<Self> {
        if !solved.consensus.evidence.is_empty() {
            return None;
        }
        let groundings = &solved.groundings;
        let any = |outcome: &Outcome| groundings.iter().any(|grounding| grounding.outcome == *outcome);
        if any(&Outcome::Found) {
            return Some(Self::new(Status::Disagreement, "no answer: the views disagree"));
        }
        if let Some(failures) = failures(groundings, any(&Outcome::Absent)) {
            return Some(Self::new(Status::Failed, &failures));
        }
        let reason = groundings.iter().find_map(|grounding| match &grounding.outcome {
            Outcome::Unsupported(unread) => Some(unread),
            _ => None,
        });
        match reason {
            Some(reason) if !any(&Outcome::Absent) => Some(unread(reason)),
            _ => Some(Self::new(Status::Absent, "no answer: no view shows it")),
        }
    }

    /// The sentence cannot be read.
    pub(super) fn unread(unread: &Unreadable, text: &str, known: &Known, grounder: &dyn Grounder) -> Self {
        let nearest = known.nearest(text, |sentence| grounder.reads(sentence).is_ok());
        let mut message = format!("no answer: {unread}");
        let is_about_words = matches!(unread.reason, Reason::Unknown | Reason::Bare);
        if let Some(knows) = grounder.knows().filter(|_| is_about_words) {
            message += &format!("; it knows {knows}");
        }
        if let Some(nearest) = nearest {
            message += &format!("; nearest sentence that it reads: \"{nearest}\"");
        }
        Self {
            unread_words: unread.words.clone(),
            nearest: nearest.map(str::to_owned),
            ..Self::new(Status::Unread, &message)
        }
    }

    /// What the cameras see of it.
    pub(super) fn seen(views: &[CameraView], solved: &Solved, picture: &Path) -> Self {
        let sureness = Sureness::of(solved);
        let sure = sureness.as_ref().map(|sureness| format!("; {sureness}")).unwrap_or_default();
        let (visible, support) = (visible(views), support(solved));
        let message = format!("answer: {visible} ({support}){sure}; picture: {}", picture.display());
        Self { sureness, ..Self::new(Status::Answered, &message) }
    }

    /// Whether masks say something: an answer, or that there is nothing to be seen.
    pub(super) fn has_masks(&self) -> bool {
        !matches!(self.status, Status::Unread | Status::Failed)
    }

    /// Whether there is one.
    pub fn is_there(&self) -> bool {
        self.status == Status::Answered
    }
}

fn visible(views: &[CameraView]) -> String {
    let sum = |of: fn(&CameraView) -> usize| views.iter().map(of).sum::<usize>();
    let (seen, frames) = (sum(|view| view.seen), sum(|view| view.frames));
    let most = views.iter().map(|view| view.most_px).max().unwrap_or(0);
    let cameras = match views {
        [view] if view.is_held_out => format!("the held-out camera {}", view.camera),
        [view] => format!("camera {}", view.camera),
        _ => format!("{} cameras", views.len()),
    };
    match (seen, views.len()) {
        (0, 1) => format!("found, but {cameras} never shows it"),
        (0, _) => format!("found, but none of {cameras} shows it"),
        _ => format!("seen in {seen} of {frames} frames of {cameras}, at most {most} pixels"),
    }
}

/// How many views are behind it.
fn support(solved: &Solved) -> String {
    let (behind, all) = (solved.consensus.evidence.len(), solved.groundings.len());
    let support = match solved.consensus.decision {
        _ if behind == 1 => format!("1 of {all} views alone"),
        _ if !solved.consensus.settings.is_on => format!("{behind} of {all} views show it, unchecked"),
        Decision::NoneReliableAll => {
            format!("no two of {all} views agree; all {behind} that found something count")
        }
        Decision::TiedAll => {
            format!("views contradict each other; all {behind} of {all} that found something count")
        }
        _ => format!("{behind} of {all} views agree"),
    };
    match failed(&solved.groundings).count() {
        0 => support,
        count => format!("{support}, {count} failed"),
    }
}

/// The views that failed, which say nothing about the scene.
fn failed(groundings: &[Grounding]) -> impl Iterator<Item = &Outcome> {
    groundings.iter().map(|grounding| &grounding.outcome).filter(|outcome| !outcome.is_final())
}

fn failures(groundings: &[Grounding], others_deny: bool) -> Option<String> {
    let first = failed(groundings).next()?;
    let why = first.why().unwrap_or_else(|| first.word().to_owned());
    let why: String = why.lines().next().unwrap_or_default().chars().take(LONGEST_REASON).collect();
    let (count, all) = (failed(groundings).count(), groundings.len());
    let others = if others_deny { ", and no other shows it" } else { "" };
    Some(format!("no answer: {count} of {all} views failed{others}: {why}"))
}

#[cfg(test)]
mod tests {
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
        let unread = |unread: &Unreadable| Answer::new(Status::Unread, &format!("no answer: {unread}"));
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
        let unread = || Unsupported(Unreadable::words(Reason::Unknown, [&"flurb".to_owned()]));
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
        assert!(
            message(&[other(1, 1)], &alone).contains("camera cam01, at most 1 pixels (1 of 2 views alone)")
        );
        let unvoted = solved(&[Outcome::Found, Outcome::Found], &[0, 1], Preset::Off);
        assert!(message(&[other(1, 1)], &unvoted).contains("(2 of 2 views show it, unchecked)"));
    }
}
