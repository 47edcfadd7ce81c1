//! One view, from question to masks, by each coupling.

use l4d_endpoint::{EndpointError, Image, Reply, Request};

use super::pick::{self, Candidates};
use super::request::{self, SentFrames, Template};
use super::{Coupling, Vlm, pictures};
use crate::clip::ViewClip;
use crate::grounder::{Grounding, Outcome, Question};
use crate::plan::{GroundingPlan, SentPictures, Wanted, clean, read};
use crate::question::CheckedQuestion;
use crate::worker::{ClipPrompt, Segmented, TextKind, WorkerError};

/// Why a view has no masks, with what was noted on the way.
pub(super) struct NoMasks {
    pub(super) outcome: Outcome,
    pub(super) notes: Vec<String>,
}

impl Vlm {
    pub(super) fn plan_request(
        &self,
        asked: &CheckedQuestion<'_>,
        sent: &SentFrames<'_>,
        pictures: Vec<Image>,
    ) -> Request {
        request::request(self.coupling.template(), asked, sent, pictures, self.convention, &self.settings)
    }

    pub(super) fn noun_request(&self, asked: &CheckedQuestion<'_>) -> Request {
        request::text_request(Template::NOUN, asked, &self.settings)
    }

    /// Masks, or why there are none.
    pub(super) fn try_ground(&self, clip: &ViewClip, question: &Question) -> Result<Grounding, NoMasks> {
        let asked = CheckedQuestion::new(clip, question).map_err(NoMasks::without_notes)?;
        let sent = SentFrames::choose(clip, &asked, &self.settings);
        let (plan, found) = match self.coupling {
            Coupling::Text => self.by_words(clip, &asked, &sent)?,
            Coupling::Box => self.by_boxes(clip, &asked, &sent)?,
            Coupling::Pick => self.by_choice(clip, &asked, &sent)?,
        };
        let GroundingPlan { mut notes, intervals, .. } = plan.clone();
        notes.extend(found.skipped.iter().map(|step| format!("the segmenter left out: {step}")));
        let mut masks = found.union();
        if self.settings.gate && intervals.is_empty() {
            notes.push("the model gives no interval: no frame is gated".to_owned());
        }
        if self.settings.gate {
            masks.retain(|frame, _| plan.holds_at(*frame));
        }
        Ok(Grounding::of_masks(clip, masks, notes))
    }

    /// `text`: the model's words to a segmenter of text.
    fn by_words(
        &self,
        clip: &ViewClip,
        asked: &CheckedQuestion<'_>,
        sent: &SentFrames<'_>,
    ) -> Result<(GroundingPlan, Segmented), NoMasks> {
        let mut plan = self.plan(asked, sent, Wanted::Words)?;
        let words = match self.segmenter.hello().text {
            Some(TextKind::Phrase) => plan.noun_phrase.clone(),
            Some(TextKind::Sentence) | None => plan.expression.clone(),
        };
        plan.notes.push(format!("the segmenter was given: {words}"));
        let found = self.segment(clip, &[ClipPrompt::Text(words)], asked, &plan)?;
        Ok((plan, found))
    }

    /// `box`: the model's boxes to a segmenter that follows them.
    fn by_boxes(
        &self,
        clip: &ViewClip,
        asked: &CheckedQuestion<'_>,
        sent: &SentFrames<'_>,
    ) -> Result<(GroundingPlan, Segmented), NoMasks> {
        let mut plan = self.plan(asked, sent, Wanted::Boxes)?;
        let (with, all) = (plan.frame_count(), sent.clock.sent().len());
        plan.notes.push(format!("places in {with} of {all} pictures"));
        let takes_points = self.segmenter.takes("point").is_ok();
        let mut prompts = Vec::new();
        for keyframe in &plan.keyframes {
            let (object, frame) = (keyframe.object, keyframe.frame);
            prompts.extend(keyframe.box_px.map(|box_px| ClipPrompt::Box { object, frame, box_px }));
            let points = keyframe.points_px.iter().filter(|_| takes_points);
            prompts.extend(points.map(|point_px| ClipPrompt::Point { object, frame, point_px: *point_px }));
        }
        if prompts.is_empty() {
            let worker = &self.segmenter.hello().name;
            let outcome =
                Outcome::Error(format!("the model gives points alone, which `{worker}` does not take"));
            return Err(NoMasks { outcome, notes: plan.notes });
        }
        let found = self.segment(clip, &prompts, asked, &plan)?;
        Ok((plan, found))
    }

