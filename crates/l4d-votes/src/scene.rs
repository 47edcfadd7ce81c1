//! A scene as the benchmark has it now: its queries, its objects, and a digest that ties votes to both.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use l4d_data::digest::sha256_file;
use l4d_data::scene::Role;
use l4d_data::{Benchmark, DataError, Interval, Name, Profile, Query, Temporal};

use crate::key::Meaning;

/// The part of a scene that rounds ask about.
#[derive(Debug)]
pub(crate) struct SceneNow {
    /// Queries of one category and of two.
    pub(crate) queries: Vec<Query>,
    /// Sentences that nothing satisfies.
    pub(crate) absents: Vec<Query>,
    /// Name and category of each object.
    objects: Vec<(Name, String)>,
    whole: Interval,
    /// SHA-256 of the file that lists the objects.
    digest: String,
}

impl SceneNow {
    /// Rendered scenes list their objects in their tracks, captures, which have none, in their truth.
    pub(crate) fn read(bench: &Benchmark, profile: Profile, scene: &Name) -> Result<Self, DataError> {
        bench.scene(scene)?;
        let (objects, whole, path): (Vec<_>, Interval, PathBuf) = if profile.is_rendered() {
            let instances = bench.tracks(scene)?.instances.into_iter();
            let named = instances.map(|one| (one.role, one.name, one.category)).collect();
            (named, Interval::WHOLE, bench.dir.tracks(scene))
        } else {
            let truth = bench.truth(profile, scene)?;
            let whole = truth.whole();
            let named = truth.instances.into_iter().map(|one| (one.role, one.name, one.category)).collect();
            (named, whole, bench.dir.truth(profile, scene))
        };
        let objects = objects.into_iter().filter(|(role, ..)| *role == Role::Object);
        Ok(Self {
            queries: [bench.queries(scene)?, bench.composites(scene)?].concat(),
            absents: bench.absents(scene)?,
            objects: objects.map(|(_, name, category)| (name, category)).collect(),
            whole,
            digest: sha256_file(&path)?,
        })
    }

    /// What a query of this scene means.
    pub(crate) fn meaning(&self, query: &Query) -> Meaning {
        Meaning {
            referents: query.referents.iter().cloned().collect(),
            temporal: query.temporal,
            frames: query.frames.clone(),
            tracks: self.digest.clone(),
        }
    }

    /// What a bare category means: all of its objects, always.
    pub(crate) fn meaning_of_category(&self, category: &str) -> Meaning {
        let of_category = self.objects.iter().filter(|(_, of)| of == category);
        Meaning {
            referents: of_category.map(|(name, _)| name.clone()).collect::<BTreeSet<Name>>(),
            temporal: Temporal::Whole,
            frames: vec![self.whole],
            tracks: self.digest.clone(),
        }
    }

    /// Categories with more than one object.
    pub(crate) fn look_alikes(&self) -> Vec<String> {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        self.objects.iter().for_each(|(_, category)| *counts.entry(category).or_default() += 1);
        counts.into_iter().filter(|(_, count)| *count > 1).map(|(category, _)| category.to_owned()).collect()
    }
}
