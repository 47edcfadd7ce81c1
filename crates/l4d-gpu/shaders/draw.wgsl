// Colour and depths of each pixel. Of each level of transmittance the depth of the last Gaussian in front of which
// at least as much is left: the one behind which it is less, if the level is reached at all.
@group(0) @binding(7) var<storage, read_write> picture: array<vec4<f32>>;

// Levels of transmittance whose depths are asked for.
const LEVELS = vec3<f32>(0.75, 0.5, 0.25);

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
    // A column a pixel: colour and summed depth, and the three depths. What is indexed with a variable stays apart
    // from what the loop adds to, which then lives in registers.
    var shown_before: mat4x4<f32>;
    var crossed_before: mat4x4<f32>;
    if (!begins()) {
        for (var i = 0u; i < 4u; i++) {
            if (strip.inside[i]) {
                shown_before[i] = picture[2u * (pixel_of(strip) + i)];
                crossed_before[i] = picture[2u * (pixel_of(strip) + i) + 1u];
            }
        }
    }
    var shown = shown_before;
    let crossed = transpose(crossed_before);
    var near = crossed[0];
    var median = crossed[1];
    var far = crossed[2];
    let range = range_of(tile, lane);
    for (var first = range.x; first < range.y; first += LANES) {
        if (!load_batch(first, range.y, lane, light)) {
            break;
        }
        let count = min(LANES, range.y - first);
        for (var i = 0u; i < count && any(light.open); i++) {
            let splat2d = staged[i];
            let step = blend(splat2d, strip, &light);
            let weight = step.weight;
            let carried = vec4(splat2d.colour, splat2d.depth);
            shown += mat4x4(weight.x * carried, weight.y * carried, weight.z * carried, weight.w * carried);
            let depth = vec4(splat2d.depth);
            near = select(near, depth, step.blended & (step.before >= vec4(LEVELS.x)));
            median = select(median, depth, step.blended & (step.before >= vec4(LEVELS.y)));
            far = select(far, depth, step.blended & (step.before >= vec4(LEVELS.z)));
        }
    }
    store_light(strip, light);
    var shown_after = shown;
    for (var i = 0u; i < 4u; i++) {
        if (strip.inside[i]) {
            picture[2u * (pixel_of(strip) + i)] = shown_after[i];
            picture[2u * (pixel_of(strip) + i) + 1u] = vec4(near[i], median[i], far[i], 0.0);
        }
    }
}
