// Blend weights of all Gaussians of a tile in one pixel. One lane: the tests of a Gaussian depend on those before.
// A Gaussian, and the bits of its weight.
@group(0) @binding(7) var<storage, read_write> shown: array<vec2<u32>>;

@compute @workgroup_size(1)
fn main() {
    // The part names the tile, and the pixel in place of pairs.
    let tile = part.first_tile;
    let column = part.first_pair;
    let strip = strip_at(column / 4u * 4u, part.end_pair);
    var light = load_light(strip);
    let entries = entries_of(tile);
    for (var i = entries.x; i < entries.y; i++) {
        let owner = owners[pairs[i]];
        let weight = blend(footprints[owner], strip, &light).weight[column % 4u];
        shown[i - bounds[2u * tile]] = vec2(owner, bitcast<u32>(weight));
    }
    store_light(strip, light);
}
