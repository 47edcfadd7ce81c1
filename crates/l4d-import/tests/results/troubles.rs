//! What users report of the originals, each ending in a finding that names the cause.

use l4d_data::{Finding, Report};
use l4d_import::results::import::Imported;
use l4d_import::results::preset::Preset;
use l4d_import::results::relevancy::TextEmbeddingsFile;
use l4d_masks::{Mask, png};
use l4d_testing::foreign::{npy, npy_texts, npz, pth};

use crate::bench::{Bench, SCENE, TEXTS, clip, codes, cup, referent};

fn masks(bench: &Bench, mask: impl Fn(usize, usize) -> Mask) {
    for position in 0..clip().len() {
        for (query, text) in TEXTS.iter().enumerate() {
            bench.write(
                &format!("eval_result/{SCENE}/{:05}/chosen_{text}.png", position + 1),
                png::encode(&mask(query, position)),
            );
        }
    }
}

/// Levels of every frame, and an autoencoder of 3 to 8 numbers.
fn latents(bench: &Bench, value: impl Fn(u64, usize) -> f32, channels: usize) {
    for position in 0..clip().len() {
        for level in 1..=3 {
            let data: Vec<f32> = (0..96 * 128 * channels).map(|index| value(level, index)).collect();
            bench.write(
                &format!("output/{SCENE}_{level}/train/ours_None/renders_npy/{position:05}.npy"),
                npy(&[96, 128, channels], &data),
            );
        }
    }
    let weight: Vec<f32> = (0..24).map(|index| ((index * 7 % 11) as f32 - 5.0) / 5.0).collect();
    let bytes = pth(&[("decoder.0.weight", &[8, 3], weight), ("decoder.0.bias", &[8], vec![0.1; 8])]);
    bench.write(&format!("autoencoder/ckpt/{SCENE}/ae_ckpt/best_ckpt.pth"), bytes);
}

fn wave(level: u64, index: usize) -> f32 {
    0.5 * (index as f32 * 0.37 + level as f32).sin()
}

/// Imports latents with sentences of `width` numbers.
fn import_latents(bench: &Bench, width: usize) -> (Imported, Report) {
    let path = bench.path("texts.npz");
    let numbers = |count: usize| -> Vec<f32> { (0..count * width).map(|index| wave(9, index)).collect() };
    let bytes = npz(&[
        ("queries", npy_texts(&TEXTS)),
        ("positives", npy(&[3, width], &numbers(3))),
        ("negatives", npy(&[4, width], &numbers(4))),
    ]);
    std::fs::write(&path, bytes).unwrap();
    bench.import("langsplat", |request| {
        request.encoders.texts = Some((path.clone(), TextEmbeddingsFile::read(&path).unwrap()));
    })
}

/// Codes of what is found in doing so.
fn of_latents(bench: &Bench, width: usize) -> Vec<&'static str> {
    codes(import_latents(bench, width).1)
}

#[test]
fn latents_that_are_something_else() {
    type Value = fn(u64, usize) -> f32;
    let sound: Value = wave;
    let cases: [(&str, Value, usize, usize, &str); 6] = [
        ("colours", |level, index| 0.75 + 0.2 * wave(level, index), 3, 8, "L4D550"),
        ("three levels that are one", |_, index| wave(1, index), 3, 8, "L4D551"),
        ("blank renders", |_, _| 0.0, 3, 8, "L4D552"),
        (
            "no numbers",
            |level, index| if index == 77 { f32::NAN } else { wave(level, index) },
            3,
            8,
            "L4D553",
        ),
        ("channels", sound, 12, 8, "L4D554"),
        ("sentences", sound, 3, 16, "L4D554"),
    ];
    for (case, value, channels, width, code) in cases {
        let bench = Bench::new();
        latents(&bench, value, channels);
        assert!(of_latents(&bench, width).contains(&code), "{case}");
    }
}

#[test]
fn latents_without_sentences_or_decoder() {
    let bench = Bench::new();
    latents(&bench, wave, 3);
    assert!(codes(bench.import("langsplat", |_| ()).1).contains(&"L4D555"));
    std::fs::remove_file(
        bench.path("method").join(format!("autoencoder/ckpt/{SCENE}/ae_ckpt/best_ckpt.pth")),
    )
    .unwrap();
    assert!(of_latents(&bench, 8).contains(&"L4D554"));
}

