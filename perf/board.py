"""How long `l4d leaderboard` takes from counts.csv to tables and figures.

Makes a folder of scores of many made-up methods (the oracle's counts on the shipped queries, each query spoilt by its own
share) and runs the verb on it.

    python3 perf/board.py --l4d target/release/l4d --methods 50
    python3 perf/board.py --l4d target/release/l4d --methods 50 -- --html
    python3 perf/board.py --l4d target/release/l4d --methods 10000 --scenes tabletop_tea -- --html
    python3 perf/board.py --l4d target/release/l4d --methods 2 --copies 70 --repeat 1 -- --html

prints one JSON object with the best wall time, the best processor time (which can be compared on a machine that others use
as well), the peak memory and the size of the page; what follows `--` goes to the verb. Methods beyond the first hundred have
the counts of one of them under a name of their own; `--copies 70` asks each query 70 times, which makes 20 230. Needs no render, and Python's standard library alone.

Targets: 50 methods on all queries in under 10 s; time in proportion to the methods, memory far below that of their counts: below 300 MB
for 20 230 queries and two methods with the page.
"""

import argparse
import concurrent.futures
import csv
import hashlib
import importlib.util
import json
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BENCHMARK = Path(__file__).resolve().parents[1] / "benchmark"
# Each takes a while to make up.
MADE_UP = 100


