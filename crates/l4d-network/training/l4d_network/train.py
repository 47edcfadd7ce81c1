"""Learning: `python -m l4d_network.train`. Can be stopped at any moment and started again with the same command."""

from __future__ import annotations

import argparse
import json
import math
import os
import random
import time
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from . import data
from .data import Sample, Scene
from .evaluate import evaluate
from .model import Encoder, Network, Vocabulary, pool


def main() -> None:
    """Learns from the pictures of some folders."""
    options = _options()
    torch.set_num_threads(options.threads)
    torch.manual_seed(options.seed)
    scenes = [scene for folder in options.data for scene in data.read(folder)]
    if options.built:
        scenes += data.read(options.built, options.bench)
    dev = data.read(options.dev, options.dev_bench) if options.dev else []
    options.out.mkdir(parents=True, exist_ok=True)
    checkpoint = options.out / "checkpoint.pt"
    state = torch.load(checkpoint, weights_only=False) if checkpoint.is_file() else None
    words = state["words"] if state else data.vocabulary(scenes)
    network = Network(words, Encoder(pretrained=state is None and not options.from_scratch))
    network = network.to(memory_format=torch.channels_last)  # a third faster on processors
    pictures = sum(len(scene.colour) for scene in scenes)
    print(
        f"{len(scenes)} scenes, {pictures} pictures, {len(words.kinds) - 1} nouns, {len(words.values)} values, "
        f"{sum(p.numel() for p in network.parameters()) / 1e6:.2f} M parameters",
        flush=True,
    )
    optimiser = _optimiser(network, options.rate)
    first = 0
    if state:
        network.load_state_dict(state["network"])
        optimiser.load_state_dict(state["optimiser"])
        first = state["iteration"]
    learner = _Learner(network, words, scenes)
    rates = [group["lr"] if not state else group["initial_lr"] for group in optimiser.param_groups]
    for group, rate in zip(optimiser.param_groups, rates):
        group["initial_lr"] = rate
    started, sums = time.monotonic(), np.zeros(5)
    for iteration in range(first + 1, options.iterations + 1):
        share = iteration / options.iterations
        factor = min(1.0, iteration / 100) * (0.5 * (1 + math.cos(math.pi * share)) * 0.98 + 0.02)
        for group, rate in zip(optimiser.param_groups, rates):
            group["lr"] = rate * factor
        rng = random.Random(f"{options.seed}/{iteration}")  # so that a resumed run draws what it would have drawn
        samples = [data.draw(scenes, rng) for _ in range(options.batch)]
        losses = learner.losses(samples)
        optimiser.zero_grad()
        sum(losses).backward()
        nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        optimiser.step()
        sums += [float(loss.detach()) for loss in losses]
        if iteration % options.report == 0:
            _report(options.out, iteration, sums / options.report, started, iteration - first)
            sums[:] = 0.0
        if iteration % options.every == 0 or iteration == options.iterations:
            _save(checkpoint, network, optimiser, words, iteration)
            if dev:
                _judge(options.out, iteration, network, dev)


