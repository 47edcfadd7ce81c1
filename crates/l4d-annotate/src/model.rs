//! Everything that the application knows. It changes in [`crate::update`] alone and is drawn by [`crate::view`].

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

use l4d_data::{Interval, Name};
use l4d_masks::mask::PixelBox;
use l4d_votes::{Answer, Choice, ItemId, Response, Round, ShownFrames};
use ratatui::layout::Size;

use crate::draft::{Draft, DraftChoice};
use crate::field::Field;
use crate::layout::{Screen, screen};
use crate::look::Look;
use crate::picture::{Picture, PictureRequest};
use crate::scene::{SceneInfo, Scenes};
use crate::viewport::Viewport;

/// How long a picture is shown while playing, if the clip has a frame for each canonical one.
const FRAME_TIME: Duration = Duration::from_nanos(1_000_000_000 / 24);

/// An item with what the log says about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Question {
    pub(crate) id: ItemId,
    pub(crate) text: String,
    pub(crate) scene: Name,
    /// What was said.
    pub(crate) response: Response,
}

/// What the keys do now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Looking, and choosing objects.
    Choose,
    /// Looking, and choice when the choice holds.
    When,
    /// Typing why the prompt is ambiguous.
    Reason(Field),
    Comment(Field),
    /// The list of what is left.
    Summary {
        /// Which of [`Model::unanswered`] is marked.
        selected: usize,
        /// Whether the question is asked that seals.
        sealing: bool,
    },
    /// Leaving would drop an answer that was not saved.
    Leave,
}

/// What the last event led to, in one sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Notice {
    pub(crate) text: String,
    pub(crate) is_error: bool,
}

#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) title: String,
    pub(crate) annotator: Name,
    pub(crate) questions: Vec<Question>,
    pub(crate) scenes: Arc<Scenes>,
    pub(crate) look: Look,
    pub(crate) size: Size,
    /// Place in `questions`.
    pub(crate) at: usize,
    pub(crate) mode: Mode,
    pub(crate) help: bool,
    pub(crate) draft: Draft,
    /// Drafts of items that were left without saving, by place.
    pub(crate) drafts: BTreeMap<usize, Draft>,
    pub(crate) view: usize,
    /// Place in the frames of the scene.
    pub(crate) frame: usize,
    pub(crate) viewport: Viewport,
    pub(crate) outlines: bool,
    /// When the next frame is due.
    pub(crate) playing: Option<Duration>,
    pub(crate) seen: ShownFrames,
    pub(crate) shown_at: Duration,
    pub(crate) notice: Option<Notice>,
    /// The item that an undo would change.
    pub(crate) undoable: Option<ItemId>,
    pub(crate) sealed: bool,
    /// What was asked of the painter last.
    pub(crate) requested: Option<PictureRequest>,
    /// What it painted last.
    pub(crate) picture: Option<Arc<Picture>>,
    pub(crate) picture_error: Option<String>,
}

impl Model {
    /// A session at the first open item, or at the summary if there is none.
    pub(crate) fn new(
        round: &Round,
        annotator: Name,
        questions: Vec<Question>,
        undoable: Option<ItemId>,
        scenes: Arc<Scenes>,
        look: Look,
        size: Size,
    ) -> Self {
        let open = questions.iter().position(|question| question.response.is_open());
        let mode = if open.is_some() { Mode::Choose } else { Mode::Summary { selected: 0, sealing: false } };
        let mut model = Self {
            title: round.name.to_string(),
            annotator,
            questions,
            scenes,
            look,
            size,
            at: open.unwrap_or(0),
            mode,
            help: false,
            draft: Draft::default(),
            drafts: BTreeMap::new(),
            view: 0,
            frame: 0,
            viewport: Viewport::WHOLE,
            outlines: true,
            playing: None,
            seen: ShownFrames::default(),
            shown_at: Duration::ZERO,
            notice: None,
            undoable,
            sealed: false,
            requested: None,
            picture: None,
            picture_error: None,
        };
        model.frame = model.scene().opening;
        model.recall_draft();
        model
    }

    pub(crate) fn question(&self) -> &Question {
        &self.questions[self.at]
    }

    pub(crate) fn scene(&self) -> &SceneInfo {
        &self.scenes[&self.question().scene]
    }

    /// When the draft holds.
    pub(crate) fn holds(&self) -> Interval {
        self.draft.holds(self.scene())
    }

    /// The canonical frame on the screen.
    pub(crate) fn frame_number(&self) -> u32 {
        self.scene().frames[self.frame]
    }

    /// Where things are on the screen; none if it is too small.
    pub(crate) fn screen(&self) -> Option<Screen> {
        screen(self.size, &self.question().text, self.look.aspect(self.scene().size))
    }

