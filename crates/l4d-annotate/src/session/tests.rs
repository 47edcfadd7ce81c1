use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use l4d_votes::{Ballot, Round, RoundDir};
use ratatui::backend::{CrosstermBackend, TestBackend};
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Rect, Size};
use ratatui::{TerminalOptions, Viewport};
use ratatui_image::picker::{Picker, ProtocolType};

use super::*;
use crate::look::{Colours, Look, Medium};
use crate::model::Start;
use crate::scene;
use crate::testing::{FakeLog, Fixture, PROMPTS, look, name};

fn key(code: KeyCode) -> Input {
    Input::Event(TerminalEvent::Key(KeyEvent::new(code, KeyModifiers::NONE)))
}

/// A session over the fixture, or over the scenes in a folder.
fn session(
    fixture: &Fixture,
    look: Look,
    picker: Option<Picker>,
    size: Size,
    send: &Sender,
) -> Session<FakeLog> {
    let scenes = Arc::clone(&fixture.scenes);
    let painter = Painter::new(&fixture.data(), &fixture.exports(), scenes, look, picker);
    Session::new(fixture.model(look, size, fixture.questions()), FakeLog::default(), studio(painter, send))
}

#[test]
fn a_session_ends_with_q_and_its_pictures_come_by_themselves() {
    let fixture = Fixture::new();
    let (send, inputs) = mpsc::channel();
    let mut session = session(&fixture, look(true, Colours::Full), None, Size::new(80, 24), &send);
    let mut terminal = Terminal::new(TestBackend::new(80, 24)).unwrap();
    let user = std::thread::spawn(move || {
        for code in [KeyCode::Char('1'), KeyCode::Enter, KeyCode::Enter, KeyCode::Char('n'), KeyCode::Enter] {
            send.send(key(code)).unwrap();
        }
        std::thread::sleep(Duration::from_secs(1));
        send.send(key(KeyCode::Char('q'))).unwrap();
        // The sender lives until here: the session ends because of the key.
        send
    });
    session.serve(&mut terminal, &inputs).unwrap();
    drop(user.join().unwrap());
    assert_eq!(session.model.progress(), (2, 0));
    assert!(session.model.picture().is_some());
}

#[test]
fn signals_and_a_lost_terminal_end_the_session_with_a_reason() {
    let fixture = Fixture::new();
    let cases = [
        (Input::Signal("SIGTERM"), "ended by SIGTERM"),
        (Input::Lost(io::Error::from(io::ErrorKind::BrokenPipe)), "the terminal cannot be used"),
        (Input::PainterDied, "the painter of the pictures failed"),
    ];
    for (input, expected) in cases {
        let (send, inputs) = mpsc::channel();
        let mut session = session(&fixture, look(true, Colours::Full), None, Size::new(80, 24), &send);
        send.send(input).unwrap();
        let error =
            session.serve(&mut Terminal::new(TestBackend::new(80, 24)).unwrap(), &inputs).unwrap_err();
        assert!(error.to_string().starts_with(expected), "{error}");
        assert!(error.hint().unwrap().contains("goes on where it stopped"));
    }
}

#[test]
fn control_c_ends_the_session_from_anywhere() {
    let fixture = Fixture::new();
    let (send, inputs) = mpsc::channel();
    let mut session = session(&fixture, look(true, Colours::Full), None, Size::new(80, 24), &send);
    send.send(key(KeyCode::Char('a'))).unwrap();
    let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
    send.send(Input::Event(TerminalEvent::Key(interrupt))).unwrap();
    session.serve(&mut Terminal::new(TestBackend::new(80, 24)).unwrap(), &inputs).unwrap();
}

#[test]
fn a_terminal_of_another_size_than_expected_is_drawn_in_its_own() {
    let fixture = Fixture::new();
    let (send, inputs) = mpsc::channel();
    let mut session = session(&fixture, look(true, Colours::Full), None, Size::new(80, 24), &send);
    let mut terminal = Terminal::new(TestBackend::new(120, 40)).unwrap();
    send.send(key(KeyCode::Char('q'))).unwrap();
    session.serve(&mut terminal, &inputs).unwrap();
    assert_eq!(session.model.size, Size::new(120, 40));
}

