//! The annotation screen, driven by keys alone in a real terminal.

pub(crate) mod data;
pub(crate) mod tmux;

use std::collections::BTreeMap;
use std::path::PathBuf;

use l4d_data::Name;
use l4d_votes::key::ItemSource;
use l4d_votes::{Ballot, ItemId, Key, Round, RoundDir};

use crate::support::{Dir, Noise};
use tmux::Tmux;

const PANEL: [&str; 5] = ["ada", "ben", "cyd", "dee", "eve"];
const USUAL: (u16, u16) = (80, 24);
const LARGE: (u16, u16) = (160, 48);

/// A folder with pictures and an open round.
struct Desk {
    dir: Dir,
    tmux: Tmux,
}

impl Desk {
    fn new() -> Self {
        let dir = data::dir();
        let annotators = PANEL.join(",");
        let shares = "--sample 18 --gold 0.2 --repeats 0.1 --view-count 3 --simulated";
        dir.succeed(format!("open-round r1 --profile tiny --annotators {annotators} {shares}"));
        Self { dir, tmux: Tmux::new() }
    }

    fn round(&self) -> (RoundDir, Round) {
        round_of(&self.dir)
    }

    /// The command of an annotator, for a shell.
    fn command(&self, annotator: &str) -> String {
        let l4d = env!("CARGO_BIN_EXE_l4d");
        format!("{l4d} verify-prompts r1 --as {annotator} --picture halfblocks")
    }

    /// Opens the screen of an annotator; the terminal's process is the program itself.
    fn sit_down(&self, annotator: &str, size: (u16, u16), environment: &str) {
        let command = format!("exec env {environment} {}", self.command(annotator));
        self.tmux.start(annotator, size, self.dir.path("").as_path(), &command);
        self.tmux.wait(annotator, "an item or the summary", |screen| {
            item_on(screen).is_some() || screen.contains("items:")
        });
    }

    fn ballot(&self, annotator: &str) -> Ballot {
        let (dir, round) = self.round();
        let (ballot, notices) = Ballot::open(&dir, &round, &Name::new(annotator).unwrap()).unwrap();
        assert!(notices.is_empty(), "{notices:?}");
        ballot
    }

    fn answered(&self, annotator: &str) -> usize {
        let ballot = self.ballot(annotator);
        ballot.order().iter().filter(|item| ballot.response(item).unwrap().answer.is_some()).count()
    }

    /// Answers every item by keys, as they come.
    fn vote(&self, annotator: &str) {
        let right = right_keys(&self.dir, annotator);
        let mut screen = self.tmux.screen(annotator);
        for turn in 0.. {
            let Some(item) = item_on(&screen) else { break };
            let keys = &right[&item];
            self.tmux.text(annotator, keys);
            match keys.as_str() {
                "n" => self.tmux.keys(annotator, &["Enter"]),
                "a" => {
                    self.tmux.text(annotator, "one cannot tell which");
                    self.tmux.keys(annotator, &["Enter"]);
                }
                // People look around; what they save is the same.
                _ if turn % 5 == 0 => {
                    self.tmux.keys(annotator, &["Right", "z", "Right", "Down", "Enter", "Enter"]);
                }
                _ => self.tmux.keys(annotator, &["Enter", "Enter"]),
            }
            screen = self.tmux.wait(annotator, "the next item", |screen| {
                item_on(screen).map_or_else(|| screen.contains("items:"), |next| next != item)
            });
        }
        seal(&self.tmux, annotator);
    }
}

/// The round `r1` of a folder.
pub(crate) fn round_of(folder: &Dir) -> (RoundDir, Round) {
    let dir = RoundDir::new(folder.path("annotation/rounds/r1"));
    let round = Round::open(&dir).unwrap();
    (dir, round)
}

