//! Milliseconds that one core needs to look at a picture of 256x192, for one or more folders of weights in turn:
//! `cargo run --release -p l4d-network --example look_time -- [WEIGHTS...]`. Without arguments, the shipped weights.

#![allow(clippy::print_stdout)]

use std::time::Instant;

use l4d_network::{Network, Picture};

const ROUNDS: usize = 15;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folders: Vec<String> = std::env::args().skip(1).collect();
    let mut networks = vec![];
    for folder in &folders {
        let description = std::fs::read_to_string(format!("{folder}/perception.json"))?;
        networks.push((
            folder.as_str(),
            Network::load(std::fs::read(format!("{folder}/perception.onnx"))?, &description)?,
        ));
    }
    if networks.is_empty() {
        networks.push(("shipped", Network::shipped()?));
    }
    let wave = |at: usize| 0.5 + 0.5 * (at as f32 * 0.37).sin();
    let picture = Picture { width: 256, height: 192, colour: (0..256 * 192 * 3).map(wave).collect() };
    let mut times = vec![vec![]; networks.len()];
    for _ in 0..ROUNDS {
        for ((_, network), times) in networks.iter().zip(&mut times) {
            let begin = Instant::now();
            network.look(&picture)?;
            times.push(begin.elapsed().as_secs_f64() * 1000.0);
        }
    }
    for ((name, _), times) in networks.iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        println!("{name}: {:.1} ms least, {:.1} ms median of {ROUNDS}", times[0], times[ROUNDS / 2]);
    }
    Ok(())
}
