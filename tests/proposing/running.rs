//! `l4d propose-prompts` as a whole run: resumed after an error, stopped by a budget, divided into shards, recorded and
//! replayed, and refused for scenes that are incomplete.

use l4d_data::json;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use serde_json::{Value, json};

use super::scripted::{Seen, Server, Turn, completion, ok, says, thinks};
use super::stage::*;

#[test]
fn a_second_run_asks_only_about_scenes_without_an_answer() {
    let (dir, left_out) = stage(&[CUPS, CATS]);
    let [cups, cats] = [0, 2].map(|index| answer(&[proposal(&dir, &left_out[index])]));
    let error = Turn::Say(500, Vec::new(), "{\"error\":{\"message\":\"out of order\"}}".to_owned());
    let server = Server::start(vec![says(&cups), error, says(&cats), says("never asked")]);
    endpoint(&dir, &server, "");
    let answers = |report: &Value| [0, 1].map(|scene| report["scenes"][scene]["answer"].clone());
    let first = prompts(&dir, "--json");
    first.says(1, &["L4D568", "500"]);
    assert_eq!((answers(&first.value()), server.count()), ([json!("server"), Value::Null], 2));
    let kept = dir.read(&format!("{PROPOSALS}/{CUPS}.jsonl"));

    let second = prompts(&dir, "--json").value();
    assert_eq!(server.count(), 3, "only the scene without an answer is asked about");
    assert_eq!(answers(&second), ["cache", "server"]);
    assert_eq!((&second["scenes"][1]["candidates"], &second["findings"]), (&json!(1), &json!([])));
    assert_eq!(dir.read(&format!("{PROPOSALS}/{CUPS}.jsonl")), kept);

    let after = dir.tree(PROPOSALS);
    assert_eq!((prompts(&dir, "--jobs 2").code, server.count()), (0, 3));
    assert_eq!(dir.tree(PROPOSALS), after, "the same bytes");
}

#[test]
fn a_budget_stops_a_run_and_a_dry_run_sends_nothing() {
    let (dir, left_out) = stage(&[CUPS, CATS]);
    let mut wordy = completion(&answer(&[proposal(&dir, &left_out[0])]));
    wordy["usage"] = json!({ "prompt_tokens": 3000, "completion_tokens": 5000, "total_tokens": 8000 });
    let server = Server::start(vec![ok(&wordy)]);
    endpoint(&dir, &server, "prices = { prompt_per_million = 10.0, completion_per_million = 100.0 }");
    let plan = || prompts(&dir, "--dry-run --json").value();
    let planned = plan();
    let (total, first) = (&planned["total"], &planned["plans"][0]["plan"]);
    assert_eq!((server.count(), &planned["dry_run"], &total["questions"]), (0, &json!(true), &json!(2)));
    assert_eq!((&first["images"], &total["kept"]), (&json!(2), &json!(0)));
    let [total, first] = [total, first].map(|plan| plan["cost"].as_f64().unwrap());
    assert!(first > 0.1 && total > first, "{planned}");
    prompts(&dir, "--dry-run").says(0, &["question tokens", CATS]);
    assert!(!dir.path("work").exists(), "a plan writes nothing");

    // Enough for one scene, not for two.
    let run = prompts(&dir, &format!("--max-cost {} --json", first * 1.2));
    run.says(1, &["budget"]);
    let scenes = run.value()["scenes"].clone();
    assert_eq!((server.count(), &scenes[0]["answer"]), (1, &json!("server")));
    assert_eq!(scenes[1]["answer"], Value::Null);
    assert_eq!(plan()["total"]["kept"], 1, "what was answered costs no more");
}

#[test]
fn shards_divide_the_scenes_and_recordings_need_no_server() {
    let (dir, left_out) = stage(&[CUPS, CATS]);
    let [cups, cats] = [0, 2].map(|index| answer(&[proposal(&dir, &left_out[index])]));
    let reply = thinks(move |seen: &Seen| says(if seen.body.contains("keyboard") { &cups } else { &cats }));
    let server = Server::start(vec![reply]);
    endpoint(&dir, &server, "");
    for shard in ["1/2", "2/2"] {
        let run = prompts(&dir, &format!("--shard {shard} --json --link record:tape --out sharded"));
        let scenes = run.value()["scenes"].clone();
        assert_eq!((scenes.as_array().unwrap().len(), &scenes[0]["candidates"]), (1, &json!(1)), "{run}");
    }
    assert_eq!(server.count(), 2);
    drop(server);
    let replayed = prompts(&dir, "--json --link replay:tape --out replayed").value();
    assert_eq!(replayed["scenes"][1]["answer"], "recording");
    assert_eq!(dir.tree("sharded"), dir.tree("replayed"));
}

#[test]
fn missing_and_mismatched_scenes_are_named_and_nothing_is_asked() {
    let (dir, _) = stage(&[CUPS]);
    let server = Server::start(vec![says("never asked")]);
    endpoint(&dir, &server, "");
    prompts(&dir, "--scenes room_nowhere").says(2, &["room_nowhere"]);
    prompts(&dir, "--data nothing").says(2, &["build-scenes"]);
    let place = SceneDir::new(&dir.path("data/tiny"), CUPS);
    let mut scene = Scene::read(&place.scene()).unwrap();
    let held_out = scene.test_camera().unwrap().name.clone();
    std::fs::remove_file(place.frame(&held_out, 96)).unwrap();
    prompts(&dir, "").says(1, &["0096.exr"]);
    scene.variant = 7;
    json::write(&place.scene(), &scene).unwrap();
    prompts(&dir, "").says(1, &["L4D112"]);
    assert_eq!(server.count(), 0);
    dir.run("propose-prompts --profile tiny").says(2, &["--endpoint"]);
}
