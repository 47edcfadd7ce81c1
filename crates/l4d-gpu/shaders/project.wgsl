// Projection: where each Gaussian lies on the picture plane, which tiles it covers, its key of depth.
struct Part {
    // Gaussians.
    count: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<uniform> scene: Scene;
@group(0) @binding(2) var<storage, read> gaussians: array<Gaussian>;
@group(0) @binding(3) var<storage, read> sh: array<f32>;
// Along the optical axis, metres; 0 for what is not in front of the near plane. They come from outside, rounded
// from f64, so that the order is the same everywhere.
@group(0) @binding(4) var<storage, read> depths: array<f32>;
@group(0) @binding(5) var<storage, read_write> splats2d: array<Splat2d>;
// Tiles: first and end column, first and end row, 16 bits each.
@group(0) @binding(6) var<storage, read_write> rects: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> keys: array<u32>;
@group(0) @binding(8) var<storage, read_write> order: array<u32>;
// The first Gaussian that overflows, times 4, plus what overflows.
@group(0) @binding(9) var<storage, read_write> complaint: atomic<u32>;

const MEANS: u32 = 0u;
const SCALES: u32 = 1u;
const SH: u32 = 2u;

// By bits: a compiler may assume that no number is infinite.
fn finite(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u;
}

fn complain(index: u32, about: u32) {
    atomicMin(&complaint, index * 4u + about);
}

// Display colour in the direction from the camera, not clamped.
fn sh_colour(index: u32, offset: vec3<f32>) -> vec3<f32> {
    let values = basis(direction_of(offset).xyz);
    let count = coefficients();
    let first = index * count * 3u;
    var sum = vec3(0.5);
    for (var k = 0u; k < count; k++) {
        let at = first + k * 3u;
        sum += values[k] * vec3(sh[at], sh[at + 1u], sh[at + 2u]);
    }
    return sum;
}

// Tile in which a coordinate lies, along x and y; clamped to the picture.
fn tile_at(edge: vec2<f32>) -> vec2<u32> {
    return vec2<u32>(clamp(floor(edge / f32(TILE)), vec2(0.0), vec2<f32>(scene.tiles)));
}

@compute @workgroup_size(LANES)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = index_of(group, groups) * LANES + lane;
    if (index >= part.count) {
        return;
    }
    order[index] = index;
    keys[index] = scene.hidden_key;
    rects[index] = vec2(0u);
    splats2d[index] = Splat2d(vec2(0.0), vec2(0.0), 0.0, 0.0, 0.0, 0.0, vec3(0.0));

    let gaussian = gaussians[index];
    let depth = depths[index];
    if (depth <= 0.0 || gaussian.opacity < scene.alpha_min) {
        return;
    }
    let projection = linearize(gaussian, depth);
    let mean = scene.focal * projection.point.xy / depth + scene.principal;
    if (!(finite(mean.x) && finite(mean.y))) {
        complain(index, MEANS);
        return;
    }

    // Covariance in square units. Its determinant is a sum of squares, where xx yy - xy^2 would cancel.
    let xx = dot(projection.first_scaled, projection.first_scaled);
    let xy = dot(projection.first_scaled, projection.second_scaled);
    let yy = dot(projection.second_scaled, projection.second_scaled);
    let variance = vec2(xx, yy) + projection.blur;
    let area = cross(projection.first_scaled, projection.second_scaled);
    let determinant = dot(area, area) + projection.blur * (xx + yy) + projection.blur * projection.blur;
    let across = sqrt(HALF_LOG2_E * (variance.y / determinant)) / projection.unit;
    let down = sqrt(HALF_LOG2_E / variance.y) / projection.unit;

    let middle = 0.5 * (variance.x + variance.y);
    let difference = 0.5 * (variance.x - variance.y);
    let roundest = 0.1 / projection.unit / projection.unit / projection.unit / projection.unit;
    let spread = sqrt(max(difference * difference + xy * xy, roundest));
    let radius = ceil(scene.sigmas * sqrt(middle + spread) * projection.unit);
    if (!(finite(across) && finite(down) && finite(radius)) || determinant <= 0.0) {
        complain(index, SCALES);
        return;
    }

    let least = tile_at(mean - radius);
    let most = tile_at(mean + radius + f32(TILE - 1u));
    if (least.x >= most.x || least.y >= most.y) {
        return;
    }
    let raw = sh_colour(index, projection.offset);
    if (!(finite(raw.x) && finite(raw.y) && finite(raw.z))) {
        complain(index, SH);
        return;
    }
    splats2d[index] = Splat2d(
        mean,
        vec2(across, -xy / variance.y * across),
        down,
        gaussian.opacity,
        depth,
        radius,
        max(raw, vec3(0.0)),
    );
    keys[index] = bitcast<u32>(depth) - scene.depth_base;

    // Of the tiles of that square only those matter that touch the box around the ellipse outside of which alpha is
    // too small; a little more, for rounding.
    let reach = max(log2(gaussian.opacity) + scene.span, 0.0);
    let half = sqrt(variance * (reach / HALF_LOG2_E)) * projection.unit;
    let margin = 0.01 + 1e-5 * (abs(mean) + half);
    let first = max(least, tile_at(mean - half - margin));
    let end = min(most, tile_at(mean + half + margin + f32(TILE)));
    if (first.x < end.x && first.y < end.y) {
        rects[index] = first | (end << vec2(16u));
    }
}
