"""A render on two nodes of a Slurm cluster against the same on one: real daemons on this machine, a core a node.

    python perf/two_nodes.py --scene tabletop_mouse_cups

Sends `workflow/l4d.sbatch build-scenes --profile small --samples 0` as an array of 8, first to a cluster of one node, then
to one of two, and prints one JSON object with the seconds of both and their ratio. Needs what `workflow/tests/cluster.py` does.
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

from cluster import Cluster, lacks  # noqa: E402

PARTS = 8


def seconds_with(nodes, options, folder):
    data = folder / "data"
    render = ["build-scenes", "--profile", "small", "--samples", "0", "--scenes", options.scene, "--data", str(data)]
    plan = [str(options.l4d.resolve()), "--quiet", *render, "--tracks-only"]
    subprocess.run(plan, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    with Cluster(folder / "cluster", nodes=nodes) as cluster:
        command = ["sbatch", "--wait", f"--array=1-{PARTS}", "--cpus-per-task=1", f"--output={folder}/%a.log"]
        command += [str(ROOT / "workflow/l4d.sbatch"), *render]
        began = time.monotonic()
        env = {**cluster.env, "L4D": str(options.l4d.resolve())}
        subprocess.run(command, cwd=ROOT, env=env, check=True, stdout=subprocess.DEVNULL)
        return time.monotonic() - began


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", required=True)
    parser.add_argument("--l4d", type=Path, default=ROOT / "target/release/l4d")
    options = parser.parse_args()
    if lacks() or len(os.sched_getaffinity(0)) < 2:
        sys.exit(lacks() or "needs two cores")
    found = {}
    for nodes in (1, 2):
        with tempfile.TemporaryDirectory() as folder:
            found[nodes] = round(seconds_with(nodes, options, Path(folder)), 1)
    print(json.dumps({"one_node_s": found[1], "two_nodes_s": found[2], "ratio": round(found[1] / found[2], 2)}))
