//! Asking: cache first, then budget, then the server with retries.

use std::collections::BTreeSet;
use std::path::Path;

use crate::budget::{Budget, Ledger, Plan, Spent, estimate};
use crate::config::Endpoint;
use crate::error::EndpointError;
use crate::exchange::{Call, Exchanges, Link, Response};
use crate::http::Http;
use crate::openai;
use crate::reply::{Origin, Reply};
use crate::request::Request;
use crate::retry::with_retries;
use crate::secret::Environment;

/// How the cache takes part.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CacheUse {
    /// Answers in it are taken, new ones are kept.
    #[default]
    Take,
    /// New answers replace kept ones.
    Refresh,
}

/// Where answers come from, and where they go.
#[derive(Debug)]
enum Source {
    Server(Http),
    /// What answers of it are kept in this folder.
    Cached(Http, Exchanges, CacheUse),
    /// Everything that it says is kept in this folder.
    Recorded(Http, Exchanges),
    /// This folder, and no network at all.
    Recording(Exchanges),
}

/// A way to ask one model. Threads share it by reference.
#[derive(Debug)]
pub struct Client {
    endpoint: Endpoint,
    source: Source,
    ledger: Ledger,
}

impl Client {
    /// Opens a client; keys are read from the environment now, except for a replay, which needs none.
    ///
    /// # Errors
    /// If the endpoint is unsound, a key is missing, or the folder of a recording cannot be written.
    pub fn open(endpoint: Endpoint, link: &Link) -> Result<Self, EndpointError> {
        Self::open_in(endpoint, link, &|variable| std::env::var_os(variable))
    }

    /// The same with keys from elsewhere than the environment of this process.
    ///
    /// # Errors
    /// As [`Client::open`].
    pub fn open_in(
        endpoint: Endpoint,
        link: &Link,
        environment: Environment<'_>,
    ) -> Result<Self, EndpointError> {
        endpoint.check("endpoint")?;
        let source = match link {
            Link::Live => Source::Server(Http::open(&endpoint, environment)?),
            Link::Record(folder) => {
                let http = Http::open(&endpoint, environment)?;
                endpoint.record(folder)?;
                Source::Recorded(http, Exchanges::new(folder))
            }
            Link::Replay(folder) => Source::Recording(Exchanges::new(folder)),
        };
        Ok(Self { ledger: Ledger::new(Budget::default(), endpoint.prices)?, source, endpoint })
    }

    /// Keeps answers in a folder, which several endpoints may share. Recording and replaying do without: a
    /// recording must be whole.
    #[must_use]
    pub fn with_cache(mut self, folder: &Path, cache: CacheUse) -> Self {
        if let Source::Server(http) = self.source {
            self.source = Source::Cached(http, Exchanges::new(folder.join(self.endpoint.id())), cache);
        }
        self
    }

    /// Limits what is spent.
    ///
    /// # Errors
    /// If cost is limited and the endpoint has no prices.
    pub fn with_budget(mut self, budget: Budget) -> Result<Self, EndpointError> {
        self.ledger = Ledger::new(budget, self.endpoint.prices)?;
        Ok(self)
    }

