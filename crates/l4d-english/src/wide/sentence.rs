//! Whole texts: a description, the time at which it counts, and what an earlier sentence has spoken of.

use l4d_data::Temporal;
use l4d_query::{Clause, Party, Predicate, Relation, Superlative};

use super::guess::{Guess, Guesses, cheapest};
use super::noun_phrase::{Article, Described};
use super::property::Item;
use super::{Edge, Order, Wide};
use crate::lexicon::Form;

/// Words before a description that are passed over at most.
const MOST_PASSED: usize = 24;
/// Guesses at an earlier sentence that are followed.
const MOST_EARLIER: usize = 2;

type Meaning = (Predicate, Temporal);

impl Wide<'_, '_> {
    /// All guesses at the whole, the cheapest first.
    pub(super) fn sentences(&self) -> Vec<Guess<Meaning>> {
        let mut found = self.single_sentence(0);
        if self.before.is_none() {
            found.extend(self.after_another());
        }
        found.sort_by_key(|guess| guess.cost);
        found
    }

    /// One sentence: "at the end, the cup next to the lamp".
    fn single_sentence(&self, at: usize) -> Vec<Guess<Meaning>> {
        let mut found = Vec::new();
        let (edge, start) = match self.word(at) {
            "@start" => (Some(Edge::Start), self.skip(at + 1, ",")),
            "@end" => (Some(Edge::End), self.skip(at + 1, ",")),
            _ => (None, at),
        };
        if let Some(gate) = self.gate(start) {
            self.gated_first(gate, &mut found);
        }
        self.rivals_first(start, &mut found);
        self.inverted(start, edge, &mut found);
        self.no_other(start, edge, &mut found);
        self.part_first(start, &mut found);
        // "No teapot pours into this cup."
        let has_this = self.tokens.iter().any(|word| matches!(word.as_str(), "this" | "that"));
        for acted in self.acted_on(start).into_iter().filter(|_| self.before.is_none()) {
            let meaning = (acted.value.predicate(), Temporal::Whole);
            // "A hand pushes a block": objects are asked for, hands are not.
            let is_asked =
                has_this || self.mentions.first().is_some_and(|(_, noun)| !self.words.is_object(noun));
            found.push(acted.map(|_| meaning).plus(if is_asked { 4 } else { 40 }));
        }
        let inner = if edge.is_some() {
            self.skip(start, "it is|this is|that is|which is|which one is|find|show me|i want")
        } else {
            start
        };
        for begin in inner..self.tokens.len().min(inner + MOST_PASSED) {
            // What comes before a description is mostly manners.
            let mut passed = self.pass_all(inner, begin);
            passed.cost /= 3;
            let is_denial = begin > inner
                && matches!(self.word(begin - 1), "no" | "not" | "never" | "nobody" | "without" | "neither");
            if passed.cost > 60 || is_denial {
                break;
            }
            // What is named first is mostly what is meant.
            for (place, _) in self
                .mentions
                .iter()
                .filter(|(place, noun)| *place >= inner && *place < begin && self.words.is_object(noun))
            {
                let is_apart = self.tokens[*place..begin].iter().any(|word| word == ",");
                passed.cost += if is_apart { 5 } else { 14 };
            }
            let tops = self.described(begin, true);
            for top in tops.iter().filter(|top| top.value.article != Article::No) {
                let mut such = top.value.clone();
                let mut price = 0;
                if let Some(edge) = edge {
                    match edge.of(such.clauses.clone()) {
                        Some(clauses) => such.clauses = clauses,
                        None => price = 15,
                    }
                }
                let whole = passed.then(top.clone(), |(), _| such).plus(price);
                self.finish(&whole, &mut found);
            }
            // "Of the cups, the one that ..." and "the one of the cups".
            if let Some(of) = self.phrase(begin, "of the|of all the|among all the|among all|of these|of those|of all|between the|out of these|out of the|out of those|out of|among the|among these|among those|among|both of the|of both|from the|from these") {
                let of = self.skip(of, "two|three|four|five|these|those|the");
                for noun in self.nouns(of).into_iter().filter(|guess| guess.value.1) {
                    let next = self.skip(noun.end, ",");
                    for top in self.described(next, true).iter().filter(|top| top.value.noun == noun.value.0) {
                        let such = top.value.clone();
                        let whole = passed.then(noun.clone(), |(), _| ()).then(top.clone(), |(), _| such);
                        self.finish(&whole, &mut found);
                    }
                }
            }
        }
        cheapest(found)
    }

