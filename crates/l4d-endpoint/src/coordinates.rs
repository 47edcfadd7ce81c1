//! How models write down boxes: conventions as data, and the pixels that each of them means.

use std::sync::LazyLock;

use serde::Deserialize;
use serde_json::Value;

use crate::error::EndpointError;

/// A box in pixels of the picture as it was sent; `x0 < x1`, `y0 < y1`, inside the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxPx {
    pub x0: f64,
    /// Upper edge.
    pub y0: f64,
    pub x1: f64,
    pub y1: f64,
}

impl BoxPx {
    /// Intersection over union, 0 to 1.
    pub fn iou(&self, other: &Self) -> f64 {
        let overlap = |low: f64, high: f64| (high - low).max(0.0);
        let intersection = overlap(self.x0.max(other.x0), self.x1.min(other.x1))
            * overlap(self.y0.max(other.y0), self.y1.min(other.y1));
        intersection / (self.area() + other.area() - intersection)
    }

    /// Square pixels.
    pub fn area(&self) -> f64 {
        (self.x1 - self.x0) * (self.y1 - self.y0)
    }
}

/// Order of the four numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Left, upper, right, lower.
    Xyxy,
    /// Upper, left, lower, right.
    Yxyx,
}

/// What the numbers count.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// This much is a whole side of the picture.
    Relative(f64),
    /// Pixels of the picture as it was sent.
    Pixels,
    /// Pixels of the picture as the model's processor resizes it.
    Resized(Resize),
}

/// How a processor resizes: sides become multiples of `factor`, their product stays between two bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resize {
    /// Side of a token, pixels.
    pub factor: u32,
    /// Fewest pixels.
    pub min_pixels: u32,
    /// Most pixels.
    pub max_pixels: u32,
}

impl Resize {
    /// The size that a picture of `width` x `height` gets, pixels.
    pub fn size(&self, width: u32, height: u32) -> (u32, u32) {
        let factor = f64::from(self.factor);
        let (width, height) = (f64::from(width), f64::from(height));
        // Python's `round`, with which the models were trained, rounds halves to even.
        let nearest = |side: f64| (side / factor).round_ties_even().max(1.0) * factor;
        let (mut resized_width, mut resized_height) = (nearest(width), nearest(height));
        let (fewest, most) = (f64::from(self.min_pixels), f64::from(self.max_pixels));
        if resized_width * resized_height > most {
            let shrink = (width * height / most).sqrt();
            let fitted = |side: f64| (side / shrink / factor).floor().max(1.0) * factor;
            (resized_width, resized_height) = (fitted(width), fitted(height));
        } else if resized_width * resized_height < fewest {
            let grow = (fewest / (width * height)).sqrt();
            let fitted = |side: f64| (side * grow / factor).ceil() * factor;
            (resized_width, resized_height) = (fitted(width), fitted(height));
        }
        (resized_width as u32, resized_height as u32)
    }
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convention {
    /// As in the configuration.
    pub name: String,
    /// The field name that models of this kind were trained with: ask with it.
    pub key: String,
    /// Order of the numbers.
    pub order: Order,
    /// What they count.
    pub scale: Scale,
    /// Who was seen to use it.
    pub note: String,
}

#[derive(Deserialize)]
struct File {
    convention: Vec<Convention>,
}

static CONVENTIONS: LazyLock<Vec<Convention>> = LazyLock::new(|| {
    let file: File = toml::from_str(include_str!("coordinates.toml")).expect("the embedded table is valid");
    file.convention
});

impl Convention {
    /// All that are known.
    pub fn all() -> &'static [Convention] {
        &CONVENTIONS
    }