/// The keys that answer each item rightly, for one annotator.
pub(crate) fn right_keys(folder: &Dir, annotator: &str) -> BTreeMap<ItemId, String> {
    let (dir, round) = round_of(folder);
    let key = Key::read(&dir, &round).unwrap();
    let annotator = Name::new(annotator).unwrap();
    let scenes = l4d_annotate::scene::load(&folder.path("data/tiny"), &round, &annotator).unwrap();
    let keys = |item: &l4d_votes::Item| {
        let card = &scenes[&item.scene];
        let mut source = key.source(&item.id).unwrap();
        while let ItemSource::Repeat { of } = source {
            source = key.source(of).unwrap();
        }
        match source {
            ItemSource::Query { meaning, .. } => {
                meaning.referents.iter().map(|name| card.number_of(name).unwrap().to_string()).collect()
            }
            ItemSource::Absent { .. } => "n".to_owned(),
            _ => "a".to_owned(),
        }
    };
    round.items.iter().map(|item| (item.id.clone(), keys(item))).collect()
}

/// Seals the ballot from the summary on, and leaves.
fn seal(tmux: &Tmux, annotator: &str) {
    tmux.text(annotator, "S");
    tmux.wait(annotator, "the question", |screen| screen.contains("Seal the ballot?"));
    tmux.text(annotator, "y");
    tmux.wait(annotator, "the seal", |screen| screen.contains("The ballot is sealed."));
    tmux.text(annotator, "q");
    tmux.wait_for_end(annotator);
}

fn kill(signal: &str, process: &str) {
    let status = std::process::Command::new("kill").args([signal, process]).status().unwrap();
    assert!(status.success());
}

/// The item that the first line of a screen names.
fn item_on(screen: &str) -> Option<ItemId> {
    let line = screen.lines().next()?;
    line.split(' ').find_map(|word| word.parse().ok())
}

/// How many items the screen calls answered.
fn answered_on(screen: &str) -> Option<usize> {
    let words: Vec<&str> = screen.lines().take(2).flat_map(str::split_whitespace).collect();
    let place = words.iter().position(|word| word.trim_end_matches(',') == "answered")?;
    words.get(place.checked_sub(1)?)?.parse().ok()
}

#[test]
fn five_annotators_complete_a_round_by_keys_alone() {
    let desk = Desk::new();
    let (_, round) = desk.round();
    assert!(round.items.len() >= 20, "{} items", round.items.len());
    std::thread::scope(|scope| {
        for (annotator, size) in PANEL.into_iter().zip([USUAL, LARGE, USUAL, LARGE, USUAL]) {
            let desk = &desk;
            scope.spawn(move || {
                desk.sit_down(annotator, size, "LANG=C.UTF-8");
                desk.vote(annotator);
            });
        }
    });
    for annotator in PANEL {
        assert!(desk.ballot(annotator).is_sealed());
        assert_eq!(desk.answered(annotator), round.items.len());
    }
    // Five people who saw different numbers meant the same objects.
    let verdict = desk.dir.json("verdict r1");
    assert_eq!(verdict["outcomes"]["valid"].as_u64(), Some(18), "{verdict:#}");
}

#[test]
fn killing_the_process_loses_no_vote_that_the_screen_acknowledged() {
    let desk = Desk::new();
    let mut noise = Noise::new(11);
    // No key takes anything back, so acknowledged answers can only become more.
    let bursts: [&[&str]; 10] = [
        &["1"],
        &["2", "Enter", "Enter"],
        &["n", "Enter"],
        &["Enter"],
        &["Right", "["],
        &["End", "]"],
        &["z", "x"],
        &["Space"],
        &["Down", "w"],
        &["1", "Enter"],
    ];
    let mut acknowledged = 0;
    for _ in 0..6 {
        desk.sit_down("ada", USUAL, "LANG=C.UTF-8");
        let resumed = answered_on(&desk.tmux.screen("ada")).unwrap();
        assert!(resumed >= acknowledged, "{resumed} of {acknowledged} answers are left");
        for _ in 0..3 + noise.below(16) {
            desk.tmux.keys("ada", bursts[noise.below(bursts.len() as u32) as usize]);
            acknowledged = answered_on(&desk.tmux.screen("ada")).unwrap_or(acknowledged).max(acknowledged);
        }
        kill("-9", &desk.tmux.value("ada", "pane_pid"));
        desk.tmux.wait_for_end("ada");
        desk.tmux.close("ada");
        assert!(desk.answered("ada") >= acknowledged);
    }
    assert!(acknowledged > 3, "the noise answered only {acknowledged} items");
}

