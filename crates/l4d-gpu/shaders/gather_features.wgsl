// The transpose of splat_features: for each pair of tile and Gaussian the sum over pixels of blend weight times what the
// pixel holds, eight channels at a time.
const WIDTH: u32 = CHANNELS;

@group(0) @binding(7) var<storage, read> pixels: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> partials: array<f32>;

fn pixel_value(strip: Strip, pixel: u32, half: u32) -> vec4<f32> {
    if (!strip.inside[pixel]) {
        return vec4(0.0);
    }
    return pixels[2u * (pixel_of(strip) + pixel) + half];
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
    let lower = mat4x4(pixel_value(strip, 0u, 0u), pixel_value(strip, 1u, 0u), pixel_value(strip, 2u, 0u), pixel_value(strip, 3u, 0u));
    let upper = mat4x4(pixel_value(strip, 0u, 1u), pixel_value(strip, 1u, 1u), pixel_value(strip, 2u, 1u), pixel_value(strip, 3u, 1u));
    let range = range_of(tile, lane);
    var first = range.x;
    for (; first < range.y; first += LANES) {
        if (!load_batch(first, range.y, lane, light)) {
            break;
        }
        let count = min(LANES, range.y - first);
        for (var i = 0u; i < count; i += SUMMED) {
            for (var slot = 0u; slot < min(SUMMED, count - i); slot++) {
                var low = vec4(0.0);
                var high = vec4(0.0);
                if (any(light.open)) {
                    let weight = blend(staged[i + slot], strip, &light).weight;
                    low = lower * weight;
                    high = upper * weight;
                }
                store_lane_sum(slot, 0u, lane, low.x);
                store_lane_sum(slot, 1u, lane, low.y);
                store_lane_sum(slot, 2u, lane, low.z);
                store_lane_sum(slot, 3u, lane, low.w);
                store_lane_sum(slot, 4u, lane, high.x);
                store_lane_sum(slot, 5u, lane, high.y);
                store_lane_sum(slot, 6u, lane, high.z);
                store_lane_sum(slot, 7u, lane, high.w);
            }
            reduce_lanes(i, count, lane);
        }
    }
    store_zeros(first, range.y, lane);
    store_light(strip, light);
}
