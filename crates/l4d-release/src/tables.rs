//! The benchmark as tables, a JSON object a line: for viewers and loaders that open no archive.
//!
//! What a column is called, holds and means is said once, here; the metadata and the card repeat it.

use l4d_data::query::Query;
use l4d_data::scene::Role;
use l4d_data::timeline::FPS;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Profile, Split, json};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::gather::{Gathered, SceneFacts};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Text,
    Integer,
    Float,
    /// A list of texts.
    Texts,
    /// A list of `[first, last]`, both inclusive.
    Intervals,
}

/// A column of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) about: &'static str,
    /// The column of another table in which the same values stand once each.
    pub(crate) refers_to: Option<(&'static str, &'static str)>,
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
    about: &'a str,
    rows: usize,
}

const fn column(name: &'static str, kind: Kind, about: &'static str) -> Column {
    Column { name, kind, about, refers_to: None }
}

const SCENE: Column =
    Column { refers_to: Some(("scenes", "scene")), ..column("scene", Kind::Text, "Name of the scene.") };

const QUERIES: &[Column] = &[
    column("id", Kind::Text, "Scene and number of the query."),
    SCENE,
    column("scale", Kind::Text, "Spatial scale of the scene: outdoor, room or tabletop."),
    column("text", Kind::Text, "The sentence."),
    column(
        "categories",
        Kind::Texts,
        "What tells the referent from its look-alikes: attribute, action, spatial, interaction.",
    ),
    column("referents", Kind::Texts, "Names of the instances that are meant; none in absent sentences."),
    column(
        "temporal",
        Kind::Text,
        "whole: the sentence names an identity and counts in all frames; while: it counts in `frames` only.",
    ),
    column(
        "frames",
        Kind::Intervals,
        "When it holds: first and last frame of each interval, both inclusive.",
    ),
    column("predicate", Kind::Text, "The meaning for machines, as JSON; empty for captures."),
    column(
        "status",
        Kind::Text,
        "candidate: proved by machine, not yet voted on by people; verified: by people; rejected: not scored.",
    ),
    column("source", Kind::Text, "Who wrote the sentence: author, model or import."),
];

const SCENES: &[Column] = &[
    column("scene", Kind::Text, "Name of the scene."),
    column("scale", Kind::Text, "Spatial scale: outdoor, room or tabletop."),
    column("kind", Kind::Text, "rendered, or capture: recorded by others."),
    column("description", Kind::Text, "The story in a sentence or two."),
    column("objects", Kind::Integer, "Instances that queries may mean."),
    column("landmarks", Kind::Integer, "Instances that are only named in relations."),
    column("queries", Kind::Integer, "Single-category queries, rejected ones included."),
    column("composites", Kind::Integer, "Queries of two categories."),
    column("absents", Kind::Integer, "Sentences that nothing satisfies."),
    column(
        "training_views",
        Kind::Integer,
        "Cameras that methods may use, at most; 0 where nobody listed them.",
    ),
    column("held_out_view", Kind::Text, "The camera that is judged."),
    column("frames", Kind::Integer, "Frames of the clip, annotated or not."),
    column("duration_s", Kind::Float, "Length of the clip, seconds; 0 where nobody knows."),
];

const INSTANCES: &[Column] = &[
    column("id", Kind::Text, "Scene and name of the instance."),
    SCENE,
    column(
        "number",
        Kind::Integer,
        "Value of the id channel in frames: 1 to 999 objects, from 1001 landmarks.",
    ),
    column("name", Kind::Text, "Its name, as `referents` have it."),
    column("role", Kind::Text, "object: queries may mean it; landmark: it is only named in relations."),
    column("category", Kind::Text, "Common noun."),
    column("attributes", Kind::Text, "Visible properties, as JSON."),
    column("front", Kind::Text, "Axis of its box that points forward; empty where it has no front."),
];

