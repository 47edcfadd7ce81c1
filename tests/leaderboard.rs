//! `l4d leaderboard`: from scored baselines to tables and figures, and what it refuses.

use std::collections::BTreeMap;
use std::process::Command;

use l4d_data::json;
use serde_json::Value;

use crate::support::{Dir, Run, root};

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
    dir.edit("results/contestant/method.json", "\"baseline\": true", "\"baseline\": false");
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
    assert!(first.starts_with("1,colour,contestant,"), "{first}");
    assert!(first.contains(&format!(",8,{miou:.4},")), "{first}");
    let oracle = csv.lines().find(|line| line.contains(",oracle,")).unwrap();
    assert!(
        oracle.starts_with(',') && oracle.contains("\"baseline, used ground truth\",8,100.0000,"),
        "{oracle}"
    );

    let taken = dir.read("leaderboard/taken.csv");
    assert!(taken.starts_with("method,scene,query,meant,taken,which_is,"), "{taken}");
    let of = |method: &str, which: &str| {
        let row = |line: &&str| {
            line.starts_with(&format!("{method},")) && line.contains(&format!(",{which},Discs"))
        };
        taken.lines().filter(row).count()
    };
    assert_eq!((of("oracle", "meant"), of("none", "nothing")), (8, 8), "{taken}");
    assert_eq!(of("contestant", "meant") + of("contestant", "look_alike"), 8, "{taken}");

    for name in [
        "per_category",
        "per_scale",
        "metrics",
        "speed",
        "over_time",
        "taken",
        "queries_contestant",
        "confusion_contestant",
    ] {
        let svg = dir.read(&format!("leaderboard/figures/{name}.svg"));
        assert!(svg.starts_with("<svg role=\"img\" ") && svg.contains("profile tiny"), "{name}");
        assert!(svg.contains("\n<title>") && svg.contains("</title>\n<desc>Discs"), "{name}");
        let png = std::fs::read(dir.path(format!("leaderboard/figures/{name}.png"))).unwrap();
        assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n", "{name}");
    }
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(page.contains("(figures/per_category.svg)") && page.contains("2 verified by people"));
    assert!(
        page.contains("(figures/queries_contestant.svg)") && !page.contains("(figures/queries_none.svg)")
    );
    let speed = dir.read("leaderboard/figures/speed.svg");
    assert!(
        speed.contains("No method says how long it took.") && speed.contains("No time reported: contestant")
    );
}

