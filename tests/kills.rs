//! `kill -9` at any moment: the next run of a verb ends with the files of one that was not killed, and nothing else is
//! left. What the verbs keep apart, and how a stopped one says how to go on.

use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::support::{Dir, Noise, Run};
use crate::{annotation, hosting, interop, originals, proposing, releasing, solving, splats};

/// A verb that writes, and a folder in which it can be run.
pub(crate) struct Verb {
    pub(crate) name: &'static str,
    pub(crate) stage: fn() -> Dir,
    pub(crate) line: &'static str,
    /// Whether it is quick enough to be killed in the plain suite.
    pub(crate) is_quick: bool,
}

pub(crate) const fn verb(name: &'static str, stage: fn() -> Dir, line: &'static str) -> Verb {
    Verb { name, stage, line, is_quick: false }
}

const fn quick(name: &'static str, stage: fn() -> Dir, line: &'static str) -> Verb {
    Verb { is_quick: true, ..verb(name, stage, line) }
}

/// Some iterations, and a checkpoint now and then.
const TRAIN: &str = "train-splats ball --profile tiny --data data --gaussians 800 --coarse 40 --unfold 4 --fine 60 \
     --patience 0 --checkpoint-seconds 0.1";

/// All that write more than a file and need no Blender, whose kills are in `blender`.
pub(crate) static VERBS: [Verb; 18] = [
    quick("baseline", Dir::with_benchmark, "baseline --profile tiny"),
    quick("score", Dir::with_baselines, "score --profile tiny"),
    verb("leaderboard", scored, "leaderboard --profile tiny --html"),
    quick("export", interop::folder, "export wall --profile tiny --format colmap --out out"),
    quick("import-scene", interop::shelf, interop::IMPORT),
    quick("import", originals::folder, "import mevis theirs --profile tiny"),
    quick("open-round", annotation::bench, annotation::OPEN),
    quick("verdict", annotation::voted, "verdict pilot"),
    quick("propose-prompts", proposing::taped_prompts, proposing::PROMPTS_AGAIN),
    quick("propose-scenes", proposing::taped_scenes, proposing::SCENES_AGAIN),
    quick("host", hosting::bench, hosting::HOST),
    quick(
        "release",
        releasing::rendered,
        "release --date 2026-11-22 --url https://example.org/two --profile tiny",
    ),
    quick(
        "download",
        releasing::published,
        "download release/two-0.1.0 --bench there/benchmark --data there/data --work there/work",
    ),
    verb("stats", releasing::rendered, "stats --profile tiny --out stats"),
    verb("train-splats", splats::scene, TRAIN),
    verb(
        "render-splats",
        solving::world,
        "render-splats ball --profile tiny --data data --out clips --preview",
    ),
    verb("solve", unseen, "solve --profile tiny --data data --grounder oracle"),
    verb("ablate", solving::world, "ablate scales --profile tiny --data data --grounder oracle --lift vote"),
];

pub(crate) fn scored() -> Dir {
    let dir = Dir::with_baselines();
    dir.succeed("score --profile tiny");
    dir
}

/// A world whose model was not drawn yet.
fn unseen() -> Dir {
    let dir = solving::world();
    dir.remove("work/tiny/ball/clips");
    dir
}

/// All files, what a clock says and what a run notes for the next one left out.
fn files(dir: &Dir) -> BTreeMap<String, Vec<u8>> {
    fn forget_times(value: &mut Value) {
        match value {
            Value::Object(fields) => {
                fields.retain(|name, _| !name.ends_with("seconds") && name != "peak_memory_bytes");
                fields.values_mut().for_each(forget_times);
            }
            Value::Array(items) => items.iter_mut().for_each(forget_times),
            _ => {}
        }
    }
    let mut files = dir.tree("");
    files.retain(|name, _| !name.ends_with(".l4d-written"));
    for (name, bytes) in &mut files {
        if name.ends_with(".json")
            && let Ok(mut document) = serde_json::from_slice(bytes)
        {
            forget_times(&mut document);
            *bytes = document.to_string().into_bytes();
        }
    }
    files
}

/// Kills a verb so many times, once or twice before it may end; what is wrong then.
fn kill(verb: &Verb, kills: u32, noise: &mut Noise) -> Result<(), String> {
    let stage = (verb.stage)();
    let calm = stage.copy();
    let begin = Instant::now();
    calm.succeed(verb.line);
    let whole = begin.elapsed();
    let expected = files(&calm);
    let mut killed = 0;
    while killed < kills {
        let shaken = stage.copy();
        for _ in 0..=noise.below(2) {
            let mut child = shaken.spawn(verb.line);
            sleep(whole * noise.below(1000) / 1000);
            killed += u32::from(child.try_wait().unwrap().is_none());
            child.kill().unwrap();
            child.wait().unwrap();
        }
        let run = shaken.run(verb.line);
        // A round that is whole is never opened again.
        if run.code != 0 && !run.stderr.contains("there is such a round already") {
            return Err(format!("{} does not go on after {killed} kills: {run}", verb.name));
        }
        let found = files(&shaken);
        let differs = |name: &&String| expected.get(*name) != found.get(*name);
        let differing: Vec<&String> = expected
            .keys()
            .chain(found.keys().filter(|name| !expected.contains_key(*name)))
            .filter(differs)
            .collect();
        if !differing.is_empty() {
            return Err(format!("{} differs after {killed} kills: {differing:?}", verb.name));
        }
    }
    Ok(())
}

