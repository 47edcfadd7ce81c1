//! What is said when something is wrong: commands that can be pasted, the name that was meant, one line a cause.

use std::fs;

use l4d_masks::{Mask, png};
use serde_json::json;

use crate::support::Dir;
use crate::world;

const MASKS: &str = "results/oracle/masks/room_discs";
const CARD: &str = "results/oracle/method.json";
const CHECK: &str = "check-results --profile tiny";

#[test]
fn commands_in_hints_have_the_folders_that_were_named() {
    let dir = Dir::with_benchmark();
    dir.rename("benchmark", "my set");
    dir.refuses(
        "train-splats room_discs --profile tiny --bench 'my set' --data pictures --work models",
        &["`l4d build-scenes --profile tiny --scenes room_discs --bench 'my set' --data pictures`"],
    );
    dir.refuses(
        "leaderboard --profile tiny --bench 'my set'",
        &["`l4d score --bench 'my set' --profile tiny`"],
    );
}

#[test]
fn the_name_that_was_meant_is_asked_about() {
    let dir = Dir::with_oracle();
    dir.refuses("score --profile tiny --scenes room_dics", &["did you mean `room_discs`?"]);
    dir.refuses("train-splats room_dics --profile tiny", &["did you mean `room_discs`?"]);
    world::write_scene(&dir.path("data"));
    let view = "view ball --profile tiny --data data --methods";
    dir.refuses(format!("{view} orakle"), &["did you mean `oracle`?"]);
    dir.refuses(format!("{view} nothing-like-it"), &["choose among oracle"]);
    dir.run("scores").says(2, &["similar", "score"]);
}

#[test]
fn a_scene_of_another_profile_is_named() {
    let dir = Dir::with_benchmark();
    world::write_scene(&dir.path("data/tiny"));
    dir.refuses(
        "train-splats ball",
        &["rendered at tiny: --profile tiny", "l4d build-scenes --profile small"],
    );
}

#[test]
fn half_a_render_is_said_to_be_one() {
    let dir = Dir::with_benchmark();
    world::write_scene(&dir.path("data"));
    world::write_tracks(&dir.path("data"));
    dir.remove("data/ball/scene.json");
    let view = "data/ball/frames/cam00";
    let pictures = fs::read_dir(dir.path(view)).unwrap().map(|entry| entry.unwrap().path());
    let pictures = pictures.filter(|path| path.extension().is_some_and(|end| end == "exr")).take(3);
    pictures.for_each(|path| fs::remove_file(path).unwrap());
    let check = dir.run("check-scenes --profile tiny --data data --scenes ball");
    let go_on = "`l4d build-scenes --profile tiny --scenes ball --data data`";
    check.says(1, &["L4D101", "the render was interrupted, and 3 of ", "pictures lack", go_on]);
}

#[test]
fn findings_of_one_cause_are_one_line() {
    let dir = Dir::with_oracle();
    dir.remove(&format!("{MASKS}/001.json"));
    for frame in (0..=96).step_by(12) {
        dir.write(&format!("{MASKS}/001/{frame:04}.png"), png::encode(&Mask::full(96, 128)));
    }
    let run = dir.run(CHECK);
    run.says(1, &["L4D309]: 9 times: ", "96x128", "001/0000.png", "and 6 more; --all lists each", "hint: "]);
    assert!(!run.stdout.contains("001/0048.png"), "{run}");
    assert!(run.stdout.lines().count() < 12, "{run}");
    let all = dir.run(format!("{CHECK} --all"));
    assert_eq!(all.stdout.matches("L4D309").count(), 9, "{all}");
    dir.run("score --profile tiny")
        .says(1, &["9 times", "`l4d check-results --all --profile tiny` lists each"]);
}

#[test]
fn all_that_is_wrong_with_a_card_is_said_at_once() {
    let dir = Dir::with_oracle();
    dir.change(CARD, |card| {
        card["seconds"] = json!("long");
        card["colour"] = json!(1);
        card.as_object_mut().unwrap().remove("protocol");
        card.as_object_mut().unwrap().remove("truth_digest");
    });
    let fields =
        ["field `seconds`", "field `colour`", "field `protocol`: ", "field `truth_digest`: ", "init-results"];
    dir.run(CHECK).says(1, &fields);
}

#[test]
fn exchanged_sides_are_recognised() {
    let dir = Dir::with_oracle();
    dir.edit(&format!("{MASKS}/001.json"), "[96,128]", "[128,96]");
    dir.run(CHECK).says(1, &["it is [width, height]: write [height, width], which is [96, 128]"]);
    let dir = Dir::with_oracle();
    dir.change(CARD, |card| (card["width"], card["height"]) = (json!(96), json!(128)));
    dir.run(CHECK).says(1, &["width and height are exchanged", "\"width\": 128, \"height\": 96"]);
}
