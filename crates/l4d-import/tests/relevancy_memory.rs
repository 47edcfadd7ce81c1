//! Relevancy takes room for one frame and the maps of one level, never for embeddings. Counts what its process
//! allocates, so that it is a test program of its own.

use l4d_import::results::relevancy::decoder::Layer;
use l4d_import::results::relevancy::{Decoder, Engine, Latents, Rules, Smoothing, TextEmbeddings, answer};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATED: PeakAlloc = PeakAlloc;

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;
const SENTENCES: usize = 10;

#[test]
fn a_frame_takes_room_for_its_maps_and_not_for_embeddings() {
    let number = |index: usize| ((index * 2_654_435_761 % 1000) as f32 - 500.0) / 500.0;
    let widths = [3, 16, 64, 256, 512];
    let layers = widths.windows(2).map(|pair| Layer {
        inputs: pair[0],
        outputs: pair[1],
        weight: (0..pair[0] * pair[1]).map(number).collect(),
        bias: (0..pair[1]).map(number).collect(),
    });
    let decoder = Decoder::new(layers.collect()).unwrap();
    let vectors = |count: usize| (0..count * 512).map(|index| number(index * 7 + count)).collect();
    let texts = TextEmbeddings::new(512, vectors(SENTENCES), vectors(4)).unwrap();
    let engine = Engine::new(&decoder, &texts).unwrap();
    let pixels = (WIDTH * HEIGHT) as usize;
    let data: Vec<f32> = (0..pixels * 3).map(number).collect();
    let latents = Latents { width: WIDTH, height: HEIGHT, channels: 3, data: &data };
    let rules = Rules { smoothing: Smoothing::Pool29, threshold: 0.4, stretch_positive: false };

    ALLOCATED.reset_peak_usage();
    let before = ALLOCATED.current_usage_as_mb();
    let chosen = answer(&engine, &[latents; 3], &rules);
    let taken_mb = ALLOCATED.peak_usage_as_mb() - before;
    assert_eq!(chosen.len(), SENTENCES);

    let map_mb = (pixels * 4) as f32 / (1 << 20) as f32;
    // Maps before and after smoothing, masks in bytes, and blocks of a few threads.
    let bound_mb = 2.5 * SENTENCES as f32 * map_mb + 40.0;
    let embeddings_mb = 512.0 * map_mb;
    assert!(taken_mb < bound_mb, "{taken_mb} MB, more than {bound_mb}");
    assert!(bound_mb < embeddings_mb / 2.0, "the bound says nothing");
}
