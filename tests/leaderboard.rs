//! `l4d leaderboard`: from scored baselines to the document, tables and figures, and what it refuses.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;

use l4d_board::Board;
use l4d_data::json;
use serde_json::Value;

use crate::support::{Dir, Run, root};

const TINY: [&str; 2] = ["--profile", "tiny"];
const BASELINES: [&str; 6] =
    ["all", "look-alike-union", "none", "oracle", "random-look-alike", "time-agnostic"];

fn leaderboard(dir: &Dir) -> Run {
    dir.run(&[&["leaderboard"], &TINY[..]].concat())
}

fn make(dir: &Dir) -> Run {
    dir.succeed(&[&["leaderboard"], &TINY[..]].concat())
}

fn score(dir: &Dir, more: &[&str]) {
    dir.succeed(&[&["score"], &TINY[..], more].concat());
}

/// Scored baselines; `contestant` is the random look-alike under a name of its own, without truth.
pub(crate) fn scored() -> Dir {
    let dir = Dir::with_benchmark();
    dir.succeed(&[&["baseline"], &TINY[..]].concat());
    std::fs::rename(dir.path("results/random-look-alike"), dir.path("results/contestant")).unwrap();
    let card = "results/contestant/method.json";
    dir.edit(card, "random-look-alike", "contestant");
    dir.edit(card, "\"ground_truth\": true", "\"ground_truth\": false");
    dir.edit(card, "\"baseline\": true", "\"baseline\": false");
    score(&dir, &[]);
    dir
}

/// A baseline as a method of its own that says what it looked at.
pub(crate) fn contestant(dir: &Dir, baseline: &str, name: &str, saw_depth: bool) {
    crate::solving::copy(&dir.path(format!("results/{baseline}")), &dir.path(format!("results/{name}")));
    let path = format!("results/{name}/method.json");
    let card = dir.read(&path).replacen(&format!("\"{baseline}\""), &format!("\"{name}\""), 1);
    let card = card.replace("\"ground_truth\": true", "\"ground_truth\": false");
    let card = card.replace("  \"baseline\": true,\n", "");
    dir.write(&path, card.replace("\"depth\": false", &format!("\"depth\": {saw_depth}")));
}

/// A table by its columns.
fn table(dir: &Dir, file: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(dir.path(file)).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

/// All files of a folder with their bytes.
fn files(folder: PathBuf) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        match entry.path().is_dir() {
            true => {
                found.extend(
                    files(entry.path()).into_iter().map(|(rest, bytes)| (format!("{name}/{rest}"), bytes)),
                );
            }
            false => {
                found.insert(name, std::fs::read(entry.path()).unwrap());
            }
        }
    }
    found
}

#[test]
fn scores_become_a_document_tables_and_figures() {
    let dir = scored();
    let run = make(&dir);
    let line = "Made up 0.1.0 · protocol l4d · profile tiny · 8 queries, 2 verified by people, 2 rejected\n";
    assert!(run.stdout.starts_with(line) && run.stdout.contains("   1 contestant"), "{}", run.stdout);
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{}", run.stdout);
    assert!(run.stderr.contains("leaderboard/leaderboard.csv"), "{}", run.stderr);
    let written = files(dir.path("leaderboard"));
    for figure in ["per_category", "metrics", "speed", "taken", "queries_contestant", "confusion_contestant"]
    {
        let svg = String::from_utf8_lossy(&written[&format!("figures/{figure}.svg")]);
        assert!(svg.starts_with("<svg role=\"img\" ") && svg.contains("profile tiny"), "{figure}");
        assert!(written[&format!("figures/{figure}.png")].starts_with(b"\x89PNG\r\n\x1a\n"), "{figure}");
    }
    let page = dir.read("leaderboard/leaderboard.md");
    assert!(
        page.contains("(figures/queries_contestant.svg)") && !page.contains("(figures/queries_none.svg)")
    );

    let board = Board::read(&dir.path("leaderboard/board.json")).unwrap();
    let summary: Value = json::read(&dir.path("scores/contestant/summary.json")).unwrap();
    assert_eq!(summary["miou"], board.methods[0].scores.headline.percent.miou.unwrap());
    assert_eq!((board.heading.queries, board.methods[0].answers.len()), (8, 8));

    let taken = table(&dir, "leaderboard/taken.csv");
    let of = |method: &str, which: &str| {
        taken.iter().filter(|row| row["method"] == method && row["which_is"] == which).count()
    };
    assert_eq!((of("oracle", "meant"), of("none", "nothing")), (8, 8));
    assert_eq!(of("contestant", "meant") + of("contestant", "look_alike"), 8);
}

