//! What an evaluator asks of a scene, and how it combines what it is told.
//!
//! Clauses are defined once, in `eval` and `relations`, over a [`Reading`]. The hard one is [`World`]: things are what
//! the tracks declare, and something holds or doesn't. The soft one is `soft`: things are what they are believed to be,
//! and something holds to a degree.

use std::rc::Rc;

use l4d_data::tracks::TrackedInstance;
use l4d_data::{Event, Name};

use crate::ast::{Clause, Party};
use crate::thresholds::Slack;
use crate::times::Times;
use crate::world::World;

/// How true something is: yes or no, or 0 to 1.
pub(crate) trait Degree: Copy {
    /// It does not hold.
    const FALSE: Self;
    const TRUE: Self;
    /// What nothing is known of.
    const UNKNOWN: Self;

    /// Both hold; the other is not asked for where this one does not hold at all.
    #[must_use]
    fn and(self, other: impl FnOnce() -> Self) -> Self;
    /// One of them holds.
    #[must_use]
    fn or(self, other: Self) -> Self;
    /// It does not hold.
    #[must_use]
    fn not(self) -> Self;
    /// Whether it rather holds than not.
    fn is_likely(self) -> bool;
    /// Whether it may hold at all.
    fn is_possible(self) -> bool;
}

/// How true something is over the clip.
pub(crate) trait Truth: Clone {
    /// How true it is at a moment.
    type Degree: Degree;

    /// The same at all frames.
    fn constant(degree: Self::Degree) -> Self;
    /// As true as `test` says, asked frame by frame.
    fn when(test: impl FnMut(u32) -> Self::Degree) -> Self;
    /// At a frame.
    fn at(&self, frame: u32) -> Self::Degree;
    /// At the start of the clip.
    fn at_start(&self) -> Self::Degree;
    /// At the end of the clip.
    fn at_end(&self) -> Self::Degree;
    /// At some time.
    fn ever(&self) -> Self::Degree;
    /// All the time.
    fn throughout(&self) -> Self::Degree;
    /// When both hold.
    #[must_use]
    fn and(self, other: Self) -> Self;
    /// When one of them holds.
    #[must_use]
    fn or(self, other: Self) -> Self;
    /// When it does not hold.
    #[must_use]
    fn not(self) -> Self;
    /// Whether, given that both happen, this begins at least `lead` frames before the other; `jitter` is how well
    /// beginnings are known, frames.
    fn leads(&self, other: &Self, lead: f64, jitter: f64) -> Self::Degree;
    /// Whether, given that both happen, this ends after the other.
    fn outlasts(&self, other: &Self, jitter: f64) -> Self::Degree;
}

/// Something that happens.
pub(crate) trait Happens {
    /// How true it is over the clip that it happens.
    type Truth;

    fn subject(&self) -> &Name;
    /// What is done.
    fn verb(&self) -> &str;
    fn object(&self) -> Option<&Name>;
    fn times(&self) -> Self::Truth;
}

/// In what two values are compared, which says how far they have to differ to be told apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// Lengths and places.
    Metres,
    /// Places as shares of a length, metres.
    ShareOf(f64),
    /// Sizes to this power: 1 for a height, 3 for a volume.
    Size(f64),
    Degrees,
}

/// A thing with how sure it is that it is one of those meant.
pub(crate) type Member<'a, D> = (&'a TrackedInstance, D);

/// A scene as an evaluator asks for it.
pub(crate) trait Reading<'a> {
    /// How true something is at a moment.
    type Degree: Degree;
    /// How true something is over the clip.
    type Truth: Truth<Degree = Self::Degree>;
    type Event: Happens<Truth = Self::Truth>;

    /// Where everything is.
    fn world(&self) -> &World<'a>;
    /// How strictly thresholds are meant.
    fn slack(&self) -> Slack;
    /// Everything that is said to happen.
    fn events(&self) -> &[Self::Event];
    /// Whether a thing is called by this noun.
    fn is_a(&self, thing: &TrackedInstance, noun: &str) -> Self::Degree;
    /// Whether a property of a thing has this value.
    fn has(&self, thing: &TrackedInstance, key: &str, value: &str) -> Self::Degree;
    /// What goes by this name.
    fn named(&self, name: &Name) -> Vec<Member<'a, Self::Degree>>;
    /// Whether a thing is compared with another of that noun.
    fn is_rival(&self, thing: &TrackedInstance, other: &TrackedInstance, noun: &str) -> Self::Degree;
    /// Whether a value is at least a limit.
    fn at_least(&self, value: f64, limit: f64, unit: Unit) -> Self::Degree;
    /// How well frames are known at which something begins or ends.
    fn jitter_frames(&self) -> f64;
    /// The nearest of several, each of which may not be one of those meant.
    fn nearest(&self, distances: impl Iterator<Item = (f64, Self::Degree)>) -> Option<f64>;
    /// How much a clause of a description counts.
    fn weigh(&self, clause: &Clause, degree: Self::Degree) -> Self::Degree;
    /// Those whom a party means, of all with how well they fit; a reading may keep the result.
    fn meant(
        &self,
        party: &Party,
        all: impl FnOnce() -> Vec<Member<'a, Self::Degree>>,
    ) -> Rc<Vec<Member<'a, Self::Degree>>>;
}

