//! Asking: cache first, then budget, then the server with retries.

use std::collections::BTreeSet;
use std::path::Path;

use crate::budget::{Budget, Ledger, Plan, Spent, estimate};
use crate::config::Endpoint;
use crate::error::EndpointError;
use crate::exchange::{Call, Exchanges, Response};
use crate::openai;
use crate::reply::{Origin, Reply};
use crate::request::Request;
use crate::retry::with_retries;
use crate::secret::Environment;
use crate::transport::{Link, Transport};

/// How the cache takes part.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CacheUse {
    /// Answers in it are taken, new ones are kept.
    #[default]
    Take,
    /// New answers replace kept ones.
    Refresh,
}

/// A way to ask one model. Threads share it by reference.
#[derive(Debug)]
pub struct Client {
    endpoint: Endpoint,
    transport: Transport,
    cache: Option<(Exchanges, CacheUse)>,
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
        Ok(Self {
            transport: Transport::open(&endpoint, link, environment)?,
            ledger: Ledger::new(Budget::default(), endpoint.prices)?,
            cache: None,
            endpoint,
        })
    }

    /// Keeps answers in a folder, which several endpoints may share. Recording and replaying do without: a
    /// recording must be whole.
    #[must_use]
    pub fn with_cache(mut self, folder: &Path, cache: CacheUse) -> Self {
        if matches!(self.transport, Transport::Live(_)) {
            self.cache = Some((Exchanges::new(folder.join(self.endpoint.id())), cache));
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
        let mut reply = match self.kept(&call) {
            Some(reply) => {
                self.ledger.book_kept();
                reply
            }
            None if matches!(self.transport, Transport::Replay(_)) => {
                let (reply, _) = self.send(&call, |response| openai::read_chat(&call, response))?;
                self.ledger.book_kept();
                Reply { origin: Origin::Recording, ..reply }
            }
            None => self.fetch(&call, request)?,
        };
        reply.notes.extend(lost_prompt(request, reply.usage.prompt_tokens));
        Ok(reply)
    }

    /// Names of the models that the server lists.
    ///
    /// # Errors
    /// If the server gives no list.
    pub fn models(&self) -> Result<Vec<String>, EndpointError> {
        let call = openai::models(&self.endpoint);
        self.send(&call, |response| openai::read_models(&call, response)).map(|(models, _)| models)
    }

    /// Forgets a kept answer, so that the question is asked anew.
    ///
    /// # Errors
    /// If the file cannot be deleted.
    pub fn forget(&self, request: &Request) -> Result<(), EndpointError> {
        match &self.cache {
            Some((exchanges, _)) => Ok(exchanges.remove(&openai::chat(&self.endpoint, request))?),
            None => Ok(()),
        }
    }

    /// What asking all of this would mean; nothing is sent.
    pub fn plan<'a>(&self, requests: impl IntoIterator<Item = &'a Request>) -> Plan {
        let mut plan = Plan::default();
        let mut planned = BTreeSet::new();
        for request in requests {
            let call = openai::chat(&self.endpoint, request);
            plan.questions += 1;
            let is_repeated = self.cache.is_some() && !planned.insert(call.digest.clone());
            if is_repeated || self.kept(&call).is_some() {
                plan.kept += 1;
                continue;
            }
            plan.images += request.images().count() as u64;
            plan.bytes += call.body.as_ref().map_or(0, Vec::len) as u64;
            plan.tokens = plan.tokens.plus(estimate(&self.endpoint, request));
        }
        plan.cost = self.ledger.cost(plan.tokens);
        plan
    }

    /// What was spent so far.
    pub fn spent(&self) -> Spent {
        self.ledger.spent()
    }

    /// Asks the server within budget, and keeps its answer if it is whole: another may come out better next time.
    /// A full disk costs the cache, not the answer.
    fn fetch(&self, call: &Call, request: &Request) -> Result<Reply, EndpointError> {
        let needed = estimate(&self.endpoint, request);
        self.ledger.set_aside(needed)?;
        let result = self.send(call, |response| openai::read_chat(call, response));
        let (reply, response) = match result {
            Ok(answer) => answer,
            Err(error) => {
                self.ledger.book_failure(needed, &error);
                return Err(error);
            }
        };
        self.ledger.book_answer(needed, &reply.usage, &reply.text);
        if let Some((exchanges, _)) = &self.cache
            && reply.whole().is_ok()
            && let Err(error) = exchanges.write(call, &response)
        {
            tracing::warn!("an answer could not be kept: {error}");
        }
        Ok(reply)
    }

    /// Sends until the response can be read, or it fails for good.
    fn send<T>(
        &self,
        call: &Call,
        read: impl Fn(&Response) -> Result<T, EndpointError>,
    ) -> Result<(T, Response), EndpointError> {
        let mut retry = self.endpoint.retry;
        if matches!(self.transport, Transport::Replay(_)) {
            retry.tries = 1;
        }
        // The digest as a seed: questions that failed together do not come back together.
        let seed = u64::from_str_radix(&call.digest[..16], 16).unwrap_or(0);
        with_retries(&retry, &self.endpoint.timeouts, seed, std::thread::sleep, |patience| {
            let response = self.transport.send(call, patience)?;
            Ok((read(&response)?, response))
        })
    }

    /// The answer in the cache. What cannot be read there is asked again.
    fn kept(&self, call: &Call) -> Option<Reply> {
        let (exchanges, CacheUse::Take) = self.cache.as_ref()? else { return None };
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
