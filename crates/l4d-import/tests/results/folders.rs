//! Whole folders, as methods leave them: what comes in, and what scores say of it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use l4d_data::results::{MethodCard, Track};
use l4d_data::{Name, Profile, Query, QueryId, Report};
use l4d_import::results::import::{FrameOrder, Identity, Imported, Request, write};
use l4d_import::results::relevancy::{TextEmbeddingsFile, gate};
use l4d_masks::{Mask, ids, png};
use l4d_score::judge::Answer;
use l4d_score::protocols::judge_answers;
use l4d_score::truth::SceneTruth;
use l4d_score::{EvalSet, Options, Protocol, QuerySet, Summary, score_results};
use l4d_testing::foreign::{npy, npy_texts, npz, pth};

use crate::bench::{Bench, SCENE, TEXTS, clip, codes, cup, referent, request};

fn id(query: usize) -> QueryId {
    format!("{SCENE}/{:03}", query + 1).parse().unwrap()
}

fn mask_of(imported: &Imported, query: usize, frame: u32) -> Option<Mask> {
    let mask = imported.answers[&id(query)][&frame].as_ref()?;
    Some(Mask::from_rle(mask, 128, 96))
}

fn identity(depth: bool) -> Identity {
    Identity { name: Name::new("theirs").unwrap(), version: "1".to_owned(), test_view: false, depth }
}

fn score(bench: &Bench, imported: &Imported) -> Summary {
    let benchmark = bench.open();
    let request = request(&benchmark, "langsplat-masks", &bench.path("method"));
    let identity = identity(true);
    let results = bench.path("results");
    write(&results, &identity, &request, imported, true).unwrap();
    let mut report = Report::default();
    let eval_set = EvalSet::open(bench.open(), Profile::Tiny, QuerySet::Queries, &[], &mut report).unwrap();
    let card = MethodCard::read(&results.join("theirs/method.json")).unwrap();
    assert_eq!((card.used.depth, card.used.track()), (true, Track::ColourDepth));
    let scored =
        score_results(&results, &eval_set, &Options::default(), &bench.path("scores"), false, |_| ())
            .unwrap();
    assert!(!scored.report.has_errors(), "{:?}", scored.report);
    scored.summaries.into_iter().next().unwrap()
}

/// What a protocol says of the masks that came in.
fn recount(bench: &Bench, imported: &Imported, protocol: Protocol, measure: &str) -> Option<f64> {
    let (bench, scene) = (bench.open(), Name::new(SCENE).unwrap());
    let truth = SceneTruth::load(&bench, Profile::Tiny, &scene).unwrap();
    let queries = bench.queries(&scene).unwrap();
    let asked: Vec<&Query> =
        queries.iter().filter(|query| imported.answers.contains_key(&query.id)).collect();
    let of_frames = |frames| Answer::of_frames(frames, &truth.frames);
    let answers = imported.answers.iter().map(|(id, frames)| (id.clone(), of_frames(frames))).collect();
    let path = bench.dir.queries(&scene);
    let sheets =
        judge_answers(&[protocol], &scene, &truth, &asked, &path, &answers, &imported.summits).unwrap();
    sheets[0].get(measure)
}

/// Masks that are right in part, so that no two averages are the same.
fn guess(query: usize, position: usize) -> Mask {
    let truth = cup(referent(query), position);
    let cut = 42 + (3 * position + 5 * query) as u32 % 20;
    Mask::from_fn(128, 96, |col, row| truth.get(col, row) && row < cut)
}

