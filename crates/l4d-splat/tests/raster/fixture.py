"""Writes torch.json: a small scene, its picture and its gradients as PyTorch's autograd finds them in float64.

    python crates/l4d-splat/tests/raster/fixture.py

Numbers that go in are rounded to float32 first, so that both sides start from the same values.
"""

import json
import sys
from pathlib import Path

import numpy as np
import torch

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[3] / "perf"))

from reference_splats import Splats, View, draw  # noqa: E402

BACKGROUND = (0.25, 0.5, 0.125)


def main() -> None:
    """One scene with everything in it: colours by direction, a turned camera, thin and large Gaussians."""
    random = np.random.default_rng(5)
    count = 28
    z = random.uniform(1.5, 5.0, count)
    rotations = random.normal(size=(count, 4))
    inputs = {
        "means": np.stack([z * random.uniform(-0.5, 0.5, count), z * random.uniform(-0.4, 0.4, count), z], 1),
        "scales": 0.02 * 25.0 ** random.random((count, 3)),
        "rotations": rotations / np.linalg.norm(rotations, axis=1, keepdims=True),
        "opacities": random.uniform(0.05, 1.0, count),
        "sh": random.uniform(-1, 1, (count, 16, 3)) * np.where(np.arange(16) == 0, 1.5, 0.25)[:, None],
    }
    inputs = {name: torch.tensor(value.astype(np.float32).astype(np.float64), requires_grad=True) for name, value in inputs.items()}
    angle = 0.3
    view = View(44, 30, 40.0, 44.0, 20.5, 16.0, [
        [np.cos(angle), 0.0, -np.sin(angle), 0.4], [0.0, 1.0, 0.0, -0.1], [np.sin(angle), 0.0, np.cos(angle), 0.2],
    ])  # fmt: skip
    drawn = draw(Splats(**inputs), view, BACKGROUND)
    weights = {name: torch.tensor(random.uniform(-1, 1, value.shape).astype(np.float32)) for name, value in drawn.items()}
    sum((value * weights[name].double()).sum() for name, value in drawn.items()).backward()
    fixture = {
        "view": vars(view),
        "background": BACKGROUND,
        "splats": {name: flat(value) for name, value in inputs.items()},
        "drawing": {name: flat(value) for name, value in drawn.items()},
        "weights": {name: flat(value) for name, value in weights.items()},
        "gradients": {name: flat(value.grad) for name, value in inputs.items()},
    }
    (HERE / "torch.json").write_text(json.dumps(fixture) + "\n")


def flat(values: torch.Tensor) -> list[float]:
    """The numbers in order, with more digits than float32 has."""
    return [float(f"{value:.9g}") for value in values.detach().double().flatten().tolist()]


if __name__ == "__main__":
    main()
