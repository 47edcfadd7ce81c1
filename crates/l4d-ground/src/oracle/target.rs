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
    use std::collections::BTreeMap;

    use l4d_data::Status;
    use l4d_data::query::{Provenance, Temporal, text_digest};

    use super::*;

    fn instance(id: u32, name: &str, role: Role, category: &str) -> Instance {
        let (name, category) = (Name::new(name).unwrap(), category.to_owned());
        Instance { id, name, role, category, attributes: BTreeMap::new(), front: None }
    }

    fn query(referents: &[&str]) -> Query {
        Query {
            id: "yard/001".parse().unwrap(),
            text: "the cups".to_owned(),
            categories: vec![Category::Action],
            referents: referents.iter().map(|name| Name::new(*name).unwrap()).collect(),
            temporal: Temporal::While,
            frames: vec![Interval::new(10, 30).unwrap(), Interval::new(50, 70).unwrap()],
            predicate: None,
            text_digest: text_digest("the cups", None),
            provenance: Provenance { source: "author".to_owned(), note: String::new() },
            status: Status::Candidate,
        }
    }

    #[test]
    fn look_alikes_are_the_other_objects_of_the_same_categories() {
        let instances = [
            instance(4, "cup_d", Role::Object, "cup"),
            instance(1, "cup_a", Role::Object, "cup"),
            instance(2, "plate", Role::Object, "plate"),
            instance(3, "cup_c", Role::Object, "cup"),
            instance(1001, "cup_painted", Role::Landmark, "cup"),
        ];
        let target = Target::of(&instances, &query(&["cup_c", "cup_a"])).unwrap();
        assert_eq!((target.referents.as_slice(), target.look_alikes.as_slice()), (&[1, 3][..], &[4][..]));
        assert!(target.holds_at(10) && target.holds_at(70) && !target.holds_at(40) && !target.holds_at(9));
        let absent = Target::of(&instances, &query(&[])).unwrap();
        assert!(absent.referents.is_empty() && absent.look_alikes.is_empty());
    }

    #[test]
    fn referents_that_no_object_has_are_named() {
        let instances = [instance(1001, "table", Role::Landmark, "table")];
        let error = Target::of(&instances, &query(&["table"])).unwrap_err().to_string();
        assert!(error.contains("yard/001") && error.contains("`table`"), "{error}");
    }
}
