//! `l4d propose-prompts` and `l4d propose-scenes`: against a scripted server, and (slow) against a real one with
//! a tiny random model.

#[path = "../crates/l4d-endpoint/tests/scripted/mod.rs"]
pub(crate) mod scripted;

mod answers;
mod running;
mod scenarios;
mod stage;

use serde_json::json;

use self::scripted::{Seen, Server, says, thinks};
use self::stage::{CATS, CUPS, answer, endpoint, prompts, proposal, stage};
use crate::endpoint::Process;
use crate::support::Dir;

/// Proposals from what [`taped_prompts`] and [`taped_scenes`] recorded.
pub(crate) const PROMPTS_AGAIN: &str = "propose-prompts --profile tiny --endpoint endpoint.toml --frames 2 \
     --view-count 0 --link replay:tape --out proposals";
pub(crate) const SCENES_AGAIN: &str =
    "propose-scenes --endpoint endpoint.toml --scales room --link replay:tape --out scenarios";

/// A folder with the recorded answers of a model that was asked for prompts.
pub(crate) fn taped_prompts() -> Dir {
    let (dir, left_out) = stage(&[CUPS, CATS]);
    let [cups, cats] = [0, 2].map(|index| answer(&[proposal(&dir, &left_out[index])]));
    let reply = thinks(move |seen: &Seen| says(if seen.body.contains("keyboard") { &cups } else { &cats }));
    taped(dir, reply, PROMPTS_AGAIN)
}

/// The same of one that was asked for scenes.
pub(crate) fn taped_scenes() -> Dir {
    let (dir, _) = stage(&[CUPS]);
    let reply = says(&json!({ "scenarios": [scenarios::bakery()] }).to_string());
    taped(dir, reply, SCENES_AGAIN)
}

fn taped(dir: Dir, reply: scripted::Turn, line: &str) -> Dir {
    let server = Server::start(vec![reply]);
    endpoint(&dir, &server, "");
    let run = dir.run(line.replace("replay", "record"));
    assert!(run.code < 2, "{run}");
    for left in ["proposals", "scenarios", "work"] {
        if dir.path(left).exists() {
            dir.remove(left);
        }
    }
    dir
}

/// Random weights answer garbage: all of it is kept with its reasons, and nothing breaks.
#[test]
#[ignore = "slow: makes a Python environment with a model server"]
fn a_real_server_with_random_weights() {
    let server = Process::with_grammar();
    let (dir, _) = stage(&[CUPS, CATS]);
    let before = dir.tree("benchmark");
    dir.write("endpoint.toml", format!("base_url = \"{}\"\nmodel = \"tiny\"\n", server.base_url));
    for repeat in ["0", "1", "2", "3", "4"] {
        let out = format!("proposals-{repeat}");
        let more = format!("--json --repeat {repeat} --answer-tokens 1500 --out {out} --jobs 2");
        let report = prompts(&dir, &more).value();
        for scene in report["scenes"].as_array().unwrap() {
            assert_eq!(scene["answer"], "server", "{report}");
            let [proposed, candidates, unproved, failed] =
                ["proposed", "candidates", "unproved", "failed"].map(|count| scene[count].as_u64().unwrap());
            assert_eq!(proposed, candidates + unproved + failed);
            let name = scene["scene"].as_str().unwrap();
            let lines = |ending: &str| dir.lines(&format!("{out}/{name}{ending}")).len() as u64;
            assert_eq!((lines(".jsonl"), lines(".unproved.jsonl")), (candidates, unproved));
            let unread = report["findings"].as_array().unwrap().iter().filter(|finding| {
                finding["code"] == "L4D560" && finding["where"].as_str().unwrap().contains(name)
            });
            assert_eq!(lines(".failed.jsonl"), failed + unread.count() as u64, "{report}");
            let failed = dir.lines(&format!("{out}/{name}.failed.jsonl"));
            assert!(failed.iter().all(|failed| failed["reasons"] != json!([])));
        }
    }
    assert_eq!(dir.tree("benchmark"), before);
}
