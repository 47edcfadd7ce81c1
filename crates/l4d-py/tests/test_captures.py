"""Scenes that others recorded: each has a size and a timeline of its own."""

from pathlib import Path

import numpy as np
import pytest

import l4d


@pytest.fixture(scope="module")
def capture(world: Path) -> l4d.Capture:
    return l4d.Capture(world / "data/captures/desk")


@pytest.fixture(scope="module")
def desks(world: Path) -> l4d.Benchmark:
    return l4d.Benchmark(world / "captures", profile="real")


def test_pictures_are_those_on_disk(capture: l4d.Capture) -> None:
    columns, rows = np.meshgrid(np.arange(6), np.arange(4))
    for frame in capture.frames:
        expected = np.stack([np.full((4, 6), frame), 10 * columns, 20 * rows], axis=-1)
        picture = capture.picture("cam00", frame)
        assert picture.dtype == np.uint8 and np.array_equal(picture, expected)
    clip = capture.clip("cam01")
    assert clip.shape == (2, 4, 6, 3) and np.array_equal(clip[1], capture.picture("cam01", 1))
    assert [capture.saw("cam01", frame) for frame in (0, 1, 2, 200)] == [True, True, False, False]


def test_a_capture_says_what_it_is(capture: l4d.Capture) -> None:
    assert (capture.name, capture.source, capture.width, capture.height) == ("desk", "a test", 6, 4)
    assert (capture.frames, capture.frames_per_second, capture.is_metric) == ([0, 1, 200], 30.0, False)
    assert capture.notes == ["Made up."]
    assert [camera.name for camera in capture.cameras] == ["cam00", "cam01"]
    assert [camera.name for camera in capture.training_cameras] == ["cam01"]
    # A camera that stands still has its pose at any moment.
    assert np.array_equal(capture.camera("cam00").world_from_camera(200), np.eye(4))


def test_captures_are_asked_about_scene_by_scene(desks: l4d.Benchmark) -> None:
    assert (desks.size("desk"), desks.clip("desk")) == ((6, 4), [0, 1, 200])
    for common in ("frames", "width", "height", "timeline"):
        with pytest.raises(l4d.L4dError) as told:
            getattr(desks, common)
        assert told.value.field == "profile" and "clip" in told.value.hint


def test_results_of_captures_are_written_and_scored(desks: l4d.Benchmark, tmp_path: Path) -> None:
    truth = desks.truth("desk")
    assert truth.frames == [0, 200] and truth.masks("desk/001").sum() == 12
    writer = l4d.ResultsWriter(tmp_path / "mine", desks, version="1")
    with pytest.raises(l4d.L4dError, match="no answer for frame 200"):
        writer.write("desk/001", {0: None})
    writer.write("desk/001", {frame: truth.mask("desk/001", frame) for frame in truth.frames})
    assert writer.remaining() == [] and l4d.check(writer.path, desks) == []
    assert l4d.score(writer.path, desks)["methods"][0]["tube_iou"] == 100.0
    # A frame that no one drew on may be answered, and nothing judges that.
    everywhere = np.zeros((3, 4, 6), bool)
    everywhere[1] = True
    everywhere[[0, 2]] = truth.masks("desk/001")
    writer.write("desk/001", everywhere)
    assert l4d.score(writer.path, desks)["methods"][0]["tube_iou"] == 100.0


def test_errors_say_where_and_what_to_do(capture: l4d.Capture, world: Path, tmp_path: Path) -> None:
    for call in (
        lambda: capture.picture("cam01", 200),
        lambda: capture.picture("cam00", 2),
        lambda: capture.picture("cam09", 0),
        lambda: capture.clip("cam09"),
    ):
        with pytest.raises(l4d.L4dError) as told:
            call()
        assert told.value.field in ("frame", "view") and told.value.hint
    document = (world / "data/captures/desk/capture.json").read_text()
    for what, to in {'"width": 6': '"width": 600000', '"fx": 5.0': '"fx": 0.0', '"l4d/capture/1"': '"l4d/capture/9"'}.items():
        assert what in document
        (tmp_path / "capture.json").write_text(document.replace(what, to))
        with pytest.raises(l4d.L4dError) as told:
            l4d.Capture(tmp_path)
        assert told.value.path.endswith("capture.json") and told.value.hint