#[test]
fn a_ballot_keeps_what_was_shown_as_saved() {
    let fixture = Fixture::new();
    let dir = fixture.dir();
    let (ballot, _) = Ballot::open(&dir, &fixture.round, &name("ada")).unwrap();
    let mut log = BallotLog(ballot);
    let asked = questions(&fixture.round, &log);
    assert_eq!(asked.len(), PROMPTS.len());
    let item = &asked[2].id;
    let answer = l4d_votes::Answer { choice: l4d_votes::Choice::None, frames: l4d_data::Interval::WHOLE };
    let recorded = log.record(item, Event::Choose(answer), Seen::default(), Duration::from_secs(1)).unwrap();
    assert!(recorded.standing.answer.is_some() && recorded.undoable.as_ref() == Some(item));
    assert!(log.seal().is_err(), "items are open");
    drop(log);
    let (ballot, notices) = Ballot::open(&dir, &fixture.round, &name("ada")).unwrap();
    assert!(notices.is_empty());
    assert_eq!(questions(&fixture.round, &BallotLog(ballot))[2].standing, recorded.standing);
}

/// A terminal that tells when it was drawn.
#[derive(Clone)]
struct Screen(Arc<Mutex<mpsc::Sender<Instant>>>);

impl io::Write for Screen {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.lock().unwrap().send(Instant::now()).ok();
        Ok(())
    }
}

/// A session on a thread of its own: keys in, moments of drawing out.
struct Scripted {
    send: Sender,
    drawn: Receiver<Instant>,
    served: std::thread::JoinHandle<()>,
}

impl Scripted {
    fn start(build: impl FnOnce(&Sender, Size) -> Session<FakeLog> + Send + 'static, size: Size) -> Self {
        let (send, inputs) = mpsc::channel();
        let (draws, drawn) = mpsc::channel();
        let to_session = send.clone();
        let served = std::thread::spawn(move || {
            let backend = CrosstermBackend::new(Screen(Arc::new(Mutex::new(draws))));
            let viewport = Viewport::Fixed(Rect::new(0, 0, size.width, size.height));
            let mut terminal = Terminal::with_options(backend, TerminalOptions { viewport }).unwrap();
            build(&to_session, size).serve(&mut terminal, &inputs).unwrap();
        });
        Self { send, drawn, served }
    }

    /// Time from a key to the screen.
    fn press(&self, code: KeyCode) -> Duration {
        while self.drawn.try_recv().is_ok() {}
        let pressed = Instant::now();
        self.send.send(key(code)).unwrap();
        self.drawn.recv_timeout(Duration::from_secs(60)).unwrap() - pressed
    }

    /// Waits until the screen has stood still for a while; tells when it was drawn last.
    fn settle(&self, pause: Duration) -> Option<Instant> {
        let mut last = None;
        while let Ok(drawn) = self.drawn.recv_timeout(pause) {
            last = Some(drawn);
        }
        last
    }

    fn end(self) {
        self.send.send(key(KeyCode::Char('q'))).unwrap();
        self.served.join().unwrap();
    }
}

/// The bound is 50 ms; unoptimised code on a busy machine gets more.
const BOUND: Duration = Duration::from_millis(if cfg!(debug_assertions) { 500 } else { 50 });

fn report(what: &str, mut times: Vec<Duration>) {
    times.sort();
    let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
    println!("{what}: median {median:.1?}, worst {worst:.1?} of {}", times.len());
    assert!(worst < BOUND, "{what}: {worst:?}");
}

/// Looking around: frames, views, zoom, numbers, with pauses shorter than a picture takes.
const WALK: [KeyCode; 12] = [
    KeyCode::Right,
    KeyCode::Right,
    KeyCode::Down,
    KeyCode::Char('2'),
    KeyCode::Char('+'),
    KeyCode::Char('z'),
    KeyCode::Char('x'),
    KeyCode::Left,
    KeyCode::Char('2'),
    KeyCode::Char('>'),
    KeyCode::End,
    KeyCode::Char('<'),
];

#[test]
fn keys_reach_the_screen_in_time() {
    let fixture = Arc::new(Fixture::new());
    let kept = Arc::clone(&fixture);
    let build = move |send: &Sender, size| session(&kept, look(true, Colours::Full), None, size, send);
    let scripted = Scripted::start(build, Size::new(160, 48));
    scripted.settle(Duration::from_millis(500));
    report(
        "key to screen, characters",
        (0..60).map(|turn| scripted.press(WALK[turn % WALK.len()])).collect(),
    );
    scripted.end();
}

