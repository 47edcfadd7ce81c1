//! What is sent, what is kept, and what is never told.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

mod common;
mod scripted;

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use common::{client, endpoint, picture, question};
use l4d_endpoint::{
    Budget, CacheUse, Client, Endpoint, EndpointError, Image, Kind, Link, Message, Origin, Part, Prices,
    Request, Schema, Tokens,
};
use scripted::{Server, Turn, completion, ok, says, status, thinks};
use serde_json::{Value, json};

fn with_pictures(images: &[Image]) -> Request {
    let mut parts = Vec::new();
    for (index, image) in images.iter().enumerate() {
        parts.push(Part::text(format!("<{index}.0 seconds>")));
        parts.push(Part::Image(image.clone()));
    }
    parts.push(Part::text("What moves?"));
    Request::new(vec![Message::system("Be brief."), Message::user(parts)])
}

fn schema() -> Schema {
    Schema::new("answer", json!({"type": "object"}))
}

/// Answers with what it was asked, so that no answer can be mistaken for another.
fn echo() -> Turn {
    thinks(|seen| says(&seen.json()["messages"][0]["content"].to_string()))
}

fn files_under(folder: &Path) -> Vec<String> {
    let mut contents = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            contents.extend(files_under(&path));
        } else {
            contents.push(format!("{}\n{}", path.display(), fs::read_to_string(&path).unwrap()));
        }
    }
    contents
}

#[test]
fn the_body_is_what_the_protocol_says() {
    let server = Server::start(vec![says("nothing")]);
    let image = picture(7);
    let reply =
        client(&server).ask(&with_pictures(std::slice::from_ref(&image)).with_schema(schema())).unwrap();
    assert_eq!((reply.text.as_str(), reply.origin), ("nothing", Origin::Server));
    assert_eq!((reply.model.as_deref(), reply.fingerprint.as_deref()), (Some("scripted-1"), Some("fp")));
    let seen = server.seen().remove(0);
    assert_eq!(seen.line, "POST /v1/chat/completions HTTP/1.1");
    assert_eq!(seen.headers["content-type"], "application/json");
    assert!(!seen.headers.contains_key("authorization"));
    let body = seen.json();
    let sent = body["messages"][1]["content"][1]["image_url"]["url"].as_str().unwrap();
    let base64 = sent.strip_prefix("data:image/png;base64,").unwrap();
    assert_eq!(base64::Engine::decode(&base64::prelude::BASE64_STANDARD, base64).unwrap(), image.bytes());
    let expected = json!({
        "model": "tiny",
        "messages": [
            {"role": "system", "content": "Be brief."},
            {"role": "user", "content": [
                {"type": "text", "text": "<0.0 seconds>"},
                {"type": "image_url", "image_url": {"url": sent}},
                {"type": "text", "text": "What moves?"},
            ]},
        ],
        "max_tokens": 1024, "temperature": 0.0, "seed": 0,
        "response_format": {"type": "json_schema",
            "json_schema": {"name": "answer", "strict": true, "schema": {"type": "object"}}},
        "stream": false,
    });
    assert_eq!(body, expected);
}

#[test]
fn ollama_is_asked_through_its_own_route() {
    let answer = json!({
        "model": "qwen3-vl", "message": {"role": "assistant", "content": "[1]"}, "done": true,
        "done_reason": "stop", "prompt_eval_count": 900, "eval_count": 3,
    });
    let server = Server::start(vec![ok(&answer), ok(&json!({"models": [{"name": "qwen3-vl:latest"}]}))]);
    let mut endpoint = endpoint(&server);
    endpoint.server = "ollama".to_owned();
    let client = Client::open(endpoint, &Link::Live).unwrap();
    let reply = client.ask(&with_pictures(&[picture(1), picture(2)]).with_schema(schema())).unwrap();
    assert_eq!((reply.json::<Value>().unwrap(), reply.usage.prompt_tokens), (json!([1]), Some(900)));
    assert_eq!(client.models().unwrap(), ["qwen3-vl:latest"]);
    let seen = server.seen();
    assert_eq!(seen[0].line, "POST /api/chat HTTP/1.1");
    assert_eq!(seen[1].line, "GET /api/tags HTTP/1.1");
    let body = seen[0].json();
    let message = &body["messages"][1];
    let text = "<0.0 seconds>\n[picture 1]\n<1.0 seconds>\n[picture 2]\nWhat moves?";
    assert_eq!((&message["content"], message["images"].as_array().unwrap().len()), (&json!(text), 2));
    let options = json!({"num_ctx": 4096, "num_predict": 1024, "temperature": 0.0, "seed": 0});
    assert_eq!((&body["options"], &body["format"]), (&options, &json!({"type": "object"})));
}

