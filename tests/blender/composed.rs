//! Scenes from seeds, from the draw to scores; what is left of verbs that draw, when they are killed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use serde_json::Value;

use crate::support::{Dir, Noise, Run, l4d, root, succeed};

fn compose(out: &Path, more: &str) -> Command {
    let mut command = l4d(&format!("compose {more} --out"));
    command.arg(out);
    command
}

fn json(command: &mut Command) -> Value {
    let run: Run = command.output().unwrap().into();
    assert_eq!(run.code, 0, "{run}");
    run.value()
}

fn sums(out: &Path) -> String {
    std::fs::read_to_string(out.join("SHA256SUMS")).unwrap()
}

#[test]
fn seeds_become_scenes_whose_queries_are_proved_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("set");
    let made = json(&mut compose(&set, "--seed 1001 --count 3 --jobs 2 --json"));
    let scales = made["scenes"].as_array().unwrap().iter().map(|scene| scene["scale"].as_str().unwrap());
    assert!(scales.eq(["tabletop", "outdoor", "room"]), "{made}");
    let bench = |verb: &str| {
        let mut command = l4d(&format!("{verb} --profile tiny --bench"));
        command.arg(&set);
        command
    };
    let checked = json(&mut bench("check-queries --json"));
    assert_eq!(checked["findings"], Value::Array(Vec::new()));
    let counts = checked["queries"].as_object().unwrap().values().map(|count| count.as_u64().unwrap());
    assert!(counts.sum::<u64>() >= 24, "{checked}");

    // Anyone who composes these seeds gets the bytes whose digests are shipped.
    let whole = sums(&set);
    let shipped = std::fs::read_to_string(root().join("benchmark/train/SHA256SUMS")).unwrap();
    let known: BTreeSet<&str> = shipped.lines().collect();
    let others: Vec<&str> = whole.lines().filter(|line| !known.contains(line)).collect();
    assert!(others.is_empty(), "{others:#?}");

    // A scene that is missing is drawn again, and ends with the same bytes.
    std::fs::remove_file(set.join("queries/tabletop_1001.jsonl")).unwrap();
    std::fs::remove_file(set.join("scenes/tabletop_1001.json")).unwrap();
    succeed(&mut compose(&set, "--seed 1001 --count 3"));
    assert_eq!(sums(&set), whole);
    // What was changed is reported; --force composes it again.
    let edited = set.join("queries/room_1003.jsonl");
    std::fs::write(&edited, "{}\n").unwrap();
    let run: Run = compose(&set, "--seed 1001 --count 3").output().unwrap().into();
    run.refused(&["queries/room_1003.jsonl", "--force"]);
    succeed(&mut compose(&set, "--seed 1001 --count 3 --force"));
    assert_eq!(sums(&set), whole);
    assert!(std::fs::read_to_string(&edited).unwrap().contains("room_1003/001"));
    // Another seed of the same name is none of this set.
    let run: Run = compose(&set, "--seed 1001 --theme no_theme").output().unwrap().into();
    run.refused(&["tabletop_1001.json", "another composition"]);

    let data = folder.path().join("data");
    let mut build = bench("build-scenes --samples 0 --scenes tabletop_1001");
    succeed(build.arg("--data").arg(&data));
    let mut check = bench("check-scenes --json --scenes tabletop_1001");
    assert_eq!(json(check.arg("--data").arg(&data))["findings"], Value::Array(Vec::new()));
    assert!(set.join("truth/tiny/tabletop_1001.json").is_file());
}

#[test]
fn a_scenario_is_composed_or_refused_with_the_words_that_exist() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scenario.json");
    let scenario = |noun: &str, verb: &str| {
        let text = format!(
            r#"{{"schema":"l4d/scenario/1","name":"tabletop_morning","scale":"tabletop","groups":[{{"category":"{noun}"}}],
                "events":[{{"subject":"hand","verb":"{verb}","object":"x","frames":[8,30]}}]}}"#
        );
        std::fs::write(&path, text).unwrap();
        let mut command = l4d("compose --json --spec");
        command.arg(&path).arg("--out").arg(folder.path().join("set"));
        command
    };
    let run: Run = scenario("unicorn", "lift").output().unwrap().into();
    run.refused(&["categories", "unicorn", "cup"]);
    let made = json(&mut scenario("cup", "lift"));
    assert_eq!(made["scenes"][0]["scene"], "tabletop_morning");
    let tracks = std::fs::read_to_string(folder.path().join("set/scenes/tabletop_morning.json")).unwrap();
    assert!(tracks.contains(r#""verb":"lift""#) && tracks.contains(r#""category":"cup""#));
}

/// Kills a verb that writes into a folder at random moments, and lets it end then: the same files as without a kill.
fn goes_on_after(kills: u32, verb: &str, line: impl Fn(&str) -> Command) {
    let (dir, mut noise) = (Dir::new(), Noise::new(7));
    let into = |name: &str| line(dir.path(name).to_str().unwrap());
    let begin = Instant::now();
    succeed(&mut into("calm"));
    let whole = begin.elapsed();
    for _ in 0..kills {
        let mut child = into("shaken").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(whole * noise.below(900) / 1000);
        child.kill().unwrap();
        child.wait().unwrap();
    }
    succeed(&mut into("shaken"));
    let [calm, shaken]: [BTreeMap<String, Vec<u8>>; 2] = ["calm", "shaken"].map(|name| dir.tree(name));
    let differing: Vec<&String> =
        calm.keys().chain(shaken.keys()).filter(|name| calm.get(*name) != shaken.get(*name)).collect();
    assert!(!calm.is_empty() && differing.is_empty(), "{verb}: {differing:?}");
}

#[test]
#[ignore = "slow: kills compose ten times"]
fn verbs_that_draw_scenes_go_on_after_ten_kills() {
    goes_on_after(10, "compose", |out| compose(Path::new(out), "--seed 1001 --count 2"));
}
