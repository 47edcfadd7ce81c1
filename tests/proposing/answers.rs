//! What a model may answer, and what becomes of it.

use serde_json::{Value, json};

use super::scripted::{Server, Turn, ok, says};
use super::stage::*;

#[test]
fn proposals_go_three_ways_and_none_into_the_benchmark() {
    let (dir, left_out) = stage(&[CUPS]);
    let before = dir.tree("benchmark");
    let [whole, gated] = [0, 1].map(|index| proposal(&dir, &left_out[index]));
    let with = |field: &str, value: Value| {
        let mut item = whole.clone();
        item[field] = value;
        item
    };
    let items = [
        whole.clone(),
        gated,
        with("referents", json!([99])),
        with("text", json!("The cup to the left of the lamp")),
        with("category", json!("colour")),
        with("text", json!("The zzyzx cup on the desk")),
        json!({ "text": "The cup", "said": "nothing else" }),
        whole.clone(),
        json!({ "category": "action", "text": "The cup that is lifted after the others", "referents": [2],
                "temporal": "whole", "frames": [], "predicate": "" }),
    ];
    let prose = format!("Of course!\n```json\n{}\n```\nShall I go on?", answer(&items));
    let server = Server::start(vec![says(&prose)]);
    endpoint(&dir, &server, "");
    prompts(&dir, "").says(0, &["candidates", "L4D563 x1"]);

    let candidates = lines(&dir, &format!("{CUPS}.jsonl"));
    assert_eq!(candidates.len(), 2, "{}", dir.read(&format!("{PROPOSALS}/{CUPS}.failed.jsonl")));
    for (candidate, query) in candidates.iter().zip(&left_out) {
        for field in ["text", "categories", "referents", "temporal", "frames", "predicate", "text_digest"] {
            assert_eq!(candidate[field], query[field], "{field}");
        }
        assert_eq!([&candidate["status"], &candidate["provenance"]["source"]], ["candidate", "model"]);
        let note = candidate["provenance"]["note"].as_str().unwrap();
        assert!(note.starts_with("model tiny (says it is scripted-1), endpoint 127.0.0.1:"), "{note}");
    }
    assert_ne!(candidates[0]["id"], candidates[1]["id"]);
    let unproved = lines(&dir, &format!("{CUPS}.unproved.jsonl"));
    assert_eq!((unproved.len(), &unproved[0]["query"]["predicate"]), (1, &Value::Null));
    let failed = lines(&dir, &format!("{CUPS}.failed.jsonl"));
    let found: Vec<Vec<&str>> = failed.iter().map(codes).collect();
    assert!(found[0].contains(&"L4D563") && found[1].contains(&"L4D216"), "{found:?}");
    assert_eq!(found[2], ["L4D562"]);
    assert!(found[3].contains(&"L4D214") && found[4].contains(&"L4D561"), "{found:?}");
    assert!(found[5].contains(&"L4D213") && found[5].contains(&"L4D212"), "the same again: {found:?}");
    assert_eq!(failed[4]["said"]["said"], "nothing else", "in the model's words");
    assert_eq!(dir.tree("benchmark"), before);

    // A candidate is ready for the benchmark: moved there, the whole set checks.
    let queries = format!("benchmark/queries/{CUPS}.jsonl");
    let moved = dir.read(&queries) + &dir.read(&format!("{PROPOSALS}/{CUPS}.jsonl"));
    dir.write(&queries, moved);
    let checked = dir.json("check-queries --profile tiny");
    assert_eq!(checked["findings"], json!([]));
}

#[test]
fn what_is_no_answer_leaves_no_file_and_a_clear_message() {
    let (dir, _) = stage(&[CUPS]);
    let page = "<html><head><title>Log in</title></head></html>";
    let html = Turn::Say(200, vec![("content-type", "text/html".to_owned())], page.to_owned());
    let body = ok(&json!({ "error": { "message": "model not loaded" } }));
    for (turn, reason) in [
        (html, "web page"),
        (body, "model not loaded"),
        (Turn::Cut, "127.0.0.1"),
        (Turn::Reset, "127.0.0.1"),
        (Turn::Raw(b"\xff\xfe garbage".to_vec()), "127.0.0.1"),
        (Turn::Say(401, Vec::new(), "{}".to_owned()), "401"),
    ] {
        let server = Server::start(vec![turn]);
        endpoint(&dir, &server, "");
        prompts(&dir, "").says(1, &["L4D568", reason, "hint: "]);
        assert!(!dir.path(PROPOSALS).exists());
    }
    let server = Server::start(vec![says("x")]);
    endpoint(&dir, &server, "");
    drop(server);
    prompts(&dir, "").says(1, &["start the server"]);
}
