//! `recipes/<scene>.json`: what a composed scene is made from. It takes the place of a recipe in Python.

use serde::{Deserialize, Serialize};

use crate::benchmark::Draw;
use crate::json::Document;
use crate::name::Name;
use crate::scene::Scale;

/// Schema tag of a composition.
pub const SCHEMA: &str = "l4d/composition/1";
/// The largest seed: readers of JSON round larger numbers.
pub const MOST_SEED: u64 = 1 << 53;

/// A seed, and what is pinned instead of drawn from it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Composition {
    /// [`SCHEMA`].
    pub schema: String,
    /// What the scene is called.
    pub scene: Name,
    /// Outdoor, room or tabletop.
    pub scale: Scale,
    /// Of everything random.
    pub seed: u64,
    /// How many draws of the seed were thrown away before it.
    pub draw: u32,
    /// Where it happens; drawn where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// What kind of things happen; drawn where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub theme: Option<String>,
    /// Nouns that have to be there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub categories: Vec<String>,
    /// Verbs that have to happen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub verbs: Vec<String>,
}

impl Composition {
    pub fn of(scene: Name, scale: Scale, seed: u64) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            scene,
            scale,
            seed,
            draw: 0,
            place: None,
            theme: None,
            categories: Vec::new(),
            verbs: Vec::new(),
        }
    }

    /// The draw that its frames and tracks name.
    pub fn draw(&self) -> Draw {
        Draw { variant: 0, seed: self.seed }
    }
}

impl Document for Composition {
    const SCHEMA: &'static str = SCHEMA;
    const HINT: &'static str = "write it with `l4d compose`";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn problem(&self) -> Option<(String, String)> {
        (self.seed > MOST_SEED)
            .then(|| ("field `seed`".to_owned(), format!("is {}, but at most {MOST_SEED}", self.seed)))
    }
}
