//! `l4d leaderboard`: from scored baselines to the document, tables and figures, and what it refuses.

use std::process::Command;
use std::sync::LazyLock;

use l4d_board::Board;
use serde_json::Value;

use crate::support::{Dir, Run, named, root, shipped, succeed};

const BASELINES: [&str; 6] =
    ["all", "look-alike-union", "none", "oracle", "random-look-alike", "time-agnostic"];
const LEADERBOARD: &str = "leaderboard --profile tiny";

fn make(dir: &Dir) -> Run {
    dir.succeed(LEADERBOARD)
}

fn score(dir: &Dir, more: &str) {
    dir.succeed(format!("score --profile tiny {more}"));
}

/// Scored baselines; `contestant` is the random look-alike under a name of its own, without truth.
pub(crate) fn scored() -> Dir {
    static SCORED: LazyLock<Dir> = LazyLock::new(|| {
        let dir = Dir::with_baselines();
        dir.contestant("random-look-alike", "contestant");
        score(&dir, "");
        dir
    });
    SCORED.copy()
}

/// The same and the board of it, for tests that only look.
fn made() -> &'static Dir {
    static MADE: LazyLock<Dir> = LazyLock::new(|| {
        let dir = scored();
        dir.succeed(format!("{LEADERBOARD} --html"));
        dir
    });
    &MADE
}

/// Adds a copy of a baseline as a method of its own that says what it looked at.
pub(crate) fn add_contestant(dir: &Dir, baseline: &str, name: &str, saw_depth: bool) {
    let results = dir.path(format!("results/{baseline}"));
    crate::support::copy(&results, &dir.path("kept"));
    dir.contestant(baseline, name);
    dir.rename("kept", &format!("results/{baseline}"));
    dir.change(&format!("results/{name}/method.json"), |card| card["used"]["depth"] = saw_depth.into());
}

#[test]
fn masks_that_are_not_those_that_were_scored_are_told() {
    let dir = scored();
    let html = format!("{LEADERBOARD} --html");
    assert!(!dir.succeed(&html).stderr.contains("warning"));
    dir.write("results/contestant/masks/room_discs/001.json", "{");
    dir.write("results/oracle/masks/room_discs/001.json", dir.read("results/all/masks/room_discs/001.json"));
    dir.run(html).says(
        0,
        &[
            "warning: results/contestant/masks/room_discs/001.json: ",
            "warning: results/contestant/masks/room_discs: the masks of 001 are not those that were scored",
            "warning: results/oracle/masks/room_discs: the masks of 001 are not",
            "score the method again",
        ],
    );
}

#[test]
fn scores_become_a_document_tables_and_figures() {
    let dir = made().copy();
    let run = dir.succeed(format!("{LEADERBOARD} --html --out again"));
    let line = "Discs 0.1.0 · protocol l4d · profile tiny · 8 queries, 2 verified by people, 2 rejected\n";
    assert!(run.stdout.starts_with(line), "{run}");
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{run}");
    run.says(0, &["   1 contestant", "again/leaderboard.csv"]);
    let written = dir.tree("leaderboard");
    assert!(written == dir.tree("again"), "the same scores give the same bytes");
    for figure in ["per_category", "metrics", "speed", "taken"] {
        let svg = String::from_utf8_lossy(&written[&format!("figures/{figure}.svg")]);
        assert!(svg.starts_with("<svg role=\"img\" ") && svg.contains("profile tiny"), "{figure}");
        assert!(written[&format!("figures/{figure}.png")].starts_with(b"\x89PNG\r\n\x1a\n"), "{figure}");
    }
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(page.contains("(figures/taken.svg)") && written.contains_key("index.html"));

    let board = Board::read(&dir.path("leaderboard/board.json")).unwrap();
    let summary = dir.value("scores/contestant/summary.json");
    assert_eq!(summary["miou"], board.methods[0].scores.headline.percent.miou.unwrap());
    assert_eq!((board.heading.queries, board.methods[0].answers.len()), (8, 8));

    let taken = dir.table("leaderboard/taken.csv");
    let of = |method: &str, which: &str| {
        taken.iter().filter(|row| row["method"] == method && row["which_is"] == which).count()
    };
    assert_eq!((of("oracle", "meant"), of("none", "nothing")), (8, 8));
    assert_eq!(of("contestant", "meant") + of("contestant", "look_alike"), 8);
}

