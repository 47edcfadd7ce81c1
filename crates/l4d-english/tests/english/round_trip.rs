//! What is said is read back, whatever is drawn.

use std::collections::{BTreeMap, BTreeSet};

use l4d_english::{Words, canonical, forms, read, vocabulary};
use l4d_query::prove::{wording_problem, words as words_of};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::made_up::yard;
use crate::predicates::draw;

const DRAWS: usize = 1200;

#[test]
fn every_form_reads_back_and_no_two_predicates_share_one() {
    let tracks = yard();
    let words = Words::of(&tracks);
    let known = vocabulary();
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    let mut seen = BTreeSet::new();
    let mut meaning = BTreeMap::new();
    let (mut total, mut unsaid) = (0, Vec::new());
    for _ in 0..DRAWS {
        let (predicate, temporal) = draw(&tracks, &mut rng);
        let predicate = canonical(&predicate);
        if !seen.insert(format!("{predicate} {temporal:?}")) {
            continue;
        }
        let found = forms(&predicate, temporal, &words);
        if found.is_empty() {
            unsaid.push(format!("{predicate} ({temporal:?})"));
        }
        for sentence in found {
            total += 1;
            assert_eq!(read(&sentence, &words), Ok((predicate.clone(), temporal)), "{sentence}");
            let length = words_of(&sentence).len();
            assert!((3..=20).contains(&length), "{length} words: {sentence}");
            assert_eq!(wording_problem(&sentence, temporal, &predicate), None, "{sentence}");
            let strange: Vec<String> =
                words_of(&sentence).into_iter().filter(|word| !known.contains(word)).collect();
            assert_eq!(strange, [""; 0], "{sentence}");
            let other = meaning.insert(sentence.clone(), (predicate.clone(), temporal));
            assert!(other.is_none(), "{sentence} means {predicate} and {other:?}");
        }
    }
    let share = unsaid.len() as f64 / seen.len() as f64;
    println!("{} predicates, {total} sentences, {} unsaid", seen.len(), unsaid.len());
    assert!(share < 0.04, "{:.1} % are not said:\n{}", share * 100.0, unsaid.join("\n"));
}
