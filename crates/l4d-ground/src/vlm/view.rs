//! One view, from question to masks, by each coupling.
//!
//! A question is one message: labelled pictures in the order of time, then the words. That is the common denominator
//! of the servers, and how models of the Qwen family were trained to see videos.

use std::cmp::Reverse;

use l4d_endpoint::{EndpointError, Image, Message, Part, Reply, Request, Schema, one_line};
use l4d_frames::drawn::RgbImage;
use l4d_frames::overlay::{Mark, annotated, encode_jpeg, enlarge, object_colour};
use l4d_masks::Mask;
use serde_json::Value;

use super::prompt::{Shape, Template, boxes_shape, choice_shape, read_choice, words_shape};
use super::{Coupling, Settings, Vlm};
use crate::clip::{ClipFrame, ViewClip};
use crate::grounder::{CheckedQuestion, Outcome, Question};
use crate::plan::{Clock, GroundingPlan, Keyframe, SentPictures, Wanted, read};
use crate::worker::{ClipPrompt, Object, Segmented, TextKind};

/// Largest factor by which small clips are enlarged: nothing is gained beyond.
const LARGEST_FACTOR: u32 = 16;
/// More outlines than this hide what they outline.
const MOST_CANDIDATES: usize = 20;

/// A view that is asked about.
pub(super) struct View<'a> {
    vlm: &'a Vlm,
    clip: &'a ViewClip,
    asked: CheckedQuestion<'a>,
    /// The frames that are sent: spread over what is asked about, its first and last among them.
    clock: Clock,
    /// By which pictures are enlarged.
    factor: u32,
    /// How it went, for people to read.
    pub(super) notes: Vec<String>,
}

impl<'a> View<'a> {
    /// The outcome says why there is nothing to ask.
    pub(super) fn new(vlm: &'a Vlm, clip: &'a ViewClip, question: &'a Question) -> Result<Self, Outcome> {
        let asked = CheckedQuestion::new(clip, question)?;
        let Settings { keyframes, picture_pixels, .. } = vlm.settings;
        let (available, wanted) = (asked.frames.len(), keyframes.min(asked.frames.len()));
        let moment = |index: usize| match wanted {
            1 => available / 2,
            _ => (index * (available - 1) + (wanted - 1) / 2) / (wanted - 1),
        };
        let frames = (0..wanted).filter_map(|index| asked.frames.get(moment(index)).copied()).collect();
        let pixels = f64::from(clip.width) * f64::from(clip.height);
        let factor = (f64::from(picture_pixels) / pixels).sqrt().round() as u32;
        let factor = factor.clamp(1, LARGEST_FACTOR);
        Ok(Self { vlm, clip, asked, clock: Clock(frames), factor, notes: Vec::new() })
    }

    /// What was found, or why there are no masks.
    pub(super) fn masks(&mut self) -> Result<Segmented, Outcome> {
        let found = match self.vlm.coupling {
            Coupling::Text => {
                let plan = self.plan(Template::TEXT, self.plain().map_err(failed)?)?;
                let words = match self.vlm.segmenter.hello().text {
                    Some(TextKind::Phrase) => plan.noun_phrase,
                    Some(TextKind::Sentence) | None => plan.expression,
                };
                self.notes.push(format!("the segmenter was given: {words}"));
                self.segment(&[ClipPrompt::Text(words)])?
            }
            Coupling::Box => {
                let plan = self.plan(Template::BOX, self.plain().map_err(failed)?)?;
                let with = plan.keyframes.chunk_by(|a, b| a.frame == b.frame).count();
                self.notes.push(format!("places in {with} of {} pictures", self.clock.0.len()));
                let prompt = |Keyframe { frame, object, place }| ClipPrompt::Box { object, frame, place };
                self.segment(&plan.keyframes.into_iter().map(prompt).collect::<Vec<_>>())?
            }
            Coupling::Pick => {
                let phrase = self.plan(Template::NOUN, Vec::new())?.noun_phrase;
                let found = self.segment(&[ClipPrompt::Text(phrase.clone())])?;
                self.notes.push(format!("{} candidates for: {phrase}", found.objects.len()));
                self.chosen(found)?
            }
        };
        self.notes.extend(found.skipped.iter().map(|step| format!("the segmenter left out: {step}")));
        Ok(found)
    }

