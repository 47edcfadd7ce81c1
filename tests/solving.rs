//! `solve` and `query` as their users run them, on made-up twins: one ball rolls, its twin lies farther back.

use std::sync::LazyLock;

use l4d_data::Profile;
use l4d_masks::{Mask, png};
use serde_json::{Value, json};

use crate::support::{Dir, Run, named};
use crate::world::{SCENE, SIZE, seen, write_twins, write_twins_benchmark};

const SOLVE: &str = "solve --profile tiny --data data";
/// One sentence about the scene.
const QUERY: &str = "query ball 'The ball that rolls' --profile tiny --data data --grounder oracle";
/// Enough iterations for two balls, so that they have an outline.
const LEARNED: &str = "--depth --gaussians 2500 --coarse 150 --unfold 20 --fine 400";

/// A folder with the scene, a model of it, clips of the model and a benchmark about it, all made once.
pub(crate) fn world() -> Dir {
    static WORLD: LazyLock<Dir> = LazyLock::new(|| {
        let dir = Dir::new();
        write_twins(&dir.path("data"));
        write_twins_benchmark(&dir.path("benchmark"), &dir.path("data"));
        dir.succeed(format!("train-splats {SCENE} --profile tiny --data data {LEARNED}"));
        dir.succeed(format!("{SOLVE} --grounder oracle --queries ball/001"));
        dir.remove("results");
        dir.remove("work/tiny/ball/answers");
        dir
    });
    WORLD.copy()
}

/// The same with the answers of the oracle to all sentences.
fn solved() -> Dir {
    static SOLVED: LazyLock<Dir> = LazyLock::new(|| {
        let dir = world();
        let run = dir.succeed(format!("{SOLVE} --grounder oracle"));
        run.says(0, &["3 queries: 3 reliable"]);
        dir
    });
    SOLVED.copy()
}

fn score(dir: &Dir, method: &str) -> Value {
    named(&dir.json("score results --profile tiny --missing skip")["methods"], method).clone()
}

/// Masks of an instance as a grounder of files reads them, in some views of a query.
fn write_masks(dir: &Dir, number: &str, instance_of_view: &[(&str, u32)]) {
    for (view, id) in instance_of_view {
        for frame in Profile::Tiny.frames() {
            let mask = seen(&dir.path("data"), view, frame, *id);
            dir.write(&format!("made/{SCENE}/{number}/{view}/{frame:04}.png"), png::encode(&mask));
        }
    }
}

/// One sentence, asked by the grounder that needs nothing.
fn ask(dir: &Dir, text: &str, more: &str) -> Run {
    dir.run(format!("query {SCENE} '{text}' --profile tiny --data data {more}"))
}

fn last_line(run: &Run) -> &str {
    run.stdout.lines().last().unwrap()
}

#[test]
fn what_the_training_views_show_becomes_masks_of_the_held_out_one() {
    const METHOD: &str = "panopticquery-oracle";
    let dir = solved();
    let used = dir.value(&format!("results/{METHOD}/method.json"))["used"].clone();
    assert_eq!((&used["ground_truth"], &used["test_view"]), (&json!(true), &json!(false)));
    assert_eq!(used["depth"], true, "its model learned from depth");
    let scored = score(&dir, METHOD);
    for (field, at_least) in [("miou", 75.0), ("tube_iou", 75.0), ("macc", 99.0), ("select", 99.0)] {
        assert!(scored[field].as_f64().unwrap() > at_least, "{field} of {scored}");
    }
    // The third sentence holds in the middle of the clip alone, and its answer does too.
    let gated = dir.value(&format!("results/{METHOD}/masks/{SCENE}/003.json"));
    for (frame, counts) in gated["frames"].as_object().unwrap() {
        let holds = (24..=72).contains(&frame.parse::<u32>().unwrap());
        assert_eq!(counts.is_string(), holds, "frame {frame}");
    }

    // What is answered stays answered, and other settings are not mixed in under the same name.
    let record = || dir.read(&format!("work/tiny/{SCENE}/answers/{METHOD}/001/manifest.json"));
    let before = record();
    dir.succeed(format!("{SOLVE} --grounder oracle"));
    assert_eq!(record(), before);
    let other = format!("{SOLVE} --grounder oracle --view-count 3 --queries ball/001 --name {METHOD}");
    dir.refuses(&other, &["with other settings", "--force"]);
    dir.succeed(format!("{other} --force"));
    assert_ne!(record(), before);
}

