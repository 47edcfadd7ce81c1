"""Speed of a frame through the Python package against the Rust reader alone, as a ratio in one run.

    cargo build --release -p l4d-py && cargo build --release -p l4d-py --example read_frames
    python perf/python_frames.py data/small/tabletop_tea

Needs numpy. Both sides read the same frame from the same file again and again, in rounds that take turns; a round's number
is its median, and the ratio is that of the medians over rounds. The Python side gives float32 light, depth and ids as
arrays, the Rust side what its reader gives (light as half floats). Target: at most 1.2. Frames without colours
(`l4d build-scenes --samples 0`) are the hardest: there is least to decode.
"""

import argparse
import json
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def load(library: Path, folder: Path):
    """The package with the library that cargo built."""
    shutil.copytree(ROOT / "crates/l4d-py/python/l4d", folder / "l4d")
    shutil.copy(library, folder / "l4d/_native.abi3.so")
    sys.path.insert(0, str(folder))
    import l4d

    return l4d


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--frame", type=int, default=48)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--repeats", type=int, default=40)
    parser.add_argument("--target", type=Path, default=ROOT / "target", help="target folder of cargo")
    arguments = parser.parse_args()
    release = arguments.target / "release"
    with tempfile.TemporaryDirectory() as folder:
        l4d = load(release / "libl4d_py.so", Path(folder))
        scene = l4d.Scene(arguments.scene)
        view = scene.training_cameras[0].name

        def python_round() -> float:
            seconds = []
            for _ in range(arguments.repeats):
                start = time.perf_counter()
                scene.frame(view, arguments.frame)
                seconds.append(time.perf_counter() - start)
            return statistics.median(seconds)

        command = [release / "examples/read_frames", arguments.scene, view, arguments.frame, arguments.repeats]
        rust = subprocess.Popen(list(map(str, command)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

        def rust_round() -> float:
            rust.stdin.write("\n")
            rust.stdin.flush()
            return float(rust.stdout.readline())

        python_round(), rust_round()
        rounds = [(rust_round(), python_round()) for _ in range(arguments.rounds)]
        rust.stdin.close()
        rust.wait()
    rust_s, python_s = (statistics.median(side) for side in zip(*rounds, strict=True))
    print(
        json.dumps(
            {
                "scene": arguments.scene.name,
                "profile": scene.profile,
                "size": [scene.width, scene.height],
                "rust_ms": round(rust_s * 1e3, 3),
                "python_ms": round(python_s * 1e3, 3),
                "ratio": round(python_s / rust_s, 3),
                "ratio_of_rounds": [round(python / rust, 3) for rust, python in rounds],
            }
        )
    )


if __name__ == "__main__":
    main()
