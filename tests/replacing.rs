//! No verb replaces a file that it did not write: somebody's file stands under each of the names that a verb uses, before
//! its first run and after it. And two runs at once do not mix what they write.

use std::thread;

use crate::kills::{VERBS, Verb, verb};
use crate::support::{Dir, Run, l4d, manifest, root};
use crate::{interop, real_scenes, solving};

const MINE: &[u8] = b"mine\n";
/// Of the many files that a slow verb writes.
const FEW: usize = 5;

/// Verbs that are not among those that are killed.
static MORE: [Verb; 5] = [
    verb("sheet", interop::folder, "sheet wall --profile tiny --views cam00 --out drawn/wall.png"),
    verb(
        "query",
        solving::world,
        "query ball 'The ball that rolls' --profile tiny --data data --grounder oracle --out asked",
    ),
    verb("import-scene, to be asked about", real_scenes::captured, real_scenes::IMPORT),
    verb("score --protocol", Dir::with_oracle, "score --profile tiny --protocol davis"),
    verb("leaderboard", crate::kills::scored, "leaderboard --profile tiny"),
];

/// Those whose files the user can name: what somebody changed after a run stays, too.
const NAMED_BY_USERS: [&str; 7] =
    ["score", "score --protocol", "leaderboard", "stats", "sheet", "query", "open-round"];

/// Runs a verb with somebody's file in the place of each one that it writes; the names that are lost.
fn lost(verb: &Verb, most: usize) -> Vec<String> {
    let stage = (verb.stage)();
    let calm = stage.copy();
    calm.succeed(verb.line);
    let before = stage.tree("");
    let is_hidden = |name: &str| name.rsplit('/').next().is_some_and(|file| file.starts_with('.'));
    // A file that is called by its own digest is no one else's.
    let is_meant = |name: &String| !is_hidden(name) && !name.ends_with(".safetensors");
    let mut written: Vec<String> = calm.tree("").into_keys().filter(is_meant).collect();
    written.retain(|name| !before.contains_key(name));
    assert!(!written.is_empty(), "{} writes nothing", verb.name);
    let step = written.len().div_ceil(most);
    let mut lost = Vec::new();
    for name in written.iter().step_by(step) {
        let mut stages = vec![stage.copy()];
        if NAMED_BY_USERS.contains(&verb.name) {
            stages.push(calm.copy());
        }
        for (time, dir) in ["first", "second"].into_iter().zip(stages) {
            dir.write(name, MINE);
            let run = dir.run(verb.line);
            if dir.bytes(name) != MINE {
                lost.push(format!("{}, {time} run: {name}: {}", verb.name, run.stderr));
            }
        }
    }
    lost
}

#[test]
fn no_quick_verb_replaces_a_file_that_it_did_not_write() {
    let verbs = VERBS.iter().filter(|verb| verb.is_quick).chain(&MORE[2..4]).chain([&MORE[0]]);
    let lost: Vec<String> = verbs.flat_map(|verb| lost(verb, FEW)).collect();
    assert!(lost.is_empty(), "{}", lost.join("\n"));
}

#[test]
fn no_board_or_answer_replaces_a_file_that_it_did_not_write() {
    let lost: Vec<String> = [&MORE[1], &MORE[4]].into_iter().flat_map(|verb| lost(verb, FEW)).collect();
    assert!(lost.is_empty(), "{}", lost.join("\n"));
}

#[test]
#[ignore = "slow: every verb with a file of somebody under each name that it uses"]
fn no_verb_replaces_a_file_that_it_did_not_write() {
    let lost: Vec<String> = VERBS.iter().chain(&MORE).flat_map(|verb| lost(verb, 100)).collect();
    assert!(lost.is_empty(), "{}", lost.join("\n"));
}

#[test]
fn with_force_files_of_others_are_replaced() {
    for name in ["score", "stats"] {
        let verb = VERBS.iter().find(|verb| verb.name == name).unwrap();
        let (dir, calm) = ((verb.stage)(), (verb.stage)());
        calm.succeed(verb.line);
        let file = if name == "score" { "scores/oracle/counts.csv" } else { "stats/words.csv" };
        dir.write(file, MINE);
        dir.refuses(verb.line, &[file, "was not written by l4d", "--force"]);
        dir.succeed(format!("{} --force", verb.line));
        assert_eq!(dir.bytes(file), calm.bytes(file));
        dir.succeed(verb.line);
    }
}

