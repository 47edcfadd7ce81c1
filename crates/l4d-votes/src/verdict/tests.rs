use l4d_data::Temporal;

use super::*;
use crate::fixture::{interval, name, objects, poll};

/// The verdict on one query that means `tabby` while frames 40 to 60, if these are the answers.
fn one(rule: &str, answers: &[Standing]) -> ItemVerdict {
    let names = ["ada", "ben", "cho", "dee", "eve"];
    let meaning = Meaning {
        referents: BTreeSet::from([name("tabby")]),
        temporal: Temporal::While,
        frames: vec![interval(40, 60)],
        tracks: "0".repeat(64),
    };
    let (mut round, key, sheets) = poll(&names[..answers.len()], &[(meaning, answers.to_vec())]);
    round.rule = rule.parse().unwrap();
    let current = round.items.iter().map(|item| (item.id.clone(), item.digest.clone())).collect();
    judge(&round, &key, &sheets, &current).items.remove(0)
}

fn said(choice: Choice) -> Standing {
    Standing { answer: Some(Answer { choice, frames: Interval::WHOLE }), ..Standing::default() }
}

fn right() -> Standing {
    said(objects(&["tabby"]))
}

#[test]
fn all_five_must_choose_exactly_what_is_meant() {
    let verdict = one("unanimous:5", &[right(), right(), right(), right(), right()]);
    assert_eq!((verdict.outcome, verdict.pattern().as_str()), (Outcome::Valid, "+++++"));
    assert!(verdict.reasons.is_empty());
    let late = Answer { frames: interval(61, 96), choice: objects(&["tabby"]) };
    let wrong = [
        (said(objects(&["ginger"])), "++++x", "eve chose ginger"),
        (said(objects(&["ginger", "tabby"])), "++++x", "eve chose ginger, tabby"),
        (said(Choice::None), "++++0", "eve found nothing that fits"),
        (said(Choice::Ambiguous { reason: "two sit".into() }), "++++?", "eve called it ambiguous: two sit"),
        (
            Standing { answer: Some(late), ..Standing::default() },
            "++++t",
            "eve chose the objects meant, at frames 61 to 96",
        ),
    ];
    for (standing, pattern, reason) in wrong {
        let verdict = one("unanimous:5", &[right(), right(), right(), right(), standing]);
        assert_eq!((verdict.outcome, verdict.pattern().as_str()), (Outcome::Rejected, pattern));
        assert_eq!(verdict.reasons, [reason]);
    }
}

#[test]
fn a_majority_still_needs_every_answer() {
    let wrong = || said(Choice::None);
    assert_eq!(one("majority:3/5", &[right(), wrong(), right(), wrong(), right()]).outcome, Outcome::Valid);
    assert_eq!(
        one("majority:3/5", &[right(), wrong(), right(), wrong(), wrong()]).outcome,
        Outcome::Rejected
    );
    let missing = one("majority:3/5", &[right(), right(), right(), right(), Standing::default()]);
    assert_eq!((missing.outcome, missing.counted(), missing.right()), (Outcome::Incomplete, 4, 4));
    assert_eq!(missing.reasons, ["eve has not answered"]);
}

#[test]
fn a_skip_is_no_answer() {
    let skip = Standing { skipped: true, ..Standing::default() };
    let verdict = one("unanimous:2", &[right(), skip]);
    assert_eq!((verdict.outcome, verdict.pattern().as_str()), (Outcome::Incomplete, "+s"));
    assert_eq!(verdict.reasons, ["ben skipped it"]);
}

#[test]
fn an_answer_to_earlier_words_is_kept_and_not_counted() {
    let stale = Standing { stale: right().answer, ..Standing::default() };
    let verdict = one("unanimous:2", &[right(), stale]);
    assert_eq!((verdict.outcome, verdict.pattern().as_str(), verdict.counted()), (Outcome::Stale, "+~", 1));
    assert_eq!(verdict.votes[1].answer, right().answer);
}

#[test]
fn a_query_that_changed_or_went_is_stale_whatever_was_said() {
    let meaning = || Meaning {
        referents: BTreeSet::from([name("tabby")]),
        temporal: Temporal::Whole,
        frames: vec![Interval::WHOLE],
        tracks: "0".repeat(64),
    };
    let (round, key, sheets) =
        poll(&["ada"], &[(meaning(), vec![right()]), (meaning(), vec![right()]), (meaning(), vec![right()])]);
    let ids: Vec<ItemId> = round.items.iter().map(|item| item.id.clone()).collect();
    let current =
        BTreeMap::from([(ids[0].clone(), round.items[0].digest.clone()), (ids[1].clone(), "f".repeat(64))]);
    let verdicts = judge(&round, &key, &sheets, &current);
    let outcomes: Vec<Outcome> = verdicts.items.iter().map(|verdict| verdict.outcome).collect();
    assert_eq!(outcomes, [Outcome::Valid, Outcome::Stale, Outcome::Stale]);
    assert_eq!(verdicts.items[2].reasons, ["the query is gone since the round was opened"]);
    let found: Vec<_> =
        verdicts.findings.iter().map(|finding| (finding.code, finding.location.as_str())).collect();
    assert_eq!(found, [(codes::STALE_ITEM, "item q0002"), (codes::STALE_ITEM, "item q0003")]);
}

#[test]
fn one_annotator_does_not_count_for_two() {
    let meaning = Meaning {
        referents: BTreeSet::from([name("tabby")]),
        temporal: Temporal::Whole,
        frames: vec![Interval::WHOLE],
        tracks: "0".repeat(64),
    };
    let (round, key, mut sheets) = poll(&["ada", "ben"], &[(meaning, vec![right(), right()])]);
    sheets[1].annotator = name("ada");
    sheets.push(Sheet { annotator: name("eve"), ..sheets[0].clone() });
    let current = BTreeMap::from([(round.items[0].id.clone(), round.items[0].digest.clone())]);
    let verdicts = judge(&round, &key, &sheets, &current);
    assert_eq!((verdicts.items[0].pattern().as_str(), verdicts.is_final), ("+.", false));
    let error = require_sealed(round.dir(), &round, &sheets).unwrap_err();
    assert!(error.to_string().contains("not sealed yet: ben"), "{error}");
}

#[test]
fn letters_tell_marks_apart() {
    let letters: BTreeSet<char> = Mark::ALL.into_iter().map(Mark::letter).collect();
    assert_eq!(letters.len(), Mark::ALL.len());
}
