// How often each digit occurs in each block of keys.
@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
// Digits outer, blocks inner, so that the sums before each are where its keys go.
@group(0) @binding(2) var<storage, read_write> histogram: array<u32>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let block = index_of(group, groups);
    count_digits(block, lane);
    workgroupBarrier();
    if (lane < RADIX && block < part.blocks) {
        var sum = 0u;
        for (var other = 0u; other < LANES; other++) {
            sum += counters[lane * LANES + other];
        }
        histogram[lane * part.blocks + block] = sum;
    }
}
