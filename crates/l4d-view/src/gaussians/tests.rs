use l4d_data::Timeline;
use l4d_splat::synthetic::Room;

use super::*;

/// The numbers of a block as the page reads them: what stands still, then each moment; rows of columns.
fn read(layout: &Layout, bytes: &[u8]) -> Vec<Vec<Vec<f32>>> {
    let steps: Vec<u16> = bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
    let mut at = 0;
    let mut table = |rows: usize| {
        let mut table = vec![Vec::new(); rows];
        for [least, largest] in &layout.ranges {
            for row in &mut table {
                row.push(least + (largest - least) * f32::from(steps[at]) / 65535.0);
                at += 1;
            }
        }
        table
    };
    let moments = layout.times.len() * usize::from(layout.moving > 0);
    let tables = std::iter::once(table(layout.still)).collect::<Vec<_>>();
    let tables = tables.into_iter().chain((0..moments).map(|_| table(layout.moving))).collect();
    assert_eq!(at, steps.len(), "nothing is left over");
    tables
}

#[test]
fn what_is_read_is_the_model_to_half_a_step() {
    let model = Room::small(7).model().unwrap();
    let (layout, bytes) = sampled(&model, Timeline::CANONICAL).unwrap();
    assert_eq!((layout.still, layout.moving, layout.harmonics), (300, 100, 12));
    assert_eq!(
        (layout.times.len(), layout.times[0], layout.times[12], layout.times[24]),
        (25, 0.0, 0.5, 1.0)
    );
    let tables = read(&layout, &bytes);
    assert_eq!(tables.len(), 26);
    let degree = model.gaussians.sh_degree;
    for (&time, table) in layout.times.iter().zip(&tables[1..]) {
        let state = model.at(time).unwrap();
        for (row, &index) in table.iter().zip(&model.dynamic) {
            let expected = numbers(&state, index as usize, degree);
            let turned = if row[6..10].iter().zip(&expected[6..10]).map(|(a, b)| a * b).sum::<f32>() < 0.0 {
                -1.0
            } else {
                1.0
            };
            for (column, (value, expected)) in row.iter().zip(expected).enumerate() {
                let expected = if (6..10).contains(&column) { turned * expected } else { expected };
                let [least, largest] = layout.ranges[column];
                let half = 0.51 * (largest - least) / 65535.0 + 1e-6;
                assert!(
                    (value - expected).abs() <= half,
                    "column {column} at {time}: {value} and {expected}"
                );
            }
        }
    }
}

#[test]
fn rotations_go_the_short_way_between_moments() {
    let (layout, bytes) = sampled(&Room::small(3).model().unwrap(), Timeline::CANONICAL).unwrap();
    let tables = read(&layout, &bytes);
    for pair in tables[1..].windows(2) {
        for (before, after) in pair[0].iter().zip(&pair[1]) {
            let dot: f32 = (6..10).map(|column| before[column] * after[column]).sum();
            assert!(dot > -1e-3, "{dot}");
        }
    }
}

#[test]
fn what_stands_still_has_one_moment() {
    let model = Model { field: None, dynamic: Vec::new(), ..Room::small(1).model().unwrap() };
    let (layout, bytes) = sampled(&model, Timeline::CANONICAL).unwrap();
    assert_eq!((layout.still, layout.moving, layout.times.len()), (400, 0, 1));
    assert_eq!(bytes.len(), 2 * 23 * 400);
}

#[test]
fn moments_outside_of_training_are_not_asked_for() {
    let moments = vec![[0.25, 0.0], [0.75, 1.0]];
    let model = Model { moments, ..Room::small(1).model().unwrap() };
    let (layout, _) = sampled(&model, Timeline::CANONICAL).unwrap();
    assert_eq!((layout.times[0], layout.times[24]), (0.25, 0.75));
}

#[test]
fn of_too_much_colour_goes_before_moments() {
    let all_move = |gaussians: usize| {
        let model = Room { gaussians, moving: 1.0, width: 16, ..Room::ordinary(0) }.model().unwrap();
        let (degree, times) = extent(&model, Timeline::CANONICAL)?;
        Ok::<_, StageError>((degree.get(), times.len()))
    };
    assert_eq!(all_move(1000).unwrap(), (3, 25));
    assert_eq!(all_move(10_000).unwrap(), (1, 25));
    assert_eq!(all_move(40_000).unwrap(), (1, 13));
    assert!(all_move(1_000_000).unwrap_err().hint().contains("--gaussians"));
}