    /// The one of that name.
    ///
    /// # Errors
    /// If there is none; names all.
    pub fn named(name: &str) -> Result<&'static Convention, EndpointError> {
        Self::all().iter().find(|convention| convention.name == name).ok_or_else(|| {
            let names: Vec<&str> = Self::all().iter().map(|convention| convention.name.as_str()).collect();
            EndpointError::not_asked(
                "coordinates",
                format!("`{}` is no convention that l4d knows", name.escape_debug()),
                format!("use one of {}", names.join(", ")),
            )
        })
    }

    /// Where a box lies in a picture of `width` x `height`. Corners may come in any order; what sticks out is cut
    /// off; `None` if nothing is left, or if a number is none.
    pub fn pixels(&self, numbers: [f64; 4], size: (u32, u32)) -> Option<BoxPx> {
        let [x0, y0, x1, y1] = self.in_order(numbers);
        let [width, height] = self.full(size);
        let x = |number: f64| (number / width).clamp(0.0, 1.0) * f64::from(size.0);
        let y = |number: f64| (number / height).clamp(0.0, 1.0) * f64::from(size.1);
        let [x0, x1, y0, y1] = [x(x0), x(x1), y(y0), y(y1)];
        let cut = BoxPx { x0: x0.min(x1), y0: y0.min(y1), x1: x0.max(x1), y1: y0.max(y1) };
        let is_sound = numbers.iter().all(|number| number.is_finite()) && cut.x0 < cut.x1 && cut.y0 < cut.y1;
        is_sound.then_some(cut)
    }

    /// Whether all of the numbers lie in the range that the convention has for a picture of this size.
    pub fn holds(&self, numbers: [f64; 4], size: (u32, u32)) -> bool {
        let [width, height] = self.full(size);
        let limits = [width, height, width, height];
        self.in_order(numbers).iter().zip(limits).all(|(number, limit)| (0.0..=limit).contains(number))
    }

    /// What a model of this convention writes for a box; the inverse of [`Convention::pixels`].
    pub fn numbers(&self, place: BoxPx, size: (u32, u32)) -> [f64; 4] {
        let [width, height] = self.full(size);
        let x = |pixels: f64| pixels / f64::from(size.0) * width;
        let y = |pixels: f64| pixels / f64::from(size.1) * height;
        self.in_order([x(place.x0), y(place.y0), x(place.x1), y(place.y1)])
    }

    /// Left, upper, right, lower from numbers of the convention, and back.
    fn in_order(&self, [a, b, c, d]: [f64; 4]) -> [f64; 4] {
        match self.order {
            Order::Xyxy => [a, b, c, d],
            Order::Yxyx => [b, a, d, c],
        }
    }

    /// What the far corner of a picture of `width` x `height` is written as.
    fn full(&self, (width, height): (u32, u32)) -> [f64; 2] {
        let (width, height) = match self.scale {
            Scale::Relative(range) => return [range, range],
            Scale::Pixels => (width, height),
            Scale::Resized(resize) => resize.size(width, height),
        };
        [f64::from(width), f64::from(height)]
    }
}

/// A box as a model wrote it.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenBox {
    /// What the model says is in it.
    pub label: Option<String>,
    /// Its four numbers, in an order and scale that the model's convention gives.
    pub numbers: [f64; 4],
}

impl WrittenBox {
    /// The box that an object is, if it is one: by a field of four numbers, two corners or four named sides.
    pub fn of(value: &Value) -> Option<Self> {
        const KEYS: [&str; 5] = ["bbox_2d", "box_2d", "bbox", "box", "bounding_box"];
        const LABELS: [&str; 5] = ["label", "name", "color", "colour", "object"];
        let fields = value.as_object()?;
        let numbers = KEYS.iter().find_map(|key| four_numbers(fields.get(*key)?));
        let numbers = numbers.or_else(|| named_sides(value))?;
        let label = LABELS.iter().find_map(|key| fields.get(*key)?.as_str());
        Some(Self { label: label.map(str::to_owned), numbers })
    }
}

fn four_numbers(value: &Value) -> Option<[f64; 4]> {
    let numbers: Vec<f64> = match value {
        Value::Array(items) => {
            let flat = items
                .iter()
                .flat_map(|item| item.as_array().map_or(std::slice::from_ref(item), Vec::as_slice));
            flat.map(Value::as_f64).collect::<Option<_>>()?
        }
        _ => return named_sides(value),
    };
    numbers.try_into().ok()
}