    /// "One notebook is open and the other is closed, I want the open one": the request says it all, and "one" is what
    /// was spoken of; "I want the one who doesn't" denies what was said.
    fn requested(&self, at: usize, later: &[String], found: &mut Vec<Guess<Meaning>>) {
        let joint = later.first().is_some_and(|word| matches!(word.as_str(), "and" | "but" | "so"));
        let request = super::tokens::without_preamble(later[usize::from(joint)..].to_vec());
        let is_request = request.len() + usize::from(joint) < later.len();
        let Some((_, noun)) =
            self.mentions.iter().find(|(place, noun)| *place < at && self.words.is_object(noun))
        else {
            return;
        };
        if !is_request || request.is_empty() {
            return;
        }
        let text = request.join(" ");
        if [
            "the one who does not",
            "the one that does not",
            "the one which does not",
            "the woman who does not",
            "the one that is not",
        ]
        .contains(&text.as_str())
        {
            let earlier = Wide::new(self.tokens[..at].to_vec(), self.words, None);
            for top in
                earlier.described(0, true).iter().filter(|top| top.value.clauses.len() == 1 && top.end == at)
            {
                let clauses = top.value.clauses.iter().cloned().map(super::negated);
                let all = std::iter::once(Clause::Category(top.value.noun.clone())).chain(clauses);
                found.push(top.clone().map(|_| (Predicate(all.collect()), Temporal::Whole)).plus(4));
            }
        }
        let spoken =
            Described { article: Article::The, noun: noun.clone(), clauses: Vec::new(), is_plural: false };
        let wide = Wide::new(request, self.words, Some(spoken));
        // "Next to it" speaks of more than the noun.
        let is_vague = |predicate: &Predicate| {
            predicate
                .parties()
                .into_iter()
                .any(|party| matches!(party, Party::Such(such) if such.0.len() == 1))
        };
        let is_whole = |guess: &Guess<Meaning>| guess.value.0.0.len() > 1 && !is_vague(&guess.value.0);
        let seconds = wide.single_sentence(0).into_iter().filter(is_whole).take(3);
        found.extend(seconds.map(|second| Guess { cost: second.cost + 6, skipped: 0, ..second }));
    }

    /// "Several drink, I want the last one to do so", "but which one is first".
    fn ordered_later(&self, at: usize, later: &[String], first: &Guess<Described>) -> Option<Guess<Meaning>> {
        let says = |words: &[&str]| later.iter().any(|word| words.contains(&word.as_str()));
        let order = match (says(&["first", "@first", "earliest"]), says(&["last", "@last", "second"])) {
            (true, false) => Order::First,
            (false, true) => Order::Last,
            _ => return None,
        };
        let plain = "and but which one of them is the i want this that does do so it to comes goes first last @first @last earliest second who s 's are ones \
            , mean am after a in doing be only then find show me need she he they their turn";
        let is_plain = later.iter().all(|word| plain.split_whitespace().any(|own| own == word));
        if !is_plain || first.end > at {
            return None;
        }
        let clauses = order.of(first.value.clauses.clone())?;
        let all = std::iter::once(Clause::Category(first.value.noun.clone())).chain(clauses);
        let meaning = (Predicate(all.collect()), Temporal::Whole);
        Some(first.clone().map(|_| meaning).plus(3))
    }

