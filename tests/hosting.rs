//! Forms of hosting platforms: their structure as the platforms document it, and their scoring programs, run on small
//! submissions and compared with `l4d score`.

use std::collections::BTreeSet;
use std::process::Command;

use serde_json::{Value, json};

use crate::python::write_site;
use crate::support::{Dir, Run, SCENES, shipped};

pub(crate) const HOST: &str =
    "host codabench --profile tiny --date 2026-11-22 --url https://example.org/discs --wheel wheels";
const WHEEL: &str = concat!("l4d-", env!("CARGO_PKG_VERSION"), "-cp39-abi3-manylinux_2_34_x86_64.whl");
/// The submission in the starting kit, which finds nothing.
const KIT: &str = "hosting/codabench/starting_kit/submission.zip";

/// A benchmark of discs whose statuses are what no votes give: candidates. Tracks are borrowed, none of them is judged.
pub(crate) fn bench() -> Dir {
    let dir = Dir::with_baselines();
    for (scene, _) in SCENES {
        let queries = format!("benchmark/queries/{scene}.jsonl");
        let text = dir.read(&queries).replace("verified", "candidate").replace("rejected", "candidate");
        dir.write(&queries, text);
        let tracks = shipped("benchmark/scenes/tabletop_tea.json");
        dir.write(&format!("benchmark/scenes/{scene}.json"), tracks.replacen("tabletop_tea", scene, 1));
    }
    // Never installed: `python` finds the package that cargo built.
    dir.write(&format!("wheels/{WHEEL}"), "no wheel");
    dir
}

/// Makes the bundle of a competition, and the package that its scoring program imports.
fn compete(more: &str) -> Dir {
    let dir = bench();
    write_site(&dir.path("site"));
    dir.succeed(format!("{HOST} {more}"));
    dir
}

