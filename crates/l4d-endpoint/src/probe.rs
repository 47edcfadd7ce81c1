//! What a server supports, found by asking it: one short question for each thing that l4d may want.

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::client::Client;
use crate::error::{EndpointError, excerpt};
use crate::message::{Image, Message, Part};
use crate::reply::{Finish, Reply};
use crate::request::{Request, Schema};

/// How it stands with one thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Works.
    Ok,
    /// Does not, and l4d gets along without.
    Lacking,
    /// Does not, and l4d cannot do without.
    Failed,
    /// The answers do not tell.
    Unclear,
}

/// One line of the table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Line {
    /// What was looked at.
    pub name: &'static str,
    /// How it stands.
    pub state: State,
    /// What was seen.
    pub found: String,
    /// What to do about it; empty where nothing is to be done.
    pub remedy: String,
}

impl Line {
    fn new(name: &'static str, state: State, found: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { name, state, found: found.into(), remedy: remedy.into() }
    }

    fn failed(name: &'static str, state: State, error: &EndpointError) -> Self {
        Self::new(name, state, error.to_string(), error.hint())
    }
}

/// Longest answer to a probe, tokens: room for some thinking.
const MAX_TOKENS: u32 = 256;

/// Looks at everything, in order; `picture` shows one plain colour, of the name given. What a failure makes
/// pointless is left out. `next` hears what comes.
pub fn probe(client: &Client, picture: (&Image, &str), mut next: impl FnMut(&'static str)) -> Vec<Line> {
    let mut lines = Vec::new();
    next("key");
    lines.push(key(client));
    next("models");
    lines.push(models(client));
    next("chat");
    let (line, reply) = chat(client);
    lines.push(line);
    let Some(reply) = reply else { return lines };
    lines.push(usage(&reply));
    next("picture");
    let seen = one_picture(client, picture);
    let takes_pictures = seen.state != State::Lacking;
    lines.push(seen);
    if takes_pictures {
        next("pictures");
        lines.push(several_pictures(client, picture.0));
    }
    next("schema");
    lines.push(schema(client));
    next("seed");
    lines.push(seed(client));
    lines
}

fn ask(client: &Client, parts: Vec<Part>) -> Result<Reply, EndpointError> {
    client.ask(&Request::new(vec![Message::user(parts)]).with_max_tokens(MAX_TOKENS))
}

fn key(client: &Client) -> Line {
    let endpoint = client.endpoint();
    let variables: Vec<&str> = endpoint
        .api_key_env
        .iter()
        .chain(endpoint.header_env.values())
        .map(|variable| variable.as_str())
        .collect();
    if variables.is_empty() {
        return Line::new("key", State::Ok, "none is sent", "");
    }
    let found = format!("from {}", variables.join(", "));
    if endpoint.base_url.exposes_keys() {
        let remedy = "it crosses the network in the clear: use https, or a tunnel to localhost";
        return Line::new("key", State::Lacking, found, remedy);
    }
    Line::new("key", State::Ok, found, "")
}

fn models(client: &Client) -> Line {
    const SHOWN: usize = 8;
    let model = &client.endpoint().model;
    let models = match client.models() {
        Ok(models) => models,
        Err(error) => return Line::failed("models", State::Lacking, &error),
    };
    // Ollama lists `name:latest` for what is asked as `name`.
    if models.iter().any(|listed| listed == model || listed.strip_suffix(":latest") == Some(model)) {
        return Line::new("models", State::Ok, format!("{} listed, `{model}` among them", models.len()), "");
    }
    let names: Vec<String> = models.iter().take(SHOWN).map(|name| excerpt(name)).collect();
    let more = if models.len() > SHOWN { ", ..." } else { "" };
    let remedy = match models.is_empty() {
        true => "load a model into the server".to_owned(),
        false => format!("the server lists {}{more}", names.join(", ")),
    };
    Line::new(
        "models",
        State::Unclear,
        format!("{} listed, `{model}` is not among them", models.len()),
        remedy,
    )
}

fn chat(client: &Client) -> (Line, Option<Reply>) {
    let reply = match ask(client, vec![Part::text("Reply with the single word: ready")]) {
        Ok(reply) => reply,
        Err(error) => return (Line::failed("chat", State::Failed, &error), None),
    };
    let model = reply.model.as_deref().map(|model| format!(" by {}", excerpt(model))).unwrap_or_default();
    let line = match &reply.finish {
        Finish::Length => Line::new(
            "chat",
            State::Unclear,
            format!("an answer{model}, but it never came to an end"),
            "use a model that follows instructions and thinks little",
        ),
        Finish::Refused(words) => {
            Line::new("chat", State::Unclear, format!("refused: {}", excerpt(words)), "use another model")
        }
        Finish::Stop | Finish::Other(_) => {
            Line::new("chat", State::Ok, format!("\"{}\"{model}", shown(&reply.text)), "")
        }
    };
    (line, Some(reply))
}

fn usage(reply: &Reply) -> Line {
    match (reply.usage.prompt_tokens, reply.usage.completion_tokens) {
        (Some(prompt), Some(completion)) => {
            Line::new("usage", State::Ok, format!("{prompt} + {completion} tokens for that"), "")
        }
        _ => Line::new("usage", State::Lacking, "the server counts no tokens", "budgets go by estimates"),
    }
}

fn one_picture(client: &Client, (image, colour): (&Image, &str)) -> Line {
    let text = Part::text("Which colour fills this picture? Answer with one word.");
    match ask(client, vec![Part::Image(image.clone()), text]) {
        Err(error) => Line::failed("picture", State::Lacking, &error),
        Ok(reply) if reply.text.to_lowercase().contains(colour) => Line::new(
            "picture",
            State::Ok,
            format!("a {colour} picture was called {}", shown(&reply.text)),
            "",
        ),
        Ok(reply) => Line::new(
            "picture",
            State::Unclear,
            format!("was taken, but a {colour} picture was called \"{}\"", shown(&reply.text)),
            "check that the model can see (llama.cpp: --mmproj), and that it follows instructions",
        ),
    }
}

fn several_pictures(client: &Client, image: &Image) -> Line {
    let picture = |label: &str| [Part::text(label), Part::Image(image.clone())];
    let labels = ["<0.0 seconds>", "<1.0 seconds>", "<2.0 seconds>"];
    let mut parts: Vec<Part> = labels.into_iter().flat_map(picture).collect();
    parts.push(Part::text("How many pictures do you see? Answer with one number."));
    match ask(client, parts) {
        Ok(reply) if !reply.notes.is_empty() => Line::new(
            "pictures",
            State::Unclear,
            reply.notes.join("; "),
            "raise the context of the server, or send fewer pictures",
        ),
        Ok(reply) if reply.text.contains('3') || reply.text.to_lowercase().contains("three") => {
            Line::new("pictures", State::Ok, "three at once, and all were seen", "")
        }
        Ok(reply) => Line::new(
            "pictures",
            State::Unclear,
            format!("three were taken, but counted as \"{}\"", shown(&reply.text)),
            "check that the model takes several pictures, and that it follows instructions",
        ),
        Err(error) => Line::new(
            "pictures",
            State::Lacking,
            error.to_string(),
            "raise the server's limit (vLLM: --limit-mm-per-prompt, mistral.rs: --max-num-images)",
        ),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Weather {
    #[expect(dead_code, reason = "its presence is what is looked at")]
    sky: Sky,
    #[expect(dead_code, reason = "its presence is what is looked at")]
    warm: bool,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Sky {
    Clear,
    Cloudy,
}

fn schema(client: &Client) -> Line {
    // The question itself speaks of no JSON: only a server that keeps to the schema gives it.
    let schema = json!({
        "type": "object",
        "properties": { "sky": { "type": "string", "enum": ["clear", "cloudy"] }, "warm": { "type": "boolean" } },
        "required": ["sky", "warm"],
        "additionalProperties": false,
    });
    let question = Message::user(vec![Part::text("How is the weather on a fine day in July?")]);
    let request = Request::new(vec![question]).with_schema(Schema::new("weather", schema));
    let remedy = "answers are searched for JSON all the same; a small model may need a server with a grammar (vLLM, llama.cpp)";
    match client.ask(&request.with_max_tokens(MAX_TOKENS)) {
        Err(error) => Line::failed("schema", State::Lacking, &error),
        Ok(reply) if !reply.notes.is_empty() => {
            Line::new("schema", State::Lacking, reply.notes.join("; "), remedy)
        }
        Ok(reply) => match serde_json::from_str::<Weather>(&reply.text) {
            Ok(_) => Line::new("schema", State::Ok, "the answer keeps to it", ""),
            Err(_) => Line::new(
                "schema",
                State::Lacking,
                format!("taken, but ignored: \"{}\"", shown(&reply.text)),
                remedy,
            ),
        },
    }
}

fn seed(client: &Client) -> Line {
    let text = "Write down five random words.";
    let say = |seed: u32, repeat: u32| {
        let mut request = Request::new(vec![Message::user(vec![Part::text(text)])]).with_max_tokens(48);
        request.temperature = Some(1.0);
        request.seed = Some(seed);
        request.repeat = repeat;
        client.ask(&request)
    };
    let answers = say(1, 0).and_then(|first| Ok([first, say(1, 1)?, say(2, 0)?]));
    let [first, again, other] = match answers {
        Ok(answers) => answers,
        Err(error) => return Line::failed("seed", State::Lacking, &error),
    };
    let remedy = "keep temperature at 0, and record what must be repeatable (record:<folder>)";
    if !first.notes.is_empty() {
        return Line::new("seed", State::Lacking, first.notes.join("; "), remedy);
    }
    match (first.text == again.text, first.text == other.text) {
        (true, false) => {
            Line::new("seed", State::Ok, "one seed, one answer; another seed, another answer", "")
        }
        (true, true) => Line::new(
            "seed",
            State::Unclear,
            "the same answer whatever the seed",
            "nothing is sampled, or the cache of the server answers",
        ),
        (false, _) => Line::new("seed", State::Lacking, "one seed, two answers", remedy),
    }
}

fn shown(text: &str) -> String {
    const CHARS: usize = 40;
    let short = excerpt(text);
    if short.chars().count() <= CHARS {
        short
    } else {
        short.chars().take(CHARS).chain("...".chars()).collect()
    }
}