    /// `pick`: what the model chooses among everything of the kind, outlined and numbered.
    fn chosen(&mut self, mut found: Segmented) -> Result<Segmented, Outcome> {
        found.objects.retain(|object| object.masks.values().any(|mask| !mask.is_empty()));
        if found.objects.len() > MOST_CANDIDATES {
            self.notes.push(format!("only the {MOST_CANDIDATES} surest candidates were shown"));
            found.objects.truncate(MOST_CANDIDATES);
        }
        let count = found.objects.len();
        if count == 0 {
            return Err(Outcome::Absent);
        }
        let request = self.choice_request(self.marked(&found.objects).map_err(failed)?, count);
        let reply = self.ask(Template::PICK, &request)?;
        let choice = read_choice(&reply, count, &mut self.notes);
        let numbers = choice.inspect_err(|outcome| self.forget(&request, outcome))?;
        self.notes.push(format!("chosen: {numbers:?}"));
        let numbered = found.objects.into_iter().zip(1..);
        found.objects =
            numbered.filter(|(_, number)| numbers.contains(number)).map(|(object, _)| object).collect();
        Ok(found)
    }

    fn plan(&mut self, template: Template, pictures: Vec<Image>) -> Result<GroundingPlan, Outcome> {
        let request = self.plan_request(template, pictures);
        let reply = self.ask(template, &request)?;
        let pictures = SentPictures {
            clock: &self.clock,
            size: self.size(),
            clip: (self.clip.width, self.clip.height),
            convention: self.vlm.convention,
        };
        let wanted = if template == Template::BOX { Wanted::Boxes } else { Wanted::Words };
        let (outcome, mut plan) = read(&reply, wanted, &pictures);
        if !plan.expression.is_empty() {
            self.notes.push(format!("it says: {} ({})", plan.expression, plan.noun_phrase));
        }
        self.notes.append(&mut plan.notes);
        match outcome {
            Outcome::Found => Ok(plan),
            outcome => {
                self.forget(&request, &outcome);
                Err(outcome)
            }
        }
    }

    /// A reply, whole or not; what it was asked with, and for how many tokens, is noted.
    fn ask(&mut self, template: Template, request: &Request) -> Result<Reply, Outcome> {
        let client = &self.vlm.client;
        self.notes.push(format!("asked `{}` with the prompt {}", client.endpoint().model, template.name));
        let reply = client.ask(request).map_err(failed)?;
        let count = |tokens: Option<u64>| tokens.map_or("?".to_owned(), |tokens| tokens.to_string());
        self.notes.push(format!(
            "question {:.12}: {} pictures, {} tokens, and {} of answer",
            reply.digest,
            request.images().count(),
            count(reply.usage.prompt_tokens),
            count(reply.usage.completion_tokens)
        ));
        self.notes.extend(reply.notes.iter().map(|note| one_line(note, 300)));
        Ok(reply)
    }

    fn segment(&self, prompts: &[ClipPrompt]) -> Result<Segmented, Outcome> {
        let found = self.vlm.segmenter.segment(self.clip, prompts, Some(self.asked.range));
        found.map_err(|error| match error.outcome() {
            // These are the model's words, not the user's: asked again it may find others.
            Outcome::Unsupported(unread) => {
                Outcome::Unparsed(format!("the segmenter cannot take what the model says: {unread}"))
            }
            outcome => outcome,
        })
    }

    /// Only answers are remembered: a reply without sense may come out better next time.
    fn forget(&self, request: &Request, outcome: &Outcome) {
        if !outcome.is_answer()
            && let Err(error) = self.vlm.client.forget(request)
        {
            tracing::warn!("a reply without sense stays in the cache: {error}");
        }
    }

