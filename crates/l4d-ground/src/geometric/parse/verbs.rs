//! What is done, by whom and to whom: active, passive, with and without an object.

use l4d_query::{Clause, Party};

use super::super::lexicon::{Form, Motion, VerbReading};
use super::phrase::{attribute, is_plain_event};
use super::places::{ClipEnd, FILLERS};
use super::{ANY_PERSON, Order, Reader};

const BEING: &str = "is being|are being|was being|is|are|was|were|being|be|has been|gets|get|got|\
     getting";
const AT_END: &str = "ends up|end up|ended up|winds up";
const AT_START: &str = "starts out|starts off|start out|begins|starts|started out";
/// Verbs that only say that another one begins or goes on.
const ASPECTS: &str = "starts to|start to|starts|start|starting to|begins to|begin to|begins|keeps on|\
     keeps|goes on|goes|gets to|is seen|be seen|is about to|has to|does|do";
impl Reader<'_> {
    /// A verb phrase whose subject is what is described: "walks", "is not on the tray", "ends up under the bench".
    pub(super) fn predicate(&mut self) -> Option<Vec<Clause>> {
        let mut clauses = self.simple_predicate()?;
        let then = self.attempt(|reader| {
            reader.clip_end();
            reader.skip(",");
            reader.take_any("and then|and afterwards|and later|then|before")?;
            reader.simple_predicate()
        });
        if let Some(mut after) = then {
            let both = clauses.len() == 1
                && after.len() == 1
                && is_plain_event(&clauses[0])
                && is_plain_event(&after[0]);
            if let (true, Some(first), Some(second)) = (both, clauses.pop(), after.pop()) {
                return Some(vec![Clause::Then(Box::new([first, second]))]);
            }
            clauses.extend(after);
        }
        Some(clauses)
    }

    fn simple_predicate(&mut self) -> Option<Vec<Clause>> {
        self.skip(FILLERS);
        if self.take_any(AT_END).is_some() {
            return self.attempt(|reader| reader.state_at(ClipEnd::End));
        }
        if let Some(clauses) = self.attempt(|reader| {
            reader.take_any(AT_START)?;
            reader.state_at(ClipEnd::Start)
        }) {
            return Some(clauses);
        }
        let is_negated = self.take_any("never|does not|doesn't|do not|don't").is_some();
        let clauses = self
            .attempt(Self::being)
            .or_else(|| self.attempt(Self::having))
            .or_else(|| self.attempt(Self::doing))?;
        if !is_negated {
            return Some(clauses);
        }
        Some(clauses.into_iter().map(|clause| Clause::Not(Box::new(clause))).collect())
    }

    /// What follows "ends up" and "starts out": a place or a state.
    fn state_at(&mut self, end: ClipEnd) -> Option<Vec<Clause>> {
        self.skip(FILLERS);
        let is_negated = self.take("not");
        self.take_any("standing|sitting|lying|resting|being|up");
        let placed = self.attempt(Self::appearance_of_place).or_else(|| self.relation());
        let clause = placed.or_else(|| self.attempt(Self::extreme)).or_else(|| {
            let clauses = self.attempt(Self::doing)?;
            clauses.into_iter().next().filter(is_plain_event)
        })?;
        let clause = if is_negated { Clause::Not(Box::new(clause)) } else { clause };
        Some(vec![end.of(clause)])
    }

    /// "with another block standing on it" as a place.
    fn appearance_of_place(&mut self) -> Option<Clause> {
        if self.word() != "with" {
            return None;
        }
        let clauses = self.appearance()?;
        clauses.into_iter().find(|clause| matches!(clause, Clause::Relation { .. }))
    }

    /// "is on the tray", "gets stroked", "is the first to slide", "are walking".
    fn being(&mut self) -> Option<Vec<Clause>> {
        let verb = self.take_any(BEING)?;
        self.skip(FILLERS);
        let is_negated = self.take_any("not|never|no longer").is_some();
        self.skip(FILLERS);
        self.take("being");
        let clauses = self.complement(verb)?;
        if !is_negated {
            return Some(clauses);
        }
        Some(clauses.into_iter().map(|clause| Clause::Not(Box::new(clause))).collect())
    }

    fn complement(&mut self, verb: &str) -> Option<Vec<Clause>> {
        if let Some(clauses) = self.attempt(Self::ordinal_complement) {
            return Some(clauses);
        }
        if matches!(verb, "gets" | "get" | "got")
            && let Some(clause) = self.attempt(Self::filled)
        {
            return Some(vec![clause]);
        }
        let extreme = self.attempt(|reader| {
            reader.take_any("the|one of the");
            let clause = reader.extreme()?;
            reader.attempt(|reader| {
                reader.take("of the").then_some(())?;
                let (_, _, length) = reader.lexicon.noun_at(reader.rest())?;
                reader.advance(length);
                Some(())
            });
            Some(clause)
        });
        if let Some(clause) = extreme.or_else(|| self.relation()) {
            return Some(vec![clause]);
        }
        // The participle before the adjective: "is worn by", "is painted by" against "is worn".
        if let Some(clause) = self.attempt(|reader| reader.participle(None)) {
            return Some(vec![clause]);
        }
        if let Some(clauses) = self.attempt(Self::doing) {
            return Some(clauses);
        }
        if let Some(clauses) = self.attempt(Self::appearance) {
            return Some(clauses);
        }
        if let Some(colour) = self.colour() {
            return Some(vec![attribute("colour", &colour)]);
        }
        let (key, value) = self.lexicon.attribute(self.word())?;
        let clause = attribute(key, value);
        self.advance(1);
        Some(vec![clause])
    }

    /// "(is) the last to be tilted".
    fn ordinal_complement(&mut self) -> Option<Vec<Clause>> {
        self.take("the");
        let order = match self.take_any("first|last")? {
            "first" => Order::First,
            _ => Order::Last,
        };
        self.take("one");
        let mut clauses = self.infinitive()?;
        let event = clauses.iter_mut().find(|clause| is_plain_event(clause))?;
        *event = order.of(event.clone());
        Some(clauses)
    }

    /// "to start running", "to be tilted".
    pub(super) fn infinitive(&mut self) -> Option<Vec<Clause>> {
        if !self.take("to") {
            return None;
        }
        self.attempt(Self::being).or_else(|| self.attempt(Self::doing))
    }

    /// "(gets) its tea from the tall pot".
    fn filled(&mut self) -> Option<Clause> {
        self.take_any("its|some|the");
        if !self.lexicon.is_material(self.word()) {
            return None;
        }
        self.advance(1);
        self.take("from");
        Some(Clause::Undergoes { verb: "pour_into".to_owned(), by: self.party()? })
    }

    /// "has tea poured into it", "has a lid".
    fn having(&mut self) -> Option<Vec<Clause>> {
        let poured = self.attempt(|reader| {
            reader.take_any("has|have|having")?;
            reader.party()?;
            reader.participle(None)
        });
        if let Some(clause) = poured {
            self.take("it");
            return Some(vec![clause]);
        }
        if matches!(self.word(), "has" | "have") { self.attempt(Self::appearance) } else { None }
    }

    /// "lifted by the woman", "tilted", "emptied into". Without somebody: by anybody.
    pub(super) fn participle(&mut self, by: Option<Party>) -> Option<Clause> {
        let reading = self.reading(|form| form == Form::Past, true)?;
        let verb = self.lexicon.verb(reading.verb)?;
        let (name, motion) = (verb.name.clone(), verb.motion);
        let by_other = self.attempt(|reader| {
            reader.take_any("by|from")?;
            reader.party()
        });
        let held_in = self.attempt(|reader| {
            reader.take_any("in|into|with")?;
            let party = reader.party()?;
            reader.is_live(&party).then_some(party)
        });
        self.ways();
        if !motion.is_mutual() {
            return Some(Clause::Does { verb: name, to: None });
        }
        let somebody = Party::Category(ANY_PERSON.to_owned());
        let by = by.or(by_other).or(held_in).unwrap_or(somebody);
        Some(Clause::Undergoes { verb: name, by })
    }

    fn is_live(&self, party: &Party) -> bool {
        let noun = match party {
            Party::Name(name) => name.as_str(),
            Party::Category(noun) => noun,
            Party::Such(predicate) => predicate.noun(),
        };
        self.lexicon.noun(noun).is_some_and(|noun| noun.live)
    }

    /// Something that somebody else does to what is described; the object is a gap or a pronoun.
    pub(super) fn done_by(&mut self, by: Party) -> Option<Clause> {
        self.skip(FILLERS);
        let is_negated = self.take_any("never|does not|doesn't").is_some();
        let is_passive = self.attempt(|reader| {
            reader.take_any("is being|are being|is|are|gets")?;
            reader.participle(Some(by.clone()))
        });
        let clause = match is_passive {
            Some(clause) => clause,
            None => {
                self.take_any("is|are");
                self.take_any("starts to|starts");
                let reading = self.reading(|_| true, true)?;
                self.take_any("it|him|her|them");
                self.particles_after(&reading);
                self.ways();
                // "while the cat plays": another one's doing alone says nothing of this one.
                let verb = self.lexicon.verb(reading.verb).filter(|verb| verb.motion.is_mutual())?;
                Clause::Undergoes { verb: verb.name.clone(), by }
            }
        };
        let clause = match clause {
            // What flows is not who pours.
            Clause::Undergoes { verb, by } if self.is_flowing(&by) => {
                Clause::Undergoes { verb, by: Party::Category(ANY_PERSON.to_owned()) }
            }
            other => other,
        };
        Some(if is_negated { Clause::Not(Box::new(clause)) } else { clause })
    }

    fn is_flowing(&self, party: &Party) -> bool {
        match party {
            Party::Name(name) => self.lexicon.is_material(name),
            Party::Category(noun) => self.lexicon.is_material(noun),
            Party::Such(_) => false,
        }
    }

    /// "walks", "stands in front of the gate", "lifts a bucket", "put the jug down".
    fn doing(&mut self) -> Option<Vec<Clause>> {
        self.take_any(ASPECTS);
        self.skip(FILLERS);
        let is_negated = self.take("not");
        if self.word() == "be" || self.word() == "being" {
            return self.attempt(Self::being);
        }
        let with_object = self.attempt(|reader| {
            let reading = reader.reading(|form| form != Form::Past, true)?;
            let to = reader.party()?;
            reader.particles_after(&reading);
            let verb = reader.lexicon.verb(reading.verb)?;
            verb.motion.is_mutual().then(|| Clause::Does { verb: verb.name.clone(), to: Some(to) })
        });
        let clauses = match with_object {
            Some(clause) => {
                self.ways();
                vec![clause]
            }
            None => self.attempt(Self::doing_alone)?,
        };
        if !is_negated {
            return Some(clauses);
        }
        Some(clauses.into_iter().map(|clause| Clause::Not(Box::new(clause))).collect())
    }

    fn doing_alone(&mut self) -> Option<Vec<Clause>> {
        let reading = self.reading(|form| form != Form::Past, false)?;
        let verb = self.lexicon.verb(reading.verb)?;
        let (name, motion) = (verb.name.clone(), verb.motion);
        self.skip(FILLERS);
        if motion == Motion::Still {
            // "stands in front of the gate" says where, not what is done.
            self.take_any("up|down");
            let place = self.attempt(Self::extreme).or_else(|| self.relation());
            if let Some(place) = place {
                return Some(vec![place]);
            }
        }
        self.ways();
        Some(vec![Clause::Does { verb: name, to: None }])
    }

    /// The verb that stands here, with the particles that follow at once; those that follow the object are read later.
    fn reading(&mut self, form: impl Fn(Form) -> bool, is_mutual: bool) -> Option<VerbReading> {
        let readings = self.lexicon.verbs_at(self.word()).iter().filter(|reading| form(reading.form));
        let kind = |reading: &&VerbReading| {
            self.lexicon.verb(reading.verb).is_some_and(|verb| verb.motion.is_mutual())
        };
        let follows = |reading: &&VerbReading| {
            reading.particles.iter().enumerate().all(|(index, particle)| self.ahead(1 + index) == particle)
        };
        let adjacent = readings.clone().filter(follows);
        // More particles say more; then the wanted number of roles; passives of what takes no object are read too.
        let best = adjacent.max_by_key(|reading| {
            (kind(reading) == is_mutual, reading.particles.len(), std::cmp::Reverse(reading.verb))
        });
        let parted = readings.filter(|reading| kind(reading) && is_mutual && !reading.particles.is_empty());
        let parted = parted
            .filter(|reading| self.has_soon(&reading.particles))
            .max_by_key(|reading| reading.particles.len());
        let is_parted = parted
            .is_some_and(|parted| best.is_none_or(|best| best.particles.is_empty() && !follows(&parted)));
        let chosen = if is_parted { parted } else { best }?.clone();
        let length = if is_parted { 1 } else { 1 + chosen.particles.len() };
        let mut chosen = chosen;
        if !is_parted {
            chosen.particles.clear();
        }
        self.advance(length);
        Some(chosen)
    }

    /// Whether particles stand within the next few words: "puts the jug down".
    fn has_soon(&self, particles: &[String]) -> bool {
        (2..7).any(|from| {
            particles.iter().enumerate().all(|(index, particle)| self.ahead(from + index) == particle)
        })
    }

    fn particles_after(&mut self, reading: &VerbReading) {
        let is_next =
            reading.particles.iter().enumerate().all(|(index, particle)| self.ahead(index) == particle);
        if is_next {
            self.advance(reading.particles.len());
        }
    }
}
