#!/usr/bin/env python3
"""Recomputes the headline of a leaderboard from scores/<method>/counts.csv, with the standard library alone.

    python3 benchmark/recompute.py scores
    python3 benchmark/recompute.py scores --check leaderboard/leaderboard.csv

Prints a CSV: one row a method, percent, the mean over queries of each metric of docs/scoring.md, and the cluster-robust
standard error of mIoU. `select` asks which objects a query means, so it needs the queries of the benchmark too (--bench);
everything else follows from the rows of counts.csv.

--check compares with the tables of `l4d leaderboard`: exit 0 if every number is the same, 1 if not, 2 if something cannot
be read.
"""

import argparse
import csv
import json
import math
import sys
from collections import defaultdict
from pathlib import Path

PIXELS = ("intersection", "union", "predicted", "truth", "instance_overlap")
COLUMNS = ("scene", "query", "frame", "state", *PIXELS[:4], "instance", PIXELS[4])
STATES = ("hit", "miss", "false_alarm", "true_absent", "missing", "not_annotated")
METRICS = ("miou", "macc", "acc25", "acc50", "tube_iou", "select", "false_positive_rate")
# Tables are printed with four decimals.
TOLERANCE = 0.5e-4 + 1e-9


class Refusal(Exception):
    """What cannot be read, in words."""


def read_counts(path: Path) -> dict[tuple[str, str], list[dict]]:
    """Rows of counts.csv by (scene, query), in their order."""
    queries: dict[tuple[str, str], list[dict]] = defaultdict(list)
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        missing = [column for column in COLUMNS if column not in (reader.fieldnames or [])]
        if missing:
            raise Refusal(f"{path}: has no column {', '.join(missing)}; run `l4d score` again")
        for row in reader:
            try:
                row.update({column: int(row[column]) for column in PIXELS})
            except (TypeError, ValueError):
                raise Refusal(f"{path}: line {reader.line_num}: a count is no whole number") from None
            if row["state"] not in STATES:
                raise Refusal(f"{path}: line {reader.line_num}: no state is called {row['state']!r}")
            queries[row["scene"], row["query"]].append(row)
    return queries


def read_referents(bench: Path) -> dict[tuple[str, str], set[str]]:
    """Names of what each query means."""
    referents = {}
    for path in sorted((bench / "queries").glob("*.jsonl")):
        for line in path.read_text(encoding="utf-8").splitlines():
            if line.strip():
                query = json.loads(line)
                scene, number = query["id"].split("/")
                referents[scene, number] = set(query["referents"])
    return referents


def ratios(rows: list[dict], referents: set[str] | None, options: argparse.Namespace) -> dict[str, float | None]:
    """The metrics of one query, 0 to 1."""
    left_out = {"not_annotated"} | ({"missing"} if options.missing == "skip" else set())
    rows = [row for row in rows if row["state"] not in left_out]
    present = [row for row in rows if row["truth"] > 0]
    absent = [row for row in rows if row["truth"] == 0]
    found = dict.fromkeys(METRICS)
    if absent:
        found["false_positive_rate"] = sum(row["predicted"] > 0 for row in absent) / len(absent)
    if not present:
        return found
    ious = [row["intersection"] / row["union"] for row in present]
    found["miou"] = sum(ious) / len(ious)
    for metric, threshold in (("macc", options.hit_iou), ("acc25", 0.25), ("acc50", 0.5)):
        found[metric] = sum(iou > threshold for iou in ious) / len(ious)
    found["tube_iou"] = sum(row["intersection"] for row in rows) / sum(row["union"] for row in rows)
    if referents is not None:
        overlaps: dict[str, int] = defaultdict(int)
        for row in rows:
            if row["instance"]:
                overlaps[row["instance"]] += row["instance_overlap"]
        meant = max((overlap for name, overlap in overlaps.items() if name in referents), default=0)
        other = max((overlap for name, overlap in overlaps.items() if name not in referents), default=0)
        found["select"] = float(meant > other)
    return found


