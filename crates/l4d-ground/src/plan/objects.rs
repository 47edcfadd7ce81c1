//! Which boxes of several frames are the same object, where a model gives more than one per frame.

use super::Keyframe;

/// Boxes that overlap by more than this within a frame are one box, written twice.
const SAME_BOX_IOU: f64 = 0.9;
/// More objects than one sentence means.
const MOST_OBJECTS: usize = 16;

/// Numbers the objects from 1: each box goes to the object whose last box overlaps it most, or lies nearest; what is
/// left over in a frame begins a new object. Repeated boxes and points without a box of their own join the first.
/// Gives what is kept, ascending by frame and object, and how many boxes were not.
pub(super) fn numbered(mut places: Vec<Keyframe>) -> (Vec<Keyframe>, usize) {
    places.sort_by_key(|place| place.frame);
    let mut last_boxes: Vec<[f64; 4]> = Vec::new();
    let mut kept: Vec<Keyframe> = Vec::new();
    let mut dropped = 0;
    for frame in places.chunk_by(|a, b| a.frame == b.frame) {
        let begin = kept.len();
        let mut boxes: Vec<[f64; 4]> = Vec::new();
        for place in frame.iter().filter_map(|place| place.box_px) {
            if boxes.iter().any(|other| iou(&place, other) > SAME_BOX_IOU) || boxes.len() == MOST_OBJECTS {
                dropped += 1;
            } else {
                boxes.push(place);
            }
        }
        let objects = assign(&boxes, &mut last_boxes);
        for (place, object) in boxes.iter().zip(objects) {
            let Some(object) = object else {
                dropped += 1;
                continue;
            };
            kept.push(Keyframe {
                frame: frame[0].frame,
                object,
                box_px: Some(*place),
                points_px: Vec::new(),
            });
        }
        kept[begin..].sort_by_key(|keyframe| keyframe.object);
        let points: Vec<[f64; 2]> = frame.iter().flat_map(|place| place.points_px.iter().copied()).collect();
        if points.is_empty() {
            continue;
        }
        match kept.get_mut(begin) {
            Some(first) => first.points_px = points,
            None => {
                kept.push(Keyframe { frame: frame[0].frame, object: 1, box_px: None, points_px: points });
            }
        }
    }
    (kept, dropped)
}

/// The object of each box of a frame, best matches first.
fn assign(boxes: &[[f64; 4]], last_boxes: &mut Vec<[f64; 4]>) -> Vec<Option<u32>> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (index, place) in boxes.iter().enumerate() {
        pairs.extend(
            last_boxes.iter().enumerate().map(|(object, last)| (distance(place, last), index, object)),
        );
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut objects = vec![None; boxes.len()];
    let mut is_taken = vec![false; last_boxes.len()];
    for (_, index, object) in pairs {
        if objects[index].is_none() && !is_taken[object] {
            objects[index] = Some(object);
            is_taken[object] = true;
            last_boxes[object] = boxes[index];
        }
    }
    for (index, object) in objects.iter_mut().enumerate() {
        if object.is_none() && last_boxes.len() < MOST_OBJECTS {
            *object = Some(last_boxes.len());
            last_boxes.push(boxes[index]);
        }
    }
    objects.into_iter().map(|object| object.map(|object| object as u32 + 1)).collect()
}

/// Overlapping boxes are nearer than others; those go by their centres, relative to their size.
fn distance(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let overlap = iou(a, b);
    if overlap > 0.0 {
        return -overlap;
    }
    let centre = |place: &[f64; 4]| [(place[0] + place[2]) / 2.0, (place[1] + place[3]) / 2.0];
    let size = (area(a) + area(b)).sqrt().max(1e-9);
    let ([ax, ay], [bx, by]) = (centre(a), centre(b));
    (ax - bx).hypot(ay - by) / size
}

fn iou(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let width = (a[2].min(b[2]) - a[0].max(b[0])).max(0.0);
    let height = (a[3].min(b[3]) - a[1].max(b[1])).max(0.0);
    let intersection = width * height;
    let union = area(a) + area(b) - intersection;
    if union > 0.0 { intersection / union } else { 0.0 }
}

fn area(place: &[f64; 4]) -> f64 {
    (place[2] - place[0]) * (place[3] - place[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(frame: u32, x: f64) -> Keyframe {
        Keyframe { frame, object: 0, box_px: Some([x, 0.0, x + 10.0, 10.0]), points_px: Vec::new() }
    }

    fn objects(places: Vec<Keyframe>) -> Vec<(u32, u32, f64)> {
        let (kept, _) = numbered(places);
        kept.iter().map(|found| (found.frame, found.object, found.box_px.unwrap()[0])).collect()
    }

    #[test]
    fn an_object_keeps_its_number_however_the_model_lists_it() {
        let found =
            objects(vec![place(0, 0.0), place(0, 50.0), place(8, 48.0), place(8, 3.0), place(16, 40.0)]);
        assert_eq!(found, [(0, 1, 0.0), (0, 2, 50.0), (8, 1, 3.0), (8, 2, 48.0), (16, 2, 40.0)]);
    }

    #[test]
    fn a_single_box_a_frame_is_one_object_however_far_it_moves() {
        assert_eq!(objects(vec![place(8, 90.0), place(0, 0.0)]), [(0, 1, 0.0), (8, 1, 90.0)]);
    }

    #[test]
    fn repeated_boxes_count_once_and_crowds_are_cut() {
        let (kept, dropped) = numbered(vec![place(0, 0.0), place(0, 0.1), place(0, 0.0)]);
        assert_eq!((kept.len(), dropped), (1, 2));
        let (kept, dropped) = numbered((0..40).map(|index| place(0, f64::from(index) * 20.0)).collect());
        assert_eq!((kept.len(), dropped), (16, 24));
    }

    #[test]
    fn points_join_the_box_of_their_frame() {
        let point = |frame| Keyframe { box_px: None, points_px: vec![[1.0, 2.0]], ..place(frame, 0.0) };
        let (kept, _) = numbered(vec![place(0, 0.0), point(0), point(8)]);
        assert_eq!((kept[0].points_px.len(), kept[0].box_px.is_some()), (1, true));
        assert_eq!((kept[1].frame, kept[1].object, kept[1].box_px), (8, 1, None));
    }
}
