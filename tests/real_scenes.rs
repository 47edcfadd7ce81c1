//! A capture of somebody, all the way: imported with the masks that people drew, asked about, voted on, answered by
//! another method, and scored. Nothing of it is rendered.

use l4d_formats::npy;
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use l4d_masks::{Mask, png};
use serde_json::{Value, json};

use crate::support::{Dir, codes, named, query};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;
/// Columns and rows of the cups: first and last, the last one outside.
const RED: [u32; 2] = [8, 24];
const BLUE: [u32; 2] = [40, 56];
const JUDGED: [&str; 2] = ["0000", "0002"];

fn cup([first, end]: [u32; 2]) -> Mask {
    Mask::from_fn(WIDTH, HEIGHT, |column, row| (first..end).contains(&column) && (8..24).contains(&row))
}

/// A data set in the layout of Neural 3D Video: two cameras, four moments. Some of the held-out pictures were drawn on.
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
    let image = |(id, frame)| json!({"id": id, "file_name": format!("cam00/{frame}.png"), "width": WIDTH, "height": HEIGHT});
    let images: Vec<Value> = judged.iter().enumerate().map(image).collect();
    let annotations: Vec<Value> =
        (0..images.len()).flat_map(|image| [annotation(image, 0, RED), annotation(image, 1, BLUE)]).collect();
    let categories = json!([{"id": 0, "name": "cup: red"}, {"id": 1, "name": "cup: blue"}]);
    let drawn = json!({"images": images, "annotations": annotations, "categories": categories});
    dir.write("drawn.json", drawn.to_string());
    dir
}

pub(crate) const IMPORT: &str =
    "import-scene neu3d table --masks drawn.json --masks-format coco --bench captures --scale tabletop";
/// What judges real scenes.
const REAL: &str = "--bench captures --profile real";
const QUERIES: &str = "captures/queries/table.jsonl";

/// A capture that is not imported yet, and what people drew on it.
pub(crate) fn captured() -> Dir {
    capture_drawn_on(&JUDGED)
}

/// A capture that was imported, with two queries.
pub(crate) fn authored() -> Dir {
    authored_on(&JUDGED)
}

/// The same with truth at these frames.
pub(crate) fn authored_on(judged: &[&str]) -> Dir {
    let dir = capture_drawn_on(judged);
    dir.succeed(IMPORT);
    write_queries(
        &dir,
        &[
            query("table/001", "the red cup", "attribute", &["cup__red"], "whole", [0, 3]),
            query("table/002", "the cup while it is lifted", "action", &["cup__blue"], "while", [2, 3]),
        ],
    );
    dir
}

fn write_queries(dir: &Dir, queries: &[Value]) {
    dir.write(QUERIES, queries.iter().map(|query| format!("{query}\n")).collect::<String>());
}

#[test]
fn masks_on_a_capture_become_a_scene_that_is_judged_where_people_drew() {
    let dir = capture_drawn_on(&JUDGED);
    let run = dir.json(IMPORT);
    assert_eq!((&run["annotated"], &run["truth"]), (&json!(2), &json!("captures/truth/real/table.json")));
    let truth = dir.value("captures/truth/real/table.json");
    assert_eq!((&truth["frames"], &truth["unannotated"]), (&json!([0, 2]), &json!([1, 3])));
    assert_eq!(truth["visible"]["cam00"]["cup__red"], json!([256, 256]));
    assert_eq!(truth["instances"][0]["category"], "cup");
    // A second import keeps the queries.
    dir.write(QUERIES, "kept\n");
    dir.succeed(format!("{IMPORT} --masks-only --out data/captures/table"));
    assert_eq!(dir.read(QUERIES), "kept\n");
    assert_eq!(dir.read("captures/panoptic-l4d.toml").matches("table").count(), 1);
}

#[test]
fn queries_of_a_real_scene_are_checked_as_far_as_nothing_has_to_be_proved() {
    let dir = authored();
    let run = dir.json(format!("check-queries {REAL}"));
    assert_eq!(run["findings"], json!([]), "{run:#}");
    assert_eq!((&run["queries"]["attribute"], &run["queries"]["action"]), (&json!(1), &json!(1)));
    write_queries(
        &dir,
        &[
            query("table/001", "the red cup", "attribute", &["cup__green"], "whole", [0, 3]),
            query("table/002", "the cup on the left", "spatial", &["cup__red"], "whole", [0, 96]),
            query("table/003", "the cup while it falls", "action", &["cup__red"], "while", [1, 1]),
        ],
    );
    let run = dir.json(format!("check-queries {REAL}"));
    for code in ["L4D202", "L4D206", "L4D210", "L4D216"] {
        assert!(codes(&run).contains(&code), "{code} is not among {run:#}");
    }
}