#[test]
fn json_says_which_are_ranked_and_why_others_are_not() {
    let board = scored().json(LEADERBOARD);
    assert_eq!((&board["ranked"][0]["name"], &board["ranked"][0]["rank"]), (&"contestant".into(), &1.into()));
    let counts = ["queries", "verified_queries", "rejected_queries"].map(|count| board[count].as_u64());
    assert_eq!(counts, [Some(8), Some(2), Some(2)]);
    let oracle = named(&board["unranked"], "oracle");
    assert_eq!(oracle["unranked_because"], serde_json::json!(["baseline", "used ground truth"]));
    assert_eq!(oracle["scores"]["miou"], 100.0);
}

#[test]
fn no_baseline_is_ranked_whatever_its_card_says() {
    let dir = scored();
    dir.succeed("baseline random-look-alike --profile tiny");
    // A card of versions before the field: its name says what it is.
    for name in BASELINES {
        dir.change(&format!("results/{name}/method.json"), |card| {
            card.as_object_mut().unwrap().remove("baseline");
            card["used"]["ground_truth"] = false.into();
        });
    }
    // The field alone is enough, under any name.
    dir.rename("results/all", "results/everything");
    dir.change("results/everything/method.json", |card| {
        card["name"] = "everything".into();
        card["baseline"] = true.into();
    });
    dir.remove("scores");
    score(&dir, "");
    make(&dir);
    for row in dir.table("leaderboard/leaderboard.csv") {
        let is_ranked = row["method"] == "contestant";
        assert_eq!((row["rank"].is_empty(), row["unranked_because"] == "baseline"), (!is_ranked, !is_ranked));
    }
    assert!(dir.read("leaderboard/leaderboard.md").contains("| everything | baseline |"));
    assert!(dir.read("leaderboard/tables/panoptic_l4d.tex").contains("everything$^{\\dagger}$"));
}

#[test]
fn protocols_of_others_have_tables_apart_and_change_nothing_here() {
    let dir = scored();
    for protocol in ["davis", "mevis"] {
        score(&dir, &format!("--protocol {protocol}"));
    }
    make(&dir).says(0, &["Apart and never ranked, in leaderboard/protocols: davis, mevis."]);
    assert_eq!(dir.read("leaderboard/leaderboard.csv"), made().read("leaderboard/leaderboard.csv"));
    assert!(dir.read("leaderboard/leaderboard.md").contains("[davis](protocols/davis.md)"));
    let page = dir.read("leaderboard/protocols/davis.md");
    for part in [
        "| davis: J&F |",
        "frames of 6 queries are first or last",
        "| oracle | 0.1.0 | baseline, used ground truth | 100.00 |",
    ] {
        assert!(page.contains(part), "{page}");
    }
    let rows = dir.table("leaderboard/protocols/davis.csv");
    // Whole, and of each of two scenes.
    assert_eq!(rows.len(), 6 * 3);
    let kept = dir.value("scores-davis/contestant/protocol-davis.json");
    for (scene, sheet) in [("", &kept["measures"]), ("room_discs", &kept["scenes"]["room_discs"])] {
        let row = rows.iter().find(|row| row["method"] == "contestant" && row["scene"] == scene).unwrap();
        assert_eq!(row["davis j_and_f"], format!("{:.4}", sheet["j_and_f"].as_f64().unwrap()));
    }
    let board = dir.json(LEADERBOARD);
    assert!(board["protocols"][0]["methods"][0]["measures"]["j_and_f"].is_number());
    assert_eq!(board["protocols"][0]["is_headline"], false);

    // What was judged against something else is reported and left out, what is damaged stops.
    let other = |card: &mut Value| card["benchmark_version"] = "0.0.9".into();
    dir.change("scores-davis/none/protocol-davis.json", other);
    std::fs::create_dir(dir.path("scores-davis/empty")).unwrap();
    score(&dir, "--protocol davis results/all --scenes room_discs");
    let empty = "scores-davis/empty: holds nothing of the protocol davis";
    make(&dir).says(0, &["scores-davis/none: was judged on benchmark 0.0.9", empty]);
    assert!(!dir.read("leaderboard/protocols/davis.csv").contains("none,"));
    assert!(dir.read("leaderboard/protocols/davis.md").contains("| all | 0.1.0 | baseline, partial |"));
    dir.edit("scores-davis/oracle/protocol-davis.csv", ",100,", ",NaN,");
    dir.run(LEADERBOARD).says(2, &["protocol-davis.csv: line "]);
}

