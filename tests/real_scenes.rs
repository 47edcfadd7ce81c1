//! A capture of somebody, all the way: imported with the masks that people drew, asked about, voted on, answered by
//! another method, and scored. Nothing of it is rendered.

use l4d_data::query::text_digest;
use l4d_formats::npy;
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use l4d_masks::{Mask, png};
use serde_json::{Value, json};

use crate::annotation_tui::tmux::Tmux;
use crate::support::Dir;

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;
/// Columns and rows of the cups: first and last, the last one outside.
const RED: [u32; 2] = [8, 24];
const BLUE: [u32; 2] = [40, 56];
const JUDGED: [&str; 2] = ["0000", "0002"];

fn cup([first, end]: [u32; 2]) -> Mask {
    Mask::from_fn(WIDTH, HEIGHT, |column, row| (first..end).contains(&column) && (8..24).contains(&row))
}

/// A data set in the layout of Neural 3D Video: two cameras, four moments. Two of the held-out pictures were drawn on.
fn capture() -> Dir {
    capture_drawn_on(&JUDGED)
}

fn capture_drawn_on(judged: &[&str]) -> Dir {
    let dir = Dir::new();
    let mut poses = Vec::new();
    for number in 0..2 {
        // Axes are down, right, backward; then height, width, focal length.
        let place = f64::from(number);
        poses.extend([
            0.0, 1.0, 0.0, place, 48.0, -1.0, 0.0, 0.0, 0.0, 64.0, 0.0, 0.0, 1.0, 0.0, 70.0, 0.5, 20.0,
        ]);
        for moment in 0..4 {
            let shade = 60 * moment as u8;
            let mut picture = RgbImage::from_pixel(WIDTH, HEIGHT, Rgb([shade, 90, 120]));
            for (cup, colour) in [(cup(RED), [200, 30, 30]), (cup(BLUE), [30, 30, 200])] {
                cup.pixels().for_each(|(column, row)| picture.put_pixel(column, row, Rgb(colour)));
            }
            dir.write(&format!("table/cam0{number}/images/{moment:04}.png"), encode_colour(&picture));
        }
    }
    dir.write("table/poses_bounds.npy", npy::encode_f64(&[2, 17], &poses));
    let annotation = |image: usize, category: usize, [first, end]: [u32; 2]| {
        json!({"id": 2 * image + category, "image_id": image, "category_id": category,
               "segmentation": [[first, 8, end, 8, end, 24, first, 24]]})
    };
    let images: Vec<Value> = judged
        .iter()
        .enumerate()
        .map(|(id, frame)| json!({"id": id, "file_name": format!("cam00/{frame}.png"), "width": WIDTH, "height": HEIGHT}))
        .collect();
    let annotations: Vec<Value> =
        (0..images.len()).flat_map(|image| [annotation(image, 0, RED), annotation(image, 1, BLUE)]).collect();
    let categories = json!([{"id": 0, "name": "cup: red"}, {"id": 1, "name": "cup: blue"}]);
    let drawn = json!({"images": images, "annotations": annotations, "categories": categories});
    dir.write("drawn.json", drawn.to_string());
    dir
}

const IMPORT: [&str; 10] = [
    "import-scene",
    "neu3d",
    "table",
    "--masks",
    "drawn.json",
    "--masks-format",
    "coco",
    "--bench",
    "captures",
    "--scale",
];
/// What judges real scenes.
const REAL: [&str; 4] = ["--bench", "captures", "--profile", "real"];

