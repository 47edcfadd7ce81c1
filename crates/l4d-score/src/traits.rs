//! What is asked, as a picture shows it: how large the target of a query is in the held-out view, how much of it comes
//! and goes, and how the sentence binds time. Derived from the query and the pixel counts of the truth file: no mask is
//! decoded, and nothing a method does plays a part.

use l4d_data::truth::Truth;
use l4d_data::{Query, Temporal};

/// Targets of a smaller share of the picture are small.
const SMALL: f64 = 0.01;
/// Targets of at least this share of the picture are large.
const LARGE: f64 = 0.03;
/// Below this share of its largest area a target counts as partly hidden.
const HALF: f64 = 0.5;

/// Visible area of the target as a share of the picture, mean over the frames in which it is asked for and visible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, strum::Display)]
#[strum(serialize_all = "lowercase")]
pub enum Size {
    /// Below [`SMALL`].
    Small,
    Medium,
    /// At least [`LARGE`].
    Large,
}

/// How much of the target comes and goes while it is asked for. A truth has no hidden pixels, so that a target that moves
/// away, or out of the picture, looks like one that is hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, strum::Display)]
#[strum(serialize_all = "lowercase")]
pub enum Occlusion {
    /// Always at least [`HALF`] of its largest area.
    Never,
    /// Below that in some frame.
    Partly,
    /// Gone in some frame.
    Fully,
}

/// The traits of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Traits {
    /// How the sentence binds time.
    pub temporal: Temporal,
    /// None if the target is visible in no frame in which it is asked for.
    pub size: Option<Size>,
    pub occlusion: Option<Occlusion>,
}

impl Traits {
    /// Of a query in the held-out view.
    pub fn of(query: &Query, truth: &Truth) -> Self {
        let nowhere = Self { temporal: query.temporal, size: None, occlusion: None };
        let Some(view) = truth.visible.get(&truth.test_view) else { return nowhere };
        let mut pixels = vec![0_u64; truth.frames.len()];
        for counts in query.referents.iter().filter_map(|referent| view.get(referent)) {
            pixels.iter_mut().zip(counts).for_each(|(sum, &count)| *sum += u64::from(count));
        }
        let is_asked = |frame: u32| query.asks_at(frame);
        let asked: Vec<u64> = truth
            .frames
            .iter()
            .zip(&pixels)
            .filter(|(frame, _)| is_asked(**frame))
            .map(|(_, &count)| count)
            .collect();
        let shown = asked.iter().filter(|count| **count > 0).count();
        if shown == 0 {
            return nowhere;
        }
        let picture = f64::from(truth.width) * f64::from(truth.height);
        let share = asked.iter().sum::<u64>() as f64 / (shown as f64 * picture);
        let size = match share {
            share if share < SMALL => Size::Small,
            share if share < LARGE => Size::Medium,
            _ => Size::Large,
        };
        let (most, least) = (pixels.iter().max().copied(), asked.iter().min().copied());
        let (most, least) = (most.unwrap_or_default(), least.unwrap_or_default());
        let occlusion = match least {
            0 => Occlusion::Fully,
            least if (least as f64) < HALF * most as f64 => Occlusion::Partly,
            _ => Occlusion::Never,
        };
        Self { size: Some(size), occlusion: Some(occlusion), ..nowhere }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use l4d_data::{Name, Profile, Scale};

    use super::*;

    fn traits(temporal: &str, frames: &str, referents: &str, visible: &[(&str, &[u32])]) -> Traits {
        let line = format!(
            r#"{{"id":"room/001","text":"A","categories":["action"],"referents":{referents},"temporal":"{temporal}",
                "frames":{frames},"predicate":null,"text_digest":"","provenance":{{"source":"author"}},
                "status":"candidate"}}"#
        );
        let query: Query = serde_json::from_str(&line).unwrap();
        let name = |name: &str| Name::new(name).unwrap();
        let truth = Truth {
            schema: l4d_data::truth::SCHEMA.to_owned(),
            scene: name("room"),
            scale: Scale::Room,
            variant: 0,
            profile: Profile::Real,
            width: 100,
            height: 10,
            test_view: name("test"),
            frames: vec![0, 10, 20, 30],
            unannotated: Vec::new(),
            instances: Vec::new(),
            visible: BTreeMap::from([
                (name("test"), visible.iter().map(|(of, counts)| (name(of), counts.to_vec())).collect()),
                (name("train"), BTreeMap::from([(name("a"), vec![1000; 4])])),
            ]),
        };
        Traits::of(&query, &truth)
    }

    #[test]
    fn size_and_occlusion_of_hand_made_targets() {
        use Occlusion::{Fully, Never, Partly};
        use Size::{Large, Medium, Small};
        let whole: [(&[u32], Option<Size>, Option<Occlusion>); 7] = [
            (&[9, 9, 10, 11], Some(Small), Some(Never)),
            (&[10, 10, 10, 10], Some(Medium), Some(Never)),
            (&[30, 0, 0, 0], Some(Large), Some(Fully)),
            (&[0, 0, 0, 0], None, None),
            (&[20, 10, 15, 20], Some(Medium), Some(Never)),
            (&[20, 9, 15, 20], Some(Medium), Some(Partly)),
            (&[20, 0, 15, 20], Some(Medium), Some(Fully)),
        ];
        for (counts, size, occlusion) in whole {
            let found = traits("whole", "[[0,30]]", r#"["a"]"#, &[("a", counts)]);
            assert_eq!((found.size, found.occlusion), (size, occlusion), "{counts:?}");
        }
        // While the sentence holds, against the largest area of the whole clip.
        let gated: [(&[u32], Option<Size>, Option<Occlusion>); 3] = [
            (&[99, 5, 7, 99], Some(Small), Some(Partly)),
            (&[0, 9, 9, 0], Some(Small), Some(Never)),
            (&[0, 9, 9, 20], Some(Small), Some(Partly)),
        ];
        for (counts, size, occlusion) in gated {
            let found = traits("while", "[[10,20]]", r#"["a"]"#, &[("a", counts)]);
            assert_eq!((found.size, found.occlusion, found.temporal), (size, occlusion, Temporal::While));
        }
        // Several referents are added up; unknown ones are not there.
        let visible: [(&str, &[u32]); 2] = [("a", &[20, 0, 20, 20]), ("b", &[0, 15, 0, 0])];
        let found = traits("whole", "[[0,30]]", r#"["a","b","c"]"#, &visible);
        assert_eq!((found.size, found.occlusion), (Some(Medium), Some(Never)));
    }
}