    /// What comes after a description: nothing, a gate, or words that fit nowhere.
    fn finish(&self, whole: &Guess<Described>, found: &mut Vec<Guess<Meaning>>) {
        let such = &whole.value;
        let length = self.tokens.len();
        let mut tail = self.pass_all(whole.end, length);
        tail.cost -= tail.cost / 3;
        // A description that says nothing is no description.
        let empty = if such.clauses.is_empty() { 30 } else { 0 };
        let meaning = (such.predicate(), Temporal::Whole);
        found.push(whole.then(tail, |_, ()| meaning).plus(empty + role_price(self, such)));
        for at in whole.end..length.min(whole.end + 3) {
            let Some(gate) = self.gate(at) else { continue };
            let passed = self.pass_all(whole.end, at);
            // "While it does so": what has been said already.
            let again = "it does so|she does so|he does so|they do so|it does it|she does it|he does it|they do it|it does|she does|he does|it is|she is|he is|they are|doing so|doing it|\
                doing that|it happens|this happens|that happens|that is happening|it is doing so|she is doing so|he is doing so|it is doing it|it is doing that|she is doing it|\
                she is doing that|he is doing it|he is doing that|it is at it|it lasts|that lasts|this lasts|it goes on|that goes on|it is happening|this is happening|it holds|that holds|that is so|\
                it is so|it does that|she does that|he does that|being so|it is there|that is the case|this is the case|it is true|they last|it has it|he has it|she has it|it has one|he makes it|she makes it|that is going on|it is going on";
            if let Some(end) = self.phrase(gate, again)
                && !such.clauses.is_empty()
            {
                let tail = self.pass_all(end, length);
                let meaning = (such.predicate(), Temporal::While);
                found.push(
                    whole
                        .then(passed.clone(), |_, ()| ())
                        .then(tail, |(), ()| meaning)
                        .plus(role_price(self, such)),
                );
            }
            for gated in self.gated(gate, &such.noun) {
                let tail = self.pass_all(gated.end, length);
                let clauses = such.predicate().0.into_iter().chain(gated.value.clone());
                let meaning = (Predicate(clauses.collect()), Temporal::While);
                let parts = whole.then(passed.clone(), |_, ()| ()).then(gated, |(), _| ());
                found.push(parts.then(tail, |(), ()| meaning).plus(role_price(self, such)));
            }
        }
    }

    /// The place after a word that begins a gate.
    fn gate(&self, at: usize) -> Option<usize> {
        let start = self.skip(at, "but only|but just|only|just|but");
        let mut next = self.any_of(start, "@while when as until once during throughout mid amid")?;
        let is_noun = matches!(self.word(start), "during" | "throughout" | "mid" | "amid");
        while let Some(after) = self.any_of(
            next,
            if is_noun {
                "its her his their the a this that act of whole"
            } else {
                "@while when as just only but"
            },
        ) {
            next = after;
        }
        Some(next)
    }

    /// "it rolls", "rolling", "a hand lifts it", "the dog is running".
    fn gated(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let at = self.skip(at, "there is|there are|is|you see it|you can see it|we see it|you see her|you see him|we can see it|it can be seen|it is seen");
        if let Some(next) = self.any_of(at, "it he she they that this") {
            found.extend(self.verb_phrase(next, noun));
        }
        for again in self
            .described(at, false)
            .iter()
            .filter(|guess| guess.value.noun == noun && guess.value.clauses.is_empty())
        {
            found.extend(self.verb_phrase(again.end, noun).into_iter().map(|guess| guess.plus(2)));
        }
        found.extend(self.verb_phrase(at, noun));
        found.extend(self.complement(at, noun));
        found.extend(self.done_by(at, noun));
        // "During its walk".
        if self.any_of(at.wrapping_sub(1), "its her his their the that").is_some() {
            let named = self.event(at, &[Form::Base], Some(noun), false).into_iter();
            found.extend(named.map(|guess| guess.map(|clause| vec![clause]).plus(2)));
        }
        // "While it has hold of it and is turning it": more of the same.
        let mut all = found.clone();
        for one in found {
            let Some(next) = self.phrase(one.end, "and|, and|and @while|and while") else { continue };
            let next = self.skip(next, "it|is|it is");
            for two in [self.done_by(next, noun), self.complement(next, noun)].concat() {
                all.push(one.then(two, |one, two| [&one[..], &two[..]].concat()));
            }
        }
        cheapest(all)
    }

