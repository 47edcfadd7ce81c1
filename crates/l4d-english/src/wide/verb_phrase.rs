//! What is said of a thing with verbs, and everything that may follow a noun.

use std::rc::Rc;

use l4d_query::{Clause, Relation};

use super::data::data;
use super::guess::{Guess, Guesses, cheapest};
use super::{Edge, Order, Wide, is_event, negated};
use crate::lexicon::Form;

const FINITE: [Form; 4] = [Form::Third, Form::Base, Form::Past, Form::Ing];
const BE: &str = "is|are|was|were|be|been|being|gets|get|getting|got|keeps|keep|keeping|stays|stay|staying|remains|remain|remaining|am|has been|have been|goes|appears|becomes";
const HAVE: &str = "has|have|had|having|got|has got|is having|keeps|with|contains|contain|holds|is holding|carries|shows|bears|displays|features|sports";
const WEAR: &str = "wears|wear|wore|is wearing|has on|sports";
const STARTS: &str = "starts out|starts off|starts|begins|started|began|start out|start off|start|begin|starts the clip|begins the clip|starting out|starting off|\
    starting|beginning|begins its time|starts life";
const ENDS: &str = "ends its trip|ends its drive|ends its journey|ends its run|ends its walk|finishes its trip|finishes its run|has ended up|has come to lie|has come to rest|has come to stand|has finished|has finished up|ends up|winds up|finishes up|finishes|finishes off|ends|comes to rest|comes to a rest|settles|lands up|ended up|finished|end up|wind up|finish|winding up|\
    ending up|finishing|finishing up|ending|ends the clip|finishes the clip|comes to a stop|is left|wound up|turns out|comes to stand|comes to lie|arrives|gets to";
const ASPECTS: &str = "get to|comes and|comes over and|goes over and|goes up and|walks up and|walks over and|starts by|begins by|starts off by|spends|spend|spends its time|spends her time|spends his time|spends the clip|spends time|go and|come and|goes off and|gets round to|gets around to|happen to|happens to be|gets to be|get to be|starts to|starts|begins to|begins|begin|begin to|start|start to|starting to|starting|keeps on|keeps|goes on to|goes on|goes and|gets to|goes|proceeds to|manages to|\
    sets about|sets off|is seen|can be seen|is busy|is shown|continues to|comes|decides to|gets down to|ends up|happens to|has to|would|can|does|do|did|will|is about to|breaks into|\
    gets itself|takes to|sets to|goes ahead and|is caught|is found|gets up and|goes to";
const POSTURES: &str = "stands|sits|lies|rests|stand|sit|lie|rest|standing|sitting|lying|resting|stood|sat|lay|hangs|hanging|is placed|is located|is put|placed|located|put|\
    comes|coming|stays|staying|remains|remaining|keeps|keeping|is found|is parked|parked|belongs|lives|finds itself|is situated|situated|rests itself|positioned|hovers|perches|perched";
const RELATIVES: &str = "that|which|who|whom|where|, which|, who|, that|, the one that|, the one which|, the one who|the one that|the one who|and that|and which|and who|\
    the one which|, the one|the one|the only one that|the only one who|, the only one that|, the only one who|, the only one which|whichever|the same one that|, it|, she|, he|, they|it|she|he|, this one|, that one";

/// All phrases of the grammar of verbs, whose words are no misspellings.
pub(super) const PHRASES: &[&str] = &[BE, HAVE, WEAR, STARTS, ENDS, ASPECTS, POSTURES, RELATIVES];