class _Learner:
    """What a batch costs: things and kinds of pixels, centres, offsets, kinds and attributes of objects."""

    def __init__(self, network: Network, words: Vocabulary, scenes: list[Scene]) -> None:
        self._network, self._words = network, words
        self._kind = {kind: number for number, kind in enumerate(words.kinds)}
        self._value = {pair: number for number, pair in enumerate(words.values)}
        self._by_key = words.by_key()
        self._weights = self._pixel_weights(scenes)

    def losses(self, samples: list[Sample]) -> list[Tensor]:
        """One loss for each head."""
        pictures = torch.stack([sample.picture for sample in samples])
        features, pixels = self._network(pictures)
        kinds = torch.stack([self._pixel_kinds(sample) for sample in samples])
        thing = F.binary_cross_entropy_with_logits(pixels[:, 0], (kinds > 0).float())
        by_kind = F.cross_entropy(self._network.pixel_kind(features[0]), kinds, weight=self._weights)
        centre = torch.stack([sample.centre for sample in samples])
        offset = torch.stack([sample.offset for sample in samples])
        to_centre = ((pixels[:, 1] - centre) ** 2 * (1 + 20 * centre)).mean() * 4
        inside = (kinds > 0)[:, None].float()
        to_offset = ((pixels[:, 2:] - offset).abs() * inside).sum() / (inside.sum() + 1) * 0.5
        of_kinds, of_values = self._objects(samples, features, pictures)
        return [0.5 * thing + 0.7 * by_kind, to_centre, to_offset, of_kinds, of_values]

    def _objects(self, samples: list[Sample], features: list[Tensor], pictures: Tensor) -> tuple[Tensor, Tensor]:
        half = F.avg_pool2d(pictures, 2)
        rows, kinds, asked = [], [], []
        for number, sample in enumerate(samples):
            if not sample.things:
                continue
            rows.append(pool([level[number] for level in features], half[number], sample.masks))
            for thing in sample.things:
                if thing.is_object:
                    asked += [(len(kinds), *pair) for pair in thing.attributes.items() if pair in self._value]
                kinds.append(self._kind.get(thing.kind, 0))
        if not rows:
            return torch.zeros(()), torch.zeros(())
        target = torch.tensor(kinds)
        known = F.one_hot(target, len(self._words.kinds)).float()
        # Half of the time the network's own guess, as it will have to do.
        logits, values = self._network.describe(torch.cat(rows), known if torch.rand(()) < 0.7 else None)
        of_kinds = F.cross_entropy(logits, target, label_smoothing=0.05)
        terms = []
        for row, key, value in asked:
            choices = self._by_key[key]
            wanted = choices.index(self._value[(key, value)])
            terms.append(F.cross_entropy(values[row, choices][None], torch.tensor([wanted])))
        of_values = torch.stack(terms).mean() if terms else torch.zeros(())
        return of_kinds, 0.5 * of_values

    def _pixel_kinds(self, sample: Sample) -> Tensor:
        table = torch.zeros(65536, dtype=torch.long)
        for number, thing in sample.scene.things.items():
            table[number] = self._kind.get(thing.kind, 0)
        return table[sample.ids]

    def _pixel_weights(self, scenes: list[Scene]) -> Tensor:
        """Rare kinds count more, the background less."""
        counts = np.zeros(len(self._words.kinds))
        for scene in scenes:
            numbers, pixels = np.unique(scene.ids, return_counts=True)
            for number, count in zip(numbers.tolist(), pixels.tolist()):
                thing = scene.things.get(number)
                counts[self._kind.get(thing.kind, 0) if thing else 0] += count
        weights = torch.tensor((counts / counts.sum() + 1e-4) ** -0.35, dtype=torch.float32)
        weights /= weights.mean()
        weights[0] = min(float(weights[0]), 0.5)
        return weights


def _optimiser(network: Network, rate: float) -> torch.optim.AdamW:
    encoder = list(network.encoder.parameters())
    rest = [p for name, p in network.named_parameters() if not name.startswith("encoder.")]
    groups = [{"params": encoder, "lr": 0.3 * rate}, {"params": rest, "lr": rate}]
    return torch.optim.AdamW(groups, weight_decay=1e-3)


def _save(
    path: Path, network: Network, optimiser: torch.optim.Optimizer, words: Vocabulary, iteration: int
) -> None:
    content = {
        "network": network.state_dict(),
        "optimiser": optimiser.state_dict(),
        "words": words,
        "iteration": iteration,
    }
    temporary = path.with_suffix(".tmp")
    torch.save(content, temporary)
    os.replace(temporary, path)


def _report(out: Path, iteration: int, losses: np.ndarray, started: float, done: int) -> None:
    seconds = (time.monotonic() - started) / done
    line = {"iteration": iteration, "losses": [round(float(loss), 4) for loss in losses], "seconds": round(seconds, 2)}
    print(json.dumps(line), flush=True)
    with (out / "curve.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


def _judge(out: Path, iteration: int, network: Network, dev: list[Scene]) -> None:
    network.eval()
    line = {"iteration": iteration, **evaluate(network, dev)}
    network.train()
    print(json.dumps({key: value for key, value in line.items() if not isinstance(value, dict)}), flush=True)
    with (out / "dev.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="l4d_network.train", description=__doc__)
    parser.add_argument("--data", type=Path, action="append", default=[], help="arrangements; may be repeated")
    parser.add_argument("--built", type=Path, help="folder of built training scenes")
    parser.add_argument("--bench", type=Path, help="the benchmark folder that describes them")
    parser.add_argument("--dev", type=Path, help="folder of built scenes to judge by")
    parser.add_argument("--dev-bench", type=Path, help="the benchmark folder that describes those")
    parser.add_argument("--out", type=Path, required=True, help="checkpoint and curves")
    parser.add_argument("--iterations", type=int, default=6000)
    parser.add_argument("--batch", type=int, default=8)
    parser.add_argument("--rate", type=float, default=1.5e-3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--every", type=int, default=200, help="iterations between checkpoints (200)")
    parser.add_argument("--report", type=int, default=50, help="iterations between lines of the curve (50)")
    parser.add_argument("--from-scratch", action="store_true", help="an encoder that has seen no ImageNet")
    return parser.parse_args()


if __name__ == "__main__":
    main()
