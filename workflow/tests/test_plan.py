"""What the workflow means to do: nothing is run."""

import os
import re
import subprocess
import sys
import time

import pytest
from conftest import DEV, ROOT, job_counts, snakemake

ONCE = {"blender": 1, "baselines": 1, "answers": 1, "score": 1, "leaderboard": 1, "all": 1}


def dry(folder, *options, **config):
    # --quiet host: the table of jobs is printed once.
    return snakemake(folder, "--dry-run", "--quiet", "rules", *options, **config)


def test_the_graph_of_dev(tmp_path):
    counts = job_counts(dry(tmp_path, bench=DEV, profile="tiny", render_blocks=3, solve_blocks=2))
    each = dict(plan=12, render=36, settle=12, check=12, train=12, solve=24)
    assert counts == {**each, **ONCE, "total": 12 * 9 + 6}


def test_a_scene_of_one_block_is_planned_rendered_and_settled_by_one_job(tmp_path):
    counts = job_counts(dry(tmp_path, bench=DEV, profile="tiny"))
    assert counts == {**dict(render=12, check=12, train=12, solve=12), **ONCE, "total": 12 * 4 + 6}


def test_scenes_can_be_chosen_and_begun_in_the_middle(tmp_path):
    for name in ("room_0506", "room_0507"):
        scene = tmp_path / "data" / "tiny" / name / "scene.json"
        scene.parent.mkdir(parents=True)
        scene.write_text("{}")
    output = dry(tmp_path, bench=DEV, profile="tiny", scenes="room_0506,room_0507", start="train", baselines=False)
    assert job_counts(output) == dict(check=2, train=2, solve=2, answers=1, score=1, leaderboard=1, all=1, total=10)


def test_a_scene_has_no_more_blocks_than_frames(tmp_path):
    counts = job_counts(dry(tmp_path, bench=DEV, profile="tiny", render_blocks=400))
    assert counts["render"] == 12 * 9


def test_more_than_400_jobs_are_planned_in_20_seconds(tmp_path):
    before = time.monotonic()
    counts = job_counts(dry(tmp_path, bench=ROOT / "benchmark", profile="small", render_blocks=8, solve_blocks=8))
    seconds = time.monotonic() - before
    print(f"{counts['total']} jobs planned in {seconds:.1f} s")
    assert counts["total"] == 21 * (1 + 8 + 1 + 1 + 1 + 8) + 6 > 400
    assert seconds < 20


def test_training_data_come_in_blocks_of_seeds(tmp_path):
    options = ["--dry-run", "--printshellcmds", "training"]
    training = '{"folder": "tr", "compose": 25, "arrange": 12}'
    output = snakemake(tmp_path, *options, bench=ROOT / "benchmark", training=training)
    assert job_counts(output) == dict(compose=3, render_composed=3, arrange=2, training=1, total=9)
    assert "--seed 1020 --count 5 " in output
    assert "--seed 100010 --count 2 " in output


def test_kubernetes_is_planned_with_signs_in_place_of_files(tmp_path):
    # Planned only: there is no cluster.
    counts = job_counts(dry(tmp_path, engine="kubernetes", bench=DEV, profile="tiny", work=tmp_path / "work"))
    assert counts["total"] == 12 * 4 + 6


@pytest.mark.parametrize("engine", ["slurm", "local", "kubernetes"])
def test_what_cluster_init_writes_is_planned_as_it_was_estimated(tmp_path, l4d, engine):
    init = [l4d, "cluster", "init", tmp_path / "cluster", "--engine", engine, "--profile", "full"]
    scenes = ["--scenes", "room_office,tabletop_tea", "--runtime", "30"]
    folders = [f"--{name}={tmp_path / name}" for name in ("data", "work", "results", "scores", "leaderboard")]
    said = subprocess.run([*init, *scenes, *folders], cwd=ROOT, check=True, text=True, capture_output=True).stdout
    (jobs,) = re.findall(r"^2 scenes at full: (\d+) jobs, 3298 pictures", said, re.MULTILINE)
    plan = [sys.executable, "-m", "snakemake", "--workflow-profile", tmp_path / "cluster" / "profile"]
    env = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache")}
    options = ["--dry-run", "--quiet", "rules"]
    done = subprocess.run([*plan, *options], cwd=tmp_path, env=env, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    counts = job_counts(done.stdout + done.stderr)
    assert counts["total"] == int(jobs) + counts["all"]
    # Four of 97 frames, 425 s each, within half an hour.
    assert counts["render"] == 2 * 25


@pytest.mark.parametrize("wrong", [dict(profile="huge"), dict(start="end")])
def test_unknown_words_are_refused(tmp_path, wrong):
    with pytest.raises(AssertionError, match="not '(huge|end)'"):
        dry(tmp_path, bench=DEV, **wrong)
