// What one picture shares: the camera, the thresholds of blending, how depths become keys.
struct Scene {
    // Rows of the rotation from world to camera axes.
    across: vec4<f32>,
    below: vec4<f32>,
    ahead: vec4<f32>,
    // The camera's centre is the sum of both: f32 alone would lose digits far from the origin.
    centre_high: vec4<f32>,
    centre_low: vec4<f32>,
    focal: vec2<f32>,
    // Half a pixel less than the principal point: whole numbers are the centres of pixels.
    principal: vec2<f32>,
    // Slopes x/z and y/z beyond which the affine approximation is not taken.
    slope_least: vec2<f32>,
    slope_most: vec2<f32>,
    pixels: vec2<u32>,
    tiles: vec2<u32>,
    blur: f32,
    sigmas: f32,
    alpha_min: f32,
    alpha_max: f32,
    transmittance_min: f32,
    // How far log2 of alpha may fall from 0 until it is too small, and a little more.
    span: f32,
    sh_degree: u32,
    splats: u32,
    // Key of a depth: its bits less these.
    depth_base: u32,
    // Key of what is not visible: behind all others.
    hidden_key: u32,
    unused: vec2<u32>,
}