#[test]
fn the_terminal_is_given_back_however_the_session_ends() {
    let desk = Desk::new();
    // (what ends it, exit status, what is said)
    let endings =
        [("quit", 0, "items answered"), ("interrupt", 0, "items answered"), ("term", 2, "ended by SIGTERM")];
    for (ending, status, said) in endings {
        let program = format!("sh -c 'echo $$ > pid; LANG=C.UTF-8 exec {}'", desk.command("ada"));
        let command = format!("{program}; echo STATUS=$?; stty -a; exec sleep 600");
        desk.tmux.start(ending, USUAL, desk.dir.path("").as_path(), &command);
        desk.tmux.wait(ending, "an item", |screen| item_on(screen).is_some());
        assert_eq!(desk.tmux.value(ending, "alternate_on"), "1");
        match ending {
            "quit" => desk.tmux.keys(ending, &["q"]),
            "interrupt" => desk.tmux.keys(ending, &["C-c"]),
            _ => kill("-TERM", desk.dir.read("pid").trim()),
        }
        let screen = desk.tmux.wait(ending, "the shell", |screen| screen.contains("icanon"));
        assert_given_back(&desk.tmux, ending, &screen);
        assert!(screen.contains(&format!("STATUS={status}")) && screen.contains(said), "{screen}");
        desk.tmux.close(ending);
    }
}

/// Cooked, echoing, on the first screen, with a cursor, without mouse.
fn assert_given_back(tmux: &Tmux, name: &str, screen: &str) {
    let has = |word: &str| screen.split_whitespace().any(|other| other.trim_end_matches(';') == word);
    assert!(has("icanon") && has("echo") && has("isig"), "{screen}");
    for (variable, expected) in [("alternate_on", "0"), ("cursor_flag", "1"), ("mouse_any_flag", "0")] {
        assert_eq!(tmux.value(name, variable), expected, "{variable} after {name}");
    }
}

/// Not a test of its own: the process that [`a_panic_gives_the_terminal_back`] runs in a terminal.
#[test]
#[ignore = "run by another test, in a terminal"]
fn panics_in_a_terminal() {
    let _taken = l4d_annotate::terminal::TerminalGuard::take().unwrap();
    // From another thread: nothing unwinds through the guard.
    std::thread::spawn(|| panic!("as if l4d had a fault")).join().ok();
    std::process::exit(3);
}

#[test]
fn a_panic_gives_the_terminal_back() {
    let tmux = Tmux::new();
    let program: PathBuf = std::env::current_exe().unwrap();
    let command = format!(
        "{} annotation_tui::panics_in_a_terminal --exact --ignored --nocapture --test-threads 1; \
         echo STATUS=$?; stty -a; exec sleep 600",
        program.display()
    );
    tmux.start("panic", USUAL, std::env::temp_dir().as_path(), &command);
    let screen = tmux.wait("panic", "the shell", |screen| screen.contains("icanon"));
    assert!(screen.contains("as if l4d had a fault") && screen.contains("STATUS=3"), "{screen}");
    assert_given_back(&tmux, "panic", &screen);
}

#[test]
fn plain_locales_and_terminals_without_colour_get_what_they_understand() {
    let desk = Desk::new();
    desk.sit_down("ada", USUAL, "LC_ALL=C");
    desk.tmux.keys("ada", &["?"]);
    let help = desk.tmux.wait("ada", "the keys", |screen| screen.contains("any key goes back"));
    desk.tmux.keys("ada", &["Escape"]);
    let item = desk.tmux.wait("ada", "the item", |screen| screen.contains("Which objects"));
    assert!(help.is_ascii() && item.is_ascii(), "{item}");
    for (annotator, environment) in [("ben", "LC_ALL=C NO_COLOR=1"), ("cyd", "LANG=C.UTF-8 NO_COLOR=1")] {
        desk.sit_down(annotator, USUAL, environment);
        let screen = desk.tmux.wait(annotator, "an outline", |screen| screen.contains("##"));
        assert_eq!(screen.is_ascii(), annotator == "ben", "{screen}");
    }
    // TERM says that nothing can be placed: there is nothing to fall back to.
    let command = format!("TERM=dumb {}; exec sleep 600", desk.command("dee"));
    desk.tmux.start("dee", USUAL, desk.dir.path("").as_path(), &command);
    let says_why = |screen: &str| ["hint:", "dumb", "TERM"].iter().all(|word| screen.contains(word));
    desk.tmux.wait("dee", "the refusal", says_why);
}

