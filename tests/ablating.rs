//! `ablate` and `bench lift` as their users run them, on the twins: small grids, resumed, refused.

use serde_json::Value;

use crate::solving::{refused, world};
use crate::support::{Dir, root};

const COMMON: [&str; 4] = ["--profile", "tiny", "--data", "data"];
const NOISE: &str = "seed = 5\n[noise.swap]\nprobability = 0.4\n";

/// The twins with the numbers of the paper beside them.
fn stage() -> Dir {
    let dir = world();
    for table in ["mvsc", "views", "composites", "scales", "vlm"] {
        let path = format!("benchmark/published/{table}.csv");
        dir.write(&path, std::fs::read(root().join(&path)).unwrap());
    }
    dir.write("noise.toml", NOISE);
    dir
}

fn ablate<'a>(grid: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["ablate", grid], &COMMON[..], more].concat()
}

/// A row of a CSV table.
#[derive(Debug)]
struct Row {
    setting: String,
    column: String,
    metric: String,
    value: f64,
    interval: Option<(f64, f64)>,
    queries: Option<usize>,
    source: String,
    used_truth: bool,
}

fn rows(dir: &Dir, path: &str) -> Vec<Row> {
    let text = dir.read(path);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = "setting,column,metric,value,low,high,queries,scenes,source,used_truth";
    assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>().join(","), header);
    let row = |record: csv::StringRecord| Row {
        setting: record[0].to_owned(),
        column: record[1].to_owned(),
        metric: record[2].to_owned(),
        value: record[3].parse().unwrap(),
        interval: record[4].parse().ok().zip(record[5].parse().ok()),
        queries: record[6].parse().ok(),
        source: record[8].to_owned(),
        used_truth: record[9].parse().unwrap(),
    };
    reader.records().map(|record| row(record.unwrap())).collect()
}

fn value(rows: &[Row], setting: &str, column: &str, metric: &str) -> f64 {
    let found = rows.iter().find(|row| {
        row.source == "measured" && row.setting == setting && row.column == column && row.metric == metric
    });
    found.unwrap_or_else(|| panic!("no {setting}, {column}, {metric} in {rows:#?}")).value
}

#[test]
fn consensus_is_compared_query_by_query_for_each_correlation() {
    let dir = stage();
    let grid = ablate("mvsc", &["--grounder", "oracle", "--noise", "noise.toml", "--correlations", "0,0.9"]);
    let run = dir.succeed(&grid);
    for part in [
        "| w/o MVSC, rho 0 † |",
        "| with MVSC, rho 0.9 † |",
        "| *paper, another data set:* w/o MVSC | 76.24 | 67.20 |",
        "cannot be ranked",
        "## What consensus changes",
        "fewer than 8 scenes",
    ] {
        assert!(run.stdout.contains(part), "no `{part}` in\n{}", run.stdout);
    }
    let folder = "work/tiny/ablations/mvsc";
    assert_eq!(run.stdout.trim_end(), dir.read(&format!("{folder}/mvsc.md")).trim_end());
    assert!(!dir.path("results").exists() && !dir.path("scores").exists());
    assert!(!dir.path("work/tiny/ball/answers").exists());

    let found = rows(&dir, &format!("{folder}/mvsc.csv"));
    assert!(found.iter().all(|row| row.used_truth == (row.source == "measured")));
    assert!(found.iter().all(|row| row.interval.is_none()), "one scene says nothing of others");
    assert!(found.iter().any(|row| row.source == "published" && row.value == 72.97 && row.queries.is_none()));
    // Rows are what `score` says of the same masks, and differences are those of the rows.
    let scored = dir.json(&["score", &format!("{folder}/results"), "--profile", "tiny", "--scores", "again"]);
    for method in scored["methods"].as_array().unwrap() {
        let (row, rho) = method["name"].as_str().unwrap().split_once("-rho-").unwrap();
        let row = match row {
            "without-mvsc" => "w/o MVSC",
            "with-mvsc" => "with MVSC",
            "with-mvsc-abstaining" => "with MVSC, abstaining",
            other => panic!("{other}"),
        };
        let setting = format!("{row}, rho {rho}");
        for (metric, name) in
            [("miou", "miou"), ("macc", "macc"), ("tube_iou", "tube_iou"), ("select", "select")]
        {
            let difference = value(&found, &setting, "all", metric) - method[name].as_f64().unwrap();
            assert!(difference.abs() < 1e-3, "{setting} {metric}: {difference}");
        }
    }
    for rho in ["0", "0.9"] {
        for column in ["action", "spatial", "all"] {
            let [without, with] =
                ["w/o", "with"].map(|word| value(&found, &format!("{word} MVSC, rho {rho}"), column, "miou"));
            let gain = value(&found, &format!("with MVSC - w/o MVSC, rho {rho}"), column, "miou");
            assert!((with - without - gain).abs() < 1e-3, "{column} at {rho}: {with} {without} {gain}");
            let abstaining = value(&found, &format!("with MVSC, abstaining, rho {rho}"), column, "miou");
            assert!(abstaining <= with, "an empty answer is no better: {column} at {rho}");
        }
    }

    // What is answered stays answered, and the tables come out the same.
    let record = || dir.read(&format!("{folder}/answers/with-mvsc-rho-0.9/{}/001/manifest.json", "ball"));
    let (before, table) = (record(), dir.read(&format!("{folder}/mvsc.csv")));
    dir.succeed(&grid);
    assert_eq!((record(), dir.read(&format!("{folder}/mvsc.csv"))), (before, table));
    // Other errors are not mixed in.
    dir.write("noise.toml", NOISE.replace("0.4", "0.1"));
    refused(&dir.run(&grid), &["w/o MVSC, rho 0", "with other settings", "--overwrite"]);
}

