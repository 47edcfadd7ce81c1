//! `l4d propose-scenes`.

use serde_json::{Value, json};

use super::scripted::{Seen, Server, says, thinks};
use super::stage::*;
use crate::support::root;

/// The example of the instructions: a scenario in which nothing is wrong.
fn bakery() -> Value {
    let brief = std::fs::read_to_string(root().join("crates/l4d-propose/briefs/scenarios.md")).unwrap();
    serde_json::from_str::<Value>(brief.lines().last().unwrap()).unwrap()["scenarios"][0].clone()
}

#[test]
fn scenarios_are_sorted_by_the_rules() {
    let (dir, _) = stage(&[CUPS]);
    let with = |pointer: &str, value: Value| {
        let mut scenario = bakery();
        *scenario.pointer_mut(pointer).unwrap() = value;
        scenario
    };
    let rooms = [
        bakery(),
        with("/name", json!("room_oven")),
        bakery(),
        with("/name", json!("../../room_escape")),
        with("/events/0/verb", json!("teleport")),
        with("/scale", json!("galaxy")),
    ];
    let rooms = json!({ "scenarios": rooms }).to_string();
    let reply = thinks(move |seen: &Seen| match seen.body.contains("scenes of scale room") {
        true => says(&rooms),
        false => says("I have no ideas today."),
    });
    let server = Server::start(vec![reply]);
    endpoint(&dir, &server, "");
    let scenes =
        |more: &[&str]| dir.run(&[&["propose-scenes", "--endpoint", "endpoint.toml"], more].concat());
    let plan = document(&scenes(&["--dry-run", "--json"]));
    assert_eq!((server.count(), &plan["total"]["questions"]), (0, &json!(3)));

    let run = scenes(&["--json"]);
    assert_eq!((run.code, server.count()), (1, 3), "{}", run.stderr);
    let report = document(&run);
    let room = report["scales"].as_array().unwrap().iter().find(|scale| scale["scale"] == "room").unwrap();
    assert_eq!(room["scenarios"], json!(["room_bakery", "room_oven"]));
    assert_eq!((&room["proposed"], &room["failed"]), (&json!(6), &json!(4)));
    let codes: Vec<&str> = report["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|finding| finding["code"].as_str().unwrap())
        .collect();
    assert_eq!(codes, ["L4D570", "L4D570"], "two scales without ideas");
    let written: Value = serde_json::from_str(&dir.read("work/scenarios/room_bakery.json")).unwrap();
    assert_eq!(
        (&written["schema"], &written["provenance"]["source"]),
        (&json!("l4d/scenario/1"), &json!("model"))
    );
    let failed = dir.read("work/scenarios/room.failed.jsonl");
    let reasons: Vec<Vec<String>> = failed
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap())
        .map(|failed| self::codes(&failed).into_iter().map(str::to_owned).collect())
        .collect();
    let expected: [&[&str]; 4] = [&["L4D572"], &["L4D572"], &["L4D574", "L4D572"], &["L4D571"]];
    assert_eq!(
        reasons, expected,
        "a name taken, a path, a verb unknown (and the name taken), a scale unknown"
    );
    assert!(server.seen()[0].body.contains(CUPS), "existing scenes are listed");

    let room_again = scenes(&["--scales", "room"]);
    assert_eq!((room_again.code, server.count()), (0, 3), "{}{}", room_again.stdout, room_again.stderr);
    assert!(room_again.stdout.contains("room_oven"));
    let unknown = scenes(&["--scales", "galaxy"]);
    assert!(unknown.code == 2 && unknown.stderr.contains("galaxy"), "{}", unknown.stderr);
}