#[test]
fn what_cannot_work_is_refused_before_the_terminal_is_touched() {
    let desk = Desk::new();
    let refused = |arguments: &str, parts: &[&str]| {
        let run = desk.dir.run(format!("verify-prompts {arguments}"));
        run.refused(parts);
        assert!(!run.stdout.contains('\u{1b}'), "{run}");
    };
    refused("r9 --as ada", &["no such round", "r1"]);
    refused("r1 --as mallory", &["ada"]);
    // Missing pictures: the command that makes them is named.
    std::fs::remove_file(frame_of(&desk, "tabletop_mouse_cups")).unwrap();
    desk.dir.remove("data/tiny/room_office");
    let hint = "l4d build-scenes --profile tiny --scenes room_office,tabletop_mouse_cups";
    let missing = ["tabletop_mouse_cups lacks 1 picture", "room_office is not rendered", hint];
    refused("r1 --as ada", &missing);
}

fn frame_of(desk: &Desk, scene: &str) -> PathBuf {
    let frames = desk.dir.path(format!("data/tiny/{scene}/frames"));
    let view = std::fs::read_dir(frames).unwrap().next().unwrap().unwrap().path();
    view.join("0048.exr")
}

#[test]
fn an_annotators_process_opens_neither_the_key_nor_other_ballots() {
    let desk = Desk::new();
    let (dir, _) = desk.round();
    // Opening them would fail.
    std::fs::create_dir_all(dir.votes()).unwrap();
    std::fs::write(dir.key(), "\0 not a key").unwrap();
    std::fs::write(dir.ballot(&Name::new("ben").unwrap()), "\0 not a ballot").unwrap();
    desk.sit_down("ada", USUAL, "LANG=C.UTF-8");
    desk.tmux.keys("ada", &["n", "Enter"]);
    desk.tmux.wait("ada", "the next item", |screen| answered_on(screen) == Some(1));
}

#[test]
fn people_verify_prompts_on_the_pictures_of_a_capture() {
    let dir = crate::real_scenes::authored();
    let round = "open-round r1 --annotators ada --panel 1 --gold 0 --repeats 0";
    dir.succeed(format!("{round} --bench captures --profile real"));
    let tmux = Tmux::new();
    let command =
        format!("exec {} verify-prompts r1 --as ada --picture halfblocks", env!("CARGO_BIN_EXE_l4d"));
    tmux.start("ada", (100, 30), dir.path("").as_path(), &command);
    // Two objects under numbers drawn by lot: taking the first for both is right once.
    let screen = tmux.wait("ada", "the picture", |screen| screen.contains("q000"));
    assert!(screen.contains("whole clip"), "{screen}");
    let other = if screen.contains("q0001") { "q0002" } else { "q0001" };
    tmux.keys("ada", &["1", "Enter", "Enter"]);
    tmux.wait("ada", "the next item", |screen| screen.contains(other));
    tmux.keys("ada", &["1", "Enter", "Enter"]);
    tmux.wait("ada", "the summary", |screen| screen.contains("items:"));
    seal(&tmux, "ada");
    // One of the two is number 1: exactly one of the queries is understood.
    let outcomes = dir.json("verdict r1 --bench captures")["outcomes"].clone();
    assert_eq!([&outcomes["valid"], &outcomes["rejected"]], [1, 1]);
    let queries = dir.read("captures/queries/table.jsonl");
    assert_eq!(
        [queries.matches("verified").count(), queries.matches("rejected").count()],
        [1, 1],
        "{queries}"
    );
    // Drawing the masks anew is another scene: votes on the old one do not count.
    dir.edit("captures/truth/real/table.json", "\"variant\":0", "\"variant\":1");
    let check = dir.run("verdict r1 --bench captures --check");
    check.says(1, &["L4D531", "it is candidate"]);
}