#[test]
fn the_noise_that_makes_the_table_is_searched_once() {
    let dir = stage();
    let more =
        ["--grounder", "oracle", "--calibrate", "--correlations", "0", "--lift", "vote", "--out", "found"];
    let grid = ablate("mvsc", &more);
    let run = dir.succeed(&grid);
    assert!(run.stderr.contains("rho 0: ") && run.stderr.contains("paper 67.04"), "{}", run.stderr);
    let noise = dir.read("found/noise/rho-0.toml");
    assert!(noise.contains("[swap_probability]") && noise.contains("action = "), "{noise}");
    // What was found is what the row shows.
    let tried = dir.read("found/calibration.csv");
    let action = value(&rows(&dir, "found/mvsc.csv"), "w/o MVSC, rho 0", "action", "miou");
    let reached = tried
        .lines()
        .filter(|line| line.contains(",action,"))
        .map(|line| line.split(',').nth(3).unwrap().parse::<f64>().unwrap());
    let closest = reached.min_by(|a, b| (a - 67.04).abs().total_cmp(&(b - 67.04).abs())).unwrap();
    assert!((action - closest).abs() < 1e-3, "{action} {closest}\n{tried}");
    let again = dir.succeed(&grid);
    assert!(again.stderr.contains("was found before"), "{}", again.stderr);
    assert_eq!(again.stdout, run.stdout);
}

#[test]
fn views_that_the_profile_lacks_are_named() {
    let dir = stage();
    let document = dir.json(&ablate("views", &["--grounder", "oracle", "--view-counts", "1,4,6"]));
    let left_out = document["left_out"].as_array().unwrap();
    assert_eq!(left_out.len(), 1);
    assert!(
        left_out[0].as_str().unwrap().contains("6 views: profile tiny has 4 training views"),
        "{left_out:?}"
    );
    let settings: Vec<&Value> = document["rows"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|row| row["source"] == "measured")
        .map(|row| &row["setting"])
        .collect();
    assert!(
        settings.contains(&&Value::from("1"))
            && settings.contains(&&Value::from("4"))
            && !settings.contains(&&Value::from("6"))
    );
    let found = rows(&dir, "work/tiny/ablations/views/views.csv");
    assert!(value(&found, "4", "all", "miou") > 75.0, "{found:#?}");
    let bypassed = dir.read("work/tiny/ablations/views/answers/views-1/ball/001/manifest.json");
    assert!(bypassed.contains("\"decision\": \"bypassed\""), "{bypassed}");
}

