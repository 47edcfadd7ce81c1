//! End-to-end tests: the binary, run as its users run it.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop there")]

mod ablating;
mod annotation;
mod annotation_tui;
mod architecture;
mod blender;
mod blind;
mod codes;
mod endpoint;
mod foreign;
mod hostile;
mod hosting;
mod interop;
mod kills;
mod leaderboard;
mod model_grounder;
mod originals;
mod page;
mod proposing;
mod protocols;
mod python;
mod queries;
mod real_scenes;
mod real_solving;
mod releasing;
mod replacing;
mod results;
mod runner;
mod score;
mod solving;
mod splats;
mod splats_render;
mod support;
mod unchanged;
mod words;
mod world;
