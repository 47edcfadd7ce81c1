"""Where things are, and how snakemake is called."""

import os
import re
import shutil
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DEV = ROOT / "benchmark" / "dev"
SCENE = "tabletop_0515"
METHOD = "panopticquery-panoptic"
TRAIN = "--coarse 100 --unfold 5 --fine 100"
PROFILES = ROOT / "workflow" / "profiles"


def program():
    """L4D says which l4d is meant; otherwise the one that cargo built."""
    return Path(os.environ.get("L4D", ROOT / "target" / "release" / "l4d"))


@pytest.fixture(scope="session")
def l4d():
    if not program().exists():
        pytest.skip(f"no {program()}: cargo build --release, or say which one with L4D")
    return program()


def copied(folder):
    """A working folder with a scene of dev that was rendered at tiny: L4D_DEV_TINY says where, see docs/cluster.md."""
    source = os.environ.get("L4D_DEV_TINY")
    if not source:
        pytest.skip("L4D_DEV_TINY does not say where scenes of benchmark/dev, rendered at tiny, are")
    shutil.copytree(DEV, folder / "bench")
    shutil.copytree(Path(source, SCENE), folder / "data" / SCENE)
    return folder


@pytest.fixture
def rendered(tmp_path):
    return copied(tmp_path)


@pytest.fixture(scope="session")
def bare(tmp_path_factory, l4d):
    """What the verbs leave without the workflow."""
    folder = copied(tmp_path_factory.mktemp("bare"))
    bench = ["--bench", "bench", "--profile", "tiny", "--data", "data"]
    for line in [
        ["train-splats", SCENE, *bench, *TRAIN.split()],
        ["solve", *bench, "--scenes", SCENE],
        ["score", *bench[:4], "--scenes", SCENE],
    ]:
        subprocess.run([l4d, *line], cwd=folder, check=True, capture_output=True)
    return folder


def config(l4d):
    """Settings for this scene, from its training on: a short one."""
    names = dict(bench="bench", profile="tiny", data="data", scenes=SCENE, start="train", l4d=l4d)
    return {**names, "jobs": 1, "solve_blocks": 2, "train_options": TRAIN}


def answers(folder):
    """Masks and counts: all that does not depend on how long things took."""
    counts = (folder / "scores" / METHOD / "counts.csv").read_text()
    return files(folder / "results" / METHOD / "masks"), counts


def command_line(*options, engine="local", **config):
    """What is typed to run the workflow."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", ROOT / "workflow" / "Snakefile"]
    command += ["--workflow-profile", PROFILES / engine, *options]
    command += ["--config", *(f"{name}={value}" for name, value in config.items())]
    return list(map(str, command))


def snakemake(folder, *options, engine="local", env=None, **config):
    """Runs the workflow in a folder; its output, both streams, if it ended well."""
    command = command_line(*options, engine=engine, **config)
    env = {**(env or os.environ), "XDG_CACHE_HOME": str(folder / "cache")}
    done = subprocess.run(command, cwd=folder, env=env, text=True, capture_output=True)
    output = done.stdout + done.stderr
    assert done.returncode == 0, output
    return output


def job_counts(output):
    """Jobs of each rule, as snakemake lists them."""
    table = output.split("Job stats:")[1]
    return {rule: int(count) for rule, count in re.findall(r"^(\w+) +(\d+)$", table, re.MULTILINE)}


def files(folder):
    """Digest of every file of a folder."""
    paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): sha256(path.read_bytes()).hexdigest() for path in paths}
