//! Guesses: what a stretch of words may mean, and what it costs to believe so.

/// What words up to `end` may mean.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Guess<T> {
    pub(super) value: T,
    pub(super) end: usize,
    /// How far-fetched it is.
    pub(super) cost: u32,
    /// Words that were passed over, a bit each.
    pub(super) skipped: u128,
}

/// All guesses of a place.
pub(super) type Guesses<T> = Vec<Guess<T>>;

/// Guesses that are kept for each end.
const KEPT: usize = 6;

impl<T> Guess<T> {
    pub(super) fn new(value: T, end: usize, cost: u32) -> Self {
        Self { value, end, cost, skipped: 0 }
    }

    pub(super) fn map<U>(self, change: impl FnOnce(T) -> U) -> Guess<U> {
        Guess { value: change(self.value), end: self.end, cost: self.cost, skipped: self.skipped }
    }

    /// The same with a value that may not be made of it.
    pub(super) fn maybe<U>(self, change: impl FnOnce(T) -> Option<U>) -> Option<Guess<U>> {
        let value = change(self.value)?;
        Some(Guess { value, end: self.end, cost: self.cost, skipped: self.skipped })
    }

    /// The same, followed by another.
    pub(super) fn then<U, V>(&self, next: Guess<U>, join: impl FnOnce(&T, U) -> V) -> Guess<V> {
        Guess {
            value: join(&self.value, next.value),
            end: next.end,
            cost: self.cost + next.cost,
            skipped: self.skipped | next.skipped,
        }
    }

    pub(super) fn plus(mut self, cost: u32) -> Self {
        self.cost += cost;
        self
    }

    pub(super) fn ending(mut self, end: usize) -> Self {
        self.end = end;
        self
    }
}

/// The cheapest few of each end, without repeats.
pub(super) fn cheapest<T: PartialEq>(mut guesses: Guesses<T>) -> Guesses<T> {
    guesses.sort_by_key(|guess| guess.cost);
    let mut kept: Guesses<T> = Vec::new();
    for guess in guesses {
        let alike = kept.iter().filter(|other| other.end == guess.end).count();
        if alike < KEPT && !kept.iter().any(|other| other.end == guess.end && other.value == guess.value) {
            kept.push(guess);
        }
    }
    kept
}
