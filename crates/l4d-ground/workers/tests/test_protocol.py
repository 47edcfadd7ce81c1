"""The workers that need nothing but Python, over their pipes."""

import pytest
import tomllib
from conftest import PACKAGE

from l4d_workers import box, rle, samwise


def decode(counts: str) -> list[int]:
    """Run lengths of a text, written apart from the encoder: COCO's own loop."""
    runs, position = [], 0
    while position < len(counts):
        value, shift, more = 0, 0, True
        while more:
            group = ord(counts[position]) - 48
            value |= (group & 0x1F) << (5 * shift)
            more = bool(group & 0x20)
            position += 1
            shift += 1
            if not more and group & 0x10:
                value |= -1 << (5 * shift)
        if len(runs) > 2:
            value += runs[-2]
        runs.append(value)
    return runs


def test_run_lengths_are_those_of_coco():
    # 3 wide, 2 high; columns (0,1), (1,1), (0,0): the same example is in l4d-frames.
    assert rle.counts([1, 3, 2]) == "132"
    assert rle.counts([6]) == "6"
    assert rle.counts([0, 6]) == "06"
    for runs in ([1000, 3, 1, 70000, 2, 2, 5], [0, 1, 1, 1, 1, 1, 1]):
        assert decode(rle.counts(runs)) == runs


@pytest.mark.parametrize(
    ("pixels", "runs"),
    [
        ((1, 1, 3, 2), [5, 1, 3, 1, 14]),
        ((0, 0, 6, 4), [0, 24]),
        ((2, 0, 4, 4), [8, 8, 8]),
        ((5, 3, 6, 4), [23, 1]),
        ((3, 2, 3, 4), [24]),
    ],
)
def test_boxes_are_filled_down_the_columns(pixels, runs):
    assert decode(rle.of_box(pixels, 6, 4)) == runs


def test_a_box_goes_straight_between_those_that_are_known():
    boxes = {2: (0.0, 0.0, 4.0, 4.0), 6: (8.0, 0.0, 12.0, 8.0)}
    assert box.between(boxes, 0) == (0.0, 0.0, 4.0, 4.0)
    assert box.between(boxes, 4) == (4.0, 0.0, 8.0, 6.0)
    assert box.between(boxes, 7) == (8.0, 0.0, 12.0, 8.0)
    # Pixels whose centres lie inside: columns 1 and 2 of 0.6 to 2.6.
    assert box.covered((0.6, -3.0, 2.6, 99.0), 6, 4) == (1, 0, 3, 4)


def test_the_box_worker_answers_and_leaves_with_its_parent(running, clip):
    worker = running("box")
    hello = worker.hello()
    assert (hello["protocol"], hello["name"], hello["prompts"], hello["text"]) == (1, "box", ["box"], None)
    prompts = [
        {"obj": 1, "frame": 2, "box_px": [10, 20, 14, 22]},
        {"obj": 2, "frame": 5, "box_px": [0, 0, 1, 1]},
    ]
    masks, end = worker.answer(clip(prompts, span=(2, 6), number=3))
    assert end == {"id": 3, "done": True, "skipped": []}
    assert [(mask["obj"], mask["frame"]) for mask in masks] == [(o, f) for o in (1, 2) for f in range(2, 7)]
    assert masks[0]["rle"]["size"] == [48, 64]
    assert decode(masks[0]["rle"]["counts"])[:4] == [10 * 48 + 20, 2, 46, 2]
    assert worker.close() == 0


def test_what_cannot_be_answered_is_told_and_the_worker_goes_on(running, clip):
    worker = running("box")
    worker.hello()
    _, end = worker.answer(clip([{"obj": 1, "text": "a cup"}]))
    assert end["error"]["kind"] == "bad_prompt"
    _, end = worker.answer(clip([], span=(0, 8)))
    assert end["error"]["kind"] == "bad_prompt"
    masks, end = worker.answer(clip([{"obj": 1, "frame": 0, "box_px": [0, 0, 9, 9]}]))
    assert len(masks) == 8 and end["done"]


def test_the_null_worker_takes_everything_and_finds_nothing(running, clip):
    worker = running("null")
    assert worker.hello()["text"] == "sentence"
    masks, end = worker.answer(clip([{"obj": 1, "text": "a cup 🥤 'x' \"y\""}]))
    assert masks == [] and end["done"]
    worker.say({"op": "shutdown"})
    assert worker.process.wait(20) == 0


def test_samwise_never_sees_a_frame_alone_and_needs_everything_on_disk(running, tmp_path):
    assert [len(part) for part in samwise.windows(9)] == [9]
    assert [len(part) for part in samwise.windows(49)] == [8, 8, 8, 8, 8, 9]
    assert [len(part) for part in samwise.windows(10)] == [8, 2]
    assert samwise.windows(1) == [[0]]
    worker = running("samwise", "--checkout", str(tmp_path), "--weights", str(tmp_path / "none.pth"))
    assert worker.process.wait(20) == 1


def test_the_pins_are_the_same_in_both_files():
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text())["project"]
    pinned = [line for line in (PACKAGE / "requirements.txt").read_text().splitlines() if line[:1] not in "#"]
    assert project["optional-dependencies"]["torch"] == pinned
    assert project["dependencies"] == []