#[test]
fn baselines_of_a_real_scene_score_what_they_must() {
    let dir = authored();
    dir.succeed(format!("baseline {REAL}"));
    assert_eq!(dir.json(format!("check-results {REAL}"))["findings"], json!([]));
    let scores = dir.json(format!("score {REAL}"));
    assert_eq!((&scores["profile"], &scores["findings"]), (&json!("real"), &json!([])), "{scores:#}");
    let miou = |name: &str| named(&scores["methods"], name)["miou"].as_f64().unwrap();
    assert_eq!((miou("oracle"), miou("none")), (100.0, 0.0));
    let all = 100.0 * 256.0 / f64::from(WIDTH * HEIGHT);
    assert!((miou("all") - all).abs() < 1e-9, "{}", miou("all"));
    // Frames without annotation differ from those without an object.
    let counts = dir.read("scores/oracle/counts.csv");
    let rows = counts.lines().filter(|row| row.starts_with("table,001,"));
    let states: Vec<&str> = rows.map(|row| row.split(',').nth(3).unwrap()).collect();
    assert_eq!(states, ["hit", "not_annotated", "hit", "not_annotated"]);
    dir.succeed(format!("leaderboard {REAL}"));
}

#[test]
fn masks_of_langsplat_on_a_scene_of_theirs_are_scored() {
    let dir = authored();
    let half =
        Mask::from_fn(WIDTH, HEIGHT, |column, row| (8..16).contains(&column) && (8..24).contains(&row));
    // As its evaluation leaves them: a folder a picture, counted from 1; pictures without annotation as well.
    for (frame, red) in [cup(RED), half.clone(), half, cup(BLUE)].into_iter().enumerate() {
        let folder = format!("theirs/eval_result/table/{:05}", frame + 1);
        dir.write(&format!("{folder}/chosen_the red cup.png"), png::encode(&red));
        dir.write(&format!("{folder}/chosen_the cup while it is lifted.png"), png::encode(&cup(BLUE)));
    }
    let import = format!("import langsplat-masks theirs --name langsplat {REAL}");
    let run = dir.json(&import);
    assert_eq!((&run["findings"], &run["answers"]), (&json!([]), &json!(4)), "{run:#}");
    let scores = dir.json(format!("score {REAL}"));
    let categories = &scores["methods"][0]["categories"];
    // The red cup: 1 and 1/2. The lifted one: right where it holds, and where it does not a false alarm, counted apart.
    assert_eq!([&categories["attribute"]["miou"], &categories["action"]["miou"]], [75.0, 100.0]);
    let card = dir.value("results/langsplat/method.json");
    assert!(card["profile"] == "real" && card.get("width").is_none() && card.get("frames").is_none());
    let answers = dir.value("results/langsplat/masks/table/001.json");
    assert_eq!(answers["size"], json!([HEIGHT, WIDTH]));
    let read = Mask::decode(answers["frames"]["0000"].as_str().unwrap(), WIDTH, HEIGHT).unwrap();
    assert_eq!(read, cup(RED));

    // Masks of another size are none of this scene.
    dir.write("theirs/eval_result/table/00001/chosen_the red cup.png", png::encode(&Mask::full(32, 48)));
    dir.run(format!("{import} --force")).says(1, &["is 32x48, but the capture is 64x48"]);
}

#[test]
fn a_capture_goes_out_in_the_layouts_of_others_without_its_held_out_view() {
    let dir = authored();
    let export = |format: &str, more: &str| {
        dir.run(format!("export table {REAL} --format {format} --out {format} {more}"))
    };
    let picture = dir.bytes("data/captures/table/frames/cam01/0002.png");
    export("4dgaussians", "").says(0, &["--points-from", "a capture: there is no depth"]);
    assert_eq!(dir.bytes("4dgaussians/ims/0/000002.png"), picture);
    // People drew on the held-out view alone: that is the truth.
    export("coco", "").says(2, &["they are the truth"]);
    export("coco", "--held-out pictures").says(0, &[]);
    export("4d-langsplat-annotations", "").says(0, &[]);
    let written = dir.value("4d-langsplat-annotations/annotations/train/_annotations.coco.json");
    let names = written["images"].as_array().unwrap().iter().map(|image| &image["file_name"]);
    assert!(names.eq(["0000_png.rf.l4d.jpg", "0002_png.rf.l4d.jpg"]));
    export("colmap", "--frames 9").says(2, &["frame 9 was not recorded"]);
}

#[test]
fn verbs_that_need_renderings_refuse_real_scenes_and_folders_never_mix() {
    let dir = authored();
    for verb in ["build-scenes", "check-scenes", "stats"] {
        dir.run(format!("{verb} {REAL}")).says(2, &["real scenes are not rendered"]);
    }
    dir.write("captures/scenes/table.json", "{}");
    dir.run(IMPORT).says(2, &["holds the rendered scene table"]);
    let dir = capture_drawn_on(&JUDGED);
    dir.run(format!("{IMPORT} --held-out cam01")).says(2, &["nothing is drawn on a held-out view"]);
}
