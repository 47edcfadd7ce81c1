use std::fs;

use l4d_masks::Rle;

use super::*;
use crate::testing::{asked_from, blank_clip, question};

const FRAMES: [u32; 3] = [0, 12, 24];

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A file of query `yard/001`.
    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.0.path().join("yard/001").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    fn files(&self) -> Files {
        Files::open(self.0.path(), Name::new("yard").unwrap()).unwrap()
    }

    fn ask(&self) -> Grounding {
        self.files().ground(&blank_clip("cam01", 6, 4, &FRAMES), &question("yard", "001"))
    }

    /// What is said of a view that cannot be answered.
    fn complaint(&self) -> String {
        match self.ask() {
            Grounding { outcome: Outcome::Error(why), masks, .. } if masks.is_empty() => why,
            other => panic!("answered {other:?}"),
        }
    }
}

fn corner() -> Mask {
    Mask::from_fn(6, 4, |col, row| col < 2 && row == 0)
}

fn json_of(frames: &[(&str, Option<Rle>)]) -> String {
    let frames = frames.iter().map(|(key, counts)| ((*key).to_owned(), counts.clone())).collect();
    serde_json::to_string(&MaskFile { size: [4, 6], frames }).unwrap()
}

#[test]
fn json_and_pngs_say_the_same() {
    let json = Folder::new();
    let (seen, unseen) = (Some(corner().to_rle()), Some(Mask::empty(6, 4).to_rle()));
    json.put("cam01.json", json_of(&[("0000", seen), ("0012", None), ("0024", unseen), ("0036", None)]));
    let pngs = Folder::new();
    for (frame, mask) in [("0000", corner()), ("0012", Mask::empty(6, 4)), ("0024", Mask::empty(6, 4))] {
        pngs.put(&format!("cam01/{frame}.png"), png::encode(&mask));
    }
    for grounding in [json.ask(), pngs.ask()] {
        assert_eq!(grounding.outcome, Outcome::Found);
        assert_eq!(grounding.masks[&0], corner());
        assert_eq!(grounding.masks.keys().copied().collect::<Vec<_>>(), FRAMES);
        assert!(grounding.masks[&12].is_empty() && grounding.masks[&24].is_empty());
    }
    assert!(!json.files().uses_truth());
}

#[test]
fn what_is_missing_is_named() {
    let folder = Folder::new();
    let why = folder.complaint();
    assert!(why.contains("yard/001/cam01.json") && why.contains("folder cam01"), "{why}");
    folder.put("cam01.json", json_of(&[("0000", None), ("24", None)]));
    assert!(folder.complaint().contains("frame `0012`: is missing"), "{}", folder.complaint());
    folder.put("cam01/0000.png", png::encode(&corner()));
    assert!(folder.complaint().contains("beside the folder cam01"));
    let pngs = Folder::new();
    pngs.put("cam01/0000.png", png::encode(&corner()));
    assert!(pngs.complaint().contains("cam01/0012.png"), "{}", pngs.complaint());
}

#[test]
fn a_wrong_size_names_both() {
    for (name, bytes, found) in [
        ("cam01.json", br#"{"size":[96,128],"frames":{}}"#.to_vec(), "128x96"),
        ("cam01/0000.png", png::encode(&Mask::empty(5, 4)), "5x4"),
    ] {
        let folder = Folder::new();
        folder.put(name, bytes);
        let why = folder.complaint();
        assert!(why.contains(found) && why.contains("6x4") && why.contains("size of the clip"), "{why}");
    }
}

#[test]
fn hostile_files_are_complaints() {
    let good = corner().to_rle().counts().repeat(1000);
    for text in [
        String::new(),
        "[".repeat(100_000),
        r#"{"size":[4,6],"frames":{"0000":"oooooooooooo"}}"#.to_owned(),
        r#"{"size":[4,6],"frames":{"0000":"0"}}"#.to_owned(),
        r#"{"size":[4294967295,4294967295],"frames":{}}"#.to_owned(),
        r#"{"size":[4,6],"frames":{},"more":1}"#.to_owned(),
        format!(r#"{{"size":[4,6],"frames":{{"0000":"{good}"}}}}"#),
    ] {
        let folder = Folder::new();
        folder.put("cam01.json", text);
        folder.complaint();
    }
    let whole = png::encode(&corner());
    for length in 0..whole.len() {
        let folder = Folder::new();
        folder.put("cam01/0000.png", &whole[..length]);
        folder.complaint();
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_is_no_file_and_nothing_waits_for_it() {
    let folder = Folder::new();
    folder.put("note.txt", "");
    let pipe = folder.0.path().join("yard/001/cam01.json");
    assert!(std::process::Command::new("mkfifo").arg(pipe).status().unwrap().success());
    assert!(folder.complaint().contains("is not there"));
}

#[test]
fn only_frames_that_are_asked_about_are_needed_and_shown() {
    let folder = Folder::new();
    let seen = Some(corner().to_rle());
    folder.put("cam01.json", json_of(&[("0012", seen.clone()), ("0024", seen)]));
    let clip = blank_clip("cam01", 6, 4, &FRAMES);
    let grounding = folder.files().ground(&clip, &asked_from(question("yard", "001"), 13, 96));
    assert!(grounding.masks[&0].is_empty() && grounding.masks[&12].is_empty());
    assert_eq!(grounding.masks[&24], corner());
}

#[test]
fn other_scenes_and_own_sentences_are_refused() {
    let own = Question { number: None, ..question("yard", "001") };
    for (asked, words) in [(question("barn", "001"), "of yard, not of barn"), (own, "this sentence has none")]
    {
        let outcome = Folder::new().files().ground(&blank_clip("cam01", 6, 4, &FRAMES), &asked).outcome;
        assert!(matches!(&outcome, Outcome::Error(why) if why.contains(words)), "{outcome:?}");
    }
}

#[test]
fn other_masks_are_another_identity_and_nothing_in_any_frame_is_absent() {
    let folder = Folder::new();
    let none = folder.files().identity();
    folder.put("cam01.json", json_of(&[]));
    let one = folder.files().identity();
    folder.put("cam01.json", json_of(&[("0000", None), ("0012", None), ("0024", None)]));
    let changed = folder.files().identity();
    assert!(none != one && one != changed);
    assert_eq!(changed, folder.files().identity());
    let Grounding { outcome, masks, .. } = folder.ask();
    assert_eq!((outcome, masks.len()), (Outcome::Absent, 3));
}