#[test]
fn the_same_scores_give_the_same_bytes() {
    let dir = scored();
    for output in ["leaderboard", "again"] {
        dir.succeed(&[&["leaderboard", "--html", "-o", output], &TINY[..]].concat());
    }
    let (first, second) = (files(dir.path("leaderboard")), files(dir.path("again")));
    assert!(first.keys().eq(second.keys()) && first.contains_key("index.html"));
    for (name, bytes) in &first {
        assert!(second[name] == *bytes, "{name}");
    }
}

#[test]
fn json_says_which_are_ranked_and_why_others_are_not() {
    let dir = scored();
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    assert_eq!((&board["ranked"][0]["name"], &board["ranked"][0]["rank"]), (&"contestant".into(), &1.into()));
    assert_eq!((&board["queries"], &board["verified_queries"]), (&8.into(), &2.into()));
    assert_eq!(board["rejected_queries"], 2);
    let unranked = board["unranked"].as_array().unwrap();
    let oracle = unranked.iter().find(|method| method["name"] == "oracle").unwrap();
    assert_eq!(oracle["unranked_because"], serde_json::json!(["baseline", "used ground truth"]));
    assert_eq!(oracle["scores"]["miou"], 100.0);
}

#[test]
fn no_baseline_is_ranked_whatever_its_card_says() {
    let dir = scored();
    dir.succeed(&["baseline", "random-look-alike", "--profile", "tiny"]);
    // A card of versions before the field: its name says what it is.
    for name in BASELINES {
        let card = format!("results/{name}/method.json");
        let text = dir.read(&card).replace("  \"baseline\": true,\n", "");
        dir.write(&card, text.replace("\"ground_truth\": true", "\"ground_truth\": false"));
    }
    // The field alone is enough, under any name.
    std::fs::rename(dir.path("results/all"), dir.path("results/everything")).unwrap();
    dir.edit("results/everything/method.json", "\"all\"", "\"everything\"");
    dir.edit("results/everything/method.json", "\"seconds\"", "\"baseline\": true, \"seconds\"");
    std::fs::remove_dir_all(dir.path("scores")).unwrap();
    score(&dir, &[]);
    make(&dir);
    for row in table(&dir, "leaderboard/leaderboard.csv") {
        let is_ranked = row["method"] == "contestant";
        assert_eq!((row["rank"].is_empty(), row["unranked_because"] == "baseline"), (!is_ranked, !is_ranked));
    }
    assert!(dir.read("leaderboard/leaderboard.md").contains("| everything | baseline |"));
    assert!(dir.read("leaderboard/tables/panoptic_l4d.tex").contains("everything$^{\\dagger}$"));
}

