// A Gaussian as it comes from outside, without its colour.
struct Gaussian {
    // World axes, metres.
    mean: vec3<f32>,
    opacity: f32,
    // Standard deviations along the own axes, metres.
    scale: vec3<f32>,
    unused: f32,
    // Unit quaternion (w, x, y, z).
    rotation: vec4<f32>,
}

// A visible Gaussian on the picture plane.
struct Splat2d {
    // Centre in pixels, whole numbers being the centres of pixels.
    mean: vec2<f32>,
    // With `down` the upper triangle (xx, xy, yy) of the matrix that maps an offset from the centre to (u, v), such
    // that the Gaussian falls off as 2^-(u^2 + v^2).
    across: vec2<f32>,
    down: f32,
    opacity: f32,
    // Along the optical axis, metres.
    depth: f32,
    // Half side of the square in which it is drawn, whole pixels; 0 if it is not visible.
    radius: f32,
    colour: vec3<f32>,
}
