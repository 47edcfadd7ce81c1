// Numbers that the Gaussians carry, blended into pixels: eight channels at a time.
@group(0) @binding(7) var<storage, read> features: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> pixels: array<vec4<f32>>;

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let tile = index_of(group, groups);
    if (tile >= scene.tiles.x * scene.tiles.y) {
        return;
    }
    let strip = strip_of(tile, lane);
    var light = load_light(strip);
    // A column a pixel: the lower and the upper four channels. What is indexed with a variable stays apart from what
    // the loop adds to, which then lives in registers.
    var low_before: mat4x4<f32>;
    var high_before: mat4x4<f32>;
    if (!begins()) {
        for (var i = 0u; i < 4u; i++) {
            if (strip.inside[i]) {
                low_before[i] = pixels[2u * (pixel_of(strip) + i)];
                high_before[i] = pixels[2u * (pixel_of(strip) + i) + 1u];
            }
        }
    }
    var low = low_before;
    var high = high_before;
    let range = range_of(tile, lane);
    for (var first = range.x; first < range.y; first += LANES) {
        if (!load_batch(first, range.y, lane, light)) {
            break;
        }
        let count = min(LANES, range.y - first);
        for (var i = 0u; i < count && any(light.open); i++) {
            let weight = blend(staged[i], strip, &light).weight;
            let lower = features[2u * staged_owners[i]];
            let upper = features[2u * staged_owners[i] + 1u];
            low += mat4x4(weight.x * lower, weight.y * lower, weight.z * lower, weight.w * lower);
            high += mat4x4(weight.x * upper, weight.y * upper, weight.z * upper, weight.w * upper);
        }
    }
    store_light(strip, light);
    var low_after = low;
    var high_after = high;
    for (var i = 0u; i < 4u; i++) {
        if (strip.inside[i]) {
            pixels[2u * (pixel_of(strip) + i)] = low_after[i];
            pixels[2u * (pixel_of(strip) + i) + 1u] = high_after[i];
        }
    }
}
