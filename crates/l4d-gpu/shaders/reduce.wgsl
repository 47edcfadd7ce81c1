// Sums over the tiles of each Gaussian, always in the order of the tiles.
struct Part {
    count: u32,
    // Numbers a pair.
    width: u32,
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
    var sum = 0.0;
    for (var pair = offsets[rank]; pair < offsets[rank + 1u]; pair++) {
        sum += partials[pair * part.width + number];
    }
    sums[order[rank] * part.width + number] = sum;
}
