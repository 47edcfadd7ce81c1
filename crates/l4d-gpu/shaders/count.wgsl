// How many tiles the Gaussians cover, front to back.
struct Part {
    // Gaussians; one more number, 0, follows theirs and becomes their sum.
    count: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> rects: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let rank = index_of(group, groups) * LANES + lane;
    if (rank > part.count) {
        return;
    }
    var tiles = 0u;
    if (rank < part.count) {
        let rect = rects[order[rank]];
        let sides = (rect >> vec2(16u)) - (rect & vec2(0xffffu));
        tiles = sides.x * sides.y;
    }
    counts[rank] = tiles;
}
