use super::*;

fn two() -> Gaussians {
    Gaussians {
        sh_degree: ShDegree::ZERO,
        means: vec![[0.0; 3], [1.0, 2.0, 3.0]],
        log_scales: vec![[0.0, (0.5_f32).ln(), -200.0], [-3.0, -2.0, -1.0]],
        rotations: vec![[2.0, 0.0, 0.0, 0.0], [0.3, -0.6, 1.2, 0.4]],
        opacity_logits: vec![0.0, 1.5],
        sh: vec![[0.5; 3], [-0.1, 0.2, 0.7]],
    }
}

fn poisoned(change: impl Fn(&mut Gaussians)) -> String {
    let mut gaussians = two();
    change(&mut gaussians);
    gaussians.activate().unwrap_err().to_string()
}

#[test]
fn activation_by_hand() {
    let splats = two().activate().unwrap();
    assert_eq!(splats.scales()[0], [1.0, 0.5, 0.0]);
    assert_eq!(splats.rotations()[0], [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(splats.opacities()[0], 0.5);
    let length: f32 = splats.rotations()[1].iter().map(|value| value * value).sum();
    assert!((length - 1.0).abs() < 1e-6);
    assert_eq!(splats.sh_of(1), [[-0.1, 0.2, 0.7]]);
}

#[test]
fn extreme_parameters_activate_to_what_they_mean() {
    let mut gaussians = two();
    gaussians.opacity_logits = vec![-200.0, 200.0];
    gaussians.rotations = vec![[0.0; 4], [1e30, 0.0, 0.0, -1e30]];
    let splats = gaussians.activate().unwrap();
    assert_eq!(splats.opacities(), [0.0, 1.0]);
    assert_eq!(splats.rotations()[0], [1.0, 0.0, 0.0, 0.0]);
    assert!((splats.rotations()[1][3] + 0.5_f32.sqrt()).abs() < 1e-7);
    gaussians.rotations[1] = [1e-30, 0.0, 1e-30, 0.0];
    assert_eq!(gaussians.activate().unwrap().rotations()[1], [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn what_cannot_be_drawn_is_named_with_its_index_and_raw_field() {
    assert!(poisoned(|g| g.log_scales[0][1] = 89.0).starts_with("Gaussian 0, field `log_scales` is 89"));
    assert_eq!(poisoned(|g| g.sh.truncate(1)), "field `sh` has 1 entries where 2 are needed");
}

#[test]
fn parts_that_are_no_splats_are_refused() {
    let parts = || two().activate().unwrap().into_parts();
    assert!(Splats::new(parts()).is_ok());
    type Change = fn(&mut SplatParts);
    let changes: [(Change, &str); 6] = [
        (|p| p.scales[1][0] = -1e-9, "Gaussian 1, field `scales` is -0.000000001"),
        (|p| p.rotations[0] = [0.0; 4], "Gaussian 0, field `rotations` is 0"),
        (|p| p.opacities[1] = 1.001, "Gaussian 1, field `opacities` is 1.001"),
        (|p| p.opacities[0] = f32::NAN, "Gaussian 0, field `opacities` is NaN"),
        (|p| p.sh[1][2] = f32::NEG_INFINITY, "Gaussian 1, field `sh` is -inf"),
        (|p| p.scales.truncate(1), "field `scales` has 1 entries"),
    ];
    for (change, message) in changes {
        let mut changed = parts();
        change(&mut changed);
        let error = Splats::new(changed).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

/// A loss that is linear in the splats, so that its gradient is the coefficients.
fn coefficients() -> SplatGradients {
    let mut gradients = SplatGradients::zeros(&two().activate().unwrap());
    gradients.by.scales = vec![[0.3, -1.0, 2.0], [0.7, 0.1, -0.4]];
    gradients.by.rotations = vec![[1.0, 2.0, -1.0, 0.5], [-0.2, 0.9, 0.3, -1.1]];
    gradients.by.opacities = vec![1.25, -0.8];
    gradients
}

/// The loss of `coefficients` in f64, with the activations written out.
fn loss(raw: &[[f64; 8]; 2]) -> f64 {
    let gradients = coefficients();
    let mut sum = 0.0;
    for (index, row) in raw.iter().enumerate() {
        let length = row[3..7].iter().map(|value| value * value).sum::<f64>().sqrt();
        for (&gradient, log_scale) in gradients.by.scales[index].iter().zip(&row[..3]) {
            sum += f64::from(gradient) * log_scale.exp();
        }
        for (&gradient, value) in gradients.by.rotations[index].iter().zip(&row[3..7]) {
            sum += f64::from(gradient) * value / length;
        }
        sum += f64::from(gradients.by.opacities[index]) / (1.0 + (-row[7]).exp());
    }
    sum
}

#[test]
fn gradients_through_the_activations_are_central_differences() {
    let gaussians = two();
    let raw: [[f64; 8]; 2] = std::array::from_fn(|index| {
        let [a, b, c] = gaussians.log_scales[index];
        let [w, x, y, z] = gaussians.rotations[index];
        [a, b, c, w, x, y, z, gaussians.opacity_logits[index]].map(f64::from)
    });
    let gradients = coefficients().through_activation(&gaussians);
    for index in 0..2 {
        let [a, b, c] = gradients.log_scales[index];
        let [w, x, y, z] = gradients.rotations[index];
        let ours = [a, b, c, w, x, y, z, gradients.opacity_logits[index]];
        for (axis, &ours) in ours.iter().enumerate() {
            let shifted = |by: f64| {
                let mut raw = raw;
                raw[index][axis] += by;
                loss(&raw)
            };
            let difference = (shifted(1e-5) - shifted(-1e-5)) / 2e-5;
            assert!((f64::from(ours) - difference).abs() < 1e-6, "{index} {axis}: {ours} {difference}");
        }
    }
}

#[test]
fn saturated_opacities_keep_their_gradient() {
    let mut gaussians = two();
    gaussians.opacity_logits = vec![30.0, -30.0];
    let logits = coefficients().through_activation(&gaussians).opacity_logits;
    let expected = f64::exp(-30.0);
    for (logit, factor) in logits.iter().zip([1.25, -0.8]) {
        assert!((f64::from(*logit) / (factor * expected) - 1.0).abs() < 1e-5, "{logit}");
    }
}

#[test]
fn gradients_of_several_pictures_add_up() {
    let mut sum = coefficients();
    let mut other = coefficients();
    other.visible[1] = true;
    other.means_ndc[1] = [3.0, -4.0];
    sum.add(&other);
    assert_eq!(sum.by.opacities, [2.5, -1.6]);
    assert_eq!((sum.visible, sum.by.scales[1][0]), (vec![false, true], 1.4));
}
