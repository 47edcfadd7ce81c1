// Brings the Gaussians of a tile near, as many at a time as there are lanes, until none of its pixels is open.
var<workgroup> staged: array<Splat2d, LANES>;
var<workgroup> staged_pairs: array<u32, LANES>;
var<workgroup> staged_owners: array<u32, LANES>;
var<workgroup> tile_range: vec2<u32>;
// One more than the last entry that an open lane next_entry to begin with.
var<workgroup> next_entry: atomic<u32>;

// First and end of the tile's entries in this dispatch, the same for all lanes.
fn range_of(tile: u32, lane: u32) -> vec2<u32> {
    if (lane == 0u) {
        tile_range = entries_of(tile);
        atomicStore(&next_entry, 0u);
    }
    return workgroupUniformLoad(&tile_range);
}

// Whether there is something left to blend into; the result is the same for all lanes, and each has to ask.
fn load_batch(first: u32, end: u32, lane: u32, light: Light) -> bool {
    if (any(light.open)) {
        atomicMax(&next_entry, first + 1u);
    }
    if (workgroupUniformLoad(&next_entry) <= first) {
        return false;
    }
    if (first + lane < end) {
        let pair = pairs[first + lane];
        let owner = owners[pair];
        staged[lane] = splats2d[owner];
        staged_pairs[lane] = pair;
        staged_owners[lane] = owner;
    }
    workgroupBarrier();
    return true;
}
