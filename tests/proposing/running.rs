//! Runs that stop, go on, are divided, recorded or refused.

use std::path::PathBuf;
use std::process::Command;

use l4d_data::json;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use serde_json::{Value, json};

use super::scripted::{Seen, Server, Turn, completion, ok, says, thinks};
use super::stage::*;
use crate::support::Run;

#[test]
fn nothing_is_asked_twice() {
    let (dir, left_out) = stage(&[CUPS, CATS]);
    let [cups, cats] = [0, 2].map(|index| answer(&[proposal(&dir, &left_out[index])]));
    let error = Turn::Say(500, Vec::new(), "{\"error\":{\"message\":\"out of order\"}}".to_owned());
    let server = Server::start(vec![says(&cups), error, says(&cats), says("never asked")]);
    endpoint(&dir, &server, "");
    let first = prompts(&dir, &["--json"]);
    assert_eq!((first.code, server.count()), (1, 2), "{}", first.stderr);
    let report = document(&first);
    assert_eq!(report["scenes"][0]["answer"], "server");
    assert_eq!(
        (&report["scenes"][1]["answer"], &report["findings"][0]["code"]),
        (&Value::Null, &json!("L4D568"))
    );
    let message = report["findings"][0]["message"].as_str().unwrap();
    assert!(message.contains("500") && message.contains("out of order"), "{message}");
    let kept = dir.read(&format!("work/tiny/proposals/{CUPS}.jsonl"));

    let second = document(&prompts(&dir, &["--json"]));
    assert_eq!(server.count(), 3, "only the scene without an answer is asked about");
    assert_eq!([&second["scenes"][0]["answer"], &second["scenes"][1]["answer"]], ["cache", "server"]);
    assert_eq!((&second["scenes"][1]["candidates"], &second["findings"]), (&json!(1), &json!([])));
    assert_eq!(dir.read(&format!("work/tiny/proposals/{CUPS}.jsonl")), kept);

    let after = files(&dir.path("work/tiny/proposals"));
    let third = prompts(&dir, &["--jobs", "2"]);
    assert_eq!((third.code, server.count()), (0, 3));
    assert_eq!(files(&dir.path("work/tiny/proposals")), after, "the same bytes");
}

#[test]
fn a_budget_stops_and_a_plan_sends_nothing() {
    let (dir, left_out) = stage(&[CUPS, CATS]);
    let mut wordy = completion(&answer(&[proposal(&dir, &left_out[0])]));
    wordy["usage"] = json!({ "prompt_tokens": 3000, "completion_tokens": 5000, "total_tokens": 8000 });
    let server = Server::start(vec![ok(&wordy)]);
    endpoint(&dir, &server, "prices = { prompt_per_million = 10.0, completion_per_million = 100.0 }");
    let plan = document(&prompts(&dir, &["--dry-run", "--json"]));
    assert_eq!((server.count(), &plan["dry_run"], &plan["total"]["questions"]), (0, &json!(true), &json!(2)));
    assert_eq!((&plan["plans"][0]["plan"]["images"], &plan["total"]["kept"]), (&json!(2), &json!(0)));
    let [total, first] =
        [&plan["total"]["cost"], &plan["plans"][0]["plan"]["cost"]].map(|c| c.as_f64().unwrap());
    assert!(first > 0.1 && total > first, "{plan}");
    let table = prompts(&dir, &["--dry-run"]);
    assert!(table.stdout.contains("question tokens") && table.stdout.contains(CATS), "{}", table.stdout);
    assert!(!dir.path("work").exists(), "a plan writes nothing");

    // Enough for one scene, not for two.
    let limit = format!("{}", first * 1.2);
    let run = prompts(&dir, &["--max-cost", &limit, "--json"]);
    assert_eq!((run.code, server.count()), (1, 1), "{}", run.stderr);
    let report = document(&run);
    let message = report["findings"][0]["message"].as_str().unwrap();
    assert!(message.contains("budget"), "{message}");
    assert_eq!(
        [&report["scenes"][0]["answer"], &report["scenes"][1]["answer"]],
        [&json!("server"), &Value::Null]
    );
    let plan = document(&prompts(&dir, &["--dry-run", "--json"]));
    assert_eq!(plan["total"]["kept"], 1, "what was answered costs no more");
}

#[test]
fn other_proposals_are_not_overwritten_unasked() {
    let (dir, left_out) = stage(&[CUPS]);
    let server =
        Server::start(vec![says(&answer(&[proposal(&dir, &left_out[0])])), says("{\"proposals\":[]}")]);
    endpoint(&dir, &server, "");
    assert_eq!(prompts(&dir, &[]).code, 0);
    let file = format!("work/tiny/proposals/{CUPS}.jsonl");
    let kept = dir.read(&file);
    let again = prompts(&dir, &["--repeat", "1"]);
    assert!(
        again.code == 1 && again.stdout.contains("L4D569") && again.stdout.contains("--force"),
        "{}",
        again.stdout
    );
    assert_eq!((dir.read(&file), server.count()), (kept, 2));
    assert_eq!(server.seen()[1].json()["seed"], 1);
    assert_eq!(prompts(&dir, &["--repeat", "1", "--force"]).code, 0);
    assert_eq!((dir.read(&file), server.count()), (String::new(), 2), "the answer was kept");
}

