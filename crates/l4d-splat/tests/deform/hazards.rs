//! Rows, places, times and numbers at the edges of what there is.

use l4d_splat::deform::{Bounds, DeformConfig, DeformationField, Init, Trace};

use crate::fixtures::{positions, relative_difference, small_config, small_field, wide};

#[test]
fn no_rows_give_no_offsets_and_no_gradients() {
    let field = small_field(small_config(), 1);
    assert_eq!(field.offsets(&[], 0.5).unwrap(), field.config().zeros(0));
    let mut trace = Trace::default();
    let offsets = field.trace(&[], 0.5, &mut trace).unwrap();
    let mut gradients = field.zero_gradients();
    assert_eq!(field.backward(&mut trace, &offsets, &mut gradients).unwrap(), Vec::<[f32; 3]>::new());
    assert_eq!(gradients, field.zero_gradients());
}

#[test]
fn a_row_is_answered_alike_alone_and_among_others() {
    let field = small_field(small_config(), 1);
    let positions = positions(1000, 3);
    let all = field.offsets(&positions, 0.25).unwrap();
    for row in [0, 255, 256, 999] {
        let alone = field.offsets(&positions[row..=row], 0.25).unwrap();
        for (alone, all) in alone.flat().into_iter().zip(all.flat()) {
            let expected = &all[row * alone.len()..][..alone.len()];
            let near = alone.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1.0e-6);
            assert!(near, "row {row}: {alone:?} instead of {expected:?}");
        }
    }
}

#[test]
fn rows_without_gradient_say_nothing_and_change_nothing() {
    let field = small_field(small_config(), 1);
    let positions = positions(1000, 3);
    // Groups and gaps of many lengths, across the edges of blocks.
    let says = |row: usize| row % 7 < 2 || (250..262).contains(&row);
    let rows: Vec<usize> = (0..1000).filter(|&row| says(row)).collect();
    let mut trace = Trace::default();
    let mut upstream = field.trace(&positions, 0.4, &mut trace).unwrap();
    let coefficients = field.config().sh_coefficients;
    for row in (0..1000).filter(|&row| !says(row)) {
        upstream.means[row] = [0.0; 3];
        upstream.log_scales[row] = [-0.0; 3];
        upstream.rotations[row] = [0.0; 4];
        upstream.opacity_logits[row] = 0.0;
        upstream.sh[row * coefficients..][..coefficients].fill([0.0; 3]);
    }
    let mut among = field.zero_gradients();
    let slopes = field.backward(&mut trace, &upstream, &mut among).unwrap();

    let alone_at: Vec<[f32; 3]> = rows.iter().map(|&row| positions[row]).collect();
    let alone_upstream = field.trace(&alone_at, 0.4, &mut trace).unwrap();
    let mut alone = field.zero_gradients();
    let alone_slopes = field.backward(&mut trace, &alone_upstream, &mut alone).unwrap();
    let (among, alone) = (among.lists(), alone.lists());
    for (among, alone) in
        among.planes.iter().chain(&among.layers).zip(alone.planes.iter().chain(&alone.layers))
    {
        assert!(relative_difference(among, &wide(alone)) < 1.0e-5);
    }
    assert!(slopes.iter().enumerate().all(|(row, slope)| says(row) || *slope == [0.0; 3]));
    for (row, alone) in rows.into_iter().zip(alone_slopes) {
        let near = slopes[row].iter().zip(alone).all(|(a, b)| (a - b).abs() < 1.0e-5 * (1.0 + b.abs()));
        assert!(near, "row {row}: {:?} instead of {alone:?}", slopes[row]);
    }
}

