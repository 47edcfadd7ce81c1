//! Files of every kind, damaged at random: each verb that reads them ends by itself, with an exit code that it has, and an
//! error says what to do.

use std::fmt::Write as _;
use std::thread;

use super::bounded_line;
use crate::support::{Dir, Noise, root};
use crate::{foreign, interop, real_scenes, releasing, solving};

/// A folder, and what reads its files there.
struct Stage {
    make: fn() -> Dir,
    lines: &'static [&'static str],
}

static STAGES: [Stage; 9] = [
    Stage {
        make: Dir::with_oracle,
        lines: &[
            "check-results --profile tiny",
            "score --profile tiny",
            "score --profile tiny --protocol davis",
        ],
    },
    Stage { make: scored, lines: &["leaderboard --profile tiny"] },
    Stage { make: written, lines: &["check-queries --profile tiny", "stats --profile tiny"] },
    Stage {
        make: releasing::rendered,
        lines: &[
            "check-scenes --profile tiny",
            "release --date 2026-11-22 --url https://example.org/two --profile tiny",
        ],
    },
    Stage {
        make: interop::folder,
        lines: &[
            "export wall --profile tiny --format colmap --out out",
            "export wall --profile tiny --format 4dgaussians --out out",
        ],
    },
    Stage { make: interop::shelf, lines: &[interop::IMPORT] },
    Stage {
        make: solving::world,
        lines: &[
            "solve --profile tiny --data data --grounder oracle --scenes ball",
            "render-splats ball --profile tiny --data data --out clips --frames 0",
        ],
    },
    Stage {
        make: foreign::folder,
        lines: &[
            "render-splats wall --profile tiny --splats output/panoptic --views cam01 --frames 0 --out clips",
        ],
    },
    Stage { make: real_scenes::authored, lines: &["check-queries --profile real"] },
];

fn scored() -> Dir {
    let dir = Dir::with_baselines();
    dir.succeed("score --profile tiny");
    dir
}

/// A shipped scene with everything that its queries are proved from.
fn written() -> Dir {
    let files = ["scenes/{}.json", "truth/tiny/{}.json", "queries/{}.jsonl", "queries/{}.composite.jsonl"];
    Dir::with_shipped("Cups", &["tabletop_mouse_cups"], &files)
}

/// What a number becomes, and other bytes that readers may stumble over.
const NUMBERS: [&str; 8] = ["NaN", "1e999", "-1", "99999999999999999999", "0", "null", "[]", "\"x\""];
const BYTES: [&[u8]; 6] = [b"\0", b"\xff\xfe", b"\"", b"{", b"\n", "\u{202e}".as_bytes()];

/// One way to damage a file.
fn damaged(bytes: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let place = |noise: &mut Noise, length: usize| noise.below(length.max(1) as u32) as usize;
    let at = place(noise, bytes.len());
    let end = (at + 1 + place(noise, 64)).min(bytes.len());
    match noise.below(8) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at.min(end)..end)),
        2 => bytes.splice(at..at, bytes[at..end].to_vec()).for_each(drop),
        3 => bytes.splice(at..at, BYTES[place(noise, BYTES.len())].iter().copied()).for_each(drop),
        4 | 5 => {
            for _ in 0..=noise.below(4) {
                let at = place(noise, bytes.len());
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << noise.below(8);
                }
            }
        }
        _ => {
            let is_digit = |byte: &u8| byte.is_ascii_digit();
            if let Some(first) = bytes[at..].iter().position(is_digit).map(|first| at + first) {
                let length = bytes[first..].iter().take_while(|byte| is_digit(byte)).count();
                let other = NUMBERS[place(noise, NUMBERS.len())].bytes();
                bytes.splice(first..first + length, other).for_each(drop);
            }
        }
    }
    bytes
}

/// What is wrong with how a verb took a damaged file; none if nothing is.
fn problem(stage: &Dir, line: &str, file: &str, noise: &mut Noise) -> Option<String> {
    let dir = stage.copy();
    let bytes = damaged(&stage.bytes(file), noise);
    dir.write(file, &bytes);
    let run = bounded_line(&dir, line);
    let is_sound = match run.code {
        0 | 1 => true,
        2 => run.stderr.contains("hint: "),
        _ => false,
    };
    (!is_sound || run.stderr.contains("panicked")).then(|| {
        let kept = format!("{}-{}", line.split(' ').next().unwrap_or_default(), file.replace('/', "-"));
        let folder = root().join("target/tmp/mutations");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(&kept), &bytes).unwrap();
        format!("{line}, {file} (kept as {kept}): {run}")
    })
}

/// Damages so many files, every verb's in turn; two processes at once.
fn mutate(count: u32, seed: u64) {
    let share = |worker: u64| {
        let mut noise = Noise::new(seed + worker);
        let stages: Vec<(Dir, Vec<String>)> = STAGES
            .iter()
            .map(|stage| {
                let dir = (stage.make)();
                let files = dir.tree("").into_iter().filter(|(_, bytes)| !bytes.is_empty());
                let files = files.map(|(name, _)| name).collect();
                (dir, files)
            })
            .collect();
        let mut problems = Vec::new();
        for number in 0..count / 2 {
            let place = number as usize % STAGES.len();
            let ((dir, files), lines) = (&stages[place], STAGES[place].lines);
            let line = lines[noise.below(lines.len() as u32) as usize];
            let file = &files[noise.below(files.len() as u32) as usize];
            problems.extend(problem(dir, line, file, &mut noise));
        }
        problems
    };
    let problems: Vec<String> = thread::scope(|scope| {
        let workers = [0, 1].map(|worker| scope.spawn(move || share(worker)));
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    let mut said = String::new();
    for problem in problems.iter().take(20) {
        writeln!(said, "{problem}\n").unwrap();
    }
    assert!(problems.is_empty(), "{} of {count}\n{said}", problems.len());
}

#[test]
fn sixty_damaged_files_are_taken_or_refused() {
    mutate(60, 1);
}

#[test]
#[ignore = "slow: 20 000 runs"]
fn twenty_thousand_damaged_files_are_taken_or_refused() {
    mutate(20_000, 2);
}