#[test]
fn shards_divide_the_scenes_and_recordings_need_no_server() {
    let (dir, left_out) = stage(&[CUPS, CATS]);
    let [cups, cats] = [0, 2].map(|index| answer(&[proposal(&dir, &left_out[index])]));
    let reply = thinks(move |seen: &Seen| says(if seen.body.contains("keyboard") { &cups } else { &cats }));
    let server = Server::start(vec![reply]);
    endpoint(&dir, &server, "");
    for shard in ["1/2", "2/2"] {
        let report = document(&prompts(
            &dir,
            &["--shard", shard, "--json", "--link", "record:tape", "--out", "sharded"],
        ));
        assert_eq!(report["scenes"].as_array().unwrap().len(), 1, "{report}");
        assert_eq!(report["scenes"][0]["candidates"], 1, "{report}");
    }
    assert_eq!(server.count(), 2);
    drop(server);
    let replayed = document(&prompts(&dir, &["--json", "--link", "replay:tape", "--out", "replayed"]));
    assert_eq!(replayed["scenes"][1]["answer"], "recording");
    let names = |folder: &str| -> Vec<(PathBuf, Vec<u8>)> {
        let own = |(path, bytes): (PathBuf, Vec<u8>)| {
            (path.strip_prefix(dir.path(folder)).unwrap().to_owned(), bytes)
        };
        files(&dir.path(folder)).into_iter().map(own).collect()
    };
    assert_eq!(names("sharded"), names("replayed"));
}

#[test]
fn keys_reach_the_server_and_nothing_else() {
    const KEY: &str = "sk-canary-0123456789";
    let (dir, left_out) = stage(&[CUPS]);
    let echo = thinks(|seen: &Seen| {
        let message = format!("denied: {}", seen.headers["authorization"]);
        Turn::Say(403, Vec::new(), json!({ "error": { "message": message } }).to_string())
    });
    let server = Server::start(vec![echo, says(&answer(&[proposal(&dir, &left_out[0])]))]);
    endpoint(&dir, &server, "api_key_env = \"L4D_TEST_KEY\"");
    let run = |more: &[&str]| -> Run {
        let mut command = Command::new(env!("CARGO_BIN_EXE_l4d"));
        command.args(PROMPTS).args(more).current_dir(dir.path(""));
        command.env("L4D_TEST_KEY", KEY).env("RUST_LOG", "trace").output().unwrap().into()
    };
    let refused = run(&["--link", "record:tape"]);
    assert_eq!(refused.code, 1);
    let answered = run(&["--verbose"]);
    assert_eq!(answered.code, 0, "{}", answered.stderr);
    assert!(server.seen()[1].headers["authorization"].contains(KEY));
    for output in [&refused.stdout, &refused.stderr, &answered.stdout, &answered.stderr] {
        assert!(!output.contains("canary"), "{output}");
    }
    for (path, bytes) in files(&dir.path("")) {
        assert!(!bytes.windows(6).any(|window| window == b"canary"), "{}", path.display());
    }
    let unset = dir.run(&[&PROMPTS[..], &["--refresh"]].concat());
    assert!(unset.code == 2 && unset.stderr.contains("L4D_TEST_KEY"), "{}", unset.stderr);
}

#[test]
fn scenes_that_do_not_fit_are_named() {
    let (dir, _) = stage(&[CUPS]);
    let server = Server::start(vec![says("never asked")]);
    endpoint(&dir, &server, "");
    let unknown = prompts(&dir, &["--scenes", "room_nowhere"]);
    assert!(unknown.code == 2 && unknown.stderr.contains("room_nowhere"), "{}", unknown.stderr);
    let empty = prompts(&dir, &["--data", "nothing"]);
    assert!(empty.code == 2 && empty.stderr.contains("build-scenes"), "{}", empty.stderr);
    let place = SceneDir::new(&dir.path("data/tiny"), CUPS);
    let mut scene = Scene::read(&place.scene()).unwrap();
    let held_out = scene.test_camera().unwrap().name.clone();
    std::fs::remove_file(place.frame(&held_out, 96)).unwrap();
    let missing = prompts(&dir, &[]);
    assert!(missing.code == 1 && missing.stdout.contains("0096.exr"), "{}", missing.stdout);
    scene.variant = 7;
    json::write(&place.scene(), &scene).unwrap();
    let missing = prompts(&dir, &[]);
    assert!(missing.code == 1 && missing.stdout.contains("L4D112"), "{}", missing.stdout);
    assert_eq!(server.count(), 0);
    let unasked = dir.run(&["propose-prompts", "--profile", "tiny"]);
    assert!(unasked.code == 2 && unasked.stderr.contains("--endpoint"), "{}", unasked.stderr);
}
