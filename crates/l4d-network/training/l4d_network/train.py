"""Learning: `python -m l4d_network.train`. Can be stopped at any moment and started again with the same command."""

from __future__ import annotations

import argparse
import copy
import json
import math
import os
import time
from pathlib import Path

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from . import data
from .batch import Batch, Pictures
from .data import Scene
from .evaluate import evaluate
from .model import Encoder, Network, Size, Vocabulary, pool

WARM = 200
"""Iterations until the full rate."""
AVERAGED_OVER = 500
"""Iterations over which the weights are averaged that are judged and exported."""


def main() -> None:
    """Learns from the pictures of some folders or packs."""
    options = _options()
    torch.set_num_threads(options.threads)
    torch.manual_seed(options.seed)
    torch.set_float32_matmul_precision("high")
    device = torch.device(options.device)
    scenes = [scene for path in options.data for scene in data.read(path)]
    judged = {"dev": data.read(options.dev, options.dev_bench)} if options.dev else {}
    if options.unseen:
        scenes, judged["unseen"] = scenes[: -options.unseen], scenes[-options.unseen :]
    options.out.mkdir(parents=True, exist_ok=True)
    checkpoint = options.out / "checkpoint.pt"
    state = torch.load(checkpoint, weights_only=False, map_location=device) if checkpoint.is_file() else None
    words = state["words"] if state else data.vocabulary(scenes)
    size = state["size"] if state else Size(encoder=options.encoder)
    network = Network(words, Encoder(size.encoder, pretrained=not state and not options.from_scratch), size)
    network = network.to(device, memory_format=torch.channels_last)  # a third faster on processors
    averaged = copy.deepcopy(network).eval()
    optimiser = _optimiser(network, options.rate)
    first = 0
    if state:
        network.load_state_dict(state["network"])
        averaged.load_state_dict(state["averaged"])
        optimiser.load_state_dict(state["optimiser"])
        first = state["iteration"]
    _forget_after(options.out, first)
    pictures = Pictures(scenes, words, device)
    print(
        f"{len(scenes)} scenes, {len(pictures)} pictures, {len(words.kinds) - 1} nouns, {len(words.values)} values, "
        f"{sum(p.numel() for p in network.parameters()) / 1e6:.2f} M parameters",
        flush=True,
    )
    about = {"batch": options.batch, "rate": options.rate, "seed": options.seed, "encoder": size.encoder}
    about |= {"device": options.device, "layouts": len(scenes), "pictures": len(pictures), "unseen": options.unseen}
    (options.out / "run.json").write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")
    learner = _Learner(network, words, pictures.pixels_of_kinds(len(words.kinds)))
    started, sums = time.monotonic(), torch.zeros(5, device=device)
    for iteration in range(first + 1, options.iterations + 1):
        share = _share(iteration, options.iterations, started, options.seconds)
        for group in optimiser.param_groups:
            factor = min(1.0, iteration / WARM) * (0.5 * (1 + math.cos(math.pi * share)) * 0.99 + 0.01)
            group["lr"] = group["initial_lr"] * factor
        # Drawn from the iteration's number, so that a resumed run draws what it would have drawn.
        batch = pictures.draw(options.batch, options.seed * 1_000_003 + iteration)
        with torch.autocast(device.type, torch.bfloat16, enabled=device.type == "cuda"):
            losses = learner.losses(batch)
        optimiser.zero_grad()
        torch.stack(losses).sum().backward()
        nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        optimiser.step()
        _average(averaged, network, iteration)
        sums += torch.stack(losses).detach()
        ends = share >= 1.0
        if iteration % options.report == 0:
            _report(options.out, iteration, (sums / options.report).tolist(), started, iteration - first)
            sums.zero_()
        if iteration % options.every == 0 or ends:
            _save(checkpoint, network, averaged, optimiser, words, size, iteration)
            for name, held_out in judged.items():
                _judge(options.out / f"{name}.jsonl", iteration, averaged, held_out)
        if ends:
            break


def _share(iteration: int, last: int, started: float, seconds: float | None) -> float:
    """How much of the schedule is over: iterations, or seconds if those end first."""
    share = iteration / last
    return share if seconds is None else min(1.0, max(share, (time.monotonic() - started) / seconds))


