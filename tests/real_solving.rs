//! The reference solver on a capture, all the way: pictures that somebody took are imported with masks, splats are learned
//! without depth, and sentences are answered and scored. What is photographed here is the made-up twins, with a grain on
//! everything: where a thing has one colour, comparing pictures finds nothing.

use std::sync::LazyLock;

use glam::{DVec2, DVec3};
use half::f16;
use l4d_data::{Camera, Split};
use l4d_formats::npy;
use l4d_frames::drawn::{RgbImage, encode_colour};
use l4d_frames::{Display, Frame};
use l4d_masks::{Mask, ids, png};
use serde_json::{Value, json};

use crate::support::{Dir, named, query};
use crate::world::{SIZE, camera_at, twins_seen_by};

/// Where the cameras are; the first one is held out, as in all data sets of this layout.
const PLACES_M: [f64; 6] = [0.1, -0.9, -0.55, -0.2, 0.4, 0.8];
/// Numbers of the moments: they begin where the source's first ones were left out.
const MOMENTS: [u32; 2] = [2, 10];
/// Views on which masks are drawn, beside the held-out one.
const DRAWN: [&str; 4] = ["cam01", "cam02", "cam04", "cam05"];
const SOLVE: &str = "solve --profile real --bench captures";
/// Enough iterations for two balls.
const LEARNED: &str = "--gaussians 3000 --coarse 200 --unfold 20 --fine 400";

fn cameras() -> Vec<Camera> {
    let camera = |(index, &x): (usize, &f64)| {
        camera_at(&format!("cam{index:02}"), if index == 0 { Split::Test } else { Split::Train }, x)
    };
    PLACES_M.iter().enumerate().map(camera).collect()
}

/// The canonical frame of the twins that is photographed at a moment: the ball rolls from the left to the right.
fn canonical(moment: u32) -> u32 {
    (moment - MOMENTS[0]) * 96 / (MOMENTS[1] - MOMENTS[0])
}

/// The grain of the twins at a pixel, about -1 to 1: it is in the material, so that it rolls along without turning.
fn grain(camera: &Camera, frame: &Frame, pixel: usize, canonical: u32) -> f64 {
    let at = [pixel as u32 % SIZE[0], pixel as u32 / SIZE[0]].map(|place| f64::from(place) + 0.5);
    let depth_m = f64::from(frame.surfaces.depth_m[pixel]);
    let point = camera.unproject(0, DVec2::from_array(at), depth_m);
    let id = frame.surfaces.id[pixel];
    let rolled = if id == 1 { 1.6 * f64::from(canonical) / 96.0 } else { 0.0 };
    let own = point - DVec3::X * rolled + DVec3::splat(3.0 * f64::from(id));
    0.6 * waves(14.0 * own) + 0.4 * waves(31.0 * (own + 5.0))
}

fn waves(at: DVec3) -> f64 {
    (at.x + 1.7 * (0.9 * at.y).sin()).sin()
        * (1.3 * at.y + 0.7 * at.z + 1.1 * (1.2 * at.z).sin()).sin()
        * (1.1 * at.z + 0.5 * at.x + 0.4).sin()
}

/// Twins in the layout of Neural 3D Video, masks as grey pictures beside them: 1 rolls, 2 lies.
fn photograph(dir: &Dir) {
    let display = Display::new(1.0);
    let mut poses = Vec::new();
    for camera in cameras() {
        let rows = camera.world_from_camera(0).transpose().to_cols_array_2d();
        let shape = [f64::from(SIZE[1]), f64::from(SIZE[0]), camera.fx];
        // Axes are down, right, backward; then the place, then height, width, focal length.
        for (row, size) in rows.iter().zip(shape) {
            poses.extend([row[1], row[0], -row[2], row[3], size]);
        }
        poses.extend([0.5, 20.0]);
        for moment in 0..=MOMENTS[1] {
            let time = canonical(moment.max(MOMENTS[0]));
            let frame = twins_seen_by(&camera, time);
            let pixels = frame.rgb.iter().enumerate().flat_map(|(pixel, rgb)| {
                let light = 1.0 + 0.5 * grain(&camera, &frame, pixel, time);
                rgb.map(|linear| display.byte(f16::from_f64(light * linear.to_f64())))
            });
            let picture = RgbImage::from_raw(SIZE[0], SIZE[1], pixels.collect()).unwrap();
            dir.write(&format!("twins/{}/images/{moment:04}.png", camera.name), encode_colour(&picture));
            let is_drawn = camera.split == Split::Test || DRAWN.contains(&camera.name.as_str());
            if is_drawn && moment >= MOMENTS[0] {
                let numbers: Vec<u8> = frame.surfaces.id.iter().map(|&id| id as u8).collect();
                let drawn = ids::encode_palette(SIZE[0], SIZE[1], &numbers);
                dir.write(&format!("drawn/{}_{moment:04}.png", camera.name), drawn);
            }
        }
    }
    dir.write("twins/poses_bounds.npy", npy::encode_f64(&[PLACES_M.len(), 17], &poses));
}

