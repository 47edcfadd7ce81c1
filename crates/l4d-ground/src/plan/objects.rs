//! Which boxes of several frames are the same object, where a model gives more than one per frame.

use l4d_endpoint::BoxPx;

use super::Keyframe;

/// Boxes that overlap by more than this within a frame are one box, written twice.
const SAME_BOX_IOU: f64 = 0.9;
/// More objects than one sentence means.
const MOST_OBJECTS: usize = 16;

/// Numbers the objects from 1: each box (frame and place) goes to the object whose last box overlaps it most, or lies
/// nearest; what is left over in a frame begins a new object. Gives what is kept, ascending by frame and object, and
/// how many boxes were not.
pub(super) fn numbered(mut places: Vec<(u32, BoxPx)>) -> (Vec<Keyframe>, usize) {
    places.sort_by_key(|(frame, _)| *frame);
    let all = places.len();
    let mut last_boxes: Vec<BoxPx> = Vec::new();
    let mut kept: Vec<Keyframe> = Vec::new();
    for of_frame in places.chunk_by(|a, b| a.0 == b.0) {
        let mut boxes: Vec<BoxPx> = Vec::new();
        for (_, place) in of_frame {
            if boxes.len() < MOST_OBJECTS && boxes.iter().all(|other| place.iou(other) <= SAME_BOX_IOU) {
                boxes.push(*place);
            }
        }
        let objects = assign(&boxes, &mut last_boxes);
        let found = boxes.iter().zip(objects).filter_map(|(&place, object)| {
            Some(Keyframe { frame: of_frame[0].0, object: object? as u32 + 1, place })
        });
        kept.extend(found);
    }
    kept.sort_by_key(|keyframe| (keyframe.frame, keyframe.object));
    let dropped = all - kept.len();
    (kept, dropped)
}

/// The object of each box of a frame, from 0, best matches first.
fn assign(boxes: &[BoxPx], last_boxes: &mut Vec<BoxPx>) -> Vec<Option<usize>> {
    let pair = |(index, place): (usize, &BoxPx)| -> Vec<(f64, usize, usize)> {
        last_boxes.iter().zip(0..).map(|(last, object)| (distance(place, last), index, object)).collect()
    };
    let mut pairs: Vec<(f64, usize, usize)> = boxes.iter().enumerate().flat_map(pair).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut objects: Vec<Option<usize>> = vec![None; boxes.len()];
    for (_, index, object) in pairs {
        if objects[index].is_none() && !objects.contains(&Some(object)) {
            objects[index] = Some(object);
            last_boxes[object] = boxes[index];
        }
    }
    for (index, object) in objects.iter_mut().enumerate() {
        if object.is_none() && last_boxes.len() < MOST_OBJECTS {
            *object = Some(last_boxes.len());
            last_boxes.push(boxes[index]);
        }
    }
    objects
}

/// Overlapping boxes are nearer than others; those go by their centres, relative to their size.
fn distance(a: &BoxPx, b: &BoxPx) -> f64 {
    let overlap = a.iou(b);
    if overlap > 0.0 {
        return -overlap;
    }
    let [x, y] = [a.x0 + a.x1 - b.x0 - b.x1, a.y0 + a.y1 - b.y0 - b.y1];
    x.hypot(y) / 2.0 / (a.area() + b.area()).sqrt().max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(frame: u32, x: f64) -> (u32, BoxPx) {
        (frame, BoxPx { x0: x, y0: 0.0, x1: x + 10.0, y1: 10.0 })
    }

    #[test]
    fn an_object_keeps_its_number_however_the_model_lists_it() {
        let objects = |places: &[(u32, f64)]| -> Vec<(u32, u32, f64)> {
            let (kept, _) = numbered(places.iter().map(|&(frame, x)| place(frame, x)).collect());
            kept.iter().map(|found| (found.frame, found.object, found.place.x0)).collect()
        };
        let found = objects(&[(0, 0.0), (0, 50.0), (8, 48.0), (8, 3.0), (16, 40.0)]);
        assert_eq!(found, [(0, 1, 0.0), (0, 2, 50.0), (8, 1, 3.0), (8, 2, 48.0), (16, 2, 40.0)]);
        // A single box a frame is one object, however far it moves.
        assert_eq!(objects(&[(8, 90.0), (0, 0.0)]), [(0, 1, 0.0), (8, 1, 90.0)]);
    }

    #[test]
    fn repeated_boxes_count_once_and_crowds_are_cut() {
        let (kept, dropped) = numbered(vec![place(0, 0.0), place(0, 0.1), place(0, 0.0)]);
        assert_eq!((kept.len(), dropped), (1, 2));
        let (kept, dropped) = numbered((0..40).map(|index| place(0, f64::from(index) * 20.0)).collect());
        assert_eq!((kept.len(), dropped), (16, 24));
    }
}
