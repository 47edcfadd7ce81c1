//! The question about a view: labelled pictures in the order of time, then the words, in one message.
//!
//! That is the common denominator of the servers, and how models of the Qwen family were trained to see videos.

use l4d_data::digest::sha256_hex;
use l4d_endpoint::coordinates::Scale;
use l4d_endpoint::{Convention, Image, Message, Part, Request, Schema};
use serde_json::{Map, Value, json};

use super::Settings;
use crate::clip::{ClipFrame, ViewClip};
use crate::plan::Clock;
use crate::question::CheckedQuestion;

/// Largest factor by which small clips are enlarged: nothing is gained beyond.
const LARGEST_FACTOR: u32 = 16;

/// A prompt, as a file beside this code. Its version is part of its name: a changed text is another file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Template {
    pub(super) name: &'static str,
    text: &'static str,
}

impl Template {
    pub(super) const TEXT: Self = Self { name: "text_v1", text: include_str!("prompts/text_v1.md") };
    pub(super) const BOX: Self = Self { name: "box_v1", text: include_str!("prompts/box_v1.md") };
    pub(super) const NOUN: Self = Self { name: "noun_v1", text: include_str!("prompts/noun_v1.md") };
    pub(super) const PICK: Self = Self { name: "pick_v1", text: include_str!("prompts/pick_v1.md") };

    /// What answers depend on.
    pub(super) fn identity(self) -> Value {
        json!({ "name": self.name, "sha256": sha256_hex(self.text.as_bytes()) })
    }

    /// The prompt with its places filled, in one pass: what is filled in is never searched for places.
    pub(super) fn fill(self, filling: &Filling<'_>) -> String {
        let mut filled = String::new();
        let mut rest = self.text.trim_end();
        while let Some((before, after)) = rest.split_once('{') {
            filled.push_str(before);
            let word = after.split_once('}').and_then(|(name, after)| Some((filling.word(name)?, after)));
            match word {
                Some((word, after)) => {
                    filled.push_str(&word);
                    rest = after;
                }
                None => {
                    filled.push('{');
                    rest = after;
                }
            }
        }
        filled + rest
    }
}

/// What fills the places of a prompt.
pub(super) struct Filling<'a> {
    pub(super) query: &'a str,
    pub(super) count: usize,
    pub(super) seconds: f64,
    pub(super) key: &'a str,
    pub(super) gate: bool,
    pub(super) candidates: usize,
    pub(super) example: Value,
}

impl<'a> Filling<'a> {
    pub(super) fn of(asked: &CheckedQuestion<'a>, sent: &SentFrames<'_>, settings: &Settings) -> Self {
        Self {
            query: asked.sentence,
            count: sent.clock.sent().len(),
            seconds: f64::from(asked.range.frame_count()) / sent.clip.timeline.frames_per_second(),
            key: "",
            gate: settings.gate,
            candidates: 0,
            example: Value::Null,
        }
    }

    fn word(&self, name: &str) -> Option<String> {
        let interval_rule = "\n- \"intervals\": when the query holds, as a list of {\"start\": ..., \"end\": ...} in numbers of labels, both inclusive. The whole clip if it speaks of nothing that begins or ends.";
        Some(match name {
            // As JSON, so that no sentence can end its quotes.
            "query" => Value::from(self.query).to_string(),
            "count" => self.count.to_string(),
            "seconds" => format!("{:.1}", self.seconds),
            "key" => self.key.to_owned(),
            "candidates" => self.candidates.to_string(),
            "interval_rule" if self.gate => interval_rule.to_owned(),
            "interval_rule" => String::new(),
            "example" => self.example.to_string(),
            _ => return None,
        })
    }
}

/// Which frames of a clip are sent, and how large.
#[derive(Debug)]
pub(super) struct SentFrames<'a> {
    pub(super) clip: &'a ViewClip,
    pub(super) clock: Clock,
    /// By which pictures are enlarged.
    pub(super) factor: u32,
}

impl<'a> SentFrames<'a> {
    /// Frames spread over what is asked about, its first and last among them.
    pub(super) fn choose(clip: &'a ViewClip, asked: &CheckedQuestion<'_>, settings: &Settings) -> Self {
        let (available, wanted) = (asked.frames.len(), settings.keyframes.min(asked.frames.len()));
        let moment = |index: usize| match wanted {
            1 => available / 2,
            _ => (index * (available - 1) + (wanted - 1) / 2) / (wanted - 1),
        };
        let frames = (0..wanted).filter_map(|index| asked.frames.get(moment(index)).copied()).collect();
        let pixels = f64::from(clip.width) * f64::from(clip.height);
        let factor = (f64::from(settings.picture_pixels) / pixels).sqrt().round() as u32;
        Self { clip, clock: Clock::new(frames, asked.range), factor: factor.clamp(1, LARGEST_FACTOR) }
    }