#[test]
fn a_context_that_lost_its_pictures_is_noticed() {
    let mut body = completion("fine");
    body["usage"]["prompt_tokens"] = 20.into();
    let server = Server::start(vec![ok(&body)]);
    let reply = client(&server).ask(&with_pictures(&[picture(1), picture(2)])).unwrap();
    assert!(reply.notes[0].contains("20 tokens"), "{:?}", reply.notes);
}

#[test]
fn the_same_bytes_are_asked_once() {
    let server = Server::start(vec![echo()]);
    let folder = tempfile::tempdir().unwrap();
    let open = |cache| client(&server).with_cache(folder.path(), cache).unwrap();
    let ask = |request: &Request| open(CacheUse::Take).ask(request).unwrap();
    let request = with_pictures(&[picture(1)]);
    assert_eq!(ask(&request).origin, Origin::Server);
    let kept = ask(&request);
    assert_eq!((kept.origin, kept.text.as_str(), server.count()), (Origin::Cache, "\"Be brief.\"", 1));

    // Whatever changes the question is another question: one grey level, a word, the seed, another run.
    let mut others = [with_pictures(&[picture(2)]), question("Be brief!"), request.clone(), request.clone()];
    others[2].seed = Some(1);
    others[3].repeat = 1;
    let mut digests: Vec<String> = others.iter().map(|other| ask(other).digest).collect();
    assert_eq!(server.count(), 5);
    digests.sort();
    digests.dedup();
    assert_eq!(digests.len(), 4);
    assert!(!server.seen()[4].json().as_object().unwrap().contains_key("repeat"));

    assert_eq!(open(CacheUse::Refresh).ask(&request).unwrap().origin, Origin::Server);
    open(CacheUse::Take).forget(&request).unwrap();
    assert_eq!(ask(&request).origin, Origin::Server);
    assert_eq!(server.count(), 7);

    // Pictures stand in the cache as digests.
    let files = files_under(folder.path()).concat();
    assert!(files.contains(&format!("image/png sha256 {}", picture(1).digest())));
    assert!(!files.contains("base64"));
}

#[test]
fn a_damaged_cache_costs_a_question_and_a_full_one_nothing_else() {
    let server = Server::start(vec![echo()]);
    let folder = tempfile::tempdir().unwrap();
    let open = || client(&server).with_cache(folder.path(), CacheUse::Take).unwrap();
    let digest = open().ask(&question("a")).unwrap().digest;
    let file = folder.path().join(open().endpoint().id()).join(&digest[..2]).join(format!("{digest}.json"));
    let whole = fs::read(&file).unwrap();
    fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    assert_eq!(open().ask(&question("a")).unwrap().origin, Origin::Server);
    assert_eq!(fs::read(&file).unwrap(), whole);

    // A folder that cannot be made: the answer is still given.
    let blocked = folder.path().join("blocked");
    fs::write(&blocked, "a file").unwrap();
    let client = client(&server).with_cache(&blocked, CacheUse::Take).unwrap();
    assert_eq!(client.ask(&question("b")).unwrap().origin, Origin::Server);
}

