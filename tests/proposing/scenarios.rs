//! `l4d propose-scenes`.

use serde_json::{Value, json};

use super::scripted::{Seen, Server, says, thinks};
use super::stage::*;
use crate::support::{self, shipped};

/// The example of the instructions: a scenario in which nothing is wrong.
pub(super) fn bakery() -> Value {
    let brief = shipped("crates/l4d-propose/briefs/scenarios.md");
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
    let scenes = |more: &str| dir.run(format!("propose-scenes --endpoint endpoint.toml {more}"));
    let plan = scenes("--dry-run --json").value();
    assert_eq!((server.count(), &plan["total"]["questions"]), (0, &json!(3)));

    let run = scenes("--json");
    assert_eq!((run.code, server.count()), (1, 3), "{run}");
    let report = run.value();
    let room = report["scales"].as_array().unwrap().iter().find(|scale| scale["scale"] == "room").unwrap();
    assert_eq!(room["scenarios"], json!(["room_bakery", "room_oven"]));
    assert_eq!((&room["proposed"], &room["failed"]), (&json!(6), &json!(4)));
    assert_eq!(support::codes(&report), ["L4D570", "L4D570"], "two scales without ideas");
    let written = dir.value("work/scenarios/room_bakery.json");
    assert_eq!([&written["schema"], &written["provenance"]["source"]], ["l4d/scenario/1", "model"]);
    let failed = dir.lines("work/scenarios/room.failed.jsonl");
    let reasons: Vec<Vec<&str>> = failed.iter().map(codes).collect();
    // A name taken, a path, a verb unknown (and the name taken), a scale unknown.
    let expected: [&[&str]; 4] = [&["L4D572"], &["L4D572"], &["L4D574", "L4D572"], &["L4D571"]];
    assert_eq!(reasons, expected);
    assert!(server.seen()[0].body.contains(CUPS), "existing scenes are listed");

    scenes("--scales room").says(0, &["room_oven"]);
    assert_eq!(server.count(), 3);
    scenes("--scales galaxy").says(2, &["galaxy"]);
}