#[test]
fn a_view_that_means_the_twin_is_outvoted() {
    let dir = world();
    write_masks(&dir, "001", &[("cam00", 1), ("cam01", 2), ("cam02", 1), ("cam03", 1)]);
    let files = format!("{SOLVE} --grounder files --masks made --queries ball/001");
    dir.succeed(format!("{files} --name voted"));
    dir.succeed(format!("{files} --name unvoted --no-consensus"));
    let consensus = dir.value(&format!("work/tiny/{SCENE}/answers/voted/001/consensus.json"));
    assert_eq!(consensus["evidence"], json!([0, 2, 3]), "{consensus}");
    let [voted, unvoted] = ["voted", "unvoted"].map(|method| score(&dir, method)["miou"].as_f64().unwrap());
    assert!(voted > 75.0 && voted > unvoted + 1.0, "{voted} {unvoted}");
}

#[test]
fn views_that_do_not_answer_are_named_and_asked_again() {
    let dir = world();
    write_masks(&dir, "002", &[("cam00", 2), ("cam03", 2)]);
    let files = format!("{SOLVE} --grounder files --masks made --queries ball/002 --name half");
    let run = dir.succeed(&files);
    let unanswered = "1 queries have views that did not answer, ball/002 for one";
    run.says(0, &["views: 2 error, 2 found", unanswered]);
    let half = dir.read(&format!("results/half/masks/{SCENE}/002.json"));
    assert!(half.contains("\"0048\":\""), "two views that agree are enough: {half}");
    write_masks(&dir, "002", &[("cam01", 2), ("cam02", 2)]);
    let run = dir.succeed(format!("{files} --force"));
    run.says(0, &["views: 4 found"]);
    assert!(!run.stderr.contains("did not answer"), "{run}");
}

#[test]
fn a_sentence_is_answered_from_any_camera_at_any_time() {
    let dir = world();
    let run = dir.succeed(format!("{QUERY} --explain --out asked"));
    run.says(0, &["grounding", "consensus", "masks", "seconds", "4 of 4 views go on"]);
    for file in ["sheet.png", "consensus.json", "lift", "masks/cam04/0048.png"] {
        assert!(dir.path("asked").join(file).exists(), "{file}");
    }
    assert!(dir.path("asked/overlay.png").exists() || dir.path("asked/overlay.mp4").exists());
    let last = last_line(&run);
    let start = "answer: seen in 9 of 9 frames of the held-out camera cam04, at most ";
    assert!(last.starts_with(start), "{last}");
    assert!(last.ends_with(" pixels (4 of 4 views agree); picture: asked/sheet.png"), "{last}");

    let is_close = |picture: &str, view: &str| {
        let mask = png::decode(&dir.bytes(picture), SIZE[0], SIZE[1]).unwrap();
        let truth: Mask = seen(&dir.path("data"), view, 48, 1);
        mask.and_count(&truth) as f64 / mask.or_count(&truth) as f64 > 0.7
    };
    assert!(is_close("asked/masks/cam04/0048.png", "cam04"));
    let document = dir.json(format!("{QUERY} --views cam01,cam02 --times 0.5,0.3 --out elsewhere"));
    let answer = &document["answer"];
    assert_eq!((&document["decision"], &answer["status"]), (&json!("reliable"), &json!("answered")));
    assert!(answer["message"].as_str().unwrap().starts_with("answer: seen in 4 of 4 frames"), "{answer}");
    assert_eq!(answer.as_object().unwrap().len(), 2, "{answer}");
    assert_eq!(document["frames"]["cam01"].as_object().unwrap().len(), 2);
    assert!(is_close("elsewhere/masks/cam01/t0.500000.png", "cam01"));

    let between = dir.json(format!("{QUERY} --from 36 --to 60 --out between"));
    let frames: Vec<&String> = between["frames"]["cam04"].as_object().unwrap().keys().collect();
    assert_eq!(frames, ["0036", "0048", "0060"]);
}