fn yaml(text: &str) -> Value {
    serde_yaml_ng::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn python(dir: &Dir, arguments: &[&str]) -> Run {
    let mut command = Command::new("python3");
    command.env("PYTHONPATH", dir.path("site")).env("PYTHONDONTWRITEBYTECODE", "1");
    command.args(arguments).current_dir(dir.path("")).output().unwrap().into()
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Scores a submission as Codabench's worker does: the command of `metadata.yaml`, its folders put in place.
fn score(dir: &Dir, submission: &str) -> Run {
    let metadata = yaml(&dir.read("hosting/codabench/scoring_program/metadata.yaml"));
    let command = metadata["command"].as_str().unwrap().to_owned();
    let command = command
        .replace("/app/program", "hosting/codabench/scoring_program")
        .replace("/app/input/ref", "hosting/codabench/reference_data")
        .replace("/app/input/res", submission)
        .replace("/app/output", "output");
    python(dir, &command.strip_prefix("python3 ").unwrap().split(' ').collect::<Vec<_>>())
}

/// The masks of a baseline as a method of their own would submit them: the numbers are what is compared.
fn submission(dir: &Dir, baseline: &str) -> String {
    dir.contestant(baseline, &format!("like-{baseline}"));
    format!("results/like-{baseline}")
}

/// Demands that a submission is refused in words.
fn refused(dir: &Dir, submission: &str, parts: &[&str]) {
    let run = score(dir, submission);
    run.says(1, parts);
    assert!(!run.stderr.contains("Traceback") && !dir.path("output").exists(), "{submission}: {run}");
}

#[test]
fn the_program_of_codabench_says_what_l4d_says() {
    let dir = compete("");
    dir.succeed("score --profile tiny");
    // A baseline is known by its word, and by its name alone as in cards of before there was the word.
    score(&dir, "results/none").says(1, &["not ranked"]);
    dir.change("results/none/method.json", |card| drop(card.as_object_mut().unwrap().remove("baseline")));
    score(&dir, "results/none").says(1, &["not ranked"]);
    for baseline in ["oracle", "time-agnostic", "random-look-alike", "look-alike-union"] {
        score(&dir, &submission(&dir, baseline)).says(0, &[]);
        let counts = format!("scores/{baseline}/counts.csv");
        assert_eq!(dir.read("output/counts.csv"), dir.read(&counts), "{baseline}");
        let theirs = dir.value("output/scores.json");
        let summary = dir.value(&format!("scores/{baseline}/summary.json"));
        let same = |key: &str, ours: &Value| {
            let (theirs, ours) = (theirs[key].as_f64().unwrap(), ours.as_f64().unwrap_or(0.0));
            assert!((theirs - ours).abs() < 1e-9, "{baseline} {key}: {theirs} instead of {ours}");
        };
        same("fpr", &summary["false_positive_rate"]);
        for key in ["miou", "macc", "acc25", "acc50", "tube_iou", "select"] {
            same(key, &summary[key]);
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
    let dir = compete("--until 2027-01-31");
    let root = dir.path("hosting/codabench");
    let document = yaml(&dir.read("hosting/codabench/competition.yaml"));
    assert_eq!(document["version"], 2);
    assert!(document["title"].is_string());
    let (task, phase) = (&document["tasks"][0], &document["phases"][0]);
    let files = [&document["image"], &document["terms"], &task["scoring_program"], &task["reference_data"]];
    for file in files.into_iter().chain([&phase["starting_kit"]]) {
        assert!(root.join(file.as_str().unwrap()).exists(), "{file}");
    }
    for page in document["pages"].as_array().unwrap() {
        let file = root.join(page["file"].as_str().unwrap());
        assert!(page["title"].is_string() && file.metadata().unwrap().len() > 0);
    }
    assert_eq!([&phase["start"], &phase["end"]], ["2026-11-22 00:00:00", "2027-01-31 23:59:59"]);
    assert_eq!(phase["tasks"], json!([0]));
    // Every column is a key that the program writes.
    score(&dir, KIT).says(0, &[]);
    let scores = dir.value("output/scores.json");
    let columns = document["leaderboards"][0]["columns"].as_array().unwrap();
    for (index, column) in columns.iter().enumerate() {
        assert_eq!(column["index"], index);
        assert!(scores[column["key"].as_str().unwrap()].is_number(), "{column}");
        assert!(["asc", "desc"].contains(&column["sorting"].as_str().unwrap()));
    }
    assert_eq!((scores["miou"].as_f64(), scores["queries"].as_u64()), (Some(0.0), Some(10)));
    // The archive holds the same files, readable by others.
    python(&dir, &["-m", "zipfile", "--test", "hosting/codabench/bundle.zip"]).says(0, &[]);
    let script = "import sys,zipfile; print(*sorted(zipfile.ZipFile(sys.argv[1]).namelist()), sep='\\n')";
    let names = python(&dir, &["-c", script, "hosting/codabench/bundle.zip"]).stdout;
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
    let dir = compete("--track colour+depth");
    score(&dir, KIT).says(0, &[]);
    let document = yaml(&dir.read("hosting/codabench/competition.yaml"));
    assert!(document["title"].as_str().unwrap().ends_with("track colour + depth"), "{document}");
    assert!(dir.read("hosting/codabench/pages/evaluation.md").contains("of the track colour + depth:"));
    let folder = submission(&dir, "all");
    score(&dir, &folder).says(1, &["did not learn from rendered depth"]);
    dir.change(&format!("{folder}/method.json"), |card| card["used"]["depth"] = true.into());
    score(&dir, &folder).says(0, &[]);
}

#[test]
fn hostile_submissions_are_refused_in_words() {
    let dir = compete("");
    let folder = submission(&dir, "all");
    let mask = "results/like-all/masks/room_discs/001.json";
    let card = "results/like-all/method.json";
    let (sound_mask, sound_card) = (dir.read(mask), dir.read(card));
    // Findings of the check, in whatever form.
    for (from, to, word) in [
        ("\"0012\"", "\"../0012\"", "../0012"),
        ("\"size\":", "\"size\":NaN,\"sise\":", "size"),
        ("{", "[[[[", "L4D"),
    ] {
        dir.write(mask, sound_mask.replace([' ', '\n'], ""));
        dir.edit(mask, from, to);
        refused(&dir, &folder, &["masks/room_discs/001.json", word]);
    }
    dir.write(mask, "[".repeat(200_000));
    refused(&dir, &folder, &["masks/room_discs/001.json"]);
    dir.remove(mask);
    let second = "results/like-all/masks/room_discs/002.json";
    let sound_second = dir.read(second);
    dir.remove(second);
    refused(&dir, &folder, &["room_discs/001", "room_discs/002"]);
    // Everything that is wrong is said at once.
    dir.edit(card, "\"tiny\"", "\"small\"");
    dir.edit(card, "\"l4d\"", "\"davis\"");
    refused(&dir, &folder, &["field `profile`", "field `protocol`", "room_discs/001", "room_discs/002"]);
    dir.write(card, &sound_card);
    dir.write(second, &sound_second);
    // A link could lead to the truth.
    std::os::unix::fs::symlink(dir.path("results/oracle/masks/room_discs/001.json"), dir.path(mask)).unwrap();
    refused(&dir, &folder, &["001.json", "link"]);
    dir.remove(mask);
    dir.write(mask, &sound_mask);
    for (from, to, word) in [
        ("\"tiny\"", "\"small\"", "profile"),
        ("\"benchmark_version\":\"0.1.0\"", "\"benchmark_version\":\"9.9.9\"", "9.9.9"),
        ("\"ground_truth\":false", "\"ground_truth\":true", "ground truth"),
        ("\"seconds\"", "\"baseline\":true,\"seconds\"", "baselines are not ranked"),
        ("\"depth\":false", "\"depth\":true", "is ranked in another track"),
        ("\"depth\":false", "\"depth\":1", "depth"),
    ] {
        dir.edit(card, from, to);
        refused(&dir, &folder, &["method.json", word]);
        dir.write(card, &sound_card);
    }
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
    python(&dir, &["-c", script]).says(0, &[]);
    for (archive, word) in [
        ("torn.zip", "cannot be read"),
        ("climbing.zip", "no path below the archive"),
        ("bomb.zip", "larger than"),
        ("lzma.zip", "stored or deflated"),
        ("many.zip", "more than 20000"),
        ("twice.zip", "is in the archive twice"),
        ("list.zip", "list of files"),
    ] {
        refused(&dir, archive, &[word]);
    }
}

#[test]
fn the_hub_gets_tasks_a_leaderboard_and_results() {
    let dir = bench();
    for (baseline, field, value) in
        [("all", "/link", json!("https://example.org/a: \"b\"")), ("oracle", "/used/depth", json!(true))]
    {
        let card = format!("{}/method.json", submission(&dir, baseline));
        dir.change(&card, |card| *card.pointer_mut(field).unwrap() = value);
    }
    dir.succeed("baseline all oracle --profile tiny");
    dir.succeed("score --profile tiny");
    dir.succeed("host huggingface --profile tiny --dataset lab/discs");
    let root = "hosting/huggingface";
    let tasks = yaml(&dir.read(&format!("{root}/dataset/eval.yaml")));
    assert_eq!(keys(&tasks), BTreeSet::from(["name", "description", "evaluation_framework", "tasks"]));

    let results = |method: &str, file: &str| {
        yaml(&dir.read(&format!("{root}/methods/{method}/.eval_results/{file}.yaml")))[0].clone()
    };
    let result = results("like-all", "discs-tiny");
    let data_set = json!({"id": "lab/discs", "task_id": tasks["tasks"][0]["id"]});
    for (key, value) in data_set.as_object().unwrap() {
        assert_eq!(result["dataset"][key], *value);
    }
    assert_eq!(result["source"]["url"], "https://example.org/a: \"b\"");
    let miou = dir.value("scores/like-all/summary.json")["miou"].clone();
    assert_eq!(result["value"], miou);

    let card = dir.read(&format!("{root}/methods/like-all/README.md"));
    let front = yaml(card.split("---\n").nth(1).unwrap());
    let entry = &front["model-index"][0]["results"][0];
    assert!(entry["task"]["type"].is_string() && entry["dataset"]["name"].is_string());
    assert_eq!(entry["dataset"]["type"], "lab/discs");
    let metric = &entry["metrics"][0];
    assert_eq!((&metric["type"], &metric["value"]), (&json!("miou"), &miou));

    // The leaderboard has all methods; baselines and those that looked at the truth have no rank and no card.
    let rows = dir.lines(&format!("{root}/leaderboard/leaderboard.jsonl"));
    assert_eq!(rows.len(), 8);
    let ranked = rows.iter().filter(|row| row["rank"].is_u64());
    let ranked: Vec<Value> = ranked.map(|row| json!([row["track"], row["rank"], row["method"]])).collect();
    assert_eq!(ranked, [json!(["colour", 1, "like-all"]), json!(["colour+depth", 1, "like-oracle"])]);
    let page = dir.read(&format!("{root}/leaderboard/README.md"));
    let (colour, depth) = page.split_once("## Track: colour + depth").unwrap();
    for (part, texts) in [
        (colour, ["\n\n## Track: colour\n\n| rank |", "| 1 | like-all |"]),
        (depth, ["| 1 | like-oracle |", "\n\n## Not ranked\n\n| rank |"]),
    ] {
        assert!(texts.iter().all(|text| part.contains(text)), "{page}");
    }
    // Its result is of a task of its own, since the Hub ranks all results of a task.
    let result = results("like-oracle", "discs-tiny-depth");
    assert_eq!(result["dataset"]["task_id"], tasks["tasks"][1]["id"]);
    let none = rows.iter().find(|row| row["method"] == "none").unwrap();
    assert_eq!(none["unranked_because"], "baseline");
    let csv = dir.read(&format!("{root}/leaderboard/leaderboard.csv"));
    let header: BTreeSet<&str> = csv.lines().next().unwrap().split(',').collect();
    assert_eq!(header, keys(&rows[0]));
    assert!(csv.contains("\"https://example.org/a: \"\"b\"\"\""), "{csv}");
    for baseline in ["oracle", "all", "none"] {
        assert!(!dir.path(format!("{root}/methods/{baseline}")).exists(), "{baseline}");
    }
    dir.rename("scores", "elsewhere");
    dir.edit("benchmark/panoptic-l4d.toml", "0.1.0", "0.2.0");
    let other = "host huggingface elsewhere --dataset lab/discs --profile tiny --out x";
    dir.refuses(other, &["summary.json"]);
}

#[test]
fn a_folder_of_something_else_is_not_mixed_in() {
    let dir = bench();
    dir.succeed(HOST);
    let before = dir.bytes("hosting/codabench/bundle.zip");
    dir.succeed(HOST);
    assert_eq!(dir.bytes("hosting/codabench/bundle.zip"), before, "the same bytes");
    dir.write("hosting/codabench/reference_data/truth/old_scene.json", "{}");
    dir.run(HOST).says(2, &["old_scene.json"]);
    let wheel = format!("wheels/{WHEEL}");
    dir.remove(&wheel);
    dir.run(format!("{HOST} --out other")).says(2, &["--wheel", "maturin build"]);
    dir.write(&wheel, "no wheel");
    // A query is verified by votes alone.
    dir.edit("benchmark/queries/room_discs.jsonl", "candidate", "verified");
    dir.run(format!("{HOST} --out other")).says(1, &["L4D602"]);
    assert!(!dir.path("other").exists());
    for (right, wrong) in [
        ("--wheel wheels", "--until 2026-11-21 --wheel wheels"),
        ("https://example.org/discs", "here"),
        ("--date 2026-11-22", "--date today"),
    ] {
        assert_eq!(dir.run(HOST.replace(right, wrong)).code, 2, "{wrong:?}");
    }
}
