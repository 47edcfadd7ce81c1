"""How fast the identity field learns: seconds of an iteration in l4d and in PyTorch, as ratios in one run.

    python perf/lift_field.py data/small/room_office work/small/room_office/splats

The PyTorch versions minimise the objective of the paper as it is written (section 4; SA4D): phi over all Gaussians
twice an iteration, 32 features blended into every pixel, a 1x1 convolution and cross-entropy, distances from 1000
sampled Gaussians to all others for the divergence, Adam.

`torch_drawn` does what l4d does: it rasterizes the picture of each iteration, with reference_splats.py. Projection and
lists of tiles are kept, geometry being frozen; only blending is done anew.
`torch_literal` is spared that too: blend weights of some pictures come from l4d as sparse matrices (both ways, so that
no transpose is made in an iteration) and stay in memory, which those of a whole clip would not.
`torch_savings` is the latter with the savings that change no number: one evaluation, one channel, neighbours looked up.

l4d learns on the whole clip and rasterizes each picture anew. All run in turn, `--rounds` times, and the best time counts:
on a busy machine only the ratios of one run mean anything. Needs cargo, numpy and PyTorch.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from reference_splats import Splats, View, project, spread, tile_lists

ROOT = Path(__file__).resolve().parents[1]


class Blend(torch.autograd.Function):
    """A @ features, with A and its transpose at hand."""

    @staticmethod
    def forward(context, features, matrix, transposed):
        context.transposed = transposed
        return matrix @ features

    @staticmethod
    def backward(context, gradient):
        return context.transposed @ gradient, None, None


class Field(torch.nn.Module):
    """phi and the decoder."""

    def __init__(self):
        super().__init__()
        widths = [72, 256, 256, 256, 32]
        layers = []
        for inputs, outputs in zip(widths, widths[1:]):
            layers += [torch.nn.Linear(inputs, outputs), torch.nn.ReLU()]
            torch.nn.init.xavier_uniform_(layers[-2].weight)
        self.phi = torch.nn.Sequential(*layers[:-1])
        self.decoder = torch.nn.Conv2d(32, 2, kernel_size=1)

    def classes(self, features):
        """Logits of rows of features."""
        return self.decoder(features.t()[None, :, :, None])[0, :, :, 0].t()


def encode(numbers, frequencies):
    """The numbers, their sines and their cosines at doubling frequencies."""
    angles = (numbers[..., None] * 2.0 ** torch.arange(frequencies)).flatten(-2)
    return torch.cat([numbers, angles.sin(), angles.cos()], -1)


def pictures(folder: Path, count: int):
    """What the example exported."""
    index = json.loads((folder / "index.json").read_text())
    for picture, (moment, view) in enumerate(zip(index["times"], index["views"])):
        read = lambda name, kind: torch.from_numpy(np.fromfile(folder / f"{picture}.{name}", kind).astype(kind))
        starts, gaussians = (read(name, "<u4").to(torch.int64) for name in ("starts.u32", "gaussians.u32"))
        size = (len(starts) - 1, count)
        matrix = torch.sparse_csr_tensor(starts, gaussians, read("weights.f32", "<f4"), size)
        transposed = matrix.to_sparse_coo().t().coalesce().to_sparse_csr()
        mask = read("mask.u32", "<u4").to(torch.int64)
        yield {
            "matrix": matrix,
            "transposed": transposed,
            "mask": mask,
            "means": read("means.f32", "<f4").reshape(-1, 3),
            "shapes": read("shapes.f32", "<f4").reshape(-1, 8),
            "view": View(**view),
            "time": encode(torch.tensor([[moment]], dtype=torch.float32), 4),
        }


def at_hand(features, picture):
    """Blended with weights that are known."""
    return Blend.apply(features, picture["matrix"], picture["transposed"])


def drawn(features, picture):
    """Blended by drawing them."""
    if "flat" not in picture:
        shapes, view = picture["shapes"], picture["view"]
        grey = torch.zeros(len(shapes), 1, 3)
        splats = Splats(picture["means"], shapes[:, :3], shapes[:, 3:7], shapes[:, 7], grey)
        picture["flat"] = project(splats, view)
        picture["lists"] = tile_lists(picture["flat"], view)
    flat = picture["flat"]
    return spread(flat, *picture["lists"], features[flat["kept"]], picture["view"]).flatten(0, 1)


def literal(field, picture, places, blend=at_hand):
    """The loss as it is written."""
    inputs = torch.cat([places, picture["time"].expand(len(places), -1)], -1)
    blended = blend(field.phi(inputs), picture)
    loss = F.cross_entropy(field.classes(blended), picture["mask"])
    identities = torch.softmax(field.classes(field.phi(inputs)), -1)
    sampled = torch.randperm(len(places))[:1000]
    near = torch.cdist(picture["means"][sampled], picture["means"]).topk(5, largest=False).indices
    p, q = identities[sampled][:, None], identities[near]
    divergence = (p * (torch.log(p + 1e-10) - torch.log(q + 1e-10))).sum(-1).mean()
    return loss + 2.0 * divergence


def savings(field, picture, places):
    """The same loss in fewer operations."""
    inputs = torch.cat([places, picture["time"].expand(len(places), -1)], -1)
    if "near" not in picture:
        parts = [torch.cdist(part, picture["means"]).topk(5, largest=False).indices for part in picture["means"].split(1000)]
        picture["near"] = torch.cat(parts)
    contrast = field.decoder.weight[1, :, 0, 0] - field.decoder.weight[0, :, 0, 0]
    bias = field.decoder.bias[1] - field.decoder.bias[0]
    logits = field.phi(inputs) @ contrast
    blended = Blend.apply(logits[:, None], picture["matrix"], picture["transposed"])[:, 0] + bias
    loss = F.binary_cross_entropy_with_logits(blended, picture["mask"].float())
    sampled = torch.randperm(len(places))[:1000]
    of, from_ = (logits + bias)[sampled][:, None], (logits + bias)[picture["near"][sampled]]
    positive = torch.sigmoid(of) * (F.logsigmoid(of) - F.logsigmoid(from_))
    negative = torch.sigmoid(-of) * (F.logsigmoid(-of) - F.logsigmoid(-from_))
    return loss + 2.0 * (positive + negative).mean()


def run_torch(loss, shots, places, iterations: int) -> float:
    """Seconds of an iteration."""
    torch.manual_seed(0)
    field = Field()
    adam = torch.optim.Adam(field.parameters(), lr=5e-4, eps=1e-15)
    seconds = []
    for iteration in range(iterations + 2):
        start = time.perf_counter()
        adam.zero_grad()
        loss(field, shots[iteration % len(shots)], places).backward()
        adam.step()
        seconds.append(time.perf_counter() - start)
    return float(np.median(seconds[2:]))


def run_l4d(binary: Path, options) -> float:
    """Seconds of an iteration, of the whole lift: what is done once is in it."""
    command = [binary, options.scene, options.splats, "learn", str(options.our_iterations)]
    seconds = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["seconds"]
    return seconds / options.our_iterations


def main() -> None:
    """Times everything in turn and prints the ratios."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("splats", type=Path)
    parser.add_argument("--pictures", type=int, default=4, help="pictures for PyTorch")
    parser.add_argument("--iterations", type=int, default=8, help="of PyTorch, a round")
    parser.add_argument("--our-iterations", type=int, default=2000, help="of l4d, a round")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--binary", type=Path, help="the built example lift_scene; without it cargo builds it")
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    binary = options.binary
    if binary is None:
        subprocess.run(["cargo", "build", "--release", "-p", "l4d-solve", "--example", "lift_scene"], check=True, cwd=ROOT)
        binary = ROOT / "target/release/examples/lift_scene"
    with tempfile.TemporaryDirectory(prefix="l4d-perf-") as scratch:
        export = [binary, options.scene, options.splats, "export", scratch, str(options.pictures)]
        subprocess.run(export, check=True)
        means = torch.from_numpy(np.fromfile(Path(scratch) / "means.f32", "<f4").reshape(-1, 3))
        shots = list(pictures(Path(scratch), len(means)))
    places = encode(means, 10)
    best: dict[str, float] = {}
    for _ in range(options.rounds):
        times = {
            "torch_drawn": run_torch(lambda *all_: literal(*all_, blend=drawn), shots, places, options.iterations),
            "torch_literal": run_torch(literal, shots, places, options.iterations),
            "torch_savings": run_torch(savings, shots, places, options.iterations),
            "l4d": run_l4d(binary, options),
        }
        for name, seconds in times.items():
            best[name] = min(best.get(name, float("inf")), seconds)
    ratios = {
        f"{theirs}_over_l4d": round(best[theirs] / best["l4d"], 2)
        for theirs in ("torch_drawn", "torch_literal", "torch_savings")
    }
    weights = float(np.mean([len(shot["matrix"].values()) for shot in shots]))
    about = {"gaussians": len(means), "weights_a_picture": round(weights), "torch": torch.__version__}
    print(json.dumps(about | {"seconds_an_iteration": best, "ratios": ratios}, indent=2))


if __name__ == "__main__":
    main()
