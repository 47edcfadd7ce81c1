"""How the cost of each stage grows from `tiny` over `small` to `full`: seconds a picture and memory, exponents over pixels.

    cargo build --release
    python perf/growth.py run SCENE --work work/growth       # measures what was not measured yet
    python perf/growth.py table --work work/growth --figure docs/pictures/growth.svg

Stages: colour (4 samples a pixel), depth and ids (`--samples 0`), `check-scenes` of a whole scene, `baseline` and `score` of
one scene, and drawing a made-up model of as many Gaussians as the profile has, forward. An exponent is
the slope of a straight line through the logarithms: 1 means as many times the seconds as pixels.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Width and height, views, frames, Gaussians of `train-splats`.
PROFILES = {
    "tiny": ((128, 96), 5, 9, 5_000),
    "small": ((256, 192), 13, 49, 18_000),
    "full": ((640, 480), 17, 97, 60_000),
}
STAGES = ("colour", "depth and ids", "check-scenes", "baseline", "score", "draw")


def call(options, *words):
    """Runs a verb; wall seconds, megabytes at most of it and what it starts, and what it says."""
    command = [str(options.l4d.resolve()), "--quiet", *map(str, words)]
    began = time.monotonic()
    process = subprocess.Popen(command, cwd=options.work, stdout=subprocess.PIPE, text=True)
    said = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    # Findings are 1.
    if os.waitstatus_to_exitcode(status) > 1:
        sys.exit(f"{' '.join(command)} failed")
    return time.monotonic() - began, usage.ru_maxrss / 1024, said


def measure(options, profile):
    """Seconds a picture and megabytes of each stage, as pairs."""
    size, views, frames, gaussians = PROFILES[profile]
    pictures = views * frames
    common = ["--profile", profile, "--bench", options.bench.resolve()]
    render = ["build-scenes", *common, "--scenes", options.scene, "--blender-scripts", ROOT / "blender_scripts"]
    render += ["--work", options.blender.resolve()]
    found = {}

    def rendered(data, *more):
        return call(options, *render, "--data", data, *more)

    # Differences of two runs each, so that starting Blender and building the scene drop out.
    stride = 96 // (frames - 1)
    some = ["--samples", 4, "--views", options.views]
    rendered(f"colour/{profile}", "--tracks-only")
    fewer, _, _ = rendered(f"colour/{profile}", *some, "--frames", "48")
    more, memory, _ = rendered(f"colour/{profile}", *some, "--frames", f"0-{3 * stride - 1}")
    found["colour"] = ((more - fewer) / 4, memory)
    rendered(f"depth/{profile}", "--tracks-only")
    fewer, _, _ = rendered(f"depth/{profile}", "--samples", 0, "--frames", "48")
    more, memory, _ = rendered(f"depth/{profile}", "--samples", 0, "--frames", f"0-{4 * stride - 1}")
    found["depth and ids"] = ((more - fewer) / (3 * views), memory)
    data = options.data.resolve() / profile
    rendered(data, "--samples", 0)
    seconds, memory, _ = call(options, "check-scenes", *common, "--data", data, "--scenes", options.scene)
    found["check-scenes"] = (seconds / pictures, memory)
    one = [*common, "--scenes", options.scene]
    seconds, memory, _ = call(options, "baseline", *one, "--results", f"results/{profile}", "--force")
    found["baseline"] = (seconds / frames, memory)
    judged = ["score", f"results/{profile}", *one, "--scores", f"scores/{profile}", "--force"]
    seconds, memory, _ = call(options, *judged)
    found["score"] = (seconds / frames, memory)
    drawn = ["bench", "splats", "--gaussians", gaussians, "--size", f"{size[0]}x{size[1]}", "--sweeps", "rasterizer"]
    _, memory, said = call(options, *drawn, "--repeats", 3, "--out", f"bench/{profile}", "--force", "--json")
    found["draw"] = (json.loads(said)["rows"][0]["picture_ms"] / 1e3, memory)
    return found


def run(options):
    options.work.mkdir(parents=True, exist_ok=True)
    for profile in PROFILES:
        file = options.work / f"{profile}.json"
        if not file.exists():
            print(f"measuring {profile}", file=sys.stderr, flush=True)
            file.write_text(json.dumps(measure(options, profile), indent=1))


def exponent(points):
    """Slope of the straight line through the logarithms, least squares."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mean = [sum(axis) / len(logs) for axis in zip(*logs)]
    covariance = sum((x - mean[0]) * (y - mean[1]) for x, y in logs)
    return covariance / sum((x - mean[0]) ** 2 for x, _ in logs)


