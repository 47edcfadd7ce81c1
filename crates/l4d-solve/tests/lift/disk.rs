//! Answers on disk.

use std::fs;
use std::path::{Path, PathBuf};

use l4d_masks::Mask;
use l4d_solve::lift::{ClosedSettings, FieldSettings, LiftSettings, Lifted};

use crate::fixture::{Scene, empty};

fn answers() -> Vec<Lifted> {
    let scene = Scene::new();
    let gated = |_: usize, frame: u32, mask: Mask| if frame > 48 { empty() } else { mask };
    let evidence = scene.evidence(2, gated);
    let field = FieldSettings { iterations: 2, width: 16, features: 4, ..FieldSettings::paper() };
    [LiftSettings::Closed(ClosedSettings::robust()), LiftSettings::Field(field)]
        .iter()
        .map(|settings| scene.lift(&evidence, settings).unwrap())
        .collect()
}

fn tensors(folder: &Path) -> PathBuf {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> =
        names.filter(|path| path.extension().is_some_and(|ending| ending == "safetensors")).collect();
    assert_eq!(found.len(), 1, "one file of tensors");
    found.remove(0)
}

#[test]
fn answers_come_back_as_they_were_and_replace_each_other() {
    let folder = tempfile::tempdir().unwrap();
    for lifted in answers() {
        lifted.write(folder.path()).unwrap();
        assert_eq!(Lifted::read(folder.path()).unwrap(), lifted);
        let bytes = fs::read(tensors(folder.path())).unwrap();
        lifted.write(folder.path()).unwrap();
        assert_eq!(fs::read(tensors(folder.path())).unwrap(), bytes);
    }
}

#[test]
fn damaged_answers_are_refused() {
    for lifted in answers() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Lifted::read(folder.path()).is_err());
        lifted.write(folder.path()).unwrap();
        let (card_path, tensors_path) = (folder.path().join("lift.json"), tensors(folder.path()));
        let (card, bytes) = (fs::read_to_string(&card_path).unwrap(), fs::read(&tensors_path).unwrap());

        let mut flipped = bytes.clone();
        *flipped.last_mut().unwrap() ^= 1;
        for broken in [&bytes[..bytes.len() / 2], &flipped, &[][..]] {
            fs::write(&tensors_path, broken).unwrap();
            assert!(Lifted::read(folder.path()).unwrap_err().to_string().contains("digest"));
        }
        fs::write(&tensors_path, &bytes).unwrap();

        for (from, to) in [
            ("l4d/lift/1", "l4d/lift/9"),
            ("lift-", "../lift-"),
            ("\"gaussians\": 400", "\"gaussians\": 4000000000000"),
            ("\"gaussians\": 400", "\"gaussians\": 0"),
            ("\"states\": 2", "\"states\": 99999999999999"),
            ("\"times\": 5", "\"times\": 6"),
            ("\"width\": 16", "\"width\": 4000"),
            ("\"width\": 16", "\"width\": 0"),
            ("\"schema\"", "\"unknown\""),
        ] {
            if card.contains(from) {
                fs::write(&card_path, card.replace(from, to)).unwrap();
                let read = Lifted::read(folder.path());
                let is_field = card.contains("\"width\"");
                // A field has no list of Gaussians; that it is another model's is found where it meets one.
                assert!(read.is_err() || (is_field && from.contains("gaussians")), "{from} -> {to}");
            }
        }
        fs::write(&card_path, &card).unwrap();
        assert_eq!(Lifted::read(folder.path()).unwrap(), lifted);
    }
}
