// Backward over Gaussians: from sums over pixels to the derivatives by the splats.
//
// Written with the columns of the whitened projection, so that nothing cancels even where a Gaussian is a million
// times longer than wide: L being the conic factor and q the picture of an own axis of unit length, L q is
// computed from differences of products of unscaled axes (see `whitened`), and all derivatives from L q.
struct Part {
    // Gaussians.
    count: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<uniform> scene: Scene;
@group(0) @binding(2) var<storage, read> gaussians: array<Gaussian>;
@group(0) @binding(3) var<storage, read> sh: array<f32>;
@group(0) @binding(4) var<storage, read> splats2d: array<Splat2d>;
// Ten per Gaussian, see backward.wgsl.
@group(0) @binding(5) var<storage, read> sums: array<f32>;
// Sixteen a Gaussian: mean (3), centre in normalised device coordinates (2), scale (3), quaternion (4), opacity,
// whether it is visible, and two that are 0.
@group(0) @binding(6) var<storage, read_write> by_gaussian: array<f32>;
@group(0) @binding(7) var<storage, read_write> by_sh: array<f32>;

// Derivative of the exponential with base 2, and what a variance is in units of the whitened exponent.
const FACTOR: f32 = 2.0 * PER_EXPONENT / HALF_LOG2_E;

// L q of the three own axes: first row, second row. With P the scaled axes and c the variance along y the first is
// across / c * (blur * q.x + sum over j of P_j.y (P_j.y q.x - P_j.x q.y)).
fn whitened(projection: Projection, scale: vec3<f32>, splat2d: Splat2d) -> array<vec2<f32>, 3> {
    let variance = dot(projection.second_scaled, projection.second_scaled) + projection.blur;
    let share = projection.second_scaled * (scale / projection.unit);
    var columns: array<vec2<f32>, 3>;
    for (var k = 0u; k < 3u; k++) {
        let minors = projection.second * projection.first[k] - projection.first * projection.second[k];
        let along = (projection.blur * projection.first[k] + dot(share, minors)) / variance;
        columns[k] = vec2(splat2d.across.x * along, splat2d.down * projection.second[k]);
    }
    return columns;
}

fn by_quaternion(q: vec4<f32>, g: mat3x3<f32>) -> vec4<f32> {
    // g holds columns: g[k][i] is the derivative by row i, column k of the rotation matrix.
    let w = q.x;
    let x = q.y;
    let y = q.z;
    let z = q.w;
    let turn = vec3(g[1][2] - g[2][1], g[2][0] - g[0][2], g[0][1] - g[1][0]);
    let yz = g[1][2] + g[2][1];
    let xz = g[0][2] + g[2][0];
    let xy = g[0][1] + g[1][0];
    return 2.0 * vec4(
        x * turn.x + y * turn.y + z * turn.z,
        w * turn.x + y * xy + z * xz - 2.0 * x * (g[1][1] + g[2][2]),
        w * turn.y + x * xy + z * yz - 2.0 * y * (g[0][0] + g[2][2]),
        w * turn.z + x * xz + y * yz - 2.0 * z * (g[0][0] + g[1][1]),
    );
}

// Derivatives of the basis functions by the components of the direction.
fn basis_gradient(d: vec3<f32>) -> array<vec3<f32>, 16> {
    var rows: array<vec3<f32>, 16>;
    let x = d.x;
    let y = d.y;
    let z = d.z;
    let xx = x * x;
    let yy = y * y;
    let zz = z * z;
    if (scene.sh_degree >= 1u) {
        rows[1] = vec3(0.0, -C1, 0.0);
        rows[2] = vec3(0.0, 0.0, C1);
        rows[3] = vec3(-C1, 0.0, 0.0);
    }
    if (scene.sh_degree >= 2u) {
        rows[4] = C2[0] * vec3(y, x, 0.0);
        rows[5] = C2[1] * vec3(0.0, z, y);
        rows[6] = C2[2] * vec3(-2.0 * x, -2.0 * y, 4.0 * z);
        rows[7] = C2[3] * vec3(z, 0.0, x);
        rows[8] = C2[4] * vec3(2.0 * x, -2.0 * y, 0.0);
    }
    if (scene.sh_degree >= 3u) {
        rows[9] = C3[0] * vec3(6.0 * x * y, 3.0 * (xx - yy), 0.0);
        rows[10] = C3[1] * vec3(y * z, x * z, x * y);
        rows[11] = C3[2] * vec3(-2.0 * x * y, 4.0 * zz - xx - 3.0 * yy, 8.0 * y * z);
        rows[12] = C3[3] * vec3(-6.0 * x * z, -6.0 * y * z, 6.0 * zz - 3.0 * xx - 3.0 * yy);
        rows[13] = C3[4] * vec3(4.0 * zz - 3.0 * xx - yy, -2.0 * x * y, 8.0 * x * z);
        rows[14] = C3[5] * vec3(2.0 * x * z, -2.0 * y * z, xx - yy);
        rows[15] = C3[6] * vec3(3.0 * (xx - yy), -6.0 * x * y, 0.0);
    }
    return rows;
}

// Writes the derivatives by the spherical harmonics; returns those by the offset from the camera.
fn through_colour(index: u32, offset: vec3<f32>, by_colour: vec3<f32>) -> vec3<f32> {
    let towards = direction_of(offset);
    let values = basis(towards.xyz);
    let rows = basis_gradient(towards.xyz);
    let count = coefficients();
    let first = index * count * 3u;
    var colour = vec3(0.5);
    for (var k = 0u; k < count; k++) {
        let at = first + k * 3u;
        colour += values[k] * vec3(sh[at], sh[at + 1u], sh[at + 2u]);
    }
    // Colours that are clamped at 0 have no gradient.
    let open = select(by_colour, vec3(0.0), colour < vec3(0.0));
    var by_direction = vec3(0.0);
    for (var k = 0u; k < count; k++) {
        let at = first + k * 3u;
        let by_coefficient = values[k] * open;
        by_sh[at] = by_coefficient.x;
        by_sh[at + 1u] = by_coefficient.y;
        by_sh[at + 2u] = by_coefficient.z;
        by_direction += rows[k] * dot(open, vec3(sh[at], sh[at + 1u], sh[at + 2u]));
    }
    return (by_direction - towards.xyz * dot(by_direction, towards.xyz)) / towards.w;
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
    let splat2d = splats2d[index];
    if (splat2d.radius <= 0.0) {
        return;
    }
    let gaussian = gaussians[index];
    let projection = linearize(gaussian, splat2d.depth);
    let at = index * GRADIENT_SUMS;
    let by_colour = vec3(sums[at], sums[at + 1u], sums[at + 2u]);
    let by_depth = sums[at + 3u];
    let by_log_alpha = sums[at + 4u];
    let first_sums = vec2(sums[at + 5u], sums[at + 6u]);
    let second_sums = mat2x2(sums[at + 7u], sums[at + 8u], sums[at + 8u], sums[at + 9u]);

    let by_centre = 2.0 * PER_EXPONENT * vec2(
        splat2d.across.x * first_sums.x,
        splat2d.across.y * first_sums.x + splat2d.down * first_sums.y,
    );

    let columns = whitened(projection, gaussian.scale, splat2d);
    var by_scale: vec3<f32>;
    var by_axes: mat3x3<f32>;
    // Derivative by the length of all scaled axes together, and by the slopes at which the projection is taken.
    var by_size = 0.0;
    var by_slope = vec2(0.0);
    for (var k = 0u; k < 3u; k++) {
        let scale = gaussian.scale[k];
        let pulled = FACTOR * (second_sums * (columns[k] * scale));
        by_scale[k] = dot(columns[k], pulled);
        by_size += scale * by_scale[k];
        by_axes[k] = scale * (projection.axes * vec3(
            dot(columns[0], pulled), dot(columns[1], pulled), dot(columns[2], pulled),
        ));
        let by_picture = vec2(
            splat2d.across.x * pulled.x,
            splat2d.across.y * pulled.x + splat2d.down * pulled.y,
        );
        by_slope += by_picture * (scale * dot(scene.ahead.xyz, projection.axes[k]));
    }
    let depth = splat2d.depth;
    let ratio = scene.focal / depth;
    by_slope = select(-ratio * by_slope, vec2(0.0), projection.clamped);

    let by_aside = ratio * by_centre + by_slope / depth;
    let by_ahead = by_depth
        - dot(ratio * by_centre, projection.point.xy) / depth
        - by_size / depth
        - dot(by_slope, projection.slope) / depth;
    let by_mean = scene.across.xyz * by_aside.x + scene.below.xyz * by_aside.y + scene.ahead.xyz * by_ahead
        + through_colour(index, projection.offset, by_colour);
    let by_rotation = by_quaternion(gaussian.rotation, by_axes);
    let by_ndc = 0.5 * vec2<f32>(scene.pixels) * by_centre;

    let to = index * GRADIENT_FLOATS;
    for (var axis = 0u; axis < 3u; axis++) {
        by_gaussian[to + axis] = by_mean[axis];
        by_gaussian[to + 5u + axis] = by_scale[axis];
    }
    by_gaussian[to + 3u] = by_ndc.x;
    by_gaussian[to + 4u] = by_ndc.y;
    for (var part_of = 0u; part_of < 4u; part_of++) {
        by_gaussian[to + 8u + part_of] = by_rotation[part_of];
    }
    by_gaussian[to + 12u] = by_log_alpha / gaussian.opacity;
    by_gaussian[to + 13u] = 1.0;
}
