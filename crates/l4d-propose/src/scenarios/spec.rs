//! A scenario: its form as a model gives it, and as a file.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::query::Provenance;
use l4d_data::{Category, DataError, Interval, Scale, Temporal, json};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Value, json};

use crate::answer::Reason;
use crate::quote::excerpt;

/// Schema tag of a scenario file.
pub(super) const SCHEMA: &str = "l4d/scenario/1";

/// A scenario as a model proposes it; what it leaves out or adds is no matter of form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Draft {
    /// `<scale>_<what>`.
    pub(super) name: String,
    pub(super) scale: Scale,
    pub(super) environment: Environment,
    /// What happens, in a sentence or two.
    pub(super) story: String,
    /// What queries may refer to, by category.
    pub(super) groups: Vec<Group>,
    /// What relations may name.
    #[serde(default)]
    pub(super) landmarks: Vec<Landmark>,
    /// What happens, in canonical frames.
    pub(super) events: Vec<DraftEvent>,
    /// What could be asked.
    pub(super) queries: Vec<Sketch>,
}

/// The place that a scene is in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Environment {
    pub(super) place: String,
    /// Where the light comes from.
    pub(super) light: String,
    /// What things rest on.
    pub(super) ground: String,
}

/// Objects of one category.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Group {
    pub(super) category: String,
    pub(super) members: Vec<Member>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Member {
    /// Category and role.
    pub(super) name: String,
    /// What it looks like: feature -> value.
    #[serde(deserialize_with = "features")]
    pub(super) features: BTreeMap<String, String>,
}

/// A thing that relations may name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Landmark {
    pub(super) name: String,
    pub(super) category: String,
}

/// Something that happens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct DraftEvent {
    pub(super) subject: String,
    pub(super) verb: String,
    /// To whom; null for actions.
    #[serde(default, deserialize_with = "something")]
    pub(super) object: Option<String>,
    pub(super) frames: Interval,
    /// How often it repeats in a second; 0 for what happens once.
    #[serde(default)]
    pub(super) loop_hz: f64,
}

/// A query in outline.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Sketch {
    /// What tells the referent from its look-alikes.
    pub(super) category: Category,
    pub(super) text: String,
    /// The object meant.
    pub(super) referent: String,
    /// How the sentence binds time.
    pub(super) temporal: Temporal,
}

/// A scenario file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Scenario {
    pub(super) schema: &'static str,
    #[serde(flatten)]
    pub(super) draft: Draft,
    pub(super) provenance: Provenance,
}

impl Draft {
    /// Reads one item of an answer; the error is the first field of another form.
    pub(super) fn read(item: &Value) -> Result<Self, Reason> {
        let bytes = item.to_string().into_bytes();
        json::parse(Path::new("answer"), None, &bytes).map_err(|error| {
            let (field, message) = match error {
                DataError::Format { location, message, .. } => (location, message),
                other => (String::new(), other.to_string()),
            };
            let field = field.trim_start_matches("field ").trim_matches('`');
            let hint = "see docs/proposing.md for the form of a scenario";
            Reason::new("L4D571", field, excerpt(&message), hint)
        })
    }

    /// Every object with its category.
    pub(super) fn objects(&self) -> impl Iterator<Item = (&Group, &Member)> {
        self.groups.iter().flat_map(|group| group.members.iter().map(move |member| (group, member)))
    }
}

impl DraftEvent {
    /// The event in a message.
    pub(super) fn place(&self) -> String {
        let Self { subject, verb, object, .. } = self;
        let object = object.as_ref().map_or_else(String::new, |object| format!(" {object}"));
        excerpt(&format!("event {subject} {verb}{object}"))
    }
}

/// Features as a map, or as a list of keys with values, which a strict schema prefers.
fn features<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<String, String>, D::Error> {
    #[derive(Deserialize)]
    struct Pair {
        key: String,
        value: String,
    }
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Form {
        Map(BTreeMap<String, String>),
        List(Vec<Pair>),
    }
    Ok(match Form::deserialize(deserializer)? {
        Form::Map(map) => map,
        Form::List(pairs) => pairs.into_iter().map(|Pair { key, value }| (key, value)).collect(),
    })
}