#[test]
fn part_of_the_scenes_is_partial_until_the_board_is_of_that_part() {
    let dir = scored();
    score(&dir, "results/contestant --scenes room_discs");
    score(&dir, "results/none --scenes room_discs");
    let board = dir.json(LEADERBOARD);
    assert_eq!(named(&board["unranked"], "contestant")["unranked_because"][0], "partial");
    // Six methods, two of them partial: six pairs by three metrics.
    let pairs = dir.table("leaderboard/comparisons.csv");
    assert_eq!(pairs.len(), 18);
    for row in &pairs {
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        assert!(row["first"] != "none" && row["second"] != "none", "{row:?}");
        assert!(number("p") <= number("holm_p") && number("p") >= 0.5, "two scenes tell nothing: {row:?}");
        assert!(row["different"] == "false" && row["few_scenes"] == "true");
    }
    let board = dir.json(format!("{LEADERBOARD} --scenes room_discs"));
    assert_eq!((&board["ranked"][0]["name"], &board["queries"]), (&"contestant".into(), &4.into()));
}

#[test]
fn damage_is_named_and_the_old_board_stays() {
    let dir = made().copy();
    let before = dir.read("leaderboard/leaderboard.csv");
    let (counts, summary) = (dir.read("scores/oracle/counts.csv"), dir.read("scores/oracle/summary.json"));
    let lines: Vec<&str> = counts.lines().collect();
    let not_absent = lines.iter().position(|line| line.contains("true_absent")).unwrap();
    let without = [&lines[..not_absent], &lines[not_absent + 1..]].concat().join("\n");
    let cases = [
        ("scores/oracle/counts.csv", counts.replacen("hit", "NaN", 1), "counts.csv: line "),
        ("scores/oracle/counts.csv", lines[..lines.len() - 9].join("\n"), "do not follow from these rows"),
        ("scores/oracle/counts.csv", without, "counts.csv: rows: "),
        ("scores/oracle/counts.csv", counts.replacen(",union,", ",onion,", 1), "counts.csv: line 1: "),
        ("scores/oracle/counts.csv", String::new(), "counts.csv: line 1: "),
        ("scores/oracle/summary.json", "{".to_owned(), "summary.json"),
        ("scores/oracle/summary.json", dir.read("scores/none/summary.json"), "field `name`"),
        ("scores/oracle/summary.json", summary.replacen("100.0", "99.0", 1), "do not follow from these rows"),
        ("scores/oracle/summary.json", summary.replacen("100.0", "101.0", 1), "field `miou`: is 101"),
    ];
    for (file, text, reason) in cases {
        let good = dir.read(file);
        dir.write(file, text);
        dir.refuses(LEADERBOARD, &[reason]);
        dir.write(file, good);
    }
    dir.remove("scores/oracle/counts.csv");
    assert_eq!(dir.run(LEADERBOARD).code, 2);
    assert_eq!(dir.read("leaderboard/leaderboard.csv"), before);
}

#[test]
fn methods_scored_on_something_else_are_left_out_and_named() {
    let dir = scored();
    score(&dir, "results/all --hit-iou 0.5");
    make(&dir).says(0, &["scores/all/summary.json"]);
    let board = dir.value("leaderboard/board.json");
    let methods = board["methods"].as_array().unwrap();
    assert_eq!(methods.len(), BASELINES.len() - 1);
    assert!(methods.iter().all(|method| method["name"] != "all"));
}

#[test]
fn no_scores_unscored_folders_and_a_file_as_output_are_reported() {
    let dir = Dir::with_benchmark();
    dir.refuses(LEADERBOARD, &["scores"]);
    std::fs::create_dir(dir.path("scores")).unwrap();
    dir.refuses(LEADERBOARD, &["no scored method"]);

    let dir = scored();
    std::fs::create_dir(dir.path("scores/broken")).unwrap();
    make(&dir).says(0, &["scores/broken: holds no summary.json"]);
    dir.write("taken", "mine");
    dir.run(format!("{LEADERBOARD} -o taken")).says(2, &["taken"]);
    assert_eq!(dir.read("taken"), "mine");
}

