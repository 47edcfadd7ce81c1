//! `l4d leaderboard`: from scored baselines to tables and figures, and what it refuses.

use l4d_data::json;
use serde_json::Value;

use crate::support::Dir;

const TINY: [&str; 2] = ["--profile", "tiny"];
const BASELINES: [&str; 6] =
    ["all", "look-alike-union", "none", "oracle", "random-look-alike", "time-agnostic"];

fn leaderboard(dir: &Dir) -> crate::support::Run {
    dir.run(&[&["leaderboard"], &TINY[..]].concat())
}

/// Scored baselines; `contestant` is the random look-alike under a name of its own, without truth.
fn scored() -> Dir {
    let dir = Dir::with_benchmark();
    dir.succeed(&[&["baseline"], &TINY[..]].concat());
    rename(&dir, "results/random-look-alike", "results/contestant");
    dir.edit("results/contestant/method.json", "random-look-alike", "contestant");
    dir.edit("results/contestant/method.json", "\"ground_truth\": true", "\"ground_truth\": false");
    dir.succeed(&[&["score"], &TINY[..]].concat());
    dir
}

fn rename(dir: &Dir, from: &str, to: &str) {
    std::fs::rename(dir.path(from), dir.path(to)).unwrap();
}

#[test]
fn scores_become_tables_and_figures() {
    let dir = scored();
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(
        run.stdout.starts_with(
            "Discs 0.1.0 · protocol l4d · profile tiny · 8 queries, 2 verified by people, 2 rejected\n"
        ),
        "{}",
        run.stdout
    );
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{}", run.stdout);
    assert!(run.stdout.contains("   1 contestant"), "{}", run.stdout);
    assert!(run.stderr.contains("leaderboard/leaderboard.csv"), "{}", run.stderr);

    let csv = dir.read("leaderboard/leaderboard.csv");
    let summary: Value = json::read(&dir.path("scores/contestant/summary.json")).unwrap();
    let miou = summary["miou"].as_f64().unwrap();
    let first = csv.lines().nth(1).unwrap();
    assert!(first.starts_with("1,contestant,"), "{first}");
    assert!(first.contains(&format!(",8,{miou:.4},")), "{first}");
    let oracle = csv.lines().find(|line| line.contains(",oracle,")).unwrap();
    assert!(oracle.starts_with(',') && oracle.contains("used ground truth,8,100.0000,"), "{oracle}");

    for name in ["per_category", "per_scale", "metrics", "over_time"] {
        let svg = dir.read(&format!("leaderboard/figures/{name}.svg"));
        assert!(svg.starts_with("<svg ") && svg.contains("profile tiny"), "{name}");
        let png = std::fs::read(dir.path(format!("leaderboard/figures/{name}.png"))).unwrap();
        assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n", "{name}");
    }
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(page.contains("(figures/per_category.svg)") && page.contains("2 verified by people"));
}

#[test]
fn the_same_scores_give_the_same_bytes() {
    let dir = scored();
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    dir.succeed(&[&["leaderboard", "-o", "again"], &TINY[..]].concat());
    for file in
        ["leaderboard.csv", "per_scene.csv", "leaderboard.md", "figures/metrics.svg", "figures/metrics.png"]
    {
        let read = |folder: &str| std::fs::read(dir.path(folder).join(file)).unwrap();
        assert_eq!(read("leaderboard"), read("again"), "{file}");
    }
}

#[test]
fn json_says_who_is_ranked_and_why_others_are_not() {
    let dir = scored();
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    assert_eq!(board["ranked"][0]["name"], "contestant");
    assert_eq!(board["ranked"][0]["rank"], 1);
    assert_eq!((&board["queries"], &board["verified_queries"]), (&8.into(), &2.into()));
    assert_eq!(board["rejected_queries"], 2);
    let oracle =
        board["unranked"].as_array().unwrap().iter().find(|method| method["name"] == "oracle").unwrap();
    assert_eq!(oracle["unranked_because"][0], "used ground truth");
    assert_eq!(oracle["scores"]["miou"], 100.0);
}

