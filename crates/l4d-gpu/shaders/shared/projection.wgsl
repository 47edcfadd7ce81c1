// A Gaussian in camera axes: what projecting and its derivative both need.
struct Projection {
    // From the camera, world axes, metres.
    offset: vec3<f32>,
    // Camera axes, metres.
    point: vec3<f32>,
    // Slopes x/z and y/z where the affine approximation is taken, and whether they were clamped back.
    slope: vec2<f32>,
    clamped: vec2<bool>,
    // Columns are the own axes in world axes.
    axes: mat3x3<f32>,
    // Own axes to the picture, pixels per metre: x and y.
    first: vec3<f32>,
    second: vec3<f32>,
    // The same times the scales over `unit`: entries of at most 2, so that no square overflows.
    first_scaled: vec3<f32>,
    second_scaled: vec3<f32>,
    // A power of two, pixels; at least 1.
    unit: f32,
    // Variance that is added to both axes, in square units.
    blur: f32,
}

fn axes_of(q: vec4<f32>) -> mat3x3<f32> {
    let w = q.x;
    let x = q.y;
    let y = q.z;
    let z = q.w;
    return mat3x3(
        vec3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        vec3(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        vec3(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    );
}

fn largest(v: vec3<f32>) -> f32 {
    let sizes = abs(v);
    return max(max(sizes.x, sizes.y), sizes.z);
}

// The power of two below a number of at least 1: dividing by it costs no digits.
fn power_of_two(size: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(max(size, 1.0)) & 0x7f800000u);
}

fn linearize(gaussian: Gaussian, depth: f32) -> Projection {
    var projection: Projection;
    projection.offset = (gaussian.mean - scene.centre_high.xyz) - scene.centre_low.xyz;
    let aside = vec2(dot(scene.across.xyz, projection.offset), dot(scene.below.xyz, projection.offset));
    projection.point = vec3(aside, depth);
    let ratio = aside / depth;
    projection.slope = clamp(ratio, scene.slope_least, scene.slope_most);
    projection.clamped = (ratio < scene.slope_least) | (ratio > scene.slope_most);
    let scale = scene.focal / depth;
    let first = scale.x * (scene.across.xyz - projection.slope.x * scene.ahead.xyz);
    let second = scale.y * (scene.below.xyz - projection.slope.y * scene.ahead.xyz);
    projection.axes = axes_of(gaussian.rotation);
    projection.first = first * projection.axes;
    projection.second = second * projection.axes;
    let first_scaled = projection.first * gaussian.scale;
    let second_scaled = projection.second * gaussian.scale;
    projection.unit = power_of_two(max(largest(first_scaled), largest(second_scaled)));
    projection.first_scaled = first_scaled / projection.unit;
    projection.second_scaled = second_scaled / projection.unit;
    projection.blur = scene.blur / projection.unit / projection.unit;
    return projection;
}

// Unit vector from the camera and the distance. Squares of coordinates could overflow.
fn direction_of(offset: vec3<f32>) -> vec4<f32> {
    let size = largest(offset);
    let small = offset / size;
    let length = sqrt(dot(small, small));
    return vec4(small / length, size * length);
}
