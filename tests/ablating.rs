//! `ablate` and `bench lift` as their users run them, on the twins: small grids, resumed, refused.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::solving::world;
use crate::support::{Dir, query, shipped};

const COMMON: &str = "--profile tiny --data data";
const ORACLE: &str = "--profile tiny --data data --grounder oracle";
const NOISE: &str = "seed = 5\n[noise.swap]\nprobability = 0.4\n";
const BENCH_LIFT: &str = "bench lift ball --quick --queries 2 --profile tiny --data data --out bench";

/// The twins with the numbers of the paper beside them.
fn stage() -> Dir {
    let dir = world();
    for table in ["mvsc", "views", "composites", "scales", "vlm"] {
        let path = format!("benchmark/published/{table}.csv");
        dir.write(&path, shipped(&path));
    }
    dir.write("noise.toml", NOISE);
    dir
}

/// Rows of the table of a grid.
fn rows(dir: &Dir, path: &str) -> Vec<BTreeMap<String, String>> {
    let header = "setting,column,metric,value,low,high,queries,scenes,source,used_truth\n";
    assert!(dir.read(path).starts_with(header));
    dir.table(path)
}

fn value(rows: &[BTreeMap<String, String>], setting: &str, column: &str, metric: &str) -> f64 {
    let wanted = [("source", "measured"), ("setting", setting), ("column", column), ("metric", metric)];
    let found = rows.iter().find(|row| wanted.iter().all(|(field, value)| row[*field] == **value));
    found.unwrap_or_else(|| panic!("no {setting}, {column}, {metric} in {rows:#?}"))["value"].parse().unwrap()
}

#[test]
fn consensus_is_compared_query_by_query_for_each_correlation() {
    let dir = stage();
    let quick = "--lift vote --clip-every 2";
    let grid = format!("ablate mvsc {ORACLE} --noise noise.toml --correlations 0,0.9 {quick}");
    let run = dir.succeed(&grid);
    run.says(
        0,
        &[
            "| w/o MVSC, rho 0 † |",
            "| with MVSC, rho 0.9 † |",
            "| *paper, another data set:* w/o MVSC | 76.24 | 67.20 |",
            "cannot be ranked",
            "## What consensus changes",
            "fewer than 8 scenes",
        ],
    );
    let folder = "work/tiny/ablations/mvsc";
    assert_eq!(run.stdout.trim_end(), dir.read(&format!("{folder}/mvsc.md")).trim_end());
    assert!(!dir.path("results").exists() && !dir.path("scores").exists());
    assert!(!dir.path("work/tiny/ball/answers").exists());

    let found = rows(&dir, &format!("{folder}/mvsc.csv"));
    assert!(found.iter().all(|row| (row["used_truth"] == "true") == (row["source"] == "measured")));
    assert!(found.iter().all(|row| row["low"].is_empty()), "one scene says nothing of others");
    let is_printed = |row: &BTreeMap<String, String>| {
        row["source"] == "published" && row["value"].parse() == Ok(72.97) && row["queries"].is_empty()
    };
    assert!(found.iter().any(is_printed));
    // Rows are what `score` says of the same masks, and differences are those of the rows.
    let scored = dir.json(format!("score {folder}/results --profile tiny --scores again"));
    let settings = BTreeMap::from([
        ("without-mvsc", "w/o MVSC"),
        ("with-mvsc", "with MVSC"),
        ("with-mvsc-abstaining", "with MVSC, abstaining"),
    ]);
    for method in scored["methods"].as_array().unwrap() {
        let (row, rho) = method["name"].as_str().unwrap().split_once("-rho-").unwrap();
        let setting = format!("{}, rho {rho}", settings[row]);
        for metric in ["miou", "macc", "tube_iou", "select"] {
            let difference = value(&found, &setting, "all", metric) - method[metric].as_f64().unwrap();
            assert!(difference.abs() < 1e-3, "{setting} {metric}: {difference}");
        }
    }
    for rho in ["0", "0.9"] {
        for column in ["action", "spatial", "all"] {
            let miou = |row: &str| value(&found, &format!("{row}, rho {rho}"), column, "miou");
            let [without, with] = ["w/o MVSC", "with MVSC"].map(miou);
            let gain = miou("with MVSC - w/o MVSC");
            assert!((with - without - gain).abs() < 1e-3, "{column} at {rho}: {with} {without} {gain}");
            let abstaining = miou("with MVSC, abstaining");
            assert!(abstaining <= with, "an empty answer is no better: {column} at {rho}");
        }
    }

    // What is answered stays answered, and the tables come out the same.
    let record = || dir.read(&format!("{folder}/answers/with-mvsc-rho-0.9/ball/001/manifest.json"));
    let (before, table) = (record(), dir.read(&format!("{folder}/mvsc.csv")));
    dir.succeed(&grid);
    assert_eq!((record(), dir.read(&format!("{folder}/mvsc.csv"))), (before, table));
    // Other errors are not mixed in.
    dir.write("noise.toml", NOISE.replace("0.4", "0.1"));
    dir.refuses(&grid, &["w/o MVSC, rho 0", "with other settings", "--force"]);
}

