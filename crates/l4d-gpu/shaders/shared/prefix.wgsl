// Sums over lanes in the order of the lanes, without subgroups.
var<workgroup> lane_totals: array<u32, LANES>;

// Stays at the largest number where a sum would pass it, so that whoever reads a total sees that it is too large.
fn plus(a: u32, b: u32) -> u32 {
    return a + min(b, 0xffffffffu - a);
}

// Sum of the values of all lanes before this one. Contains a barrier: every lane has to call it.
fn lanes_before(value: u32, lane: u32) -> u32 {
    lane_totals[lane] = value;
    workgroupBarrier();
    var sum = 0u;
    for (var other = 0u; other < lane; other++) {
        sum = plus(sum, lane_totals[other]);
    }
    return sum;
}
