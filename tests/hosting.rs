//! Forms of hosting platforms: their structure as the platforms document it, and their scoring programs, run on small
//! submissions and compared with `l4d score`.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};

use crate::python::write_site;
use crate::support::{Dir, SCENES};

const SEASON: [&str; 6] = ["--date", "2026-11-22", "--url", "https://example.org/discs", "--wheel", "wheels"];
const WHEEL: &str = concat!("l4d-", env!("CARGO_PKG_VERSION"), "-cp39-abi3-manylinux_2_34_x86_64.whl");

/// A benchmark of discs whose statuses are what no votes give: candidates. Tracks are borrowed, none of them is judged.
fn bench() -> Dir {
    let dir = Dir::with_benchmark();
    for (scene, _) in SCENES {
        let queries = format!("benchmark/queries/{scene}.jsonl");
        dir.write(
            &queries,
            dir.read(&queries).replace("verified", "candidate").replace("rejected", "candidate"),
        );
        let tracks = crate::support::root().join("benchmark/scenes/tabletop_tea.json");
        let tracks = std::fs::read_to_string(tracks).unwrap();
        dir.write(&format!("benchmark/scenes/{scene}.json"), tracks.replacen("tabletop_tea", scene, 1));
    }
    // Never installed: `python` finds the package that cargo built.
    dir.write(&format!("wheels/{WHEEL}"), "no wheel");
    dir
}

fn host(dir: &Dir, platform: &str, more: &[&str]) {
    dir.succeed(&[&["host", platform, "--profile", "tiny"], more].concat());
}

/// Makes the bundle of a competition, and the package that its scoring program imports.
fn compete(dir: &Dir, more: &[&str]) {
    write_site(&dir.path("site"));
    host(dir, "codabench", &[&SEASON[..], more].concat());
}