fn real(words: &[&'static str]) -> Vec<&'static str> {
    [words, &REAL].concat()
}

fn query(number: &str, text: &str, category: &str, referent: &str, temporal: &str, frames: Value) -> String {
    json!({
        "id": format!("table/{number}"), "text": text, "categories": [category], "referents": [referent],
        "temporal": temporal, "frames": frames, "predicate": null, "text_digest": text_digest(text, None),
        "provenance": {"source": "author"}, "status": "candidate",
    })
    .to_string()
}

/// A capture that was imported, with two queries.
pub(crate) fn authored() -> Dir {
    authored_on(&JUDGED)
}

/// The same with truth at these frames.
pub(crate) fn authored_on(judged: &[&str]) -> Dir {
    let dir = capture_drawn_on(judged);
    dir.succeed(&[&IMPORT[..], &["tabletop"]].concat());
    let queries = [
        query("001", "the red cup", "attribute", "cup__red", "whole", json!([[0, 3]])),
        query("002", "the cup while it is lifted", "action", "cup__blue", "while", json!([[2, 3]])),
    ];
    dir.write("captures/queries/table.jsonl", queries.join("\n") + "\n");
    dir
}

#[test]
fn masks_on_a_capture_become_a_scene_that_is_judged_where_people_drew() {
    let dir = capture();
    let run = dir.json(&[&IMPORT[..], &["tabletop"]].concat());
    assert_eq!((&run["annotated"], &run["truth"]), (&json!(2), &json!("captures/truth/real/table.json")));
    let truth: Value = serde_json::from_str(&dir.read("captures/truth/real/table.json")).unwrap();
    assert_eq!((&truth["frames"], &truth["unannotated"]), (&json!([0, 2]), &json!([1, 3])));
    assert_eq!(truth["visible"]["cam00"]["cup__red"], json!([256, 256]));
    assert_eq!(truth["instances"][0]["category"], "cup");
    // A second import keeps the queries.
    dir.write("captures/queries/table.jsonl", "kept\n");
    dir.succeed(&[&IMPORT[..], &["tabletop", "--masks-only", "--out", "data/captures/table"]].concat());
    assert_eq!(dir.read("captures/queries/table.jsonl"), "kept\n");
    assert_eq!(dir.read("captures/panoptic-l4d.toml").matches("table").count(), 1);
}

#[test]
fn queries_of_a_real_scene_are_checked_as_far_as_nothing_has_to_be_proved() {
    let dir = authored();
    let run = dir.json(&real(&["check-queries"]));
    assert_eq!(run["findings"], json!([]), "{run:#}");
    assert_eq!((&run["queries"]["attribute"], &run["queries"]["action"]), (&json!(1), &json!(1)));
    let bad = [
        query("001", "the red cup", "attribute", "cup__green", "whole", json!([[0, 3]])),
        query("002", "the cup on the left", "spatial", "cup__red", "whole", json!([[0, 96]])),
        query("003", "the cup while it falls", "action", "cup__red", "while", json!([[1, 1]])),
    ];
    dir.write("captures/queries/table.jsonl", bad.join("\n") + "\n");
    let run = dir.json(&real(&["check-queries"]));
    let codes: Vec<&str> =
        run["findings"].as_array().unwrap().iter().map(|finding| finding["code"].as_str().unwrap()).collect();
    for code in ["L4D202", "L4D206", "L4D210", "L4D216"] {
        assert!(codes.contains(&code), "{code} is not among {codes:?}");
    }
}

#[test]
fn baselines_of_a_real_scene_score_what_they_must() {
    let dir = authored();
    dir.succeed(&real(&["baseline"]));
    assert_eq!(dir.json(&real(&["check-results"]))["findings"], json!([]));
    let scores = dir.json(&real(&["score"]));
    assert_eq!((&scores["profile"], &scores["findings"]), (&json!("real"), &json!([])), "{scores:#}");
    let miou = |name: &str| {
        let methods = scores["methods"].as_array().unwrap();
        methods.iter().find(|method| method["name"] == name).unwrap()["miou"].as_f64().unwrap()
    };
    assert_eq!((miou("oracle"), miou("none")), (100.0, 0.0));
    let all = 100.0 * 256.0 / f64::from(WIDTH * HEIGHT);
    assert!((miou("all") - all).abs() < 1e-9, "{}", miou("all"));
    // Frames without annotation differ from those without an object.
    let counts = dir.read("scores/oracle/counts.csv");
    let states: Vec<&str> = counts
        .lines()
        .skip(1)
        .filter(|row| row.starts_with("table,001,"))
        .map(|row| row.split(',').nth(3).unwrap())
        .collect();
    assert_eq!(states, ["hit", "not_annotated", "hit", "not_annotated"]);
    let page = dir.run(&real(&["leaderboard"]));
    assert_eq!(page.code, 0, "{}", page.stderr);
}

#[test]
fn masks_of_langsplat_on_a_scene_of_theirs_are_scored() {
    let dir = authored();
    let half =
        Mask::from_fn(WIDTH, HEIGHT, |column, row| (8..16).contains(&column) && (8..24).contains(&row));
    // As its evaluation leaves them: a folder a picture, counted from 1; pictures without annotation as well.
    for (frame, red) in [cup(RED), half.clone(), half, cup(BLUE)].into_iter().enumerate() {
        let folder = format!("theirs/table/{:05}", frame + 1);
        dir.write(&format!("{folder}/chosen_the red cup.png"), png::encode(&red));
        dir.write(&format!("{folder}/chosen_the cup while it is lifted.png"), png::encode(&cup(BLUE)));
    }
    let run = dir.json(&real(&["import", "langsplat-masks", "theirs", "--name", "langsplat"]));
    assert_eq!((&run["findings"], &run["answers"]), (&json!([]), &json!(4)), "{run:#}");
    let scores = dir.json(&real(&["score"]));
    let method = &scores["methods"][0];
    // The red cup: 1 and 1/2. The lifted one: right where it holds, and where it does not a false alarm, counted apart.
    assert_eq!(method["categories"]["attribute"]["miou"], 75.0);
    assert_eq!(method["categories"]["action"]["miou"], 100.0);
    let card: Value = serde_json::from_str(&dir.read("results/langsplat/method.json")).unwrap();
    assert!(card["profile"] == "real" && card.get("width").is_none() && card.get("frames").is_none());
    let answers: Value = serde_json::from_str(&dir.read("results/langsplat/masks/table/001.json")).unwrap();
    assert_eq!(answers["size"], json!([HEIGHT, WIDTH]));
    let read = Mask::decode(answers["frames"]["0000"].as_str().unwrap(), WIDTH, HEIGHT).unwrap();
    assert_eq!(read, cup(RED));

    // Masks of another size are none of this scene.
    dir.write("theirs/table/00001/chosen_the red cup.png", png::encode(&Mask::full(32, 48)));
    let run = dir.run(&real(&["import", "langsplat-masks", "theirs", "--name", "langsplat", "--force"]));
    assert_eq!(run.code, 1);
    assert!(run.stdout.contains("is 32x48, but the capture is 64x48"), "{}", run.stdout);
}

#[test]
fn a_capture_goes_out_in_the_layouts_of_others_without_its_held_out_view() {
    let dir = authored();
    let export = |format: &'static str, more: &[&'static str]| {
        let words = [
            "export",
            "table",
            "--profile",
            "real",
            "--bench",
            "captures",
            "--format",
            format,
            "--out",
            format,
        ];
        dir.run(&[&words[..], more].concat())
    };
    let bytes = |path: &str| std::fs::read(dir.path(path)).unwrap();
    let picture = bytes("data/captures/table/frames/cam01/0002.png");
    let run = export("4dgaussians", &[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for said in ["--points-from", "a capture: there is no depth"] {
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    assert_eq!(bytes("4dgaussians/ims/0/000002.png"), picture);
    // People drew on the held-out view alone: that is the truth.
    let run = export("coco", &[]);
    assert!(run.code == 2 && run.stderr.contains("they are the truth"), "{}", run.stderr);
    assert_eq!(export("coco", &["--held-out", "pictures"]).code, 0);
    let run = export("4d-langsplat-annotations", &[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let written: Value =
        serde_json::from_str(&dir.read("4d-langsplat-annotations/annotations/train/_annotations.coco.json"))
            .unwrap();
    let names: Vec<&str> = written["images"]
        .as_array()
        .unwrap()
        .iter()
        .map(|image| image["file_name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["0000_png.rf.l4d.jpg", "0002_png.rf.l4d.jpg"]);
    let run = export("colmap", &["--frames", "9"]);
    assert!(run.code == 2 && run.stderr.contains("frame 9 was not recorded"), "{}", run.stderr);
}

#[test]
fn people_verify_prompts_on_the_pictures_of_a_capture() {
    let dir = authored();
    let open = ["open-round", "r1", "--annotators", "ada", "--panel", "1", "--gold", "0", "--repeats", "0"];
    dir.succeed(&real(&open));
    let tmux = Tmux::new();
    let command =
        format!("exec {} verify-prompts --round r1 --as ada --picture halfblocks", env!("CARGO_BIN_EXE_l4d"));
    tmux.start("ada", (100, 30), dir.path("").as_path(), &command);
    // Two objects under numbers drawn by lot: taking the first for both is right once.
    let screen =
        tmux.wait("ada", "the picture", |screen| screen.contains("q0001") || screen.contains("q0002"));
    assert!(screen.contains("whole clip"), "{screen}");
    let other = if screen.contains("q0001") { "q0002" } else { "q0001" };
    tmux.keys("ada", &["1", "Enter", "Enter"]);
    tmux.wait("ada", "the next item", |screen| screen.contains(other));
    tmux.keys("ada", &["1", "Enter", "Enter"]);
    tmux.wait("ada", "the summary", |screen| screen.contains("items:"));
    tmux.text("ada", "S");
    tmux.wait("ada", "the question", |screen| screen.contains("Seal the ballot?"));
    tmux.text("ada", "y");
    tmux.wait("ada", "the seal", |screen| screen.contains("The ballot is sealed."));
    tmux.text("ada", "q");
    tmux.wait_for_end("ada");
    let verdict = dir.json(&["verdict", "--round", "r1", "--bench", "captures"]);
    // One of the two is number 1: exactly one of the queries is understood.
    assert_eq!(
        (&verdict["outcomes"]["valid"], &verdict["outcomes"]["rejected"]),
        (&json!(1), &json!(1)),
        "{verdict:#}"
    );
    let queries = dir.read("captures/queries/table.jsonl");
    assert_eq!(
        (queries.matches("verified").count(), queries.matches("rejected").count()),
        (1, 1),
        "{queries}"
    );
    // Drawing the masks anew is another scene: votes on the old one do not count.
    dir.edit("captures/truth/real/table.json", "\"variant\":0", "\"variant\":1");
    let checked = dir.run(&["verdict", "--round", "r1", "--bench", "captures", "--check"]);
    assert!(
        checked.stdout.contains("L4D531") && checked.stdout.contains("it is candidate"),
        "{}",
        checked.stdout
    );
}

#[test]
fn verbs_that_need_renderings_refuse_real_scenes_and_folders_never_mix() {
    let dir = authored();
    for verb in ["build-scenes", "check-scenes", "stats"] {
        let run = dir.run(&real(&[verb]));
        assert_eq!(run.code, 2, "{verb}: {}", run.stdout);
        assert!(run.stderr.contains("real scenes are not rendered"), "{verb}: {}", run.stderr);
    }
    dir.write("captures/scenes/table.json", "{}");
    let run = dir.run(&[&IMPORT[..], &["tabletop"]].concat());
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("holds the rendered scene table"), "{}", run.stderr);
    let dir = capture();
    let refused = dir.run(&[&IMPORT[..], &["tabletop", "--held-out", "cam01"]].concat());
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("nothing is drawn on a held-out view"), "{}", refused.stderr);
}
