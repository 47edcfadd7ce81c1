// Replaces each number of a block by the sum of those before it, and notes the sum of the block.
struct Part {
    count: u32,
    blocks: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read_write> numbers: array<u32>;
@group(0) @binding(2) var<storage, read_write> totals: array<u32>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let block = index_of(group, groups);
    let first = min(block * BLOCK + lane * RUN, part.count);
    let end = min(first + RUN, part.count);
    var total = 0u;
    for (var i = first; i < end; i++) {
        total = plus(total, numbers[i]);
    }
    var sum = lanes_before(total, lane);
    if (lane == LANES - 1u && block < part.blocks) {
        totals[block] = plus(sum, total);
    }
    for (var i = first; i < end; i++) {
        let number = numbers[i];
        numbers[i] = sum;
        sum = plus(sum, number);
    }
}