class _Learner:
    """What a batch costs: things and kinds of pixels, centres, offsets, kinds and attributes of objects."""

    def __init__(self, network: Network, words: Vocabulary, pixels: Tensor) -> None:
        self._network, self._words = network, words
        by_key = words.by_key()
        members = torch.zeros(len(words.values), len(by_key))
        for number, choices in enumerate(by_key.values()):
            members[choices, number] = 1.0
        self._members = members.to(pixels.device)
        self._weights = _pixel_weights(pixels)

    def losses(self, batch: Batch) -> list[Tensor]:
        """One loss for each head."""
        features, pixels, parts = self._network(batch.pictures)
        of_pixels = self._network.pixel_kind(features[0]).float()
        features, pixels = [level.float() for level in features], pixels.float()
        inside = (batch.kinds > 0).float()
        thing = F.binary_cross_entropy_with_logits(pixels[:, 0], inside)
        by_kind = F.cross_entropy(of_pixels, batch.kinds, weight=self._weights)
        to_centre = ((pixels[:, 1] - batch.centre) ** 2 * (1 + 20 * batch.centre)).mean() * 4
        to_offset = ((pixels[:, 2:] - batch.offset).abs() * inside[:, None]).sum() / (inside.sum() + 1) * 0.5
        of_kinds, of_values = self._objects(batch, features, parts)
        return [0.5 * thing + 0.7 * by_kind, to_centre, to_offset, of_kinds, of_values]

    def _objects(self, batch: Batch, features: list[Tensor], parts: Tensor) -> tuple[Tensor, Tensor]:
        with torch.autocast(batch.pictures.device.type, enabled=False):
            rows = pool(features, F.avg_pool2d(batch.pictures, 2), parts, batch.masks)[batch.rows]
        if not len(rows):
            return rows.sum(), rows.sum()
        known = F.one_hot(batch.nouns, len(self._words.kinds)).float()
        # Part of the time the network's own guess, as it will have to do.
        logits, values = self._network.describe(rows, known if torch.rand(()) < 0.7 else None)
        of_kinds = F.cross_entropy(logits.float(), batch.nouns, label_smoothing=0.05)
        return of_kinds, 0.5 * self._of_values(values.float(), batch.values)

    def _of_values(self, logits: Tensor, wanted: Tensor) -> Tensor:
        """Cross entropy among the values of each key, over all keys that an object has."""
        highest = logits.amax(1, keepdim=True).detach()
        among = ((logits - highest).exp() @ self._members).clamp(min=1e-30).log() + highest
        right = torch.gather(logits, 1, wanted.clamp(min=0))
        asked = (wanted >= 0).float()
        return ((among - right) * asked).sum() / asked.sum().clamp(min=1.0)


def _pixel_weights(pixels: Tensor) -> Tensor:
    """Rare kinds count more, the background less."""
    weights = (pixels / pixels.sum() + 1e-4) ** -0.35
    weights /= weights.mean()
    weights[0] = weights[0].clamp(max=0.5)
    return weights


def _average(averaged: Network, network: Network, iteration: int) -> None:
    decay = min(1.0 - 1.0 / AVERAGED_OVER, iteration / (iteration + 10.0))
    with torch.no_grad():
        torch._foreach_lerp_(list(averaged.parameters()), list(network.parameters()), 1.0 - decay)
        for mean, value in zip(averaged.buffers(), network.buffers()):
            mean.copy_(mean.lerp(value, 1.0 - decay) if mean.is_floating_point() else value)


def _optimiser(network: Network, rate: float) -> torch.optim.AdamW:
    encoder = list(network.encoder.parameters())
    rest = [p for name, p in network.named_parameters() if not name.startswith("encoder.")]
    groups = [
        {"params": encoder, "lr": 0.3 * rate, "initial_lr": 0.3 * rate},
        {"params": rest, "lr": rate, "initial_lr": rate},
    ]
    return torch.optim.AdamW(groups, weight_decay=2e-2)


def _save(
    path: Path,
    network: Network,
    averaged: Network,
    optimiser: torch.optim.Optimizer,
    words: Vocabulary,
    size: Size,
    iteration: int,
) -> None:
    content = {
        "network": network.state_dict(),
        "averaged": averaged.state_dict(),
        "optimiser": optimiser.state_dict(),
        "words": words,
        "size": size,
        "iteration": iteration,
    }
    temporary = path.with_suffix(".tmp")
    torch.save(content, temporary)
    os.replace(temporary, path)


def _forget_after(out: Path, iteration: int) -> None:
    """Leaves out of the curves what a killed run wrote after its last checkpoint: it is learned again."""
    for path in out.glob("*.jsonl"):
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        whole = [line for line in lines if line.endswith("\n") and json.loads(line)["iteration"] <= iteration]
        path.write_text("".join(whole), encoding="utf-8")


def _report(out: Path, iteration: int, losses: list[float], started: float, done: int) -> None:
    seconds = (time.monotonic() - started) / done
    line = {"iteration": iteration, "losses": [round(loss, 4) for loss in losses], "seconds": round(seconds, 4)}
    print(json.dumps(line), flush=True)
    with (out / "curve.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


def _judge(path: Path, iteration: int, network: Network, scenes: list[Scene]) -> None:
    line = {"iteration": iteration, **evaluate(network, scenes)}
    shown = {key: value for key, value in line.items() if not isinstance(value, dict)}
    print(json.dumps({"judged": path.stem, **shown}), flush=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="l4d_network.train", description=__doc__)
    parser.add_argument("--data", type=Path, action="append", required=True, help="arrangements or a pack; repeatable")
    parser.add_argument("--dev", type=Path, help="folder of built scenes, or their pack, to judge by")
    parser.add_argument("--dev-bench", type=Path, help="the benchmark folder that describes those")
    parser.add_argument("--unseen", type=int, default=0, help="layouts, the last, to judge by and not to learn from")
    parser.add_argument("--out", type=Path, required=True, help="checkpoint and curves")
    parser.add_argument("--encoder", default=Size().encoder, help=f"({Size().encoder})")
    parser.add_argument("--device", default="cpu", help="cpu or cuda (cpu)")
    parser.add_argument("--iterations", type=int, default=6000)
    parser.add_argument("--seconds", type=float, help="end the schedule after so long, if it is not over by then")
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
