//! Asking: cache first, then budget, then the server with patience.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use l4d_data::json;

use crate::breaker::Breaker;
use crate::budget::{Budget, Ledger, Plan, Spent, Tokens, estimate};
use crate::call::{Call, Response};
use crate::config::Endpoint;
use crate::dialect::{self, Said};
use crate::error::EndpointError;
use crate::extract::without_thinking;
use crate::http::Http;
use crate::learned::Learned;
use crate::replay::{Recorder, Replay};
use crate::reply::{Finish, Origin, Reply};
use crate::request::Request;
use crate::retry::patiently;
use crate::secret::Environment;
use crate::store::Exchanges;
use crate::transport::Transport;

const LEARNED_FILE: &str = "learned.json";

/// What stands at the other end: `live`, `record:<folder>` or `replay:<folder>`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Link {
    /// The server.
    #[default]
    Live,
    /// The server, and everything that it says is kept in a folder.
    Record(PathBuf),
    /// Such a folder, and no network at all.
    Replay(PathBuf),
}

impl FromStr for Link {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "live" => Ok(Self::Live),
            Some(("record", folder)) if !folder.is_empty() => Ok(Self::Record(folder.into())),
            Some(("replay", folder)) if !folder.is_empty() => Ok(Self::Replay(folder.into())),
            _ => Err("write `live`, `record:<folder>` or `replay:<folder>`".to_owned()),
        }
    }
}

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
    transport: Box<dyn Transport>,
    origin: Origin,
    cache: Option<(Exchanges, CacheUse)>,
    ledger: Ledger,
    breaker: Breaker,
    learned: Mutex<Learned>,
    learned_file: Option<PathBuf>,
}

impl Client {
    /// Opens a client; keys are read from the environment now, unless a recording stands in for the server.
    pub fn open(endpoint: Endpoint, link: &Link) -> Result<Self, EndpointError> {
        Self::open_in(endpoint, link, &|variable| std::env::var_os(variable))
    }

    /// The same with keys from elsewhere than the environment of this process.
    pub fn open_in(
        endpoint: Endpoint,
        link: &Link,
        environment: Environment<'_>,
    ) -> Result<Self, EndpointError> {
        endpoint.check("endpoint")?;
        match link {
            Link::Live => {
                let http = Http::open(&endpoint, environment)?;
                Self::over(endpoint, Box::new(http))
            }
            Link::Record(folder) => {
                let recorder = Recorder::new(Http::open(&endpoint, environment)?, folder, &endpoint)?;
                Self::over(endpoint, Box::new(recorder))?.remembering(folder)
            }
            Link::Replay(folder) => {
                let mut client = Self::over(endpoint, Box::new(Replay::new(folder)))?;
                client.origin = Origin::Recording;
                // What is recorded does not change by waiting.
                client.endpoint.retry.tries = 1;
                client.endpoint.retry.failures_in_a_row = u32::MAX;
                client.remembering(folder)
            }
        }
    }

    /// A client over a transport of the caller's own.
    pub fn over(endpoint: Endpoint, transport: Box<dyn Transport>) -> Result<Self, EndpointError> {
        endpoint.check("endpoint")?;
        Ok(Self {
            ledger: Ledger::new(Budget::default(), endpoint.prices)?,
            breaker: Breaker::new(endpoint.base_url.to_string(), &endpoint.retry),
            origin: Origin::Server,
            cache: None,
            learned: Mutex::default(),
            learned_file: None,
            transport,
            endpoint,
        })
    }

    /// Keeps answers in a folder, which several endpoints may share. Recording and replaying do without: a
    /// recording must be whole.
    pub fn with_cache(mut self, folder: &Path, cache: CacheUse) -> Result<Self, EndpointError> {
        if self.origin == Origin::Recording || self.learned_file.is_some() {
            return Ok(self);
        }
        let folder = folder.join(self.endpoint.id());
        self.cache = Some((Exchanges::new(&folder), cache));
        self.remembering(&folder)
    }

    /// Limits what is spent. A limit of cost without prices is an error.
    pub fn with_budget(mut self, budget: Budget) -> Result<Self, EndpointError> {
        self.ledger = Ledger::new(budget, self.endpoint.prices)?;
        Ok(self)
    }