#[test]
fn counts_alone_give_the_numbers_of_the_table() {
    let dir = made().copy();
    let recompute = || -> Run {
        let mut python = Command::new("python3");
        python.arg(root().join("benchmark/recompute.py")).current_dir(dir.path(""));
        python.args(["scores", "--bench", "benchmark", "--check", "leaderboard/leaderboard.csv"]);
        python.output().expect("python3 is on the PATH").into()
    };
    let run = recompute();
    run.says(0, &["48 numbers of leaderboard/leaderboard.csv compared, 0 differ"]);
    // Standard errors, too: both sides derive them from the rows.
    assert!(run.stdout.lines().next().unwrap().ends_with(",miou_error"), "{run}");
    let groups = dir.table("leaderboard/groups.csv");
    for line in run.stdout.lines().skip(1) {
        let (name, error) = (line.split(',').next().unwrap(), line.rsplit(',').next().unwrap());
        let all = groups.iter().find(|row| row["method"] == name && row["kind"] == "all").unwrap();
        assert_eq!(all["miou_error"], error, "{name}");
    }
    let counts = dir.read("scores/contestant/counts.csv");
    for (text, code, reason) in [
        (counts.replace(",miss,0,", ",hit,1,"), 1, "contestant: miou is"),
        (counts.replacen(",union,", ",onion,", 1), 2, "counts.csv: has no column union"),
        (counts.replacen(",miss,", ",miss,NaN", 1), 2, "counts.csv: line"),
    ] {
        dir.write("scores/contestant/counts.csv", text);
        recompute().says(code, &[reason]);
    }
}

#[test]
fn groups_hold_every_query_once_in_each_kind() {
    let dir = made();
    let mut groups = dir.table("leaderboard/groups.csv");
    groups.retain(|row| row["method"] == "contestant");
    let of = |kind: &str| groups.iter().filter(|row| row["kind"] == kind).collect::<Vec<_>>();
    let kinds =
        ["all", "category", "scale", "scale_category", "temporal", "size", "occlusion", "scene", "query"];
    for kind in kinds {
        let queries: usize = of(kind).iter().map(|row| row["queries"].parse::<usize>().unwrap()).sum();
        assert_eq!(queries, 8, "{kind}");
    }
    let all = of("all")[0];
    let number = |column: &str| all[column].parse::<f64>().unwrap();
    assert!(number("miou_low") <= number("miou") && number("miou") <= number("miou_high"), "{all:?}");
    assert_eq!((all["scenes"].as_str(), all["few_scenes"].as_str()), ("2", "true"));
    assert!(of("scene").iter().all(|row| row["miou_low"].is_empty()), "one scene says nothing of others");

    // The same from `score`.
    let dir = scored();
    let scores = dir.json("score --groups --profile tiny");
    let found = &named(&scores["methods"], "contestant")["groups"];
    assert_eq!(found.as_array().unwrap().len(), groups.len());
    assert!((found[0]["miou"]["value"].as_f64().unwrap() - number("miou")).abs() < 1e-4);
    let run = dir.succeed("score results/contestant --groups --profile tiny");
    run.says(0, &["contestant, with 95 % intervals clustered by scene"]);
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{run}");
}

#[test]
fn what_methods_and_papers_report_is_apart() {
    let dir = scored();
    for table in ["panoptic_l4d", "scales", "composites"] {
        let file = format!("benchmark/published/{table}.csv");
        dir.write(&file, shipped(&file));
    }
    dir.change("results/contestant/method.json", |card| {
        card["reported"] = serde_json::json!({"miou": 99.5, "action miou": 98, "vIoU": 0.7});
    });
    score(&dir, "results/contestant");
    make(&dir);
    let reported = dir.table("leaderboard/reported.csv");
    let reported: Vec<(&str, bool)> =
        reported.iter().map(|row| (row["number"].as_str(), row["recomputed"].is_empty())).collect();
    assert_eq!(reported, [("action miou", false), ("miou", false), ("vIoU", true)]);
    let page = dir.read("leaderboard/tables/panoptic_l4d.md");
    let (ours, paper) = page.split_once("## As reported in the paper, on its own data").unwrap();
    assert!(ours.contains("| contestant |") && !ours.contains("LangSplat"), "{page}");
    assert!(paper.contains("| LangSplat | 47.79 | 28.81 |") && !paper.contains("contestant"), "{page}");
    let rows = dir.table("leaderboard/tables/panoptic_l4d.csv");
    let of = |source: &str| rows.iter().find(|row| row["source"] == source).unwrap();
    assert!(of("published")["value"] == "47.7900" && of("published")["low"].is_empty());
    assert!(!of("measured")["low"].is_empty());
    assert!(dir.read("leaderboard/tables/scales.tex").contains("contestant, room"));
    let ranking = dir.read("leaderboard/leaderboard.csv");
    assert!(!ranking.contains("LangSplat"), "{ranking}");
    assert!(ranking.lines().nth(1).unwrap().starts_with("1,colour,contestant,"), "{ranking}");
}

