//! Every draw of the noise, from a generator of its own: seed, scene, query and purpose name it, and view and frame
//! where the draw belongs to one. So views are independent given what their query drew, no view or frame depends on
//! which others are asked, and changing one kind of noise leaves the draws of the others as they were.

use l4d_data::Name;
use l4d_data::digest::sha256;
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Gamma, Open01};

use super::noise::{NoiseModel, Swap};
use super::target::Target;

/// Changes whenever the same seed would draw something else.
const VERSION: &str = "l4d/oracle/1";

/// The draws of one query.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draws<'a> {
    pub(super) seed: u64,
    pub(super) scene: &'a Name,
    pub(super) number: &'a Name,
}

/// What a view takes the sentence to mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Meant {
    /// What it does mean.
    Referents,
    /// These instances, ascending.
    LookAlikes(Vec<u32>),
    /// It would have been something else, if there were anything like it.
    NothingElse,
}

impl Draws<'_> {
    /// Whether a view says absent, whatever it shows.
    pub(super) fn is_dropped(&self, noise: &NoiseModel, view: &Name) -> bool {
        happens(&mut self.of_view("drop", view), noise.dropped_views)
    }

    /// What a view takes the sentence to mean.
    pub(super) fn meant(&self, swap: &Swap, target: &Target, view: &Name) -> Meant {
        if !self.is_swapped(swap, view) {
            return Meant::Referents;
        }
        let count = target.referents.len().min(target.look_alikes.len());
        if count == 0 {
            return Meant::NothingElse;
        }
        let mut random = self.of_query("look-alike");
        let mut alike = target.look_alikes.clone();
        let mut chosen = alike.partial_shuffle(&mut random, count).0.to_vec();
        chosen.sort_unstable();
        Meant::LookAlikes(chosen)
    }

    /// Whether a view shows something else.
    pub(super) fn is_swapped(&self, swap: &Swap, view: &Name) -> bool {
        let chance = self.chance_of_swap(swap);
        happens(&mut self.of_view("swap", view), chance)
    }

    /// The chance that the views of this query share.
    fn chance_of_swap(&self, swap: &Swap) -> f64 {
        let (mean, rho) = (swap.probability, swap.correlation);
        if rho <= 0.0 || mean <= 0.0 || mean >= 1.0 {
            return mean;
        }
        let mut random = self.of_query("swap");
        let weight = 1.0 / rho - 1.0;
        match [mean, 1.0 - mean].map(|share| ln_gamma(share * weight, &mut random)) {
            // X / (X + Y) of two Gamma variables is Beta.
            [Some(ln_x), Some(ln_y)] => 1.0 / (1.0 + (ln_y - ln_x).exp()),
            // The limit of a correlation of 1: all views or none.
            _ => f64::from(u8::from(happens(&mut random, mean))),
        }
    }

    /// Whether nothing is shown at a frame.
    pub(super) fn flickers(&self, noise: &NoiseModel, view: &Name, frame: u32) -> bool {
        happens(&mut self.of_frame("flicker", view, frame), noise.flicker)
    }

    /// Pixels by which the outline moves at a frame: below 0 inwards, above 0 outwards.
    pub(super) fn edge_px(&self, noise: &NoiseModel, view: &Name, frame: u32) -> i32 {
        let [inwards, outwards] = noise.edge_px;
        self.of_frame("edge", view, frame).random_range(inwards..=outwards)
    }

    fn of_query(&self, purpose: &str) -> ChaCha8Rng {
        self.stream(&[purpose])
    }

    fn of_view(&self, purpose: &str, view: &Name) -> ChaCha8Rng {
        self.stream(&[purpose, view])
    }

    fn of_frame(&self, purpose: &str, view: &Name, frame: u32) -> ChaCha8Rng {
        self.stream(&[purpose, view, &frame.to_string()])
    }

    fn stream(&self, words: &[&str]) -> ChaCha8Rng {
        // Names and purposes hold no line feed, so that no two lists of words read the same.
        let place =
            format!("{VERSION}\n{}\n{}\n{}\n{}", self.seed, self.scene, self.number, words.join("\n"));
        ChaCha8Rng::from_seed(sha256(place.as_bytes()))
    }
}

/// Logarithm of a draw from Gamma(shape, 1); none if the shape is too small to have one. In logarithms, because at
/// small shapes nearly all draws are smaller than any f64: G(a) = G(a + 1) U^(1 / a).
fn ln_gamma(shape: f64, random: &mut ChaCha8Rng) -> Option<f64> {
    let draw: f64 = Gamma::new(shape + 1.0, 1.0).ok()?.sample(random);
    let uniform: f64 = Open01.sample(random);
    Some(draw.ln() + uniform.ln() / shape).filter(|ln| ln.is_finite())
}

fn happens(random: &mut ChaCha8Rng, chance: f64) -> bool {
    random.random::<f64>() < chance
}