#[test]
fn the_noise_that_makes_the_table_is_searched_once() {
    let dir = stage();
    let grid = format!("ablate mvsc {ORACLE} --calibrate --correlations 0 --lift vote --out found");
    let run = dir.succeed(&grid);
    run.says(0, &["rho 0: ", "paper 67.04"]);
    let noise = dir.read("found/noise/rho-0.toml");
    assert!(noise.contains("[swap_probability]") && noise.contains("action = "), "{noise}");
    // What was found is what the row shows.
    let tried = dir.read("found/calibration.csv");
    let action = value(&rows(&dir, "found/mvsc.csv"), "w/o MVSC, rho 0", "action", "miou");
    let reached = tried.lines().filter(|line| line.contains(",action,"));
    let reached = reached.map(|line| line.split(',').nth(3).unwrap().parse::<f64>().unwrap());
    let closest = reached.min_by(|a, b| (a - 67.04).abs().total_cmp(&(b - 67.04).abs())).unwrap();
    assert!((action - closest).abs() < 1e-3, "{action} {closest}\n{tried}");
    let again = dir.succeed(&grid);
    again.says(0, &["was found before"]);
    assert_eq!(again.stdout, run.stdout);
}

#[test]
fn views_that_the_profile_lacks_are_named() {
    let dir = stage();
    let document = dir.json(format!("ablate views {ORACLE} --view-counts 1,4,6"));
    let left_out = document["left_out"].as_array().unwrap();
    assert_eq!(left_out.len(), 1);
    let why = "6 views: profile tiny has 4 training views";
    assert!(left_out[0].as_str().unwrap().contains(why), "{left_out:?}");
    let measured = document["rows"].as_array().unwrap().iter().filter(|row| row["source"] == "measured");
    let settings: Vec<&str> = measured.map(|row| row["setting"].as_str().unwrap()).collect();
    assert!(["1", "4"].iter().all(|count| settings.contains(count)) && !settings.contains(&"6"));
    let found = rows(&dir, "work/tiny/ablations/views/views.csv");
    assert!(value(&found, "4", "all", "miou") > 75.0, "{found:#?}");
    let bypassed = dir.read("work/tiny/ablations/views/answers/views-1/ball/001/manifest.json");
    assert!(bypassed.contains("\"decision\": \"bypassed\""), "{bypassed}");
}

