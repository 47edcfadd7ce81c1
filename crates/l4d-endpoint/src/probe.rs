//! What a server supports, found by asking it: one short question per thing that l4d may want.

use serde::Serialize;
use serde_json::{Value, json};

use crate::client::Client;
use crate::error::{EndpointError, excerpt, one_line};
use crate::reply::{Finish, Reply};
use crate::request::{Image, Message, Part, Request, Schema};

/// Whether one thing works.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    Ok,
    /// It does not, and l4d gets along without.
    Lacking,
    /// It does not, and l4d cannot do without.
    Failed,
    /// The answers do not tell.
    Unclear,
}

/// One line of the table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Line {
    /// What was looked at.
    pub name: &'static str,
    /// Whether it works.
    pub state: State,
    /// What was seen.
    pub found: String,
    /// What to do about it; empty where nothing is to be done.
    pub hint: String,
}

/// State, what was seen, and the hint.
type Finding = (State, String, String);

fn finding(state: State, found: impl Into<String>, hint: &str) -> Finding {
    (state, found.into(), hint.to_owned())
}

fn lacking(error: EndpointError) -> Finding {
    (State::Lacking, error.to_string(), error.hint().to_owned())
}

fn judged<T>(answer: Result<T, EndpointError>, judge: impl FnOnce(&T) -> Finding) -> Finding {
    answer.map_or_else(lacking, |answer| judge(&answer))
}

/// Longest answer to a probe, tokens: room for some thinking.
const MAX_TOKENS: u32 = 256;

/// Looks at everything, in order; `picture` shows one plain colour, of the name given. What a failure makes
/// pointless is left out. `next` gets the name of each probe before it is made.
pub fn probe(client: &Client, picture: (&Image, &str), mut next: impl FnMut(&'static str)) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let mut add = |name, look: &dyn Fn() -> Finding| {
        next(name);
        let (state, found, hint) = look();
        lines.push(Line { name, state, found, hint });
        state
    };
    add("key", &|| key(client));
    add("models", &|| models(client));
    let reply = client.ask(&request("Reply with the single word: ready"));
    add("chat", &|| chat(&reply));
    if let Ok(reply) = &reply {
        add("usage", &|| usage(reply));
        if add("picture", &|| one_picture(client, picture)) != State::Lacking {
            add("pictures", &|| several_pictures(client, picture.0));
        }
        add("schema", &|| schema(client));
        add("seed", &|| seed(client));
    }
    lines
}

fn ask(client: &Client, parts: Vec<Part>) -> Result<Reply, EndpointError> {
    client.ask(&Request::new(vec![Message::user(parts)]).with_max_tokens(MAX_TOKENS))
}

fn request(text: &str) -> Request {
    Request::new(vec![Message::user(vec![Part::text(text)])]).with_max_tokens(MAX_TOKENS)
}

fn key(client: &Client) -> Finding {
    let endpoint = client.endpoint();
    let variables: Vec<String> =
        endpoint.api_key_env.iter().chain(endpoint.header_env.values()).cloned().collect();
    let found = format!("from {}", variables.join(", "));
    match (variables.is_empty(), endpoint.base_url.exposes_keys()) {
        (true, _) => finding(State::Ok, "none is sent", ""),
        (false, false) => finding(State::Ok, found, ""),
        (false, true) => {
            let hint = "it crosses the network in the clear: use https, or a tunnel to localhost";
            finding(State::Lacking, found, hint)
        }
    }
}

fn models(client: &Client) -> Finding {
    const SHOWN: usize = 8;
    let model = &client.endpoint().model;
    let models = match client.models() {
        Ok(models) => models,
        Err(error) => return lacking(error),
    };
    // Ollama lists `name:latest` for what is asked as `name`.
    if models.iter().any(|listed| listed == model || listed.strip_suffix(":latest") == Some(model)) {
        return finding(State::Ok, format!("{} listed, `{model}` among them", models.len()), "");
    }
    let names: Vec<String> = models.iter().take(SHOWN).map(|name| excerpt(name)).collect();
    let more = if models.len() > SHOWN { ", ..." } else { "" };
    let hint = match names.is_empty() {
        true => "load a model into the server".to_owned(),
        false => format!("the server lists {}{more}", names.join(", ")),
    };
    (State::Unclear, format!("{} listed, `{model}` is not among them", models.len()), hint)
}