/// Sixels of the whole screen take long to encode, so nearly every key comes while a picture is in the making.
#[test]
fn keys_do_not_wait_for_pictures() {
    let fixture = Arc::new(Fixture::new());
    let kept = Arc::clone(&fixture);
    let build = move |send: &Sender, size: Size| {
        let mut picker = Picker::halfblocks();
        picker.set_protocol_type(ProtocolType::Sixel);
        let look = Look { medium: Medium::Pixels, ..look(true, Colours::Full) };
        session(&kept, look, Some(picker), size, send)
    };
    let scripted = Scripted::start(build, Size::new(160, 48));
    scripted.settle(Duration::from_millis(500));
    report("key to screen, pixels", (0..60).map(|turn| scripted.press(WALK[turn % WALK.len()])).collect());
    scripted.end();
}

/// `L4D_DATA=data/small cargo test --release -p l4d-annotate real_scenes -- --nocapture` measures real scenes.
#[test]
fn real_scenes_answer_in_time() {
    let Some(data) = std::env::var_os("L4D_DATA").map(PathBuf::from) else { return };
    let folder = tempfile::tempdir().unwrap();
    let dir = RoundDir::new(folder.path().join("r1"));
    std::fs::create_dir_all(dir.root()).unwrap();
    let profile = data.file_name().unwrap().to_string_lossy().into_owned();
    let settings = format!(
        "schema = \"l4d/round/1\"\nname = \"r1\"\ntitle = \"\"\nprofile = \"{profile}\"\nseed = 3\n\
         annotators = [\"ada\", \"ben\"]\nrule = \"unanimous:2\"\nviews = 5\n"
    );
    std::fs::write(dir.settings(), settings).unwrap();
    let names: Vec<String> = l4d_data::store::list_folder(&data)
        .unwrap()
        .into_iter()
        .filter(|scene| data.join(scene).join("scene.json").is_file())
        .collect();
    let lines = names.iter().enumerate().map(|(number, scene)| {
        let number = number + 1;
        format!("{{\"item\":\"q{number:04}\",\"scene\":\"{scene}\",\"text\":\"The thing\",\"digest\":\"{number:064x}\"}}\n")
    });
    std::fs::write(dir.items(), lines.collect::<String>()).unwrap();
    for (width, height) in [(80, 24), (160, 48)] {
        let (data, dir) = (data.clone(), dir.clone());
        let started = Instant::now();
        let build = move |send: &Sender, size: Size| {
            let round = Round::open(&dir).unwrap();
            let scenes = Arc::new(scene::load(&data, &round, &name("ada")).unwrap());
            let look = look(true, Colours::Full);
            let question = |item: &l4d_votes::Item| Question {
                id: item.id.clone(),
                text: item.text.clone(),
                scene: item.scene.clone(),
                standing: Standing::default(),
            };
            let model = Model::new(Start {
                round: &round,
                annotator: name("ada"),
                questions: round.items.iter().map(question).collect(),
                scenes: Arc::clone(&scenes),
                look,
                size,
                undoable: None,
            });
            let painter = Painter::new(&data, &data, scenes, look, None);
            Session::new(model, FakeLog::default(), studio(painter, send))
        };
        let scripted = Scripted::start(build, Size::new(width, height));
        let first = scripted.settle(Duration::from_millis(500)).unwrap() - started;
        println!("{width}x{height}: scenes read and first picture shown after {first:.1?}");
        assert!(first < Duration::from_secs(1) || cfg!(debug_assertions), "{first:?}");
        report("key to screen", (0..120).map(|turn| scripted.press(WALK[turn % WALK.len()])).collect());
        scripted.settle(Duration::from_millis(500));
        let shown = |code: KeyCode| {
            let pressed = Instant::now();
            scripted.press(code);
            scripted.settle(Duration::from_millis(200)).map_or(Duration::ZERO, |drawn| drawn - pressed)
        };
        let mut times: Vec<Duration> =
            (0..20).map(|turn| shown([KeyCode::Right, KeyCode::Down][turn % 2])).collect();
        times.sort();
        println!("key to new picture: median {:.1?}, worst {:.1?}", times[10], times[19]);
        scripted.end();
    }
}
