"""Jobs, daemons and Snakemake itself killed at random points of the work: the bytes stay those of the bare verbs."""

import os
import random
import signal
import subprocess
import time
from pathlib import Path

import pytest
from cluster import Cluster, lacks
from conftest import METHOD, SCENE, answers, command_line, config

pytestmark = pytest.mark.skipif(bool(lacks()), reason=lacks())

BLOCKS = 49
# A node that says nothing for this long is given up, and its jobs are queued again.
SILENCE_S = 10


@pytest.fixture
def cluster(tmp_path_factory):
    with Cluster(tmp_path_factory.mktemp("cluster"), options=f"SlurmdTimeout={SILENCE_S}") as cluster:
        yield cluster


class Workflow:
    """Snakemake as a process of its own group, with fewer jobs at once than are ready."""

    def __init__(self, folder, l4d, cluster):
        options = ["--jobs", 4, "--latency-wait", 10, "--slurm-status-command", "squeue"]
        options += ["--slurm-init-seconds-before-status-checks", 2]
        settings = {**config(l4d), "solve_blocks": BLOCKS}
        self.command = command_line(*options, engine="slurm", **settings)
        self.env = {**cluster.env, "XDG_CACHE_HOME": str(folder / "cache")}
        self.folder, self.log = folder, folder / "snakemake.log"
        self.start()

    def start(self):
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                self.command, cwd=self.folder, env=self.env, start_new_session=True, stdout=log, stderr=log
            )

    def kill_and_start_again(self):
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        unlock = [*self.command, "--unlock"]
        subprocess.run(unlock, cwd=self.folder, env=self.env, check=True, capture_output=True)
        self.start()

    def blocks_done(self):
        return len(list((self.folder / "work" / "tiny" / "workflow" / "solve" / METHOD).glob(f"{SCENE}.*")))

    def until(self, is_true, what, seconds=300):
        end = time.monotonic() + seconds
        while not is_true():
            ended = self.process.poll()
            assert ended in (None, 0), self.log.read_text()[-6000:]
            assert time.monotonic() < end, f"{what}\n{self.log.read_text()[-6000:]}"
            time.sleep(0.1)


def answering(l4d):
    """Processes of jobs that answer queries."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if words[:2] == [str(l4d).encode(), b"solve"]:
            found.append(int(folder.name))
    return found


def kill_a_job(workflow, cluster, l4d):
    workflow.until(lambda: answering(l4d), "a job that answers")
    for process in answering(l4d)[:1]:
        os.kill(process, signal.SIGKILL)


def restart_a_node(workflow, cluster, l4d):
    cluster.stop("n1", signal.SIGKILL)
    cluster.start("n1")


def lose_a_node(workflow, cluster, l4d):
    """The daemon is gone for longer than the cluster waits; the jobs on it run on, beside those that replace them."""
    cluster.stop("n2", signal.SIGKILL)
    time.sleep(3 * SILENCE_S)
    cluster.start("n2")


def restart_the_controller(workflow, cluster, l4d):
    cluster.stop("slurmctld", signal.SIGKILL)
    time.sleep(1)
    cluster.start("slurmctld")


def restart_snakemake(workflow, cluster, l4d):
    workflow.kill_and_start_again()


KILLS = [kill_a_job, restart_a_node, lose_a_node, restart_the_controller, restart_snakemake]


def test_whatever_is_killed_the_bytes_stay(rendered, bare, l4d, cluster):
    draw = random.Random(1)
    kills = draw.sample(KILLS, len(KILLS))
    points = sorted(draw.sample(range(1, BLOCKS - 5), len(kills)))
    workflow = Workflow(rendered, l4d, cluster)
    for point, kill in zip(points, kills, strict=True):
        workflow.until(lambda point=point: workflow.blocks_done() >= point, f"block {point}, before {kill.__name__}")
        print(f"{workflow.blocks_done()} of {BLOCKS} blocks: {kill.__name__}", flush=True)
        kill(workflow, cluster, l4d)
    workflow.until(lambda: workflow.process.poll() == 0, "the end", seconds=600)
    assert answers(rendered) == answers(bare)
