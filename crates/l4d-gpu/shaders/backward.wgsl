// Backward over pixels: the gradient sums of each pair of tile and Gaussian over the pixels of the tile. Front to back like the drawing itself; what lies behind a Gaussian is the whole pixel less
// what has been blended so far, so nothing is divided by a transmittance.
//
// The ten sums: derivative by colour (3) and by depth, and, each weighted with the derivative by the natural
// logarithm of alpha: 1, u, v, u^2, uv, v^2.
const WIDTH: u32 = GRADIENT_SUMS;

// Two for each pixel: derivative of the loss by red, green, blue and summed depth; then the derivative by
// accumulated alpha, the loss of the whole pixel (the sum of the derivatives times what they are derivatives by),
// and the loss that has been blended so far.
@group(0) @binding(7) var<storage, read_write> slopes: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> partials: array<f32>;

fn slope_of(strip: Strip, pixel: u32, half: u32) -> vec4<f32> {
    if (!strip.inside[pixel]) {
        return vec4(0.0);
    }
    return slopes[2u * (pixel_of(strip) + pixel) + half];
}

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
    let shown = mat4x4(
        slope_of(strip, 0u, 0u), slope_of(strip, 1u, 0u), slope_of(strip, 2u, 0u), slope_of(strip, 3u, 0u),
    );
    let rest = mat4x4(
        slope_of(strip, 0u, 1u), slope_of(strip, 1u, 1u), slope_of(strip, 2u, 1u), slope_of(strip, 3u, 1u),
    );
    let by_alpha = transpose(rest)[0];
    let whole = transpose(rest)[1];
    var so_far = transpose(rest)[2];
    let range = range_of(tile, lane);
    var first = range.x;
    for (; first < range.y; first += LANES) {
        if (!load_batch(first, range.y, lane, light)) {
            break;
        }
        let count = min(LANES, range.y - first);
        for (var i = 0u; i < count; i += SUMMED) {
            for (var slot = 0u; slot < min(SUMMED, count - i); slot++) {
                var by_shown = vec4(0.0);
                var by_log_alpha = vec4(0.0);
                var u = vec4(0.0);
                var v = 0.0;
                if (any(light.open)) {
                    let splat2d = staged[i + slot];
                    let step = blend(splat2d, strip, &light);
                    // Derivative by this Gaussian's weight, and the loss of all that is blended behind it.
                    let by_weight = by_alpha + vec4(splat2d.colour, splat2d.depth) * shown;
                    so_far += step.weight * by_weight;
                    let behind = whole - so_far;
                    let derivative = step.before * by_weight - behind / (1.0 - step.alpha);
                    // Capped alpha has no gradient.
                    let free = step.blended & (step.alpha < vec4(scene.alpha_max));
                    by_log_alpha = select(vec4(0.0), derivative * step.alpha, free);
                    by_shown = shown * step.weight;
                    u = step.u;
                    v = step.v;
                }
                let all = dot(by_log_alpha, vec4(1.0));
                let along = dot(by_log_alpha, u);
                store_lane_sum(slot, 0u, lane, by_shown.x);
                store_lane_sum(slot, 1u, lane, by_shown.y);
                store_lane_sum(slot, 2u, lane, by_shown.z);
                store_lane_sum(slot, 3u, lane, by_shown.w);
                store_lane_sum(slot, 4u, lane, all);
                store_lane_sum(slot, 5u, lane, along);
                store_lane_sum(slot, 6u, lane, all * v);
                store_lane_sum(slot, 7u, lane, dot(by_log_alpha, u * u));
                store_lane_sum(slot, 8u, lane, along * v);
                store_lane_sum(slot, 9u, lane, all * v * v);
            }
            reduce_lanes(i, count, lane);
        }
    }
    store_zeros(first, range.y, lane);
    store_light(strip, light);
    for (var i = 0u; i < 4u; i++) {
        if (strip.inside[i]) {
            slopes[2u * (pixel_of(strip) + i) + 1u].z = so_far[i];
        }
    }
}