/// Null, nothing and an empty string are the same.
fn something<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    Ok(Option::<String>::deserialize(deserializer)?.filter(|text| !text.trim().is_empty()))
}

/// The shape that an answer should have.
pub(super) fn schema() -> Value {
    let text = json!({ "type": "string" });
    let object = |properties: Value| {
        let required: Vec<&String> =
            properties.as_object().into_iter().flatten().map(|(key, _)| key).collect();
        json!({ "type": "object", "additionalProperties": false, "required": required, "properties": properties })
    };
    let list = |items: Value| json!({ "type": "array", "items": items });
    let choice = |names: &[&str]| json!({ "type": "string", "enum": names });
    let member =
        object(json!({ "name": text, "features": list(object(json!({ "key": text, "value": text }))) }));
    object(json!({ "scenarios": list(object(json!({
        "name": text,
        "scale": choice(&Scale::ALL.map(Scale::as_str)),
        "environment": object(json!({ "place": text, "light": text, "ground": text })),
        "story": text,
        "groups": list(object(json!({ "category": text, "members": list(member) }))),
        "landmarks": list(object(json!({ "name": text, "category": text }))),
        "events": list(object(json!({
            "subject": text, "verb": text, "object": text, "frames": list(json!({ "type": "integer" })),
            "loop_hz": { "type": "number" },
        }))),
        "queries": list(object(json!({
            "category": choice(&Category::ALL.map(Category::as_str)), "text": text, "referent": text,
            "temporal": choice(&["whole", "while"]),
        }))),
    }))) }))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The example of the instructions: a spec in which nothing is wrong.
    pub(crate) fn bakery() -> Value {
        let instructions = include_str!("../../briefs/scenarios.md");
        let example = instructions.lines().last().unwrap();
        serde_json::from_str::<Value>(example).unwrap()["scenarios"][0].clone()
    }

    #[test]
    fn both_forms_of_features_and_of_nobody_are_read_and_a_file_is_read_again() {
        let draft = Draft::read(&bakery()).unwrap();
        assert_eq!(draft.groups[0].members[0].features["crust"], "dark");
        assert_eq!(draft.events[0].object.as_deref(), Some("loaf_carried"));
        assert_eq!(draft.events[2].object, None);
        let mut other = bakery();
        other["groups"][0]["members"][0]["features"] = json!({ "crust": "dark", "shape": "round" });
        other["events"][2]["object"] = Value::Null;
        other["events"][2].as_object_mut().unwrap().remove("loop_hz");
        other["remark"] = json!("I like bread");
        assert_eq!(Draft::read(&other).unwrap(), draft);
        let provenance = Provenance { source: l4d_data::query::Source::Model, note: "tiny".to_owned() };
        let file = Scenario { schema: SCHEMA, draft: draft.clone(), provenance };
        assert_eq!(Draft::read(&serde_json::to_value(file).unwrap()).unwrap(), draft);
    }

    #[test]
    fn what_has_another_form_is_named_by_its_field() {
        for (pointer, value, field) in [
            ("/scale", json!("galaxy"), "scale"),
            ("/events/0/frames", json!([30, 8]), "events[0].frames"),
            ("/events/0/frames", json!([8]), "events[0].frames"),
            ("/events/1/loop_hz", json!("fast"), "events[1].loop_hz"),
            ("/queries/0/category", json!("colour"), "queries[0].category"),
            ("/groups/0/members", json!("three loaves"), "groups[0].members"),
        ] {
            let mut item = bakery();
            *item.pointer_mut(pointer).unwrap() = value;
            let reason = Draft::read(&item).unwrap_err();
            assert_eq!((reason.code, reason.field.as_str()), ("L4D571", field), "{}", reason.message);
        }
        assert_eq!(Draft::read(&json!([1])).unwrap_err().code, "L4D571");
    }

    #[test]
    fn the_schema_is_strict_everywhere() {
        fn check(schema: &Value) {
            if schema["type"] == "object" {
                assert_eq!(schema["additionalProperties"], false);
                let properties = schema["properties"].as_object().unwrap();
                assert_eq!(schema["required"].as_array().unwrap().len(), properties.len());
                properties.values().for_each(check);
            }
            if schema["type"] == "array" {
                check(&schema["items"]);
            }
        }
        check(&schema());
    }
}
