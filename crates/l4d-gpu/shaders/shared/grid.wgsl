// Workgroups are laid out in rows, because one dimension of a dispatch is limited. The last row may be too long:
// every pass checks its bounds.
fn index_of(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return group.y * groups.x + group.x;
}
