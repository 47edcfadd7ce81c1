// A pair for each tile that a Gaussian covers: Gaussians front to back, their tiles row-major.
struct Part {
    count: u32,
    // Tiles in a row.
    columns: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> rects: array<vec2<u32>>;
// Where the pairs of a Gaussian start, by its rank.
@group(0) @binding(3) var<storage, read> offsets: array<u32>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> pairs: array<u32>;
@group(0) @binding(6) var<storage, read_write> owners: array<u32>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let rank = index_of(group, groups) * LANES + lane;
    if (rank >= part.count) {
        return;
    }
    let owner = order[rank];
    let first = rects[owner] & vec2(0xffffu);
    let end = rects[owner] >> vec2(16u);
    var pair = offsets[rank];
    for (var row = first.y; row < end.y; row++) {
        for (var column = first.x; column < end.x; column++) {
            keys[pair] = row * part.columns + column;
            pairs[pair] = pair;
            owners[pair] = owner;
            pair += 1u;
        }
    }
}
