use l4d_data::{Interval, Temporal};

use super::*;
use crate::fixture::{interval, meaning, poll, response};

/// The verdict on one query that means `tabby` while frames 40 to 60, if these are the answers.
fn one(answers: Vec<Response>) -> ItemVerdict {
    let names = ["ada", "ben", "cho", "dee", "eve"];
    let tabby = meaning(&["tabby"], Temporal::While, interval(40, 60));
    let (round, key, given) = poll(&names[..answers.len()], &[(tabby, answers)]);
    judge(&round, &key, &given, &BTreeMap::new()).items.remove(0)
}

#[test]
fn the_outcome_follows_from_the_marks() {
    for (letters, outcome, reason) in [
        ("+++++", Outcome::Valid, None),
        ("++++x", Outcome::Rejected, Some("eve chose ginger")),
        ("++++X", Outcome::Rejected, Some("eve chose ginger, tabby")),
        ("++++0", Outcome::Rejected, Some("eve found nothing that fits")),
        ("++++?", Outcome::Rejected, Some("eve called it ambiguous: two sit")),
        ("++++t", Outcome::Rejected, Some("eve chose the objects meant, at frames 61 to 96")),
        ("++++.", Outcome::Incomplete, Some("eve has not answered")),
        ("+s", Outcome::Incomplete, Some("ben skipped it")),
        ("+~", Outcome::Stale, Some("ben answered an earlier wording or scene")),
    ] {
        let verdict = one(letters.chars().map(response).collect());
        assert_eq!((verdict.outcome, verdict.pattern()), (outcome, letters.replace('X', "x")));
        assert_eq!(verdict.reasons.last().map(String::as_str), reason);
        let counted = letters.len() - letters.chars().filter(|letter| ".s~".contains(*letter)).count();
        assert_eq!((verdict.counted(), verdict.right()), (counted, letters.matches('+').count()));
    }
    assert_eq!(one(vec![response('+'), response('~')]).votes[1].answer, response('+').answer);
}

#[test]
fn a_query_that_changed_or_went_is_stale_whatever_was_said() {
    let tabby = || (meaning(&["tabby"], Temporal::Whole, Interval::WHOLE), vec![response('+')]);
    let (round, key, given) = poll(&["ada"], &[tabby(), tabby(), tabby()]);
    let ids = round.items.iter().map(|item| item.id.clone());
    let changes = ids.zip([Change::No, Change::Edited, Change::Gone]).collect();
    let verdicts = judge(&round, &key, &given, &changes);
    let outcomes: Vec<Outcome> = verdicts.items.iter().map(|verdict| verdict.outcome).collect();
    assert_eq!(outcomes, [Outcome::Valid, Outcome::Stale, Outcome::Stale]);
    assert_eq!(verdicts.items[2].reasons, ["the query is gone since the round was opened"]);
    let found: Vec<_> =
        verdicts.findings.iter().map(|finding| (finding.code, finding.location.as_str())).collect();
    assert_eq!(found, [("L4D521", "item q0002"), ("L4D521", "item q0003")]);
}

#[test]
fn who_has_not_sealed_is_waited_for() {
    let tabby = meaning(&["tabby"], Temporal::Whole, Interval::WHOLE);
    let (round, key, mut given) = poll(&["ada", "ben"], &[(tabby, vec![response('+'), response('+')])]);
    assert!(judge(&round, &key, &given, &BTreeMap::new()).is_final && require_sealed(&round, &given).is_ok());
    given[1].sealed = false;
    let verdicts = judge(&round, &key, &given, &BTreeMap::new());
    assert_eq!((verdicts.is_final, verdicts.findings[0].code), (false, "L4D520"));
    let error = require_sealed(&round, &given).unwrap_err();
    assert!(error.to_string().contains("not sealed yet: ben"), "{error}");
}
