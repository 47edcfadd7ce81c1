// Sums over the pixels of a tile, for a few Gaussians at a time: each lane leaves its own sums, then each of some
// lanes adds up one number over all lanes, always in the same order.
//
// The pass defines WIDTH, the numbers a Gaussian.

// One more than the lanes, so that neighbours read from different banks.
const TALLY_STRIDE: u32 = LANES + 1u;
var<workgroup> tally: array<f32, TALLIED * WIDTH * TALLY_STRIDE>;

fn leave(slot: u32, number: u32, lane: u32, value: f32) {
    tally[(slot * WIDTH + number) * TALLY_STRIDE + lane] = value;
}

// Sums of the staged Gaussians from `first` on, to their places in `partials`. Every lane has to call it.
fn add_up(first: u32, staged_count: u32, lane: u32) {
    workgroupBarrier();
    let slots = min(TALLIED, staged_count - first);
    if (lane < slots * WIDTH) {
        var sum = 0.0;
        for (var other = 0u; other < LANES; other++) {
            sum += tally[lane * TALLY_STRIDE + other];
        }
        let pair = staged_pairs[first + lane / WIDTH];
        if (pair >= part.first_pair && pair < part.end_pair) {
            partials[(pair - part.first_pair) * WIDTH + lane % WIDTH] = sum;
        }
    }
    workgroupBarrier();
}

// Nothing for the entries of a tile from `first` on: none of its pixels is open when they come.
fn add_nothing(first: u32, end: u32, lane: u32) {
    for (var i = first + lane; i < end; i += LANES) {
        let pair = pairs[i];
        if (pair >= part.first_pair && pair < part.end_pair) {
            for (var number = 0u; number < WIDTH; number++) {
                partials[(pair - part.first_pair) * WIDTH + number] = 0.0;
            }
        }
    }
}