#[test]
fn fewer_pictures_than_frames() {
    let bench = Bench::new();
    latents(&bench, wave, 3);
    for level in 1..=3 {
        let file = format!("output/{SCENE}_{level}/train/ours_None/renders_npy/00008.npy");
        std::fs::remove_file(bench.path("method").join(file)).unwrap();
    }
    assert!(of_latents(&bench, 8).contains(&"L4D546"));
    let missing = bench.path(&format!("method/output/{SCENE}_2/train/ours_None/renders_npy/00007.npy"));
    std::fs::remove_file(&missing).unwrap();
    let findings = import_latents(&bench, 8).1.into_sorted();
    let of_level = |finding: &&Finding| finding.code == "L4D548" && finding.message.contains("level 2");
    let paths: Vec<&str> = findings.iter().filter(of_level).map(|finding| finding.path.as_str()).collect();
    assert_eq!(paths, [missing.to_str().unwrap()], "the file that is missing is named, not one beside it");
}

#[test]
fn sentences_that_do_not_count_need_no_vector() {
    let bench = Bench::new();
    latents(&bench, wave, 3);
    let (queries, composites) =
        ["", ".composite"].map(|kind| bench.path(&format!("bench/queries/{SCENE}{kind}.jsonl"))).into();
    let first = std::fs::read_to_string(queries).unwrap().lines().next().unwrap().to_owned();
    let other = "the red cup beside the blue cup";
    let mut composite: serde_json::Value = serde_json::from_str(&first).unwrap();
    composite["id"] = format!("{SCENE}/501").into();
    composite["categories"] = serde_json::json!(["attribute", "spatial"]);
    composite["text"] = other.into();
    composite["text_digest"] = l4d_data::query::text_digest(other, None).into();
    std::fs::write(composites, composite.to_string()).unwrap();
    assert!(!of_latents(&bench, 8).contains(&"L4D555"));
}

#[test]
fn latents_of_another_size_are_named_once_a_frame() {
    let bench = Bench::new();
    latents(&bench, wave, 3);
    for (level, position) in
        (1..=3).flat_map(|level| (0..clip().len()).map(move |position| (level, position)))
    {
        let numbers: Vec<f32> = (0..48 * 64 * 3).map(|index| wave(level, index + position)).collect();
        let file = format!("output/{SCENE}_{level}/train/ours_None/renders_npy/{position:05}.npy");
        bench.write(&file, npy(&[48, 64, 3], &numbers));
    }
    let (imported, report) = import_latents(&bench, 8);
    let sizes = report.into_sorted().into_iter().filter(|finding| finding.code == "L4D547");
    assert_eq!(sizes.count(), clip().len());
    assert!(imported.summits.is_empty(), "nothing is located in latents that were not read");
}

#[test]
fn renders_of_training_cameras() {
    let bench = Bench::new();
    latents(&bench, wave, 3);
    assert!(of_latents(&bench, 8).contains(&"L4D580"));
}

#[test]
fn two_runs_in_one_folder() {
    let bench = Bench::new();
    latents(&bench, wave, 3);
    bench.write(
        &format!("output/{SCENE}_1/train/ours_7000/renders_npy/00000.npy"),
        npy(&[1, 1, 3], &[0.0; 3]),
    );
    assert_eq!(of_latents(&bench, 8), ["L4D543"]);
}

#[test]
fn masks_of_another_frame() {
    let bench = Bench::new();
    masks(&bench, |query, position| cup(referent(query), position.saturating_sub(1)));
    let (_, report) = bench.import("langsplat-masks", |_| ());
    let findings = report.into_sorted();
    assert_eq!(findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["L4D557"]);
    assert!(findings[0].message.contains("one frame earlier"), "{findings:?}");
    let bench = Bench::new();
    masks(&bench, |query, position| cup(referent(query), (position + 1).min(8)));
    let findings = bench.import("langsplat-masks", |_| ()).1.into_sorted();
    assert!(findings[0].message.contains("one frame later"), "{findings:?}");
}

#[test]
fn masks_that_hardly_touch_the_truth() {
    let bench = Bench::new();
    masks(&bench, |_, _| Mask::from_fn(128, 96, |_, row| row < 4));
    assert_eq!(codes(bench.import("langsplat-masks", |_| ()).1), ["L4D558"]);
}

#[test]
fn masks_of_everything() {
    let bench = Bench::new();
    masks(
        &bench,
        |query, position| {
            if query == 0 { Mask::full(128, 96) } else { cup(referent(query), position) }
        },
    );
    assert_eq!(codes(bench.import("langsplat-masks", |_| ()).1), ["L4D556"]);
}