fn named_sides(value: &Value) -> Option<[f64; 4]> {
    const NAMES: [[&str; 4]; 4] = [
        ["x_min", "y_min", "x_max", "y_max"],
        ["xmin", "ymin", "xmax", "ymax"],
        ["x1", "y1", "x2", "y2"],
        ["x0", "y0", "x1", "y1"],
    ];
    NAMES.iter().find_map(|names| {
        let numbers: Option<Vec<f64>> = names.iter().map(|name| value.get(*name)?.as_f64()).collect();
        numbers?.try_into().ok()
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    #[test]
    fn sizes_are_those_of_the_models_own_processor() {
        // transformers 5.23.0, smart_resize of qwen2_vl; tests/endpoint_server/resize.py prints them.
        let small = Resize { factor: 28, min_pixels: 3_136, max_pixels: 12_845_056 };
        let large = Resize { factor: 32, min_pixels: 65_536, max_pixels: 16_777_216 };
        for (resize, (width, height), expected) in [
            (small, (714, 490), (728, 504)),
            (small, (640, 480), (644, 476)),
            (small, (630, 518), (616, 504)),
            (small, (10, 10), (56, 56)),
            (small, (8000, 6000), (4116, 3080)),
            (large, (714, 490), (704, 480)),
            (large, (200, 120), (352, 224)),
            (large, (16_384, 2_048), (11_584, 1_440)),
        ] {
            assert_eq!(resize.size(width, height), expected);
        }
    }

    #[test]
    fn each_convention_puts_its_numbers_where_they_belong() {
        let expected = BoxPx { x0: 71.4, y0: 98.0, x1: 357.0, y1: 245.0 };
        for (name, numbers) in [
            ("rel1000_xyxy", [100.0, 200.0, 500.0, 500.0]),
            ("rel1000_yxyx", [200.0, 100.0, 500.0, 500.0]),
            ("abs_px_xyxy", [71.4, 98.0, 357.0, 245.0]),
            ("abs_px_resized28_xyxy", [72.8, 100.8, 364.0, 252.0]),
            ("abs_px_resized32_xyxy", [70.4, 96.0, 352.0, 240.0]),
            ("rel1_xyxy", [0.1, 0.2, 0.5, 0.5]),
        ] {
            let convention = Convention::named(name).unwrap();
            let place = convention.pixels(numbers, (714, 490)).unwrap();
            assert!(place.iou(&expected) > 1.0 - 1e-9, "{name}: {place:?}");
        }
    }

    #[test]
    fn corners_are_sorted_and_what_sticks_out_is_cut() {
        let convention = Convention::named("abs_px_xyxy").unwrap();
        let place = convention.pixels([50.0, 90.0, -10.0, 20.0], (100, 60)).unwrap();
        assert_eq!(place, BoxPx { x0: 0.0, y0: 20.0, x1: 50.0, y1: 60.0 });
        for nothing in [
            [5.0, 5.0, 5.0, 9.0],
            [200.0, 0.0, 300.0, 9.0],
            [f64::NAN, 0.0, 1.0, 1.0],
            [0.0, 0.0, f64::INFINITY, 1.0],
        ] {
            assert_eq!(convention.pixels(nothing, (100, 60)), None);
        }
    }

    #[test]
    fn numbers_beyond_the_range_are_told() {
        let holds = |name, numbers| Convention::named(name).unwrap().holds(numbers, (20, 10));
        assert!(holds("rel1000_xyxy", [0.0, 0.0, 1000.0, 1000.0]));
        assert!(!holds("rel1000_xyxy", [0.0, 0.0, 1000.5, 10.0]));
        assert!(holds("abs_px_xyxy", [0.0, 0.0, 20.0, 10.0]));
        assert!(!holds("abs_px_xyxy", [0.0, 0.0, 10.0, 20.0]));
        assert!(!holds("abs_px_xyxy", [-1.0, 0.0, 10.0, 5.0]));
    }

    #[test]
    fn overlap_is_intersection_over_union() {
        let square = |x: f64| BoxPx { x0: x, y0: 0.0, x1: x + 2.0, y1: 2.0 };
        assert!((square(0.0).iou(&square(1.0)) - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!(square(0.0).iou(&square(5.0)), 0.0);
    }

    #[test]
    fn a_box_has_four_numbers_in_any_of_their_forms() {
        let found =
            |value| WrittenBox::of(&value).map(|found| (found.label.unwrap_or_default(), found.numbers));
        let named = json!({"box": {"x_min": 5, "y_min": 6, "x_max": 7, "y_max": 8}, "color": "blue"});
        for (value, label, numbers) in [
            (json!({"bbox_2d": [1, 2, 3, 4], "label": "red"}), "red", [1.0, 2.0, 3.0, 4.0]),
            (named, "blue", [5.0, 6.0, 7.0, 8.0]),
            (json!({"bbox": [[9, 10], [11, 12]]}), "", [9.0, 10.0, 11.0, 12.0]),
            (json!({"x1": 1, "y1": 1, "x2": 2, "y2": 2, "name": "green"}), "green", [1.0, 1.0, 2.0, 2.0]),
        ] {
            assert_eq!(found(value), Some((label.to_owned(), numbers)));
        }
        for nothing in [json!({"bbox_2d": [1, 2, 3]}), json!({"bbox_2d": ["a", 2, 3, 4]}), json!(7)] {
            assert_eq!(found(nothing), None);
        }
    }

    proptest! {
        #[test]
        fn any_numbers_give_a_box_inside_the_picture_or_none(numbers in prop::array::uniform4(any::<f64>()), width in 1..5000_u32, height in 1..5000_u32) {
            for convention in Convention::all() {
                if let Some(place) = convention.pixels(numbers, (width, height)) {
                    prop_assert!(place.x0 >= 0.0 && place.x0 < place.x1 && place.x1 <= f64::from(width));
                    prop_assert!(place.y0 >= 0.0 && place.y0 < place.y1 && place.y1 <= f64::from(height));
                }
            }
        }

        #[test]
        fn numbers_are_the_inverse_of_pixels(x in 0.0..500.0, y in 0.0..300.0, w in 1.0..200.0, h in 1.0..200.0) {
            let place = BoxPx { x0: x, y0: y, x1: x + w, y1: y + h };
            for convention in Convention::all() {
                let back = convention.pixels(convention.numbers(place, (714, 510)), (714, 510)).unwrap();
                prop_assert!(back.iou(&place) > 1.0 - 1e-9);
            }
        }
    }
}
