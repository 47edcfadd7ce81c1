//! `l4d score --protocol`: numbers of other evaluations in tables and files of their own.

use std::sync::LazyLock;

use l4d_data::query::text_digest;
use l4d_score::Protocol;
use serde_json::{Map, Value};

use crate::support::{Dir, named};

fn baselines() -> Dir {
    static BASELINES: LazyLock<Dir> = LazyLock::new(|| {
        let dir = Dir::with_baselines();
        for unused in ["all", "random-look-alike", "look-alike-union"] {
            dir.remove(&format!("results/{unused}"));
        }
        dir
    });
    BASELINES.copy()
}

fn measures<'a>(judged: &'a Value, method: &str) -> &'a Map<String, Value> {
    named(&judged["methods"], method)["measures"].as_object().unwrap()
}

#[test]
fn the_truth_is_right_and_silence_wrong_under_every_protocol() {
    let dir = baselines();
    // SA-Co needs sentences that nothing satisfies, which these baselines do not answer.
    for protocol in
        Protocol::ALL.into_iter().filter(|protocol| *protocol != Protocol::Saco).map(Protocol::as_str)
    {
        let judged = dir.json(format!("score --profile tiny --protocol {protocol}"));
        assert_eq!((&judged["protocol"], &judged["is_headline"]), (&protocol.into(), &false.into()));
        for (measure, value) in measures(&judged, "oracle") {
            let expected: Value = match measure.as_str() {
                "localisation" => Value::Null,
                "j_decay" | "f_decay" => 0.0.into(),
                _ => 100.0.into(),
            };
            assert_eq!(value, &expected, "{protocol}, {measure}");
        }
        let silent = measures(&judged, "none").iter().filter(|(measure, _)| !measure.ends_with("decay"));
        for (measure, value) in silent {
            let value = value.as_f64().unwrap_or(0.0);
            // Where nothing is to be found, silence is right under some rules.
            let is_bounded =
                matches!((protocol, measure.as_str()), ("davis" | "mevis" | "votsr", _) | (_, "acc"));
            assert!(value == 0.0 || (is_bounded && value < 100.0), "{protocol}, {measure}: {value}");
        }
        // Blind to time: unseen by protocols that look at frames that show the target, seen by the others.
        let blind = |measure: &str| measures(&judged, "time-agnostic")[measure].as_f64().unwrap();
        match protocol {
            "langsplat" => assert_eq!(blind("miou"), 100.0),
            "4d-langsplat" => assert!(blind("acc") < 100.0),
            "mevis" => assert!(blind("j") < 100.0),
            _ => {}
        }
    }
}

#[test]
fn a_protocol_has_a_table_and_files_of_its_own_and_is_not_ranked() {
    let dir = baselines();
    let run = dir.succeed("score --profile tiny --protocol davis");
    assert!(run.stdout.starts_with("protocol davis (DAVIS 2017"), "{run}");
    run.says(0, &["never ranked", "J&F", "every method: 12 frames of 6 queries are first or last"]);
    assert!(dir.read("scores-davis/oracle/protocol-davis.csv").starts_with("protocol,scene,query,j_and_f"));
    assert_eq!(dir.value("scores-davis/oracle/protocol-davis.json")["protocol"], "davis");
    assert!(!dir.path("scores").exists(), "a protocol wrote scores of ours");
    let board = "leaderboard scores-davis --profile tiny";
    dir.refuses(board, &["there is no scored method", "what `--protocol` wrote is never ranked"]);
    assert!(!dir.path("leaderboard/leaderboard.csv").exists(), "a protocol was ranked");
}

#[test]
fn holes_are_refused_only_where_the_source_would_stop() {
    let dir = baselines();
    dir.remove("results/oracle/masks/room_discs/001.json");
    let score = |protocol: &str, more: &str| {
        dir.run(format!("score results/oracle --profile tiny --protocol {protocol} {more}"))
    };
    for protocol in ["langsplat", "4d-langsplat", "davis"] {
        score(protocol, "").says(1, &["L4D308"]);
        score(protocol, "--missing zero").says(0, &["count as empty"]);
        score(protocol, "--missing skip").says(0, &[" partial\n"]);
    }
    for (protocol, what) in [("mevis", "lost silently"), ("gaussian-grouping", "skipped silently")] {
        score(protocol, "").says(0, &[what]);
        score(protocol, "--missing zero").says(2, &["--missing"]);
    }
}

#[test]
fn saco_asks_for_absent_sentences_too() {
    let dir = baselines();
    let line = r#"{"id":"room_discs/900","text":"the green disc","categories":["attribute"],"referents":[],"temporal":"whole",
        "frames":[[0,96]],"predicate":null,"text_digest":null,"provenance":{"source":"author"},"status":"candidate"}"#;
    let mut absent: Value = serde_json::from_str(line).unwrap();
    absent["text_digest"] = text_digest("the green disc", None).into();
    dir.write("benchmark/queries/room_discs.absent.jsonl", absent.to_string());
    let score = "score results/oracle --profile tiny --protocol saco";
    dir.run(score).says(1, &["L4D308", "900"]);
    let frames: Map<String, Value> = (0..9).map(|n| (format!("{:04}", 12 * n), Value::Null)).collect();
    let answer = serde_json::json!({"size": [96, 128], "frames": frames});
    dir.write("results/oracle/masks/room_discs/900.json", answer.to_string());
    let judged = dir.json(score);
    assert_eq!(judged["set"], "with-absents");
    let near = |measure: &str| (measures(&judged, "oracle")[measure].as_f64().unwrap() - 100.0).abs() < 0.1;
    assert!(["cgf1", "pmf1", "il_mcc", "n_acc"].into_iter().all(near), "{judged}");
}

#[test]
fn unknown_protocols_and_options_of_ours_are_refused() {
    let dir = baselines();
    dir.run("score --profile tiny --protocol coco").says(2, &["l4d, langsplat, 4d-langsplat"]);
    dir.run("score --profile tiny --protocol davis --hit-iou 0.5").says(2, &["--hit-iou"]);
    assert_eq!(dir.json("score --profile tiny --protocol l4d")["protocol"], "l4d");
    assert!(dir.path("scores/oracle/counts.csv").exists());
}
