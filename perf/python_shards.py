"""Speed of batches from shards: `l4d.torch.Scenes` over tar shards, against the same members as loose files, against decoding
alone, and over the built scenes.

    cargo build --release -p l4d-py
    l4d release --bench BENCH --profile tiny --date 2026-11-22 --url https://example.org/x --out release
    python perf/python_shards.py release/NAME-VERSION/shards/tiny --data data/tiny

Needs PyTorch and numpy. All sides give the same tensors of the same samples in the same order, in this process, batch by batch
with the collation of PyTorch; files are in the page cache. Sides take turns in each round; a number is the median over rounds.
`decoding` decodes bytes that are in memory and makes batches of them, with cameras that are ready: what no reader can leave out.
Bounds: shards are no slower than loose files, and take at most 1.2 times what decoding alone does. `--workers` times a `DataLoader`
as well.
"""

import argparse
import json
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Callable

from python_frames import ROOT, load


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shards", type=Path)
    parser.add_argument("--data", type=Path, help="folder of the built scenes")
    parser.add_argument("--samples", type=int, default=400)
    parser.add_argument("--batch", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--exact-depth", action="store_true")
    parser.add_argument("--target", type=Path, default=ROOT / "target", help="target folder of cargo")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        load(arguments.target / "release/libl4d_py.so", Path(folder))
        print(json.dumps(measure(arguments, Path(folder) / "loose")))


def measure(arguments: argparse.Namespace, loose: Path) -> dict[str, Any]:
    import numpy as np
    import torch
    from torch.utils.data import DataLoader, Subset, default_collate

    import l4d
    from l4d.torch import Scenes

    torch.set_num_threads(1)
    exact = arguments.exact_depth
    scenes = Scenes(arguments.shards, exact_depth=exact)
    count = min(arguments.samples, len(scenes))
    names = ["json", "png", "depth.png", "ids.png", *(["depth_rest.png"] if exact else [])]
    loose.mkdir()
    for index in range(count):
        for name in names:
            (loose / f"{index:06}.{name}").write_bytes(scenes._read(scenes._items[index], name))
    held = [
        {name: (loose / f"{index:06}.{name}").read_bytes() for name in names} for index in range(count)
    ]
    cards = [scenes[index] for index in range(count)]

    def tensors(members: dict[str, bytes], scale_m: float) -> dict[str, torch.Tensor]:
        return {
            "colour": torch.from_numpy(l4d.decode_colour(members["png"])),
            "depth_m": torch.from_numpy(l4d.decode_depth(members["depth.png"], scale_m, members.get("depth_rest.png"))),
            "ids": torch.from_numpy(l4d.decode_ids(members["ids.png"]).view(np.int32)),
        }

    scales = [json.loads(members["json"])["depth_scale_m"] for members in held]
    cameras = [{name: value for name, value in card.items() if name not in ("colour", "depth_m", "ids")} for card in cards]

    def decoded(index: int) -> dict[str, Any]:
        return {**cameras[index], **tensors(held[index], scales[index])}

    def of_files(index: int) -> dict[str, Any]:
        members = {name: (loose / f"{index:06}.{name}").read_bytes() for name in names}
        card = json.loads(members["json"])
        intrinsics = [[card["fx"], 0.0, card["cx"]], [0.0, card["fy"], card["cy"]], [0.0, 0.0, 1.0]]
        return {
            **{name: card[name] for name in ("scene", "view", "frame", "seconds")},
            "time": l4d.Timeline(card["profile"]).unit_time(card["frame"]),
            "intrinsics": torch.tensor(intrinsics, dtype=torch.float64),
            "world_from_camera": torch.tensor(card["world_from_camera"], dtype=torch.float64).reshape(4, 4),
            **tensors(members, card["depth_scale_m"]),
        }

    def batches(read: Callable[[int], Any]) -> float:
        start = time.perf_counter()
        for first in range(0, count, arguments.batch):
            default_collate([read(index) for index in range(first, min(first + arguments.batch, count))])
        return time.perf_counter() - start

    sides: dict[str, Callable[[], float]] = {
        "decoding": lambda: batches(decoded),
        "loose": lambda: batches(of_files),
        "shards": lambda: batches(lambda index: scenes[index]),
    }
    if arguments.data:
        built = Scenes(arguments.data)
        sides["built"] = lambda: batches(lambda index: built[index % len(built)])
    if arguments.workers:
        loader = DataLoader(
            Subset(scenes, range(count)),
            batch_size=arguments.batch,
            num_workers=arguments.workers,
            persistent_workers=True,
        )

        def with_workers() -> float:
            start = time.perf_counter()
            for _ in loader:
                pass
            return time.perf_counter() - start

        sides["shards_with_workers"] = with_workers
    for side in sides.values():
        side()
    rounds = [{name: side() for name, side in sides.items()} for _ in range(arguments.rounds)]
    medians = {name: statistics.median(each[name] for each in rounds) for name in sides}
    return {
        "samples": count,
        "size": list(cards[0]["colour"].shape[1::-1]),
        "exact_depth": exact,
        "ms_a_sample": {name: round(seconds / count * 1e3, 3) for name, seconds in medians.items()},
        "shards_to_loose": round(statistics.median(each["shards"] / each["loose"] for each in rounds), 3),
        "shards_to_decoding": round(statistics.median(each["shards"] / each["decoding"] for each in rounds), 3),
    }


if __name__ == "__main__":
    sys.exit(main())