def recompute_module():
    """The script that derives numbers from counts: a summary has to agree with its rows."""
    spec = importlib.util.spec_from_file_location("recompute", BENCHMARK / "recompute.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def spoil(rows: list[dict], number: int) -> list[dict]:
    """The oracle's rows with a share of each target missed and as much marked beside it; some queries go wrong."""
    skill = 0.2 + 0.7 * random.Random(number).random()
    spoilt = []
    for row in rows:
        row = dict(row)
        query = random.Random(f"{number}/{row['scene']}/{row['query']}")
        truth = int(row["truth"])
        found = min(skill + query.gauss(0, 0.15), 1.0) if query.random() < skill + 0.3 else 0.0
        overlap = int(truth * max(found, 0.0))
        if truth:
            row["state"] = "hit" if overlap else "miss"
            row["intersection"], row["predicted"], row["union"] = overlap, truth, 2 * truth - overlap
            row["instance"], row["instance_overlap"] = (row["instance"], overlap) if overlap else ("", 0)
        spoilt.append(row)
    return spoilt


def write_method(scores: Path, bench: Path, name: str, rows: list[dict], summary: dict) -> None:
    folder = scores / name
    folder.mkdir()
    with (folder / "counts.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    recompute = recompute_module()
    referents = recompute.read_referents(bench)
    headline = recompute.headline(folder, referents, argparse.Namespace(missing="zero", hit_iou=0.0))
    headline.pop("miou_error")
    used = {**summary["used"], "ground_truth": False}
    seconds = 10.0 * len(name) + headline["miou"]
    document = {**summary, **headline, "name": name, "used": used, "baseline": False, "seconds": seconds}
    (folder / "summary.json").write_text(json.dumps(document), encoding="utf-8")


def copy_method(scores: Path, source: str, name: str) -> None:
    folder = scores / name
    folder.mkdir()
    (folder / "counts.csv").write_bytes((scores / source / "counts.csv").read_bytes())
    summary = json.loads((scores / source / "summary.json").read_text(encoding="utf-8"))
    (folder / "summary.json").write_text(json.dumps({**summary, "name": name}), encoding="utf-8")


def make_methods(scores: Path, bench: Path, count: int) -> tuple[int, int]:
    """Adds methods to a folder of scores that holds the oracle, `count` in all; returns the numbers of queries and rows."""
    with (scores / "oracle/counts.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    summary = json.loads((scores / "oracle/summary.json").read_text(encoding="utf-8"))
    for number in range(count - 1):
        name = f"method-{number:05}"
        if number < MADE_UP:
            write_method(scores, bench, name, spoil(rows, number), summary)
        else:
            copy_method(scores, f"method-{number % MADE_UP:05}", name)
    return summary["queries"], len(rows)


def copy_benchmark(target: Path, profile: str, copies: int) -> None:
    """The benchmark with every query under `copies` numbers."""
    shutil.copytree(BENCHMARK / "published", target / "published")
    shutil.copytree(BENCHMARK / "scenes", target / "scenes")
    shutil.copytree(BENCHMARK / "truth" / profile, target / "truth" / profile)
    shutil.copy(BENCHMARK / "panoptic-l4d.toml", target)
    (target / "queries").mkdir()
    for path in sorted((BENCHMARK / "queries").glob("*.jsonl")):
        if path.stem.endswith((".composite", ".absent")):
            continue
        lines = []
        for query in map(json.loads, path.read_text(encoding="utf-8").splitlines()):
            scene, number = query["id"].split("/")
            predicate = json.dumps(query["predicate"], sort_keys=True, separators=(",", ":"))
            for copy in range(copies):
                text = f"{query['text']} {copy}"
                digest = hashlib.sha256(f"{text}\n{predicate}".encode()).hexdigest()[:16]
                numbered = {"id": f"{scene}/{copy + 1:03}{number}", "text": text, "text_digest": digest}
                lines.append(json.dumps({**query, **numbered}))
        (target / "queries" / path.name).write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--l4d", type=Path, required=True, help="the binary, built with --release")
    parser.add_argument("--methods", type=int, default=50)
    parser.add_argument("--profile", default="small")
    parser.add_argument("--scenes", help="these alone, with commas between them (all)")
    parser.add_argument("--copies", type=int, default=1, help="how often each query is asked")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("rest", nargs="*", help="arguments of `l4d leaderboard`")
    options = parser.parse_args()
    l4d = options.l4d.resolve()
    with tempfile.TemporaryDirectory() as root:
        source = BENCHMARK
        if options.copies > 1:
            source = Path(root) / "benchmark"
            copy_benchmark(source, options.profile, options.copies)
        bench = ["--bench", str(source), "--profile", options.profile]
        bench += ["--scenes", options.scenes] if options.scenes else []

        def run(*arguments: str) -> tuple[float, resource.struct_rusage]:
            """Wall seconds, and what the process used. What starts it must be small: its memory counts until it is replaced."""
            start = time.perf_counter()
            process = subprocess.Popen(
                [l4d, *arguments, *bench], cwd=root, stdout=subprocess.DEVNULL, stderr=sys.stderr
            )
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode != 0:
                raise SystemExit(f"l4d {' '.join(arguments)} ended with {process.returncode}")
            return time.perf_counter() - start, usage

        run("-q", "baseline", "oracle")
        run("-q", "score")
        scores = Path(root) / "scores"
        # Rows as Python has them are large: another process holds them.
        with concurrent.futures.ProcessPoolExecutor(1) as other:
            queries, rows = other.submit(make_methods, scores, source, options.methods).result()
        runs = [run("-q", "leaderboard", *options.rest) for _ in range(options.repeat)]
        files = [path for path in (Path(root) / "leaderboard").rglob("*") if path.is_file()]
        report = {
            "methods": options.methods,
            "queries": queries,
            "rows": rows,
            "profile": options.profile,
            "arguments": options.rest,
            "cores": os.cpu_count(),
            "files": len(files),
            "seconds": round(min(wall for wall, _ in runs), 3),
            "processor_seconds": round(min(usage.ru_utime + usage.ru_stime for _, usage in runs), 3),
            "peak_memory_mib": round(max(usage.ru_maxrss for _, usage in runs) / 1024),
            "page_bytes": sum(path.stat().st_size for path in files if path.name == "index.html"),
        }
        print(json.dumps(report))


if __name__ == "__main__":
    main()
