"""`l4d.torch.Scenes`: the same tensors from shards as from the built scene, with forked and spawned workers.

Needs PyTorch: tests/python.rs runs it with the Python of `L4D_TORCH_PYTHON`.
"""

import pickle
from pathlib import Path

import numpy as np
import pytest
import torch
from torch.utils.data import DataLoader

import l4d
from l4d.torch import Sample, Scenes

TENSORS = ("intrinsics", "world_from_camera", "colour", "depth_m", "ids")


@pytest.fixture
def built(world: Path) -> Scenes:
    return Scenes(world / "data/tiny/ball", split=None)


@pytest.fixture
def sharded(world: Path) -> Scenes:
    return Scenes(world / "shards", split=None)


def key(sample: Sample) -> tuple[str, int]:
    return sample["view"], sample["frame"]


def test_shards_hold_what_was_built(built: Scenes, sharded: Scenes) -> None:
    assert len(built) == len(sharded) == 5 * 9
    others = {key(sample): sample for sample in (sharded[index] for index in range(len(sharded)))}
    for index in range(len(built)):
        sample = built[index]
        other = others[key(sample)]
        assert [sample[name] for name in ("scene", "seconds", "time")] == [
            other[name] for name in ("scene", "seconds", "time")
        ]
        for name in TENSORS:
            assert sample[name].dtype == other[name].dtype and torch.equal(sample[name], other[name]), name


def test_cameras_are_those_of_the_package(sharded: Scenes, scene: l4d.Scene) -> None:
    sample = sharded[0]
    camera = scene.camera(sample["view"])
    assert np.array_equal(sample["intrinsics"].numpy(), camera.intrinsics)
    assert np.array_equal(sample["world_from_camera"].numpy(), camera.world_from_camera(sample["frame"]))
    frame = scene.frame(sample["view"], sample["frame"])
    assert np.array_equal(sample["colour"].numpy(), frame.display())
    assert sample["colour"].dtype == torch.uint8 and sample["ids"].dtype == torch.int32
    assert sample["seconds"] == scene.timeline.seconds(sample["frame"])


@pytest.mark.parametrize("how", ["fork", "spawn"])
@pytest.mark.parametrize("source", ["built", "sharded"])
def test_workers_read_what_one_process_reads(how: str, source: str, request: pytest.FixtureRequest) -> None:
    scenes = request.getfixturevalue(source)
    # Files are open already here: workers must not share them.
    expected = [scenes[index] for index in range(len(scenes))]
    loader = DataLoader(scenes, batch_size=4, num_workers=2, multiprocessing_context=how)
    at = 0
    for batch in loader:
        for row in range(len(batch["frame"])):
            assert (batch["view"][row], int(batch["frame"][row])) == key(expected[at])
            assert all(torch.equal(batch[name][row], expected[at][name]) for name in TENSORS)
            at += 1
    assert at == len(scenes)


def test_what_is_asked_for_is_what_comes(world: Path, sharded: Scenes) -> None:
    for source in ("data/tiny", "shards"):
        scenes = Scenes(world / source, parts=["depth"], views=["cam01", "cam04"], frames=[0, 96])
        # The held-out view is not asked for.
        assert [key(scenes[index]) for index in range(len(scenes))] == [("cam01", 0), ("cam01", 96)]
        assert {"colour", "ids"}.isdisjoint(scenes[0])
        assert len(Scenes(world / source, split="test")) == 9
    near = Scenes(world / "shards", split=None, exact_depth=False)
    for index in range(0, len(near), 7):
        exact, rounded = sharded[index]["depth_m"], near[index]["depth_m"]
        hit = torch.isfinite(exact)
        assert torch.equal(hit, torch.isfinite(rounded))
        assert (exact[hit] - rounded[hit]).abs().max() <= exact[hit].max() / 65535
    again = pickle.loads(pickle.dumps(near))
    assert torch.equal(again[3]["depth_m"], near[3]["depth_m"])


def test_errors_say_what_to_do(world: Path, tmp_path: Path) -> None:
    def refuses(*words: str, **arguments: object) -> None:
        with pytest.raises(l4d.L4dError) as caught:
            Scenes(**arguments)
        assert all(word in str(caught.value) for word in words), caught.value

    refuses("no such", "nowhere", paths="nowhere")
    refuses("parts", "colour, depth, ids", paths=world / "shards", parts=["color"])
    refuses("split", paths=world / "shards", split="val")
    refuses("no picture", paths=world / "shards", scenes=["other"])
    shard = next((world / "shards").glob("*-train-*.tar"))
    (tmp_path / "cut.tar").write_bytes(b"x" * 700)
    refuses("cut.tar", "fetch it again", paths=tmp_path)
    assert l4d.torch.Scenes is Scenes and len(Scenes(shard)) == 36
