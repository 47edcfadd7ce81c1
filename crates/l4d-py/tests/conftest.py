"""What the tests share. The folder that they run in is made by tests/python.rs: a rendered scene, its benchmark, results,
scores and splats, and what Rust says of them."""

import hashlib
import json
import os
from pathlib import Path

import numpy as np
import pytest

import l4d


@pytest.fixture(scope="session")
def world() -> Path:
    return Path.cwd()


@pytest.fixture(scope="session")
def root() -> Path:
    """The project's folder."""
    return Path(os.environ["L4D_ROOT"])


@pytest.fixture(scope="session")
def expected(world: Path) -> dict:
    return json.loads((world / "expected.json").read_text())


@pytest.fixture(scope="session")
def scene(world: Path) -> l4d.Scene:
    return l4d.Scene(world / "data/tiny/ball")


@pytest.fixture(scope="session")
def benchmark(world: Path) -> l4d.Benchmark:
    return l4d.Benchmark(world / "benchmark", profile="tiny")


def digest(array: np.ndarray) -> str:
    assert array.flags.c_contiguous
    return hashlib.sha256(array.tobytes()).hexdigest()
