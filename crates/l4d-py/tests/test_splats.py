"""Splats and clips."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import digest

import l4d


@pytest.fixture(scope="module")
def splats(world: Path) -> l4d.Splats:
    return l4d.Splats(world / "work/tiny/ball/splats")


def test_a_picture_has_the_bits_that_rust_draws(splats: l4d.Splats, scene: l4d.Scene, expected: dict) -> None:
    camera = scene.camera(expected["view"])
    for depth in ("median", "expected", "sum"):
        picture = splats.render(camera, frame=expected["frame"], depth=depth)
        assert digest(picture.depth_m) == expected["splats"][depth]
        assert digest(picture.rgb) == expected["splats"]["rgb"] and digest(picture.alpha) == expected["splats"]["alpha"]
    assert [picture.rgb.shape, picture.depth_m.shape, picture.alpha.shape] == [(96, 128, 3), (96, 128), (96, 128)]
    assert picture.rgb.dtype == picture.depth_m.dtype == picture.alpha.dtype == np.float32
    shown = np.clip(picture.rgb, 0, 1) * np.float32(255)
    assert picture.display().dtype == np.uint8 and np.abs(picture.display() - shown).max() <= 0.5
    at_time = splats.render(camera, time=scene.timeline.unit_time(expected["frame"]))
    assert digest(at_time.rgb) == expected["splats"]["rgb"]


def test_gaussians_are_what_is_drawn(splats: l4d.Splats, scene: l4d.Scene) -> None:
    state = splats.gaussians(frame=48)
    count = splats.gaussian_count
    shapes = {"means": (count, 3), "scales": (count, 3), "rotations": (count, 4), "opacities": (count,)}
    assert {name: state[name].shape for name in shapes} == shapes
    assert state["sh"].shape[::2] == (count, 3) and state["sh"].shape[1] in (1, 4, 9, 16)
    assert all(values.dtype == np.float32 and np.isfinite(values).all() for values in state.values())
    assert np.allclose(np.linalg.norm(state["rotations"], axis=1), 1, atol=1e-3)
    assert state["scales"].min() >= 0 and 0 <= state["opacities"].min() and state["opacities"].max() <= 1
    at_time = splats.gaussians(time=scene.timeline.unit_time(48))
    assert all(np.array_equal(at_time[name], state[name]) for name in state)
    if splats.dynamic_count:
        assert not np.array_equal(splats.gaussians(frame=0)["means"], state["means"])
    with pytest.raises(l4d.L4dError, match="exactly one"):
        splats.gaussians()


def test_a_clip_is_its_pictures(splats: l4d.Splats, scene: l4d.Scene) -> None:
    camera = scene.camera("cam02")
    clip = splats.clip(camera, [48, 0], background=(0.25, 0.5, 1.0))
    assert clip.frames == [48, 0] and len(clip) == 2 and clip.display().shape == (2, 96, 128, 3)
    for at, frame in enumerate(clip.frames):
        picture = splats.render(camera, frame=frame, background=(0.25, 0.5, 1.0))
        assert np.array_equal(clip.rgb[at], picture.rgb) and np.array_equal(clip.depth_m[at], picture.depth_m)
        assert np.array_equal(clip.display()[at], picture.display())
    assert not np.array_equal(clip.rgb[0], splats.render(camera, frame=48).rgb)
    assert splats.render(camera, frame=0, size=(32, 24)).rgb.shape == (24, 32, 3)


def test_a_model_says_what_it_is(splats: l4d.Splats) -> None:
    assert splats.family == "l4d" and splats.gaussian_count > splats.dynamic_count > 0
    assert splats.notes == [] and splats.scene is None and splats.profile is None
    assert splats.saw_depth is None


def test_clips_on_disk_are_what_the_verb_drew(splats: l4d.Splats, scene: l4d.Scene, world: Path) -> None:
    clips = l4d.Clips(world / "work/tiny/ball/clips")
    assert (clips.views, clips.width, clips.height, clips.depth_kind) == (["cam01"], 128, 96, "median")
    assert clips.frames("cam01") == scene.frames
    assert np.array_equal(clips.camera("cam01").world_from_camera(), scene.camera("cam01").world_from_camera())
    stored, drawn = clips.read("cam01"), splats.clip(scene.camera("cam01"), scene.frames)
    assert stored.frames == scene.frames and np.array_equal(stored.display(), drawn.display())
    assert np.array_equal(stored.depth_m, drawn.depth_m)
    assert np.array_equal(stored.alpha, drawn.alpha.astype(np.float16).astype(np.float32))

    shallow = l4d.Clips(world / "clips-png")
    stored, drawn = shallow.read("cam01"), splats.render(scene.camera("cam01"), frame=0, depth="expected")
    near = drawn.depth_m < 65
    assert (stored.frames, shallow.depth_kind, stored.alpha) == ([0], "expected", None)
    assert near.any() and np.abs(stored.depth_m[0] - drawn.depth_m)[near].max() <= 0.000_6


def test_errors_say_where_and_what_to_do(splats: l4d.Splats, scene: l4d.Scene, world: Path, tmp_path: Path) -> None:
    camera = scene.camera("cam00")
    for arguments in ({}, {"frame": 0, "time": 0.0}, {"frame": 97}, {"frame": 0, "depth": "deep"}):
        with pytest.raises(l4d.L4dError) as told:
            splats.render(camera, **arguments)
        assert told.value.field and told.value.hint
    with pytest.raises(l4d.L4dError, match="time 1.5"):
        splats.render(camera, time=1.5)
    for size in ((0, 4), (1 << 20, 1 << 20)):
        with pytest.raises(l4d.L4dError, match="sides are 1 to"):
            splats.render(camera, frame=0, size=size)
    with pytest.raises(l4d.L4dError) as told:
        l4d.Splats(tmp_path)
    assert told.value.path == str(tmp_path) and "train-splats" in told.value.hint
    with pytest.raises(l4d.L4dError) as told:
        l4d.Clips(world / "work/tiny/ball/clips").read("cam01", [1])
    assert told.value.field == "frames"
    manifest = (world / "work/tiny/ball/clips/manifest.json").read_text()
    (tmp_path / "manifest.json").write_text(manifest.replace('"0000"', '"../../0000"'))
    with pytest.raises(l4d.L4dError, match="is not a name"):
        l4d.Clips(tmp_path)


def test_other_threads_run_while_it_draws(splats: l4d.Splats, scene: l4d.Scene) -> None:
    camera = scene.camera("cam00")
    worker = threading.Thread(target=lambda: splats.clip(camera, scene.frames, size=(512, 384)))
    worker.start()
    ticks = 0
    while worker.is_alive():
        time.sleep(0.001)
        ticks += worker.is_alive()
    assert ticks >= 5, "the interpreter's lock was held"