    /// "While it is flying, the duck."
    fn gated_first(&self, gate: usize, found: &mut Vec<Guess<Meaning>>) {
        // "When the cat walks": nothing else is described.
        for top in self.described(gate, false).iter().filter(|top| self.words.is_object(&top.value.noun)) {
            let noun = &top.value.noun;
            for said in self.verb_phrase(top.end, noun) {
                let clauses = top.value.predicate().0.into_iter().chain(said.value.clone());
                let meaning = (Predicate(clauses.collect()), Temporal::While);
                let tail = self.pass_all(said.end, self.tokens.len());
                found.push(top.then(said, |_, _| ()).then(tail, |(), ()| meaning).plus(4));
            }
        }
        for (_, noun) in self.mentions.iter().take(4) {
            for gated in self.gated(gate, noun) {
                let next = self.skip(gated.end, "do i want to see|do i want|, do i want to see|i want to see|do i need to see|do i need|, that is what i want to see|, that is what i want|, that is when i want|, that is when i want to see|, that is when i need|, that is when|, i want|, show me|, find|,");
                for top in self.described(next, true).iter().filter(|top| top.value.noun == *noun) {
                    let clauses = top.value.predicate().0.into_iter().chain(gated.value.clone());
                    let meaning = (Predicate(clauses.collect()), Temporal::While);
                    let tail = self.pass_all(top.end, self.tokens.len());
                    found.push(gated.then(top.clone(), |_, _| ()).then(tail, |(), ()| meaning));
                }
            }
        }
    }

    /// "Before any of the other men, this one drinks."
    fn rivals_first(&self, at: usize, found: &mut Vec<Guess<Meaning>>) {
        let Some((_, noun)) = self.mentions.first() else { return };
        let Some((order, end)) = self.rivals(at, noun) else { return };
        let next = self.skip(end, ",");
        for top in self.described(next, true).iter().filter(|top| top.value.noun == *noun) {
            let Some(clauses) = order.of(top.value.clauses.clone()) else { continue };
            let all = std::iter::once(Clause::Category(noun.clone())).chain(clauses);
            let meaning = (Predicate(all.collect()), Temporal::Whole);
            let tail = self.pass_all(top.end, self.tokens.len());
            found.push(top.then(tail, |_, ()| meaning).plus(2));
        }
    }

    /// "Touching a hand, that pen": what is said goes before what it is said of.
    fn inverted(&self, at: usize, edge: Option<Edge>, found: &mut Vec<Guess<Meaning>>) {
        let at = self.skip(at, "it is|it|she is|she|he is|he|they are|they");
        for (place, noun) in self.mentions.iter().filter(|(place, _)| *place > at + 1) {
            for said in [self.complement(at, noun), self.verb_phrase(at, noun)].concat() {
                // "Next to that pot is the pot I want."
                let bare = self.any_of(said.end, "the a this that").map(|_| said.end);
                let Some(next) = self
                    .phrase(said.end, ",|is|are|, and that is|there is|, there is|stands|lies|sits|, that is")
                    .or(bare)
                    .filter(|next| next <= place)
                else {
                    continue;
                };
                for top in self.described(next, true).iter().filter(|top| top.value.noun == *noun) {
                    let clauses = match edge {
                        Some(edge) => edge.of(said.value.clone()),
                        None => Some(said.value.clone()),
                    };
                    let Some(clauses) = clauses else { continue };
                    let all = top.value.predicate().0.into_iter().chain(clauses);
                    let meaning = (Predicate(all.collect()), Temporal::Whole);
                    let tail = self.pass_all(top.end, self.tokens.len());
                    found.push(said.then(top.clone(), |_, _| ()).then(tail, |(), ()| meaning).plus(3));
                }
            }
        }
    }

    /// "The roof of one of the cars is black": the part goes first.
    fn part_first(&self, at: usize, found: &mut Vec<Guess<Meaning>>) {
        let start = self.skip(at, "the|its");
        for (item, end) in self.items(start) {
            let Item::Part(_) = &item else { continue };
            let Some(of) = self.any_of(end, "of") else { continue };
            for owner in
                self.described(of, false).iter().filter(|owner| self.words.is_object(&owner.value.noun))
            {
                let Some(is) = self.any_of(owner.end, "is are has") else { continue };
                for said in self.items(is) {
                    let Some((clauses, cost)) =
                        self.resolved(&owner.value.noun, &[item.clone(), said.0.clone()], false)
                    else {
                        continue;
                    };
                    let all = owner.value.predicate().0.into_iter().chain(clauses);
                    let meaning = (Predicate(all.collect()), Temporal::Whole);
                    let tail = self.pass_all(said.1, self.tokens.len());
                    found.push(owner.clone().ending(said.1).then(tail, |_, ()| meaning).plus(cost + 2));
                }
            }
        }
    }

