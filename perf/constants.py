"""Which constants of training, solver and grounder matter on a set of scenes, and in which direction.

    python perf/constants.py open work/constants/tree
    cargo build --release --manifest-path work/constants/tree/Cargo.toml
    python perf/constants.py run train --scenes outdoor_0501,room_0505,tabletop_0509
    python perf/constants.py run solve
    python perf/constants.py run panoptic
    python perf/constants.py table

Constants are compiled in. `open` copies the sources and makes those that `constants.toml` lists ask a
variable of the environment (`L4D_CONSTANT`, one name and value), so that one build serves all values; what is
shipped stays as it is. `run` changes one constant at a time and appends a line per value and scene to
`work/constants/measured.jsonl`. What is there already is not measured again, so that a run which was stopped
goes on; `--again` forgets a stage (its queries changed, say). `table` prints Markdown: the mean over scenes
of the difference to the value that is shipped, scene by scene, the standard error of that mean, and how many
scenes.

`train` learns each scene anew and takes the PSNR of its held-out view, `sweep` does so without depth; `solve`
asks the oracle with the errors of `constants_noise.toml` about the models that `train` made as shipped, and
takes mIoU; so do `panoptic` and `fused`, with their own masks. All of it is about one benchmark folder, by default
`benchmark/dev`: nothing may be chosen on the test set.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import csv
import itertools
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import tomllib
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
STAGES = ("train", "sweep", "solve", "panoptic", "fused")
UNITS = {"train": "dB", "sweep": "dB", "solve": "mIoU", "panoptic": "mIoU", "fused": "mIoU"}
SHIPPED = "shipped"

HELPER = """//! Constants that the environment may replace.

/// `default`, or what `L4D_CONSTANT` (`name=value`) says.
pub(crate) fn of<T: std::str::FromStr>(name: &str, default: T) -> T {
    let Ok(said) = std::env::var("L4D_CONSTANT") else { return default };
    match said.split_once('=') {
        Some((said, value)) if said == name => value.parse().unwrap_or_else(|_| panic!("{said}: `{value}`")),
        _ => default,
    }
}
"""


@dataclass(frozen=True)
class Constant:
    """A constant, where it is, and what else is tried."""

    stage: str
    name: str
    files: tuple[str, ...]
    text: str | None
    was: str | None
    default: str
    values: tuple[str, ...]


def main() -> None:
    """Opens constants, measures them, or prints what was measured."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    verbs = parser.add_subparsers(dest="verb", required=True)
    opening = verbs.add_parser("open", help="copy the sources, with their constants open to the environment")
    opening.add_argument("tree", type=Path)
    running = verbs.add_parser("run", help="measure one constant after the other")
    running.add_argument("stage", choices=STAGES)
    running.add_argument("--bench", type=Path, default=ROOT / "benchmark" / "dev")
    running.add_argument("--profile", default="tiny")
    running.add_argument("--data", type=Path, default=ROOT / "work" / "dev-data" / "tiny")
    running.add_argument("--work", type=Path, default=ROOT / "work" / "constants" / "models")
    running.add_argument("--binary", type=Path, default=ROOT / "work/constants/tree/target/release/l4d")
    running.add_argument("--scenes", type=lambda text: text.split(","), help="default: all of the set")
    running.add_argument("--only", type=lambda text: text.split(","), help="names of constants; default: all")
    running.add_argument("--jobs", type=int, default=1, help="processes at once, a thread each")
    running.add_argument("--again", action="store_true", help="forget what was measured of this stage")
    for verb in (running, verbs.add_parser("table", help="print what was measured, as Markdown")):
        verb.add_argument("--measured", type=Path, default=ROOT / "work" / "constants" / "measured.jsonl")
    options = parser.parse_args()
    if options.verb == "open":
        open_sources(options.tree)
    elif options.verb == "run":
        run(options)
    else:
        print(table(read(options.measured)))


# --- constants ---


def constants(stage: str) -> list[Constant]:
    """What `constants.toml` lists of a stage."""
    listed = tomllib.loads((HERE / "constants.toml").read_text())[stage]
    found = [constant(stage, entry, listed["files"]) for entry in listed.get("constants", [])]
    for key in listed.get("all_of", []):
        path = ROOT / "crates" / listed["files"][key]
        names = re.findall(
            r"^pub\(\w+\) const (\w+): (?:f32|f64|usize|u32) =", path.read_text(), re.MULTILINE
        )
        users = sorted(
            str(file.relative_to(ROOT / "crates")) for file in path.parent.rglob("*.rs") if file != path
        )
        found += [
            constant(stage, {"name": name, "file": key, "also": users}, listed["files"]) for name in names
        ]
    return found