#[test]
fn chosen_masks_of_langsplat_score_as_its_own_evaluation_would() {
    let bench = Bench::new();
    for position in 0..clip().len() {
        for (query, text) in TEXTS.iter().enumerate() {
            let file = format!("eval_result/{SCENE}/{:05}/chosen_{text}.png", position + 1);
            bench.write(&file, png::encode(&guess(query, position)));
        }
    }
    bench.write(&format!("eval_result/{SCENE}/20240101.log"), "iou chosen: 0.9\n");
    bench.write(&format!("eval_result/{SCENE}/20240202.log"), "trunc thresh: 0.4\niou chosen: 0.5\n");
    let (imported, report) = bench.import("langsplat-masks", |_| ());
    assert!(report.is_empty(), "{:?}", report.into_sorted());
    assert_eq!(imported.claimed[&format!("{SCENE}: iou chosen")], 0.5, "the latest log counts");
    for (position, frame) in clip().into_iter().enumerate() {
        assert_eq!(mask_of(&imported, 1, frame).unwrap(), guess(1, position));
    }

    let summary = score(&bench, &imported);
    let value = serde_json::to_value(&summary).unwrap();
    let number = |pointer: &str| value.pointer(pointer).and_then(serde_json::Value::as_f64).unwrap();
    let theirs = |protocol, measure| recount(&bench, &imported, protocol, measure).unwrap();
    // LangSplat averages pairs of frame and sentence: our micro average.
    let iou = |query: usize, position: usize| {
        let (mask, truth) = (guess(query, position), cup(referent(query), position));
        mask.and_count(&truth) as f64 / mask.or_count(&truth) as f64
    };
    let holds = |query: usize, frame: u32| query != 2 || (36..=60).contains(&frame);
    let places: Vec<(usize, usize, u32)> = (0..3)
        .flat_map(|query| clip().into_iter().enumerate().map(move |(at, frame)| (query, at, frame)))
        .filter(|(query, _, frame)| holds(*query, *frame))
        .collect();
    let micro = places.iter().map(|&(query, at, _)| iou(query, at)).sum::<f64>() / places.len() as f64;
    assert!((theirs(Protocol::LangSplat, "miou") - micro).abs() < 1e-12);
    assert!((number("/averages/micro/miou") / 100.0 - micro).abs() < 1e-4);
    // 4D LangSplat averages sentences, without those about a time; ours are all of them.
    let of_query = |query: usize| {
        let frames: Vec<f64> =
            places.iter().filter(|place| place.0 == query).map(|&(query, at, _)| iou(query, at)).collect();
        frames.iter().sum::<f64>() / frames.len() as f64
    };
    assert!((theirs(Protocol::FourDLangSplat, "miou") - (of_query(0) + of_query(1)) / 2.0).abs() < 1e-12);
    assert!((number("/miou") / 100.0 - (of_query(0) + of_query(1) + of_query(2)) / 3.0).abs() < 1e-4);
    // A mask in every frame: on where it should be off, so a third of the frames are right.
    assert!((theirs(Protocol::FourDLangSplat, "acc") - 3.0 / 9.0).abs() < 1e-12);
}

/// Latents that point along the axes: 0 the red cup, 1 the blue one, 2 everything else.
fn axes(position: usize, strength: f32) -> Vec<f32> {
    let (red, blue) = (cup("cup_red", position), cup("cup_blue", position));
    let rows = (0..96).flat_map(|row| (0..128).map(move |col| (col, row)));
    let pixel = |(col, row): (u32, u32)| match (red.get(col, row), blue.get(col, row)) {
        (true, _) => [strength, -0.3, 0.3],
        (_, true) => [-0.3, strength, 0.3],
        _ => [-0.05, -0.05 * strength, 0.9],
    };
    rows.flat_map(pixel).collect()
}

/// The weights of a decoder that changes nothing, as torch saves them, with an encoder beside it.
fn weights(width: usize) -> Vec<u8> {
    let mut identity = vec![0.0; width * width];
    (0..width).for_each(|index| identity[index * width + index] = 1.0);
    pth(&[
        ("decoder.0.bias", &[width], vec![0.0; width]),
        ("decoder.0.weight", &[width, width], identity),
        ("encoder.0.weight", &[1, 1], vec![0.5]),
    ])
}