def standard_error(values: dict[tuple[str, str], float]) -> float | None:
    """Of the mean over queries, clustered by scene."""
    mean = sum(values.values()) / len(values)
    residuals: dict[str, float] = defaultdict(float)
    for (scene, _), value in values.items():
        residuals[scene] += value - mean
    scenes = len(residuals)
    if scenes < 2:
        return None
    return math.sqrt(scenes / (scenes - 1) * sum(residual**2 for residual in residuals.values())) / len(values)


def headline(folder: Path, referents: dict | None, options: argparse.Namespace) -> dict[str, float | None]:
    """Means over the queries of one method, percent."""
    queries = read_counts(folder / "counts.csv")
    unknown = None if referents is None else next((query for query in queries if query not in referents), None)
    if unknown:
        raise Refusal(f"{folder / 'counts.csv'}: {'/'.join(unknown)} is no query of the benchmark")
    found = {
        query: ratios(rows, referents and referents[query], options) for query, rows in queries.items()
    }
    row: dict[str, float | None] = {"queries": sum(one["miou"] is not None for one in found.values())}
    for metric in METRICS:
        values = [one[metric] for one in found.values() if one[metric] is not None]
        row[metric] = 100 * sum(values) / len(values) if values else None
    values = {query: 100 * one["miou"] for query, one in found.items() if one["miou"] is not None}
    row["miou_error"] = standard_error(values) if values else None
    return row


def check(path: Path, methods: dict[str, dict], columns: list[str]) -> int:
    """Prints every number of a table that differs; their number."""
    if not path.exists():
        raise Refusal(f"{path}: is not there; run `l4d leaderboard`")
    differences, compared = 0, 0
    with path.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            name = row["method"]
            if name not in methods:
                raise Refusal(f"{path}: {name} has no counts.csv in the folder of scores")
            for column in columns:
                theirs, ours = row[column], methods[name][column]
                compared += 1
                if (theirs == "") != (ours is None) or (ours is not None and abs(float(theirs) - ours) > TOLERANCE):
                    print(f"{name}: {column} is {ours}, but the table says {theirs or 'nothing'}", file=sys.stderr)
                    differences += 1
    print(f"{compared} numbers of {path} compared, {differences} differ", file=sys.stderr)
    return differences


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scores", type=Path, nargs="?", default=Path("scores"))
    parser.add_argument("--bench", type=Path, help="folder of the benchmark, for `select`")
    parser.add_argument("--missing", choices=("zero", "skip"), default="zero", help="as in `l4d score`")
    parser.add_argument("--hit-iou", type=float, default=0.0, help="as in `l4d score`")
    parser.add_argument("--check", type=Path, metavar="CSV", help="leaderboard.csv to compare with")
    options = parser.parse_args()
    folders = sorted(path.parent for path in options.scores.glob("*/counts.csv"))
    if not folders:
        raise Refusal(f"{options.scores}: holds no <method>/counts.csv; run `l4d score`")
    referents = None if options.bench is None else read_referents(options.bench)
    methods = {folder.name: headline(folder, referents, options) for folder in folders}

    columns = ["queries", *(metric for metric in METRICS if metric != "select" or referents is not None)]
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["method", *columns, "miou_error"])
    best_first = sorted(methods.items(), key=lambda item: (-(item[1]["miou"] or 0.0), item[0]))
    for name, row in best_first:
        numbers = ["" if row[column] is None else f"{row[column]:.4f}" for column in [*columns[1:], "miou_error"]]
        writer.writerow([name, row["queries"], *numbers])
    return 1 if options.check and check(options.check, methods, columns) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Refusal as refusal:
        print(f"error: {refusal}", file=sys.stderr)
        sys.exit(2)
    except (OSError, UnicodeDecodeError, json.JSONDecodeError, KeyError) as error:
        print(f"error: {type(error).__name__}: {error}", file=sys.stderr)
        sys.exit(2)