#[test]
fn protocols_of_others_have_tables_apart_and_change_nothing_here() {
    let dir = scored();
    make(&dir);
    let ranking = dir.read("leaderboard/leaderboard.csv");
    for protocol in ["davis", "mevis"] {
        score(&dir, &["--protocol", protocol]);
    }
    let run = make(&dir);
    assert!(run.stdout.contains("Apart and never ranked, in leaderboard/protocols: davis, mevis."));
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
    let kept: Value = json::read(&dir.path("scores-davis/contestant/protocol-davis.json")).unwrap();
    for (scene, told) in [("", &kept["measures"]), ("room_discs", &kept["scenes"]["room_discs"])] {
        let row = rows.iter().find(|row| row["method"] == "contestant" && row["scene"] == scene).unwrap();
        assert_eq!(row["davis j_and_f"], format!("{:.4}", told["j_and_f"].as_f64().unwrap()));
    }
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    assert!(board["protocols"][0]["methods"][0]["measures"]["j_and_f"].is_number());
    assert_eq!(board["protocols"][0]["is_headline"], false);

    // What was judged against something else is reported and left out, what is damaged stops.
    let card = "scores-davis/none/protocol-davis.json";
    dir.edit(card, "\"benchmark_version\": \"0.1.0\"", "\"benchmark_version\": \"0.0.9\"");
    std::fs::create_dir(dir.path("scores-davis/empty")).unwrap();
    score(&dir, &["--protocol", "davis", "results/all", "--scenes", "room_discs"]);
    let run = make(&dir);
    assert!(run.stderr.contains("scores-davis/none: was judged on benchmark 0.0.9"), "{}", run.stderr);
    assert!(run.stderr.contains("scores-davis/empty: holds nothing of the protocol davis"), "{}", run.stderr);
    assert!(!dir.read("leaderboard/protocols/davis.csv").contains("none,"));
    assert!(dir.read("leaderboard/protocols/davis.md").contains("| all | 0.1.0 | baseline, partial |"));
    dir.edit("scores-davis/oracle/protocol-davis.csv", ",100,", ",NaN,");
    let run = leaderboard(&dir);
    assert!(run.code == 2 && run.stderr.contains("protocol-davis.csv: line "), "{}", run.stderr);
}

#[test]
fn part_of_the_scenes_is_partial_until_the_board_is_of_that_part() {
    let dir = scored();
    score(&dir, &["results/contestant", "--scenes", "room_discs"]);
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    let unranked = board["unranked"].as_array().unwrap();
    let partial = unranked.iter().find(|method| method["name"] == "contestant").unwrap();
    assert_eq!(partial["unranked_because"][0], "partial");
    let board = dir.json(&["leaderboard", "--profile", "tiny", "--scenes", "room_discs"]);
    assert_eq!((&board["ranked"][0]["name"], &board["queries"]), (&"contestant".into(), &4.into()));
}

#[test]
fn other_versions_and_protocols_are_apart() {
    let dir = scored();
    let version = "\"benchmark_version\": \"0.";
    dir.edit("scores/oracle/summary.json", &format!("{version}1.0\""), &format!("{version}0.9\""));
    score(&dir, &["results/contestant", "--hit-iou", "0.5"]);
    let run = make(&dir);
    assert!(run.stdout.contains("not of this board: benchmark 0.0.9"), "{}", run.stdout);
    assert!(run.stdout.contains("protocol l4d with hits above IoU 0.5"), "{}", run.stdout);
    assert!(run.stderr.contains("warning:") && run.stderr.contains("0.0.9"), "{}", run.stderr);
    let csv = dir.read("leaderboard/leaderboard.csv");
    assert!(!csv.contains("oracle") && !csv.contains("contestant"), "{csv}");
    for name in ["all", "look-alike-union", "none", "time-agnostic", "contestant"] {
        std::fs::remove_dir_all(dir.path(format!("scores/{name}"))).unwrap();
    }
    let run = leaderboard(&dir);
    assert!(run.code == 2 && run.stderr.contains("no method was scored on Made up 0.1.0"), "{}", run.stderr);
}

