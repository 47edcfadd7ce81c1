//! What a query means, as ids: the referents, what could be taken for them, and when they count.

use l4d_data::scene::{Instance, Role};
use l4d_data::{Category, Interval, Name, Query, QueryId};
use serde::{Deserialize, Serialize};

/// A referent that the scene does not have.
#[derive(Debug, thiserror::Error)]
#[error("query {query} refers to `{name}`, which is no object of its scene: run `l4d check-queries`")]
pub struct UnknownReferent {
    query: QueryId,
    name: Name,
}

/// The truth about one query.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Ids of the instances meant, ascending; none for absent sentences.
    pub referents: Vec<u32>,
    /// Ids of the other objects of the referents' categories, ascending.
    pub look_alikes: Vec<u32>,
    /// What kind of reasoning tells them apart.
    pub categories: Vec<Category>,
    /// When the referents count, canonical frames.
    pub frames: Vec<Interval>,
}

impl Target {
    /// Looks a query up among the instances of its scene.
    ///
    /// # Errors
    /// A referent is no object of the scene.
    pub fn of(instances: &[Instance], query: &Query) -> Result<Self, UnknownReferent> {
        let objects = || instances.iter().filter(|instance| instance.role == Role::Object);
        let meant: Vec<&Instance> = query
            .referents
            .iter()
            .map(|name| {
                let found = objects().find(|instance| instance.name == *name);
                found.ok_or_else(|| UnknownReferent { query: query.id.clone(), name: name.clone() })
            })
            .collect::<Result<_, _>>()?;
        let is_meant = |id: u32| meant.iter().any(|instance| instance.id == id);
        let is_alike = |instance: &&Instance| {
            !is_meant(instance.id) && meant.iter().any(|other| other.category == instance.category)
        };
        let ascending = |mut ids: Vec<u32>| {
            ids.sort_unstable();
            ids
        };
        Ok(Self {
            referents: ascending(meant.iter().map(|instance| instance.id).collect()),
            look_alikes: ascending(objects().filter(is_alike).map(|instance| instance.id).collect()),
            categories: query.categories.clone(),
            frames: query.frames.clone(),
        })
    }

    /// Whether the referents count at a canonical frame.
    pub fn holds_at(&self, frame: u32) -> bool {
        self.frames.iter().any(|interval| interval.contains(frame))
    }
}

#[cfg(test)]
mod tests {
    use l4d_testing::{instance, query};

    use super::*;

    #[test]
    fn look_alikes_are_the_other_objects_of_the_same_categories() {
        let instances = [
            instance(4, "cup_d"),
            instance(1, "cup_a"),
            instance(2, "plate"),
            instance(3, "cup_c"),
            instance(1001, "cup_painted"),
        ];
        let of =
            |referents: &[&str]| Target::of(&instances, &query("yard/001", "the cups", referents, [10, 30]));
        let target = of(&["cup_c", "cup_a"]).unwrap();
        assert_eq!((target.referents.as_slice(), target.look_alikes.as_slice()), (&[1, 3][..], &[4][..]));
        assert!(target.holds_at(10) && target.holds_at(30) && !target.holds_at(31) && !target.holds_at(9));
        let absent = of(&[]).unwrap();
        assert!(absent.referents.is_empty() && absent.look_alikes.is_empty());
        let error = of(&["cup_painted"]).unwrap_err().to_string();
        assert!(error.contains("yard/001") && error.contains("`cup_painted`"), "{error}");
    }
}
