"""The workflow on this machine, from a rendered scene to the leaderboard."""

import json
import os
import signal
import subprocess
import time

from conftest import METHOD, SCENE, answers, command_line, config, job_counts, snakemake


def test_a_scene_becomes_a_board_and_stays_one(rendered, bare, l4d):
    output = snakemake(rendered, "--cores", 1, **config(l4d))
    assert job_counts(output)["total"] == 9
    board = json.loads((rendered / "leaderboard" / "board.json").read_text())
    assert METHOD in json.dumps(board)
    assert answers(rendered) == answers(bare)
    assert "Nothing to be done" in snakemake(rendered, "--cores", 1, **config(l4d))


def test_a_killed_run_goes_on(rendered, bare, l4d):
    command = command_line("--cores", 1, **config(l4d))
    running = subprocess.Popen(command, cwd=rendered, start_new_session=True, stderr=subprocess.DEVNULL)
    splats = rendered / "work" / "tiny" / SCENE / "splats"
    end = time.monotonic() + 120
    while not splats.exists() and running.poll() is None and time.monotonic() < end:
        time.sleep(0.1)
    os.killpg(running.pid, signal.SIGKILL)
    running.wait()
    assert splats.exists()
    assert not (rendered / "leaderboard").exists()

    # The killed run left its lock behind.
    subprocess.run([*command, "--unlock"], cwd=rendered, check=True, capture_output=True)
    snakemake(rendered, "--cores", 1, **config(l4d))
    assert answers(rendered) == answers(bare)