#[test]
fn what_cannot_be_answered_is_refused() {
    let dir = world();
    dir.write("noise.toml", "seed = 1\n[noise.swap]\nprobability = 3\n");
    let solve = format!("{SOLVE} --grounder oracle");
    for (more, parts) in [
        ("--queries ball/999", &["has no query ball/999"][..]),
        ("--scenes cave", &["no scene `cave`", "ball"]),
        ("--noise noise.toml", &["noise.toml", "swap.probability", "between 0 and 1"]),
    ] {
        dir.refuses(format!("{solve} {more}"), parts);
    }
    dir.refuses(format!("{SOLVE} --grounder files --masks made --noise x.toml"), &["--noise"]);
    for (more, parts) in [
        ("--views cam99", &["no camera `cam99`", "cam00"][..]),
        ("--from 60 --to 20", &["--from, --to"]),
        ("--from 1 --to 5", &["no moment"]),
    ] {
        dir.refuses(format!("{QUERY} {more}"), parts);
    }
    ask(&dir, "  ", "").refused(&["sentence is empty"]);

    let card = format!("work/tiny/{SCENE}/splats/checkpoint.json");
    dir.edit(&card, "\"scene\": \"ball\"", "\"scene\": \"barn\"");
    dir.refuses(&solve, &["was trained on scene barn", "l4d train-splats ball"]);
    dir.remove(&format!("work/tiny/{SCENE}/splats"));
    dir.refuses(&solve, &["there are no splats", "l4d train-splats ball --profile tiny"]);
    dir.remove(&format!("data/{SCENE}/scene.json"));
    dir.refuses(&solve, &["there is no scene", "l4d build-scenes"]);
}

#[test]
fn sentences_of_any_length_and_script_come_to_an_end() {
    let dir = world();
    let long = "ball ".repeat(10_000);
    for (text, folder) in [(long.as_str(), "long"), ("球 🎾 \u{202e}\u{1b}[2J что", "strange")] {
        let run = ask(&dir, text, &format!("--out {folder}"));
        assert_eq!(run.code, 1, "{run}");
        assert!(run.stdout.starts_with("no answer: ") && !run.stdout.contains('\u{1b}'), "{run}");
        assert!(run.stdout.lines().count() == 1 && run.stdout.len() < 500, "{run}");
        assert!(!dir.path(folder).exists(), "{folder}");
    }
}

#[test]
fn a_sentence_that_cannot_be_read_is_answered_by_what_can() {
    let dir = world();
    let run = ask(&dir, "The flurb that rolls", "--out asked");
    let [line] = run.stdout.lines().collect::<Vec<_>>()[..] else { panic!("{run}") };
    let nearest = "reads: \"The ball that rolls\"";
    run.says(1, &["no answer: cannot read \"flurb\"; ", "kinds of things and", nearest]);
    assert!(line.len() < 400, "{line}");
    for written in [dir.path("asked"), dir.path(format!("work/tiny/{SCENE}/asked"))] {
        assert!(!written.exists(), "{}", written.display());
    }

    let document = ask(&dir, "The ball nearest to the zorple", "--json").value();
    let answer = &document["answer"];
    assert_eq!((&answer["status"], &answer["unread_words"]), (&json!("unread"), &json!(["zorple"])));
    assert_eq!(answer["nearest"], "The ball nearest to the wall");
    assert_eq!((&document["folder"], &document["frames"]), (&Value::Null, &json!({})));
    let alone = ask(&dir, "The ball", "--bench nowhere");
    alone.says(1, &["\"ball\" says nothing beside the kind"]);
    assert!(!alone.stdout.contains("nearest"), "{alone}");
}