fn chat(reply: &Result<Reply, EndpointError>) -> Finding {
    let reply = match reply {
        Ok(reply) => reply,
        Err(error) => return (State::Failed, error.to_string(), error.hint().to_owned()),
    };
    let model = reply.model.as_deref().map(|model| format!(" by {}", excerpt(model))).unwrap_or_default();
    match &reply.finish {
        Finish::Length => finding(
            State::Unclear,
            format!("an answer{model}, but it never came to an end"),
            "use a model that follows instructions and thinks little",
        ),
        Finish::Refused(words) => {
            finding(State::Unclear, format!("refused: {}", excerpt(words)), "use another model")
        }
        Finish::Stop => finding(State::Ok, format!("\"{}\"{model}", shown(reply)), ""),
    }
}

fn usage(reply: &Reply) -> Finding {
    match (reply.usage.prompt_tokens, reply.usage.completion_tokens) {
        (Some(prompt), Some(completion)) => {
            finding(State::Ok, format!("{prompt} + {completion} tokens for that"), "")
        }
        _ => finding(State::Lacking, "the server counts no tokens", "budgets go by estimates"),
    }
}

fn one_picture(client: &Client, (image, colour): (&Image, &str)) -> Finding {
    let text = Part::text("Which colour fills this picture? Answer with one word.");
    judged(ask(client, vec![Part::Image(image.clone()), text]), |reply| {
        if reply.text.to_lowercase().contains(colour) {
            return finding(State::Ok, format!("a {colour} picture was called {}", shown(reply)), "");
        }
        finding(
            State::Unclear,
            format!("was taken, but a {colour} picture was called \"{}\"", shown(reply)),
            "check that the model can see (llama.cpp: --mmproj), and that it follows instructions",
        )
    })
}

fn several_pictures(client: &Client, image: &Image) -> Finding {
    let picture = |label: &str| [Part::text(label), Part::Image(image.clone())];
    let labels = ["<0.0 seconds>", "<1.0 seconds>", "<2.0 seconds>"];
    let mut parts: Vec<Part> = labels.into_iter().flat_map(picture).collect();
    parts.push(Part::text("How many pictures do you see? Answer with one number."));
    let more = "raise the server's limit (vLLM: --limit-mm-per-prompt, mistral.rs: --max-num-images)";
    let reply = match ask(client, parts) {
        Ok(reply) => reply,
        Err(error) => return finding(State::Lacking, error.to_string(), more),
    };
    if !reply.notes.is_empty() {
        let hint = "raise the context of the server, or send fewer pictures";
        return finding(State::Unclear, reply.notes.join("; "), hint);
    }
    if reply.text.contains('3') || reply.text.to_lowercase().contains("three") {
        return finding(State::Ok, "three at once, and all were seen", "");
    }
    finding(
        State::Unclear,
        format!("three were taken, but counted as \"{}\"", shown(&reply)),
        "check that the model takes several pictures, and that it follows instructions",
    )
}

fn schema(client: &Client) -> Finding {
    // The question itself speaks of no JSON: only a server that keeps to the schema gives it.
    let schema = json!({
        "type": "object",
        "properties": { "sky": { "type": "string", "enum": ["clear", "cloudy"] }, "warm": { "type": "boolean" } },
        "required": ["sky", "warm"],
        "additionalProperties": false,
    });
    let question = request("How is the weather on a fine day in July?");
    judged(client.ask(&question.with_schema(Schema::new("weather", schema))), |reply| {
        let weather: Value = serde_json::from_str(&reply.text).unwrap_or_default();
        let is_sky = matches!(weather["sky"].as_str(), Some("clear" | "cloudy"));
        if is_sky && weather["warm"].is_boolean() && weather.as_object().is_some_and(|all| all.len() == 2) {
            return finding(State::Ok, "the answer keeps to it", "");
        }
        finding(
            State::Lacking,
            format!("taken, but ignored: \"{}\"", shown(reply)),
            "answers are searched for JSON all the same; a small model may need a server with a grammar (vLLM, llama.cpp)",
        )
    })
}

fn seed(client: &Client) -> Finding {
    let say = |seed: u32, repeat: u32| {
        let question = request("Write down five random words.").with_max_tokens(48);
        client.ask(&Request { temperature: Some(1.0), seed: Some(seed), repeat, ..question })
    };
    let answers = say(1, 0).and_then(|first| Ok([first, say(1, 1)?, say(2, 0)?]));
    judged(answers, |[first, again, other]| match (first.text == again.text, first.text == other.text) {
        (true, false) => finding(State::Ok, "one seed, one answer; another seed, another answer", ""),
        (true, true) => finding(
            State::Unclear,
            "the same answer whatever the seed",
            "nothing is sampled, or the cache of the server answers",
        ),
        (false, _) => finding(
            State::Lacking,
            "one seed, two answers",
            "keep temperature at 0, and record what must be repeatable (record:<folder>)",
        ),
    })
}

/// The beginning of an answer.
fn shown(reply: &Reply) -> String {
    one_line(&reply.text, 40)
}