    /// "No other cup is as tall", "no other cup is closer to the lamp".
    fn no_other(&self, at: usize, edge: Option<Edge>, found: &mut Vec<Guess<Meaning>>) {
        let Some(next) = self.phrase(at, "no other|none of the other|no") else { return };
        for noun in self.nouns(next) {
            let Some(is) = self
                .phrase(noun.end, "is|are|stands|gets|comes|lies|is as|stands as|are as|is quite as|is so")
            else {
                continue;
            };
            let name = noun.value.0.clone();
            let mut said = self.relation(is);
            said.extend(self.extreme(is));
            let plain = match self.word(is) {
                "tall" => Some(Superlative::Tallest),
                "big" | "large" => Some(Superlative::Largest),
                "small" | "little" | "tiny" => Some(Superlative::Smallest),
                "high" => Some(Superlative::Highest),
                "low" => Some(Superlative::Lowest),
                _ => None,
            };
            said.extend(plain.map(|extreme| Guess::new(vec![Clause::Superlative(extreme)], is + 1, 0)));
            let is_extreme = |clause: &Clause| match clause {
                Clause::Superlative(_) => true,
                Clause::Relation { kind, .. } => matches!(kind, Relation::ClosestTo | Relation::FarthestFrom),
                _ => false,
            };
            for (kind, words) in [
                (
                    Relation::FarthestFrom,
                    "as far from|so far from|as far away from|so far away from|as far off from|far from|as distant from",
                ),
                (
                    Relation::ClosestTo,
                    "as close to|as near to|so close to|so near to|close to|as near|quite as close to",
                ),
            ] {
                // "As" has been taken for part of "is as".
                let starts = [is, is.saturating_sub(1)];
                for of in starts.into_iter().filter_map(|start| self.phrase(start, words)) {
                    said.extend(self.parties(of).into_iter().map(|guess| {
                        guess.map(|(party, _)| vec![Clause::Relation { kind, of: vec![party] }])
                    }));
                }
            }
            for guess in said.into_iter().filter(|guess| guess.value.iter().all(is_extreme)) {
                let value = match edge {
                    Some(edge) => edge.of(guess.value.clone()).unwrap_or_else(|| guess.value.clone()),
                    None => guess.value.clone(),
                };
                let clauses = std::iter::once(Clause::Category(name.clone())).chain(value);
                let meaning = (Predicate(clauses.collect()), Temporal::Whole);
                let end = self.skip(guess.end, "as this one|as it|as this|than this one|than it|than this");
                let tail = self.pass_all(end, self.tokens.len());
                found.push(guess.then(tail, |_, ()| meaning).plus(4));
            }
        }
    }

    /// "One of the cats sits down, I'd like the toy in front of it": the second sentence speaks of the first.
    fn after_another(&self) -> Vec<Guess<Meaning>> {
        let mut found = Vec::new();
        let places = (1..self.tokens.len().saturating_sub(1)).filter(|at| self.word(*at) == ",");
        for at in places.take(3) {
            let later = self.tokens[at + 1..].to_vec();
            self.requested(at, &later, &mut found);
            let speaks_back = later.iter().any(|word| {
                matches!(
                    word.as_str(),
                    "it" | "him" | "her" | "them" | "she" | "he" | "one" | "that" | "they" | "its"
                )
            });
            if !speaks_back {
                continue;
            }
            let earlier = Wide::new(self.tokens[..at].to_vec(), self.words, None);
            let mut firsts: Vec<Guess<Described>> = Vec::new();
            for begin in 0..earlier.tokens.len().min(4) {
                let passed = earlier.pass_all(0, begin);
                for top in earlier.described(begin, true).iter() {
                    let tail = earlier.pass_all(top.end, earlier.tokens.len());
                    let such = top.value.clone();
                    firsts.push(passed.then(top.clone(), |(), _| ()).then(tail, |(), ()| such));
                }
            }
            let named = wide_mentions(&later, self.words);
            for acted in earlier.acted_on(0) {
                // "A cat bats a toy, and that toy is the one": the toy is meant.
                if named.as_ref() == Some(&acted.value.noun) {
                    let meaning = (acted.value.predicate(), Temporal::Whole);
                    found.push(acted.clone().map(|_| meaning).plus(3));
                }
                firsts.push(acted);
            }
            for guess in earlier.single_sentence(0) {
                let (predicate, temporal) = guess.value.clone();
                if temporal == Temporal::Whole {
                    let clauses = predicate.0.iter().skip(1).cloned().collect();
                    let noun = predicate.noun().to_owned();
                    firsts.push(
                        guess
                            .map(|_| Described { article: Article::The, noun, clauses, is_plural: false })
                            .plus(2),
                    );
                }
            }
            firsts.retain(|guess| !guess.value.clauses.is_empty());
            for first in &cheapest(firsts).into_iter().take(MOST_EARLIER).collect::<Vec<_>>() {
                let wide = Wide::new(
                    super::tokens::without_preamble(later.clone()),
                    self.words,
                    Some(first.value.clone()),
                );
                // "Both tilt, which one is last": an order of what was said.
                found.extend(self.ordered_later(at, &later, first));
                // "... that is the one": the second sentence says no more.
                let rest: u32 = (0..wide.tokens.len()).map(|place| wide.price(place)).sum();
                let meaning = (first.value.predicate(), Temporal::Whole);
                found.push(first.clone().map(|_| meaning).plus(10 + rest.min(40)));
                // What was passed over in the second sentence is not where it was in the whole.
                let seconds = wide.sentences().into_iter().take(3);
                found.extend(seconds.map(|second| Guess {
                    cost: first.cost + second.cost + 8,
                    skipped: first.skipped,
                    ..second
                }));
            }
        }
        found
    }
}

