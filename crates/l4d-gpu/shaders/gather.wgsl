// The transpose of spread: for each pair of tile and Gaussian the sum over pixels of blend weight times what the
// pixel holds, eight channels at a time.
const WIDTH: u32 = CHANNELS;

@group(0) @binding(7) var<storage, read> pixels: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> partials: array<f32>;

fn held(strip: Strip, pixel: u32, half: u32) -> vec4<f32> {
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
    let tile = part.first_tile + index_of(group, groups);
    if (tile >= part.end_tile) {
        return;
    }
    let strip = strip_of(tile, lane);
    var light = light_on(strip);
    let lower = mat4x4(held(strip, 0u, 0u), held(strip, 1u, 0u), held(strip, 2u, 0u), held(strip, 3u, 0u));
    let upper = mat4x4(held(strip, 0u, 1u), held(strip, 1u, 1u), held(strip, 2u, 1u), held(strip, 3u, 1u));
    let range = range_of(tile, lane);
    var first = range.x;
    for (; first < range.y; first += LANES) {
        if (!stage(first, range.y, lane, light)) {
            break;
        }
        let count = min(LANES, range.y - first);
        for (var i = 0u; i < count; i += TALLIED) {
            for (var slot = 0u; slot < min(TALLIED, count - i); slot++) {
                var low = vec4(0.0);
                var high = vec4(0.0);
                if (any(light.open)) {
                    let weight = blend(staged[i + slot], strip, &light).weight;
                    low = lower * weight;
                    high = upper * weight;
                }
                leave(slot, 0u, lane, low.x);
                leave(slot, 1u, lane, low.y);
                leave(slot, 2u, lane, low.z);
                leave(slot, 3u, lane, low.w);
                leave(slot, 4u, lane, high.x);
                leave(slot, 5u, lane, high.y);
                leave(slot, 6u, lane, high.z);
                leave(slot, 7u, lane, high.w);
            }
            add_up(i, count, lane);
        }
    }
    add_nothing(first, range.y, lane);
    keep(strip, light);
}