    /// Items that are answered, and items that are skipped.
    pub(crate) fn progress(&self) -> (usize, usize) {
        let count = |test: fn(&Response) -> bool| {
            self.questions.iter().filter(|question| test(&question.response)).count()
        };
        (count(|response| response.answer.is_some()), count(|response| response.skipped))
    }

    /// Places of the items without an answer: open ones first, then skipped ones.
    pub(crate) fn unanswered(&self) -> Vec<usize> {
        let places = |skipped: bool| {
            let matches = move |(_, question): &(usize, &Question)| {
                question.response.answer.is_none() && question.response.skipped == skipped
            };
            self.questions.iter().enumerate().filter(matches).map(|(place, _)| place)
        };
        places(false).chain(places(true)).collect()
    }

    /// Whether the draft says something that the log does not.
    pub(crate) fn is_unsaved(&self) -> bool {
        !self.draft.is_blank() && self.draft.answer(self.scene()) != self.question().response.answer
    }

    /// Whether leaving now would drop something that was entered.
    pub(crate) fn has_unsaved(&self) -> bool {
        let is_typing =
            matches!(&self.mode, Mode::Reason(field) | Mode::Comment(field) if !field.text().is_empty());
        is_typing || self.is_unsaved() || !self.drafts.is_empty()
    }

    /// The draft that says what an answer of the current item says.
    pub(crate) fn draft_of(&self, answer: Answer) -> Draft {
        let choice = match answer.choice {
            Choice::None => DraftChoice::None,
            Choice::Ambiguous { reason } => DraftChoice::Ambiguous(reason),
            Choice::Objects(names) => {
                let number = |name: &Name| self.scene().number_of(name);
                DraftChoice::Objects(names.iter().filter_map(number).collect())
            }
        };
        let frames = Some(answer.frames).filter(|frames| *frames != self.scene().whole());
        Draft { choice, frames, typed: String::new() }
    }

    /// Makes the draft what the log says.
    pub(crate) fn recall_draft(&mut self) {
        let answer = self.question().response.answer.clone();
        self.draft = answer.map_or_else(Draft::default, |answer| self.draft_of(answer));
    }

    /// Ids of the objects that the draft names.
    pub(crate) fn chosen_ids(&self) -> BTreeSet<u32> {
        let scene = self.scene();
        self.draft.numbers().filter_map(|number| scene.object(number)).map(|object| object.id).collect()
    }

    /// The picture that ought to be on the screen; none where there is no room or pictures are off.
    pub(crate) fn wanted(&self) -> Option<PictureRequest> {
        let area = self.screen()?.picture;
        if self.help || !self.shows_scene() {
            return None;
        }
        let scene = self.scene();
        let cells = self.look.fit(scene.size, area.as_size());
        Some(PictureRequest {
            scene: self.question().scene.clone(),
            view: scene.views[self.view].clone(),
            frame: self.frame_number(),
            region: self.viewport.region(scene.size),
            cells,
            chosen: self.chosen_ids(),
            outlines: self.outlines,
        })
    }

    /// Whether the screen is that of an item, and not a page of text.
    pub(crate) fn shows_scene(&self) -> bool {
        !matches!(self.mode, Mode::Summary { .. })
    }

    /// The picture on the screen, if it is one of this scene.
    pub(crate) fn picture(&self) -> Option<&Picture> {
        let picture = self.picture.as_deref()?;
        (picture.request.scene == self.question().scene).then_some(picture)
    }

    /// Whether the picture on the screen is not the wanted one yet.
    pub(crate) fn is_loading(&self) -> bool {
        self.picture_error.is_none()
            && self.requested.is_some()
            && self.picture.as_deref().map(|picture| &picture.request) != self.requested.as_ref()
    }

    /// When something happens without a key.
    pub(crate) fn wakes_at(&self) -> Option<Duration> {
        // A picture that is still being painted will wake the loop itself.
        self.playing.filter(|_| !self.is_loading())
    }

    /// How long each frame is shown while playing.
    pub(crate) fn frame_time(&self) -> Duration {
        let frames = &self.scene().frames;
        let stride = frames.get(1).map_or(1, |second| second - frames[0]);
        FRAME_TIME * stride.max(1)
    }

    /// Frames worth decoding before they are asked for.
    pub(crate) fn frames_ahead(&self) -> Vec<u32> {
        let frames = &self.scene().frames;
        let count = if self.playing.is_some() { 4 } else { 1 };
        (1..=count).filter_map(|step| frames.get(self.frame + step)).copied().collect()
    }

    pub(crate) fn box_around(&self, ids: &BTreeSet<u32>) -> Option<PixelBox> {
        self.picture()?.source.box_around(ids)
    }

    pub(crate) fn say(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), is_error: false });
    }

    pub(crate) fn complain(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), is_error: true });
    }
}