#[test]
fn outside_the_box_everything_is_as_on_its_nearest_face() {
    let field = small_field(small_config(), 2);
    let far = [[9.0, 0.25, -0.5], [-1.0e30, -3.0, 0.5], [f32::MAX, f32::MIN, f32::MAX]];
    let near = far.map(|position: [f32; 3]| position.map(|value| value.clamp(-1.0, 1.0)));
    for time in [0.0, 0.4, 1.0] {
        assert_eq!(field.offsets(&far, time).unwrap(), field.offsets(&near, time).unwrap());
        let mut trace = Trace::default();
        let offsets = field.trace(&far, time, &mut trace).unwrap();
        let slopes = field.backward(&mut trace, &offsets, &mut field.zero_gradients()).unwrap();
        assert_eq!(slopes[0][0], 0.0);
        assert!(slopes[0][1] != 0.0 && slopes[0][2] != 0.0);
        assert_eq!([slopes[1][0], slopes[1][1]], [0.0; 2]);
        assert_eq!(slopes[2], [0.0; 3]);
    }
    // Faces belong to the outside.
    let mut trace = Trace::default();
    let offsets = field.trace(&[[1.0; 3], [-1.0; 3], [1.0, 0.3, -1.0]], 0.5, &mut trace).unwrap();
    let slopes = field.backward(&mut trace, &offsets, &mut field.zero_gradients()).unwrap();
    assert_eq!([slopes[0], slopes[1]], [[0.0; 3]; 2]);
    assert!(slopes[2][0] == 0.0 && slopes[2][1] != 0.0 && slopes[2][2] == 0.0);
}

#[test]
fn the_first_and_the_last_moment_are_inside_the_clip_and_others_are_not() {
    let field = small_field(small_config(), 3);
    for time in [0.0, -0.0, f32::MIN_POSITIVE, 1.0] {
        assert!(field.offsets(&[[0.0; 3]], time).is_ok());
    }
    for time in [-0.001, 1.001, f32::NAN, f32::INFINITY] {
        let error = field.offsets(&[[0.0; 3]], time).unwrap_err();
        assert!(error.to_string().starts_with("time is"), "{error}");
        assert!(field.trace(&[[0.0; 3]], time, &mut Trace::default()).is_err());
    }
}

#[test]
fn the_first_half_of_the_time_axis_is_never_read_from_a_foreign_field() {
    let field = small_field(small_config(), 3);
    let mut trace = Trace::default();
    let offsets = field.trace(&positions(40, 9), 0.0, &mut trace).unwrap();
    let mut gradients = field.zero_gradients();
    field.backward(&mut trace, &offsets, &mut gradients).unwrap();
    // Plane (x, t) of level 0: 4 channels of 7 times of 5 places. Time 0 lies on the middle row.
    let plane = &field.gradient_tensors(&gradients)["deformation_net.grid.grids.0.2"];
    assert_eq!(plane.shape, [1, 4, 7, 5]);
    for (place, value) in plane.data.iter().enumerate() {
        assert_eq!(*value != 0.0, place / 5 % 7 == 3, "value {place} is {value}");
    }
}

#[test]
fn positions_that_are_not_finite_are_named() {
    let field = small_field(small_config(), 4);
    for poison in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut positions = positions(300, 1);
        positions[271][1] = poison;
        let message = field.offsets(&positions, 0.5).unwrap_err().to_string();
        assert!(message.starts_with("row 271: the position ("), "{message}");
        assert_eq!(field.trace(&positions, 0.5, &mut Trace::default()).unwrap_err().to_string(), message);
    }
}

#[test]
fn a_poisoned_gradient_is_named_and_changes_nothing() {
    let field = small_field(small_config(), 4);
    let mut trace = Trace::default();
    let offsets = field.trace(&positions(300, 1), 0.5, &mut trace).unwrap();
    let mut gradients = field.zero_gradients();
    let mut poisoned = offsets.clone();
    poisoned.rotations[270][2] = f32::NAN;
    let message = field.backward(&mut trace, &poisoned, &mut gradients).unwrap_err().to_string();
    assert!(message.starts_with("row 270: the gradient of `rotations` is NaN"), "{message}");
    let mut short = offsets;
    short.sh.pop();
    let message = field.backward(&mut trace, &short, &mut gradients).unwrap_err().to_string();
    assert!(message.starts_with("`sh` has"), "{message}");
    assert_eq!(gradients, field.zero_gradients());
}

