//! What only the board shows of `counts.csv`, as group-bys of polars: mean IoU by frame, what was taken for the
//! referents, and confusions.
//!
//! Metrics, intervals and tests are not made here: `l4d-score` defines them on the same rows, `l4d score` and the
//! bindings use them without polars, and a second implementation could only differ. The group-bys are eager, because
//! lazy frames of this version of polars bring an HTTP client and 180 more crates.

use std::collections::BTreeMap;

use l4d_data::{Name, Role};
use l4d_score::counts::{FrameCount, State};
use l4d_score::{Missing, Options};
use polars::prelude::{Column, DataFrame, PolarsResult};

use crate::board::{Answer, BoardQuery, BoardScene, Choice, Confusion, Thing};

/// Canonical frame -> mean IoU, percent, over the queries with a true or predicted pixel there; a false alarm counts 0.
pub(crate) fn iou_of_frames(counts: &[FrameCount], options: &Options) -> PolarsResult<BTreeMap<u32, f64>> {
    let is_counted = |count: &&FrameCount| match count.state {
        State::NotAnnotated => false,
        State::Missing => options.missing != Missing::Skip && count.union > 0,
        _ => count.union > 0,
    };
    let (frames, ious): (Vec<u32>, Vec<f64>) = counts
        .iter()
        .filter(is_counted)
        .map(|count| (count.frame, 100.0 * count.intersection as f64 / count.union as f64))
        .unzip();
    let table = DataFrame::new(
        frames.len(),
        vec![Column::new("frame".into(), frames), Column::new("iou".into(), ious)],
    )?;
    #[expect(deprecated, reason = "what replaces it is lazy frames")]
    let means = table.group_by_stable(["frame"])?.select(["iou"]).mean()?;
    let pairs = means.column("frame")?.u32()?.iter().zip(means.column("iou_mean")?.f64()?.iter());
    Ok(pairs.filter_map(|(frame, mean)| Some((frame?, mean?))).collect())
}

/// A query whose target is visible, with what was taken.
pub(crate) struct Taken<'a> {
    pub(crate) scene: &'a BoardScene,
    pub(crate) query: &'a BoardQuery,
    pub(crate) answer: &'a Answer,
    pub(crate) choice: Choice,
}

impl Taken<'_> {
    /// The referent that was taken, else the first.
    fn meant(&self) -> Option<&Name> {
        let own = self.answer.taken.as_ref().filter(|name| self.query.referents.contains(name));
        own.or(self.query.referents.first())
    }

    /// The column of a confusion: an object's name, or what the choice is.
    fn instead(&self) -> &str {
        match (self.choice, &self.answer.taken) {
            (Choice::Landmark, _) => LANDMARK,
            (Choice::Tied | Choice::Nothing, _) | (_, None) => NOTHING,
            (_, Some(name)) => name,
        }
    }
}

// No names of instances: those have no spaces.
const LANDMARK: &str = "a landmark";
const NOTHING: &str = "nothing certain";

/// Queries by what was taken, and confusions by scene.
pub(crate) fn choices_and_confusions(
    taken: &[Taken],
) -> PolarsResult<(BTreeMap<Choice, usize>, Vec<Confusion>)> {
    let text = |name: &str, value: &dyn Fn(&Taken) -> String| {
        Column::new(name.into(), taken.iter().map(value).collect::<Vec<String>>())
    };
    let table = DataFrame::new(
        taken.len(),
        vec![
            text("choice", &|one| one.choice.key().to_owned()),
            text("scene", &|one| one.scene.name.to_string()),
            text("meant", &|one| one.meant().map(Name::to_string).unwrap_or_default()),
            text("taken", &|one| one.instead().to_owned()),
        ],
    )?;
    let by_choice = counted(&table, &["choice"])?;
    let choice = |key: &str| Choice::ALL.into_iter().find(|choice| choice.key() == key);
    let choices = by_choice.iter().filter_map(|(key, queries)| Some((choice(&key[0])?, *queries))).collect();
    let cells = counted(&table, &["scene", "meant", "taken"])?;
    let mut confusions: Vec<Confusion> = Vec::new();
    for scene in taken.chunk_by(|a, b| a.scene.name == b.scene.name).map(|group| group[0].scene) {
        let of_scene: Vec<_> = cells.iter().filter(|(key, _)| key[0] == scene.name.as_str()).collect();
        let is_met = |thing: &&Thing| {
            let name = thing.name.as_str();
            let is_meant = taken
                .iter()
                .any(|one| one.scene.name == scene.name && one.query.referents.contains(&thing.name));
            is_meant || of_scene.iter().any(|(key, _)| key[1] == name || key[2] == name)
        };
        let mut objects: Vec<Thing> =
            scene.things.iter().filter(|thing| thing.role == Role::Object).filter(is_met).cloned().collect();
        objects.sort();
        let place = |name: &str| objects.iter().position(|thing| thing.name.as_str() == name);
        let mut queries = vec![vec![0; objects.len() + 2]; objects.len()];
        for (key, count) in of_scene {
            let column = match key[2].as_str() {
                LANDMARK => objects.len(),
                NOTHING => objects.len() + 1,
                name => place(name).unwrap_or(objects.len()),
            };
            if let Some(row) = place(&key[1]) {
                queries[row][column] += count;
            }
        }
        confusions.push(Confusion { scene: scene.name.clone(), objects, queries });
    }
    Ok((choices, confusions))
}

/// The values of some columns that occur together, in the order of their first row, and how often they do.
fn counted(table: &DataFrame, keys: &[&str]) -> PolarsResult<Vec<(Vec<String>, usize)>> {
    let grouped = table.group_by_stable(keys.iter().copied())?.select([keys[0]]).count()?;
    let columns = keys.iter().map(|key| grouped.column(key)?.str()).collect::<PolarsResult<Vec<_>>>()?;
    let counts = grouped.column(&format!("{}_count", keys[0]))?.idx()?;
    let row = |index: usize| {
        let values = columns.iter().map(|column| column.get(index).unwrap_or_default().to_owned());
        (values.collect(), counts.get(index).unwrap_or_default() as usize)
    };
    Ok((0..grouped.height()).map(row).collect())
}