    /// Whom it asks.
    pub fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }

    /// Asks and waits. A reply may be cut off or refused: [`Reply::whole`] and [`Reply::json`] tell.
    pub fn ask(&self, request: &Request) -> Result<Reply, EndpointError> {
        let mut learned = self.learned();
        loop {
            let call = dialect::chat(&self.endpoint, request, &learned);
            self.check_size(request, &call)?;
            if let Some(reply) = self.kept(&call, request, &learned) {
                self.ledger.book_kept();
                return Ok(reply);
            }
            let (response, said) = self.fetch(&call, request)?;
            match said {
                Ok(said) => {
                    self.remember(&learned);
                    let reply = self.reply(said, &call, request, &learned, self.origin);
                    self.keep(&call, &response, &reply);
                    return Ok(reply);
                }
                Err(error) => match learned.with(&response, &call.identity["body"]) {
                    Some(lesson) => {
                        tracing::warn!("{error}; asking again without the field");
                        learned = lesson;
                    }
                    None => return Err(error),
                },
            }
        }
    }

    /// Names of the models that the server lists.
    pub fn models(&self) -> Result<Vec<String>, EndpointError> {
        let call = dialect::models(&self.endpoint);
        self.breaker.admit()?;
        let result = patiently(&self.endpoint.retry, &self.endpoint.timeouts, |patience| {
            let response = self.transport.send(&call, patience)?;
            dialect::read_models(&self.endpoint, &call, &response)
        });
        self.breaker.note(&result);
        result
    }

    /// Forgets a kept answer, so that the question is asked anew.
    pub fn forget(&self, request: &Request) -> Result<(), EndpointError> {
        match &self.cache {
            Some((exchanges, _)) => {
                Ok(exchanges.remove(&dialect::chat(&self.endpoint, request, &self.learned()))?)
            }
            None => Ok(()),
        }
    }

    /// What asking all of this would mean; nothing is sent.
    pub fn plan<'a>(&self, requests: impl IntoIterator<Item = &'a Request>) -> Result<Plan, EndpointError> {
        let learned = self.learned();
        let mut plan = Plan::default();
        let mut planned = BTreeSet::new();
        for request in requests {
            let call = dialect::chat(&self.endpoint, request, &learned);
            self.check_size(request, &call)?;
            plan.questions += 1;
            let is_repeated = self.cache.is_some() && !planned.insert(call.digest.clone());
            if is_repeated || self.kept(&call, request, &learned).is_some() {
                plan.kept += 1;
                continue;
            }
            let tokens = estimate(&self.endpoint, request);
            plan.images += request.images().count() as u64;
            plan.bytes += call.body.as_ref().map_or(0, Vec::len) as u64;
            plan.tokens = Tokens {
                prompt: plan.tokens.prompt + tokens.prompt,
                completion: plan.tokens.completion + tokens.completion,
            };
        }
        plan.cost = self.ledger.cost(plan.tokens);
        Ok(plan)
    }

    /// What was spent so far.
    pub fn spent(&self) -> Spent {
        self.ledger.spent()
    }

    /// Asks the server, within budget and patience: the response, and what was said or why nothing.
    fn fetch(&self, call: &Call, request: &Request) -> Result<Fetched, EndpointError> {
        if self.origin == Origin::Recording {
            let response = self.transport.send(call, Duration::MAX)?;
            let said = dialect::read_chat(&self.endpoint, call, &response);
            if said.is_ok() {
                self.ledger.book_kept();
            }
            return Ok((response, said));
        }
        self.breaker.admit()?;
        let needed = estimate(&self.endpoint, request);
        self.ledger.set_aside(needed)?;
        let result = patiently(&self.endpoint.retry, &self.endpoint.timeouts, |patience| {
            let response = self.transport.send(call, patience)?;
            match dialect::read_chat(&self.endpoint, call, &response) {
                Err(error) if error.is_passing() => Err(error),
                said => Ok((response, said)),
            }
        });
        self.breaker.note(&result);
        match &result {
            Ok((_, Ok(said))) => self.ledger.book_answer(needed, &said.usage, &said.text),
            Ok((_, Err(error))) | Err(error) => self.ledger.book_failure(needed, error),
        }
        result
    }

    fn reply(&self, said: Said, call: &Call, request: &Request, learned: &Learned, origin: Origin) -> Reply {
        let Said { text, finish, usage, model, fingerprint, mut notes } = said;
        notes.extend(learned.notes(request));
        notes.extend(self.lost_prompt(request, usage.prompt_tokens));
        Reply {
            text: without_thinking(&text).to_owned(),
            finish: finish.unwrap_or(Finish::Stop),
            usage,
            model,
            fingerprint,
            origin,
            digest: call.digest.clone(),
            notes,
        }
    }

    /// Servers that cut a question to their context lose its first pictures without a word; their count tells.
    fn lost_prompt(&self, request: &Request, counted: Option<u64>) -> Option<String> {
        /// No model spends less on a picture.
        const FEWEST_PER_IMAGE: u64 = 16;
        let counted = counted?;
        let least = request.images().count() as u64 * FEWEST_PER_IMAGE;
        (counted < least).then(|| {
            format!("the server counted {counted} tokens in the question, too few for its pictures: some may be lost")
        })
    }

    /// The answer in the cache. What cannot be read there is asked again.
    fn kept(&self, call: &Call, request: &Request, learned: &Learned) -> Option<Reply> {
        let (exchanges, CacheUse::Take) = self.cache.as_ref()? else { return None };
        let response = match exchanges.read(call) {
            Ok(response) => response?,
            Err(error) => {
                tracing::warn!("{error}; asking again");
                return None;
            }
        };
        let said = dialect::read_chat(&self.endpoint, call, &response).ok()?;
        Some(self.reply(said, call, request, learned, Origin::Cache))
    }

    /// Keeps whole answers alone: a cut or refused one may come out better next time. A full disk costs the cache,
    /// not the answer.
    fn keep(&self, call: &Call, response: &Response, reply: &Reply) {
        let Some((exchanges, _)) = &self.cache else { return };
        if reply.whole().is_err() {
            return;
        }
        if let Err(error) = exchanges.write(call, response) {
            tracing::warn!("an answer could not be kept: {error}");
        }
    }

    fn check_size(&self, request: &Request, call: &Call) -> Result<(), EndpointError> {
        let too_large = |message: String| Err(EndpointError::QuestionTooLarge { message });
        let kind = self.endpoint.kind();
        let images = request.images().count();
        if let Some(limit) = self.endpoint.limits.images.or(kind.max_images).filter(|limit| images > *limit) {
            return too_large(format!("it holds {images} pictures, the limit is {limit}"));
        }
        if let Some(image) =
            request.images().find(|image| !kind.image_types.iter().any(|mime| mime == image.mime()))
        {
            let message = format!("is {}, which {} servers do not take", image.mime(), kind.name);
            return Err(EndpointError::Picture { message });
        }
        let bytes = call.body.as_ref().map_or(0, Vec::len) as u64;
        let limit = self.endpoint.limits.request_bytes.min(kind.max_request_bytes.unwrap_or(u64::MAX));
        if bytes > limit {
            return too_large(format!("it has {bytes} bytes, the limit is {limit}"));
        }
        Ok(())
    }

    fn learned(&self) -> Learned {
        self.learned.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Takes over what another run learned, and keeps what this one learns beside its answers: a question that is
    /// sent without a field must be found again without it.
    fn remembering(mut self, folder: &Path) -> Result<Self, EndpointError> {
        let file = folder.join(LEARNED_FILE);
        if file.exists() {
            self.learned = Mutex::new(json::read(&file)?);
        }
        self.learned_file = Some(file);
        Ok(self)
    }

    fn remember(&self, lesson: &Learned) {
        let mut learned = self.learned.lock().unwrap_or_else(PoisonError::into_inner);
        if *learned == *lesson {
            return;
        }
        learned.omitted.extend(lesson.omitted.iter().cloned());
        learned.other_max_tokens |= lesson.other_max_tokens;
        if let Some(file) = &self.learned_file
            && self.origin == Origin::Server
            && let Err(error) = json::write(file, &*learned)
        {
            tracing::warn!("what the server taught could not be kept: {error}");
        }
    }
}

type Fetched = (Response, Result<Said, EndpointError>);