def constant(stage: str, entry: dict, files: dict[str, str]) -> Constant:
    """An entry of `constants.toml`; the value that is shipped comes from the sources."""
    own = files[entry["file"]]
    text, was = entry.get("text"), entry.get("was")
    if text is None:
        default = definition(entry["name"], (ROOT / "crates" / own).read_text()).group("value")
    else:
        default = re.search(r"\[\[(.+?)\]\]", text).group(1)
    values = entry.get("values")
    if values is None:
        number = float(default.replace("_", ""))
        values = [number / 2, number * 2] if "." in default else [int(number) // 2, int(number) * 2]
    written = tuple(str(value).lower() if isinstance(value, bool) else str(value) for value in values)
    return Constant(stage, entry["name"], (own, *entry.get("also", [])), text, was, default, written)


def definition(name: str, text: str) -> re.Match:
    """Where a constant is defined."""
    found = re.search(rf"const {name}: (?P<type>\w+) = (?P<value>[^;\[]+);", text)
    if found is None:
        sys.exit(f"there is no constant {name}: mend constants.toml")
    return found


def open_sources(tree: Path) -> None:
    """A copy of what git tracks, in which the listed constants ask the environment."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True)
    for name in filter(None, listed.stdout.split("\0")):
        new, old = tree / name, ROOT / name
        if old.is_file() and not (new.is_file() and new.read_bytes() == old.read_bytes()):
            new.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(old, new)
    crates: dict[str, list[str]] = {}
    for one in itertools.chain.from_iterable(map(constants, STAGES)):
        functions = crates.setdefault(one.files[0].split("/")[0], [])
        opened = f"opened_{len(functions)}"
        if one.text is None:
            kind = definition(one.name, (ROOT / "crates" / one.files[0]).read_text()).group("type")
            functions.append(
                f"/// {one.name}\npub(crate) fn {opened}() -> {kind} {{\n"
                f"    static VALUE: std::sync::OnceLock<{kind}> = std::sync::OnceLock::new();\n"
                f'    *VALUE.get_or_init(|| of("{one.name}", {one.default}))\n}}\n'
            )
            for file in one.files:
                path = tree / "crates" / file
                if file != one.files[0] and f"const {one.name}:" in path.read_text():
                    continue  # Another constant of this name.
                path.write_text(ask_for(one.name, f"crate::opened::{opened}()", path.read_text()))
            continue
        functions.append("")
        path = tree / "crates" / one.files[0]
        asked = f'crate::opened::of("{one.name}", {one.default})'
        new = re.sub(r"\[\[.+?\]\]", asked, one.text)
        old = one.was or re.sub(r"\[\[(.+?)\]\]", r"\1", one.text)
        source = path.read_text()
        if source.count(old) != 1:
            sys.exit(f"{path}: `{old}` is there {source.count(old)} times: mend constants.toml")
        path.write_text(source.replace(old, new))
    for crate, functions in crates.items():
        (tree / "crates" / crate / "src" / "opened.rs").write_text(
            "\n".join([HELPER, *filter(None, functions)])
        )
        path = tree / "crates" / crate / "src" / "lib.rs"
        path.write_text(path.read_text() + "\nmod opened;\n")


def ask_for(name: str, call: str, source: str) -> str:
    """The source with every use of a constant replaced; definitions, imports and comments stay."""
    lines, importing = [], False
    for line in source.split("\n"):
        bare = line.strip()
        importing = importing or bare.startswith(("use ", "pub(crate) use ", "pub(super) use "))
        if not (importing or bare.startswith("//") or f"const {name}:" in line):
            line = re.sub(rf"(?<![\w:])(?:\w+::)*{name}\b", call, line)
        importing = importing and not bare.endswith(";")
        lines.append(line)
    return "\n".join(lines)


# --- measuring ---


def run(options: argparse.Namespace) -> None:
    """Measures everything of a stage that was not measured yet."""
    known = read(options.measured)
    if options.again:
        known = [line for line in known if line["stage"] != options.stage]
        write(options.measured, known)
    manifest = tomllib.loads((options.bench / "panoptic-l4d.toml").read_text())
    scenes = options.scenes or manifest["scenes"]
    chosen = [one for one in constants(options.stage) if not options.only or one.name in options.only]
    todo = [(SHIPPED, "")] + [(one.name, value) for one in chosen for value in one.values]
    done = {(line["stage"], line["constant"], line["value"], line["scene"]) for line in known}
    lock = threading.Lock()

    def note(name: str, value: str, scene: str, measured: dict) -> None:
        line = {"stage": options.stage, "constant": name, "value": value, "scene": scene, **measured}
        with lock, options.measured.open("a") as file:
            file.write(json.dumps(line) + "\n")

    def measure(name: str, value: str) -> None:
        left = [scene for scene in scenes if (options.stage, name, value, scene) not in done]
        if not left:
            return
        with tempfile.TemporaryDirectory(prefix="l4d-constants-") as scratch:
            if options.stage in ("train", "sweep"):
                for scene in left:
                    note(name, value, scene, trained(options, scene, f"{name}={value}", Path(scratch)))
            else:
                for scene, found in solved(options, left, f"{name}={value}", Path(scratch)).items():
                    note(name, value, scene, found)
        print(f"{options.stage}: {name} {value}", file=sys.stderr, flush=True)

    options.measured.parent.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for future in [pool.submit(measure, name, value) for name, value in todo]:
            future.result()


def call(options: argparse.Namespace, said: str, *arguments: object) -> str:
    """What a verb says on standard output."""
    environment = os.environ | {"L4D_CONSTANT": said, "RAYON_NUM_THREADS": "1"}
    command = [options.binary.resolve(), "--quiet", *arguments]
    done = subprocess.run(
        [str(part) for part in command], cwd=ROOT, env=environment, capture_output=True, text=True
    )
    if done.returncode:
        sys.exit(f"{said}: {' '.join(map(str, command))}\n{done.stderr}")
    return done.stdout


def trained(options: argparse.Namespace, scene: str, said: str, scratch: Path) -> dict:
    """The report of a model that was learned with one constant changed."""
    kept = said == f"{SHIPPED}=" and options.stage == "train"
    folder = (options.work / options.profile / scene / "splats") if kept else scratch / scene
    arguments = ["--bench", options.bench, "--profile", options.profile, "--data", options.data]
    arguments += [] if options.stage == "sweep" else ["--depth"]
    said_json = call(
        options, said, "train-splats", scene, *arguments, "--out", folder, "--force", "--json"
    )
    report = json.loads(said_json)["report"]
    shutil.rmtree(scratch / scene, ignore_errors=True)
    test = report["test"]
    return {
        "score": test["psnr_db"],
        "moving": test["psnr_moving_db"],
        "depth_m": test["depth_error_m"],
        "gaussians": report["gaussians"],
        "seconds": report["train_seconds"],
    }


def solved(options: argparse.Namespace, scenes: list[str], said: str, scratch: Path) -> dict[str, dict]:
    """mIoU by scene, percent, of answers with one constant changed."""
    grounder = {
        "solve": ["--grounder", "oracle", "--noise", HERE / "constants_noise.toml"],
        "panoptic": ["--grounder", "panoptic"],
        "fused": ["--grounder", "panoptic-fused"],
    }[options.stage]
    about = ["--bench", options.bench, "--profile", options.profile, "--scenes", ",".join(scenes)]
    places = ["--data", options.data, "--work", options.work]
    into = ["--name", "tried", "--results", scratch / "results", "--answers", scratch / "answers"]
    call(options, said, "solve", *about, *places, *grounder, *into)
    call(options, said, "score", scratch / "results", *about, "--scores", scratch / "scores")
    with (scratch / "scores" / "tried" / "counts.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["state"] in ("hit", "miss")]
    found: dict[str, dict[str, list[float]]] = {scene: {} for scene in scenes}
    for row in rows:
        iou = int(row["intersection"]) / int(row["union"])
        found[row["scene"]].setdefault(row["query"], []).append(iou)
    means = {scene: [mean(ious) for ious in queries.values()] for scene, queries in found.items()}
    return {scene: {"score": 100 * mean(ious), "queries": len(ious)} for scene, ious in means.items() if ious}


# --- what was measured ---


def read(path: Path) -> list[dict]:
    """All lines."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def write(path: Path, lines: list[dict]) -> None:
    """All lines, in place of those that are there."""
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))