#[test]
fn cut_refused_and_failed_answers_are_not_kept() {
    let mut cut = completion("half an ans");
    cut["choices"][0]["finish_reason"] = "length".into();
    let boom = status(400, &json!({"error": "no"}));
    for turn in [ok(&cut), boom, ok(&json!({"error": "no"})), says("")] {
        let server = Server::start(vec![turn, says("whole")]);
        let folder = tempfile::tempdir().unwrap();
        let open = || client(&server).with_cache(folder.path(), CacheUse::Take).unwrap();
        open().ask(&question("a")).ok();
        assert_eq!(open().ask(&question("a")).unwrap().text, "whole");
        assert_eq!(open().ask(&question("a")).unwrap().origin, Origin::Cache);
    }
}

/// Rejects these fields by name, one at a time.
fn fussy(fields: &'static [&'static str]) -> Turn {
    thinks(move |seen| {
        let body = seen.json();
        match fields.iter().find(|field| !body[**field].is_null()) {
            Some(field) => {
                let message = format!("Unsupported parameter: '{field}' is not supported with this model.");
                status(
                    400,
                    &json!({"error": {"message": message, "param": field, "type": "invalid_request_error"}}),
                )
            }
            None => says("fine"),
        }
    })
}

#[test]
fn a_field_that_the_server_names_is_left_out_and_remembered() {
    let server = Server::start(vec![fussy(&["temperature", "seed"])]);
    let folder = tempfile::tempdir().unwrap();
    let open = || client(&server).with_cache(folder.path(), CacheUse::Take).unwrap();
    let first = open();
    let reply = first.ask(&question("a")).unwrap();
    assert_eq!((server.count(), reply.notes.len()), (3, 2));
    assert!(reply.notes[0].contains("`seed`") && reply.notes[1].contains("`temperature`"));
    first.ask(&question("b")).unwrap();
    assert_eq!(server.count(), 4);
    // Another run knows it too, and finds what this one kept.
    let reply = open().ask(&question("a")).unwrap();
    assert_eq!((reply.origin, reply.notes.len()), (Origin::Cache, 2));
    open().ask(&question("c")).unwrap();
    assert_eq!(server.count(), 5);
    let last = server.seen()[4].json();
    assert!(last["seed"].is_null() && last["temperature"].is_null() && !last["max_tokens"].is_null());
}

#[test]
fn the_limit_of_tokens_is_renamed_where_the_server_says_so() {
    let server = Server::start(vec![thinks(|seen| match seen.json()["max_tokens"].is_null() {
        true => says("fine"),
        false => {
            let message = "Unsupported parameter: 'max_tokens'. Use 'max_completion_tokens' instead.";
            status(400, &json!({"error": {"message": message, "param": "max_tokens"}}))
        }
    })]);
    client(&server).ask(&question("a")).unwrap();
    assert_eq!(server.seen()[1].json()["max_completion_tokens"], 1024);

    // One that minds the number gets it twice at most.
    let message = "'max_tokens' or 'max_completion_tokens' is too large: 1024.";
    let server = Server::start(vec![status(400, &json!({"error": {"message": message}}))]);
    let error = client(&server).ask(&question("a")).unwrap_err();
    assert!(error.to_string().contains("too large") && server.count() == 2, "{error}, {}", server.count());
}

#[test]
fn what_the_user_set_is_not_dropped_behind_their_back() {
    let server = Server::start(vec![fussy(&["top_k"])]);
    let mut endpoint = endpoint(&server);
    endpoint.body.insert("top_k".to_owned(), 20.into());
    let error = Client::open(endpoint, &Link::Live).unwrap().ask(&question("a")).unwrap_err();
    assert!(error.to_string().contains("top_k") && server.count() == 1, "{error}");
}