/// Sentences along the axes, with one phrase along the third.
fn texts(bench: &Bench) -> (PathBuf, TextEmbeddingsFile) {
    let path = bench.path("texts.npz");
    let positives = npy(&[3, 3], &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    let bytes = npz(&[
        ("queries", npy_texts(&TEXTS)),
        ("positives", positives),
        ("negatives", npy(&[1, 3], &[0.0, 0.0, 1.0])),
    ]);
    std::fs::write(&path, bytes).unwrap();
    let file = TextEmbeddingsFile::read(&path).unwrap();
    assert_eq!(file.queries.len(), 3);
    (path, file)
}

fn langsplat(bench: &Bench) {
    for position in 0..clip().len() {
        for (level, strength) in [(1, 0.5), (2, 0.9), (3, 0.3)] {
            let file = format!("output/{SCENE}_{level}/test/ours_None/renders_npy/{position:05}.npy");
            bench.write(&file, npy(&[96, 128, 3], &axes(position, strength)));
        }
    }
    bench.write(&format!("autoencoder/ckpt/{SCENE}/ae_ckpt/best_ckpt.pth"), weights(3));
}

/// The vote of LangSplat, pixel by pixel: the majority of 7x7, in windows that end before the last row and column.
fn voted(mask: &Mask) -> Mask {
    let window = |centre: u32, side: u32| centre.saturating_sub(3)..(centre + 4).min(side - 1);
    Mask::from_fn(128, 96, |col, row| {
        let voters = window(row, 96).flat_map(|row| window(col, 128).map(move |col| (col, row)));
        let votes: Vec<bool> = voters.map(|(col, row)| mask.get(col, row)).collect();
        2 * votes.iter().filter(|&&vote| vote).count() > votes.len()
    })
}

#[test]
fn latents_of_langsplat_become_the_masks_of_its_rules() {
    let bench = Bench::new();
    langsplat(&bench);
    let (imported, report) =
        bench.import("langsplat", |request| request.encoders.texts = Some(texts(&bench)));
    assert!(!report.has_errors(), "{:?}", report.into_sorted());
    for (position, frame) in clip().into_iter().enumerate() {
        for query in 0..3 {
            // Relevancy finds each cup to the pixel; then the vote rounds its corners, and draws the last cup, which ends
            // two columns before the border, out to it.
            let expected = voted(&cup(referent(query), position));
            assert_eq!(mask_of(&imported, query, frame).unwrap(), expected, "query {query}, frame {frame}");
        }
    }
    assert!(imported.assumptions["threshold"].contains("0.7"), "{:?}", imported.assumptions);
    assert!(imported.inputs.keys().any(|input| input.ends_with("best_ckpt.pth")));
    assert_eq!(imported.inputs[&format!("{SCENE}: 27 files")].len(), 64);
    assert!(score(&bench, &imported).scores.headline.percent.miou.unwrap() > 90.0);
}

#[test]
fn the_highest_mean_is_looked_for_in_the_box_of_the_object() {
    let located = |bench: &Bench| {
        let (imported, _) = bench.import("langsplat", |request| request.encoders.texts = Some(texts(bench)));
        recount(bench, &imported, Protocol::LangSplat, "localisation").unwrap()
    };
    let bench = Bench::new();
    langsplat(&bench);
    assert_eq!(located(&bench), 1.0);
    // The film runs backwards: objects are where they belong around the middle alone.
    for position in 0..clip().len() {
        let file = format!("output/{SCENE}_2/test/ours_None/renders_npy/{position:05}.npy");
        bench.write(&file, npy(&[96, 128, 3], &axes(clip().len() - 1 - position, 0.9)));
    }
    let backwards = located(&bench);
    assert!((1.0 / 9.0..5.0 / 9.0).contains(&backwards), "{backwards}");
}

#[test]
fn two_imports_are_the_same_to_the_byte() {
    let bench = Bench::new();
    langsplat(&bench);
    let card = || {
        let (imported, _) = bench.import("langsplat", |request| request.encoders.texts = Some(texts(&bench)));
        score(&bench, &imported);
        std::fs::read(bench.path("results/theirs/method.json")).unwrap()
    };
    assert_eq!(card(), card());
}

#[test]
fn four_d_langsplat_is_gated_by_its_features_of_time() {
    let bench = Bench::new();
    // Similar to "it tips" in the middle of the clip.
    let level = |position: usize| if (3..=5).contains(&position) { 0.9 } else { 0.1 };
    for position in 0..clip().len() {
        for (level, strength) in [(1, 0.5), (2, 0.9), (3, 0.3)] {
            let file = format!(
                "output/hypernerf/{SCENE}/{SCENE}_{level}/video_lang/ours_10000/renders_npy/{position:05}.npy"
            );
            bench.write(&file, npy(&[96, 128, 3], &axes(position, strength)));
        }
        let time: Vec<f32> = (0..96 * 128).flat_map(|_| [level(position), 1.0, 0.0, 0.0, 0.0, 0.2]).collect();
        let file =
            format!("output/hypernerf/{SCENE}/{SCENE}_0/video_lang/ours_20000/renders_npy/{position:05}.npy");
        bench.write(&file, npy(&[96, 128, 6], &time));
    }
    bench.write(&format!("output/hypernerf/{SCENE}/clip_best_ckpt.pth"), weights(3));
    bench.write(&format!("output/hypernerf/{SCENE}/video_best_ckpt.pth"), weights(6));
    let time_texts = bench.path("time.npz");
    let bytes = npz(&[
        ("queries", npy_texts(&TEXTS[2..])),
        ("positives", npy(&[1, 6], &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])),
    ]);
    std::fs::write(&time_texts, bytes).unwrap();
    let both = |request: &mut Request<'_>| {
        request.encoders.texts = Some(texts(&bench));
        request.encoders.time_texts =
            Some((time_texts.clone(), TextEmbeddingsFile::read(&time_texts).unwrap()));
    };
    let (imported, report) = bench.import("4d-langsplat", both);
    assert!(!report.has_errors(), "{:?}", report.into_sorted());
    let cosine = |x: f64| x / (x * x + 1.04).sqrt();
    let cosines: Vec<f64> = (0..9).map(|position| cosine(level(position).into())).collect();
    let open = gate::gate(&cosines);
    assert_eq!(open, [false, false, false, true, true, true, false, false, false]);
    for (frame, is_open) in clip().into_iter().zip(open) {
        assert_eq!(mask_of(&imported, 2, frame).is_some(), is_open, "frame {frame}");
        assert!(mask_of(&imported, 0, frame).is_some(), "a sentence about no time is not gated");
    }
    let theirs = |measure| recount(&bench, &imported, Protocol::FourDLangSplat, measure);
    assert_eq!(theirs("acc"), Some(1.0));
    assert!(theirs("viou").unwrap() > 0.9);

    let folder =
        bench.path(&format!("method/output/hypernerf/{SCENE}/{SCENE}_0/video_lang/ours_20000/renders_npy"));
    std::fs::remove_file(folder.join("00004.npy")).unwrap();
    let findings = bench.import("4d-langsplat", both).1.into_sorted();
    let missing = findings.iter().find(|finding| finding.code == "L4D548").unwrap();
    assert!(missing.path == folder.to_str().unwrap() && missing.message.contains("48"), "{missing:?}");
}

