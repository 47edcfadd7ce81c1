//! `l4d propose-prompts` and `l4d propose-scenes`: against a scripted server, and (slow) against a real one with
//! a tiny random model.

#[path = "../crates/l4d-endpoint/tests/scripted/mod.rs"]
pub(crate) mod scripted;

mod answers;
mod running;
mod scenarios;
mod stage;

use serde_json::json;

use self::stage::{CATS, CUPS, prompts, stage};
use crate::endpoint::Process;

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