def mean(values: list[float]) -> float:
    """Of one value at least."""
    return sum(values) / len(values)


def effect(scores: dict[str, float], usual: dict[str, float]) -> str:
    """Mean difference over the scenes that both have, its standard error, and how many scenes those are."""
    differences = [scores[scene] - usual[scene] for scene in scores if scene in usual]
    if not differences:
        return "-"
    middle, count = mean(differences), len(differences)
    if count == 1:
        return f"{middle:+.2f} (1)"
    spread = math.sqrt(sum((one - middle) ** 2 for one in differences) / (count - 1) / count)
    return f"{middle:+.2f} ± {spread:.2f} ({count})"


def table(lines: list[dict]) -> str:
    """Markdown: a row for each constant."""
    by: dict[tuple[str, str, str], dict[str, float]] = {}
    for line in lines:
        by.setdefault((line["stage"], line["constant"], line["value"]), {})[line["scene"]] = line["score"]
    rows = []
    for stage in STAGES:
        usual = by.get((stage, SHIPPED, ""), {})
        if not usual:
            continue
        level = f"{mean(list(usual.values())):.2f} {UNITS[stage]} over {len(usual)} scenes"
        rows += [
            f"\n**{stage}**, as shipped: {level}\n",
            "| constant | value | others: difference |",
            "|---|---|---|",
        ]
        for one in constants(stage):
            tried = [
                f"{value}: {effect(by[stage, one.name, value], usual)}"
                for value in one.values
                if (stage, one.name, value) in by
            ]
            if tried:
                rows.append(f"| `{one.name}` | {one.default} | {'; '.join(tried)} |")
    return "\n".join(rows)


if __name__ == "__main__":
    main()