impl Wide<'_, '_> {
    /// "A hand sets one of the teapots down": what something is done to.
    fn acted_on(&self, at: usize) -> Guesses<Described> {
        let mut found = Vec::new();
        for subject in self.described(at, false).iter() {
            let verb_at = self.skip(subject.end, "never|does not|does|is|ever");
            let is_denied =
                self.tokens[subject.end..verb_at].iter().any(|word| matches!(word.as_str(), "never" | "not"));
            let is_not = is_denied || subject.value.article == Article::No;
            for event in self.event(
                verb_at,
                &[Form::Third, Form::Base, Form::Past, Form::Ing],
                Some(&subject.value.noun),
                true,
            ) {
                let Clause::Does { verb, to: Some(Party::Category(noun)) } = &event.value else { continue };
                let mut subject_ = subject.value.clone();
                if subject_.article == Article::No {
                    subject_.article = Article::A;
                }
                let by = self.party(&subject_);
                let clause = Clause::Undergoes { verb: verb.clone(), by };
                let clause = if is_not { super::negated(clause) } else { clause };
                let (clauses, end) = match self.rivals(event.end, noun) {
                    Some((order, end)) => {
                        (order.of(vec![clause.clone()]).unwrap_or_else(|| vec![clause]), end)
                    }
                    None => (vec![clause], event.end),
                };
                let such = Described { article: Article::The, noun: noun.clone(), clauses, is_plural: false };
                let tail = self.pass_all(end, self.tokens.len());
                found.push(subject.then(event.clone(), |_, _| ()).then(tail, |(), ()| such));
            }
        }
        // "The ball gets kicked by a woman": the woman.
        for subject in self.described(at, false).iter() {
            let Some(next) = self.any_of(subject.end, "is gets was got") else { continue };
            for event in self.passive(next, &subject.value.noun) {
                let Clause::Undergoes { verb, by: Party::Category(noun) } = &event.value else { continue };
                let clauses = vec![Clause::Does { verb: verb.clone(), to: Some(self.party(&subject.value)) }];
                let such = Described { article: Article::The, noun: noun.clone(), clauses, is_plural: false };
                let tail = self.pass_all(event.end, self.tokens.len());
                found.push(subject.then(event.clone(), |_, _| ()).then(tail, |(), ()| such));
            }
        }
        cheapest(found)
    }
}

/// Scenes are asked for objects, seldom for landmarks.
fn role_price(wide: &Wide<'_, '_>, such: &Described) -> u32 {
    if wide.words.is_object(&such.noun) { 0 } else { 25 }
}

/// What a later sentence names first.
fn wide_mentions(tokens: &[String], words: &crate::words::Words<'_>) -> Option<String> {
    let wide = Wide::new(tokens.to_vec(), words, None);
    wide.mentions.first().map(|(_, noun)| noun.clone())
}
