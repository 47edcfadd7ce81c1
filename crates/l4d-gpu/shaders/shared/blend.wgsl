// The inner loop: the Gaussians of one tile over its pixels, front to back. Owns the order of the tests, once for
// all passes that use blend weights. A lane holds four pixels side by side.
struct Part {
    // Of each tile the entries that this dispatch blends, counted from the tile's first.
    first_entry: u32,
    end_entry: u32,
}

@group(0) @binding(0) var<uniform> part: Part;
@group(0) @binding(1) var<uniform> scene: Scene;
// Of each tile the first and the end of its entries in `pairs`.
@group(0) @binding(2) var<storage, read> bounds: array<u32>;
// Pairs by tile, and front to back in each tile.
@group(0) @binding(3) var<storage, read> pairs: array<u32>;
// Which Gaussian a pair belongs to.
@group(0) @binding(4) var<storage, read> owners: array<u32>;
@group(0) @binding(5) var<storage, read> splats2d: array<Splat2d>;
// Transmittance of each pixel that the dispatches so far have left; negative where the pixel is finished.
@group(0) @binding(6) var<storage, read_write> transmittances: array<f32>;

const STEPS = vec4<f32>(0.0, 1.0, 2.0, 3.0);

// Four pixels side by side.
struct Strip {
    column: u32,
    row: u32,
    inside: vec4<bool>,
}

struct Light {
    transmittance: vec4<f32>,
    // Where the pixel is not finished.
    open: vec4<bool>,
}

// One Gaussian over one strip.
struct Step {
    // Offset from the Gaussian's centre, whitened.
    u: vec4<f32>,
    v: f32,
    alpha: vec4<f32>,
    // Transmittance in front.
    before: vec4<f32>,
    blended: vec4<bool>,
    // 0 where nothing is blended.
    weight: vec4<f32>,
}

fn strip_at(column: u32, row: u32) -> Strip {
    let columns = vec4(column) + vec4(0u, 1u, 2u, 3u);
    return Strip(column, row, (columns < vec4(scene.pixels.x)) & vec4(row < scene.pixels.y));
}

fn strip_of(tile: u32, lane: u32) -> Strip {
    let column = tile % scene.tiles.x * TILE + lane % (TILE / 4u) * 4u;
    let row = tile / scene.tiles.x * TILE + lane / (TILE / 4u);
    return strip_at(column, row);
}

// Of the first pixel of a strip, row-major.
fn pixel_of(strip: Strip) -> u32 {
    return strip.row * scene.pixels.x + strip.column;
}

// Entries of a tile that this dispatch blends.
fn entries_of(tile: u32) -> vec2<u32> {
    let first = bounds[2u * tile];
    let end = bounds[2u * tile + 1u];
    return vec2(min(first + part.first_entry, end), min(first + part.end_entry, end));
}

// Whether this dispatch is the first to blend.
fn begins() -> bool {
    return part.first_entry == 0u;
}

fn load_light(strip: Strip) -> Light {
    var left = vec4(1.0);
    if (!begins()) {
        for (var i = 0u; i < 4u; i++) {
            if (strip.inside[i]) {
                left[i] = transmittances[pixel_of(strip) + i];
            }
        }
    }
    return Light(abs(left), strip.inside & (left > vec4(0.0)));
}

fn store_light(strip: Strip, light: Light) {
    let left = select(-light.transmittance, light.transmittance, light.open);
    for (var i = 0u; i < 4u; i++) {
        if (strip.inside[i]) {
            transmittances[pixel_of(strip) + i] = left[i];
        }
    }
}

// 2^-x for x >= 0 with a relative error below 3e-7, the same on every adapter; x above 126 counts as 126.
fn exp2_negative(x: vec4<f32>) -> vec4<f32> {
    let bounded = min(x, vec4(126.0));
    let whole = round(bounded);
    let f = whole - bounded;
    var power = f * 0.0013264735 + 0.009671518;
    power = power * f + 0.05550734;
    power = power * f + 0.24022242;
    power = power * f + 0.6931470;
    power = power * f + 1.0;
    let exponent = vec4<u32>(vec4(127) - vec4<i32>(whole)) << vec4(23u);
    return power * bitcast<vec4<f32>>(exponent);
}

fn blend(splat2d: Splat2d, strip: Strip, light: ptr<function, Light>) -> Step {
    let offset = vec2(f32(strip.column), f32(strip.row)) - splat2d.mean;
    let v = splat2d.down * offset.y;
    let u = dot(splat2d.across, offset) + splat2d.across.x * STEPS;
    let alpha = min(splat2d.opacity * exp2_negative(u * u + v * v), vec4(scene.alpha_max));
    let before = (*light).transmittance;
    let after = before * (1.0 - alpha);
    let shows = (*light).open & (alpha >= vec4(scene.alpha_min));
    let passes = after >= vec4(scene.transmittance_min);
    let blended = shows & passes;
    (*light).open = (*light).open & (!shows | passes);
    (*light).transmittance = select(before, after, blended);
    return Step(u, v, alpha, before, blended, select(vec4(0.0), alpha * before, blended));
}