#[test]
fn another_size_is_named_and_only_resized_when_asked() {
    let bench = Bench::new();
    masks(&bench, |query, position| cup(referent(query), position).resized_nearest(256, 192));
    let (imported, report) = bench.import("langsplat-masks", |_| ());
    assert!(imported.answers.is_empty());
    let findings = report.into_sorted();
    let is_named = |message: &str| message.contains("256x192") && message.contains("128x96");
    let size =
        findings.iter().find(|finding| finding.code == "L4D547" && is_named(&finding.message)).unwrap();
    assert!(size.hint.contains("--resize"));
    assert!(findings.iter().filter(|finding| finding.code == "L4D547").count() <= 13, "the rest is counted");
    assert!(bench.import("langsplat-masks", |request| request.resize = true).1.is_empty());
    let bench = Bench::new();
    masks(&bench, |_, _| Mask::full(128, 128));
    let findings = bench.import("langsplat-masks", |request| request.resize = true).1.into_sorted();
    assert!(findings.iter().any(|finding| finding.hint.contains("proportions")), "{findings:?}");
}

#[test]
fn names_that_fit_no_sentence_and_files_that_answer_twice() {
    let bench = Bench::new();
    masks(&bench, |query, position| cup(referent(query), position));
    bench.write(
        &format!("eval_result/{SCENE}/00001/chosen_the red cupp.png"),
        png::encode(&Mask::empty(128, 96)),
    );
    bench.write(
        &format!("eval_result/{SCENE}/00001/chosen_THE RED CUP.png"),
        png::encode(&Mask::empty(128, 96)),
    );
    let findings = bench.import("langsplat-masks", |_| ()).1.into_sorted();
    let unknown = findings.iter().find(|finding| finding.code == "L4D544").unwrap();
    assert!(unknown.hint.contains("`The red cup`"), "{unknown:?}");
    let twice = findings.iter().find(|finding| finding.code == "L4D545").unwrap();
    assert!(twice.message.contains("001") && twice.hint.contains("overwrite"), "{twice:?}");
}

#[test]
fn frames_beyond_the_clip() {
    let bench = Bench::new();
    masks(&bench, |query, position| cup(referent(query), position));
    bench.write(
        &format!("eval_result/{SCENE}/00010/chosen_the red cup.png"),
        png::encode(&Mask::empty(128, 96)),
    );
    assert_eq!(codes(bench.import("langsplat-masks", |_| ()).1), ["L4D546"]);
}

#[test]
fn scenes_that_are_none_and_folders_without_anything() {
    let bench = Bench::new();
    bench.write("eval_result/teatime/00001/chosen_the red cup.png", png::encode(&Mask::empty(128, 96)));
    assert_eq!(codes(bench.import("langsplat-masks", |_| ()).1), ["L4D540", "L4D544"]);
    assert_eq!(codes(bench.import("refersplat", |_| ()).1), ["L4D540"]);
}

#[test]
fn pictures_that_may_be_masks_in_several_ways() {
    let bench = Bench::new();
    masks(&bench, |query, position| cup(referent(query), position));
    let file = |kind: ::png::ColorType, pixels: &[u8]| {
        let mut bytes = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut bytes, 128, 96);
        encoder.set_color(kind);
        if kind == ::png::ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 128, 0, 0]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(pixels).unwrap();
        writer.finish().unwrap();
        bytes
    };
    let path = format!("eval_result/{SCENE}/00001/chosen_the blue cup.png");
    let mut colours = vec![0; 128 * 96 * 3];
    colours[7] = 200;
    for (kind, pixels) in [(::png::ColorType::Rgb, colours), (::png::ColorType::Indexed, vec![1; 128 * 96])] {
        bench.write(&path, file(kind, &pixels));
        let found = codes(bench.import("langsplat-masks", |_| ()).1);
        assert_eq!(found, ["L4D548", "L4D549"], "{kind:?}");
    }
    let mut greys = vec![0; 128 * 96];
    (greys[0], greys[1]) = (100, 255);
    bench.write(&path, file(::png::ColorType::Grayscale, &greys));
    let strict = |request: &mut l4d_import::results::import::Request<'_>| {
        request.reading.inside = "mask".parse().unwrap();
    };
    assert_eq!(codes(bench.import("langsplat-masks", strict).1), ["L4D548", "L4D549"]);
}

#[test]
fn videos_and_jpegs_are_told_what_to_be() {
    let bench = Bench::new();
    for name in ["the blue cup.mp4", "the blue cup.jpg"] {
        bench.write(&format!("eval_result/{SCENE}/00001/{name}"), "x");
    }
    let mut preset = Preset::find("langsplat-masks").unwrap();
    for extension in ["mp4", "jpg"] {
        preset.template = format!("eval_result/{{scene}}/{{position+1:05}}/{{text}}.{extension}");
        let findings =
            bench.import("langsplat-masks", |request| request.preset = preset.clone()).1.into_sorted();
        let refused = findings.iter().find(|finding| finding.code == "L4D541").unwrap();
        assert!(refused.hint.contains("PNG"), "{refused:?}");
    }
}
