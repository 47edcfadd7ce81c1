//! Reads and decodes all PNG masks of a results folder and does nothing with them: the floor that
//! `perf/score.py` compares `l4d score` with.
//!
//!     decode_masks results/method

use std::io::Write as _;
use std::path::{Path, PathBuf};

use l4d_data::store::{list_folder, read_bounded};
use l4d_masks::png;
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = PathBuf::from(std::env::args_os().nth(1).ok_or("name a folder of results")?);
    let masks = root.join("masks");
    let mut queries = Vec::new();
    for scene in list_folder(&masks)? {
        let scene = masks.join(scene);
        queries.extend(list_folder(&scene)?.into_iter().map(|query| scene.join(query)));
    }
    let decoded: Result<Vec<(usize, u64)>, String> = queries.par_iter().map(|query| decode(query)).collect();
    let (count, area) = decoded?.into_iter().fold((0, 0), |sum, query| (sum.0 + query.0, sum.1 + query.1));
    writeln!(std::io::stdout(), "{count} masks, {area} pixels")?;
    Ok(())
}

fn decode(folder: &Path) -> Result<(usize, u64), String> {
    let names = list_folder(folder).map_err(|error| error.to_string())?;
    let mut area = 0;
    for name in &names {
        let path = folder.join(name);
        let bytes = read_bounded(&path, 4 << 20).map_err(|error| error.to_string())?;
        let mask = png::decode_any(&bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        area += mask.area();
    }
    Ok((names.len(), area))
}
