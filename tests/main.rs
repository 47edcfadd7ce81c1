//! End-to-end tests: the binary, run as its users run it.

mod architecture;
mod blender;
mod leaderboard;
mod results;
mod score;
mod support;
