//! Pictures that can be computed by hand.

use super::*;
use crate::gaussians::ShDegree;
use crate::splats::SplatParts;

/// Sum of the constant coefficient's products is colour - 0.5.
const C0: f64 = 0.28209479177387814;

/// A Gaussian on the optical axis, round, of standard deviation 0.2 m at depth `z`.
fn round(z: f64, opacity: f64, grey: f64) -> ([f64; 3], f64, [f64; 3]) {
    ([0.0, 0.0, z], opacity, [(grey - 0.5) / C0; 3])
}

fn splats(list: &[([f64; 3], f64, [f64; 3])]) -> Splats<f64> {
    Splats {
        parts: SplatParts {
            sh_degree: ShDegree::ZERO,
            means: list.iter().map(|entry| entry.0).collect(),
            scales: vec![[0.2; 3]; list.len()],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; list.len()],
            opacities: list.iter().map(|entry| entry.1).collect(),
            sh: list.iter().map(|entry| entry.2).collect(),
        },
    }
}

/// 33 x 33 pixels, focal length 50; the axis goes through the centre of pixel (16, 16).
fn view() -> View {
    let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    View::new([33, 33], [50.0, 50.0], [16.5, 16.5], pose).unwrap()
}

fn scene(list: &[([f64; 3], f64, [f64; 3])]) -> ReferenceScene {
    Reference::scene(&splats(list), &view(), &RasterSettings::default()).unwrap()
}

fn close(a: f64, b: f64) {
    // Settings are f32: the blur of 0.3 is known to 8 digits.
    assert!((a - b).abs() < 1e-7, "{a} is not {b}");
}

#[test]
fn a_round_gaussian_falls_off_as_it_should() {
    // 0.2 m at 2 m and focal length 50 are 5 px; the blur makes it sqrt(25.3).
    let drawing = scene(&[round(2.0, 0.8, 0.25)]).draw();
    for (column, row) in [(16, 16), (20, 16), (16, 11), (22, 13)] {
        let squares = f64::from((column - 16) * (column - 16) + (row - 16) * (row - 16));
        let alpha = 0.8 * (-0.5 * squares / 25.3).exp();
        let pixel = (row * 33 + column) as usize;
        close(drawing.alpha[pixel], alpha);
        close(drawing.colour[pixel][1], 0.25 * alpha);
        close(drawing.transmittance[pixel], 1.0 - alpha);
        close(drawing.depth_sum_m[pixel], 2.0 * alpha);
    }
    // Alpha falls below 1/255 where d^2 > 2 * 25.3 * ln(0.8 * 255): 16.4 px.
    assert!(drawing.alpha[16 * 33] > 0.0 && drawing.alpha[33 + 9] == 0.0);
    assert!(drawing.depth_expected_m()[16 * 33 + 16] - 2.0 < 1e-12);
    assert_eq!(drawing.depth_expected_m()[33 + 9], f64::INFINITY);
}

#[test]
fn the_nearer_one_hides_the_farther_one_whatever_their_order() {
    let (near, far) = (round(2.0, 0.6, 0.9), round(4.0, 0.5, 0.2));
    for list in [[near, far], [far, near]] {
        let drawing = scene(&list).draw();
        let centre = 16 * 33 + 16;
        close(drawing.colour[centre][0], 0.6 * 0.9 + 0.4 * 0.5 * 0.2);
        close(drawing.depth_sum_m[centre], 0.6 * 2.0 + 0.4 * 0.5 * 4.0);
        let quantiles = drawing.quantiles.unwrap();
        // Transmittance is 1, 0.4, 0.2.
        assert_eq!(quantiles.near_m[centre], 2.0);
        assert_eq!(quantiles.median_m[centre], 2.0);
        assert_eq!(quantiles.far_m[centre], 4.0);
    }
    let thin = scene(&[round(2.0, 0.4, 0.9), round(4.0, 0.1, 0.2)]).draw().quantiles.unwrap();
    assert_eq!(thin.near_m[16 * 33 + 16], 2.0);
    assert_eq!(thin.median_m[16 * 33 + 16], f64::INFINITY);
}

#[test]
fn alpha_is_capped_and_the_gaussian_that_would_end_the_light_is_not_blended() {
    let opaque = |z| round(z, 1.0, 1.0);
    let centre = 16 * 33 + 16;
    let capped = f64::from(0.99_f32);
    close(scene(&[opaque(2.0)]).draw().alpha[centre], capped);
    // The first leaves 0.01, the second 2e-4, the third would leave 8e-5.
    let (behind, last) = (round(3.0, 0.98, 1.0), round(4.0, 0.6, 1.0));
    let drawing = scene(&[opaque(2.0), behind, last]).draw();
    close(drawing.transmittance[centre], (1.0 - capped) * 0.02);
    assert_eq!(scene(&[opaque(2.0), behind, last]).contributors(16, 16).len(), 2);
    // Nothing comes after the one that would end the light, not even what would leave enough.
    assert_eq!(scene(&[opaque(2.0), opaque(3.0), round(4.0, 0.5, 1.0)]).contributors(16, 16).len(), 1);
}

