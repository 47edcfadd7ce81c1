//! The benchmark as tables, for viewers and loaders that open no archive: each as lines of JSON and, in `columnar`, as
//! Parquet.
//!
//! What a column is called, holds and means is in `templates/columns.json`; the metadata and the card repeat it.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use l4d_data::query::Query;
use l4d_data::scene::Role;
use l4d_data::timeline::FPS;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Name, Profile, Split, json};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::gather::{Gathered, SceneFacts};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ColumnKind {
    Text,
    Integer,
    Float,
    /// A list of texts.
    Texts,
    /// A list of `[first, last]`, both inclusive.
    Intervals,
}

/// A column of a table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) kind: ColumnKind,
    pub(crate) about: String,
    /// Table and column in which the same values are once each.
    #[serde(default)]
    pub(crate) refers_to: Option<(String, String)>,
}

/// A table, ready to be written.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    pub(crate) name: String,
    pub(crate) about: String,
    pub(crate) columns: &'static [Column],
    /// Columns that together tell each row from all others.
    pub(crate) key: &'static [&'static str],
    pub(crate) rows: Vec<Value>,
}

/// What the card says of a table.
#[derive(Debug, Serialize)]
pub(crate) struct Card<'a> {
    name: &'a str,
    path: String,
    parquet: String,
    about: &'a str,
    rows: usize,
}

static COLUMNS: LazyLock<BTreeMap<String, Vec<Column>>> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../templates/columns.json"))
        .expect("the embedded list of columns is valid")
});

impl Table {
    /// Its path in a release, a JSON object a line.
    pub(crate) fn path(&self) -> String {
        format!("tables/{}.jsonl", self.name)
    }

    /// Its path in a release, as Parquet.
    pub(crate) fn parquet_path(&self) -> String {
        format!("tables/{}.parquet", self.name)
    }

    /// A JSON object a line.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.rows.iter().flat_map(|row| format!("{row}\n").into_bytes()).collect()
    }

    pub(crate) fn card(&self) -> Card<'_> {
        Card {
            name: &self.name,
            path: self.path(),
            parquet: self.parquet_path(),
            about: &self.about,
            rows: self.rows.len(),
        }
    }
}

/// All tables of a benchmark; those that would be empty are left out.
pub(crate) fn tables(gathered: &Gathered) -> Vec<Table> {
    let table = |name: &str, columns: &str, key, about: &str, rows| Table {
        name: name.to_owned(),
        about: about.to_owned(),
        columns: &COLUMNS[columns],
        key,
        rows,
    };
    let of_scenes =
        |rows: &dyn Fn(&SceneFacts) -> Vec<Value>| gathered.scenes.iter().flat_map(rows).collect();
    let queries = |set: &dyn Fn(&SceneFacts) -> &[Query]| -> Vec<Value> {
        of_scenes(&|scene| set(scene).iter().map(|query| query_row(scene, query)).collect())
    };
    let (one, two, none) = (
        queries(&|scene| &scene.queries),
        queries(&|scene| &scene.composites),
        queries(&|scene| &scene.absents),
    );
    let scenes = of_scenes(&|scene| vec![scene_row(scene)]);
    let instances = of_scenes(&instance_rows);
    let events = of_scenes(&event_rows);
    let of_event: &[&str] = &["scene", "subject", "verb", "object", "first"];
    let mut all = vec![
        table("queries", "queries", &["id"], "Sentences of one category: what is scored.", one),
        table("composites", "queries", &["id"], "Sentences of two categories, scored apart.", two),
        table("absents", "queries", &["id"], "Sentences that nothing in the scene satisfies.", none),
        table("scenes", "scenes", &["scene"], "The scenes.", scenes),
        table("instances", "instances", &["id"], "What is annotated in the scenes.", instances),
        table("events", "events", of_event, "What instances do, alone or to each other.", events),
    ];
    for &profile in &gathered.profiles {
        let rows = of_scenes(&|scene| truth_rows(scene, profile));
        let about = format!(
            "Masks in the held-out views at profile {profile}; frames without a visible pixel have no row."
        );
        all.push(table(&format!("truth_{profile}"), "truth", &["instance", "frame"], &about, rows));
    }
    all.retain(|table| !table.rows.is_empty());
    for table in &all {
        debug_assert!(
            table.rows.iter().all(|row| fits(table, row)),
            "a row of {} has other columns",
            table.name
        );
    }
    all
}

fn fits(table: &Table, row: &Value) -> bool {
    let names = row.as_object().into_iter().flat_map(Map::keys).map(String::as_str);
    names.eq(table.columns.iter().map(|column| column.name.as_str()))
}