#[test]
fn a_recording_replays_without_a_network_and_says_what_it_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let questions: Vec<Request> = ["a", "b", "c"].map(question).into();
    let (recorded, url) = {
        let server = Server::start(vec![fussy(&["seed"])]);
        let client = Client::open(endpoint(&server), &Link::Record(folder.path().to_owned())).unwrap();
        let recorded: Vec<_> = questions.iter().map(|question| client.ask(question).unwrap()).collect();
        assert!(matches!(client.models().unwrap_err(), EndpointError::Protocol { .. }));
        (recorded, server.url())
    };
    let endpoint = Endpoint::recorded(folder.path()).unwrap();
    assert_eq!(endpoint.base_url.as_str(), url);
    // In another order, so that nothing hangs on what was learned first.
    let client = Client::open(endpoint, &Link::Replay(folder.path().to_owned())).unwrap();
    for (question, recorded) in questions.iter().zip(&recorded).rev() {
        let mut reply = client.ask(question).unwrap();
        assert_eq!(reply.origin, Origin::Recording);
        reply.origin = Origin::Server;
        assert_eq!(&reply, recorded);
    }
    assert_eq!((client.spent().kept, client.spent().answers), (3, 0));
    let error = client.ask(&question("d")).unwrap_err();
    assert_eq!(error.kind(), Kind::NotRecorded);
    assert!(
        error.to_string().contains(&folder.path().display().to_string()) && error.hint().contains("record:")
    );
    // Failures are part of a recording.
    assert!(matches!(client.models().unwrap_err(), EndpointError::Protocol { .. }));
}

#[test]
fn a_bad_day_does_not_spoil_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(vec![says("good"), status(500, &json!({"error": "bad day"}))]);
    let client = Client::open(endpoint(&server), &Link::Record(folder.path().to_owned())).unwrap();
    client.ask(&question("a")).unwrap();
    client.ask(&question("a")).unwrap_err();
    let endpoint = Endpoint::recorded(folder.path()).unwrap();
    let replay = Client::open(endpoint, &Link::Replay(folder.path().to_owned())).unwrap();
    assert_eq!(replay.ask(&question("a")).unwrap().text, "good");
}

#[test]
fn links_are_read_from_text() {
    assert_eq!("live".parse(), Ok(Link::Live));
    assert_eq!("replay:a:b/c".parse(), Ok(Link::Replay("a:b/c".into())));
    assert_eq!("record:x".parse(), Ok(Link::Record("x".into())));
    for bad in ["", "replay", "replay:", "tape:x"] {
        assert!(bad.parse::<Link>().is_err(), "{bad}");
    }
}

