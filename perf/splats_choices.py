"""What each choice of training costs and brings: processor seconds against the error of the held-out view.

    cargo build --release
    l4d build-scenes --bench benchmark/dev --profile tiny --data data/dev-tiny
    python perf/splats_choices.py room_0506 tabletop_0512 outdoor_0502 --data data/dev-tiny --keep work/choices
    python perf/splats_choices.py room_0506 --data data/dev-tiny --keep work/choices --choices "4dgaussians"

Trains each scene once for each choice on one thread, whose processor time does not depend on what else runs. What is in
`--keep` already is not trained again, so that a killed run goes on. Prints a row a choice, means over scenes; `*` marks
what no other choice beats in both. `--figure FILE.svg` draws them.
"""

import argparse
import json
import os
import resource
import subprocess
from math import ceil, floor, log2
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CHOICES = {
    "default": [],
    "with depth": ["--depth"],
    "half the Gaussians": ["--gaussians", "2500"],
    "twice the Gaussians": ["--gaussians", "10000"],
    "a quarter of the iterations": ["--coarse", "100", "--unfold", "8", "--fine", "250"],
    "four times the iterations": ["--coarse", "1600", "--unfold", "120", "--fine", "4000", "--patience", "0"],
    "no unfolding": ["--unfold", "0"],
    "everything dynamic": ["--dynamic-threshold", "0"],
    "movers alone dynamic": ["--dynamic-threshold", "1.1"],
    "harmonics of degree 0": ["--sh-degree", "0"],
    "harmonics of degree 3": ["--sh-degree", "3"],
    "one view an iteration": ["--views-per-iteration", "1"],
    "four views an iteration": ["--views-per-iteration", "4"],
    "4dgaussians": ["--preset", "4dgaussians"],
}
SLOW = {"4dgaussians"}


def trained(options, scene, choice):
    """What one training took and reached, from its file if it was there."""
    kept = options.keep / f"{scene}.{choice.replace(' ', '-')}.json"
    if kept.exists():
        return json.loads(kept.read_text())
    out = kept.with_suffix("")
    command = [options.l4d, "--quiet", "train-splats", scene, "--profile", options.profile, "--data", options.data]
    command += ["--bench", options.bench, "--out", out, "--force", "--json", *CHOICES[choice]]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = os.environ | {"RAYON_NUM_THREADS": "1"}
    done = subprocess.run(list(map(str, command)), check=True, env=environment, stdout=subprocess.PIPE)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    report = json.loads(done.stdout)["report"]
    found = {"cpu_s": seconds, "memory_mb": report["peak_memory_bytes"] / 1e6, **report["test"]}
    kept.write_text(json.dumps(found))
    return found


def row(options, choice):
    """Means over the scenes."""
    found = [trained(options, scene, choice) for scene in options.scenes]
    mean = lambda name: sum(each[name] or 0.0 for each in found) / len(found)  # noqa: E731
    return {
        "choice": choice,
        "cpu_s": round(mean("cpu_s"), 1),
        "psnr_db": round(mean("psnr_db"), 2),
        "moving_db": round(mean("psnr_moving_db"), 2),
        "ssim": round(mean("ssim"), 3),
        "depth_mm": round(1e3 * mean("depth_error_m"), 1),
        "memory_mb": round(max(each["memory_mb"] for each in found)),
    }


def front(rows):
    """Rows of the colour track that no other one beats in both time and error."""
    rows = [row for row in rows if row["choice"] != "with depth"]
    beats = lambda a, b: a["cpu_s"] <= b["cpu_s"] and a["psnr_db"] >= b["psnr_db"] and a is not b  # noqa: E731
    return [row for row in rows if not any(beats(other, row) for other in rows)]


def figure(rows):
    """Time to the right on a logarithmic axis, PSNR upwards; the front is a line."""
    left, top, width, height = 60, 30, 640, 340
    low, high = floor(log2(min(row["cpu_s"] for row in rows))), ceil(log2(max(row["cpu_s"] for row in rows)))
    worst, best = floor(min(row["psnr_db"] for row in rows)), ceil(max(row["psnr_db"] for row in rows))

    def place(row):
        x = left + width * (log2(row["cpu_s"]) - low) / (high - low)
        return x, top + height * (best - row["psnr_db"]) / (best - worst)

    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + width + 230}" height="{top + height + 50}"'
        ' font-family="sans-serif" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for power in range(low, high + 1):
        x = left + width * (power - low) / (high - low)
        lines.append(f'<line x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{top + height}" stroke="#ddd"/>')
        lines.append(f'<text x="{x:.1f}" y="{top + height + 18}" text-anchor="middle">{2**power:g}</text>')
    for decibels in range(worst, best + 1):
        y = top + height * (best - decibels) / (best - worst)
        lines.append(f'<line x1="{left}" y1="{y:.1f}" x2="{left + width}" y2="{y:.1f}" stroke="#ddd"/>')
        lines.append(f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{decibels}</text>')
    along = " ".join(f"{x:.1f},{y:.1f}" for x, y in sorted(map(place, front(rows))))
    lines.append(f'<polyline points="{along}" fill="none" stroke="#bbb" stroke-width="2"/>')
    for number, row in enumerate(rows, 1):
        x, y = place(row)
        colour = {"default": "#c40", "with depth": "#27a"}.get(row["choice"], "#222")
        # Neighbours in time have their numbers on different sides.
        turn = sorted(rows, key=lambda row: row["cpu_s"]).index(row) % 4
        across, down, anchor = [(8, 4, "start"), (0, -8, "middle"), (0, 17, "middle"), (-7, 4, "end")][turn]
        lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"/>')
        at = f'<text x="{x + across:.1f}" y="{y + down:.1f}" text-anchor="{anchor}" fill="{colour}">'
        lines.append(f"{at}{number}</text>")
        beside = f'<text x="{left + width + 20}" y="{top + 20 * number}" fill="{colour}">'
        lines.append(f"{beside}{number}  {row['choice']}</text>")
    lines.append(f'<text x="{left}" y="{top - 10}">PSNR of the held-out view, dB</text>')
    lines.append(
        f'<text x="{left + width}" y="{top + height + 38}" text-anchor="end">processor seconds a scene</text></svg>'
    )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--profile", default="tiny")
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--bench", type=Path, default=ROOT / "benchmark/dev")
    parser.add_argument("--keep", type=Path, required=True, help="folder for models and what they reached")
    parser.add_argument("--choices", help="names, comma-separated; default: all but the slow ones")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--l4d", type=Path, default=ROOT / "target/release/l4d")
    options = parser.parse_args()
    options.keep.mkdir(parents=True, exist_ok=True)
    named = options.choices.split(",") if options.choices else [name for name in CHOICES if name not in SLOW]
    rows = [row(options, choice) for choice in named]
    best = front(rows)
    print("| choice | CPU s | dB | moving | SSIM | depth mm | MB |\n|---|---:|---:|---:|---:|---:|---:|")
    for each in rows:
        choice, *numbers = each.values()
        print(f"| {choice}{' *' if each in best else ''} | {' | '.join(map(str, numbers))} |")
    if options.figure:
        options.figure.write_text(figure(rows))
