//! The workers of the package, and one that misbehaves.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use l4d_data::Interval;
use l4d_endpoint::BoxPx;
use l4d_masks::Mask;

use super::*;
use crate::testing::{asked_from, clip, sentence};
use crate::{Grounder, Grounding, Outcome, Unreadable};

fn here() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A worker of the package.
fn shipped(python: &Path, arguments: &[&str]) -> Launch {
    let environment = BTreeMap::from([
        ("PYTHONPATH".to_owned(), here().join("workers").into()),
        ("PYTHONDONTWRITEBYTECODE".to_owned(), "1".into()),
    ]);
    let module = ["-m", "l4d_workers"].iter().chain(arguments);
    Launch { program: python.to_owned(), arguments: module.map(Into::into).collect(), environment }
}

fn scripted(arguments: &[&str]) -> Launch {
    let script = here().join("tests/worker/scripted.py");
    let arguments = [script.into_os_string()].into_iter().chain(arguments.iter().map(Into::into));
    Launch { program: "python3".into(), arguments: arguments.collect(), environment: BTreeMap::new() }
}

fn brief() -> WorkerTimeouts {
    WorkerTimeouts {
        hello: Duration::from_secs(30),
        silence: Duration::from_secs(20),
        answer: Duration::from_secs(20),
        farewell: Duration::from_millis(500),
    }
}

fn hasty() -> WorkerTimeouts {
    WorkerTimeouts { silence: Duration::from_millis(400), answer: Duration::from_millis(800), ..brief() }
}

struct Kit {
    folder: tempfile::TempDir,
}

impl Kit {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn file(&self) -> String {
        self.folder.path().join("count").display().to_string()
    }

    fn segmenter(&self, launch: Launch, timeouts: WorkerTimeouts) -> Arc<Segmenter> {
        let worker = Worker::start(launch, timeouts).unwrap();
        Arc::new(Segmenter::new(worker, FrameStore::new(self.folder.path().join("frames")), 0.0))
    }

    /// One that gets the sentence itself; the mode of the scripted worker counts its starts in a file.
    fn grounder(&self, mode: &str, timeouts: WorkerTimeouts) -> TextGrounder {
        TextGrounder::new(self.segmenter(scripted(&[mode, &self.file()]), timeouts)).unwrap()
    }

    fn ask(&self, mode: &str, timeouts: WorkerTimeouts, text: &str) -> Grounding {
        self.grounder(mode, timeouts).ground(&clip(8, 6, &[0, 12]), &sentence(text))
    }

    /// How often the worker was started.
    fn starts(&self) -> usize {
        std::fs::read_to_string(self.file()).unwrap().len()
    }
}

/// What is marked in the answers of the scripted worker.
fn left() -> Mask {
    Mask::from_fn(8, 6, |column, _| column < 4)
}

