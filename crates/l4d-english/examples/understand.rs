//! Reads sentences from standard input with the words of a scene:
//! `cargo run -p l4d-english --example understand -- benchmark/dev/scenes/room_0506.json`.

use std::io::{BufRead as _, Write as _};

use l4d_data::tracks::Tracks;
use l4d_english::{Words, understand};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name a file of benchmark/*/scenes")?;
    let tracks: Tracks = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let words = Words::of(&tracks);
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        writeln!(out, "{line}")?;
        match understand(&line, &words) {
            Ok(readings) => {
                for reading in readings {
                    let note = reading.note().unwrap_or_default();
                    let (confidence, predicate) = (reading.confidence, &reading.predicate);
                    writeln!(out, "    {confidence:.2} {predicate} {:?} {note}", reading.temporal)?;
                }
            }
            Err(unread) => writeln!(out, "    {unread}")?,
        }
    }
    Ok(())
}
