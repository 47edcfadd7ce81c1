"""How fast latents become masks: ratio of our relevancy to the same steps in PyTorch on the CPU, with error beside it.

    python perf/relevancy.py
    python perf/relevancy.py --size 640x480 --prompts 20

Three frames of three levels at 1352x1014 and ten sentences, as LangSplatV2 and 4D LangSplat cut them (pool of 29), by
the widths of LangSplat's decoder. PyTorch decodes in slices, since the embeddings of a whole level would take 2.8 GB;
its slice is the fastest of a few. Both read the same files and end with masks, in turn, as often as `--rounds` says,
and the best time of each counts: on a busy machine only the ratio of one run means anything. `parts` says where
PyTorch's time goes, so that the ratio without the pooling is known too. Needs cargo, numpy and PyTorch.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import torch

ROOT = Path(__file__).resolve().parents[1]
WIDTHS = {"langsplat": [3, 16, 32, 64, 128, 256, 256, 512], "4d-langsplat": [3, 16, 32, 64, 128, 256, 512]}
SLICES = [1 << 12, 1 << 14, 1 << 16, 1 << 18]


def main() -> None:
    """Times both in turn and prints the ratio."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="1352x1014")
    parser.add_argument("--frames", type=int, default=3)
    parser.add_argument("--levels", type=int, default=3)
    parser.add_argument("--prompts", type=int, default=10)
    parser.add_argument("--decoder", choices=WIDTHS, default="langsplat")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--binary", type=Path, help="the built example; without it cargo builds it")
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    with tempfile.TemporaryDirectory(prefix="l4d-perf-") as scratch:
        print(json.dumps(compare(options, Path(scratch)), indent=2))


def compare(options: argparse.Namespace, scratch: Path) -> dict:
    """Both programs on the same files."""
    frames, weights, texts = write_inputs(options, scratch)
    binary = options.binary or build()
    ours = [str(binary), str(scratch / "decoder.npz"), str(scratch / "texts.npz"), "pool29"]
    for index, levels in enumerate(frames):
        ours += ["--"] * (index > 0) + [str(level) for level in levels]
    environment = os.environ | {"RAYON_NUM_THREADS": str(options.threads)}
    piece = fastest_slice(frames[0][0], weights)
    best, theirs, parts = float("inf"), float("inf"), {}
    for _ in range(options.rounds):
        answer = json.loads(subprocess.run(ours, check=True, capture_output=True, env=environment).stdout)
        best = min(best, answer["seconds"])
        start = time.perf_counter()
        masks, spent = reference(frames, weights, texts, piece)
        seconds = time.perf_counter() - start
        if seconds < theirs:
            theirs, parts = seconds, spent
    pooling = parts["smoothing"]
    return {
        "size": options.size,
        "frames": options.frames,
        "levels": options.levels,
        "prompts": options.prompts,
        "decoder": WIDTHS[options.decoder],
        "threads": options.threads,
        "seconds": {"l4d": round(best, 3), "torch": round(theirs, 3)},
        "parts": {name: round(value, 3) for name, value in parts.items()},
        "ratio": round(theirs / best, 2),
        "ratio_without_pooling": round((theirs - pooling) / best, 2),
        "worst_iou": round(min(iou(counts, mask) for counts, mask in zip(answer["masks"], masks)), 6),
    }


def write_inputs(options: argparse.Namespace, scratch: Path) -> tuple[list, list, tuple]:
    """Latents that vary slowly, an autoencoder and sentences, all drawn from one seed."""
    random = np.random.default_rng(3)
    width, height = map(int, options.size.split("x"))
    widths = WIDTHS[options.decoder]
    weights = [(random.normal(size=(b, a)) / np.sqrt(a), 0.1 * random.normal(size=b)) for a, b in zip(widths, widths[1:])]
    weights = [(w.astype("f4"), b.astype("f4")) for w, b in weights]
    arrays = {f"decoder.{2 * index}.{name}": part for index, pair in enumerate(weights) for name, part in zip(("weight", "bias"), pair)}
    np.savez(scratch / "decoder.npz", **arrays)
    positives, negatives = random.normal(size=(options.prompts, widths[-1])), random.normal(size=(4, widths[-1]))
    positives, negatives = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (positives, negatives))
    positives, negatives = positives.astype("f4"), negatives.astype("f4")
    queries = np.array([f"sentence {index}" for index in range(options.prompts)])
    np.savez(scratch / "texts.npz", queries=queries, positives=positives, negatives=negatives)
    y, x = np.mgrid[:height, :width] / max(width, height)
    frames = []
    for frame in range(options.frames):
        levels = []
        for level in range(options.levels):
            waves = [np.sin(random.uniform(5, 40) * x + random.uniform(5, 40) * y + random.uniform(0, 6)) for _ in range(3)]
            field = np.stack(waves, -1) + 0.1 * random.normal(size=(height, width, 3))
            field /= np.linalg.norm(field, axis=-1, keepdims=True) * random.uniform(1, 1.2, (height, width, 1))
            levels.append(scratch / f"{frame}_{level}.npy")
            np.save(levels[-1], field.astype("f4"))
        frames.append(levels)
    return frames, weights, (positives, negatives)


