//! Who is in a scene, as far as rounds need to know: its objects, its clip, and a digest that ties votes to both.
//!
//! Rendered scenes say it in their tracks, real ones in their truth: they have no tracks.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use l4d_data::digest::sha256_file;
use l4d_data::scene::Role;
use l4d_data::{Benchmark, DataError, Interval, Name, Profile};

/// The objects of a scene.
#[derive(Debug)]
pub(crate) struct Cast {
    /// Name and category.
    objects: Vec<(Name, String)>,
    /// The clip.
    pub(crate) whole: Interval,
    /// SHA-256 of the file that says so.
    pub(crate) digest: String,
}

impl Cast {
    pub(crate) fn read(bench: &Benchmark, profile: Profile, scene: &Name) -> Result<Self, DataError> {
        let is_object = |role: Role| role == Role::Object;
        let (objects, whole, path): (Vec<(Name, String)>, Interval, PathBuf) = if profile.is_rendered() {
            let tracks = bench.tracks(scene)?;
            let objects = tracks.instances.into_iter().filter(|one| is_object(one.role));
            (objects.map(|one| (one.name, one.category)).collect(), Interval::WHOLE, bench.dir.tracks(scene))
        } else {
            let truth = bench.truth(profile, scene)?;
            let whole = truth.whole();
            let objects = truth.instances.into_iter().filter(|one| is_object(one.role));
            (objects.map(|one| (one.name, one.category)).collect(), whole, bench.dir.truth(profile, scene))
        };
        Ok(Self { objects, whole, digest: sha256_file(&path)? })
    }

    /// All objects of a category.
    pub(crate) fn of_category(&self, category: &str) -> BTreeSet<Name> {
        self.objects.iter().filter(|(_, of)| of == category).map(|(name, _)| name.clone()).collect()
    }

    /// Categories with more than one object.
    pub(crate) fn look_alikes(&self) -> Vec<String> {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        self.objects.iter().for_each(|(_, category)| *counts.entry(category).or_default() += 1);
        counts.into_iter().filter(|(_, count)| *count > 1).map(|(category, _)| category.to_owned()).collect()
    }
}