#[test]
fn one_model_a_frame_has_one_decoder_a_frame() {
    let bench = Bench::new();
    for (position, frame) in clip().into_iter().enumerate() {
        for (level, strength) in [(1, 0.5), (2, 0.9), (3, 0.3)] {
            let file = format!("output/{SCENE}_{frame:04}_{level}/test/ours_None/renders_npy/00000.npy");
            bench.write(&file, npy(&[96, 128, 3], &axes(position, strength)));
        }
        bench.write(&format!("autoencoder/ckpt/{SCENE}_{frame:04}/ae_ckpt/best_ckpt.pth"), weights(3));
    }
    let (imported, report) =
        bench.import("langsplat-per-frame", |request| request.encoders.texts = Some(texts(&bench)));
    assert!(!report.has_errors(), "{:?}", report.into_sorted());
    assert_eq!(imported.answers[&id(0)].len(), 9);
    assert_eq!(imported.inputs.keys().filter(|input| input.starts_with("decoder")).count(), 9);
}

#[test]
fn palette_indices_are_selected_by_sentence() {
    let bench = Bench::new();
    for position in 0..clip().len() {
        let (red, blue) = (cup("cup_red", position), cup("cup_blue", position));
        let numbers: Vec<u8> = red
            .to_bools()
            .into_iter()
            .zip(blue.to_bools())
            .map(|(red, blue)| 3 * u8::from(red) + 7 * u8::from(blue))
            .collect();
        let file = format!("{SCENE}_cam08/{position:05}.png");
        bench.write(&file, ids::encode_palette(128, 96, &numbers));
    }
    let (imported, report) = bench.import("davis", |request| {
        request.reading.selections = BTreeMap::from([
            ("001".to_owned(), BTreeSet::from([3])),
            ("the BLUE cup".to_owned(), BTreeSet::from([7])),
        ]);
    });
    assert_eq!(codes(report), ["L4D548"], "one sentence is not selected");
    assert_eq!(mask_of(&imported, 0, 0).unwrap(), cup("cup_red", 0));
    assert_eq!(mask_of(&imported, 1, 96).unwrap(), cup("cup_blue", 8));
}

