// Sums over the pixels of a tile, for a few Gaussians at a time: each lane leaves its own sums, then each of some
// lanes adds up one number over all lanes, always in the same order.
//
// The pass defines WIDTH, the numbers a Gaussian.

// One more than the lanes, so that neighbours read from different banks.
const LANE_STRIDE: u32 = LANES + 1u;
var<workgroup> lane_sums: array<f32, SUMMED * WIDTH * LANE_STRIDE>;

fn store_lane_sum(slot: u32, number: u32, lane: u32, value: f32) {
    lane_sums[(slot * WIDTH + number) * LANE_STRIDE + lane] = value;
}

// Sums of the staged Gaussians from `first` on, to their places in `partials`. Every lane has to call it.
fn reduce_lanes(first: u32, staged_count: u32, lane: u32) {
    workgroupBarrier();
    let slots = min(SUMMED, staged_count - first);
    if (lane < slots * WIDTH) {
        var sum = 0.0;
        for (var other = 0u; other < LANES; other++) {
            sum += lane_sums[lane * LANE_STRIDE + other];
        }
        let pair = staged_pairs[first + lane / WIDTH];
        partials[pair * WIDTH + lane % WIDTH] = sum;
    }
    workgroupBarrier();
}

// Nothing for the entries of a tile from `first` on: none of its pixels is open when they come.
fn store_zeros(first: u32, end: u32, lane: u32) {
    for (var i = first + lane; i < end; i += LANES) {
        let pair = pairs[i];
        for (var number = 0u; number < WIDTH; number++) {
            partials[pair * WIDTH + number] = 0.0;
        }
    }
}