#[test]
fn a_budget_is_never_crossed_not_even_by_threads() {
    let server = Server::start(vec![says("fine")]);
    let mut endpoint = endpoint(&server);
    endpoint.prices = Some(Prices { prompt_per_million: 1e6, completion_per_million: 2e6 });
    let open = |budget| Client::open(endpoint.clone(), &Link::Live).unwrap().with_budget(budget);
    let request = question("hello").with_max_tokens(10);
    // An estimate is 8 + 2 + 10 tokens; an answer books 42.
    let client = open(Budget { max_tokens_total: Some(150), max_cost: None }).unwrap();
    let failures: Vec<Kind> = std::thread::scope(|scope| {
        let ask = || {
            (0..4).filter_map(|_| client.ask(&request).err()).map(|error| error.kind()).collect::<Vec<_>>()
        };
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(ask)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    assert!(failures.iter().all(|kind| *kind == Kind::Budget));
    let spent = client.spent();
    assert_eq!((spent.answers as usize, spent.answers as usize), (server.count(), 16 - failures.len()));
    // What was set aside was too little here, since the server counts more: that much and no more slips through.
    assert!(spent.answers >= 3 && spent.tokens.total() <= 150 + 4 * (42 - 20), "{spent:?}");
    assert_eq!(spent.cost, Some((spent.tokens.prompt + 2 * spent.tokens.completion) as f64));

    let error =
        open(Budget { max_tokens_total: None, max_cost: Some(29.0) }).unwrap().ask(&request).unwrap_err();
    assert!(error.to_string().contains("it may need 30.0000"), "{error}");
    let mut unpriced = endpoint.clone();
    unpriced.prices = None;
    let budget = Budget { max_tokens_total: None, max_cost: Some(1.0) };
    assert!(
        Client::open(unpriced, &Link::Live)
            .unwrap()
            .with_budget(budget)
            .unwrap_err()
            .hint()
            .contains("[prices]")
    );
}

#[test]
fn a_plan_sends_nothing() {
    let server = Server::start(vec![says("fine")]);
    let folder = tempfile::tempdir().unwrap();
    let mut endpoint = endpoint(&server);
    endpoint.prices = Some(Prices { prompt_per_million: 1.0, completion_per_million: 4.0 });
    let client =
        Client::open(endpoint, &Link::Live).unwrap().with_cache(folder.path(), CacheUse::Take).unwrap();
    client.ask(&question("kept")).unwrap();
    let requests = [question("kept"), with_pictures(&[picture(1)]), with_pictures(&[picture(1)])];
    let plan = client.plan(&requests).unwrap();
    assert_eq!((plan.questions, plan.kept, plan.images, server.count()), (3, 2, 1, 1));
    // 8 + 3 (Be brief.), 8 + 5 (<0.0 seconds>), 8 + 2 (40 x 30 / 784), 8 + 4 (What moves?)
    assert_eq!(plan.tokens, Tokens { prompt: 46, completion: 1024 });
    assert!((plan.cost.unwrap() - (46.0 + 4.0 * 1024.0) / 1e6).abs() < 1e-12);
    assert!(plan.bytes > 300);
}

#[test]
fn limits_hold_before_anything_is_sent() {
    let server = Server::start(vec![says("fine")]);
    let ask = |edit: &dyn Fn(&mut Endpoint)| {
        let mut endpoint = endpoint(&server);
        edit(&mut endpoint);
        Client::open(endpoint, &Link::Live)
            .unwrap()
            .ask(&with_pictures(&[picture(1), picture(2)]))
            .unwrap_err()
    };
    let error = ask(&|endpoint| endpoint.limits.images = Some(1));
    assert!(error.to_string().contains("2 pictures, the limit is 1"), "{error}");
    assert!(
        ask(&|endpoint| endpoint.server = "mistral-rs".to_owned()).to_string().contains("the limit is 1")
    );
    assert!(ask(&|endpoint| endpoint.limits.request_bytes = 100).to_string().contains("the limit is 100"));
    assert_eq!(server.count(), 0);
}

#[test]
fn many_threads_share_a_client() {
    let server = Server::start(vec![echo()]);
    let folder = tempfile::tempdir().unwrap();
    let client = client(&server).with_cache(folder.path(), CacheUse::Take).unwrap();
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let client = &client;
            scope.spawn(move || {
                for round in 0..20 {
                    let text = format!("{}", (thread * 7 + round) % 25);
                    assert_eq!(client.ask(&question(&text)).unwrap().text, format!("\"{text}\""));
                }
            });
        }
    });
    assert_eq!(client.spent().answers + client.spent().kept, 160);
    assert!(server.count() < 100, "{}", server.count());
}

const KEY: &str = "sk-canary/7Yq+0123456789";
const SECOND: &str = "org-canary-8Zr-987654321";

fn environment(variable: &str) -> Option<OsString> {
    match variable {
        "L4D_TEST_KEY" => Some(format!(" {KEY}\n").into()),
        "L4D_TEST_ORG" => Some(SECOND.into()),
        "L4D_TEST_SHORT" => Some("short".into()),
        _ => None,
    }
}

fn locked(server: &Server) -> Endpoint {
    let mut endpoint = endpoint(server);
    endpoint.api_key_env = Some("L4D_TEST_KEY".parse().unwrap());
    endpoint.header_env.insert("x-org".to_owned(), "L4D_TEST_ORG".parse().unwrap());
    endpoint.retry.tries = 2;
    endpoint
}

