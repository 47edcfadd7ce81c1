// Puts keys and values where their digit belongs; equal digits keep their order.
@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read> values: array<u32>;
// Scanned: where the keys of a digit of a block start.
@group(0) @binding(3) var<storage, read> histogram: array<u32>;
@group(0) @binding(4) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_values: array<u32>;

// Place of the first key of a digit in the sorted block.
var<workgroup> starts: array<u32, RADIX>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let block = index_of(group, groups);
    count_digits(block, lane);
    workgroupBarrier();

    // All counters in one row, digits outer, lanes inner: sums before each.
    let first = lane * RADIX;
    var total = 0u;
    for (var i = first; i < first + RADIX; i++) {
        total += counters[i];
    }
    var sum = lanes_before(total, lane);
    for (var i = first; i < first + RADIX; i++) {
        let count = counters[i];
        counters[i] = sum;
        sum += count;
    }
    workgroupBarrier();
    if (lane < RADIX) {
        starts[lane] = counters[lane * LANES];
    }
    workgroupBarrier();

    let run = run_of(block, lane);
    for (var i = run.x; i < run.y; i++) {
        let key = keys[i];
        let counter = counter_of(key, lane);
        let digit = counter / LANES;
        let place = histogram[digit * part.blocks + block] + (counters[counter] - starts[digit]);
        counters[counter] += 1u;
        sorted_keys[place] = key;
        sorted_values[place] = values[i];
    }
}