fn error_of(grounding: &Grounding) -> &str {
    assert!(grounding.masks.is_empty());
    match &grounding.outcome {
        Outcome::Error(message) => message,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_box_worker_goes_straight_between_boxes() {
    let kit = Kit::new();
    let segmenter = kit.segmenter(shipped(Path::new("python3"), &["box"]), brief());
    assert_eq!((segmenter.hello().name.as_str(), segmenter.hello().text), ("box", None));
    let clip = clip(64, 48, &[0, 12, 24, 36, 48]);
    let place = |frame, x0| ClipPrompt::Box {
        object: 1,
        frame,
        place: BoxPx { x0, y0: 10.0, x1: x0 + 10.0, y1: 20.0 },
    };
    let prompts = [place(12, 10.0), place(36, 30.0)];
    let found = segmenter.segment(&clip, &prompts, Some(Interval::new(5, 40).unwrap())).unwrap();
    let masks = found.union();
    assert_eq!(masks.keys().copied().collect::<Vec<_>>(), [12, 24, 36]);
    let expected = Mask::from_fn(64, 48, |column, row| (20..30).contains(&column) && (10..20).contains(&row));
    assert_eq!(masks[&24], expected);
    let text = TextGrounder::new(segmenter).unwrap_err();
    assert!(
        matches!(text, WorkerError::Unfit { .. }) && text.to_string().contains("it takes box, not text"),
        "{text}"
    );
}

#[test]
fn the_null_worker_says_absent_in_every_frame() {
    let segmenter = Kit::new().segmenter(shipped(Path::new("python3"), &["null"]), brief());
    let grounder = TextGrounder::new(segmenter).unwrap();
    let grounding = grounder.ground(&clip(8, 6, &[0, 12, 24]), &sentence("the 猫 that 🎾"));
    assert_eq!((grounding.outcome, grounding.masks.len()), (Outcome::Absent, 3));
    assert_eq!(grounder.identity()["segmenter"]["worker"]["name"], "null");
}

#[test]
fn masks_come_back_at_their_frames_whatever_else_the_worker_says() {
    for mode in ["plain", "talks"] {
        let grounding = Kit::new().ask(mode, brief(), "cup");
        assert_eq!((grounding.outcome, grounding.masks.len()), (Outcome::Found, 2));
        assert_eq!(grounding.masks[&12], left());
    }
    let kit = Kit::new();
    let grounder = kit.grounder("plain", brief());
    let grounding = grounder.ground(&clip(8, 6, &[0, 12]), &asked_from(sentence("cup"), 6, 20));
    assert!(grounding.masks[&0].is_empty() && !grounding.masks[&12].is_empty());
    // Threads take turns.
    std::thread::scope(|scope| {
        let ask = || grounder.ground(&clip(8, 6, &[0, 12]), &sentence("cup")).masks[&12].clone();
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(ask)).collect();
        threads.into_iter().for_each(|thread| assert_eq!(thread.join().unwrap(), left()));
    });
}

#[test]
fn sentences_that_cannot_be_asked_never_reach_the_worker() {
    let kit = Kit::new();
    let grounder = kit.grounder("dies", brief());
    for text in ["", "  \n\t ", &"word ".repeat(10_000)] {
        let outcome = grounder.ground(&clip(8, 6, &[0]), &sentence(text)).outcome;
        assert_eq!(outcome, Outcome::Unsupported(grounder.reads(text).unwrap_err()));
    }
    let outcome = grounder.ground(&clip(8, 6, &[]), &sentence("cup")).outcome;
    assert!(matches!(outcome, Outcome::Error(_)), "{outcome:?}");
}

#[test]
fn refusals_are_told_apart() {
    let kit = Kit::new();
    let grounding = kit.ask("plain", brief(), "refuse");
    assert_eq!(grounding.outcome, Outcome::Unsupported(Unreadable::whole("too long[0m")));
    assert!(error_of(&kit.ask("plain", brief(), "memory")).contains("says `oom`: no memory"));
}

#[test]
fn a_worker_that_dies_is_started_again_once_and_given_up_after_four_failures() {
    let kit = Kit::new();
    assert_eq!(kit.ask("dies-once", brief(), "cup").outcome, Outcome::Found);
    assert_eq!(kit.starts(), 2);
    let kit = Kit::new();
    let grounder = kit.grounder("dies", brief());
    let ask = || grounder.ground(&clip(8, 6, &[0]), &sentence("cup"));
    assert!(error_of(&ask()).contains("ended early (exit status: 7)"));
    assert!(error_of(&ask()).contains("ended early"));
    assert!(error_of(&ask()).contains("given up after 4 failures in a row"));
    assert_eq!(kit.starts(), 4);
}

#[test]
fn one_that_hangs_breaks_the_protocol_or_is_another_after_its_restart_is_ended() {
    let cases = [
        ("hangs", hasty(), "said nothing for 0.4 seconds"),
        ("busy", hasty(), "worked on one answer for 0.8 seconds"),
        ("changes", brief(), "another hello"),
        ("wrong-id", brief(), "which was not asked"),
        ("garbage", brief(), "{'id': 1, 'done': True}"),
        ("flood", brief(), "a line without end"),
    ];
    // Side by side, since most of the time is waiting.
    std::thread::scope(|scope| {
        for (mode, timeouts, words) in cases {
            scope.spawn(move || {
                let grounding = Kit::new().ask(mode, timeouts, "cup");
                assert!(error_of(&grounding).contains(words), "{mode}: {grounding:?}");
            });
        }
    });
}

#[test]
fn a_useless_answer_costs_one_view_and_not_the_worker() {
    for (mode, words) in [
        ("wrong-size", "4x4 pixels, the frames have 8x6"),
        ("torn-mask", "cannot be read"),
        ("wrong-frame", "a mask of frame 7"),
        ("twice", "two masks of object 1"),
        ("crowd", "more than 64 objects"),
        ("late", "a mask of frame 7"),
    ] {
        let kit = Kit::new();
        let grounder = kit.grounder(mode, brief());
        let ask = |text: &str| grounder.ground(&clip(8, 6, &[0, 12]), &sentence(text));
        let bad = ask("bad");
        assert!(error_of(&bad).contains(words), "{mode}: {bad:?}");
        assert_eq!(ask("good").outcome, Outcome::Found, "{mode}");
        assert_eq!(kit.starts(), 1, "{mode} was started again");
    }
}

#[test]
fn a_worker_that_never_gets_ready_says_why() {
    let start = |mode: &str, timeouts| Worker::start(scripted(&[mode]), timeouts).unwrap_err();
    let quick = WorkerTimeouts { hello: Duration::from_millis(500), ..brief() };
    assert!(start("mute", quick).to_string().contains("was not ready for 0.5 seconds"));
    assert!(start("chatty", brief()).to_string().contains("Loading weights"));
    assert!(start("old", brief()).to_string().contains("version 7"));
    let dead = start("early-death", brief()).to_string();
    assert!(dead.contains("exit status: 3") && dead.contains("no such model"), "{dead}");
    let none =
        Launch { program: "/nowhere/python".into(), arguments: Vec::new(), environment: BTreeMap::new() };
    let error = Worker::start(none, brief()).unwrap_err();
    assert!(error.to_string().contains("`/nowhere/python` cannot be started"), "{error}");
}

#[test]
fn nothing_outlives_a_worker_that_is_dropped() {
    let kit = Kit::new();
    let worker = Worker::start(scripted(&["grandchild", &kit.file()]), brief()).unwrap();
    let grandchild = std::fs::read_to_string(kit.file()).unwrap();
    let status = PathBuf::from(format!("/proc/{grandchild}/stat"));
    let is_running = || std::fs::read_to_string(&status).is_ok_and(|text| !text.contains(") Z "));
    assert!(is_running());
    drop(worker);
    // It is killed by now; its end may take the system a moment.
    let is_gone = (0..3000).any(|_| {
        std::thread::sleep(Duration::from_millis(20));
        !is_running()
    });
    assert!(is_gone, "process {grandchild} still runs");
}

#[test]
fn frames_are_written_once_for_the_same_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let store = FrameStore::new(folder.path());
    let first = store.frames(&clip(8, 6, &[0, 12])).unwrap();
    let time = |frames: &Frames| std::fs::metadata(frames.dir.join("0012.png")).unwrap().modified().unwrap();
    let (written, second) = (time(&first), store.frames(&clip(8, 6, &[0, 12])).unwrap());
    assert_eq!((&first, written), (&second, time(&second)));
    assert!(first.dir.is_absolute() && first.files == ["0000.png", "0012.png"]);
    std::fs::remove_file(first.dir.join("0000.png")).unwrap();
    store.frames(&clip(8, 6, &[0, 12])).unwrap();
    assert!(first.dir.join("0000.png").exists(), "a missing frame is written again");
    assert_ne!(store.frames(&clip(8, 6, &[0, 24])).unwrap().dir, first.dir);
}

