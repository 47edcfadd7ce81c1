"""What the workflow costs beside the bare verbs, and what a second node saves: real daemons on this machine, a core a node.

    python perf/workflow.py [--scenes NAMES] [--l4d FILE]

Builds and checks scenes at `tiny` with the bare verbs and through `workflow/Snakefile`, with two cores both times, and
renders one scene at `small` without light as eight tasks of `workflow/l4d.sbatch`, on a cluster of one node and of two.
Prints one JSON object with seconds and ratios. Needs an environment of Blender (`l4d doctor`), and what
`workflow/tests/requirements.txt` and `workflow/tests/cluster.py` name.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "workflow/tests"))

from cluster import Cluster, lacks
from conftest import command_line

SCENES = "tabletop_tea,tabletop_blocks,room_office,room_gym,outdoor_park_cats,outdoor_street_cars"
TASKS = 8


def seconds(command, env=None):
    began = time.monotonic()
    done = subprocess.run(
        list(map(str, command)),
        check=False,
        cwd=ROOT,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    if done.returncode:
        sys.exit(done.stdout.decode())
    return time.monotonic() - began


def bare(l4d, scenes, folder):
    options = ["--profile", "tiny", "--scenes", scenes, "--data", folder / "data"]
    return seconds([l4d, "build-scenes", *options, "--jobs", 2]) + seconds([l4d, "check-scenes", *options])


def workflow(l4d, scenes, folder):
    names = scenes.split(",")
    checks = [folder / f"work/tiny/workflow/check/{name}.json" for name in names]
    settings = {
        "l4d": l4d,
        "profile": "tiny",
        # Two scenes at once, as the bare verb has.
        "jobs": 1,
        "bench": ROOT / "benchmark",
        "blender_scripts": ROOT / "blender_scripts",
        "scenes": json.dumps(names),
        "data": folder / "data",
        "work": folder / "work",
        "python": next((ROOT / "work/blender-env").glob("*/bin/python")),
    }
    return seconds(command_line(*checks, "--cores", 2, "--directory", folder, **settings))


def nodes(count, l4d, scene, folder):
    render = ["build-scenes", "--profile", "small", "--scenes", scene, "--data", folder / "data"]
    seconds([l4d, *render, "--tracks-only"])
    with Cluster(folder / "cluster", nodes=count) as cluster:
        env = {**cluster.env, "L4D": str(l4d)}
        command = ["sbatch", f"--array=1-{TASKS}", "--cpus-per-task=1", f"--output={folder}/%a.log"]
        began = time.monotonic()
        seconds([*command, ROOT / "workflow/l4d.sbatch", *render, "--samples", 0], env)
        # `sbatch --wait` looks only every half minute in the end.
        while subprocess.check_output(["squeue", "--noheader"], env=env):
            time.sleep(0.2)
        return time.monotonic() - began


def measured(run, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        return round(run(*arguments, Path(folder)), 1)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", default=SCENES)
    parser.add_argument("--l4d", type=Path, default=ROOT / "target/release/l4d")
    options = parser.parse_args()
    if lacks() or len(os.sched_getaffinity(0)) < 2:
        sys.exit(lacks() or "needs two cores")
    l4d = options.l4d.resolve()
    alone = measured(bare, l4d, options.scenes)
    through = measured(workflow, l4d, options.scenes)
    one, two = (measured(nodes, count, l4d, options.scenes.split(",")[0]) for count in (1, 2))
    found = {"bare_s": alone, "workflow_s": through, "overhead": round(through / alone - 1, 3)}
    print(json.dumps({**found, "one_node_s": one, "two_nodes_s": two, "ratio": round(one / two, 2)}))
