//! What questions may cost: estimates before, counts after, and a limit that no question crosses.

use std::ops::AddAssign;
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};

use crate::error::EndpointError;
use crate::reply::Usage;
use crate::request::{Part, Request};

/// What a million tokens cost, in any one currency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prices {
    pub prompt_per_million: f64,
    pub completion_per_million: f64,
}

impl Prices {
    pub(crate) fn is_sound(&self) -> bool {
        let prices = [self.prompt_per_million, self.completion_per_million];
        prices.iter().all(|price| price.is_finite() && *price >= 0.0)
    }

    fn cost(&self, tokens: Tokens) -> f64 {
        let Self { prompt_per_million, completion_per_million } = self;
        (tokens.prompt as f64 * prompt_per_million + tokens.completion as f64 * completion_per_million) / 1e6
    }
}

/// Tokens of questions and answers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tokens {
    pub prompt: u64,
    /// Of answers, thinking included.
    pub completion: u64,
}

impl Tokens {
    /// Of questions and answers together.
    pub fn total(self) -> u64 {
        self.prompt.saturating_add(self.completion)
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        self.with(other, u64::saturating_add)
    }

    fn minus(self, other: Self) -> Self {
        self.with(other, u64::saturating_sub)
    }

    fn with(self, other: Self, of: fn(u64, u64) -> u64) -> Self {
        Self { prompt: of(self.prompt, other.prompt), completion: of(self.completion, other.completion) }
    }
}

/// What a question needs at most, judged without asking: text at 3 bytes per token, pictures by their pixels, an
/// answer of full length. Errs high for most models.
pub(crate) fn estimate(request: &Request) -> Tokens {
    const BYTES_PER_TOKEN: u64 = 3;
    const PIXELS_PER_TOKEN: u64 = 28 * 28;
    const PER_PART: u64 = 8;
    let of_part = |part: &Part| match part {
        Part::Text(text) => PER_PART + (text.len() as u64).div_ceil(BYTES_PER_TOKEN),
        Part::Image(image) => {
            let (width, height) = image.size();
            PER_PART + (u64::from(width) * u64::from(height)).div_ceil(PIXELS_PER_TOKEN)
        }
    };
    let parts: u64 = request.messages.iter().flat_map(|message| &message.parts).map(of_part).sum();
    let schema = request.schema.as_ref().map_or(0, |schema| schema.value.to_string().len() as u64);
    Tokens { prompt: parts + schema.div_ceil(BYTES_PER_TOKEN), completion: u64::from(request.max_tokens) }
}

/// Limits of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Budget {
    /// Tokens of all questions and answers together.
    pub max_tokens_total: Option<u64>,
    /// Cost of all of them; needs prices.
    pub max_cost: Option<f64>,
}

/// What was spent so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Spent {
    /// Answers that the server gave.
    pub answers: u64,
    /// Answers that came from the cache or a recording.
    pub kept: u64,
    /// Tokens that the server counted, or estimates where it did not say.
    pub tokens: Tokens,
    /// Their cost, where prices are known.
    pub cost: Option<f64>,
}

/// What a run would do and cost at most: the answer to `--dry-run`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Plan {
    pub questions: u64,
    /// Of them, answered by the cache or a recording.
    pub kept: u64,
    /// Pictures that would be sent.
    pub images: u64,
    /// Bytes that would be sent.
    pub bytes: u64,
    /// Estimated tokens of the questions, and the most that the answers may have.
    pub tokens: Tokens,
    /// Their cost, where prices are known.
    pub cost: Option<f64>,
}

impl AddAssign for Plan {
    /// Plans for one endpoint: prices are known of both or of neither, unless one of them is empty.
    fn add_assign(&mut self, other: Self) {
        self.questions += other.questions;
        self.kept += other.kept;
        self.images += other.images;
        self.bytes += other.bytes;
        self.tokens = self.tokens.plus(other.tokens);
        self.cost = match (self.cost, other.cost) {
            (None, None) => None,
            (before, more) => Some(before.unwrap_or(0.0) + more.unwrap_or(0.0)),
        };
    }
}

/// Keeps a run within its budget, whatever the number of threads: what a question may need is set aside before it
/// is asked, and what it did need is booked after.
#[derive(Debug)]
pub(crate) struct Ledger {
    budget: Budget,
    prices: Option<Prices>,
    books: Mutex<Books>,
}

#[derive(Debug, Default)]
struct Books {
    spent: Spent,
    set_aside: Tokens,
}

