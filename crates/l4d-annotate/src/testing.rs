//! What the tests share: a round over a made-up scene on disk, and a session without a terminal.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use glam::DMat4;
use half::f16;
use l4d_data::scene::Instance;
use l4d_data::{Camera, Split};
use l4d_frames::Frame;
pub(crate) use l4d_testing::name;
use l4d_testing::{SIZE, flat, instance, scene};
use l4d_votes::{Ballot, Event, ItemId, Response, Round, RoundDir, ShownFrames};
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{Event as TerminalEvent, KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Rect, Size};

use crate::keys;
use crate::look::{Colours, Environment, Look};
use crate::message::{Effect, Message};
use crate::model::{Model, Question};
use crate::painter::Painter;
use crate::scene::{Scenes, load};
use crate::session::record;
use crate::update::{start, update};
use crate::view;

pub(crate) const PROMPTS: [&str; 4] =
    ["The disc that rolls", "The ball behind the red disc", "A thing that is not there", "The disc"];

/// A folder with one rendered scene and a round of [`PROMPTS`].
pub(crate) struct Fixture {
    folder: Arc<tempfile::TempDir>,
    pub(crate) round: Round,
    pub(crate) scenes: Arc<Scenes>,
}

impl Fixture {
    pub(crate) fn new() -> Self {
        let folder = Arc::new(tempfile::tempdir().unwrap());
        let data = folder.path().join("data");
        write_scene(&data);
        let dir = RoundDir::new(folder.path().join("r1"));
        std::fs::create_dir_all(dir.root()).unwrap();
        std::fs::write(
            dir.settings(),
            "schema = \"l4d/round/1\"\nname = \"r1\"\nprofile = \"tiny\"\nseed = 3\n\
             annotators = [\"ada\", \"ben\"]\nviews = 2\n",
        )
        .unwrap();
        let lines: Vec<String> = (1..)
            .zip(PROMPTS)
            .map(|(number, text)| {
                let digest = format!("{number:064x}");
                format!("{{\"item\":\"q{number:04}\",\"scene\":\"yard\",\"text\":\"{text}\",\"digest\":\"{digest}\"}}\n")
            })
            .collect();
        std::fs::write(dir.items(), lines.concat()).unwrap();
        let round = Round::open(&dir).unwrap();
        let scenes = Arc::new(load(&data, &round, &name("ada")).unwrap());
        Self { folder, round, scenes }
    }

    pub(crate) fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    pub(crate) fn exports(&self) -> PathBuf {
        self.folder.path().join("exports")
    }

    pub(crate) fn dir(&self) -> RoundDir {
        RoundDir::new(self.folder.path().join("r1"))
    }

    pub(crate) fn questions(&self) -> Vec<Question> {
        let question = |item: &l4d_votes::Item| Question {
            id: item.id.clone(),
            text: item.text.clone(),
            scene: item.scene.clone(),
            response: Response::default(),
        };
        self.round.items.iter().map(question).collect()
    }

    pub(crate) fn painter(&self, look: Look) -> Painter {
        Painter::new(&self.data(), &self.exports(), Arc::clone(&self.scenes), look, None)
    }

    pub(crate) fn ballot(&self) -> Ballot {
        let (ballot, notices) = Ballot::open(&self.dir(), &self.round, &name("ada")).unwrap();
        assert!(notices.is_empty());
        ballot
    }

    pub(crate) fn model(&self, look: Look, size: Size, questions: Vec<Question>) -> Model {
        Model::new(&self.round, name("ada"), questions, None, Arc::clone(&self.scenes), look, size)
    }

    /// A session of 80x24 in colour.
    pub(crate) fn drive(&self) -> Driver {
        self.drive_with(look(true, Colours::Full), Size::new(80, 24))
    }

    pub(crate) fn drive_with(&self, look: Look, size: Size) -> Driver {
        let model = self.model(look, size, self.questions());
        Driver::new(model, self.ballot(), self.painter(look), Arc::clone(&self.folder))
    }
}

pub(crate) fn look(unicode: bool, colours: Colours) -> Look {
    let environment = Environment { term: "xterm".to_owned(), ..Environment::default() };
    Look { unicode, colours, ..environment.look().unwrap() }
}

const FULL: &str = "no space left on device";

/// A session whose clock stops unless it is moved, and whose painter answers at once unless it has to wait.
pub(crate) struct Driver {
    pub(crate) model: Model,
    pub(crate) ballot: Ballot,
    /// What was asked of the ballot and not refused.
    pub(crate) events: Vec<(ItemId, Event, ShownFrames, Duration)>,
    pub(crate) disk_is_full: bool,
    pub(crate) now: Duration,
    pub(crate) paints: bool,
    pub(crate) requests: Vec<crate::picture::PictureRequest>,
    pub(crate) exported: Vec<crate::picture::ExportRequest>,
    pub(crate) is_over: bool,
    painter: Painter,
    /// The painter reads from it.
    _folder: Arc<tempfile::TempDir>,
}

impl Driver {
    fn new(mut model: Model, ballot: Ballot, painter: Painter, folder: Arc<tempfile::TempDir>) -> Self {
        let effects = start(&mut model);
        let mut driver = Self {
            model,
            ballot,
            events: Vec::new(),
            disk_is_full: false,
            now: Duration::ZERO,
            paints: true,
            requests: Vec::new(),
            exported: Vec::new(),
            is_over: false,
            painter,
            _folder: folder,
        };
        driver.carry_out(effects);
        driver
    }

    pub(crate) fn tell(&mut self, message: Message) {
        let effects = update(&mut self.model, message, self.now);
        self.carry_out(effects);
    }

