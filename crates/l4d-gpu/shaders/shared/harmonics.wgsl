// Real spherical harmonics up to degree 3 in the order and with the signs of 3D Gaussian splatting.
const C0: f32 = 0.28209479177387814;
const C1: f32 = 0.4886025119029199;
const C2 = array<f32, 5>(
    1.0925484305920792, -1.0925484305920792, 0.31539156525252005, -1.0925484305920792, 0.5462742152960396,
);
const C3 = array<f32, 7>(
    -0.5900435899266435, 2.890611442640554, -0.4570457994644658, 0.3731763325901154, -0.4570457994644658,
    1.445305721320277, -0.5900435899266435,
);

// Coefficients a colour channel.
fn coefficients() -> u32 {
    return (scene.sh_degree + 1u) * (scene.sh_degree + 1u);
}

// The basis functions in a unit direction; 0 beyond the degree.
fn basis(d: vec3<f32>) -> array<f32, 16> {
    var values: array<f32, 16>;
    let x = d.x;
    let y = d.y;
    let z = d.z;
    let xx = x * x;
    let yy = y * y;
    let zz = z * z;
    values[0] = C0;
    if (scene.sh_degree >= 1u) {
        values[1] = -C1 * y;
        values[2] = C1 * z;
        values[3] = -C1 * x;
    }
    if (scene.sh_degree >= 2u) {
        values[4] = C2[0] * x * y;
        values[5] = C2[1] * y * z;
        values[6] = C2[2] * (2.0 * zz - xx - yy);
        values[7] = C2[3] * x * z;
        values[8] = C2[4] * (xx - yy);
    }
    if (scene.sh_degree >= 3u) {
        values[9] = C3[0] * y * (3.0 * xx - yy);
        values[10] = C3[1] * x * y * z;
        values[11] = C3[2] * y * (4.0 * zz - xx - yy);
        values[12] = C3[3] * z * (2.0 * zz - 3.0 * xx - 3.0 * yy);
        values[13] = C3[4] * x * (4.0 * zz - xx - yy);
        values[14] = C3[5] * z * (xx - yy);
        values[15] = C3[6] * x * (xx - 3.0 * yy);
    }
    return values;
}