/// As many methods as asked, all with the counts of one.
pub(crate) fn copies(dir: &Dir, count: usize) {
    let (counts, summary) =
        (dir.read("scores/contestant/counts.csv"), dir.read("scores/contestant/summary.json"));
    for index in 0..count {
        let name = format!("method{index:05}");
        dir.write(&format!("scores/{name}/counts.csv"), &counts);
        let own = summary.replacen("\"contestant\"", &format!("\"{name}\""), 1);
        dir.write(&format!("scores/{name}/summary.json"), own);
    }
}

#[test]
fn many_methods_are_ranked_and_the_first_compared() {
    let dir = scored();
    copies(&dir, 60);
    make(&dir).says(0, &["more methods are not compared"]);
    let ranked = dir.table("leaderboard/leaderboard.csv");
    assert_eq!(ranked.iter().filter(|row| row["rank"] == "1").count(), 61, "equal methods share a rank");
    let pairs = dir.table("leaderboard/comparisons.csv");
    assert_eq!(pairs.len(), 3 * 50 * 49 / 2);
    assert!(pairs.iter().all(|row| row["p"] == "1.0000" && row["difference"] == "0.0000"));
}

#[test]
fn one_query_and_one_scene_make_a_board() {
    let dir = Dir::with_benchmark();
    let queries = dir.read("benchmark/queries/room_discs.jsonl");
    dir.write("benchmark/queries/room_discs.jsonl", format!("{}\n", queries.lines().next().unwrap()));
    for verb in ["baseline", "score"] {
        dir.succeed(format!("{verb} --profile tiny --scenes room_discs"));
    }
    let run = dir.succeed(format!("{LEADERBOARD} --scenes room_discs"));
    run.says(0, &[" 1 query,", "One scene says nothing of others"]);
    assert!(!run.stdout.contains(" p:") && !run.stdout.contains("detect."), "{run}");
    let rows = dir.table("leaderboard/leaderboard.csv");
    assert!(rows.iter().all(|row| row["queries"] == "1" && row["miou_low"].is_empty()), "{rows:?}");
    assert!(dir.table("leaderboard/comparisons.csv").is_empty(), "one scene is no test");
}

#[test]
fn methods_that_learned_from_depth_are_ranked_among_their_own() {
    let dir = scored();
    for (baseline, name, depth) in [("none", "blank", false), ("oracle", "deep", true), ("all", "flat", true)]
    {
        add_contestant(&dir, baseline, name, depth);
    }
    let scored = dir.succeed("score --profile tiny");
    scored.says(0, &["track colour + depth, learned from rendered depth"]);
    for (name, is_marked) in [("deep ", true), ("contestant ", false)] {
        let line = scored.stdout.lines().find(|line| line.starts_with(name)).unwrap();
        assert_eq!(line.ends_with(" *"), is_marked, "{line}");
    }
    make(&dir);
    let rows = dir.table("leaderboard/leaderboard.csv");
    let track = |method: &str| &rows.iter().find(|row| row["method"] == method).unwrap()["track"];
    let pairs = dir.table("leaderboard/comparisons.csv");
    assert!(pairs.iter().any(|row| row["first"] == "deep" && row["second"] == "flat"));
    for row in &pairs {
        assert_eq!(track(&row["first"]), track(&row["second"]), "{row:?}");
    }
    let board = dir.json(LEADERBOARD);
    let deep = named(&board["ranked"], "deep");
    assert_eq!((&deep["track"], &deep["rank"]), (&"colour+depth".into(), &1.into()));
}

/// 991 270 rows a method: held as rows they alone would be 100 MB each.
#[test]
#[ignore = "slow: makes scores of 20 230 queries"]
fn a_page_of_twenty_thousand_queries_takes_less_than_300_mb() {
    let mut harness = Command::new("python3");
    harness.arg(root().join("perf/board.py")).args(["--l4d", env!("CARGO_BIN_EXE_l4d")]);
    let said = succeed(harness.args("--methods 2 --copies 70 --repeat 1 -- --html".split(' ')));
    let report: Value = serde_json::from_str(said.lines().next().unwrap()).unwrap();
    assert_eq!(report["queries"], 20_230, "{report}");
    assert!(report["peak_memory_mib"].as_u64().unwrap() < 300, "{report}");
}
