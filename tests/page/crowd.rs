//! A board as crowded as one may become: many methods, many queries, masks of their own.

use std::collections::BTreeMap;

use l4d_data::layout::ResultsDir;
use l4d_data::results::{MaskFile, MethodCard};
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Category, Name, Query, Scale, json};
use l4d_masks::{Mask, Rle};
use l4d_testing::query;

use crate::support::{Dir, Noise, truth};

const OBJECTS: usize = 4;

/// Scored methods on made-up scenes of the profile tiny, without a page yet.
pub(crate) fn scored(methods: usize, scenes: usize, queries: usize) -> Dir {
    let dir = Dir::new();
    let truths = write_benchmark(&dir, scenes, queries);
    dir.succeed(&["baseline", "none", "--profile", "tiny"]);
    let card: MethodCard = json::read(&dir.path("results/none/method.json")).unwrap();
    std::fs::remove_dir_all(dir.path("results/none")).unwrap();
    for index in 0..methods {
        write_method(&dir, index, &card, &truths, queries);
    }
    dir.succeed(&["score", "--profile", "tiny", "--quiet"]);
    dir
}

fn write_benchmark(dir: &Dir, scenes: usize, queries: usize) -> Vec<Truth> {
    let scene = |index: usize| {
        let name = format!("crowd_{index:02}");
        let truth = truth(&name, Scale::ALL[index % 3], index as u64);
        let queries = (0..queries).map(|query| asked(&name, query, &truth)).collect();
        (truth, queries)
    };
    let scenes: Vec<(Truth, Vec<Query>)> = (0..scenes).map(scene).collect();
    l4d_testing::write_benchmark(&dir.path("benchmark"), &scenes);
    scenes.into_iter().map(|(truth, _)| truth).collect()
}

fn asked(scene: &str, index: usize, truth: &Truth) -> Query {
    let text = format!("the thing that sentence number {index} of many means when it is read slowly");
    let referent = &truth.instances[index % OBJECTS].name;
    let query = query(&format!("{scene}/{:03}", index + 1), &text, &[referent], [0, 96]);
    Query { categories: vec![Category::ALL[index % 4]], ..query }
}

/// The right thing more or less often, always a little beside it, so that hardly any mask occurs twice.
fn write_method(dir: &Dir, index: usize, card: &MethodCard, truths: &[Truth], queries: usize) {
    let name = Name::new(format!("method-{index:02}")).unwrap();
    let results = ResultsDir::new(dir.path("results").join(name.as_str()));
    json::write(&results.card(), &MethodCard { name, seconds: Some(60.0 + index as f64), ..card.clone() })
        .unwrap();
    let mut noise = Noise::new(index as u64);
    for truth in truths {
        for query in 0..queries {
            let is_right = noise.below(100) < 95 - index as u32;
            let object = if is_right { query } else { query + 1 } % OBJECTS;
            let shift = (noise.below(9) as i64 - 4, noise.below(9) as i64 - 4);
            let frames: BTreeMap<String, Option<Rle>> = truth
                .frames
                .iter()
                .map(|&frame| (frame_key(frame), answer(truth, object, frame, shift)))
                .collect();
            let id = format!("{}/{:03}", truth.scene, query + 1).parse().unwrap();
            let file = MaskFile { size: [truth.height, truth.width], frames };
            let bytes = serde_json::to_vec(&file).unwrap();
            let path = results.mask_file(&id);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
    }
}

fn answer(truth: &Truth, object: usize, frame: u32, (right, down): (i64, i64)) -> Option<Rle> {
    let mask = truth.instances[object].masks.get(&frame_key(frame))?;
    let mask = Mask::from_rle(mask, truth.width, truth.height);
    let inside = |col: u32, row: u32| {
        let (col, row) = (i64::from(col) - right, i64::from(row) - down);
        col >= 0 && row >= 0 && mask.get(col as u32, row as u32)
    };
    Some(Mask::from_fn(truth.width, truth.height, inside).to_rle())
}