#[test]
fn the_same_scores_give_the_same_bytes() {
    let dir = scored();
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    dir.succeed(&[&["leaderboard", "-o", "again"], &TINY[..]].concat());
    for file in [
        "leaderboard.csv",
        "per_scene.csv",
        "leaderboard.md",
        "figures/metrics.svg",
        "figures/metrics.png",
        "figures/confusion_contestant.svg",
        "figures/queries_contestant.png",
    ] {
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
    assert_eq!(oracle["unranked_because"], serde_json::json!(["baseline", "used ground truth"]));
    assert_eq!(oracle["scores"]["miou"], 100.0);
}

#[test]
fn no_baseline_is_ranked_whatever_its_card_says() {
    let dir = scored();
    dir.succeed(&["baseline", "random-look-alike", "--profile", "tiny"]);
    // A card of before there was the word: its name says what it is.
    for name in BASELINES {
        let card = format!("results/{name}/method.json");
        assert!(dir.read(&card).contains("\"baseline\": true"), "{name}");
        let text = dir.read(&card).replace("  \"baseline\": true,\n", "");
        dir.write(&card, text.replace("\"ground_truth\": true", "\"ground_truth\": false"));
    }
    // The word alone is enough, under any name.
    rename(&dir, "results/all", "results/everything");
    dir.edit("results/everything/method.json", "\"all\"", "\"everything\"");
    dir.edit("results/everything/method.json", "\"seconds\"", "\"baseline\": true, \"seconds\"");
    std::fs::remove_dir_all(dir.path("scores")).unwrap();
    dir.succeed(&[&["score"], &TINY[..]].concat());
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert_eq!(run.stdout.matches("(baseline)").count(), 6, "{}", run.stdout);
    let rows = table(&dir, "leaderboard/leaderboard.csv");
    let ranked: Vec<&str> =
        rows.iter().filter(|row| !row["rank"].is_empty()).map(|row| row["method"].as_str()).collect();
    assert_eq!(ranked, ["contestant"]);
    assert!(rows.iter().all(|row| row["rank"].is_empty() == (row["unranked_because"] == "baseline")));
    let page = dir.read("leaderboard/leaderboard.md");
    let (_, unranked) = page.split_once("## Not ranked, shown for scale").unwrap();
    assert!(unranked.contains("| everything | baseline |"), "{page}");
    assert!(dir.read("leaderboard/tables/panoptic_l4d.tex").contains("everything$^{\\dagger}$"));
}

#[test]
fn protocols_of_others_have_tables_apart_and_change_nothing_here() {
    let dir = scored();
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    let ranking = dir.read("leaderboard/leaderboard.csv");
    for protocol in ["davis", "hc-stvg"] {
        dir.succeed(&[&["score", "--protocol", protocol], &TINY[..]].concat());
    }
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(
        run.stdout.contains("Apart and never ranked, in leaderboard/protocols: davis, hc-stvg."),
        "{}",
        run.stdout
    );
    assert_eq!(dir.read("leaderboard/leaderboard.csv"), ranking);
    assert!(dir.read("leaderboard/leaderboard.md").contains("[davis](protocols/davis.md)"));
    let page = dir.read("leaderboard/protocols/davis.md");
    assert!(
        page.contains("| davis: J&F |") && page.contains("frames of 6 queries are first or last"),
        "{page}"
    );
    assert!(page.contains("| oracle | 0.1.0 | baseline, used ground truth | 100.00 |"), "{page}");
    let rows = table(&dir, "leaderboard/protocols/davis.csv");
    // Whole, and of each of two scenes.
    assert_eq!(rows.len(), 6 * 3);
    assert!(rows.iter().all(|row| row["protocol"] == "davis" && row.contains_key("davis j_and_f")));
    let kept: Value = json::read(&dir.path("scores-davis/contestant/protocol-davis.json")).unwrap();
    let of = |scene: &str| {
        rows.iter().find(|row| row["method"] == "contestant" && row["scene"] == scene).unwrap()["davis j_and_f"].clone()
    };
    assert_eq!(of(""), format!("{:.4}", kept["measures"]["j_and_f"].as_f64().unwrap()));
    assert_eq!(of("room_discs"), format!("{:.4}", kept["scenes"]["room_discs"]["j_and_f"].as_f64().unwrap()));
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    assert!(board["protocols"][0]["methods"][0]["measures"]["j_and_f"].is_number());
    assert_eq!(
        (&board["protocols"][0]["is_headline"], board["protocols"].as_array().unwrap().len()),
        (&false.into(), 2)
    );

    // What was judged against something else is told and left out, what is damaged stops.
    let card = "scores-davis/none/protocol-davis.json";
    dir.edit(card, "\"benchmark_version\": \"0.1.0\"", "\"benchmark_version\": \"0.0.9\"");
    std::fs::create_dir(dir.path("scores-davis/empty")).unwrap();
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(run.stderr.contains("scores-davis/none: was judged on benchmark 0.0.9"), "{}", run.stderr);
    assert!(run.stderr.contains("scores-davis/empty: holds nothing of the protocol davis"), "{}", run.stderr);
    assert!(!dir.read("leaderboard/protocols/davis.csv").contains("none,"));
    let part = ["--profile", "tiny", "--scenes", "room_discs"];
    dir.succeed(&[&["score", "results/all", "--protocol", "davis"], &part[..]].concat());
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(dir.read("leaderboard/protocols/davis.md").contains("| all | 0.1.0 | baseline, partial |"));
    dir.edit("scores-davis/oracle/protocol-davis.csv", ",100,", ",NaN,");
    let run = leaderboard(&dir);
    assert!(
        run.code == 2 && run.stderr.contains("protocol-davis.csv: line ") && run.stderr.contains("hint:"),
        "{}",
        run.stderr
    );
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
        ("scores/oracle/counts.csv", counts.replacen(",union,", ",onion,", 1), "counts.csv: line 2: "),
        ("scores/oracle/counts.csv", String::new(), "do not follow from these rows"),
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

/// A table by its columns.
fn table(dir: &Dir, file: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(dir.path(file)).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

fn recompute(dir: &Dir, arguments: &[&str]) -> Run {
    let mut python = Command::new("python3");
    python.arg(root().join("benchmark/recompute.py")).args(arguments).current_dir(dir.path(""));
    python.output().expect("python3 is on the PATH").into()
}

#[test]
fn counts_alone_give_the_numbers_of_the_table() {
    let dir = scored();
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    let check = ["scores", "--bench", "benchmark", "--check", "leaderboard/leaderboard.csv"];
    let run = recompute(&dir, &check);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert!(
        run.stderr.contains("48 numbers of leaderboard/leaderboard.csv compared, 0 differ"),
        "{}",
        run.stderr
    );
    assert!(run.stdout.lines().nth(1).unwrap().starts_with("oracle,8,100.0000,"), "{}", run.stdout);

    // Standard errors, too: both sides derive them from the rows.
    let header = run.stdout.lines().next().unwrap();
    assert!(header.ends_with(",miou_error"), "{header}");
    let groups = table(&dir, "leaderboard/groups.csv");
    for line in run.stdout.lines().skip(1) {
        let (name, error) = (line.split(',').next().unwrap(), line.rsplit(',').next().unwrap());
        let all = groups.iter().find(|row| row["method"] == name && row["kind"] == "all").unwrap();
        assert_eq!(all["miou_error"], error, "{name}");
    }

    let counts = dir.read("scores/contestant/counts.csv");
    let changes = [
        (counts.replace(",miss,0,", ",hit,1,"), 1, "contestant: miou is"),
        (counts.replacen(",union,", ",onion,", 1), 2, "counts.csv: has no column union"),
        (counts.replacen(",miss,", ",miss,NaN", 1), 2, "counts.csv: line"),
    ];
    for (text, code, told) in changes {
        dir.write("scores/contestant/counts.csv", text);
        let run = recompute(&dir, &check);
        assert!(run.code == code && run.stderr.contains(told), "{told}: {} {}", run.code, run.stderr);
    }
}

#[test]
fn groups_hold_every_query_once_in_each_kind() {
    let dir = scored();
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    let groups = table(&dir, "leaderboard/groups.csv");
    let of = |kind: &str| -> Vec<&BTreeMap<String, String>> {
        groups.iter().filter(|row| row["method"] == "contestant" && row["kind"] == kind).collect()
    };
    for kind in
        ["all", "category", "scale", "scale_category", "temporal", "size", "occlusion", "scene", "query"]
    {
        let queries: usize = of(kind).iter().map(|row| row["queries"].parse::<usize>().unwrap()).sum();
        assert_eq!(queries, 8, "{kind}");
    }
    let all = of("all")[0];
    let number = |column: &str| all[column].parse::<f64>().unwrap();
    assert!(number("miou_low") <= number("miou") && number("miou") <= number("miou_high"), "{all:?}");
    assert_eq!((all["scenes"].as_str(), all["few_scenes"].as_str()), ("2", "true"));
    assert!(of("scene").iter().all(|row| row["miou_low"].is_empty()), "one scene says nothing of others");

    // The same from `score`.
    let scores = dir.json(&[&["score", "--groups"], &TINY[..]].concat());
    let method =
        scores["methods"].as_array().unwrap().iter().find(|row| row["name"] == "contestant").unwrap();
    let found = method["groups"].as_array().unwrap();
    assert_eq!(found.len(), groups.iter().filter(|row| row["method"] == "contestant").count());
    assert_eq!(found[0]["kind"], "all");
    assert!((found[0]["miou"]["value"].as_f64().unwrap() - number("miou")).abs() < 1e-4);
    let run = dir.succeed(&[&["score", "--groups"], &TINY[..]].concat());
    assert!(run.stdout.contains("contestant, with 95 % intervals clustered by scene"), "{}", run.stdout);
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{}", run.stdout);
}

#[test]
fn pairs_are_compared_and_partial_methods_are_not() {
    let dir = scored();
    dir.succeed(&["score", "results/none", "--profile", "tiny", "--scenes", "room_discs"]);
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(run.stdout.contains("ahead of the next"), "{}", run.stdout);
    let pairs = table(&dir, "leaderboard/comparisons.csv");
    // Six methods, one of them partial: ten pairs by three metrics.
    assert_eq!(pairs.len(), 30);
    assert!(pairs.iter().all(|row| row["first"] != "none" && row["second"] != "none"));
    for row in &pairs {
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        assert!(number("p") <= number("holm_p") && number("p") >= 0.5, "two scenes tell nothing: {row:?}");
        assert!(row["different"] == "false" && row["few_scenes"] == "true");
    }
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    assert_eq!(board["comparisons"].as_array().unwrap().len(), 30);
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(page.contains("## What can be told apart") && page.contains("fewer than 8 scenes"), "{page}");
}

#[test]
fn what_a_method_reports_stands_beside_what_is_counted() {
    let dir = scored();
    let card = "results/contestant/method.json";
    dir.edit(
        card,
        "\"seconds\"",
        "\"reported\": {\"miou\": 99.5, \"action miou\": 98, \"vIoU\": 0.7}, \"seconds\"",
    );
    dir.succeed(&[&["score"], &TINY[..]].concat());
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    let rows = table(&dir, "leaderboard/reported.csv");
    let shown: Vec<(&str, bool)> =
        rows.iter().map(|row| (row["number"].as_str(), row["recomputed"].is_empty())).collect();
    assert_eq!(shown, [("action miou", false), ("miou", false), ("vIoU", true)]);
    let summary: Value = json::read(&dir.path("scores/contestant/summary.json")).unwrap();
    assert_eq!(rows[1]["recomputed"], format!("{:.4}", summary["miou"].as_f64().unwrap()));
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(
        page.contains("## Reported by the methods themselves")
            && page.contains("| contestant | miou | 99.50 |")
    );
    assert!(
        dir.read("leaderboard/leaderboard.csv").lines().nth(1).unwrap().starts_with("1,colour,contestant,")
    );
}

#[test]
fn tables_of_the_paper_stand_apart() {
    let dir = scored();
    for table in ["panoptic_l4d", "scales", "composites"] {
        let text = std::fs::read(root().join(format!("benchmark/published/{table}.csv"))).unwrap();
        dir.write(&format!("benchmark/published/{table}.csv"), text);
    }
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    let page = dir.read("leaderboard/tables/panoptic_l4d.md");
    let (ours, reported) = page.split_once("## As reported in the paper, on its own data").unwrap();
    assert!(ours.contains("| contestant |") && !ours.contains("LangSplat"), "{page}");
    assert!(reported.contains("| LangSplat | 47.79 | 28.81 |") && !reported.contains("contestant"), "{page}");
    let rows = table(&dir, "leaderboard/tables/panoptic_l4d.csv");
    assert!(
        rows.iter()
            .any(|row| row["source"] == "published" && row["value"] == "47.7900" && row["low"].is_empty())
    );
    assert!(
        rows.iter().any(|row| row["source"] == "measured" && !row["low"].is_empty() && row["queries"] == "8")
    );
    assert!(dir.read("leaderboard/tables/scales.tex").contains("contestant, room"));
    let ranking = dir.read("leaderboard/leaderboard.csv");
    assert!(!ranking.contains("LangSplat"), "{ranking}");
}

/// As many methods as asked, all with the counts of one.
pub(crate) fn copies(dir: &Dir, count: usize) {
    let (counts, summary) =
        (dir.read("scores/contestant/counts.csv"), dir.read("scores/contestant/summary.json"));
    for index in 0..count {
        let name = format!("method{index:05}");
        dir.write(&format!("scores/{name}/counts.csv"), &counts);
        dir.write(
            &format!("scores/{name}/summary.json"),
            summary.replacen("\"contestant\"", &format!("\"{name}\""), 1),
        );
    }
}

#[test]
fn hundreds_of_methods_are_ranked_and_the_first_compared() {
    let dir = scored();
    copies(&dir, 400);
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert!(run.stdout.contains("more methods are not compared"), "{}", run.stdout);
    let ranked = table(&dir, "leaderboard/leaderboard.csv");
    assert_eq!(ranked.iter().filter(|row| row["rank"] == "1").count(), 401, "equal methods share a rank");
    let pairs = table(&dir, "leaderboard/comparisons.csv");
    assert_eq!(pairs.len(), 3 * 50 * 49 / 2);
    assert!(pairs.iter().all(|row| row["p"] == "1.0000" && row["difference"] == "0.0000"));
}

#[test]
fn one_query_and_one_scene_make_a_board() {
    let dir = Dir::with_benchmark();
    let queries = dir.read("benchmark/queries/room_discs.jsonl");
    dir.write("benchmark/queries/room_discs.jsonl", format!("{}\n", queries.lines().next().unwrap()));
    let one = ["--profile", "tiny", "--scenes", "room_discs"];
    dir.succeed(&[&["baseline"], &one[..]].concat());
    dir.succeed(&[&["score"], &one[..]].concat());
    let run = dir.succeed(&[&["leaderboard"], &one[..]].concat());
    assert!(run.stdout.contains(" 1 query,"), "{}", run.stdout);
    let rows = table(&dir, "leaderboard/leaderboard.csv");
    assert!(rows.iter().all(|row| row["queries"] == "1" && row["miou_low"].is_empty()), "{rows:?}");
    assert!(table(&dir, "leaderboard/comparisons.csv").is_empty(), "one scene is no test");
    assert!(run.stdout.contains("One scene says nothing of others"), "{}", run.stdout);
    assert!(!run.stdout.contains(" p:") && !run.stdout.contains("detect."), "{}", run.stdout);
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(!page.contains("What can be told apart") && !page.contains("In brackets"), "{page}");
}

/// A baseline as a method of its own that says what it looked at.
fn contestant(dir: &Dir, baseline: &str, name: &str, saw_depth: bool) {
    crate::solving::copy(&dir.path(format!("results/{baseline}")), &dir.path(format!("results/{name}")));
    let path = format!("results/{name}/method.json");
    let card = dir.read(&path);
    let card = card.replacen(&format!("\"{baseline}\""), &format!("\"{name}\""), 1);
    let card = card.replace("\"ground_truth\": true", "\"ground_truth\": false");
    let card = card.replace("  \"baseline\": true,\n", "");
    dir.write(&path, card.replace("\"depth\": false", &format!("\"depth\": {saw_depth}")));
}

/// Two methods of each track; those that learned from depth are ahead of both others.
fn tracked() -> Dir {
    let dir = scored();
    contestant(&dir, "none", "blank", false);
    contestant(&dir, "oracle", "deep", true);
    contestant(&dir, "all", "flat", true);
    dir.succeed(&[&["score"], &TINY[..]].concat());
    dir
}

#[test]
fn who_learned_from_depth_is_ranked_among_its_own() {
    let dir = tracked();
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    let (colour, depth) = run.stdout.split_once("track: colour + depth\n").unwrap();
    assert!(colour.contains("track: colour\n   1 contestant"), "{}", run.stdout);
    assert!(depth.contains("   1 deep ") && depth.contains("   2 flat "), "{}", run.stdout);
    let rows = table(&dir, "leaderboard/leaderboard.csv");
    let ranks: Vec<[&str; 3]> = rows
        .iter()
        .filter(|row| !row["rank"].is_empty())
        .map(|row| ["track", "rank", "method"].map(|column| row[column].as_str()))
        .collect();
    let expected = [
        ["colour", "1", "contestant"],
        ["colour", "2", "blank"],
        ["colour+depth", "1", "deep"],
        ["colour+depth", "2", "flat"],
    ];
    assert_eq!(ranks, expected);
    let miou =
        |name: &str| rows.iter().find(|row| row["method"] == name).unwrap()["miou"].parse::<f64>().unwrap();
    assert!(miou("deep") > miou("contestant"), "a higher number has no rank among the others");

    let track_of: BTreeMap<&str, &str> =
        rows.iter().map(|row| (row["method"].as_str(), row["track"].as_str())).collect();
    let pairs = table(&dir, "leaderboard/comparisons.csv");
    assert!(pairs.iter().any(|row| row["first"] == "deep" && row["second"] == "flat"));
    for row in &pairs {
        assert_eq!(track_of[row["first"].as_str()], track_of[row["second"].as_str()], "{row:?}");
        assert_eq!(track_of[row["first"].as_str()], row["track"], "{row:?}");
    }
    let page = dir.read("leaderboard/leaderboard.md");
    let (colour, depth) = page.split_once("## Track: colour + depth\n").unwrap();
    assert!(colour.contains("| 1 | contestant |") && !colour.contains("| deep |"), "{page}");
    assert!(depth.contains("| 1 | deep |") && depth.contains("**100.00**"), "{page}");
    assert!(dir.read("leaderboard/tables/panoptic_l4d.tex").contains("\\emph{Track: colour + depth}"));
    for figure in ["per_category", "metrics", "over_time", "taken"] {
        assert!(dir.read(&format!("leaderboard/figures/{figure}.svg")).contains("deep + depth"), "{figure}");
    }
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    let deep = board["ranked"].as_array().unwrap().iter().find(|method| method["name"] == "deep").unwrap();
    assert_eq!((&deep["track"], &deep["rank"]), (&"colour+depth".into(), &1.into()));
    let run = dir.succeed(&[&["score"], &TINY[..]].concat());
    assert!(run.stdout.contains("track colour + depth, learned from rendered depth"), "{}", run.stdout);
    assert!(
        run.stdout.lines().any(|line| line.starts_with("deep ") && line.ends_with(" *")),
        "{}",
        run.stdout
    );
    assert!(!run.stdout.lines().any(|line| line.starts_with("contestant ") && line.ends_with('*')));
}

#[test]
fn a_method_without_rivals_in_its_track_is_not_called_best() {
    let dir = scored();
    contestant(&dir, "oracle", "deep", true);
    dir.succeed(&[&["score"], &TINY[..]].concat());
    let run = dir.succeed(&[&["leaderboard"], &TINY[..]].concat());
    assert_eq!(run.stdout.matches("   1 ").count(), 4, "one in each track, in two tables: {}", run.stdout);
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(!page.contains("**") && !page.contains("Best"), "{page}");
    let table = dir.read("leaderboard/tables/panoptic_l4d.tex");
    assert!(!table.contains("textbf") && !table.contains("underline"), "{table}");
    assert!(!dir.read("leaderboard/tables/panoptic_l4d.md").contains("**"));
}