    /// `pick`: everything of the kind, outlined and numbered, and the model chooses.
    fn by_choice(
        &self,
        clip: &ViewClip,
        asked: &CheckedQuestion<'_>,
        sent: &SentFrames<'_>,
    ) -> Result<(GroundingPlan, Segmented), NoMasks> {
        let (request, mut notes) = (self.noun_request(asked), vec![self.prompt_note(Template::NOUN)]);
        let reply = self.ask(&request, &mut notes)?;
        let mut plan = self.read_plan(&reply, &request, sent, Wanted::Words, notes)?;
        let prompt = ClipPrompt::Text(plan.noun_phrase.clone());
        let found = self.segment(clip, &[prompt], asked, &plan)?;
        plan.notes.push(format!("{} candidates for: {}", found.objects.len(), plan.noun_phrase));
        let candidates = Candidates::of(found, &mut plan.notes);
        if candidates.objects.is_empty() {
            return Err(NoMasks { outcome: Outcome::Absent, notes: plan.notes });
        }
        let pictures = pictures::marked(sent, &candidates).map_err(|error| plan.stop(&error))?;
        let request = pick::request(asked, sent, pictures, candidates.objects.len(), &self.settings);
        plan.notes.push(self.prompt_note(Template::PICK));
        let reply = self.ask(&request, &mut plan.notes)?;
        match pick::read_choice(&reply, &sent.clock, candidates.objects.len()) {
            Ok(choice) => {
                plan.intervals = choice.intervals;
                plan.notes.extend(choice.notes);
                plan.notes.push(format!("chosen: {:?}", choice.numbers));
                Ok((plan, candidates.chosen(&choice.numbers)))
            }
            Err(outcome) => {
                self.forget(&request, &outcome);
                Err(NoMasks { outcome, notes: plan.notes })
            }
        }
    }

    fn plan(
        &self,
        asked: &CheckedQuestion<'_>,
        sent: &SentFrames<'_>,
        wanted: Wanted,
    ) -> Result<GroundingPlan, NoMasks> {
        let pictures = pictures::plain(sent).map_err(|error| NoMasks::of(&error))?;
        let request = self.plan_request(asked, sent, pictures);
        let mut notes = vec![self.prompt_note(self.coupling.template())];
        let reply = self.ask(&request, &mut notes)?;
        self.read_plan(&reply, &request, sent, wanted, notes)
    }

    fn read_plan(
        &self,
        reply: &Reply,
        request: &Request,
        sent: &SentFrames<'_>,
        wanted: Wanted,
        mut notes: Vec<String>,
    ) -> Result<GroundingPlan, NoMasks> {
        let pictures = SentPictures {
            clock: &sent.clock,
            size: sent.size(),
            clip: (sent.clip.width, sent.clip.height),
            convention: self.convention,
        };
        let reading = read(reply, wanted, &pictures);
        let mut plan = reading.plan;
        if !plan.expression.is_empty() {
            notes.push(format!("it says: {} ({})", plan.expression, plan.noun_phrase));
        }
        notes.append(&mut plan.notes);
        if reading.outcome == Outcome::Found {
            return Ok(GroundingPlan { notes, ..plan });
        }
        self.forget(request, &reading.outcome);
        Err(NoMasks { outcome: reading.outcome, notes })
    }

    /// A reply, whole or not; what it was asked with, and for how many tokens, is noted.
    fn ask(&self, request: &Request, notes: &mut Vec<String>) -> Result<Reply, NoMasks> {
        match self.client.ask(request) {
            Ok(reply) => {
                let count = |tokens: Option<u64>| tokens.map_or("?".to_owned(), |tokens| tokens.to_string());
                let (prompt, completion) = (reply.usage.prompt_tokens, reply.usage.completion_tokens);
                notes.push(format!(
                    "question {}: {} pictures, {} tokens, and {} of answer",
                    &reply.digest[..12.min(reply.digest.len())],
                    request.images().count(),
                    count(prompt),
                    count(completion)
                ));
                notes.extend(reply.notes.iter().map(|note| clean(note, 300)));
                Ok(reply)
            }
            Err(error) => Err(NoMasks { notes: std::mem::take(notes), ..NoMasks::of(&error) }),
        }
    }

    fn segment(
        &self,
        clip: &ViewClip,
        prompts: &[ClipPrompt],
        asked: &CheckedQuestion<'_>,
        plan: &GroundingPlan,
    ) -> Result<Segmented, NoMasks> {
        let result = self.segmenter.segment(clip, prompts, Some(asked.range));
        let outcome = |error: WorkerError| match error.outcome() {
            // These are the model's words, not the user's: asked again it may find others.
            Outcome::Unsupported(unread) => {
                Outcome::Unparsed(format!("the segmenter cannot take what the model says: {unread}"))
            }
            outcome => outcome,
        };
        result.map_err(|error| NoMasks { outcome: outcome(error), notes: plan.notes.clone() })
    }

    /// Only answers are remembered: a reply without sense may come out better next time.
    fn forget(&self, request: &Request, outcome: &Outcome) {
        if !outcome.is_answer()
            && let Err(error) = self.client.forget(request)
        {
            tracing::warn!("a reply without sense stays in the cache: {error}");
        }
    }

    fn prompt_note(&self, template: Template) -> String {
        format!("asked `{}` with the prompt {}", self.client.endpoint().model, template.name)
    }
}

impl NoMasks {
    fn without_notes(outcome: Outcome) -> Self {
        Self { outcome, notes: Vec::new() }
    }

    fn of(error: &EndpointError) -> Self {
        Self::without_notes(Outcome::Error(format!("{error}; {}", error.hint())))
    }
}

impl GroundingPlan {
    fn stop(&self, error: &EndpointError) -> NoMasks {
        NoMasks { notes: self.notes.clone(), ..NoMasks::of(error) }
    }
}