    /// Width and height of the pictures that are sent, pixels.
    pub(super) fn size(&self) -> (u32, u32) {
        (self.clip.width * self.factor, self.clip.height * self.factor)
    }

    pub(super) fn frames(&self) -> impl Iterator<Item = &ClipFrame> {
        self.clock.sent().iter().filter_map(|frame| self.clip.at(*frame))
    }
}

/// The question for a plan.
pub(super) fn request(
    template: Template,
    asked: &CheckedQuestion<'_>,
    sent: &SentFrames<'_>,
    pictures: Vec<Image>,
    convention: &Convention,
    settings: &Settings,
) -> Request {
    let (mut example, mut properties) = words_schema();
    if template == Template::BOX {
        let numbers = convention.numbers(centre_of(sent.size()), sent.size());
        // Whole numbers, unless a side is 1.
        let number =
            |number: f64| if is_fraction(convention) { json!(number) } else { json!(number.round() as i64) };
        let numbers: Vec<Value> = numbers.into_iter().map(number).collect();
        example["boxes"] = json!([{ "time": 0.0, &convention.key: numbers }]);
        properties["boxes"] = json!({ "type": "array", "items": object_schema(json!({
            "time": { "type": "number", "minimum": 0, "maximum": sent.clock.sent().len().saturating_sub(1) },
            &convention.key: { "type": "array", "items": number_schema(convention), "minItems": 4, "maxItems": 4 },
        })) });
    }
    interval_schema(settings, &mut example, &mut properties);
    let filling = Filling { key: &convention.key, example, ..Filling::of(asked, sent, settings) };
    let schema = Schema::new("grounding_plan", object_schema(properties));
    with_pictures(pictures, template.fill(&filling), schema, settings)
}

/// A question without pictures.
pub(super) fn text_request(template: Template, asked: &CheckedQuestion<'_>, settings: &Settings) -> Request {
    let (example, properties) = words_schema();
    let filling = Filling {
        query: asked.sentence,
        count: 0,
        seconds: 0.0,
        key: "",
        gate: false,
        candidates: 0,
        example,
    };
    let schema = Schema::new("noun_phrase", object_schema(properties));
    with_pictures(Vec::new(), template.fill(&filling), schema, settings)
}

/// Labels and pictures, then the words.
pub(super) fn with_pictures(
    pictures: Vec<Image>,
    text: String,
    schema: Schema,
    settings: &Settings,
) -> Request {
    let labelled = pictures
        .into_iter()
        .enumerate()
        .flat_map(|(index, picture)| [Part::Text(Clock::label(index)), Part::Image(picture)]);
    let parts = labelled.chain([Part::Text(text)]).collect();
    let mut request = Request::new(vec![Message::user(parts)]).with_schema(schema);
    request.max_tokens = settings.answer_tokens;
    request.temperature = settings.temperature;
    request.seed = settings.seed;
    request.repeat = settings.repeat;
    request
}

/// An object with all of these properties and no others, as servers in strict mode want it.
pub(super) fn object_schema(properties: Value) -> Value {
    let required: Vec<&String> = properties.as_object().map(Map::keys).into_iter().flatten().collect();
    json!({ "type": "object", "required": required, "additionalProperties": false, "properties": properties })
}

/// Adds intervals to an example and a schema, where they are asked for.
pub(super) fn interval_schema(settings: &Settings, example: &mut Value, properties: &mut Value) {
    if settings.gate {
        let time = json!({ "type": "number", "minimum": 0 });
        example["intervals"] = json!([{ "start": 0.0, "end": 5.0 }]);
        properties["intervals"] =
            json!({ "type": "array", "items": object_schema(json!({ "start": time, "end": time })) });
    }
}

fn words_schema() -> (Value, Value) {
    let example = json!({ "visible": true, "expression": "...", "noun_phrase": "..." });
    let text = json!({ "type": "string" });
    let properties = json!({ "visible": { "type": "boolean" }, "expression": text, "noun_phrase": text });
    (example, properties)
}

fn number_schema(convention: &Convention) -> Value {
    match convention.scale {
        Scale::Relative(1.0) => json!({ "type": "number", "minimum": 0, "maximum": 1 }),
        Scale::Relative(range) => json!({ "type": "integer", "minimum": 0, "maximum": range as i64 }),
        Scale::Pixels | Scale::Resized(_) => json!({ "type": "integer", "minimum": 0 }),
    }
}

fn is_fraction(convention: &Convention) -> bool {
    matches!(convention.scale, Scale::Relative(range) if range == 1.0)
}

/// A box for the example: in the middle, where it says nothing about the target.
fn centre_of((width, height): (u32, u32)) -> l4d_endpoint::BoxPx {
    let (width, height) = (f64::from(width), f64::from(height));
    l4d_endpoint::BoxPx { x0: width * 0.4, y0: height * 0.4, x1: width * 0.6, y1: height * 0.6 }
}