impl Wide<'_, '_> {
    /// What follows a noun, as far as each of it goes.
    pub(super) fn after(&self, at: usize, noun: &str, is_top: bool) -> Rc<Guesses<Vec<Clause>>> {
        let key = (at, noun.to_owned(), is_top);
        if let Some(found) = self.rests.borrow().get(&key) {
            return Rc::clone(found);
        }
        let mut found = vec![Guess::new(Vec::new(), at, 0)];
        if at < self.tokens.len() && self.may_go_on() {
            let add = |one: &Guess<Vec<Clause>>, found: &mut Guesses<Vec<Clause>>| {
                for rest in self.after(one.end, noun, is_top).iter() {
                    found.push(one.then(rest.clone(), |one, more| [&one[..], &more[..]].concat()));
                }
            };
            for one in self.modifiers(at, noun, is_top) {
                add(&one, &mut found);
            }
            if let Some(end) = self.background(at) {
                for rest in self.after(end, noun, is_top).iter() {
                    found.push(rest.clone().plus(2));
                }
            }
            // Words that fit nowhere are passed over if something follows.
            let is_joint = matches!(self.word(at), "," | "and" | "but" | "@all");
            let may_pass = is_top
                || is_joint
                || !matches!(
                    self.word(at),
                    "@while" | "when" | "as" | "@end" | "@start" | "@first" | "@last" | "and"
                );
            if may_pass && self.word(at) != "@while" {
                let passed = self.pass(at);
                let cost = if is_joint { 1 } else { passed.cost + 1 };
                for rest in self.after(at + 1, noun, is_top).iter().filter(|rest| !rest.value.is_empty()) {
                    let mut longer = rest.clone();
                    longer.cost += cost;
                    longer.skipped |= passed.skipped;
                    found.push(longer);
                }
            }
        }
        let found = Rc::new(cheapest(found));
        self.rests.borrow_mut().insert(key, Rc::clone(&found));
        found
    }

    /// The place after "on the table", where the scene has no table that could be meant, or "more than the others".
    fn background(&self, at: usize) -> Option<usize> {
        if let Some(more) = self.any_of(at, "more") {
            return self.than_others(more);
        }
        // "That leaves the balls alone, never chasing one": what follows says what is meant.
        let start = self.skip(at, RELATIVES);
        if let Some(next) = self.any_of(start, "leaves leave leaving") {
            let left = self
                .parties(next)
                .into_iter()
                .filter_map(|guess| self.phrase(guess.end, "alone|be|in peace"));
            return left.min();
        }
        let next = self.any_of(at, "on in at across along over of around from inside")?;
        let next = self.skip(next, "the|this|that|a|our|this little|that little");
        let is_place = data().background.iter().any(|word| word == self.word(next));
        let is_there = self.nouns(next).iter().any(|guess| guess.cost < 8);
        (is_place && !is_there).then_some(next + 1)
    }

