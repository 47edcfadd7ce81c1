// Sums over the tiles of each Gaussian, always in the order of the tiles. A dispatch may see only a part of the
// pairs: it goes on where the one before it stopped.
struct Part {
    count: u32,
    // Numbers a pair.
    width: u32,
    // Pairs in `partials`.
    first_pair: u32,
    end_pair: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read> partials: array<f32>;
@group(0) @binding(4) var<storage, read_write> sums: array<f32>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let entry = index_of(group, groups) * LANES + lane;
    let rank = entry / part.width;
    let number = entry % part.width;
    if (rank >= part.count) {
        return;
    }
    let first = max(offsets[rank], part.first_pair);
    let end = min(offsets[rank + 1u], part.end_pair);
    if (first >= end) {
        return;
    }
    let at = order[rank] * part.width + number;
    var sum = sums[at];
    for (var pair = first; pair < end; pair++) {
        sum += partials[(pair - part.first_pair) * part.width + number];
    }
    sums[at] = sum;
}