#[test]
fn equal_depths_are_blended_in_the_order_of_the_list() {
    let list = [round(3.0, 0.5, 0.1), round(3.0, 0.5, 0.9), round(3.0, 0.5, 0.4)];
    let order: Vec<usize> = scene(&list).contributors(16, 16).iter().map(|entry| entry.0).collect();
    assert_eq!(order, [0, 1, 2]);
}

#[test]
fn tiles_are_those_of_the_square_of_three_standard_deviations() {
    // sqrt(25.3 + sqrt(0.1)) * 3 = 15.18, so the radius is 16: columns 0 to 32. At -20 px it ends at -4.
    let mut left = round(2.0, 0.8, 0.5);
    let gaussians = scene(&[left]).gaussians;
    assert_eq!(gaussians[0].tiles[0], 0..2);
    // The square reaches pixel 32, but the rule counts a tile only from the pixel after its first.
    left.0[0] = 0.04;
    assert_eq!(scene(&[left]).gaussians[0].tiles[0], 0..3);
    left.0[0] = -(16.0 + 20.0) / 25.0;
    assert!(scene(&[left]).gaussians.is_empty());
}

#[test]
fn what_is_not_in_front_of_the_near_plane_is_not_drawn() {
    for z in [-2.0, 0.0, 0.1, f64::from(0.2_f32)] {
        assert!(scene(&[round(z, 0.8, 0.5)]).gaussians.is_empty(), "{z}");
    }
    assert_eq!(scene(&[round(0.201, 0.8, 0.5)]).gaussians.len(), 1);
}

#[test]
fn spread_and_gather_use_the_weights_of_the_picture() {
    let scene = scene(&[round(4.0, 0.5, 0.2), round(2.0, 0.6, 0.9)]);
    let centre = 16 * 33 + 16;
    let spread = scene.splat_features(&[10.0, 1.0, -1.0, 0.0], 2);
    close(spread[2 * centre], 0.4 * 0.5 * 10.0 - 0.6);
    close(spread[2 * centre + 1], 0.4 * 0.5);
    let mut pixels = vec![0.0; 33 * 33];
    pixels[centre] = 3.0;
    let gathered = scene.gather_features(&pixels, 1);
    close(gathered[0], 3.0 * 0.4 * 0.5);
    close(gathered[1], 3.0 * 0.6);
}

#[test]
fn gradients_of_one_pixel_by_hand() {
    // Behind alpha 0.6 of 0.9 lie alpha 0.5 of 0.2 and a background of 1.
    let mut settings = RasterSettings { background: [1.0; 3], ..RasterSettings::default() };
    settings.quantiles = false;
    let list = [round(2.0, 0.6, 0.9), round(4.0, 0.5, 0.2)];
    let scene = Reference::scene(&splats(&list), &view(), &settings).unwrap();
    let mut gradient = DrawingGradient::zeros(&view());
    gradient.colour[16 * 33 + 16][0] = 1.0;
    let gradients = scene.backward(&gradient).unwrap();
    close(gradients.by.opacities[0], 0.9 - (0.5 * 0.2 + 0.5));
    close(gradients.by.opacities[1], 0.4 * (0.2 - 1.0));
    close(gradients.by.sh[0][0], 0.6 * C0);
    close(gradients.by.sh[1][0], 0.4 * 0.5 * C0);
    assert_eq!(gradients.by.sh[1][1], 0.0);
    assert_eq!(gradients.visible, [true, true]);
    let drawing = scene.draw();
    assert!(drawing.quantiles.is_none());
    close(drawing.colour[16 * 33 + 16][2], 0.6 * 0.9 + 0.4 * 0.5 * 0.2 + 0.2);
}

#[test]
fn a_scale_that_overflows_is_named() {
    let mut wide = splats(&[round(2.0, 0.6, 0.9), round(2.0, 0.6, 0.9)]);
    wide.parts.scales[1] = [1e200, 1.0, 1.0];
    let error = Reference::scene(&wide, &view(), &RasterSettings::default()).unwrap_err();
    assert!(error.to_string().starts_with("Gaussian 1, field `scales`"), "{error}");
}
