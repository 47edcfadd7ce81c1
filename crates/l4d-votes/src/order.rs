//! Who is asked what when: a shuffle of each annotator's own, recorded by its seed alone.
//!
//! A prompt that is asked twice is asked again only after half the round. Which of the two is the repeat is no
//! secret to an annotator who reads the prompts, so the order needs no key: equal prompts about one scene are a pair,
//! and the one with the smaller id comes first.

use std::collections::BTreeMap;

use l4d_data::Name;
use l4d_data::digest::sha256;
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::item::{Item, ItemId};
use crate::round::Round;

/// A generator that depends on nothing but these words.
pub(crate) fn random_of(words: &[&str]) -> ChaCha8Rng {
    ChaCha8Rng::from_seed(sha256(words.join("\n").as_bytes()))
}

pub(crate) fn order(round: &Round, annotator: &Name) -> Vec<ItemId> {
    let mut random = random_of(&["l4d/order/1", &round.seed.to_string(), &round.name, annotator]);
    let (mut pairs, mut singles) = pairs_and_singles(&round.items);
    pairs.shuffle(&mut random);
    singles.shuffle(&mut random);

    let mut order: Vec<Option<&ItemId>> = vec![None; round.items.len()];
    let places = distant_places(&mut random, order.len(), pairs.len());
    for ((first, second), [early, late]) in pairs.into_iter().zip(places) {
        order[early] = Some(first);
        order[late] = Some(second);
    }
    let mut singles = singles.into_iter();
    order.into_iter().filter_map(|place| place.or_else(|| singles.next())).cloned().collect()
}

fn pairs_and_singles(items: &[Item]) -> (Vec<(&ItemId, &ItemId)>, Vec<&ItemId>) {
    let mut prompts: BTreeMap<(&Name, &str), Vec<&ItemId>> = BTreeMap::new();
    for item in items {
        prompts.entry((&item.scene, &item.text)).or_default().push(&item.id);
    }
    let mut pairs = Vec::new();
    let mut singles = Vec::new();
    for ids in prompts.into_values() {
        match ids[..] {
            [first, second] => pairs.push((first, second)),
            _ => singles.extend(ids),
        }
    }
    (pairs, singles)
}

/// Pairs of places among `count` that are at least half of it apart, each place once; `pairs` is at most the half.
fn distant_places(random: &mut ChaCha8Rng, count: usize, pairs: usize) -> Vec<[usize; 2]> {
    let half = count / 2;
    let mut early: Vec<usize> = (0..half).collect();
    early.shuffle(random);
    early.truncate(pairs);
    // From the back: the later the early place, the fewer late ones are left for it. The k-th of them has at least
    // k places to choose from, and k - 1 are taken.
    early.sort_unstable_by(|a, b| b.cmp(a));
    let mut is_taken = vec![false; count];
    let mut places: Vec<[usize; 2]> = early
        .into_iter()
        .map(|early| {
            let free: Vec<usize> = (early + half..count).filter(|&place| !is_taken[place]).collect();
            let late = free[random.random_range(0..free.len())];
            is_taken[late] = true;
            [early, late]
        })
        .collect();
    places.shuffle(random);
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{items, name, round_of};

    /// Items with these prompts about one scene.
    fn round(prompts: &[String]) -> Round {
        let prompts: Vec<&str> = prompts.iter().map(String::as_str).collect();
        round_of(&["ada", "ben"], items("room", &prompts))
    }

    fn distinct(count: usize) -> Vec<String> {
        (0..count).map(|number| format!("The cat number {number}")).collect()
    }

    #[test]
    fn everybody_is_asked_everything_once_in_an_order_of_their_own() {
        let round = round(&distinct(40));
        let (ada, ben) = (round.order(&name("ada")), round.order(&name("ben")));
        assert_ne!(ada, ben);
        assert_eq!(ada, round.order(&name("ada")));
        for mut order in [ada, ben] {
            order.sort();
            assert!(order.iter().eq(round.items.iter().map(|item| &item.id)));
        }
    }

    #[test]
    fn the_order_follows_from_seed_round_and_annotator_alone() {
        // Recorded once: a round that has begun must keep its order under later versions.
        let order: Vec<String> =
            round(&distinct(8)).order(&name("ada")).iter().map(ToString::to_string).collect();
        assert_eq!(order.join(" "), "q0003 q0004 q0001 q0006 q0005 q0007 q0008 q0002");
    }

    #[test]
    fn a_repeat_comes_half_a_round_later() {
        for pairs in 0..=10 {
            for singles in usize::from(pairs == 0)..=7 {
                let mut prompts = distinct(pairs + singles);
                prompts.extend(distinct(pairs));
                let round = round(&prompts);
                for annotator in ["ada", "ben"] {
                    let order = round.order(&name(annotator));
                    assert_eq!(order.len(), prompts.len());
                    let place =
                        |index: usize| order.iter().position(|item| *item == round.items[index].id).unwrap();
                    for pair in 0..pairs {
                        let (first, second) = (place(pair), place(pairs + singles + pair));
                        assert!(second >= first + prompts.len() / 2, "{first} {second} of {}", prompts.len());
                    }
                }
            }
        }
    }

    #[test]
    fn the_same_words_about_another_scene_are_no_repeat() {
        let mut asked = items("room", &["The cat", "The dog"]);
        asked[1].scene = name("yard");
        asked[1].text = "The cat".to_owned();
        assert_eq!(pairs_and_singles(&asked).0, []);
    }
}
