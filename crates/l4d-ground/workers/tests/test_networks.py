"""The workers with networks, on tiny random models of the real classes. Skipped where torch is not installed."""

import pytest

pytest.importorskip("torch")

import numpy
from test_protocol import decode
from tiny_models import write_sam2, write_sam3

from l4d_workers import rle
from l4d_workers.sam3_hf import without_duplicates


@pytest.fixture(scope="module")
def sam2(tmp_path_factory):
    folder = tmp_path_factory.mktemp("models") / "sam2"
    write_sam2(folder)
    return folder


@pytest.fixture(scope="module")
def sam3(tmp_path_factory):
    folder = tmp_path_factory.mktemp("models") / "sam3"
    write_sam3(folder)
    return folder


def start(running, name, folder):
    worker = running(name, "--model", str(folder), "--device", "cpu", "--threads", "1")
    return worker, worker.hello()


def test_arrays_are_encoded_like_boxes():
    mask = numpy.zeros((4, 6), bool)
    mask[1:2, 1:3] = True
    assert rle.of_array(mask) == rle.of_box((1, 1, 3, 2), 6, 4)
    assert rle.of_array(numpy.ones((4, 6))) == "0" + rle.counts([24])
    noise = numpy.random.default_rng(0).random((33, 17)) > 0.5
    runs = decode(rle.of_array(noise))
    values = numpy.repeat(numpy.arange(len(runs)) % 2, runs)
    assert (noise == values.reshape(17, 33).T).all()


def test_boxes_and_points_are_followed_both_ways(running, clip, sam2):
    worker, hello = start(running, "sam2-hf", sam2)
    assert (hello["device"], hello["prompts"]) == ("cpu", ["box", "point"])
    assert len(hello["weights"]["sha256"]) == 64 and hello["weights"]["id"] == "sam2"
    prompts = [
        {"obj": 1, "frame": 3, "box_px": [20.0, 18.0, 32.0, 30.0]},
        {"obj": 1, "frame": 3, "point_px": [26.0, 24.0]},
        {"obj": 2, "frame": 5, "point_px": [5.0, 5.0]},
        {"obj": 1, "frame": 6, "box_px": [38.0, 18.0, 50.0, 30.0]},
    ]
    masks, end = worker.answer(clip(prompts))
    assert end == {"id": 1, "done": True, "skipped": []}, end
    places = sorted((mask["frame"], mask["obj"]) for mask in masks)
    assert [place for place in places if place[1] == 1] == [(frame, 1) for frame in range(8)]
    assert len(places) == len(set(places))
    for mask in masks:
        assert mask["rle"]["size"] == [48, 64] and sum(decode(mask["rle"]["counts"])) == 48 * 64
        assert 0.0 <= mask["score"] <= 1.0
    again, _ = worker.answer(clip(prompts, number=2))
    assert [mask["rle"] for mask in again] == [mask["rle"] for mask in masks], "the same question, another answer"
    # Only a part of the clip, with a prompt in its first frame.
    masks, end = worker.answer(clip(prompts[3:], span=(6, 7), number=3))
    assert end["done"] and sorted(mask["frame"] for mask in masks) == [6, 7]


def test_sam2_refuses_words_and_frames_that_are_none(running, clip, sam2):
    worker, _ = start(running, "sam2-hf", sam2)
    _, end = worker.answer(clip([{"obj": 1, "text": "cup"}]))
    assert end["error"]["kind"] == "bad_prompt"
    _, end = worker.answer(clip([{"obj": 1, "frame": 1, "box_px": [0, 0, 9, 9]}], span=(2, 3)))
    assert end["error"]["kind"] == "bad_prompt"
    request = clip([{"obj": 1, "frame": 0, "box_px": [0, 0, 9, 9]}])
    request["frames"]["files"][3] = "none.png"
    _, end = worker.answer(request)
    assert end["error"]["kind"] == "frames" and "none.png" in end["error"]["msg"]
    request["frames"].update(files=request["frames"]["files"][:3], width=65)
    _, end = worker.answer({**request, "range": [0, 2]})
    assert end["error"]["kind"] == "frames" and "64x48" in end["error"]["msg"]


def test_a_phrase_finds_objects_and_long_text_is_refused(running, clip, sam3):
    worker, hello = start(running, "sam3-hf", sam3)
    assert (hello["text"], hello["text_max_tokens"]) == ("phrase", 32)
    masks, end = worker.answer(clip([{"obj": 1, "text": "red cup"}]))
    assert end["done"] and "duplicates" in end["skipped"][0], end
    assert masks, "thresholds of zero find something"
    assert {mask["frame"] for mask in masks} <= set(range(8))
    for mask in masks:
        assert sum(decode(mask["rle"]["counts"])) == 48 * 64 and "score" in mask
    text = "the cup that is moved from left to right by the hand"
    _, end = worker.answer(clip([{"obj": 1, "text": text}], number=2))
    assert end["error"]["kind"] == "bad_text" and "32" in end["error"]["msg"]
    masks, end = worker.answer(clip([{"obj": 1, "text": "cup"}], span=(2, 4), number=3))
    assert end["done"] and {mask["frame"] for mask in masks} <= {2, 3, 4}


def test_of_two_masks_that_are_one_the_surer_stays():
    masks = numpy.zeros((3, 4, 10), bool)
    masks[0, :, :8] = masks[1, :, :7] = masks[2, :, 8:] = True
    assert without_duplicates(masks, numpy.array([0.5, 0.9, 0.1])) == [1, 2]
    assert without_duplicates(numpy.zeros((2, 4, 4), bool), numpy.array([0.5, 0.9])) == [0, 1]


def test_a_folder_without_a_model_ends_the_worker(running, tmp_path):
    worker = running("sam2-hf", "--model", str(tmp_path))
    assert worker.process.wait(300) == 1
