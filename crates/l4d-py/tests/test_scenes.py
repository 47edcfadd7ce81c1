"""Scenes, cameras and frames."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from conftest import digest

import l4d


def test_a_frame_has_the_bits_that_rust_reads(scene: l4d.Scene, expected: dict) -> None:
    frame = scene.frame(expected["view"], expected["frame"])
    assert [frame.rgb.dtype, frame.depth_m.dtype, frame.id.dtype] == [np.float32, np.float32, np.uint32]
    assert [frame.rgb.shape, frame.depth_m.shape, frame.id.shape] == [(96, 128, 3), (96, 128), (96, 128)]
    assert digest(frame.rgb) == expected["rgb"]
    assert digest(frame.depth_m) == expected["depth_m"]
    assert digest(frame.id) == expected["id"]
    display = frame.display()
    assert display.dtype == np.uint8 and display.shape == (96, 128, 3)
    assert digest(display) == expected["display"]
    assert (frame.view, frame.frame) == (expected["view"], expected["frame"])
    assert frame.rgb is frame.rgb, "arrays are made once"


def test_a_clip_is_its_frames(scene: l4d.Scene) -> None:
    clip = scene.clip("cam02")
    assert clip.frames == scene.frames == list(range(0, 97, 12)) and len(clip) == 9
    for at, number in enumerate(clip.frames):
        frame = scene.frame("cam02", number)
        assert np.array_equal(clip.rgb[at], frame.rgb) and np.array_equal(clip.depth_m[at], frame.depth_m)
        assert np.array_equal(clip.id[at], frame.id) and np.array_equal(clip.display()[at], frame.display())
    some = scene.clip("cam02", [24, 0])
    assert some.frames == [24, 0] and np.array_equal(some.rgb[1], clip.rgb[0])
    assert scene.clip("cam02", []).rgb.shape == (0, 96, 128, 3)


def test_a_scene_says_what_its_file_says(scene: l4d.Scene, world: Path) -> None:
    document = json.loads((world / "data/tiny/ball/scene.json").read_text())
    for field in ("name", "scale", "variant", "seed", "profile", "width", "height", "exposure"):
        assert getattr(scene, field) == document[field]
    assert [camera.name for camera in scene.cameras] == [camera["name"] for camera in document["cameras"]]
    assert [camera.name for camera in scene.training_cameras] == ["cam00", "cam01", "cam02", "cam03"]
    assert scene.test_camera.name == "cam04" and scene.test_camera.split == "test"
    ball = scene.instance("ball_a")
    assert (ball.id, ball.role, ball.category, ball.attributes, ball.front) == (1, "object", "ball", {}, None)
    assert [instance.name for instance in scene.instances] == ["ball_a", "ball_b"] and scene.events == []


def test_cameras_keep_every_bit_and_go_both_ways(scene: l4d.Scene, expected: dict) -> None:
    camera = scene.camera(expected["view"])
    pose = camera.world_from_camera()
    assert pose.dtype == np.float64 and pose.ravel().tolist() == expected["world_from_camera"]
    assert np.allclose(camera.camera_from_world() @ pose, np.eye(4), atol=1e-12)
    assert camera.intrinsics.tolist() == [[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]]

    frame = scene.frame(camera.name, 48)
    points = camera.unproject(frame.depth_m)
    origin, directions = camera.rays(frame=48)
    assert np.array_equal(origin, pose[:3, 3])
    assert np.allclose(points, origin + frame.depth_m[..., None] * directions, atol=1e-12)
    assert np.allclose((directions @ pose[:3, :3])[..., 2], 1), "planar depth: length 1 along the optical axis"
    positions, depth_m = camera.project(points.reshape(-1, 3))
    rows, columns = np.mgrid[:96, :128]
    assert np.allclose(positions, np.stack([columns + 0.5, rows + 0.5], -1).reshape(-1, 2), atol=1e-9)
    assert np.allclose(depth_m, frame.depth_m.ravel(), atol=1e-9)

    sky = np.full((96, 128), np.inf, np.float32)
    assert np.isnan(camera.unproject(sky)).all()
    half = camera.resized(64, 48)
    assert (half.width, half.fx, half.cy) == (64, camera.fx / 2, camera.cy / 2) and not half.moves


def test_two_views_agree_on_a_point(scene: l4d.Scene) -> None:
    """The ball's nearest pixel of one view lands on the ball of another."""
    one, other = scene.camera("cam01"), scene.camera("cam02")
    frame = scene.frame("cam01", 48)
    row, column = np.argwhere(frame.id == 1).mean(axis=0).astype(int)
    point = one.unproject(frame.depth_m)[row, column]
    position, _ = other.project(point[None])
    column, row = np.floor(position[0]).astype(int)
    assert scene.frame("cam02", 48).id[row, column] == 1