/// On tiny random models of the real classes, which `workers/tests/tiny_models.py` writes.
#[test]
#[ignore = "needs L4D_WORKERS_PYTHON, the Python of the workers' environment with torch"]
fn networks_load_and_answer_through_the_protocol() {
    let python = PathBuf::from(std::env::var_os("L4D_WORKERS_PYTHON").unwrap());
    let kit = Kit::new();
    let models = kit.folder.path().join("models");
    let script = here().join("workers/tests/tiny_models.py");
    let made = Command::new(&python).arg(script).arg(&models).env("OMP_NUM_THREADS", "1").status().unwrap();
    assert!(made.success());
    let open = |name: &str, model: &str| {
        let folder = models.join(model).display().to_string();
        let launch = shipped(&python, &[name, "--model", &folder, "--device", "cpu", "--threads", "1"]);
        kit.segmenter(launch, WorkerTimeouts { hello: Duration::from_secs(300), ..WorkerTimeouts::default() })
    };
    let clip = clip(64, 48, &[0, 12, 24, 36, 48]);

    let sam2 = open("sam2-hf", "sam2");
    let place = BoxPx { x0: 10.0, y0: 10.0, x1: 30.0, y1: 30.0 };
    let prompt = ClipPrompt::Box { object: 1, frame: 24, place };
    let found = sam2.segment(&clip, &[prompt], None).unwrap();
    assert_eq!(found.objects.len(), 1);
    let frames: Vec<u32> = found.objects[0].masks.keys().copied().collect();
    assert_eq!(frames, [0, 12, 24, 36, 48], "followed both ways");
    assert!(found.objects[0].score.is_some());
    assert_eq!(sam2.identity()["worker"]["deps"]["transformers"], "5.23.0");

    let grounder = TextGrounder::new(open("sam3-hf", "sam3")).unwrap();
    let grounding = grounder.ground(&clip, &sentence("red cup"));
    assert!(grounding.outcome.is_answer(), "{grounding:?}");
    assert_eq!(grounding.masks.len(), 5);
    let long = grounder.ground(&clip, &sentence("the cup that is moved from left to right by the hand"));
    assert!(matches!(long.outcome, Outcome::Unsupported(_)), "{long:?}");
}
