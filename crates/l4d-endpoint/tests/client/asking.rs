//! What is sent, and what it costs.

use l4d_endpoint::{Budget, CacheUse, Client, EndpointError, Link, Origin, Prices, Request, Schema, Tokens};
use serde_json::json;

use crate::common::{client, client_with, echo, patient, picture, question, with_pictures};
use crate::scripted::{Server, completion, ok, says, status};

#[test]
fn the_body_is_what_the_protocol_says() {
    let server = Server::start(vec![says("nothing")]);
    let image = picture(7);
    let request = with_pictures(std::slice::from_ref(&image))
        .with_schema(Schema::new("answer", json!({"type": "object"})));
    let reply = client(&server).ask(&request).unwrap();
    assert_eq!((reply.text.as_str(), reply.origin), ("nothing", Origin::Server));
    assert_eq!(reply.model.as_deref(), Some("scripted-1"));
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
    // The name of kept answers: a change here makes every cache and recording worthless.
    assert_eq!(reply.digest, "8fb5fceb7502eb726ab29e545211031e03c28edec83055e9010d5f34e41df45b");
}

#[test]
fn the_endpoint_says_which_fields_are_sent() {
    let server = Server::start(vec![says("fine")]);
    let openai = client_with(&server, |endpoint| {
        endpoint.server = "openai".to_owned();
        endpoint.omit = vec!["temperature".to_owned(), "seed".to_owned()];
        endpoint.body.insert("top_k".to_owned(), 20.into());
    });
    openai.ask(&question("a")).unwrap();
    let expected = json!({
        "model": "tiny", "messages": [{"role": "user", "content": "a"}],
        "max_completion_tokens": 1024, "stream": false, "top_k": 20,
    });
    assert_eq!(server.seen()[0].json(), expected);

    let rejection = json!({"error": {"message": "Unsupported parameter: 'seed'", "param": "seed"}});
    let server = Server::start(vec![status(400, &rejection)]);
    let error = client(&server).ask(&question("a")).unwrap_err();
    assert!(!error.to_string().contains("seed") && error.hint().contains("`omit`"), "{error}");
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
fn a_budget_is_never_crossed_not_even_by_threads() {
    let server = Server::start(vec![says("fine")]);
    let open = |prices, max_tokens_total, max_cost| {
        client_with(&server, |endpoint| endpoint.prices = prices)
            .with_budget(Budget { max_tokens_total, max_cost })
    };
    let prices = Some(Prices { prompt_per_million: 1e6, completion_per_million: 2e6 });
    let request = question("hello").with_max_tokens(10);
    // An estimate is 8 + 2 + 10 tokens; an answer books 42.
    let client = open(prices, Some(150), None).unwrap();
    let failures: Vec<EndpointError> = std::thread::scope(|scope| {
        let ask = || (0..4).filter_map(|_| client.ask(&request).err()).collect::<Vec<_>>();
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(ask)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    assert!(failures.iter().all(|error| error.hint().contains("--max-tokens-total")));
    let spent = client.spent();
    assert_eq!((spent.answers as usize, spent.answers as usize), (server.count(), 16 - failures.len()));
    // What was set aside was too little here, since the server counts more: that much and no more slips through.
    assert!(spent.answers >= 3 && spent.tokens.total() <= 150 + 4 * (42 - 20), "{spent:?}");
    assert_eq!(spent.cost, Some((spent.tokens.prompt + 2 * spent.tokens.completion) as f64));

    let error = open(prices, None, Some(29.0)).unwrap().ask(&request).unwrap_err();
    assert!(error.to_string().contains("it may need 30.0000"), "{error}");
    assert!(open(None, None, Some(1.0)).unwrap_err().hint().contains("[prices]"));
}

#[test]
fn a_plan_sends_nothing() {
    let server = Server::start(vec![says("fine")]);
    let folder = tempfile::tempdir().unwrap();
    let mut endpoint = patient(&server.url());
    endpoint.prices = Some(Prices { prompt_per_million: 1.0, completion_per_million: 4.0 });
    let client = Client::open(endpoint, &Link::Live).unwrap().with_cache(folder.path(), CacheUse::Take);
    client.ask(&question("kept")).unwrap();
    let requests = [question("kept"), with_pictures(&[picture(1)]), with_pictures(&[picture(1)])];
    let plan = client.plan(&requests);
    assert_eq!((plan.questions, plan.kept, plan.images, server.count()), (3, 2, 1, 1));
    // 8 + 3 (Be brief.), 8 + 5 (<0.0 seconds>), 8 + 2 (40 x 30 / 784), 8 + 4 (What moves?)
    assert_eq!(plan.tokens, Tokens { prompt: 46, completion: 1024 });
    assert!((plan.cost.unwrap() - (46.0 + 4.0 * 1024.0) / 1e6).abs() < 1e-12);
    assert!(plan.bytes > 300);
}

#[test]
fn many_threads_share_a_client() {
    let server = Server::start(vec![echo()]);
    let folder = tempfile::tempdir().unwrap();
    let client = client(&server).with_cache(folder.path(), CacheUse::Take);
    let ask = &|thread: u32| {
        for round in 0..20 {
            let text = format!("{}", (thread * 7 + round) % 25);
            let request: Request = question(&text);
            assert_eq!(client.ask(&request).unwrap().text, format!("\"{text}\""));
        }
    };
    std::thread::scope(|scope| {
        for thread in 0..8 {
            scope.spawn(move || ask(thread));
        }
    });
    assert_eq!(client.spent().answers + client.spent().kept, 160);
    assert!(server.count() < 100, "{}", server.count());
}