#[test]
fn composites_and_scales_have_tables_of_their_own() {
    let dir = stage();
    let text = "The ball that rolls in front of the other one";
    let composite = query("ball/501", text, "action+spatial", &["ball_a"], "whole", [0, 96]);
    dir.write("benchmark/queries/ball.composite.jsonl", format!("{composite}\n"));
    dir.succeed(format!("ablate composites {ORACLE}"));
    let found = rows(&dir, "work/tiny/ablations/composites/composites.csv");
    let measured = found.iter().filter(|row| row["source"] == "measured" && row["metric"] == "miou");
    let columns: Vec<(&str, &str)> =
        measured.map(|row| (row["column"].as_str(), row["queries"].as_str())).collect();
    assert_eq!(columns, [("spatial+action", "1"), ("all", "1")]);
    assert!(value(&found, "PanopticQuery", "all", "miou") > 75.0);

    // Judged alone, and never in place of the headline.
    let results = "work/tiny/ablations/composites/results";
    let scored = dir.json(format!("score {results} --profile tiny --set composites"));
    assert_eq!((&scored["set"], &scored["methods"][0]["queries"]), (&"composites".into(), &1.into()));
    assert!(dir.path("scores-composites/solver/counts.csv").exists() && !dir.path("scores").exists());
    let headline = dir.json(format!("score {results} --profile tiny"));
    let findings = headline["findings"].as_array().unwrap();
    let is_of_composite = |finding: &Value| finding["path"].as_str().unwrap().contains("501");
    assert!(!findings.is_empty() && !findings.iter().any(is_of_composite), "{findings:?}");
    let board = "leaderboard scores-composites --profile tiny";
    dir.refuses(board, &["no method was scored", "on composites"]);

    dir.succeed(format!("ablate scales {ORACLE}"));
    let found = rows(&dir, "work/tiny/ablations/scales/scales.csv");
    assert!(found.iter().filter(|row| row["source"] == "measured").all(|row| row["setting"] == "room"));
    assert!(value(&found, "room", "spatial", "miou") > 75.0, "{found:#?}");
}

#[test]
fn lifts_are_measured_on_the_same_evidence() {
    let dir = stage();
    let document = dir.json(BENCH_LIFT);
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4, "{document}");
    let number = |row: &Value, field: &str| row[field].as_f64().unwrap();
    for row in rows {
        assert!(number(row, "lift_seconds") > 0.0 && number(row, "flicker") >= 0.0, "{row}");
        assert_eq!(row["queries"], 2, "{row}");
        for ratio in ["miou", "tube_iou"] {
            assert!((0.0..=100.0).contains(&number(row, ratio)), "{row}");
        }
    }
    assert!(number(&rows[0], "miou") > 75.0, "{document}");
    for file in ["lift.csv", "lift.svg", "lift.png"] {
        assert!(dir.path("bench").join(file).exists(), "{file}");
    }
}

#[test]
fn grids_that_cannot_be_run_are_refused() {
    let dir = stage();
    for (grid, parts) in [
        ("mvsc --no-consensus", &["--no-consensus does not apply to the grid mvsc"][..]),
        ("views --correlations 0.3", &["--correlations does not apply to the grid views", "grid mvsc"]),
        ("views --view-counts 9,64", &["ball has 4 training views"]),
        ("views --grounder-files a.toml", &["--grounder-files does not apply to the grid views", "grid vlm"]),
        ("scales --scenes cave", &["no scene `cave`"]),
        ("composites", &["composites", "--profile"]),
    ] {
        dir.refuses(format!("ablate {grid} {ORACLE} --noise noise.toml"), parts);
    }
    dir.refuses(format!("ablate mvsc {ORACLE}"), &["without errors", "--calibrate"]);
    for (grid, parts) in [
        ("mvsc --calibrate", &["--calibrate does not apply to --grounder panoptic", "--grounder oracle"][..]),
        ("mvsc --noise noise.toml", &["--noise does not apply to --grounder panoptic"]),
        ("vlm", &["there are none", "--grounder-file"]),
    ] {
        dir.refuses(format!("ablate {grid} {COMMON}"), parts);
    }
    let published = "benchmark/published/mvsc.csv";
    let grid = format!("ablate mvsc {ORACLE} --noise noise.toml");
    dir.write(published, "table,setting,column,metric,value\nmvsc,a,action,miou,200\n");
    dir.refuses(&grid, &["mvsc.csv", "is 200"]);
    dir.remove(published);
    dir.refuses(format!("{grid} --calibrate"), &["no numbers to come close to"]);

    dir.refuses(format!("bench lift cave {COMMON}"), &["no scene `cave`"]);
    dir.refuses(format!("bench lift ball --noise none.toml {COMMON}"), &["none.toml"]);
}