    /// The endpoint that it asks.
    pub fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }

    /// Asks and waits. A reply may be cut off or refused: [`Reply::whole`] and [`Reply::json`] tell.
    ///
    /// # Errors
    /// If the budget does not cover the question, a recording lacks it, or the server gives no answer.
    pub fn ask(&self, request: &Request) -> Result<Reply, EndpointError> {
        let call = openai::chat(&self.endpoint, request);
        let kept = match &self.source {
            Source::Recording(exchanges) => {
                let reply = openai::read_chat(&call, &exchanges.recorded(&call)?)?;
                Some(Reply { origin: Origin::Recording, ..reply })
            }
            _ => self.kept(&call),
        };
        let mut reply = match kept {
            Some(reply) => {
                self.ledger.book_kept();
                reply
            }
            None => self.fetch(&call, request)?,
        };
        reply.notes.extend(lost_prompt(request, reply.usage.prompt_tokens));
        Ok(reply)
    }

    /// Forgets a kept answer, so that the question is asked anew.
    ///
    /// # Errors
    /// If the file cannot be deleted.
    pub fn forget(&self, request: &Request) -> Result<(), EndpointError> {
        match &self.source {
            Source::Cached(_, exchanges, _) => Ok(exchanges.remove(&openai::chat(&self.endpoint, request))?),
            _ => Ok(()),
        }
    }

    /// What asking all of this would mean; nothing is sent.
    pub fn plan<'a>(&self, requests: impl IntoIterator<Item = &'a Request>) -> Plan {
        let mut plan = Plan::default();
        let mut planned = BTreeSet::new();
        for request in requests {
            let call = openai::chat(&self.endpoint, request);
            plan.questions += 1;
            let is_repeated =
                matches!(self.source, Source::Cached(..)) && !planned.insert(call.digest.clone());
            if is_repeated || self.kept(&call).is_some() {
                plan.kept += 1;
                continue;
            }
            plan.images += request.images().count() as u64;
            plan.bytes += call.body.as_ref().map_or(0, Vec::len) as u64;
            plan.tokens = plan.tokens.plus(estimate(request));
        }
        plan.cost = self.ledger.cost(plan.tokens);
        plan
    }

    /// What was spent so far.
    pub fn spent(&self) -> Spent {
        self.ledger.spent()
    }

    /// Asks the server within budget.
    fn fetch(&self, call: &Call, request: &Request) -> Result<Reply, EndpointError> {
        let needed = estimate(request);
        self.ledger.set_aside(needed)?;
        let result = self.send(call, |response| {
            let reply = openai::read_chat(call, response)?;
            // Only a whole answer is kept: another may come out better next time.
            if let Source::Cached(_, exchanges, _) = &self.source
                && reply.whole().is_ok()
                && let Err(error) = exchanges.write(call, response)
            {
                // A full disk costs the cache, not the answer.
                tracing::warn!("an answer could not be kept: {error}");
            }
            Ok(reply)
        });
        match &result {
            Ok(reply) => self.ledger.book_answer(needed, &reply.usage, &reply.text),
            Err(error) => self.ledger.book_failure(needed, error),
        }
        result
    }

    /// Sends until the response can be read, or it fails for good.
    fn send<T>(
        &self,
        call: &Call,
        read: impl Fn(&Response) -> Result<T, EndpointError>,
    ) -> Result<T, EndpointError> {
        let (http, recording) = match &self.source {
            Source::Recording(exchanges) => return read(&exchanges.recorded(call)?),
            Source::Recorded(http, exchanges) => (http, Some(exchanges)),
            Source::Server(http) | Source::Cached(http, ..) => (http, None),
        };
        // The digest as a seed: questions that failed together do not come back together.
        let seed = u64::from_str_radix(&call.digest[..16], 16).unwrap_or(0);
        let Endpoint { retry, timeouts, .. } = &self.endpoint;
        with_retries(retry, timeouts, seed, std::thread::sleep, |timeout| {
            let response = http.send(call, timeout)?;
            recording.map_or(Ok(()), |exchanges| exchanges.record(call, &response))?;
            read(&response)
        })
    }

    /// The answer in the cache. What cannot be read there is asked again.
    fn kept(&self, call: &Call) -> Option<Reply> {
        let Source::Cached(_, exchanges, CacheUse::Take) = &self.source else { return None };
        let response = match exchanges.read(call) {
            Ok(response) => response?,
            Err(error) => {
                tracing::warn!("{error}; asking again");
                return None;
            }
        };
        let reply = openai::read_chat(call, &response).ok()?;
        Some(Reply { origin: Origin::Cache, ..reply })
    }
}

/// Servers that cut a question to their context lose its first pictures without an error; their count tells.
fn lost_prompt(request: &Request, counted: Option<u64>) -> Option<String> {
    /// No model spends less on a picture.
    const FEWEST_PER_IMAGE: u64 = 16;
    let counted = counted?;
    let least = request.images().count() as u64 * FEWEST_PER_IMAGE;
    (counted < least).then(|| {
        format!(
            "the server counted {counted} tokens in the question, too few for its pictures: some may be lost"
        )
    })
}