def table(options):
    measured = {profile: json.loads((options.work / f"{profile}.json").read_text()) for profile in PROFILES}
    pixels = {profile: size[0] * size[1] for profile, (size, *_) in PROFILES.items()}
    curves = {stage: [(pixels[p], measured[p][stage][0]) for p in PROFILES] for stage in STAGES}
    print("| ms a picture (MB) | tiny | small | full | exponent |\n|---|---:|---:|---:|---:|")
    for stage in STAGES:
        cells = [f"{1e3 * measured[p][stage][0]:.3g} ({measured[p][stage][1]:.0f})" for p in PROFILES]
        print(f"| {stage} | {' | '.join(cells)} | {exponent(curves[stage]):.2f} |")
    if options.figure:
        options.figure.write_text(figure(curves))


COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]


def figure(curves):
    """Curves on logarithmic axes, as SVG."""
    points = [point for curve in curves.values() for point in curve]
    low = [math.floor(math.log10(min(axis))) for axis in zip(*points)]
    high = [math.ceil(math.log10(max(axis))) for axis in zip(*points)]
    left, top, width, height = 84, 20, 420, 340

    def place(x, y):
        across = (math.log10(x) - low[0]) / (high[0] - low[0])
        up = (math.log10(y) - low[1]) / (high[1] - low[1])
        return left + across * width, top + height - up * height

    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" width="720" height="420" font-family="sans-serif" font-size="13">',
        '<rect width="720" height="420" fill="white"/>',
    ]
    for power in range(low[1], high[1] + 1):
        _, y = place(10 ** low[0], 10.0**power)
        lines.append(f'<line x1="{left}" x2="{left + width}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
        label = f"{10.0 ** (power + 3):g} ms"
        lines.append(f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{label}</text>')
    for name, ((across, down), *_) in PROFILES.items():
        x, _ = place(across * down, 10.0 ** low[1])
        lines.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{top}" y2="{top + height}" stroke="#ddd"/>')
        middle = f'<text x="{x:.1f}" y="{top + height + 18}" text-anchor="middle">'
        lines.append(f"{middle}{name}</text>")
        lines.append(f"{middle.replace(str(top + height + 18), str(top + height + 34))}{across}x{down}</text>")
    ends = sorted((place(*curve[-1])[1], stage) for stage, curve in curves.items())
    labels, last = {}, -math.inf
    for y, stage in ends:
        last = labels[stage] = max(y, last + 17)
    for colour, (stage, curve) in zip(COLOURS, curves.items()):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in (place(*point) for point in curve))
        lines.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for x, y in (place(*point) for point in curve):
            lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}"/>')
        text = f"{stage}, exponent {exponent(curve):.2f}"
        lines.append(f'<text x="{left + width + 12}" y="{labels[stage] + 4:.1f}" fill="{colour}">{text}</text>')
    lines.append(f'<text x="{left}" y="{top - 6}">a picture or frame</text></svg>')
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    verbs = parser.add_subparsers(dest="verb", required=True)
    running = verbs.add_parser("run")
    running.add_argument("scene")
    running.add_argument("--l4d", type=Path, default=ROOT / "target/release/l4d")
    running.add_argument("--bench", type=Path, default=ROOT / "benchmark")
    running.add_argument("--data", type=Path, default=ROOT / "work/growth/data", help="whole scenes, a folder a profile")
    running.add_argument("--views", default="cam05,cam09", help="two training views that all profiles have")
    running.add_argument("--blender", type=Path, default=ROOT / "work", help="folder of the Blender environment")
    tabling = verbs.add_parser("table")
    tabling.add_argument("--figure", type=Path)
    for verb in (running, tabling):
        verb.add_argument("--work", type=Path, default=ROOT / "work/growth")
    options = parser.parse_args()
    {"run": run, "table": table}[options.verb](options)