#[test]
fn composites_and_scales_have_tables_of_their_own() {
    let dir = stage();
    let query = serde_json::json!({
        "id": "ball/501",
        "text": "The ball that rolls in front of the other one",
        "categories": ["action", "spatial"],
        "referents": ["ball_a"],
        "temporal": "whole",
        "frames": [[0, 96]],
        "predicate": null,
        "text_digest": l4d_data::query::text_digest("The ball that rolls in front of the other one", None),
        "provenance": { "source": "author" },
        "status": "candidate",
    });
    dir.write("benchmark/queries/ball.composite.jsonl", format!("{query}\n"));
    dir.succeed(&ablate("composites", &["--grounder", "oracle"]));
    let found = rows(&dir, "work/tiny/ablations/composites/composites.csv");
    let measured: Vec<&Row> =
        found.iter().filter(|row| row.source == "measured" && row.metric == "miou").collect();
    let columns: Vec<(&str, Option<usize>)> =
        measured.iter().map(|row| (row.column.as_str(), row.queries)).collect();
    assert_eq!(columns, [("spatial+action", Some(1)), ("all", Some(1))]);
    assert!(value(&found, "PanopticQuery", "all", "miou") > 75.0);

    // Judged alone, and never in place of the headline.
    let results = "work/tiny/ablations/composites/results";
    let scored = dir.json(&["score", results, "--profile", "tiny", "--set", "composites"]);
    assert_eq!((&scored["set"], &scored["methods"][0]["queries"]), (&"composites".into(), &1.into()));
    assert!(dir.path("scores-composites/solver/counts.csv").exists() && !dir.path("scores").exists());
    let headline = dir.json(&["score", results, "--profile", "tiny"]);
    let findings = headline["findings"].as_array().unwrap();
    assert!(
        !findings.is_empty()
            && findings.iter().all(|finding| !finding["path"].as_str().unwrap().contains("501")),
        "{findings:?}"
    );
    let board = dir.run(&["leaderboard", "scores-composites", "--profile", "tiny"]);
    refused(&board, &["no method was scored", "on composites"]);

    dir.succeed(&ablate("scales", &["--grounder", "oracle"]));
    let found = rows(&dir, "work/tiny/ablations/scales/scales.csv");
    assert!(found.iter().filter(|row| row.source == "measured").all(|row| row.setting == "room"));
    assert!(value(&found, "room", "spatial", "miou") > 75.0, "{found:#?}");
}

#[test]
fn lifts_are_measured_on_the_same_evidence() {
    let dir = stage();
    let bench = ["bench", "lift", "ball", "--quick", "--queries", "2"];
    let document = dir.json(&[&bench, &COMMON[..], &["--out", "bench"]].concat());
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4, "{document}");
    for row in rows {
        let number = |field: &str| row[field].as_f64().unwrap();
        assert!(number("lift_seconds") > 0.0 && number("flicker") >= 0.0 && row["queries"] == 2, "{row}");
        assert!(
            (0.0..=100.0).contains(&number("miou")) && (0.0..=100.0).contains(&number("tube_iou")),
            "{row}"
        );
    }
    assert!(rows[0]["miou"].as_f64().unwrap() > 75.0, "{document}");
    for file in ["lift.csv", "lift.svg", "lift.png"] {
        assert!(dir.path("bench").join(file).exists(), "{file}");
    }
}

#[test]
fn grids_that_cannot_be_run_are_refused() {
    let dir = stage();
    let oracle = ["--grounder", "oracle", "--noise", "noise.toml"];
    let with = |grid: &str, more: &[&str]| dir.run(&ablate(grid, &[&oracle, more].concat()));
    refused(&with("mvsc", &["--no-consensus"]), &["--no-consensus is one of the rows"]);
    refused(&with("mvsc", &["--correlations", "0,1.5"]), &["1.5 is no correlation"]);
    refused(&with("mvsc", &["--correlations", "nan"]), &["NaN is no correlation"]);
    refused(&with("views", &["--correlations", "0.3"]), &["--correlations makes up errors", "grid mvsc"]);
    refused(&with("views", &["--view-counts", "9,64"]), &["ball has 4 training views"]);
    refused(&with("views", &["--grounder-files", "a.toml"]), &["--grounder-files are rows of the grid vlm"]);
    refused(&with("scales", &["--scenes", "cave"]), &["no scene `cave`"]);
    refused(&dir.run(&ablate("mvsc", &["--grounder", "oracle"])), &["without errors", "--calibrate"]);
    refused(
        &dir.run(&ablate("mvsc", &["--calibrate"])),
        &["--calibrate makes up errors", "--grounder oracle"],
    );
    refused(&dir.run(&ablate("mvsc", &["--noise", "noise.toml"])), &["--noise belongs to the oracle"]);
    refused(&dir.run(&ablate("vlm", &[])), &["there are none", "--grounder-file"]);
    refused(&with("composites", &[]), &["composites", "--profile"]);
    dir.write("benchmark/published/mvsc.csv", "table,setting,column,metric,value\nmvsc,a,action,miou,200\n");
    refused(&with("mvsc", &[]), &["mvsc.csv", "is 200"]);
    std::fs::remove_file(dir.path("benchmark/published/mvsc.csv")).unwrap();
    refused(&with("mvsc", &["--calibrate"]), &["no numbers to come close to"]);

    let bench = |more: &[&str]| dir.run(&[&["bench", "lift"], more, &COMMON[..]].concat());
    refused(&bench(&["cave"]), &["no scene `cave`"]);
    refused(&bench(&["ball", "--noise", "none.toml"]), &["none.toml"]);
}
