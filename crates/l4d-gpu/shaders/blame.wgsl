// Backward over pixels: how much of a picture's error each pair of tile and Gaussian is to blame for, as sums over
// the pixels of the tile. Front to back like the drawing itself; what lies behind a Gaussian is the whole pixel less
// what has been blended so far, so nothing is divided by a transmittance.
//
// The ten sums: derivative by colour (3) and by depth, and, each weighted with the derivative by the natural
// logarithm of alpha: 1, u, v, u^2, uv, v^2.
const WIDTH: u32 = MOMENTS;

// Two for each pixel: derivative of the loss by red, green, blue and summed depth; then the derivative by
// accumulated alpha, what the whole pixel is worth (the sum of the derivatives times what they are derivatives by),
// and what has been blended so far is worth.
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
    let tile = part.first_tile + index_of(group, groups);
    if (tile >= part.end_tile) {
        return;
    }
    let strip = strip_of(tile, lane);
    var light = light_on(strip);
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
        if (!stage(first, range.y, lane, light)) {
            break;
        }
        let count = min(LANES, range.y - first);
        for (var i = 0u; i < count; i += TALLIED) {
            for (var slot = 0u; slot < min(TALLIED, count - i); slot++) {
                var by_shown = vec4(0.0);
                var blame = vec4(0.0);
                var u = vec4(0.0);
                var v = 0.0;
                if (any(light.open)) {
                    let footprint = staged[i + slot];
                    let step = blend(footprint, strip, &light);
                    // What a unit of this Gaussian's light is worth, and all that is blended behind it.
                    let worth = by_alpha + vec4(footprint.colour, footprint.depth) * shown;
                    so_far += step.weight * worth;
                    let behind = whole - so_far;
                    let derivative = step.before * worth - behind / (1.0 - step.alpha);
                    // Capped alpha has no gradient.
                    let free = step.blended & (step.alpha < vec4(scene.alpha_max));
                    blame = select(vec4(0.0), derivative * step.alpha, free);
                    by_shown = shown * step.weight;
                    u = step.u;
                    v = step.v;
                }
                let all = dot(blame, vec4(1.0));
                let along = dot(blame, u);
                leave(slot, 0u, lane, by_shown.x);
                leave(slot, 1u, lane, by_shown.y);
                leave(slot, 2u, lane, by_shown.z);
                leave(slot, 3u, lane, by_shown.w);
                leave(slot, 4u, lane, all);
                leave(slot, 5u, lane, along);
                leave(slot, 6u, lane, all * v);
                leave(slot, 7u, lane, dot(blame, u * u));
                leave(slot, 8u, lane, along * v);
                leave(slot, 9u, lane, all * v * v);
            }
            add_up(i, count, lane);
        }
    }
    add_nothing(first, range.y, lane);
    keep(strip, light);
    for (var i = 0u; i < 4u; i++) {
        if (strip.inside[i]) {
            slopes[2u * (pixel_of(strip) + i) + 1u].z = so_far[i];
        }
    }
}
