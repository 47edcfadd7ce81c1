//! Parts of scenes that cannot be rendered are refused before Blender is looked for.

use crate::support::{Run, l4d};

const BUILD: &str = "build-scenes --profile tiny --scenes tabletop_mouse_cups --python /nonexistent/python";

fn refused(more: &str, words: &[&str]) {
    let run = Run::from(l4d(&format!("{BUILD} {more}")).output().unwrap());
    assert_eq!(run.code, 2, "{run}");
    for word in words {
        assert!(run.stderr.contains(word), "no `{word}` in\n{run}");
    }
}

#[test]
fn views_and_frames_that_are_not_there_are_refused_with_those_that_are() {
    // cam01 is a camera of the scene that `tiny` leaves out.
    let views = ["tabletop_mouse_cups has no view `cam01` at tiny", "hint: choose among cam00, "];
    refused("--views cam00,cam01", &views);
    refused("--views cam99 --shard 1/2", &["has no view `cam99`", "cam16"]);
    refused("--frames 13,24", &["tiny renders no frame of `13-13:1`", "hint: its frames are 0-96:12"]);
    for wrong in ["24-12", "0-97", "0-24:0", "all", "0,,12"] {
        refused(&format!("--frames {wrong}"), &["are no frames of 0 to 96: write 12, 0-24 or 0-48:4"]);
    }
    refused("--frames 0 --tracks-only", &["--frames does not apply beside --tracks-only"]);
    // What is there gets as far as the interpreter.
    refused("--views cam00 --frames 0-48:4 --shard 1/2", &["/nonexistent/python: cannot run"]);
}