fn yaml(dir: &Dir, file: &str) -> Value {
    serde_yaml_ng::from_str(&dir.read(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn python(dir: &Dir, arguments: &[&str]) -> Output {
    let mut command = Command::new("python3");
    command.env("PYTHONPATH", dir.path("site")).env("PYTHONDONTWRITEBYTECODE", "1");
    command.args(arguments).current_dir(dir.path("")).output().unwrap()
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Scores a submission as Codabench's worker does: the command of `metadata.yaml`, its folders put in place.
fn score(dir: &Dir, submission: &str) -> Output {
    let metadata = yaml(dir, "hosting/codabench/scoring_program/metadata.yaml");
    let command = metadata["command"].as_str().unwrap().to_owned();
    let command = command
        .replace("/app/program", "hosting/codabench/scoring_program")
        .replace("/app/input/ref", "hosting/codabench/reference_data")
        .replace("/app/input/res", submission)
        .replace("/app/output", "output");
    let words: Vec<&str> = command.split(' ').collect();
    assert_eq!(words[0], "python3");
    python(dir, &words[1..])
}

/// The masks of a baseline as a method of their own would submit them: the numbers are what is compared.
fn submission(dir: &Dir, baseline: &str) -> String {
    let method = format!("like-{baseline}");
    std::fs::rename(dir.path(format!("results/{baseline}")), dir.path(format!("results/{method}"))).unwrap();
    let card = format!("results/{method}/method.json");
    let text = dir.read(&card).replace("\"ground_truth\": true", "\"ground_truth\": false");
    dir.write(
        &card,
        text.replace("  \"baseline\": true,\n", "")
            .replace(&format!("\"{baseline}\""), &format!("\"{method}\"")),
    );
    format!("results/{method}")
}

#[test]
fn the_program_of_codabench_says_what_l4d_says() {
    let dir = bench();
    compete(&dir, &[]);
    dir.succeed(&["baseline", "--profile", "tiny"]);
    dir.succeed(&["score", "--profile", "tiny"]);
    for baseline in ["oracle", "none", "all", "time-agnostic", "random-look-alike", "look-alike-union"] {
        // By its word, and by its name alone as in cards of before there was the word.
        let refused = || {
            let run = score(&dir, &format!("results/{baseline}"));
            let said = String::from_utf8_lossy(&run.stderr).into_owned();
            assert!(run.status.code() == Some(1) && said.contains("not ranked"), "{baseline}: {said}");
        };
        refused();
        let card = format!("results/{baseline}/method.json");
        dir.edit(&card, "  \"baseline\": true,\n", "");
        refused();
        let run = score(&dir, &submission(&dir, baseline));
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        assert_eq!(
            dir.read("output/counts.csv"),
            dir.read(&format!("scores/{baseline}/counts.csv")),
            "{baseline}"
        );
        let said: Value = serde_json::from_str(&dir.read("output/scores.json")).unwrap();
        let summary: Value =
            serde_json::from_str(&dir.read(&format!("scores/{baseline}/summary.json"))).unwrap();
        let same = |key: &str, ours: &Value| {
            let (theirs, ours) = (said[key].as_f64().unwrap(), ours.as_f64().unwrap_or(0.0));
            assert!((theirs - ours).abs() < 1e-9, "{baseline} {key}: {theirs} instead of {ours}");
        };
        for (key, field) in [
            ("fpr", "false_positive_rate"),
            ("miou", "miou"),
            ("macc", "macc"),
            ("acc25", "acc25"),
            ("acc50", "acc50"),
            ("tube_iou", "tube_iou"),
            ("select", "select"),
        ] {
            same(key, &summary[field]);
        }
        for group in ["categories", "scales"] {
            for (name, metrics) in summary[group].as_object().unwrap() {
                same(&format!("miou_{name}"), &metrics["miou"]);
            }
        }
    }
}

#[test]
fn a_bundle_of_codabench_has_what_the_platform_reads() {
    let dir = bench();
    compete(&dir, &["--until", "2027-01-31"]);
    let root = dir.path("hosting/codabench");
    let document = yaml(&dir, "hosting/codabench/competition.yaml");
    assert_eq!(document["version"], 2);
    assert!(document["title"].is_string());
    for file in [
        &document["image"],
        &document["terms"],
        &document["tasks"][0]["scoring_program"],
        &document["tasks"][0]["reference_data"],
        &document["phases"][0]["starting_kit"],
    ] {
        assert!(root.join(file.as_str().unwrap()).exists(), "{file}");
    }
    for page in document["pages"].as_array().unwrap() {
        assert!(
            page["title"].is_string()
                && root.join(page["file"].as_str().unwrap()).metadata().unwrap().len() > 0
        );
    }
    let phase = &document["phases"][0];
    assert_eq!(
        (&phase["start"], &phase["end"]),
        (&json!("2026-11-22 00:00:00"), &json!("2027-01-31 23:59:59"))
    );
    assert_eq!(phase["tasks"], json!([0]));
    // Every column is a key that the program writes: here of the submission in the starting kit, which finds nothing.
    let run = score(&dir, "hosting/codabench/starting_kit/submission.zip");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let scores: Value = serde_json::from_str(&dir.read("output/scores.json")).unwrap();
    let columns = document["leaderboards"][0]["columns"].as_array().unwrap();
    for (index, column) in columns.iter().enumerate() {
        assert_eq!(column["index"], index);
        assert!(scores[column["key"].as_str().unwrap()].is_number(), "{column}");
        assert!(["asc", "desc"].contains(&column["sorting"].as_str().unwrap()));
    }
    assert_eq!((scores["miou"].as_f64(), scores["queries"].as_u64()), (Some(0.0), Some(10)));
    // The archive holds the same files, readable by others.
    let listed = python(&dir, &["-m", "zipfile", "--test", "hosting/codabench/bundle.zip"]);
    assert!(listed.status.success());
    let script = "import sys,zipfile; print(*sorted(zipfile.ZipFile(sys.argv[1]).namelist()), sep='\\n')";
    let names =
        String::from_utf8(python(&dir, &["-c", script, "hosting/codabench/bundle.zip"]).stdout).unwrap();
    for name in [
        "competition.yaml",
        "logo.png",
        "scoring_program/score.py",
        &format!("scoring_program/{WHEEL}"),
        "reference_data/competition.json",
        "reference_data/benchmark/truth/tiny/room_discs.json",
    ] {
        assert!(names.lines().any(|line| line == name), "{name}\n{names}");
    }
}

#[test]
fn a_competition_is_of_one_track() {
    let dir = bench();
    compete(&dir, &["--track", "colour+depth"]);
    let run = score(&dir, "hosting/codabench/starting_kit/submission.zip");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let document = yaml(&dir, "hosting/codabench/competition.yaml");
    assert!(document["title"].as_str().unwrap().ends_with("track colour + depth"), "{document}");
    assert!(dir.read("hosting/codabench/pages/evaluation.md").contains("of the track colour + depth:"));
    dir.succeed(&["baseline", "all", "--profile", "tiny"]);
    let folder = submission(&dir, "all");
    let said = |run: Output| String::from_utf8_lossy(&run.stderr).into_owned();
    let run = score(&dir, &folder);
    assert!(run.status.code() == Some(1) && said(run).contains("did not learn from rendered depth"));
    dir.edit(&format!("{folder}/method.json"), "\"depth\": false", "\"depth\": true");
    assert!(score(&dir, &folder).status.success());
}

#[test]
fn hostile_submissions_are_refused_in_words() {
    let dir = bench();
    compete(&dir, &[]);
    dir.succeed(&["baseline", "all", "oracle", "--profile", "tiny"]);
    submission(&dir, "all");
    let mask = "results/like-all/masks/room_discs/001.json";
    let card = "results/like-all/method.json";
    let (sound_mask, sound_card) = (dir.read(mask), dir.read(card));
    let refused = |words: &[&str]| {
        let run = score(&dir, "results/like-all");
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(1), "{said}");
        for word in words {
            assert!(said.contains(word), "{word}: {said}");
        }
        assert!(!said.contains("Traceback") && !dir.path("output").exists(), "{said}");
    };
    for (from, to, word) in [
        ("[96,128]", "[96,129]", "96"),
        ("\"0012\"", "\"0013\"", "0013"),
        ("\"0012\"", "\"../0012\"", "../0012"),
        ("\"0000\":\"", "\"0000\":\"~~~~~~~~~~~~~~~~", "0000"),
        ("\"0000\":\"", "\"0000\":\"5", "12288"),
        ("\"size\":", "\"size\":NaN,\"sise\":", "size"),
        ("[96,128]", "[96,111111111111111111111]", "size"),
        ("{", "[[[[", "L4D"),
    ] {
        let text = sound_mask.replace([' ', '\n'], "");
        assert!(text.contains(from), "{from} {text}");
        dir.write(mask, text.replacen(from, to, 1));
        refused(&["masks/room_discs/001.json", word]);
    }
    dir.write(mask, "[".repeat(200_000));
    refused(&["masks/room_discs/001.json"]);
    std::fs::remove_file(dir.path(mask)).unwrap();
    let second = "results/like-all/masks/room_discs/002.json";
    let sound_second = dir.read(second);
    std::fs::remove_file(dir.path(second)).unwrap();
    refused(&["room_discs/001", "room_discs/002"]);
    // Everything that is wrong is said at once.
    dir.edit(card, "\"tiny\"", "\"small\"");
    dir.edit(card, "\"l4d\"", "\"davis\"");
    refused(&["field `profile`", "field `protocol`", "room_discs/001", "room_discs/002"]);
    dir.write(card, &sound_card);
    dir.write(second, &sound_second);
    // A link could lead to the truth.
    std::os::unix::fs::symlink(dir.path("results/oracle/masks/room_discs/001.json"), dir.path(mask)).unwrap();
    refused(&["001.json", "link"]);
    std::fs::remove_file(dir.path(mask)).unwrap();
    dir.write(mask, &sound_mask);
    for (from, to, word) in [
        ("\"tiny\"", "\"small\"", "profile"),
        ("\"0.1.0\",\n  \"truth", "\"9.9.9\",\n  \"truth", "9.9.9"),
        ("\"ground_truth\": false", "\"ground_truth\": true", "ground truth"),
        ("\"seconds\"", "\"baseline\": true, \"seconds\"", "baselines are not ranked"),
        ("\"depth\": false", "\"depth\": true", "is ranked in another track"),
        ("\"depth\": false", "\"depth\": 1", "depth"),
    ] {
        assert!(sound_card.contains(from), "{from} {sound_card}");
        dir.write(card, sound_card.replacen(from, to, 1));
        refused(&["method.json", word]);
    }
    dir.write(card, &sound_card);
    // Archives that are none, that lie, or that climb.
    dir.write("torn.zip", "PK\u{3}\u{4}nothing");
    let script = "import zipfile
with zipfile.ZipFile('climbing.zip', 'w') as archive:
    archive.writestr('../../method.json', '{}')
with zipfile.ZipFile('bomb.zip', 'w', zipfile.ZIP_DEFLATED) as archive:
    archive.writestr('method.json', b' ' * (70 << 20))
with zipfile.ZipFile('lzma.zip', 'w', zipfile.ZIP_LZMA) as archive:
    archive.write('results/like-all/method.json', 'method.json')
with zipfile.ZipFile('many.zip', 'w') as archive:
    [archive.writestr('m/%d' % number, b'') for number in range(20001)]
with zipfile.ZipFile('twice.zip', 'w') as archive:
    [archive.write('results/like-all/method.json', 'method.json') for _ in range(2)]
with zipfile.ZipFile('list.zip', 'w') as archive:
    for number in range(200):
        entry = zipfile.ZipInfo('m/%d' % number)
        entry.comment = b' ' * 50000
        archive.writestr(entry, b'')";
    assert!(python(&dir, &["-c", script]).status.success());
    for (archive, word) in [
        ("torn.zip", "cannot be read"),
        ("climbing.zip", "no path below the archive"),
        ("bomb.zip", "larger than"),
        ("lzma.zip", "stored or deflated"),
        ("many.zip", "more than 20000"),
        ("twice.zip", "is in the archive twice"),
        ("list.zip", "list of files"),
    ] {
        let run = score(&dir, archive);
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(
            run.status.code() == Some(1) && said.contains(word) && !said.contains("Traceback"),
            "{archive}: {said}"
        );
    }
}

#[test]
fn the_hub_gets_tasks_a_leaderboard_and_results() {
    let dir = bench();
    dir.succeed(&["baseline", "--profile", "tiny"]);
    let card = format!("{}/method.json", submission(&dir, "all"));
    dir.edit(&card, "\"link\": \"\"", "\"link\": \"https://example.org/a: \\\"b\\\"\"");
    let deep = submission(&dir, "oracle");
    dir.edit(&format!("{deep}/method.json"), "\"depth\": false", "\"depth\": true");
    dir.succeed(&["baseline", "all", "oracle", "--profile", "tiny"]);
    dir.succeed(&["score", "--profile", "tiny"]);
    host(&dir, "huggingface", &["--dataset", "lab/discs"]);
    let root = "hosting/huggingface";
    let tasks = yaml(&dir, &format!("{root}/dataset/eval.yaml"));
    assert_eq!(keys(&tasks), BTreeSet::from(["name", "description", "evaluation_framework", "tasks"]));
    let task = &tasks["tasks"][0]["id"];

    let results = yaml(&dir, &format!("{root}/methods/like-all/.eval_results/discs-tiny.yaml"));
    assert_eq!(
        (&results[0]["dataset"]["id"], &results[0]["dataset"]["task_id"]),
        (&json!("lab/discs"), task)
    );
    assert_eq!(results[0]["source"]["url"], "https://example.org/a: \"b\"");
    let summary: Value = serde_json::from_str(&dir.read("scores/like-all/summary.json")).unwrap();
    assert_eq!(results[0]["value"], summary["miou"]);

    let card = dir.read(&format!("{root}/methods/like-all/README.md"));
    let front: Value = serde_yaml_ng::from_str(card.split("---\n").nth(1).unwrap()).unwrap();
    let entry = &front["model-index"][0]["results"][0];
    assert!(entry["task"]["type"].is_string() && entry["dataset"]["name"].is_string());
    assert_eq!(entry["dataset"]["type"], "lab/discs");
    assert_eq!(
        (&entry["metrics"][0]["type"], &entry["metrics"][0]["value"]),
        (&json!("miou"), &summary["miou"])
    );

    // The leaderboard has all methods; baselines and those that looked at the truth have no rank and no card.
    let rows = dir.read(&format!("{root}/leaderboard/leaderboard.jsonl"));
    let rows: Vec<Value> = rows.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(rows.len(), 8);
    let ranked: Vec<Value> = rows
        .iter()
        .filter(|row| row["rank"].is_u64())
        .map(|row| json!([row["track"], row["rank"], row["method"]]))
        .collect();
    assert_eq!(ranked, [json!(["colour", 1, "like-all"]), json!(["colour+depth", 1, "like-oracle"])]);
    let page = dir.read(&format!("{root}/leaderboard/README.md"));
    let (colour, depth) = page.split_once("## Track: colour + depth").unwrap();
    assert!(
        colour.contains("\n\n## Track: colour\n\n| rank |") && colour.contains("| 1 | like-all |"),
        "{page}"
    );
    assert!(
        depth.contains("| 1 | like-oracle |") && depth.contains("\n\n## Not ranked\n\n| rank |"),
        "{page}"
    );
    // Its result is of a task of its own, since the Hub ranks all results of a task.
    let results = yaml(&dir, &format!("{root}/methods/like-oracle/.eval_results/discs-tiny-depth.yaml"));
    assert_eq!(results[0]["dataset"]["task_id"], tasks["tasks"][1]["id"]);
    let none = rows.iter().find(|row| row["method"] == "none").unwrap();
    assert_eq!(none["unranked_because"], "baseline");
    let csv = dir.read(&format!("{root}/leaderboard/leaderboard.csv"));
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    assert_eq!(header.into_iter().collect::<BTreeSet<_>>(), keys(&rows[0]));
    assert!(csv.contains("\"https://example.org/a: \"\"b\"\"\""), "{csv}");
    for baseline in ["oracle", "all", "none"] {
        assert!(!dir.path(format!("{root}/methods/{baseline}")).exists(), "{baseline}");
    }
    dir.succeed(&["score", "--profile", "tiny", "--scores", "elsewhere"]);
    dir.edit("benchmark/panoptic-l4d.toml", "0.1.0", "0.2.0");
    let run = dir.run(&[
        "host",
        "huggingface",
        "elsewhere",
        "--dataset",
        "lab/discs",
        "--profile",
        "tiny",
        "--out",
        "x",
    ]);
    assert!(
        run.code == 2 && run.stderr.contains("summary.json") && run.stderr.contains("hint:"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_folder_of_something_else_is_not_mixed_in() {
    let dir = bench();
    host(&dir, "codabench", &SEASON);
    let before = std::fs::read(dir.path("hosting/codabench/bundle.zip")).unwrap();
    host(&dir, "codabench", &SEASON);
    assert_eq!(std::fs::read(dir.path("hosting/codabench/bundle.zip")).unwrap(), before, "the same bytes");
    dir.write("hosting/codabench/reference_data/truth/old_scene.json", "{}");
    let arguments = [&["host", "codabench", "--profile", "tiny"][..], &SEASON].concat();
    let run = dir.run(&arguments);
    assert!(run.code == 2 && run.stderr.contains("old_scene.json"), "{}", run.stderr);
    std::fs::remove_file(dir.path(format!("wheels/{WHEEL}"))).unwrap();
    let run = dir.run(&[&arguments[..], &["--out", "other"]].concat());
    assert!(
        run.code == 2 && run.stderr.contains("--wheel") && run.stderr.contains("maturin build"),
        "{}",
        run.stderr
    );
    dir.write(&format!("wheels/{WHEEL}"), "no wheel");
    // A query is verified by votes alone.
    dir.edit("benchmark/queries/room_discs.jsonl", "candidate", "verified");
    let run = dir.run(&[&arguments[..], &["--out", "other"]].concat());
    assert!(
        run.code == 1 && run.stdout.contains("L4D602") && !Path::new(&dir.path("other")).exists(),
        "{}",
        run.stdout
    );
    for wrong in [["--until", "2026-11-21"], ["--url", "here"], ["--date", "today"]] {
        let arguments = ["host", "codabench", "--profile", "tiny"];
        let mut season: Vec<&str> = SEASON.to_vec();
        match season.iter().position(|word| *word == wrong[0]) {
            Some(place) => season[place + 1] = wrong[1],
            None => season.extend(wrong),
        }
        assert_eq!(dir.run(&[&arguments[..], &season].concat()).code, 2, "{wrong:?}");
    }
}
