//! What fuzzing found worth keeping, run again: nothing of it panics.

use std::fs;
use std::path::Path;

use l4d_fuzz::TARGETS;

#[test]
fn the_corpora_are_read_without_a_panic() {
    for (name, target) in TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
        let mut paths: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        assert!(paths.len() >= 5, "{} has {} files", folder.display(), paths.len());
        for path in paths {
            // The name is what is seen of an input that panics.
            println!("{}", path.display());
            target(&fs::read(&path).unwrap());
        }
    }
}