    fn carry_out(&mut self, effects: Vec<Effect>) {
        for effect in effects {
            match effect {
                Effect::Paint { request, .. } => {
                    self.requests.push(request);
                    if self.paints {
                        self.paint();
                    }
                }
                Effect::Record { .. } if self.disk_is_full => {
                    self.tell(Message::Recorded(Err(FULL.to_owned())));
                }
                Effect::Record { item, event, seen, elapsed } => {
                    self.events.push((item.clone(), event.clone(), seen.clone(), elapsed));
                    let result = record(&mut self.ballot, item, event, seen, elapsed);
                    self.tell(Message::Recorded(result));
                }
                Effect::Seal if self.disk_is_full => self.tell(Message::Sealed(Err(FULL.to_owned()))),
                Effect::Seal => {
                    let result = self.ballot.seal().map_err(|error| error.to_string());
                    self.tell(Message::Sealed(result));
                }
                Effect::Export(request) => self.exported.push(request),
                Effect::Redraw => {}
                Effect::Quit => self.is_over = true,
            }
        }
    }

    /// Paints what was asked for last.
    pub(crate) fn paint(&mut self) {
        let request = self.requests.last().unwrap().clone();
        let key = (request.scene.clone(), request.view.clone(), request.frame);
        let shown = self.painter.frame(&key).unwrap();
        let picture = self.painter.paint(&request, &shown).unwrap();
        self.tell(Message::Painted(picture));
    }

    /// Presses keys: letters as they are, others by name in angle brackets, as in `3<Enter>`.
    pub(crate) fn keys(&mut self, text: &str) {
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let named = rest
                .strip_prefix('<')
                .and_then(|inner| inner.split_once('>'))
                .and_then(|(name, after)| Some((key_code(name)?, after)));
            let (code, after) = named.unwrap_or((KeyCode::Char(first), &rest[first.len_utf8()..]));
            rest = after;
            self.event(TerminalEvent::Key(KeyEvent::new(code, KeyModifiers::NONE)));
        }
    }

    pub(crate) fn event(&mut self, event: TerminalEvent) {
        if let Some(message) = keys::message(&self.model.mode, event) {
            self.tell(message);
        }
    }

    pub(crate) fn buffer(&self) -> Buffer {
        let area = Rect::new(0, 0, self.model.size.width, self.model.size.height);
        let mut buffer = Buffer::empty(area);
        view::draw(&self.model, area, &mut buffer);
        buffer
    }

    /// The screen as text.
    pub(crate) fn text(&self) -> String {
        let buffer = self.buffer();
        let rows = buffer.content.chunks(usize::from(buffer.area.width).max(1));
        let line = |row: &[ratatui::buffer::Cell]| {
            let symbols: String = row.iter().map(ratatui::buffer::Cell::symbol).collect();
            symbols.trim_end().to_owned() + "\n"
        };
        rows.map(line).collect()
    }

    /// Numbers of objects by name, as this annotator sees them.
    pub(crate) fn number(&self, object: &str) -> usize {
        self.model.scene().number_of(&name(object)).unwrap()
    }

    pub(crate) fn notice(&self) -> &str {
        self.model.notice.as_ref().map_or("", |notice| &notice.text)
    }
}

fn key_code(name: &str) -> Option<KeyCode> {
    Some(match name {
        "Enter" => KeyCode::Enter,
        "Esc" => KeyCode::Esc,
        "Backspace" => KeyCode::Backspace,
        "Left" => KeyCode::Left,
        "Right" => KeyCode::Right,
        "Up" => KeyCode::Up,
        "Down" => KeyCode::Down,
        "Home" => KeyCode::Home,
        "End" => KeyCode::End,
        _ => return None,
    })
}

/// Centre and radius of an object, pixels; discs 1 to 3 stand still, ball 4 rolls to the right.
pub(crate) fn disc(id: u32, frame: u32) -> (i64, i64, i64) {
    match id {
        1 => (20, 30, 10),
        2 => (60, 25, 12),
        3 => (100, 40, 14),
        _ => (15 + i64::from(frame), 75, 6),
    }
}

fn write_scene(data: &std::path::Path) {
    let camera = |view: &str, split: Split, x: f64| {
        let pose = DMat4::from_translation(glam::DVec3::X * x);
        Camera { split, ..Camera::new(name(view), SIZE, 128.0, pose) }
    };
    let cameras = vec![
        camera("cam00", Split::Train, 0.0),
        camera("cam01", Split::Test, 1.0),
        camera("cam02", Split::Train, 5.0),
    ];
    let things = [(1, "disc_a"), (2, "disc_b"), (3, "disc_c"), (4, "ball_d"), (1001, "floor")];
    let disc = |(id, label)| Instance { category: "disc".to_owned(), ..instance(id, label) };
    let scene = scene("yard", cameras, things.map(disc).to_vec());
    l4d_testing::write_scene(data, scene, |camera, frame| {
        (camera.name.as_str() != "cam00").then(|| picture(frame))
    });
}

fn picture(frame: u32) -> Frame {
    let mut picture = flat(|column, row| {
        let inside = |id: &u32| {
            let (x, y, radius) = disc(*id, frame);
            let (dx, dy) = (i64::from(column) - x, i64::from(row) - y);
            dx * dx + dy * dy < radius * radius
        };
        (1..=4).find(inside).unwrap_or(if row > 60 { 1001 } else { 0 })
    });
    for (light, id) in picture.rgb.iter_mut().zip(&picture.surfaces.id) {
        let colour = match id {
            1 => [0.8, 0.1, 0.1],
            2 => [0.1, 0.1, 0.8],
            3 => [0.1, 0.6, 0.1],
            4 => [0.9, 0.9, 0.9],
            1001 => [0.3, 0.25, 0.2],
            _ => [0.2, 0.3, 0.5],
        };
        *light = colour.map(f16::from_f32);
    }
    picture
}
