//! Reads sentences from standard input with the words of a scene: `cargo run -p l4d-english --example understand -- benchmark/dev/scenes/room_0506.json`.

use std::io::BufRead as _;

use l4d_data::tracks::Tracks;
use l4d_english::{Words, understand};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name a file of benchmark/*/scenes")?;
    let tracks: Tracks = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let words = Words::of(&tracks);
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        println!("{line}");
        match understand(&line, &words) {
            Ok(readings) => {
                for reading in readings.iter().take(2) {
                    let note = reading.note().unwrap_or_default();
                    println!("    {:.2} {} {:?} {note}", reading.confidence, reading.predicate, reading.temporal);
                }
            }
            Err(unread) => println!("    {unread}"),
        }
    }
    Ok(())
}