    /// The question for a plan.
    pub(super) fn plan_request(&self, template: Template, pictures: Vec<Image>) -> Request {
        let shape = match template == Template::BOX {
            true => boxes_shape(self.vlm.convention, self.size(), self.clock.0.len()),
            false => words_shape(),
        };
        let name = if pictures.is_empty() { "noun_phrase" } else { "grounding_plan" };
        self.request(template, pictures, name, shape, 0)
    }

    /// The question which of `candidates` candidates is meant.
    pub(super) fn choice_request(&self, pictures: Vec<Image>, candidates: usize) -> Request {
        self.request(Template::PICK, pictures, "choice", choice_shape(candidates), candidates)
    }

    fn request(
        &self,
        template: Template,
        pictures: Vec<Image>,
        name: &'static str,
        shape: Shape,
        candidates: usize,
    ) -> Request {
        let seconds = f64::from(self.asked.range.frame_count()) / self.clip.timeline.frames_per_second();
        let text = template.fill(&[
            // As JSON, so that no sentence can end its quotes.
            ("query", Value::from(self.asked.sentence).to_string()),
            ("count", self.clock.0.len().to_string()),
            ("seconds", format!("{seconds:.1}")),
            ("key", self.vlm.convention.key.clone()),
            ("candidates", candidates.to_string()),
            ("example", shape.example.to_string()),
        ]);
        let labelled = pictures
            .into_iter()
            .enumerate()
            .flat_map(|(index, picture)| [Part::Text(Clock::label(index)), Part::Image(picture)]);
        let parts = labelled.chain([Part::Text(text)]).collect();
        let Settings { answer_tokens, temperature, seed, repeat, .. } = self.vlm.settings;
        let request = Request::new(vec![Message::user(parts)])
            .with_schema(Schema::new(name, shape.schema))
            .with_max_tokens(answer_tokens);
        Request { temperature, seed, repeat, ..request }
    }

    /// Width and height of the pictures that are sent, pixels.
    fn size(&self) -> (u32, u32) {
        (self.clip.width * self.factor, self.clip.height * self.factor)
    }

    /// The pictures as they are.
    pub(super) fn plain(&self) -> Result<Vec<Image>, EndpointError> {
        self.pictures(|seen| enlarge(&seen.colour, self.factor))
    }

    /// The pictures with candidates outlined and numbered from 1. Where they overlap, the smaller one is seen.
    fn marked(&self, candidates: &[Object]) -> Result<Vec<Image>, EndpointError> {
        let mark = |place: usize| Mark {
            id: place as u32 + 1,
            number: place + 1,
            colour: object_colour(place),
            faint: false,
        };
        let marks: Vec<Mark> = (0..candidates.len()).map(mark).collect();
        self.pictures(|seen| {
            let width = self.clip.width as usize;
            let mut ids = vec![0; width * self.clip.height as usize];
            let numbered = candidates.iter().zip(1..);
            let mut masks: Vec<(&Mask, u32)> =
                numbered.filter_map(|(one, id)| Some((one.masks.get(&seen.frame)?, id))).collect();
            masks.sort_by_key(|(mask, id)| (Reverse(mask.area()), *id));
            for (mask, id) in masks {
                mask.pixels().for_each(|(column, row)| ids[row as usize * width + column as usize] = id);
            }
            annotated(&seen.colour, &ids, self.factor, &marks)
        })
    }

    fn pictures(&self, draw: impl Fn(&ClipFrame) -> RgbImage) -> Result<Vec<Image>, EndpointError> {
        let frames = self.clock.0.iter().filter_map(|frame| self.clip.at(*frame));
        frames.map(|seen| Image::new(encode_jpeg(&draw(seen)))).collect()
    }
}

fn failed(error: EndpointError) -> Outcome {
    Outcome::Error(format!("{error}; {}", error.hint()))
}