#[test]
fn a_diverged_parameter_is_reported_by_the_row_that_it_spoils() {
    for (layer, poison) in [(0, f32::NAN), (2, f32::NAN), (4, f32::INFINITY)] {
        let mut field = small_field(small_config(), 5);
        field.parameters_mut().layers[layer][0] = poison;
        let error = field.offsets(&[[0.1; 3]], 0.5).unwrap_err();
        assert!(error.to_string().contains("row 0: the offset of"), "{error}");
    }
    let mut field = small_field(small_config(), 5);
    field.parameters_mut().planes[0].fill(f32::NAN);
    let error = field.trace(&[[0.1; 3]], 0.5, &mut Trace::default()).unwrap_err();
    assert!(error.to_string().contains("have diverged"), "{error}");
}

#[test]
fn a_standing_field_changes_nothing_until_it_has_learned() {
    let bounds = Bounds::new([[1.0; 3], [-1.0; 3]]).unwrap();
    let field = DeformationField::new(small_config(), bounds, Init::Identity, 0).unwrap();
    let mut trace = Trace::default();
    let offsets = field.trace(&positions(40, 9), 0.3, &mut trace).unwrap();
    assert_eq!(offsets, field.config().zeros(40));
    let mut upstream = offsets;
    upstream.means.fill([1.0; 3]);
    let mut gradients = field.zero_gradients();
    field.backward(&mut trace, &upstream, &mut gradients).unwrap();
    assert!(
        field.gradient_tensors(&gradients)["deformation_net.pos_deform.3.weight"]
            .data
            .iter()
            .any(|value| *value != 0.0)
    );
}

#[test]
fn the_foreign_start_is_within_its_bounds_and_moves_everything() {
    let field = small_field(DeformConfig { channels: 16, width: 64, ..small_config() }, 0);
    let tensors = field.tensors();
    let range = |name: &str| {
        let data = &tensors[&format!("deformation_net.{name}")].data;
        data.iter().fold([f32::MAX, f32::MIN], |[low, high], &value| [low.min(value), high.max(value)])
    };
    let spans = |name: &str, low: f32, high: f32| {
        let [found_low, found_high] = range(name);
        let slack = 0.1 * (high - low);
        assert!(found_low >= low && found_low < low + slack, "{name}: {found_low} instead of {low}");
        assert!(found_high <= high && found_high > high - slack, "{name}: {found_high} instead of {high}");
    };
    spans("grid.grids.1.0", 0.1, 0.5);
    assert_eq!(range("grid.grids.1.2"), [1.0; 2]);
    // Xavier: sqrt(6 / (32 + 64)); biases: 1 / sqrt(32).
    spans("feature_out.0.weight", -0.25, 0.25);
    spans("feature_out.0.bias", -0.176_777, 0.176_777);
    spans("pos_deform.1.weight", -0.216_507, 0.216_507);
    let offsets = field.offsets(&positions(40, 9), 0.3).unwrap();
    assert!(offsets.means.iter().all(|offset| offset.iter().any(|value| value.abs() > 1.0e-4)));
    assert_eq!(field, small_field(DeformConfig { channels: 16, width: 64, ..small_config() }, 0));
}

#[test]
fn a_trace_can_be_used_again_for_fewer_and_more_rows() {
    let field = small_field(small_config(), 7);
    let derive = |trace: &mut Trace, rows: usize, time: f32| {
        let offsets = field.trace(&positions(rows, 1), time, trace).unwrap();
        let mut gradients = field.zero_gradients();
        let slopes = field.backward(trace, &offsets, &mut gradients).unwrap();
        (slopes, gradients)
    };
    let mut used = Trace::default();
    for (rows, time) in [(300, 0.25), (700, 0.5), (40, 0.75), (0, 0.0), (257, 1.0)] {
        assert_eq!(derive(&mut used, rows, time), derive(&mut Trace::default(), rows, time), "{rows} rows");
    }
    assert!(field.trace(&[[f32::NAN; 3]], 0.5, &mut used).is_err());
    let nothing = field.config().zeros(0);
    assert!(field.backward(&mut used, &nothing, &mut field.zero_gradients()).unwrap().is_empty());
}
