//! What the cache and recordings keep.

use std::fs;

use l4d_endpoint::{CacheUse, Client, Endpoint, Link, Origin, Request};
use serde_json::json;

use crate::common::{client, echo, files_under, patient, picture, question, with_pictures};
use crate::scripted::{Server, completion, ok, says, status};

#[test]
fn the_same_bytes_are_asked_once() {
    let server = Server::start(vec![echo()]);
    let folder = tempfile::tempdir().unwrap();
    let open = |cache| client(&server).with_cache(folder.path(), cache);
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

    let files = files_under(folder.path());
    assert!(files.contains(&format!("image/png sha256 {}", picture(1).digest())));
    assert!(!files.contains("base64"));
}

#[test]
fn a_damaged_cache_costs_a_question_and_a_full_one_nothing_else() {
    let server = Server::start(vec![echo()]);
    let folder = tempfile::tempdir().unwrap();
    let open = || client(&server).with_cache(folder.path(), CacheUse::Take);
    let digest = open().ask(&question("a")).unwrap().digest;
    let file = folder.path().join(open().endpoint().id()).join(&digest[..2]).join(format!("{digest}.json"));
    let whole = fs::read(&file).unwrap();
    fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    assert_eq!(open().ask(&question("a")).unwrap().origin, Origin::Server);
    assert_eq!(fs::read(&file).unwrap(), whole);

    // A folder that cannot be made: the answer is still given.
    let blocked = folder.path().join("blocked");
    fs::write(&blocked, "a file").unwrap();
    let client = client(&server).with_cache(&blocked, CacheUse::Take);
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
        let open = || client(&server).with_cache(folder.path(), CacheUse::Take);
        open().ask(&question("a")).ok();
        assert_eq!(open().ask(&question("a")).unwrap().text, "whole");
        assert_eq!(open().ask(&question("a")).unwrap().origin, Origin::Cache);
    }
}

#[test]
fn a_recording_replays_without_a_network_and_says_what_it_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let questions: Vec<Request> = ["a", "b", "c"].map(question).into();
    let (recorded, url, failed) = {
        let server = Server::start(vec![echo(), echo(), echo(), ok(&json!({"data": "no list"}))]);
        let link = Link::Record(folder.path().to_owned());
        let client = Client::open(patient(&server.url()), &link).unwrap();
        let recorded: Vec<_> = questions.iter().map(|question| client.ask(question).unwrap()).collect();
        let failed = client.ask(&question("e")).unwrap_err().to_string();
        (recorded, server.url(), failed)
    };
    let endpoint = Endpoint::recorded(folder.path()).unwrap();
    assert_eq!(endpoint.base_url.to_string(), url);
    let client = Client::open(endpoint, &Link::Replay(folder.path().to_owned())).unwrap();
    for (question, recorded) in questions.iter().zip(&recorded).rev() {
        let mut reply = client.ask(question).unwrap();
        assert_eq!(reply.origin, Origin::Recording);
        reply.origin = Origin::Server;
        assert_eq!(&reply, recorded);
    }
    assert_eq!((client.spent().kept, client.spent().answers), (3, 0));
    let error = client.ask(&question("d")).unwrap_err();
    assert!(error.to_string().contains(&folder.path().display().to_string()), "{error}");
    assert!(error.to_string().contains("holds no answer") && error.hint().contains("record:"), "{error}");
    // Failures are part of a recording.
    assert_eq!(client.ask(&question("e")).unwrap_err().to_string(), failed);
}

#[test]
fn a_failure_does_not_replace_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(vec![says("good"), status(500, &json!({"error": "bad day"}))]);
    let link = Link::Record(folder.path().to_owned());
    let client = Client::open(patient(&server.url()), &link).unwrap();
    client.ask(&question("a")).unwrap();
    client.ask(&question("a")).unwrap_err();
    let endpoint = Endpoint::recorded(folder.path()).unwrap();
    let replay = Client::open(endpoint, &Link::Replay(folder.path().to_owned())).unwrap();
    assert_eq!(replay.ask(&question("a")).unwrap().text, "good");
}
