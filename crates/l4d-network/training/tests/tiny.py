"""A tiny network with drawn weights, for the tests of the Rust side: `python tests/tiny.py ../tests/data`.

It has seen nothing; what counts is that PyTorch and Rust compute the same.
"""

from __future__ import annotations

import sys
from pathlib import Path

import torch
from torch import Tensor, nn

sys.path.insert(0, str(Path(__file__).parents[1]))

from l4d_network import export
from l4d_network.model import Network, Size, Vocabulary


class TinyEncoder(nn.Module):
    """Halves five times."""

    CHANNELS = (4, 5, 6, 7, 8)

    def __init__(self) -> None:
        super().__init__()
        inputs = (3, *self.CHANNELS[:-1])
        self.steps = nn.ModuleList(
            nn.Conv2d(i, o, 3, stride=2, padding=1) for i, o in zip(inputs, self.CHANNELS)
        )

    def forward(self, x: Tensor) -> list[Tensor]:
        found = []
        for step in self.steps:
            x = step(x).relu()
            found.append(x)
        return found


def main(out: Path) -> None:
    """Writes the weights, their description and what PyTorch computes."""
    torch.manual_seed(5)
    words = Vocabulary(
        ("", "ball", "cat", "cup", "person", "woman"),
        (("colour", "blue"), ("colour", "red"), ("size", "large"), ("size", "small")),
    )
    network = Network(words, TinyEncoder(), Size("tiny", (4, 5, 6, 7, 8), 16, 32, 3))
    with torch.no_grad():
        network.pixel.weight *= 6.0
        network.pixel.bias.copy_(torch.tensor([0.3, 0.4, 0.0, 0.0]))
    export.write(network, out, {"data": "none: weights are drawn"})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