#[test]
fn an_answer_of_ones_own_sentence_ends_with_a_line() {
    let dir = world();
    let run = ask(&dir, "The ball that moves", "");
    run.says(0, &["; picture: work/tiny/ball/"]);
    assert!(last_line(&run).starts_with("answer: "), "{run}");
    for number in ["001", "002", "003"] {
        write_masks(&dir, number, &["cam00", "cam01", "cam02", "cam03"].map(|view| (view, 99)));
    }
    let absent = ask(&dir, "The ball that rolls", "--grounder files --masks made --out absent");
    assert_eq!((absent.code, last_line(&absent)), (1, "no answer: no view shows it"), "{absent}");
    assert!(dir.path("absent/masks/cam04/0048.png").exists(), "that nothing is there is in masks, too");
}

#[test]
fn grounders_that_know_the_benchmark_alone_refuse_other_sentences_once() {
    let dir = world();
    dir.remove(&format!("work/tiny/{SCENE}/clips"));
    for more in ["--grounder oracle", "--grounder files --masks made"] {
        let run = ask(&dir, "The ball that jumps", more);
        let only = "answers only sentences of the benchmark";
        run.refused(&["about scene ball", "ask \"The ball that rolls\"", "--grounder panoptic", only]);
        assert!(run.stderr.matches("error:").count() == 1 && run.stdout.is_empty(), "{run}");
        ask(&dir, "The ball that rolls", &format!("{more} --bench nowhere"))
            .refused(&["nowhere has none about scene ball", "--bench"]);
    }
    assert!(!dir.path(format!("work/tiny/{SCENE}/clips")).exists(), "nothing is drawn");
}

#[test]
fn a_card_says_whether_the_splats_saw_depth() {
    let dir = world();
    let model = format!("work/tiny/{SCENE}/splats/checkpoint.json");
    let one = format!("{SOLVE} --grounder oracle --queries ball/001 --lift vote --clip-every 4");
    // Whether results say that depth was used, and whether the user is asked to say so.
    let answer = |name: &str, more: &str| {
        let run = dir.succeed(format!("{one} --name {name} {more}"));
        let card = dir.value(&format!("results/{name}/method.json"));
        let is_unknown = run.stderr.contains("not known whether the splats of ball");
        (card["used"]["depth"].as_bool().unwrap(), is_unknown)
    };
    assert_eq!(answer("deep", ""), (true, false));
    dir.edit(&model, "\"saw_depth\": true", "\"saw_depth\": false");
    assert_eq!(answer("bright", ""), (false, false));
    assert_eq!(answer("masks", "--used-depth"), (true, false));
    // A model from elsewhere says nothing, so the user has to.
    dir.edit(&model, "  \"saw_depth\": false,\n", "");
    assert_eq!(answer("foreign", ""), (false, true));
    assert_eq!(answer("foreign", "--used-depth"), (true, false), "a card learns what was not known");
    assert_eq!(answer("foreign", ""), (true, true), "and does not forget it");
}

#[test]
fn shards_together_answer_everything_once() {
    let dir = world();
    for shard in ["1/2", "2/2"] {
        dir.succeed(format!("{SOLVE} --grounder oracle --name sharded --shard {shard} --jobs 2"));
    }
    let scored = score(&dir, "sharded");
    assert_eq!((&scored["queries"], &scored["partial"]), (&json!(3), &json!(false)));
}