#[test]
fn a_refused_leaderboard_leaves_the_folder_as_it_was() {
    let dir = crate::kills::scored();
    dir.write("leaderboard/index.html", MINE);
    dir.refuses("leaderboard --profile tiny --html", &["leaderboard/index.html"]);
    assert_eq!(dir.tree("leaderboard").len(), 1);
    // Names that are not used do not matter.
    dir.succeed("leaderboard --profile tiny");
    assert_eq!(dir.bytes("leaderboard/index.html"), MINE);
}

#[test]
fn what_an_earlier_version_wrote_is_replaced() {
    let dir = crate::kills::scored();
    dir.succeed("leaderboard --profile tiny");
    for folder in ["scores/oracle", "leaderboard"] {
        dir.remove(&format!("{folder}/.l4d-written"));
    }
    dir.succeed("score --profile tiny");
    dir.succeed("leaderboard --profile tiny");
}

#[test]
fn a_quickstart_takes_no_folder_of_others() {
    let dir = Dir::new();
    dir.write("benchmark/panoptic-l4d.toml", manifest("Mine", &["a", "b"]));
    dir.write("results/oracle/method.json", MINE);
    let before = dir.tree("");
    let bench = root().join("benchmark").display().to_string();
    let refuse = |run: Run| run.refused(&["is not of a quickstart", "`benchmark` is there", "--out"]);
    let mut command = l4d(&format!("quickstart --bench {bench} --out"));
    refuse(command.arg(dir.path("")).output().unwrap().into());
    assert_eq!(dir.tree(""), before);
    // A picture that l4d drew into a checkout makes no quickstart of it.
    dir.write(".l4d-written", "unfinished  sheet.png\n");
    refuse(command.output().unwrap().into());
}

#[test]
fn a_quickstart_goes_on_in_its_own_folder_alone() {
    let dir = Dir::new();
    let bench = root().join("benchmark").display().to_string();
    // There is no Python: it stops after it has taken the folder.
    let line = format!("quickstart --bench {bench} --out first --python missing --blender-scripts missing");
    for _ in 0..2 {
        let run = dir.run(&line);
        assert!(run.code != 0 && !run.stderr.contains("not of a quickstart"), "{run}");
    }
    let theirs = manifest("Mine", &["a", "b"]);
    dir.write("first/benchmark/panoptic-l4d.toml", &theirs);
    dir.refuses(&line, &["panoptic-l4d.toml", "was not written by l4d"]);
    assert_eq!(dir.read("first/benchmark/panoptic-l4d.toml"), theirs);
}

#[test]
fn masks_are_added_and_replaced_only_by_force() {
    let dir = real_scenes::captured();
    dir.succeed(real_scenes::IMPORT);
    let line = format!("{} --masks-only --out data/captures/table", real_scenes::IMPORT);
    dir.succeed(&line);
    let before = dir.tree("");
    dir.edit("drawn.json", "red", "rot");
    dir.refuses(&line, &["masks.json", "other content", "--force"]);
    dir.write("drawn.json", &before["drawn.json"]);
    assert_eq!(dir.tree(""), before);

    let truth = "captures/truth/real/table.json";
    dir.change(truth, |truth| truth["scale"] = "room".into());
    dir.refuses(&line, &[truth, "--force"]);
    assert!(dir.read(truth).contains("room"));
    dir.edit("drawn.json", "red", "rot");
    dir.succeed(format!("{line} --force"));
    assert!(dir.read(truth).contains("tabletop") && dir.read(truth).contains("rot"));
    assert!(dir.read("data/captures/table/masks.json").contains("rot"));
}

#[test]
fn of_two_rounds_opened_at_once_one_is_there() {
    let stage = crate::annotation::bench();
    let lines = ["1", "2"].map(|seed| format!("{} --seed {seed}", crate::annotation::OPEN));
    for _ in 0..10 {
        let dir = stage.copy();
        let runs: Vec<Run> = thread::scope(|scope| {
            let dir = &dir;
            let started = lines.each_ref().map(|line| scope.spawn(move || dir.run(line)));
            started.into_iter().map(|run| run.join().unwrap()).collect()
        });
        let (won, lost): (Vec<&Run>, Vec<&Run>) = runs.iter().partition(|run| run.code == 0);
        assert_eq!((won.len(), lost.len()), (1, 1), "{}{}", runs[0], runs[1]);
        lost[0].refused(&["there is such a round already"]);
        let place = runs.iter().position(|run| run.code == 0).unwrap();
        let calm = stage.copy();
        calm.succeed(&lines[place]);
        assert_eq!(dir.tree("annotation"), calm.tree("annotation"));
    }
}
