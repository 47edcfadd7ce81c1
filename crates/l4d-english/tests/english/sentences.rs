//! Sentences to read aloud: the first few forms of predicates that are drawn, and all forms of some.

use l4d_english::{Words, forms, missing};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::made_up::yard;
use crate::predicates::draw;

#[test]
fn everything_in_the_yard_has_words() {
    assert_eq!(missing(&yard()), [""; 0]);
}

#[test]
fn drawn_sentences() {
    let tracks = yard();
    let words = Words::of(&tracks);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut lines = Vec::new();
    for _ in 0..60 {
        let (predicate, temporal) = draw(&tracks, &mut rng);
        lines.push(format!("{predicate} [{temporal:?}]"));
        lines.extend(forms(&predicate, temporal, &words).iter().take(3).map(|form| format!("    {form}")));
    }
    insta::assert_snapshot!(lines.join("\n"));
}
