// Where the pairs of each tile start and end among those sorted by tile. Tiles without pairs keep their zeros.
struct Part {
    count: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read_write> bounds: array<u32>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = index_of(group, groups) * LANES + lane;
    if (i >= part.count) {
        return;
    }
    let tile = keys[i];
    if (i == 0u || keys[max(i, 1u) - 1u] != tile) {
        bounds[2u * tile] = i;
    }
    if (i + 1u == part.count || keys[min(i + 1u, part.count - 1u)] != tile) {
        bounds[2u * tile + 1u] = i + 1u;
    }
}
