//! `l4d score --protocol`: numbers of other evaluations in tables and files of their own.

use serde_json::Value;

use crate::support::Dir;

const PROTOCOLS: [&str; 5] = ["langsplat", "4d-langsplat", "davis", "mevis", "gaussian-grouping"];

fn baselines() -> Dir {
    let dir = Dir::with_benchmark();
    dir.succeed(&["baseline", "oracle", "none", "time-agnostic", "--profile", "tiny"]);
    dir
}

fn judge(dir: &Dir, protocol: &str) -> Value {
    dir.json(&["score", "--profile", "tiny", "--protocol", protocol])
}

fn measures<'a>(judged: &'a Value, method: &str) -> &'a serde_json::Map<String, Value> {
    let methods = judged["methods"].as_array().unwrap();
    methods.iter().find(|one| one["name"] == method).unwrap()["measures"].as_object().unwrap()
}

#[test]
fn the_truth_is_right_and_silence_wrong_under_every_protocol() {
    let dir = baselines();
    for protocol in PROTOCOLS {
        let judged = judge(&dir, protocol);
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
            let is_bounded = matches!((protocol, measure.as_str()), ("davis" | "mevis", _) | (_, "acc"));
            assert!(value == 0.0 || (is_bounded && value < 100.0), "{protocol}, {measure}: {value}");
        }
    }
    // Blind to time: unseen by protocols that look at frames that show the target, seen by the others.
    let blind = |protocol: &str, measure: &str| {
        measures(&judge(&dir, protocol), "time-agnostic")[measure].as_f64().unwrap()
    };
    assert_eq!(blind("langsplat", "miou"), 100.0);
    assert!(blind("4d-langsplat", "acc") < 100.0 && blind("mevis", "j") < 100.0);
}

#[test]
fn a_protocol_has_a_table_and_files_of_its_own_and_is_not_ranked() {
    let dir = baselines();
    let run = dir.succeed(&["score", "--profile", "tiny", "--protocol", "davis"]);
    assert!(run.stdout.starts_with("protocol davis (DAVIS 2017"), "{}", run.stdout);
    assert!(run.stdout.contains("never ranked") && run.stdout.contains("J&F"), "{}", run.stdout);
    assert!(run.stdout.contains("every method: 12 frames of 6 queries are first or last"), "{}", run.stdout);
    assert!(dir.read("scores-davis/oracle/protocol-davis.csv").starts_with("protocol,scene,query,j_and_f"));
    let kept: Value = serde_json::from_str(&dir.read("scores-davis/oracle/protocol-davis.json")).unwrap();
    assert_eq!(kept["protocol"], "davis");
    assert!(!dir.path("scores").exists(), "a protocol wrote scores of ours");
    let board = dir.run(&["leaderboard", "scores-davis", "--profile", "tiny"]);
    assert!(board.stderr.contains("there is no scored method"), "{}", board.stderr);
    assert!(board.stderr.contains("what `--protocol` wrote is never ranked"), "{}", board.stderr);
    assert!(!dir.path("leaderboard/leaderboard.csv").exists(), "a protocol was ranked");
}

#[test]
fn holes_are_refused_only_where_the_source_would_stop() {
    let dir = baselines();
    std::fs::remove_file(dir.path("results/oracle/masks/room_discs/001.json")).unwrap();
    let score = |protocol: &str, more: &[&str]| {
        dir.run(&[&["score", "results/oracle", "--profile", "tiny", "--protocol", protocol], more].concat())
    };
    for protocol in ["langsplat", "4d-langsplat", "davis"] {
        let refused = score(protocol, &[]);
        assert!(refused.code == 1 && refused.stdout.contains("L4D308"), "{protocol}: {}", refused.stdout);
        let counted = score(protocol, &["--missing", "zero"]);
        assert!(counted.code == 0 && counted.stdout.contains("count as empty"), "{}", counted.stdout);
        let partial = score(protocol, &["--missing", "skip"]);
        assert!(partial.stdout.contains(" partial\n"), "{}", partial.stdout);
    }
    for (protocol, told) in [("mevis", "lost silently"), ("gaussian-grouping", "skipped silently")] {
        let run = score(protocol, &[]);
        assert!(run.code == 0 && run.stdout.contains(told), "{protocol}: {}", run.stdout);
        let refused = score(protocol, &["--missing", "zero"]);
        assert!(refused.code == 2 && refused.stderr.contains("--missing"), "{}", refused.stderr);
    }
}

#[test]
fn unknown_protocols_and_options_of_ours_are_refused() {
    let dir = baselines();
    let unknown = dir.run(&["score", "--profile", "tiny", "--protocol", "coco"]);
    assert!(unknown.code == 2 && unknown.stderr.contains("gaussian-grouping, l4d"), "{}", unknown.stderr);
    let hit = dir.run(&["score", "--profile", "tiny", "--protocol", "davis", "--hit-iou", "0.5"]);
    assert!(hit.code == 2 && hit.stderr.contains("--hit-iou"), "{}", hit.stderr);
    let ours = dir.json(&["score", "--profile", "tiny", "--protocol", "l4d"]);
    assert_eq!(ours["protocol"], "l4d");
    assert!(dir.path("scores/oracle/counts.csv").exists());
}