/// A folder with the capture, a model of it and a benchmark about it. The model is learned once for all tests.
fn world() -> Dir {
    static WORLD: LazyLock<Dir> = LazyLock::new(|| {
        let dir = imported();
        dir.succeed(format!("train-splats twins --profile real {LEARNED}"));
        dir
    });
    WORLD.copy()
}

fn imported() -> Dir {
    static IMPORTED: LazyLock<Dir> = LazyLock::new(|| {
        let dir = Dir::new();
        photograph(&dir);
        let masks = "--masks drawn --masks-format png --bench captures --scale tabletop";
        dir.succeed(format!("import-scene neu3d twins --moments 2-10 {masks}"));
        let [rolls, middle] = ["The ball that rolls", "The ball while it rolls through the middle"];
        let queries = [
            query("twins/001", rolls, "action", &["object_1"], "whole", MOMENTS),
            query("twins/002", "The ball nearest to the wall", "spatial", &["object_2"], "whole", MOMENTS),
            query("twins/003", middle, "action", &["object_1"], "while", [4, 8]),
        ];
        dir.write("captures/queries/twins.jsonl", queries.map(|query| format!("{query}\n")).concat());
        dir
    });
    IMPORTED.copy()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn splats_are_learned_from_pictures_alone_and_never_from_the_held_out_ones() {
    let dir = world();
    let manifest = dir.value("work/real/twins/splats/manifest.json");
    let test = &manifest["report"]["test"];
    assert!(number(&test["psnr_db"]) > 22.0 && number(&test["psnr_moving_db"]) > 18.0, "{test}");
    let sampling = json!({"shrink": 1, "every": 1});
    assert_eq!((&manifest["init"], &manifest["sampling"]), (&json!("pictures"), &sampling));
    let trained_on = manifest["trained_on"].as_object().unwrap();
    assert_eq!(trained_on.len(), 5 * 9);
    assert!(trained_on.keys().all(|file| !file.contains("cam00")));
    assert!(manifest["compared_with"].as_object().unwrap().keys().all(|file| file.contains("cam00")));

    // A clip of the model is as long as the capture, and frames have its numbers.
    dir.succeed("render-splats twins --profile real --views cam00 --out shown");
    let shown = dir.value("shown/manifest.json");
    let pictures = shown["views"]["cam00"]["pictures"].as_object().unwrap();
    let times: Vec<(&str, f64)> =
        pictures.iter().map(|(key, picture)| (key.as_str(), number(&picture["time"]))).collect();
    assert_eq!((times.len(), times[0], times[4], times[8]), (9, ("0002", 0.0), ("0006", 0.5), ("0010", 1.0)));
    dir.refuses(
        "render-splats twins --profile real --frames 1 --out x",
        &["frame 1 is beyond the clip", "frames are 2 to 10"],
    );
}

#[test]
fn what_was_drawn_on_training_views_becomes_masks_of_the_held_out_one() {
    const METHOD: &str = "panopticquery-oracle";
    let dir = world();
    dir.succeed(format!("{SOLVE} --grounder oracle"));
    let document = dir.json("score --bench captures --profile real");
    assert_eq!(document["findings"], json!([]), "{document:#}");
    let scored = named(&document["methods"], METHOD);
    for (field, at_least) in [("miou", 70.0), ("tube_iou", 70.0), ("select", 99.0)] {
        assert!(number(&scored[field]) > at_least, "{field} of {scored:#}");
    }
    let card = dir.value(&format!("results/{METHOD}/method.json"));
    assert_eq!((&card["profile"], &card["used"]["ground_truth"]), (&json!("real"), &json!(true)));
    assert!(card.get("width").is_none() && card.get("frames").is_none(), "{card}");
    // The third sentence holds in the middle of the clip alone, and its answer does too.
    let gated = dir.value(&format!("results/{METHOD}/masks/twins/003.json"));
    for (frame, counts) in gated["frames"].as_object().unwrap() {
        assert_eq!(counts.is_string(), (4..=8).contains(&frame.parse::<u32>().unwrap()), "frame {frame}");
    }
    // One training view was not drawn on: it does not answer, and the others do.
    let outcomes =
        dir.value(&format!("work/real/twins/answers/{METHOD}/001/manifest.json"))["outcomes"].clone();
    assert_eq!((&outcomes["cam03"], &outcomes["cam01"]), (&json!("error"), &json!("found")));

    for view in DRAWN {
        let text = dir.read("data/captures/twins/masks.json");
        dir.write("data/captures/twins/masks.json", text.replace(view, &view.replace("cam", "gone")));
    }
    dir.refuses(
        format!("{SOLVE} --grounder oracle --name blind"),
        &["nothing is drawn on a training view", "--masks-only"],
    );
}

#[test]
fn masks_made_elsewhere_are_voted_on_at_the_size_and_the_frames_of_the_clips() {
    let dir = world();
    let half = [SIZE[0] / 2, SIZE[1] / 2];
    for camera in cameras().iter().filter(|camera| camera.split == Split::Train) {
        for moment in (MOMENTS[0]..=MOMENTS[1]).step_by(2) {
            // One view takes the twin for the ball that rolls.
            let id = if camera.name.as_str() == "cam03" { 2 } else { 1 };
            let ids = twins_seen_by(camera, canonical(moment)).surfaces.id;
            let pixel = |column, row| ids[(2 * row * SIZE[0] + 2 * column) as usize] == id;
            let mask = Mask::from_fn(half[0], half[1], pixel);
            dir.write(&format!("made/twins/001/{}/{moment:04}.png", camera.name), png::encode(&mask));
        }
    }
    let files = "--grounder files --masks made --queries twins/001 --clip-size 64x48 --clip-every 2";
    dir.succeed(format!("{SOLVE} {files} --name voted"));
    let consensus = dir.value("work/real/twins/answers/voted/001/consensus.json");
    assert_eq!(consensus["evidence"], json!([0, 1, 3, 4]), "{consensus:#}");
    // Every frame of the held-out view is answered, at its own size.
    let answers = dir.value("results/voted/masks/twins/001.json");
    assert_eq!(answers["size"], json!([SIZE[1], SIZE[0]]));
    assert_eq!(answers["frames"].as_object().unwrap().len(), 9);
    let document = dir.json("score --bench captures --missing skip --profile real");
    assert!(number(&document["methods"][0]["miou"]) > 60.0, "{document:#}");
}

#[test]
fn one_sentence_is_answered_without_masks_and_without_a_benchmark() {
    let dir = world();
    dir.remove("captures");
    dir.remove("data/captures/twins/masks.json");
    let query = "query twins 'The ball that rolls' --out asked --profile real";
    let document = dir.json(format!("{query} --from 4 --to 8 --views cam00,cam02"));
    let frames: Vec<&String> = document["frames"]["cam02"].as_object().unwrap().keys().collect();
    assert_eq!(frames, ["0004", "0005", "0006", "0007", "0008"]);
    assert!(dir.path("asked/sheet.png").exists() && dir.path("asked/masks/cam00/0006.png").exists());
    dir.refuses(format!("{query} --to 11"), &["--to 11 is beyond the clip", "frames are 2 to 10"]);
    dir.refuses(
        format!("{query} --grounder oracle"),
        &["benchmark has none about scene twins", "ask with --grounder panoptic"],
    );
}

#[test]
fn ablations_run_on_captures() {
    let dir = world();
    let common = "--bench captures --grounder oracle --profile real --clip-every 4 --lift vote";
    let document = dir.json(format!("ablate views {common} --view-counts 1,3,8"));
    assert!(document["left_out"][0].as_str().unwrap().contains("8 views"), "{document:#}");
    dir.write("noise.toml", "seed = 3\n[noise.swap]\nprobability = 0.3\n");
    let document = dir.json(format!("ablate mvsc {common} --noise noise.toml --correlations 0"));
    let rows = document["rows"].as_array().unwrap();
    let settings: Vec<&str> = rows.iter().filter_map(|row| row["setting"].as_str()).collect();
    assert!(settings.iter().any(|setting| setting.starts_with("with MVSC")), "{settings:?}");
}

#[test]
fn pictures_may_be_shrunk_and_left_out() {
    let dir = imported();
    let train = "train-splats twins --profile real";
    let few = "--gaussians 400 --coarse 10 --unfold 1 --fine 10 --shrink 3 --every 3";
    dir.succeed(format!("{train} {few}"));
    let manifest = dir.value("work/real/twins/splats/manifest.json");
    assert_eq!(manifest["trained_on"].as_object().unwrap().len(), 5 * 3);
    dir.succeed("render-splats twins --views cam02 --profile real");
    let shown = dir.value("work/real/twins/clips/manifest.json");
    assert_eq!((&shown["drawn"]["width"], &shown["drawn"]["height"]), (&json!(42), &json!(32)));
    // The border that fills no square is left out: the focal length shrinks by 3 and by nothing else.
    let view = &shown["views"]["cam02"];
    assert!((number(&view["camera"]["fx"]) - 140.0 / 3.0).abs() < 1e-9, "{view}");
    let frames: Vec<&String> = view["pictures"].as_object().unwrap().keys().collect();
    assert_eq!(frames, ["0002", "0005", "0008"]);

    dir.refuses(format!("{train} --depth-weight 0.1"), &["--depth-weight", "add --depth"]);
    dir.refuses(format!("{train} --depth"), &["--depth", "--profile tiny or small or full"]);
    dir.refuses("train-splats cave --profile real", &["there is no scene", "l4d import-scene"]);
    dir.edit("data/captures/twins/capture.json", "\"width\": 128", "\"width\": 127");
    let wrong_size = ["is 128x96, but the capture is 127x96", "l4d import-scene"];
    dir.refuses(format!("{train} --out y"), &wrong_size);
}
