// Digits of the keys of one block, counted apart by lane. A lane owns a run of consecutive keys and a column of
// counters, so counting needs no atomics, and keys with equal digits keep their order.
var<workgroup> counters: array<u32, RADIX * LANES>;

struct Part {
    count: u32,
    shift: u32,
    blocks: u32,
}

fn counter_of(key: u32, lane: u32) -> u32 {
    return ((key >> part.shift) & (RADIX - 1u)) * LANES + lane;
}

// Keys of a lane in its block: first and end.
fn run_of(block: u32, lane: u32) -> vec2<u32> {
    let first = block * BLOCK + lane * RUN;
    return min(vec2(first, first + RUN), vec2(part.count));
}

// No lane touches another lane's counters.
fn count_digits(block: u32, lane: u32) {
    for (var digit = 0u; digit < RADIX; digit++) {
        counters[digit * LANES + lane] = 0u;
    }
    let run = run_of(block, lane);
    for (var i = run.x; i < run.y; i++) {
        counters[counter_of(keys[i], lane)] += 1u;
    }
}