fn kill_each(verbs: impl Iterator<Item = &'static Verb>, kills: u32) {
    let mut noise = Noise::new(u64::from(kills));
    let failures: Vec<String> = verbs.filter_map(|verb| kill(verb, kills, &mut noise).err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn quick_verbs_go_on_after_two_kills() {
    kill_each(VERBS.iter().filter(|verb| verb.is_quick), 2);
}

#[test]
#[ignore = "slow: 50 kills of each verb"]
fn every_verb_goes_on_after_fifty_kills() {
    kill_each(VERBS.iter(), 50);
}

#[test]
fn two_runs_do_not_write_into_one_folder() {
    let places = [
        ("export", "out"),
        ("host", "hosting/codabench"),
        ("import", "results/mevis"),
        ("release", "release"),
        ("score", "scores"),
        ("leaderboard", "leaderboard"),
        ("open-round", "annotation/rounds/pilot"),
    ];
    for (verb, folder) in places {
        let verb = VERBS.iter().find(|other| other.name == verb).unwrap();
        let dir = (verb.stage)();
        let lock = l4d_data::store::FolderLock::take(&dir.path(folder)).unwrap();
        dir.refuses(verb.line, &[folder, "another l4d writes into it"]);
        drop(lock);
        dir.succeed(verb.line);
    }
}

#[test]
fn training_that_is_stopped_saves_what_it_learned() {
    const TRAIN: &str = "train-splats ball --profile tiny --data data --checkpoint-seconds 3600";
    for (signal, number) in [("-INT", 2), ("-TERM", 15)] {
        let dir = splats::scene();
        let mut command = dir.command(TRAIN);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        while !dir.path("work/tiny/ball/splats").exists() {
            sleep(Duration::from_millis(20));
        }
        let process = child.id().to_string();
        assert!(Command::new("kill").args([signal, &process]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(std::os::unix::process::ExitStatusExt::signal(&output.status), Some(number));
        let run = Run::from(output);
        assert!(run.stderr.contains("stopping: what was learned is saved first"), "{run}");
        assert!(run.stderr.contains("hint: run the same command again: it goes on from there"), "{run}");
        let card = dir.value("work/tiny/ball/splats/checkpoint.json");
        assert!(card["iteration"].as_u64() > Some(0), "{card}");
    }
}

#[test]
fn a_verb_that_is_stopped_says_how_to_go_on() {
    let dir = releasing::rendered();
    // It waits as long as another run has the folder.
    let lock = l4d_data::store::FolderLock::take(&dir.path("stats")).unwrap();
    let mut command = dir.command("stats --profile tiny --out stats");
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_secs(1));
    let process = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &process]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    drop(lock);
    assert_eq!(std::os::unix::process::ExitStatusExt::signal(&output.status), Some(2));
    let run = Run::from(output);
    assert!(run.stderr.contains("warning: stopped; run the same command again"), "{run}");
}

/// Runs the binary where no file may be larger than 2 kB, which acts as a disk that is full.
fn cramped(dir: &Dir, line: &str) -> Run {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("trap '' XFSZ; ulimit -f 4; exec {} {line}", env!("CARGO_BIN_EXE_l4d"))]);
    command.current_dir(dir.path("")).output().unwrap().into()
}

#[test]
fn what_cannot_be_written_is_refused_with_file_and_hint() {
    let dir = releasing::rendered();
    cramped(&dir, "stats --profile tiny --out stats").refused(&["stats/", "cannot write"]);
    let line = format!("exec {} stats --profile tiny > /dev/full", env!("CARGO_BIN_EXE_l4d"));
    let full: Run = Command::new("sh").args(["-c", &line]).current_dir(dir.path("")).output().unwrap().into();
    full.refused(&["standard output: cannot write", "disk"]);
    dir.write("file", "");
    let long = "a".repeat(300);
    for out in ["file", "file/deeper", &long, &format!("there/{long}")] {
        for verb in ["stats --profile tiny --out", &format!("{} --out", releasing::MAKE)] {
            dir.refuses(format!("{verb} {out}"), &[out]);
        }
    }
    let dir = Dir::with_oracle();
    dir.write("scores/oracle/counts.csv/in the way", "");
    dir.refuses("score --profile tiny", &["counts.csv", "a folder is where a file is needed"]);
}

#[test]
fn results_of_others_are_never_taken_for_the_rest_of_an_import() {
    let dir = originals::folder();
    let line = "import mevis theirs --profile tiny";
    dir.succeed(line);
    let whole = dir.tree("results");
    dir.succeed(line);
    assert_eq!(dir.tree("results"), whole, "the same import once more");
    // An import that was killed leaves its claim, and the card comes last.
    let mask = "results/mevis/masks/tabletop_cups/003.json";
    for card in [true, false] {
        dir.write("results/mevis/.l4d-import", "");
        dir.edit(mask, "0000", "0001");
        if card {
            dir.remove("results/mevis/method.json");
        }
        dir.succeed(line);
        assert_eq!(dir.tree("results"), whole);
    }
    // Without one they are somebody's.
    dir.edit(mask, "0000", "0001");
    let theirs = dir.tree("results");
    dir.refuses(line, &["holds results already", "--force"]);
    dir.remove("results/mevis/method.json");
    dir.refuses(line, &["holds results already"]);
    assert_eq!(dir.read(mask).into_bytes(), theirs["mevis/masks/tabletop_cups/003.json"]);
    dir.succeed(format!("{line} --force"));
    assert_eq!(dir.tree("results"), whole);
}