def decode(latents: torch.Tensor, weights: list) -> torch.Tensor:
    """Embeddings of length 1."""
    for index, (weight, bias) in enumerate(weights):
        latents = torch.addmm(bias, latents, weight.T)
        if index + 1 < len(weights):
            latents.relu_()
    return latents / latents.norm(dim=-1, keepdim=True)


def fastest_slice(path: Path, weights: list) -> int:
    """Pixels that PyTorch decodes at once."""
    latents, weights = torch.from_numpy(np.load(path)).flatten(0, 1)[: SLICES[-1]], tensors(weights)
    times = {}
    for piece in SLICES:
        start = time.perf_counter()
        for part in latents.split(piece):
            decode(part, weights)
        times[piece] = time.perf_counter() - start
    return min(times, key=times.get)


def tensors(weights: list) -> list:
    """Weights as tensors."""
    return [tuple(torch.from_numpy(part) for part in pair) for pair in weights]


@torch.inference_mode()
def reference(frames: list, weights: list, texts: tuple, piece: int) -> tuple[list, dict]:
    """Masks of all frames, and the seconds of each step."""
    weights, masks = tensors(weights), []
    positives, negatives = (torch.from_numpy(part) for part in texts)
    pool = torch.nn.AvgPool2d(29, 1, 14, count_include_pad=False)
    majority = torch.nn.AvgPool2d(7, 1, 3, count_include_pad=False)
    spent = dict.fromkeys(("reading", "relevancy", "smoothing", "masks"), 0.0)
    for levels in frames:
        best = [(-1.0, None)] * len(positives)
        for path in levels:
            clock = time.perf_counter()

            def lap(part: str) -> None:
                nonlocal clock
                spent[part] += time.perf_counter() - clock
                clock = time.perf_counter()

            latents = torch.from_numpy(np.load(path))
            height, width, channels = latents.shape
            lap("reading")
            parts = []
            for part in latents.view(-1, channels).split(piece):
                embedding = decode(part, weights)
                margin = embedding @ positives.T - (embedding @ negatives.T).amax(1, keepdim=True)
                parts.append(torch.sigmoid(10 * margin))
            maps = torch.cat(parts).T.reshape(-1, height, width).contiguous()
            lap("relevancy")
            maps = 0.5 * (pool(maps[:, None])[:, 0] + maps)
            lap("smoothing")
            for prompt, values in enumerate(maps):
                peak = values.max().item()
                if peak > best[prompt][0]:
                    stretched = values - values.min()
                    stretched = torch.clip(stretched / (stretched.max() + 1e-9) * 2 - 1, 0, 1)
                    best[prompt] = (peak, (majority((stretched > 0.4).float()[None, None]) > 0.5)[0, 0])
            lap("masks")
        masks += [mask.numpy() for _, mask in best]
    return masks, spent


def iou(counts: str, mask: np.ndarray) -> float:
    """Agreement of run lengths with a mask."""
    runs, value, shift = [], 0, 0
    for character in counts:
        bits = ord(character) - 48
        value |= (bits & 31) << shift
        shift += 5
        if not bits & 32:
            value -= (1 << shift) if bits & 16 else 0
            runs.append(value + (runs[-2] if len(runs) > 2 else 0))
            value, shift = 0, 0
    flat = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    ours = flat.reshape(mask.shape[1], mask.shape[0]).T
    union = (ours | mask).sum()
    return float((ours & mask).sum() / union) if union else 1.0


def build() -> Path:
    """The example, optimised."""
    command = ["cargo", "build", "--release", "-p", "l4d-import", "--example", "relevancy_speed", "--message-format", "json"]
    lines = subprocess.run(command, check=True, capture_output=True, cwd=ROOT).stdout.splitlines()
    messages = [json.loads(line) for line in lines]
    return Path(next(m["executable"] for m in messages if m.get("target", {}).get("name") == "relevancy_speed" and m.get("executable")))


if __name__ == "__main__":
    main()