#[test]
fn damage_is_named_and_the_old_board_stays() {
    let dir = scored();
    make(&dir);
    let before = dir.read("leaderboard/leaderboard.csv");
    let (counts, summary) = (dir.read("scores/oracle/counts.csv"), dir.read("scores/oracle/summary.json"));
    let lines: Vec<&str> = counts.lines().collect();
    let not_absent = lines.iter().position(|line| line.contains("true_absent")).unwrap();
    let without = [&lines[..not_absent], &lines[not_absent + 1..]].concat().join("\n");
    let cases = [
        ("scores/oracle/counts.csv", counts.replacen("hit", "NaN", 1), "counts.csv: line "),
        ("scores/oracle/counts.csv", lines[..lines.len() - 9].join("\n"), "do not follow from these rows"),
        ("scores/oracle/counts.csv", without, "counts.csv: rows: "),
        ("scores/oracle/counts.csv", counts.replacen(",union,", ",onion,", 1), "counts.csv: line 2: "),
        ("scores/oracle/counts.csv", String::new(), "do not follow from these rows"),
        ("scores/oracle/summary.json", "{".to_owned(), "summary.json"),
        ("scores/oracle/summary.json", dir.read("scores/none/summary.json"), "field `name`"),
        ("scores/oracle/summary.json", summary.replacen("100.0", "99.0", 1), "do not follow from these rows"),
        ("scores/oracle/summary.json", summary.replacen("100.0", "101.0", 1), "field `miou`: is 101"),
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
fn no_scores_unscored_folders_and_a_file_as_output_are_reported() {
    let dir = Dir::with_benchmark();
    let run = leaderboard(&dir);
    assert!(run.code == 2 && run.stderr.contains("scores") && run.stderr.contains("hint:"), "{}", run.stderr);
    std::fs::create_dir(dir.path("scores")).unwrap();
    let run = leaderboard(&dir);
    assert!(run.code == 2 && run.stderr.contains("no scored method"), "{}", run.stderr);

    let dir = scored();
    std::fs::create_dir(dir.path("scores/broken")).unwrap();
    assert!(make(&dir).stderr.contains("scores/broken: holds no summary.json"));
    dir.write("taken", "mine");
    let run = dir.run(&["leaderboard", "-o", "taken", "--profile", "tiny"]);
    assert!(run.code == 2 && run.stderr.contains("taken"), "{}", run.stderr);
    assert_eq!(dir.read("taken"), "mine");
}

fn recompute(dir: &Dir, arguments: &[&str]) -> Run {
    let mut python = Command::new("python3");
    python.arg(root().join("benchmark/recompute.py")).args(arguments).current_dir(dir.path(""));
    python.output().expect("python3 is on the PATH").into()
}

#[test]
fn counts_alone_give_the_numbers_of_the_table() {
    let dir = scored();
    make(&dir);
    let check = ["scores", "--bench", "benchmark", "--check", "leaderboard/leaderboard.csv"];
    let run = recompute(&dir, &check);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains("48 numbers of leaderboard/leaderboard.csv compared, 0 differ"));
    // Standard errors, too: both sides derive them from the rows.
    assert!(run.stdout.lines().next().unwrap().ends_with(",miou_error"), "{}", run.stdout);
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
    make(&dir);
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
    let methods = scores["methods"].as_array().unwrap();
    let found = &methods.iter().find(|row| row["name"] == "contestant").unwrap()["groups"];
    let rows = groups.iter().filter(|row| row["method"] == "contestant").count();
    assert_eq!(found.as_array().unwrap().len(), rows);
    assert!((found[0]["miou"]["value"].as_f64().unwrap() - number("miou")).abs() < 1e-4);
    let run = dir.succeed(&[&["score", "--groups"], &TINY[..]].concat());
    assert!(run.stdout.contains("contestant, with 95 % intervals clustered by scene"), "{}", run.stdout);
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{}", run.stdout);
}

#[test]
fn pairs_are_compared_and_partial_methods_are_not() {
    let dir = scored();
    score(&dir, &["results/none", "--scenes", "room_discs"]);
    make(&dir);
    let pairs = table(&dir, "leaderboard/comparisons.csv");
    // Six methods, one of them partial: ten pairs by three metrics.
    assert_eq!(pairs.len(), 30);
    for row in &pairs {
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        assert!(row["first"] != "none" && row["second"] != "none", "{row:?}");
        assert!(number("p") <= number("holm_p") && number("p") >= 0.5, "two scenes tell nothing: {row:?}");
        assert!(row["different"] == "false" && row["few_scenes"] == "true");
    }
}

#[test]
fn what_methods_and_papers_report_is_apart() {
    let dir = scored();
    for table in ["panoptic_l4d", "scales", "composites"] {
        let text = std::fs::read(root().join(format!("benchmark/published/{table}.csv"))).unwrap();
        dir.write(&format!("benchmark/published/{table}.csv"), text);
    }
    let reported = "\"reported\": {\"miou\": 99.5, \"action miou\": 98, \"vIoU\": 0.7}, \"seconds\"";
    dir.edit("results/contestant/method.json", "\"seconds\"", reported);
    score(&dir, &[]);
    make(&dir);
    let reported: Vec<(String, bool)> = table(&dir, "leaderboard/reported.csv")
        .iter()
        .map(|row| (row["number"].clone(), row["recomputed"].is_empty()))
        .collect();
    assert_eq!(
        reported,
        [("action miou", false), ("miou", false), ("vIoU", true)].map(|(a, b)| (a.to_owned(), b))
    );
    let page = dir.read("leaderboard/tables/panoptic_l4d.md");
    let (ours, paper) = page.split_once("## As reported in the paper, on its own data").unwrap();
    assert!(ours.contains("| contestant |") && !ours.contains("LangSplat"), "{page}");
    assert!(paper.contains("| LangSplat | 47.79 | 28.81 |") && !paper.contains("contestant"), "{page}");
    let rows = table(&dir, "leaderboard/tables/panoptic_l4d.csv");
    let of = |source: &str| rows.iter().find(|row| row["source"] == source).unwrap();
    assert!(of("published")["value"] == "47.7900" && of("published")["low"].is_empty());
    assert!(
        !of("measured")["low"].is_empty()
            && dir.read("leaderboard/tables/scales.tex").contains("contestant, room")
    );
    let ranking = dir.read("leaderboard/leaderboard.csv");
    assert!(
        !ranking.contains("LangSplat") && ranking.lines().nth(1).unwrap().starts_with("1,colour,contestant,")
    );
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
    let run = make(&dir);
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
    for verb in ["baseline", "score"] {
        dir.succeed(&[&[verb], &one[..]].concat());
    }
    let run = dir.succeed(&[&["leaderboard"], &one[..]].concat());
    assert!(run.stdout.contains(" 1 query,"), "{}", run.stdout);
    assert!(run.stdout.contains("One scene says nothing of others"), "{}", run.stdout);
    assert!(!run.stdout.contains(" p:") && !run.stdout.contains("detect."), "{}", run.stdout);
    let rows = table(&dir, "leaderboard/leaderboard.csv");
    assert!(rows.iter().all(|row| row["queries"] == "1" && row["miou_low"].is_empty()), "{rows:?}");
    assert!(table(&dir, "leaderboard/comparisons.csv").is_empty(), "one scene is no test");
}

#[test]
fn methods_that_learned_from_depth_are_ranked_among_their_own() {
    let dir = scored();
    contestant(&dir, "none", "blank", false);
    contestant(&dir, "oracle", "deep", true);
    contestant(&dir, "all", "flat", true);
    score(&dir, &[]);
    let run = make(&dir);
    let (colour, depth) = run.stdout.split_once("track: colour + depth\n").unwrap();
    assert!(colour.contains("track: colour\n   1 contestant"), "{}", run.stdout);
    assert!(depth.contains("   1 deep ") && depth.contains("   2 flat "), "{}", run.stdout);
    let rows = table(&dir, "leaderboard/leaderboard.csv");
    let tracks: BTreeMap<&str, &str> =
        rows.iter().map(|row| (row["method"].as_str(), row["track"].as_str())).collect();
    let pairs = table(&dir, "leaderboard/comparisons.csv");
    assert!(pairs.iter().any(|row| row["first"] == "deep" && row["second"] == "flat"));
    for row in &pairs {
        assert_eq!(tracks[row["first"].as_str()], tracks[row["second"].as_str()], "{row:?}");
    }
    let board = dir.json(&[&["leaderboard"], &TINY[..]].concat());
    let deep = board["ranked"].as_array().unwrap().iter().find(|method| method["name"] == "deep").unwrap();
    assert_eq!((&deep["track"], &deep["rank"]), (&"colour+depth".into(), &1.into()));
    let run = dir.succeed(&[&["score"], &TINY[..]].concat());
    assert!(run.stdout.contains("track colour + depth, learned from rendered depth"), "{}", run.stdout);
    for (name, is_marked) in [("deep ", true), ("contestant ", false)] {
        let line = run.stdout.lines().find(|line| line.starts_with(name)).unwrap();
        assert_eq!(line.ends_with(" *"), is_marked, "{line}");
    }
}