impl Degree for bool {
    const FALSE: Self = false;
    const TRUE: Self = true;
    const UNKNOWN: Self = false;

    fn and(self, other: impl FnOnce() -> Self) -> Self {
        self && other()
    }

    fn or(self, other: Self) -> Self {
        self || other
    }

    fn not(self) -> Self {
        !self
    }

    fn is_likely(self) -> bool {
        self
    }

    fn is_possible(self) -> bool {
        self
    }
}

impl Truth for Times {
    type Degree = bool;

    fn constant(degree: bool) -> Self {
        Self::constant(degree)
    }

    fn when(test: impl FnMut(u32) -> bool) -> Self {
        Self::when(test)
    }

    fn at(&self, frame: u32) -> bool {
        Self::at(*self, frame)
    }

    fn at_start(&self) -> bool {
        Self::at(*self, 0)
    }

    fn at_end(&self) -> bool {
        Self::at(*self, l4d_data::timeline::LAST_FRAME)
    }

    fn ever(&self) -> bool {
        self.any()
    }

    fn throughout(&self) -> bool {
        self.all()
    }

    fn and(self, other: Self) -> Self {
        self & other
    }

    fn or(self, other: Self) -> Self {
        self | other
    }

    fn not(self) -> Self {
        self.complement()
    }

    fn leads(&self, other: &Self, lead: f64, _: f64) -> bool {
        let starts = self.first().zip(other.first());
        starts.is_some_and(|(own, other)| f64::from(other) >= f64::from(own) + lead)
    }

    fn outlasts(&self, other: &Self, _: f64) -> bool {
        self.last().zip(other.last()).is_some_and(|(own, other)| own > other)
    }
}

impl Happens for Event {
    type Truth = Times;

    fn subject(&self) -> &Name {
        &self.subject
    }

    fn verb(&self) -> &str {
        &self.verb
    }

    fn object(&self) -> Option<&Name> {
        self.object.as_ref()
    }

    fn times(&self) -> Times {
        Times::of(self.frames)
    }
}

impl<'a> Reading<'a> for World<'a> {
    type Degree = bool;
    type Truth = Times;
    type Event = Event;

    fn world(&self) -> &World<'a> {
        self
    }

    fn slack(&self) -> Slack {
        self.slack()
    }

    fn events(&self) -> &[Event] {
        &self.tracks().events
    }

    fn is_a(&self, thing: &TrackedInstance, noun: &str) -> bool {
        thing.category == noun
    }

    fn has(&self, thing: &TrackedInstance, key: &str, value: &str) -> bool {
        thing.attributes.get(key).is_some_and(|own| own == value)
    }

    fn named(&self, name: &Name) -> Vec<Member<'a, bool>> {
        self.instance(name).map(|instance| (instance, true)).into_iter().collect()
    }

    fn is_rival(&self, thing: &TrackedInstance, other: &TrackedInstance, _: &str) -> bool {
        other.category == thing.category && other.name != thing.name
    }

    fn at_least(&self, value: f64, limit: f64, _: Unit) -> bool {
        value >= limit
    }

    fn jitter_frames(&self) -> f64 {
        0.0
    }

    fn nearest(&self, distances: impl Iterator<Item = (f64, bool)>) -> Option<f64> {
        distances.map(|(distance, _)| distance).min_by(f64::total_cmp)
    }

    fn weigh(&self, _: &Clause, degree: bool) -> bool {
        degree
    }

    fn meant(&self, _: &Party, all: impl FnOnce() -> Vec<Member<'a, bool>>) -> Rc<Vec<Member<'a, bool>>> {
        Rc::new(all())
    }
}

/// When at least one of them holds.
pub(crate) fn any_of<T: Truth>(truths: impl IntoIterator<Item = T>) -> T {
    truths.into_iter().fold(T::constant(T::Degree::FALSE), T::or)
}

/// Whether at least one of them holds.
pub(crate) fn is_any<D: Degree>(degrees: impl IntoIterator<Item = D>) -> D {
    degrees.into_iter().fold(D::FALSE, D::or)
}
