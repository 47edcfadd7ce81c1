"""Tracks, contact and the plan: numbers that can be worked out by hand."""

from __future__ import annotations

import json

import numpy as np
import pytest
from conftest import TOY, start_worker

from l4d_blender.scene.cameras import training_subset
from l4d_blender.scene.timeline import PROFILES
from l4d_blender.worker.tracks import contact_runs


def track(tracks: dict, name: str) -> dict[str, np.ndarray]:
    entry = next(instance for instance in tracks["instances"] if instance["name"] == name)
    return {key: np.array(value) for key, value in entry["track"].items()}


def pair(tracks: dict, a: str, b: str) -> dict:
    return next(entry for entry in tracks["pairs"] if {entry["a"], entry["b"]} == {a, b})


def test_a_still_thing_has_one_entry_and_a_mover_97(tracks):
    for entry in tracks["instances"]:
        lengths = {len(values) for values in entry["track"].values()}
        assert lengths == ({97} if entry["name"] in {"crate_sliding", "post"} else {1})


def test_a_sliding_box_keeps_its_size_and_axes_and_moves_its_centre(tracks):
    crate = track(tracks, "crate_sliding")
    assert crate["extents"] == pytest.approx(np.tile([0.3, 0.4, 0.25], (97, 1)), abs=2e-6)
    assert crate["centre"][96] - crate["centre"][0] == pytest.approx([1.2, 0.0, 0.0], abs=2e-6)
    assert crate["centre"][36] - crate["centre"][0] == pytest.approx([0.6, 0.0, 0.0], abs=2e-6)
    assert crate["centre"][:, 2] == pytest.approx(0.125, abs=2e-6)
    c, s = np.cos(0.3), np.sin(0.3)
    assert crate["axes"][5] == pytest.approx([c, -s, 0, s, c, 0, 0, 0, 1], abs=2e-6)


def test_a_bending_body_has_an_upright_box_round_its_posed_mesh(tracks):
    post = track(tracks, "post")
    assert post["axes"] == pytest.approx(np.tile(np.eye(3).ravel(), (97, 1)), abs=2e-6)
    assert post["extents"][0] == pytest.approx([0.14, 0.14, 0.8], abs=1e-4)
    assert post["extents"][96][0] > 0.4
    assert post["extents"][96][2] < 0.5


def test_the_distance_from_a_crate_to_a_ball_is_what_a_ruler_says(tracks):
    """By hand: the ball's centre against the crate's oriented box, whose edges are rounded by 10 mm."""
    crate = track(tracks, "crate_sliding")
    ball = track(tracks, "ball")["centre"][0]
    for frame in (0, 30, 60):
        rotation = crate["axes"][frame].reshape(3, 3)
        local = np.abs(rotation.T @ (ball - crate["centre"][frame])) - crate["extents"][frame] / 2
        expected = np.linalg.norm(np.maximum(local, 0.0)) - 0.15
        measured = pair(tracks, "crate_sliding", "ball")["distance_m"][frame]
        assert -1e-5 <= measured - expected <= 0.010 * (np.sqrt(2) - 1) + 2e-3


def test_contact_is_where_the_picture_has_it(tracks):
    touching = pair(tracks, "ball", "post")
    ((first, last),) = touching["contact"]
    assert last == 96
    assert 40 < first < 70
    assert touching["distance_m"][0] > 0.1


def test_contact_begins_at_5_mm_and_ends_beyond_10_mm():
    far, near, between = 0.02, 0.005, 0.0099
    assert contact_runs([far, between, near, between, between, far, between]) == [[2, 4]]
    assert contact_runs([near, far, near]) == [[0, 0], [2, 2]]
    assert contact_runs([far, between]) == []
    assert contact_runs([near]) == [[0, 96]]
    assert contact_runs([far]) == []


def test_events_name_instances_and_stay_on_the_timeline(tracks):
    names = {entry["name"] for entry in tracks["instances"]}
    assert [event["verb"] for event in tracks["events"]] == ["slide", "lean", "touch"]
    for event in tracks["events"]:
        assert event["subject"] in names
        assert event["object"] is None or event["object"] in names
        assert 0 <= event["frames"][0] <= event["frames"][1] - 12 <= 84


def test_the_test_view_is_an_inner_camera_of_every_profile(tracks):
    held_out = [camera for camera in tracks["cameras"] if camera["split"] == "test"]
    assert len(held_out) == 1
    assert held_out[0]["name"] not in {"cam00", "cam16"}
    assert held_out[0]["profiles"] == ["tiny", "small", "full"]
    for profile in PROFILES.values():
        used = [camera for camera in tracks["cameras"] if profile.name in camera["profiles"]]
        assert len(used) == profile.training_views + 1


def test_training_views_of_smaller_profiles_are_spread_over_the_arc():
    training = [f"cam{i:02}" for i in range(17) if i != 7]
    assert training_subset(training, 4) == ["cam00", "cam05", "cam11", "cam16"]
    small = training_subset(training, 12)
    assert len(set(small)) == 12
    assert small[0] == "cam00"
    assert small[-1] == "cam16"


def test_cameras_look_at_the_target_with_x_right_y_down_z_forward(tracks):
    for camera in tracks["cameras"]:
        pose = np.array(camera["world_from_camera"][0]).reshape(4, 4)
        rotation = pose[:3, :3]
        assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=5e-6)
        assert np.linalg.det(rotation) == pytest.approx(1.0, abs=5e-6)
        assert rotation[2, 1] < 0.0, "image y points down"
        x, y, z = rotation.T @ (np.array([0.0, 0.0, 0.25]) - pose[:3, 3])
        assert z > 2.0
        assert abs(x / z) < 0.1
        assert abs(y / z) < 0.1


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_scene(planned, tmp_path):
    for seed in ("0", "1"):
        out = str(tmp_path / seed)
        options = ("--scene", "toy_yard", "--recipes", str(TOY), "--out", out, "--seed", seed)
        assert start_worker("plan", *options).returncode == 0
    for name in ("tracks.json", "plan.json", "scene.usdc"):
        assert (tmp_path / "0" / name).read_bytes() == (planned / name).read_bytes(), name
        assert (tmp_path / "1" / name).read_bytes() != (planned / name).read_bytes(), name


def test_the_plan_lists_the_scripts_and_the_gate(planned):
    plan = json.loads((planned / "plan.json").read_text())
    assert plan["schema"] == "l4d/plan/1"
    assert plan["bpy"] == "4.5.15"
    assert list(plan["scripts"]) == sorted(plan["scripts"])
    assert {"scenes/toy_yard.py", "l4d_blender/worker/passes.py", "l4d_blender/worker/exr.py"} <= set(
        plan["scripts"]
    )
    assert plan["gate"]["test"] in plan["gate"]["passing"]
    assert set(plan["gate"]["test_share"]) == {"crate_sliding", "crate_still", "ball", "post"}
