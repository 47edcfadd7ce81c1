//! The other side of `perf/python_frames.py`: reads frames again and again, as the Rust reader gives them.
//!
//! ```text
//! read_frames <scene> <view> <frame> <repeats>
//! ```
//!
//! Waits for a line on stdin before each round of reads, and answers with the median seconds of a read.

use std::io::{BufRead as _, Write as _};
use std::time::Instant;

use glam::UVec2;
use l4d_data::Rig;
use l4d_data::layout::SceneDir;
use l4d_frames::exr::read_frame;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, view, frame, repeats] = arguments.as_slice() else {
        return Err("usage: read_frames SCENE VIEW FRAME REPEATS".into());
    };
    let path = std::path::Path::new(scene);
    let folder = path.file_name().and_then(|name| name.to_str()).ok_or("the scene has no name")?;
    let dir = SceneDir::new(path.parent().unwrap_or(path), folder);
    let size = UVec2::from_array(Rig::read(&dir.scene())?.size());
    let path = dir.frame(view, frame.parse()?);
    let repeats: usize = repeats.parse()?;
    for line in std::io::stdin().lock().lines() {
        line?;
        let mut seconds = Vec::with_capacity(repeats);
        for _ in 0..repeats {
            let start = Instant::now();
            std::hint::black_box(read_frame(&path, size)?);
            seconds.push(start.elapsed().as_secs_f64());
        }
        seconds.sort_by(f64::total_cmp);
        let mut out = std::io::stdout().lock();
        writeln!(out, "{}", seconds[repeats / 2])?;
        out.flush()?;
    }
    Ok(())
}