#[test]
fn keys_go_into_headers_and_nowhere_else_whatever_the_server_echoes() {
    let slashed = KEY.replace('/', "\\/");
    let escaped: String = KEY.chars().map(|letter| format!("\\u{:04x}", u32::from(letter))).collect();
    let raw = |status, body: String| Turn::Say(status, vec![("retry-after", format!("0; {KEY}"))], body);
    let echoes = [
        status(401, &json!({"error": {"message": format!("Incorrect API key provided: {KEY} / {SECOND}")}})),
        raw(401, format!(r#"{{"error": {{"message": "no {slashed}"}}}}"#)),
        raw(403, format!(r#"{{"error": "no {escaped}"}}"#)),
        raw(500, format!("<html><title>{KEY}</title>Authorization: Bearer {KEY}</html>")),
        raw(429, format!("Bearer {KEY}")),
        raw(200, format!("garbage {KEY}")),
        raw(200, format!(r#"{{"error": "{escaped}"}}"#)),
        raw(200, format!("data: {{\"error\": \"{KEY}\"}}\n\n")),
        raw(200, format!("<!doctype html><title>{SECOND}</title>")),
        says(&format!("your key is {KEY}, your organisation {SECOND}")),
        ok(&{
            let mut body = completion("fine");
            body["model"] = KEY.into();
            body["system_fingerprint"] = SECOND.into();
            body
        }),
        Turn::Say(307, vec![("location", format!("http://127.0.0.1:1/{KEY}?{SECOND}"))], String::new()),
        Turn::Raw(format!("HTTP/1.1 200 OK\r\n{KEY}: x\r\nbroken {KEY}\r\n\r\n").into_bytes()),
        Turn::Raw(KEY.as_bytes().to_vec()),
    ];
    for (index, turn) in echoes.into_iter().enumerate() {
        let server = Server::start(vec![turn]);
        let folder = tempfile::tempdir().unwrap();
        let mut told = String::new();
        for link in [Link::Live, Link::Record(folder.path().join("recording"))] {
            let client = Client::open_in(locked(&server), &link, &environment).unwrap();
            let client = client.with_cache(&folder.path().join("cache"), CacheUse::Take).unwrap();
            told += &match client.ask(&question("who am I?")) {
                Ok(reply) => format!("{reply:?}"),
                Err(error) => format!("{error} {error:?} {}", error.hint()),
            };
            told += &match client.models() {
                Ok(models) => format!("{models:?}"),
                Err(error) => format!("{error} {error:?}"),
            };
            told += &format!("{client:?}");
        }
        for seen in server.seen() {
            assert_eq!(seen.headers["authorization"], format!("Bearer {KEY}"));
            assert_eq!(seen.headers["x-org"], SECOND);
        }
        told += &files_under(folder.path()).concat();
        for word in ["canary", "7Yq", "8Zr", "\\u0063", "L4D_TEST_ORG\":"] {
            assert!(!told.contains(word), "echo {index} told `{word}`:\n{told}");
        }
        assert!(server.count() >= 4);
    }
}

#[test]
fn a_redirect_is_told_and_not_followed() {
    let elsewhere = Server::start(vec![says("thanks for the key")]);
    let location = format!("http://localhost:{}/v1/chat/completions", elsewhere.port);
    let server = Server::start(vec![Turn::Say(308, vec![("location", location)], String::new())]);
    let client = Client::open_in(locked(&server), &Link::Live, &environment).unwrap();
    let error = client.ask(&question("hello")).unwrap_err();
    assert!(matches!(error, EndpointError::Redirect { .. }), "{error:?}");
    assert!(error.to_string().contains("http://localhost"), "{error}");
    assert_eq!((server.count(), elsewhere.count()), (1, 0));
}

#[test]
fn keys_that_are_none_are_told_by_the_name_of_their_variable() {
    let server = Server::start(vec![says("fine")]);
    for (variable, words) in [("L4D_TEST_NONE", "is not set"), ("L4D_TEST_SHORT", "fewer than 8")] {
        let mut endpoint = locked(&server);
        endpoint.api_key_env = Some(variable.parse().unwrap());
        let error = Client::open_in(endpoint, &Link::Live, &environment).unwrap_err();
        let text = format!("{error} {}", error.hint());
        assert!(text.contains(variable) && text.contains(words) && !text.contains("short\""), "{text}");
    }
}
