"""What the optimisation levels of dependencies (Cargo.toml) cost at run time: two binaries, verb by verb, in turn.

    cargo build --release                                # with the profile of Cargo.toml
    cargo build --release --target-dir work/optimised    # after deleting [profile.release.package]
    python3 perf/build_profile.py --before work/optimised/release/l4d --after target/release/l4d \\
        --data data/tiny --scene tabletop_tea

Prints one JSON object a verb: the least processor seconds of each binary, and their ratio. The binaries take turns, so
that a busy machine slows both. `leaderboard` ranks 50 made-up methods; `train-splats` learns for a short while.
Compile times themselves are what `cargo build --release --timings` says.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import board

ROOT = Path(__file__).resolve().parents[1]
METHODS = 50


def processor_seconds(command: list, folder: Path) -> float:
    before = board.processor_seconds()
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return board.processor_seconds() - before


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--before", type=Path, required=True)
    parser.add_argument("--after", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=Path("data/tiny"))
    parser.add_argument("--scene", default="tabletop_tea")
    parser.add_argument("--repeat", type=int, default=5)
    options = parser.parse_args()
    binaries = {"before": options.before.resolve(), "after": options.after.resolve()}
    bench = ["--bench", str(ROOT / "benchmark"), "--profile"]
    train = ["train-splats", options.scene, "--data", str(options.data.resolve()), *bench, "tiny"]
    verbs = {
        "start": ["--version"],
        "check-queries": ["check-queries", "--bench", str(ROOT / "benchmark")],
        "score": ["score", "results", "--scores", "again", *bench, "small"],
        "leaderboard": ["leaderboard", "scores", *bench, "small"],
        "leaderboard --html": ["leaderboard", "scores", "--html", *bench, "small"],
        "train-splats": [*train, "--coarse", "100", "--fine", "200", "--force"],
    }
    with tempfile.TemporaryDirectory() as root:
        folder = Path(root)
        subprocess.run([binaries["before"], "-q", "baseline", *bench, "small"], cwd=folder, check=True)
        subprocess.run([binaries["before"], "-q", "score", *bench, "small"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        board.make_methods(folder / "scores", METHODS)
        for verb, arguments in verbs.items():
            found = {name: [] for name in binaries}
            for _ in range(options.repeat):
                for name, binary in binaries.items():
                    found[name].append(processor_seconds([binary, "-q", *arguments], folder))
            best = {name: round(min(seconds), 4) for name, seconds in found.items()}
            print(json.dumps({"verb": verb, **best, "ratio": round(best["after"] / best["before"], 3)}), flush=True)


if __name__ == "__main__":
    main()