#[test]
fn options_of_another_grounder_are_refused() {
    let dir = Dir::with_benchmark();
    let strays = [
        ("--endpoint none.toml", "model"),
        ("--base-url http://localhost:1", "model"),
        ("--vlm some-model", "model"),
        ("--api-key-env KEY", "model"),
        ("--server vllm", "model"),
        ("--link record:kept", "model"),
        ("--refresh", "model"),
        ("--max-cost 1", "model"),
        ("--max-tokens-total 1", "model"),
        ("--grounder-file none.toml", "model"),
        ("--noise none.toml", "oracle"),
        ("--masks made", "files"),
        ("--given kinds", "panoptic-fused"),
    ];
    for (option, grounder) in strays {
        for verb in [format!("query {SCENE} 'The ball'"), "solve".to_owned()] {
            let run = dir.run(format!("{verb} --profile tiny --data data --grounder panoptic {option}"));
            let flag = option.split(' ').next().unwrap();
            run.says(
                2,
                &[
                    &format!("{flag} does not apply to --grounder panoptic"),
                    &format!("--grounder {grounder}"),
                ],
            );
        }
    }
    dir.run(format!("{QUERY} --weights made")).says(2, &["--weights does not apply to --grounder oracle"]);
}

#[test]
fn moments_are_frames_or_seconds_in_options_and_in_the_sentence() {
    let dir = world();
    let area = |run: Value| run["frames"]["cam04"].clone();
    let by_frame = area(dir.json(format!("{QUERY} --from 24 --to 48 --out a")));
    assert_eq!(by_frame.as_object().unwrap().keys().collect::<Vec<_>>(), ["0024", "0036", "0048"]);
    assert_eq!(area(dir.json(format!("{QUERY} --from 1s --to 2s --out b"))), by_frame);
    let spoken = "query ball 'The ball that rolls between second 1 and second 2' --profile tiny --data data \
                  --grounder oracle";
    assert_eq!(area(dir.json(format!("{spoken} --out c"))), by_frame);
    dir.refuses(
        format!("{spoken} --from 1s --out d"),
        &["the sentence says when, and so do --from and --to"],
    );
    dir.refuses(format!("{QUERY} --to 9.5s"), &["--to 9.5s is beyond the clip", "the last is at 4s"]);
    dir.run(format!("{QUERY} --from soon")).says(2, &["neither a frame (`24`) nor a time (`1.5s`)"]);
}

#[test]
fn what_can_be_said_is_listed() {
    let dir = Dir::new();
    let run = dir.succeed("query ball --words");
    run.says(0, &["things: apple, ", "colour: ", "verbs: ", "beside: \"", "first to: \""]);
    dir.refuses("query ball --words --grounder oracle", &["--words does not apply to --grounder oracle"]);
    dir.run("query ball").says(2, &["<TEXT>"]);
}

#[test]
fn controls_take_away_what_is_seen_or_said_and_are_never_ranked() {
    let dir = world();
    let run = dir.succeed(format!("{SOLVE} --control shuffled-sentences"));
    run.says(0, &["results/panopticquery-panoptic-shuffled-sentences"]);
    let card = dir.value("results/panopticquery-panoptic-shuffled-sentences/method.json");
    assert_eq!(card["baseline"], true);
    let question = |number: &str| {
        let folder = "work/tiny/ball/answers/panopticquery-panoptic-shuffled-sentences";
        dir.value(&format!("{folder}/{number}/manifest.json"))["question"]["text"].clone()
    };
    let texts = ["001", "002", "003"].map(question);
    let mut told = dir
        .lines("benchmark/queries/ball.jsonl")
        .iter()
        .map(|query| query["text"].clone())
        .collect::<Vec<_>>();
    assert!(texts.iter().zip(&told).all(|(asked, own)| asked != own), "{texts:?}");
    told.sort_by_key(ToString::to_string);
    let mut asked = texts.to_vec();
    asked.sort_by_key(ToString::to_string);
    assert_eq!(asked, told, "each sentence is handed on once");
    dir.refuses(
        format!("{SOLVE} --control blank-pictures --grounder oracle"),
        &["--control does not apply to --grounder oracle"],
    );
}