    /// One thing that is said of a noun after it.
    fn modifiers(&self, at: usize, noun: &str, is_top: bool) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        // "Which basket is next to it" asks anew.
        let asks = |next: &usize| {
            self.word(next - 1) == "which" && self.nouns(*next).iter().any(|guess| guess.value.0 == noun)
        };
        if let Some(next) = self.phrase(at, RELATIVES).filter(|next| !asks(next)) {
            found.extend(self.verb_phrase(next, noun));
            found.extend(self.done_by(next, noun));
            found.extend(self.relation(next).into_iter().map(|guess| guess.plus(1)));
            // "That, at the end, a hand touches".
            let pause = self.skip(next, ",");
            for (edge, word) in [(Edge::Start, "@start"), (Edge::End, "@end")] {
                let Some(then) = self.any_of(pause, word) else { continue };
                let then = self.skip(then, ",");
                for guess in [self.done_by(then, noun), self.verb_phrase(then, noun)].concat() {
                    found.extend(edge.of(guess.value.clone()).map(|clauses| guess.clone().map(|_| clauses)));
                }
            }
        }
        if let Some(next) = self.any_of(at, "whose 's") {
            found.extend(self.whose(next, noun));
        }
        if let Some(next) = self.phrase(at, "for which the|for which|of which the|of which|around whose|on whose|in whose|round whose|at whose|with its|with his|with her|with their|, its|, his|, her|, their|and its|and his|and her") {
            found.extend(self.whose(next, noun).into_iter().map(|guess| guess.plus(2)));
        }
        // "By whom the ball is kicked".
        if let Some(next) = self.phrase(at, "by which|by that") {
            for acted in self.acted_by(next, noun) {
                found.push(acted);
            }
        }
        found.extend(self.described_by(at, noun));
        found.extend(self.relation(at));
        found.extend(self.extreme(at));
        found.extend(self.event(at, &[Form::Ing], Some(noun), true).into_iter().map(single));
        found.extend(self.passive(at, noun).into_iter().map(single));
        if let Some(next) = self.any_of(at, "with has having") {
            found.extend(self.surrounded(next));
            found.extend(self.done_by(next, noun).into_iter().map(|guess| guess.plus(2)));
            found.extend(self.event(at, &[Form::Third], Some(noun), true).into_iter().map(single));
        }
        if let Some(next) = self.any_of(at, "without") {
            // "Without a basket in her hands".
            for guess in self.parties(next) {
                let Some(end) = self.phrase(guess.end, "in her hands|in his hands|in their hands|in hand|in her hand|in his hand|in hands|in their hand") else { continue };
                let hold =
                    |(party, _)| vec![negated(Clause::Does { verb: "hold".to_owned(), to: Some(party) })];
                found.push(guess.map(hold).ending(end));
            }
            let next = self.skip(next, "ever|once|being");
            found.extend(self.event(next, &[Form::Ing], Some(noun), true).into_iter().map(single).map(not));
            found.extend(self.passive(next, noun).into_iter().map(single).map(not));
        }
        if let Some(next) = self.any_of(at, "never not") {
            found.extend(self.complement(next, noun).into_iter().map(not));
            found.extend(self.one_verb(next, noun).into_iter().map(not));
        }
        if self.phrase(at, "does not|do not|did not|neither|is|was|does").is_some() {
            found.extend(self.one_verb(at, noun).into_iter().map(|guess| guess.plus(5)));
        }
        if self.any_of(at, "to").is_some() {
            let next = at + 1;
            found.extend(self.verb_phrase(next, noun).into_iter().map(|guess| guess.plus(2)));
        }
        if self.phrase(at, ENDS).is_some()
            || self.phrase(at, STARTS).is_some()
            || self.any_of(at, "being getting neither either").is_some()
        {
            found.extend(self.verb_phrase(at, noun).into_iter().map(|guess| guess.plus(1)));
        }
        if self.phrase(at, POSTURES).is_some() {
            found.extend(self.posture(at, noun));
        }
        // "The cup a hand lifts", "the notebook nobody writes in".
        found.extend(self.done_by(at, noun).into_iter().map(|guess| guess.plus(1)));
        if is_top {
            // "Which dog runs", "the striped ball, the orange one".
            found.extend(self.verb_phrase(at, noun).into_iter().map(|guess| guess.plus(3)));
            let start = self.skip(at, ",|and|, and|i mean|, i mean");
            if start > at {
                for other in self.described(start, false).iter().filter(|guess| guess.value.noun == noun) {
                    found.push(other.clone().map(|such| such.clauses).plus(4));
                }
            }
        }
        found.retain(|guess| guess.end > at && !guess.value.is_empty());
        self.timed(self.sequences(self.timed(cheapest(found), noun), noun), noun)
    }

    /// With what comes after it in time: "waits, then drives", "walks before drinking".
    fn sequences(&self, guesses: Guesses<Vec<Clause>>, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = guesses.clone();
        for one in guesses {
            let [first] = &one.value[..] else { continue };
            // "First waddles and then drinks": the first of two, not of all.
            let first = match first {
                Clause::First(inner) => inner.as_ref(),
                clause => clause,
            };
            if !is_event(first) {
                continue;
            }
            let at =
                self.skip(one.end, ",|first ,|first and|and first|first|, and|at first ,|@start ,|@start");
            let links = [
                (self.phrase(at, "@then|and @then|, @then|but @then|first @then|@start @then|and|, and"), self.phrase(at, "and|, and").is_some(), true),
                (self.phrase(at, "before it|before she|before he|before they|before|until it|until"), false, true),
                (self.phrase(at, "after it|after she|after he|after they|after having|after first|only after|after"), false, false),
                (self.phrase(at, "but first|, but first|but before that|, but before that|, and before that|and before that|, and before this"), false, false),
            ];
            for (next, is_and, is_later) in links {
                let Some(next) = next else { continue };
                let next = self.skip(
                    next,
                    "who|that|which|,|first|next|is|@then|she|he|it|they|it is|she is|he is|, she|, it|, he",
                );
                for two in self.one_verb(next, noun) {
                    let [second] = &two.value[..] else { continue };
                    if !is_event(second) || second == first {
                        continue;
                    }
                    // "And" alone orders nothing.
                    let is_marked = !is_and
                        || matches!(
                            self.word(two.end),
                            "@then" | "@last" | "@end" | "later" | "second" | "next"
                        );
                    if !is_marked {
                        continue;
                    }
                    let steps = if is_later {
                        [first.clone(), second.clone()]
                    } else {
                        [second.clone(), first.clone()]
                    };
                    let end = if is_and { two.end + 1 } else { two.end };
                    found.push(one.then(two.clone(), |_, _| vec![Clause::Then(Box::new(steps))]).ending(end));
                }
            }
        }
        cheapest(found)
    }

    /// With the time or the order that follows.
    fn timed(&self, guesses: Guesses<Vec<Clause>>, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = guesses.clone();
        for guess in guesses {
            let at = self.skip(guess.end, ", but only|, only|, and only|but only|only|, but|,");
            for (edge, word) in [(Edge::Start, "@start"), (Edge::End, "@end")] {
                let Some(end) = self.any_of(at, word) else { continue };
                found.extend(
                    edge.of(guess.value.clone()).map(|clauses| guess.clone().map(|_| clauses).ending(end)),
                );
            }
            if let Some((order, end)) = self.rivals(at, noun) {
                found.extend(
                    order.of(guess.value.clone()).map(|clauses| guess.clone().map(|_| clauses).ending(end)),
                );
            }
            for (order, words) in [
                (Order::First, "@first|first|first of all"),
                (Order::Last, "@last|last|second|last of all|last of them all|the last|at last"),
            ] {
                let Some(mut end) = self.phrase(at, words) else { continue };
                // "First" before "then" begins a sequence.
                if matches!(self.word(end), "@then" | "and") {
                    continue;
                }
                end = self.after_rivals(end, noun);
                found.extend(
                    order.of(guess.value.clone()).map(|clauses| guess.clone().map(|_| clauses).ending(end)),
                );
            }
        }
        cheapest(found)
    }

    /// "before all of the other cats do": an order among the like.
    pub(super) fn rivals(&self, at: usize, noun: &str) -> Option<(Order, usize)> {
        let (order, start) = match self.phrase(at, "before|ahead of|sooner than|earlier than|prior to") {
            Some(start) => (Order::First, start),
            None => (Order::Last, self.phrase(at, "after|later than|behind")?),
        };
        let mut end = start;
        loop {
            if let Some(next) = self.any_of(end, "any all both every each the other others one ones of them rest two three four else everyone everybody anyone anybody either these those") {
                end = next;
                continue;
            }
            match self.nouns(end).iter().find(|guess| guess.value.0 == noun) {
                Some(guess) => end = guess.end,
                None => break,
            }
        }
        let names_rivals = self.tokens[start..end]
            .iter()
            .any(|word| matches!(word.as_str(), "other" | "others" | "rest" | "else"));
        let mut end = self.skip(end, "does|do|is|are|did|have|has|does so|do so|gets to|get to|manages to|has been|have been|had|does it|do it|does that|do that");
        // "... have stood", "... carries one".
        if names_rivals && data().doings_at(self.word(end)).next().is_some() {
            end = self.skip(end + 1, "one|it|down|up|from it|off|so|over|there|any");
        }
        names_rivals.then_some((order, end))
    }

    /// The place after "the other cats do", where an order has been said.
    fn after_rivals(&self, at: usize, noun: &str) -> usize {
        let mut end = at;
        let nouns = self.nouns(end);
        if let Some(guess) = nouns.iter().find(|guess| guess.value.0 == noun) {
            end = guess.end;
        }
        end = self.of_all(end).unwrap_or(end);
        self.skip(end, "does|do|is|are|one|ones|one does|one is|did")
    }

    /// Verbs with one subject: "stirs a pot and tastes the food", "neither runs nor jumps".
    pub(super) fn verb_phrase(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        for one in self.timed(self.sequences(self.timed(self.one_verb(at, noun), noun), noun), noun) {
            let start = self.skip(one.end, ",");
            let is_not = |clauses: &[Clause]| clauses.iter().any(|clause| matches!(clause, Clause::Not(_)));
            let joint = self.phrase(start, "and|but|or|nor|and also|and that|and who|and which|but also|or that|as well as|and it|and she|and he").or_else(|| (start > one.end).then_some(start));
            if let Some(next) = joint {
                let continues_not = matches!(self.word(start), "or" | "nor") && is_not(&one.value);
                for two in self.verb_phrase_rest(next, noun) {
                    let is_already = is_not(&two.value);
                    let two = if continues_not && !is_already { not(two) } else { two };
                    found.push(one.then(two, |one, two| [&one[..], &two[..]].concat()));
                }
            }
            found.push(one);
        }
        cheapest(found)
    }

    fn verb_phrase_rest(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        if !self.may_go_on() {
            return Vec::new();
        }
        let mut found = self.verb_phrase(at, noun);
        // "Is on the tray and beside the lamp", "in the jug or on it".
        found.extend(self.relation(at));
        cheapest(found)
    }

    /// One verb with all that belongs to it.
    fn one_verb(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        if !self.may_go_on() {
            return found;
        }
        for (edge, word) in [(Edge::Start, "@start"), (Edge::End, "@end")] {
            if let Some(next) = self.any_of(at, word) {
                let next = self.skip(next, ",");
                let later = self.one_verb(next, noun).into_iter();
                found.extend(later.filter_map(|guess| guess.maybe(|value| edge.of(value))));
            }
        }
        for (order, words) in [
            (Order::First, "@first|, @first ,|@first ,|first"),
            (Order::Last, "@last|, @last ,|@last ,|last"),
        ] {
            if let Some(next) = self.phrase(at, words) {
                let later = self.one_verb(next, noun).into_iter().map(|guess| guess.plus(2));
                found.extend(later.filter_map(|guess| guess.maybe(|value| order.of(value))));
            }
        }
        if let Some(next) = self.phrase(at, "never|not|neither|does not|do not|did not|will not|can not|has never|have never|nor does it|nor does|nor do|nor|does never|would never|would not|has not|have not|does n't ever") {
            let next = self.skip(next, "be|been|ever");
            found.extend(self.one_verb(next, noun).into_iter().map(not));
            found.extend(self.complement(next, noun).into_iter().map(not));
        }
        if let Some(next) = self.phrase(at, BE) {
            found.extend(self.complement(next, noun));
        }
        if let Some(next) = self.phrase(at, HAVE) {
            found.extend(self.run(next, noun, false));
            if let Some(no) = self.any_of(next, "no not") {
                found.extend(self.lacking(no, noun));
            }
            found.extend(self.surrounded(next));
            found.extend(self.done_by(next, noun).into_iter().map(|guess| guess.plus(2)));
        }
        if let Some(next) = self.phrase(at, "has|have|had|having|gets|got|is given|receives|with") {
            found.extend(self.passive_of_something(next, noun));
        }
        if let Some(next) = self.phrase(
            at,
            "gets a|gets|receives a|receives|is given a|takes a|gets given a|got a|getting a|to get a|get a",
        ) {
            found.extend(self.given(next, noun));
        }
        // "Gets its tea from the pot".
        if let Some(from) = self.phrase(at, "gets its tea from|gets tea from|receives tea from|gets its drink from|gets a refill from|is given tea by|gets given tea by|receives its tea from|gets topped up from") {
            for guess in self.parties(from) {
                found.push(guess.map(|(by, _)| vec![Clause::Undergoes { verb: "pour_into".to_owned(), by }]));
            }
        }
        if let Some(next) = self.phrase(at, WEAR) {
            found.extend(self.run(next, noun, true));
            if let Some(no) = self.any_of(next, "no not") {
                found.extend(self.lacking(no, noun));
            }
        }
        // "After driving for a bit, waits": the one and then the other.
        if let Some(next) =
            self.phrase(at, ", after having|after having|, having|having|, after|after|, once done|once done")
        {
            for one in self.event(next, &[Form::Ing, Form::Participle], Some(noun), true) {
                let later = self.skip(one.end, ",|it|, it|she|he");
                for two in self.one_verb(later, noun) {
                    let [second] = &two.value[..] else { continue };
                    if is_event(second) && is_event(&one.value) && one.value != *second {
                        let steps = [one.value.clone(), second.clone()];
                        let end = self.skip(two.end, "@then|later");
                        found.push(
                            one.then(two.clone(), |_, _| vec![Clause::Then(Box::new(steps))]).ending(end),
                        );
                    }
                }
            }
        }
        for (edge, phrases) in [(Edge::Start, STARTS), (Edge::End, ENDS)] {
            let Some(next) = self.phrase(at, phrases) else { continue };
            // "Starts by kicking a ball" tells what comes first.
            if self.word(next) == "by" && self.word(next + 1).ends_with("ing") {
                continue;
            }
            let next =
                self.skip(next, "by being|being|off|up|out|by|in a place|things|as|out as|off as|up as");
            // "Starts walking" is walking; "starts out walking" is at the start.
            let is_plain = matches!(edge, Edge::Start) && next == at + 1;
            for guess in self.complement(next, noun) {
                let is_all_events = guess.value.iter().all(is_event);
                let cost = if is_plain && is_all_events { 6 } else { 0 };
                if let Some(clauses) = edge.of(guess.value.clone()) {
                    found.push(guess.map(|_| clauses).plus(cost));
                }
            }
        }
        if let Some(next) = self.phrase(at, ASPECTS) {
            let next = self.skip(next, "itself|herself|himself|off|to|be|out|up");
            found.extend(
                self.event(next, &FINITE, Some(noun), true)
                    .into_iter()
                    .map(single)
                    .map(|guess| guess.plus(1)),
            );
            found.extend(self.passive(next, noun).into_iter().map(single).map(|guess| guess.plus(1)));
            found.extend(self.complement(next, noun).into_iter().map(|guess| guess.plus(3)));
        }
        if self.phrase(at, POSTURES).is_some() {
            found.extend(self.posture(at, noun));
        }
        for (words, kind) in [("faces face", Relation::Facing), ("touches touch touched", Relation::Touching)]
        {
            let Some(next) = self.any_of(at, words) else { continue };
            for guess in self.parties(next) {
                found.push(guess.map(|(party, _)| vec![Clause::Relation { kind, of: vec![party] }]));
            }
        }
        found.extend(self.event(at, &FINITE, Some(noun), true).into_iter().map(single));
        found.retain(|guess| guess.end > at && !guess.value.is_empty());
        self.timed(cheapest(found), noun)
    }

    /// "stands nearest the plant": where, more than what is done; both where such things do it.
    fn posture(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let Some(next) = self.phrase(at, POSTURES) else { return Vec::new() };
        let next = self.skip(next, "off|up|out|there|right there|over");
        let does = ["stand", "sit", "lie", "rest"]
            .iter()
            .any(|verb| self.words.is_of_a_scene() && self.words.is_done_by(verb, noun));
        let cost = if does { 2 } else { 0 };
        let mut found: Guesses<Vec<Clause>> =
            self.relation(next).into_iter().map(|guess| guess.plus(cost)).collect();
        found.extend(self.extreme(next).into_iter().map(|guess| guess.plus(cost)));
        // "Lying open".
        found.extend(self.run(next, noun, false).into_iter().map(|guess| guess.plus(3)));
        found
    }

    /// After "has": "tea poured into it".
    fn passive_of_something(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let Some(next) = self.phrase(at, "tea|water|something|anything|nothing|coffee|a drink|liquid|words|notes|some tea|some water|its lid") else { return Vec::new() };
        let is_nothing = self.word(at) == "nothing";
        let found = self.passive(next, noun).into_iter().map(single);
        if is_nothing { found.map(not).collect() } else { found.collect() }
    }

    /// What may follow "is".
    pub(super) fn complement(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        if !self.may_go_on() {
            return found;
        }
        if let Some(next) = self.any_of(at, "not never neither") {
            return self.complement(next, noun).into_iter().map(not).collect();
        }
        let at_edge = self.phrase(at, ", @start|, @end").map_or(at, |end| end - 1);
        for (edge, word) in [(Edge::Start, "@start"), (Edge::End, "@end")] {
            if let Some(next) = self.any_of(at_edge, word) {
                let next = self.skip(next, ",");
                let later = self.complement(next, noun).into_iter();
                found.extend(later.filter_map(|guess| guess.maybe(|value| edge.of(value))));
            }
        }
        found.extend(self.extreme(at));
        found.extend(self.relation(at));
        // "Sitting there waiting".
        if let Some(next) = self.phrase(at, "sitting|standing|lying|stuck|sat|stood|parked|kept|left|held up")
        {
            found.extend(
                self.event(next, &[Form::Ing], Some(noun), true)
                    .into_iter()
                    .map(single)
                    .map(|guess| guess.plus(2)),
            );
        }
        if self.phrase(at, POSTURES).is_some() {
            found.extend(self.posture(at, noun).into_iter().map(|guess| guess.plus(1)));
        }
        found.extend(self.run(at, noun, false));
        found.extend(self.described_by(at, noun).into_iter().map(|guess| guess.plus(1)));
        found.extend(self.event(at, &[Form::Ing], Some(noun), true).into_iter().map(single));
        found.extend(self.passive(at, noun).into_iter().map(single));
        if let Some(next) = self.phrase(at, "being|getting|having been|seen|to be|shown") {
            found.extend(self.passive(next, noun).into_iter().map(single));
            found
                .extend(self.event(next, &[Form::Ing, Form::Base], Some(noun), true).into_iter().map(single));
        }
        found.extend(self.order_of(at, noun));
        // "Is a steel one", "is the only one between the posts".
        for such in self
            .described(at, false)
            .iter()
            .filter(|guess| guess.value.noun == noun && !guess.value.clauses.is_empty())
        {
            found.push(such.clone().map(|such| such.clauses).plus(1));
        }
        if let Some(next) = self.phrase(at, "the one|the only one") {
            found.extend(
                self.after(next, noun, false).iter().filter(|guess| !guess.value.is_empty()).cloned(),
            );
        }
        found.retain(|guess| guess.end > at && !guess.value.is_empty());
        self.timed(cheapest(found), noun)
    }

    /// "the first to jump", "last of the cats to sit", "first that a hand lifts".
    fn order_of(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let start = self.skip(at, "the|the very");
        let order = match self.word(start) {
            "first" | "@first" => Order::First,
            "last" | "@last" | "second" => Order::Last,
            _ => return Vec::new(),
        };
        let mut next = self.skip(start + 1, "one|ones");
        if let Some(guess) = self.nouns(next).iter().find(|guess| guess.value.0 == noun) {
            next = guess.end;
        }
        next = self.of_all(next).unwrap_or(next);
        let mut found = Vec::new();
        if let Some(to) = self.phrase(next, "to|who|that|which|when it comes to|at|in") {
            found.extend(self.verb_phrase(to, noun));
            found.extend(self.done_by(to, noun));
        }
        found.extend(self.event(next, &[Form::Ing], Some(noun), true).into_iter().map(single));
        found.extend(self.passive(next, noun).into_iter().map(single));
        let ordered = found.into_iter().filter_map(|guess| guess.maybe(|value| order.of(value)));
        ordered.collect()
    }

    /// After "whose": "roof is black", "hair has been cut short", "turn to tip comes last".
    fn whose(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = self.run(at, noun, false);
        if let Some(to) = self.phrase(at, "turn to|turn at") {
            for guess in self.verb_phrase(to, noun) {
                for (order, words) in [
                    (Order::First, "comes first|is first|comes @first"),
                    (Order::Last, "comes last|is last|comes @last|comes at the last"),
                ] {
                    let Some(end) = self.phrase(guess.end, words) else { continue };
                    found.extend(
                        order
                            .of(guess.value.clone())
                            .map(|clauses| guess.clone().map(|_| clauses).ending(end)),
                    );
                }
            }
        }
        // "Whose distance to the lamp is greatest".
        if let Some(to) =
            self.phrase(at, "distance to|distance from|distance to and from|gap to|separation from")
        {
            for guess in self.parties(to) {
                let next = self.skip(guess.end, "is the|is|comes out the|comes out");
                let more = match self.word(next) {
                    "larger" | "greater" | "longer" | "bigger" | "farther" => Some(Relation::FarthestFrom),
                    "smaller" | "closer" | "less" => Some(Relation::ClosestTo),
                    _ => None,
                };
                if let (Some(kind), Some(end)) = (more, self.than_others(next + 1)) {
                    found.push(
                        guess
                            .clone()
                            .map(|(party, _)| vec![Clause::Relation { kind, of: vec![party] }])
                            .ending(end),
                    );
                }
                let kind = match self.word(next) {
                    "greatest" | "largest" | "longest" | "farthest" | "highest" | "most" | "maximal" => {
                        Relation::FarthestFrom
                    }
                    "smallest" | "least" | "closest" | "lowest" | "minimal" => Relation::ClosestTo,
                    _ => continue,
                };
                found.push(
                    guess.map(|(party, _)| vec![Clause::Relation { kind, of: vec![party] }]).ending(next + 1),
                );
            }
        }
        // "Whose lid swings up": the part is what does it.
        if let Some((_, end)) =
            self.items(at).into_iter().find(|(item, _)| matches!(item, super::property::Item::Part(_)))
        {
            found.extend(self.verb_phrase(end, noun).into_iter().map(|guess| guess.plus(4)));
        }
        cheapest(found)
    }
}

fn single(guess: Guess<Clause>) -> Guess<Vec<Clause>> {
    guess.map(|clause| vec![clause])
}

fn not(guess: Guess<Vec<Clause>>) -> Guess<Vec<Clause>> {
    guess.map(|clauses| clauses.into_iter().map(negated).collect())
}