def test_cameras_can_be_made(scene: l4d.Scene) -> None:
    camera = scene.camera("cam00")
    again = l4d.Camera("mine", 128, 96, camera.fx, camera.fy, camera.cx, camera.cy, camera.world_from_camera())
    assert again.split == "train" and np.array_equal(again.world_from_camera(), camera.world_from_camera())
    moving = np.repeat(camera.world_from_camera()[None], 97, axis=0)
    moving[:, 0, 3] += np.arange(97)
    moving = l4d.Camera("mine", 128, 96, 9, 9, 4, 4, moving, split="test")
    assert moving.moves and moving.world_from_camera(96)[0, 3] == moving.world_from_camera()[0, 3] + 96
    mirrored = np.diag([1.0, 1.0, -1.0, 1.0])
    with pytest.raises(l4d.L4dError, match="rigid") as told:
        l4d.Camera("mine", 128, 96, 9, 9, 4, 4, mirrored)
    assert told.value.field == "camera"
    with pytest.raises(l4d.L4dError, match="97 poses, none for frame 97"):
        moving.world_from_camera(97)
    with pytest.raises(l4d.L4dError, match=r"shape \[3, 4\]"):
        l4d.Camera("mine", 128, 96, 9, 9, 4, 4, np.eye(4)[:3])


def test_timelines() -> None:
    timeline = l4d.Timeline("small")
    assert (timeline.profile, timeline.stride, timeline.fps, timeline.frame_count) == ("small", 2, 24.0, 97)
    assert timeline.frames == list(range(0, 97, 2))
    assert (timeline.seconds(96), timeline.unit_time(48), timeline.unit_time(96)) == (4.0, 0.5, 1.0)


def test_errors_say_where_and_what_to_do(scene: l4d.Scene, world: Path, tmp_path: Path) -> None:
    with pytest.raises(l4d.L4dError) as told:
        scene.frame("cam09", 0)
    assert (told.value.path, told.value.field) == (None, "view") and "cam00" in told.value.hint
    for frame in (1, 97):
        with pytest.raises(l4d.L4dError) as told:
            scene.frame("cam00", frame)
        assert told.value.field == "frame" and "not rendered" in told.value.message
    with pytest.raises(l4d.L4dError) as told:
        l4d.Scene(tmp_path / "nowhere")
    assert told.value.path.endswith("scene.json") and told.value.message.startswith("cannot open")
    assert "hint: " in str(told.value) and told.value.hint

    torn = tmp_path / "ball"
    (torn / "frames/cam00").mkdir(parents=True)
    (torn / "scene.json").write_bytes((world / "data/tiny/ball/scene.json").read_bytes())
    whole = (world / "data/tiny/ball/frames/cam00/0000.exr").read_bytes()
    (torn / "frames/cam00/0000.exr").write_bytes(whole[: len(whole) // 2])
    for read in (lambda: l4d.Scene(torn).frame("cam00", 0), lambda: l4d.Scene(torn).clip("cam00", [0])):
        with pytest.raises(l4d.L4dError) as told:
            read()
        assert told.value.path.endswith("0000.exr") and told.value.field == "EXR"
        assert "build-scenes" in told.value.hint

    again = pickle.loads(pickle.dumps(told.value))
    assert (again.path, again.hint, str(again)) == (told.value.path, told.value.hint, str(told.value))
    for hostile in ("../../etc", "a/b", "\x1b[2J", ""):
        with pytest.raises(l4d.L4dError):
            scene.frame(hostile, 0)