const EVENTS: &[Column] = &[
    SCENE,
    column("subject", Kind::Text, "Who acts."),
    column("verb", Kind::Text, "What it does, base form."),
    column("object", Kind::Text, "To whom; empty for actions."),
    column("first", Kind::Integer, "First frame."),
    column("last", Kind::Integer, "Last frame, inclusive."),
];

const TRUTH: &[Column] = &[
    SCENE,
    Column {
        refers_to: Some(("instances", "id")),
        ..column("instance", Kind::Text, "Scene and name of the instance.")
    },
    column("frame", Kind::Integer, "Frame of the clip."),
    column("height", Kind::Integer, "Height of the mask, pixels."),
    column("width", Kind::Integer, "Width of the mask, pixels."),
    column("counts", Kind::Text, "The mask in the held-out view: compressed COCO run lengths, column-major."),
];

impl Table {
    /// Its path in a release.
    pub(crate) fn path(&self) -> String {
        format!("tables/{}.jsonl", self.name)
    }

    /// The file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.rows.iter().flat_map(|row| format!("{row}\n").into_bytes()).collect()
    }

    pub(crate) fn card(&self) -> Card<'_> {
        Card { name: &self.name, path: self.path(), about: &self.about, rows: self.rows.len() }
    }
}

/// All tables of a benchmark; those that would be empty are left out.
pub(crate) fn tables(gathered: &Gathered) -> Vec<Table> {
    let table = |name: &str, about: &str, columns, key, rows| Table {
        name: name.to_owned(),
        about: about.to_owned(),
        columns,
        key,
        rows,
    };
    let of_scenes =
        |rows: &dyn Fn(&SceneFacts) -> Vec<Value>| gathered.scenes.iter().flat_map(rows).collect();
    let queries = |set: &dyn Fn(&SceneFacts) -> &[Query]| -> Vec<Value> {
        of_scenes(&|scene| set(scene).iter().map(|query| query_row(scene, query)).collect())
    };
    let mut all = vec![
        table(
            "queries",
            "Sentences of one category: what is scored.",
            QUERIES,
            &["id"],
            queries(&|scene| &scene.queries),
        ),
        table(
            "composites",
            "Sentences of two categories, scored apart.",
            QUERIES,
            &["id"],
            queries(&|scene| &scene.composites),
        ),
        table(
            "absents",
            "Sentences that nothing in the scene satisfies.",
            QUERIES,
            &["id"],
            queries(&|scene| &scene.absents),
        ),
        table("scenes", "The scenes.", SCENES, &["scene"], of_scenes(&|scene| vec![scene_row(scene)])),
        table("instances", "What is annotated in the scenes.", INSTANCES, &["id"], of_scenes(&instance_rows)),
        table(
            "events",
            "What instances do, alone or to each other.",
            EVENTS,
            &["scene", "subject", "verb", "object", "first"],
            of_scenes(&event_rows),
        ),
    ];
    for &profile in &gathered.profiles {
        let rows = of_scenes(&|scene| truth_rows(scene, profile));
        let about = format!(
            "Masks in the held-out views at profile {profile}; frames without a visible pixel have no row."
        );
        all.push(table(&format!("truth_{profile}"), &about, TRUTH, &["instance", "frame"], rows));
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
    names.eq(table.columns.iter().map(|column| column.name))
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
        match (&self.tracks, self.truths.values().next()) {
            (Some(tracks), _) => tracks
                .instances
                .iter()
                .map(|instance| InstanceFacts {
                    number: instance.id,
                    name: instance.name.to_string(),
                    role: instance.role,
                    category: instance.category.clone(),
                    attributes: json!(instance.attributes),
                    front: instance.front.clone().unwrap_or_default(),
                })
                .collect(),
            (None, Some(truth)) => truth
                .instances
                .iter()
                .map(|instance| InstanceFacts {
                    number: instance.id,
                    name: instance.name.to_string(),
                    role: instance.role,
                    category: instance.category.clone(),
                    attributes: json!({}),
                    front: String::new(),
                })
                .collect(),
            (None, None) => Vec::new(),
        }
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
