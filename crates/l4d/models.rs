//! What verbs that ask model servers share: the client that flags name, what was spent, what a dry run prints.

use anyhow::Result;
use l4d_data::Report;
use l4d_endpoint::{Budget, CacheUse, Client, Endpoint, Link, Plan, Spent};
use l4d_propose::AskOptions;
use serde_json::json;

use crate::cli::models::{AskArgs, EndpointArgs, ServerArgs};
use crate::out::{ExitStatus, Printer, refusal, table};

impl EndpointArgs {
    /// The endpoint that file and flags name, or the one that a recording was made of.
    pub(crate) fn resolve(&self) -> Result<Endpoint> {
        let mut endpoint = match (&self.endpoint, &self.link, &self.base_url, &self.vlm) {
            (Some(path), ..) => Endpoint::read(path)?,
            (None, Link::Replay(folder), ..) => Endpoint::recorded(folder)?,
            (None, _, Some(base_url), Some(model)) => Endpoint::new(base_url, model)?,
            _ => {
                let hint = "name a file with --endpoint, or give --base-url and --vlm, for example \
                            --base-url http://localhost:8000/v1 --vlm Qwen/Qwen3-VL-8B-Instruct";
                return Err(refusal("no endpoint is named", hint));
            }
        };
        if let Some(base_url) = &self.base_url {
            endpoint.base_url = base_url.parse().map_err(|message| {
                refusal(format!("--base-url {message}"), "write it like http://localhost:8000/v1")
            })?;
        }
        if let Some(model) = &self.vlm {
            endpoint.model.clone_from(model);
        }
        if let Some(variable) = &self.api_key_env {
            endpoint.api_key_env = Some(variable.clone());
        }
        if let Some(server) = &self.server {
            endpoint.server.clone_from(server);
        }
        endpoint.check("endpoint")?;
        Ok(endpoint)
    }
}

/// A client for the endpoint, with cache and budget as asked for.
pub(crate) fn open_client(args: &ServerArgs) -> Result<Client> {
    let endpoint = args.endpoint.resolve()?;
    let cache = if args.refresh { CacheUse::Refresh } else { CacheUse::Take };
    let budget = Budget { max_tokens_total: args.max_tokens_total, max_cost: args.max_cost };
    let client = Client::open(endpoint, &args.endpoint.link)?;
    Ok(client.with_cache(&args.cache, cache).with_budget(budget)?)
}

/// How questions are asked.
pub(crate) fn manner(args: &AskArgs) -> AskOptions {
    AskOptions { repeat: args.repeat, answer_tokens: args.answer_tokens }
}

/// Whom it was about, without anything secret.
pub(crate) fn about(endpoint: &Endpoint) -> serde_json::Value {
    json!({ "base_url": endpoint.base_url, "model": endpoint.model, "server": endpoint.server })
}

/// What was spent, in one line of talk.
pub(crate) fn note_spent(spent: &Spent, out: &Printer) {
    let cost = spent.cost.map_or_else(String::new, |cost| format!(", cost {cost:.4}"));
    let Spent { answers, kept, tokens, .. } = spent;
    out.note(format!(
        "{answers} answers of the server, {kept} kept ones; {} + {} tokens{cost}",
        tokens.prompt, tokens.completion
    ));
}

/// Prints plans, one row each, called `what`.
pub(crate) fn print_estimate(
    what: &'static str,
    plans: &[(String, Plan)],
    endpoint: &Endpoint,
    as_json: bool,
    report: Report,
    out: &Printer,
) -> Result<ExitStatus> {
    let mut total = Plan::default();
    plans.iter().for_each(|(_, plan)| total += *plan);
    if as_json {
        let rows: Vec<_> = plans.iter().map(|(name, plan)| json!({ what: name, "plan": plan })).collect();
        let document = json!({ "dry_run": true, "endpoint": about(endpoint), "plans": rows, "total": total });
        return out.document(document, report);
    }
    let row = |name: &str, plan: &Plan| {
        let Plan { questions, kept, images, bytes, tokens, .. } = plan;
        let cost = plan.cost.map_or_else(|| "?".to_owned(), |cost| format!("{cost:.4}"));
        let numbers = [*questions, *kept, *images].map(|count| count.to_string()).into_iter();
        let sizes = [*bytes, tokens.prompt, tokens.completion].map(|count| count.to_string());
        [name.to_owned()].into_iter().chain(numbers).chain(sizes).chain([cost]).collect::<Vec<String>>()
    };
    let head = ["questions", "kept", "pictures", "bytes", "question tokens", "answer tokens", "cost up to"];
    let mut rows = vec![[what].into_iter().chain(head).map(str::to_owned).collect::<Vec<String>>()];
    rows.extend(plans.iter().map(|(name, plan)| row(name, plan)));
    rows.push(row("all", &total));
    out.data(table(&rows))?;
    out.note("nothing was sent; tokens are estimates, those of answers the most that they may have");
    out.any_findings(report)
}