#[test]
fn part_of_the_scenes_is_partial_until_the_board_is_of_that_part() {
    let dir = scored();
    let part = ["--profile", "tiny", "--scenes", "room_discs"];
    dir.succeed(&[&["score", "results/contestant"], &part[..]].concat());
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    let partial =
        board["unranked"].as_array().unwrap().iter().find(|method| method["name"] == "contestant").unwrap();
    assert_eq!(partial["unranked_because"][0], "partial");
    let board = dir.json(&[&["leaderboard"], &part[..]].concat());
    assert_eq!(board["ranked"][0]["name"], "contestant");
    assert_eq!(board["queries"], 4);
}

#[test]
fn other_versions_and_protocols_stand_apart() {
    let dir = scored();
    dir.edit(
        "scores/oracle/summary.json",
        "\"benchmark_version\": \"0.1.0\"",
        "\"benchmark_version\": \"0.0.9\"",
    );
    dir.succeed(&["score", "results/contestant", "--profile", "tiny", "--hit-iou", "0.5"]);
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(run.stdout.contains("not of this board: benchmark 0.0.9"), "{}", run.stdout);
    assert!(run.stdout.contains("protocol l4d with hits above IoU 0.5"), "{}", run.stdout);
    assert!(run.stderr.contains("warning:") && run.stderr.contains("0.0.9"), "{}", run.stderr);
    let csv = dir.read("leaderboard/leaderboard.csv");
    assert!(!csv.contains("oracle") && !csv.contains("contestant"), "{csv}");

    for name in BASELINES
        .into_iter()
        .chain(["contestant"])
        .filter(|name| !["oracle", "random-look-alike"].contains(name))
    {
        std::fs::remove_dir_all(dir.path(format!("scores/{name}"))).unwrap();
    }
    let run = leaderboard(&dir);
    assert_eq!(run.code, 2);
    assert!(
        run.stderr.contains("no method was scored on Discs 0.1.0") && run.stderr.contains("hint:"),
        "{}",
        run.stderr
    );
}

#[test]
fn damage_is_named_and_the_old_board_stays() {
    let dir = scored();
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    let before = dir.read("leaderboard/leaderboard.csv");
    let counts = dir.read("scores/oracle/counts.csv");
    let lines: Vec<&str> = counts.lines().collect();
    let cut = lines[..lines.len() - 9].join("\n");
    let cases = [
        ("scores/oracle/counts.csv", counts.replacen("hit", "NaN", 1), "counts.csv: line "),
        ("scores/oracle/counts.csv", cut, "do not follow from these rows"),
        ("scores/oracle/summary.json", "{".to_owned(), "summary.json"),
        ("scores/oracle/summary.json", dir.read("scores/none/summary.json"), "field `name`"),
        (
            "scores/oracle/summary.json",
            dir.read("scores/oracle/summary.json").replacen("100.0", "99.0", 1),
            "do not follow from these rows",
        ),
    ];
    for (file, text, told) in cases {
        let good = dir.read(file);
        dir.write(file, text);
        let run = leaderboard(&dir);
        assert_eq!(run.code, 2, "{told}: {}", run.stdout);
        assert!(run.stderr.contains(told) && run.stderr.contains("hint:"), "{told}: {}", run.stderr);
        dir.write(file, good);
    }
    std::fs::remove_file(dir.path("scores/oracle/counts.csv")).unwrap();
    assert_eq!(leaderboard(&dir).code, 2);
    assert_eq!(dir.read("leaderboard/leaderboard.csv"), before);
}

#[test]
fn no_scores_and_unscored_folders_are_told() {
    let dir = Dir::with_benchmark();
    let run = leaderboard(&dir);
    assert_eq!(run.code, 2, "{}", run.stdout);
    assert!(run.stderr.contains("scores") && run.stderr.contains("hint:"), "{}", run.stderr);
    std::fs::create_dir(dir.path("scores")).unwrap();
    let run = leaderboard(&dir);
    assert!(run.code == 2 && run.stderr.contains("no scored method"), "{}", run.stderr);

    let dir = scored();
    std::fs::create_dir(dir.path("scores/broken")).unwrap();
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(run.stderr.contains("scores/broken: holds no summary.json"), "{}", run.stderr);
}

#[test]
fn an_output_that_is_a_file_is_refused() {
    let dir = scored();
    dir.write("taken", "mine");
    let run = dir.run(&["leaderboard", "-o", "taken", "--profile", "tiny"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("taken"), "{}", run.stderr);
    assert_eq!(dir.read("taken"), "mine");
}