fn query_row(scene: &SceneFacts, query: &Query) -> Value {
    json!({
        "id": query.id,
        "scene": scene.name,
        "scale": scene.scale,
        "text": query.text,
        "categories": query.categories,
        "referents": query.referents,
        "temporal": query.temporal,
        "frames": query.frames,
        // As text: the language nests, which columns cannot.
        "predicate": query.predicate.as_ref().map(json::canonical).unwrap_or_default(),
        "status": query.status,
        "source": query.provenance.source,
    })
}

fn scene_row(scene: &SceneFacts) -> Value {
    let count = |role| scene.instances().iter().filter(|instance| instance.role == role).count();
    let (views, held_out) = match &scene.tracks {
        Some(tracks) => {
            let of = |split| tracks.cameras.iter().filter(move |camera| camera.split == split);
            (of(Split::Train).count(), of(Split::Test).next().map(|camera| camera.name.to_string()))
        }
        None => (0, scene.truths.values().next().map(|truth| truth.test_view.to_string())),
    };
    let frames = match &scene.tracks {
        Some(tracks) => tracks.frame_count as usize,
        None => scene.truths.values().next().map_or(0, |truth| truth.clip().len()),
    };
    json!({
        "scene": scene.name,
        "scale": scene.scale,
        "kind": if scene.tracks.is_some() { "rendered" } else { "capture" },
        "description": scene.tracks.as_ref().map(|tracks| tracks.description.as_str()).unwrap_or_default(),
        "objects": count(Role::Object),
        "landmarks": count(Role::Landmark),
        "queries": scene.queries.len(),
        "composites": scene.composites.len(),
        "absents": scene.absents.len(),
        "training_views": views,
        "held_out_view": held_out.unwrap_or_default(),
        "frames": frames,
        "duration_s": if scene.tracks.is_some() { (frames.saturating_sub(1)) as f64 / FPS } else { 0.0 },
    })
}

/// What the tracks say of an instance, or the truth where there are none.
pub(crate) struct InstanceFacts {
    pub(crate) number: u32,
    pub(crate) name: String,
    pub(crate) role: Role,
    pub(crate) category: String,
    attributes: Value,
    front: String,
}

impl SceneFacts {
    pub(crate) fn instances(&self) -> Vec<InstanceFacts> {
        let facts = |number, name: &Name, role, category: &str| InstanceFacts {
            number,
            name: name.to_string(),
            role,
            category: category.to_owned(),
            attributes: json!({}),
            front: String::new(),
        };
        let of_truth = |truth: &Truth| {
            truth.instances.iter().map(|one| facts(one.id, &one.name, one.role, &one.category)).collect()
        };
        let Some(tracks) = &self.tracks else {
            return self.truths.values().next().map(of_truth).unwrap_or_default();
        };
        let of_tracks = tracks.instances.iter().map(|one| InstanceFacts {
            attributes: json!(one.attributes),
            front: one.front.clone().unwrap_or_default(),
            ..facts(one.id, &one.name, one.role, &one.category)
        });
        of_tracks.collect()
    }
}

fn instance_rows(scene: &SceneFacts) -> Vec<Value> {
    let row = |instance: InstanceFacts| {
        json!({
            "id": format!("{}/{}", scene.name, instance.name),
            "scene": scene.name,
            "number": instance.number,
            "name": instance.name,
            "role": instance.role,
            "category": instance.category,
            "attributes": json::canonical(&instance.attributes),
            "front": instance.front,
        })
    };
    scene.instances().into_iter().map(row).collect()
}

fn event_rows(scene: &SceneFacts) -> Vec<Value> {
    let Some(tracks) = &scene.tracks else { return Vec::new() };
    let row = |event: &l4d_data::Event| {
        json!({
            "scene": scene.name,
            "subject": event.subject,
            "verb": event.verb,
            "object": event.object.as_ref().map(|name| name.to_string()).unwrap_or_default(),
            "first": event.frames.first(),
            "last": event.frames.last(),
        })
    };
    tracks.events.iter().map(row).collect()
}

fn truth_rows(scene: &SceneFacts, profile: Profile) -> Vec<Value> {
    let Some(truth) = scene.truths.get(&profile) else { return Vec::new() };
    let Truth { width, height, .. } = truth;
    let mut rows = Vec::new();
    for instance in &truth.instances {
        for &frame in &truth.frames {
            if let Some(counts) = instance.masks.get(&frame_key(frame)) {
                rows.push(json!({
                    "scene": scene.name,
                    "instance": format!("{}/{}", scene.name, instance.name),
                    "frame": frame,
                    "height": height,
                    "width": width,
                    "counts": counts,
                }));
            }
        }
    }
    rows
}
