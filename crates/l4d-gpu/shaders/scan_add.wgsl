// Adds to each number of a block what all blocks before it sum up to.
struct Part {
    count: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read_write> numbers: array<u32>;
@group(0) @binding(2) var<storage, read> totals: array<u32>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let block = index_of(group, groups);
    for (var turn = 0u; turn < RUN; turn++) {
        let i = block * BLOCK + turn * LANES + lane;
        if (i < part.count) {
            numbers[i] = plus(numbers[i], totals[block]);
        }
    }
}
