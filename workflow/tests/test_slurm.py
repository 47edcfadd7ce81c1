"""The workflow, and the script without one, on a cluster of two nodes: real daemons, started here."""

import subprocess

import pytest
from cluster import Cluster, lacks
from conftest import METHOD, ROOT, SCENE, answers, config, files, snakemake

pytestmark = pytest.mark.skipif(bool(lacks()), reason=lacks())


@pytest.fixture
def cluster(tmp_path_factory):
    with Cluster(tmp_path_factory.mktemp("cluster")) as cluster:
        yield cluster


def test_a_scene_becomes_a_board_on_two_nodes(rendered, bare, l4d, cluster):
    options = ["--slurm-status-command", "squeue", "--slurm-init-seconds-before-status-checks", 2]
    output = snakemake(rendered, *options, engine="slurm", env=cluster.env, **config(l4d))
    assert "has been submitted with SLURM jobid" in output
    assert (rendered / "leaderboard" / "index.html").exists()
    assert answers(rendered) == answers(bare)


def test_the_script_without_an_engine_shares_the_queries(bare, l4d, cluster, tmp_path):
    bench = ["--bench", "bench", "--profile", "tiny", "--data", "data", "--scenes", SCENE]
    command = ["sbatch", "--wait", "--array=1-4", "--cpus-per-task=1", f"--output={tmp_path}/%a.log"]
    command += [ROOT / "workflow" / "l4d.sbatch", "solve", *bench, "--name", "shared"]
    env = {**cluster.env, "L4D": str(l4d)}
    done = subprocess.run(list(map(str, command)), cwd=bare, env=env, text=True, capture_output=True)
    logs = {path.name: path.read_text() for path in tmp_path.glob("*.log")}
    assert done.returncode == 0, f"{done.stderr}\n{logs}"
    assert len(logs) == 4
    assert files(bare / "results" / "shared" / "masks") == files(bare / "results" / METHOD / "masks")


def test_a_task_that_is_told_to_stop_waits_for_time_again(cluster, tmp_path):
    slow = tmp_path / "slow"
    slow.write_text('#!/bin/bash\ntrap "echo stopped; exit 143" TERM\necho started\nsleep 300 & wait $!\n')
    slow.chmod(0o755)
    env = {**cluster.env, "L4D": str(slow)}
    command = ["sbatch", "--parsable", "--array=1", "--cpus-per-task=1", f"--output={tmp_path}/log"]
    command = list(map(str, [*command, ROOT / "workflow" / "l4d.sbatch", "solve"]))
    job = subprocess.run(command, env=env, text=True, capture_output=True, check=True).stdout.strip()
    log = tmp_path / "log"
    cluster.until(lambda: log.exists() and "started" in log.read_text(), "the task")
    cluster.call("scancel", "--signal=TERM", "--batch", f"{job}_1", check=True)
    state = ["squeue", "--noheader", "--format=%t %r", f"--jobs={job}"]
    cluster.until(lambda: "PD BeginTime" in cluster.call(*state).stdout, "the task in the queue")
    assert "stopped" in log.read_text()