impl Ledger {
    pub(crate) fn new(budget: Budget, prices: Option<Prices>) -> Result<Self, EndpointError> {
        let refuse = |message, hint| Err(EndpointError::not_asked("max_cost", message, hint));
        match (budget.max_cost, prices) {
            (Some(cost), _) if !cost.is_finite() || cost < 0.0 => {
                refuse("must be a finite number that is not negative", "give the most that a run may cost")
            }
            (Some(_), None) => refuse(
                "cannot be kept without prices",
                "write [prices] with prompt_per_million and completion_per_million into the endpoint file",
            ),
            _ => Ok(Self { budget, prices, books: Mutex::default() }),
        }
    }

    /// Sets aside what a question may need.
    pub(crate) fn set_aside(&self, needed: Tokens) -> Result<(), EndpointError> {
        let mut books = self.lock();
        let bound = books.spent.tokens.plus(books.set_aside);
        let total = bound.plus(needed);
        let short = |what: &str, limit: String, bound: String, needed: String| {
            Err(EndpointError::not_asked(
                "the budget does not cover the question",
                format!("of {limit} {what}, {bound} are spent or set aside, and it may need {needed}"),
                "raise --max-tokens-total or --max-cost; answers so far are in the cache",
            ))
        };
        if let Some(limit) = self.budget.max_tokens_total.filter(|limit| total.total() > *limit) {
            return short("tokens", limit.to_string(), bound.total().to_string(), needed.total().to_string());
        }
        if let (Some(limit), Some(prices)) = (self.budget.max_cost, self.prices)
            && prices.cost(total) > limit
        {
            let money = |tokens| format!("{:.4}", prices.cost(tokens));
            return short("(cost)", limit.to_string(), money(bound), money(needed));
        }
        books.set_aside = books.set_aside.plus(needed);
        Ok(())
    }

    /// Books what an answer cost; where the server does not say, the estimate counts.
    pub(crate) fn book_answer(&self, needed: Tokens, usage: &Usage, text: &str) {
        let tokens = Tokens {
            prompt: usage.prompt_tokens.unwrap_or(needed.prompt),
            completion: usage.completion_tokens.unwrap_or((text.len() as u64).div_ceil(3)),
        };
        let mut books = self.lock();
        books.set_aside = books.set_aside.minus(needed);
        books.spent.answers += 1;
        books.spent.tokens = books.spent.tokens.plus(tokens);
    }

    /// Books a failure. A server that was cut off in the middle may have worked, and may bill it.
    pub(crate) fn book_failure(&self, needed: Tokens, error: &EndpointError) {
        let mut books = self.lock();
        books.set_aside = books.set_aside.minus(needed);
        if matches!(error, EndpointError::Server(failure) if failure.may_have_cost) {
            books.spent.tokens = books.spent.tokens.plus(needed);
        }
    }

    /// Books an answer that cost nothing.
    pub(crate) fn book_kept(&self) {
        self.lock().spent.kept += 1;
    }

    pub(crate) fn spent(&self) -> Spent {
        let mut spent = self.lock().spent;
        spent.cost = self.prices.map(|prices| prices.cost(spent.tokens));
        spent
    }

    pub(crate) fn cost(&self, tokens: Tokens) -> Option<f64> {
        self.prices.map(|prices| prices.cost(tokens))
    }

    fn lock(&self) -> MutexGuard<'_, Books> {
        self.books.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Failure;

    const NEEDED: Tokens = Tokens { prompt: 300, completion: 100 };

    fn ledger(max_tokens_total: Option<u64>) -> Ledger {
        Ledger::new(Budget { max_tokens_total, max_cost: None }, None).unwrap()
    }

    #[test]
    fn what_is_set_aside_counts_until_it_is_booked() {
        let ledger = ledger(Some(1000));
        ledger.set_aside(NEEDED).unwrap();
        ledger.set_aside(NEEDED).unwrap();
        let error = ledger.set_aside(NEEDED).unwrap_err();
        assert!(error.to_string().contains("of 1000 tokens, 800 are spent or set aside"), "{error}");
        let usage = Usage { prompt_tokens: Some(250), completion_tokens: Some(50) };
        ledger.book_answer(NEEDED, &usage, "");
        ledger.set_aside(Tokens { prompt: 300, completion: 0 }).unwrap();
        assert_eq!(ledger.spent().tokens, Tokens { prompt: 250, completion: 50 });
    }

    #[test]
    fn answers_without_counts_are_booked_by_estimate_and_cut_ones_in_full() {
        let ledger = ledger(None);
        ledger.book_answer(NEEDED, &Usage::default(), "seven b");
        assert_eq!(ledger.spent().tokens, Tokens { prompt: 300, completion: 3 });
        let timeout = Failure { may_have_cost: true, ..Failure::lasting("", "", "") };
        ledger.book_failure(NEEDED, &timeout.into());
        assert_eq!(ledger.spent().tokens, Tokens { prompt: 600, completion: 103 });
        ledger.book_failure(NEEDED, &Failure::lasting("", "", "").into());
        assert_eq!(ledger.spent().tokens.total(), 703);
    }
}