#[test]
fn run_lengths_in_one_file_and_null_for_nothing() {
    let bench = Bench::new();
    let record = |mask: &Mask| serde_json::json!({"size": [96, 128], "counts": mask.to_rle()});
    let frames = |query: usize| -> Vec<serde_json::Value> {
        (0..9)
            .map(|at| if at == 4 { serde_json::Value::Null } else { record(&cup(referent(query), at)) })
            .collect()
    };
    let file = serde_json::json!({"001": frames(0), "the blue cup": frames(1), "003": {"0036": record(&cup("cup_red", 3))}});
    bench.write(&format!("{SCENE}.json"), file.to_string());
    let (imported, report) = bench.import("mevis-rle", |_| ());
    assert_eq!(codes(report), ["L4D548"], "the third sentence has one frame");
    assert_eq!(mask_of(&imported, 0, 48), None);
    assert_eq!(mask_of(&imported, 1, 96).unwrap(), cup("cup_blue", 8));
    assert_eq!(mask_of(&imported, 2, 36).unwrap(), cup("cup_red", 3));
}

#[test]
fn validations_of_hypergaussian_say_when_a_sentence_holds() {
    let bench = Bench::new();
    for (query, _) in TEXTS.iter().enumerate() {
        let folder = format!("{SCENE}/entitybank/query_guided/{:03}/final_query_render_sourcebg", query + 1);
        let is_active = |at: usize| query != 2 || (3..=5).contains(&at);
        let frame = |at: usize| serde_json::json!({"frame_index": at, "image_id": "x", "query_active": is_active(at)});
        let frames: Vec<serde_json::Value> = (0..9).map(frame).collect();
        let exports = serde_json::json!({"binary_masks": "/elsewhere/binary_masks"});
        let file = serde_json::json!({"frame_exports": exports, "frames": frames});
        bench.write(&format!("{folder}/validation.json"), file.to_string());
        for at in (0..9).filter(|at| is_active(*at)) {
            bench
                .write(&format!("{folder}/binary_masks/{at:05}.png"), png::encode(&cup(referent(query), at)));
        }
    }
    let (imported, report) = bench.import("r4d", |_| ());
    assert_eq!(codes(report), Vec::<&str>::new());
    assert_eq!(mask_of(&imported, 1, 96).unwrap(), cup("cup_blue", 8));
    assert_eq!((mask_of(&imported, 2, 24), mask_of(&imported, 2, 36).unwrap()), (None, cup("cup_red", 3)));
    let digest = imported.inputs.clone();
    let mask =
        format!("{SCENE}/entitybank/query_guided/001/final_query_render_sourcebg/binary_masks/00004.png");
    bench.write(&mask, png::encode(&cup("cup_red", 3)));
    let (imported, _) = bench.import("r4d", |_| ());
    assert_ne!(imported.inputs, digest, "the pictures belong to what was read");
    std::fs::remove_file(bench.path("method").join(mask)).unwrap();
    let (_, report) = bench.import("r4d", |_| ());
    assert!(report.has_errors(), "a picture that is missing is no silence");
}

#[test]
fn trajectories_of_the_vot_toolkit_are_masks_by_query() {
    let bench = Bench::new();
    for (query, form) in ["txt", "bin", "txt"].into_iter().enumerate() {
        let name = format!("{SCENE}_{:03}", query + 1);
        let bytes = (0..9).map(|at| vot_region(&cup(referent(query), at), form == "bin"));
        let head = if form == "bin" { vec![1, 0, 9, 0, 0, 0] } else { Vec::new() };
        let file = [head].into_iter().chain(bytes).collect::<Vec<_>>().concat();
        bench.write(&format!("ours/baseline/{name}/{name}_0123abc{query}.{form}"), file);
    }
    let (imported, report) = bench.import("votsr", |_| ());
    assert_eq!(codes(report), Vec::<&str>::new());
    for (query, position) in [(0, 0), (1, 8), (2, 4)] {
        assert_eq!(mask_of(&imported, query, clip()[position]).unwrap(), cup(referent(query), position));
    }
}

/// A mask as `encode_mask` and `write_trajectory` of the toolkit write it.
fn vot_region(mask: &Mask, is_binary: bool) -> Vec<u8> {
    let pixels: Vec<(u32, u32)> = mask.pixels().collect();
    let left = pixels.iter().map(|(col, _)| *col).min().unwrap();
    let top = pixels.iter().map(|(_, row)| *row).min().unwrap();
    let width = pixels.iter().map(|(col, _)| *col).max().unwrap() + 1 - left;
    let height = pixels.iter().map(|(_, row)| *row).max().unwrap() + 1 - top;
    let runs = [0, width * height];
    if !is_binary {
        return format!("m{left},{top},{width},{height},{},{}\n", runs[0], runs[1]).into_bytes();
    }
    let numbers = [left, top, width, height, 2, runs[0], runs[1]];
    let bytes = numbers.iter().flat_map(|number| (*number as u16).to_le_bytes());
    [3].into_iter().chain(bytes).collect()
}

#[test]
fn a_list_of_frames_leaves_other_cameras_out() {
    let bench = Bench::new();
    let folder = |picture: usize| format!("{SCENE}/test/ours_1_text/test_mask/{picture:05}");
    for picture in 0..18 {
        for (query, text) in TEXTS.iter().enumerate() {
            bench.write(
                &format!("{}/{text}.png", folder(picture)),
                png::encode(&cup(referent(query), picture / 2)),
            );
        }
    }
    // Two cameras in turn; the second one is held out.
    let frames = clip().into_iter().flat_map(|frame| [None, Some(frame)]).collect();
    let (imported, report) =
        bench.import("gaussian-grouping", |request| request.order = FrameOrder::Listed(frames));
    assert!(report.is_empty(), "{:?}", report.into_sorted());
    assert_eq!(imported.answers[&id(2)].len(), 9);
    assert_eq!(mask_of(&imported, 0, 24).unwrap(), cup("cup_red", 2));
}
