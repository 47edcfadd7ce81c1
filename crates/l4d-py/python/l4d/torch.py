"""Scenes as a data set of PyTorch: pictures with depth, ids, camera and time, from folders of scenes or from tar shards.

Needs PyTorch, which nothing else of the package does.
"""

import json
import os
import tarfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Optional, TypedDict, Union

import numpy as np

from l4d._error import L4dError
from l4d._native import Scene, Timeline, decode_colour, decode_depth, decode_ids

try:
    import torch
    from torch.utils.data import Dataset
except ImportError as error:
    raise ImportError("l4d.torch needs PyTorch: install it (`pip install torch`), or use `l4d.Scene`") from error

__all__ = ["Sample", "Scenes"]

_Path = Union[str, "os.PathLike[str]"]
_PARTS = ("colour", "depth", "ids")
_MEMBERS = {"colour": ("png",), "depth": ("depth.png", "depth_rest.png"), "ids": ("ids.png",)}


class Sample(TypedDict, total=False):
    """One picture; parts that were not asked for are left out."""

    scene: str
    """Name of the scene."""
    view: str
    """Name of the camera."""
    frame: int
    """Canonical frame."""
    seconds: float
    """When that is, from the start of the scene."""
    time: float
    """The same from 0 to 1, as models of a scene take it."""
    intrinsics: torch.Tensor
    """float64 (3, 3), pixels."""
    world_from_camera: torch.Tensor
    """Pose at that frame, float64 (4, 4), metres; OpenCV axes."""
    colour: torch.Tensor
    """uint8 (H, W, 3), what a screen shows."""
    depth_m: torch.Tensor
    """float32 (H, W), planar, metres; inf where nothing is hit."""
    ids: torch.Tensor
    """int32 (H, W); 0 where nothing is annotated."""


class _Member(NamedTuple):
    offset: int
    size: int


class _Sharded(NamedTuple):
    shard: str
    members: dict[str, _Member]


class _Loose(NamedTuple):
    folder: str
    view: str
    frame: int


class Scenes(Dataset[Sample]):
    """Pictures of scenes, one an item: of folders that `l4d build-scenes` or `l4d download` made, or of the shards of a release.

    `paths` are one or several of: a scene (`data/tiny/tabletop_tea`), a folder of scenes (`data/tiny`), a shard
    (`shards/tiny/tabletop_tea-train-000.tar`), a folder of shards. `split` is `"train"`, `"test"` (the held-out view, which
    methods must not look at) or None for both; `parts` are some of `"colour"`, `"depth"` and `"ids"`; `exact_depth=False` rounds
    depth to 16 bits, which is quicker to read. `scenes`, `views` and `frames` keep the pictures that they name.

    Nothing is kept in memory. Each worker of a `DataLoader` opens files of its own, whether it is forked or spawned.
    """

    def __init__(
        self,
        paths: Union[_Path, Sequence[_Path]],
        *,
        parts: Sequence[str] = _PARTS,
        split: Optional[str] = "train",
        scenes: Optional[Iterable[str]] = None,
        views: Optional[Iterable[str]] = None,
        frames: Optional[Iterable[int]] = None,
        exact_depth: bool = True,
    ) -> None:
        if unknown := [part for part in parts if part not in _PARTS]:
            raise L4dError(f"there is no `{unknown[0]}`", field="parts", hint=f"choose among {', '.join(_PARTS)}")
        if split not in ("train", "test", None):
            raise L4dError(f"there is no `{split}`", field="split", hint="choose among train, test and None")
        self.parts = tuple(part for part in _PARTS if part in parts)
        self.exact_depth = exact_depth
        self._split = split
        self._items: list[Union[_Sharded, _Loose]] = []
        wanted = [None if names is None else frozenset(names) for names in (scenes, views, frames)]
        self._wanted: tuple[Any, ...] = tuple(wanted)
        given = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
        for path in map(Path, given):
            self._add(path)
        if not self._items:
            message = "holds no picture of what was asked for"
            hint = "give folders of scenes or tar shards, and see `split`, `scenes`, `views` and `frames`"
            raise L4dError(message, path=", ".join(map(str, given)), hint=hint)
        self._forget()

    def __len__(self) -> int:
        return len(self._items)

    def __getitem__(self, index: int) -> Sample:
        item = self._items[index]
        if self._process != os.getpid():
            self._forget()
        return self._of_shard(item) if isinstance(item, _Sharded) else self._of_folder(item)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in ("_files", "_scenes", "_process")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._forget()

    def _forget(self) -> None:
        """What this process opens is its own; what another one opened is not touched."""
        self._process = os.getpid()
        self._files: dict[str, int] = {}
        self._scenes: dict[str, Scene] = {}

    def __del__(self) -> None:
        if getattr(self, "_process", None) == os.getpid():
            for file in self._files.values():
                os.close(file)

    def _wants(self, scene: str, view: str, frame: int) -> bool:
        return all(names is None or name in names for names, name in zip(self._wanted, (scene, view, frame)))

    def _add(self, path: Path) -> None:
        if path.is_file():
            self._add_shard(path)
        elif (path / "scene.json").is_file():
            self._add_folder(path)
        elif path.is_dir():
            for inside in sorted(path.iterdir()):
                if inside.suffix == ".tar":
                    self._add_shard(inside)
                elif (inside / "scene.json").is_file():
                    self._add_folder(inside)
        else:
            raise L4dError("there is no such file or folder", path=str(path))

    def _add_folder(self, path: Path) -> None:
        scene = Scene(path)
        for camera in scene.cameras:
            if self._split not in (None, camera.split):
                continue
            self._items += [
                _Loose(str(path), camera.name, frame)
                for frame in scene.frames
                if self._wants(scene.name, camera.name, frame)
            ]

    def _add_shard(self, path: Path) -> None:
        samples: dict[str, dict[str, _Member]] = {}
        try:
            with tarfile.open(path, "r:") as archive:
                for member in archive:
                    folder, _, name = member.name.rpartition("/")
                    stem, _, suffix = name.partition(".")
                    if member.isreg() and suffix:
                        members = samples.setdefault(f"{folder}/{stem}", {})
                        members[suffix] = _Member(member.offset_data, member.size)
        except (OSError, tarfile.TarError) as error:
            raise L4dError(f"is no whole tar file: {error}", path=str(path), hint="fetch it again") from error
        needed = {"json"}.union(*(_MEMBERS[part] for part in self.parts))
        if not self.exact_depth:
            needed.discard("depth_rest.png")
        with open(path, "rb") as file:
            for key, members in samples.items():
                if missing := needed - set(members):
                    hint = "give shards of `l4d release`"
                    raise L4dError(f"has no .{min(missing)}", path=str(path), field=key, hint=hint)
                scene, view, frame = key.split("/")
                if not self._wants(scene, view, int(frame)):
                    continue
                if self._split is not None:
                    file.seek(members["json"].offset)
                    if json.loads(file.read(members["json"].size))["split"] != self._split:
                        continue
                self._items.append(_Sharded(str(path), {name: members[name] for name in needed}))

    def _read(self, item: _Sharded, name: str) -> bytes:
        file = self._files.get(item.shard)
        if file is None:
            file = self._files[item.shard] = os.open(item.shard, os.O_RDONLY)
        member = item.members[name]
        return os.pread(file, member.size, member.offset)

    def _of_shard(self, item: _Sharded) -> Sample:
        card = json.loads(self._read(item, "json"))
        intrinsics = [[card["fx"], 0.0, card["cx"]], [0.0, card["fy"], card["cy"]], [0.0, 0.0, 1.0]]
        sample: Sample = {
            "scene": card["scene"],
            "view": card["view"],
            "frame": card["frame"],
            "seconds": card["seconds"],
            "time": Timeline(card["profile"]).unit_time(card["frame"]),
            "intrinsics": torch.tensor(intrinsics, dtype=torch.float64),
            "world_from_camera": torch.tensor(card["world_from_camera"], dtype=torch.float64).reshape(4, 4),
        }
        if "colour" in self.parts:
            sample["colour"] = torch.from_numpy(decode_colour(self._read(item, "png")))
        if "depth" in self.parts:
            rest = self._read(item, "depth_rest.png") if self.exact_depth else None
            depth_m = decode_depth(self._read(item, "depth.png"), card["depth_scale_m"], rest)
            sample["depth_m"] = torch.from_numpy(depth_m)
        if "ids" in self.parts:
            sample["ids"] = torch.from_numpy(decode_ids(self._read(item, "ids.png")).view(np.int32))
        return sample

    def _of_folder(self, item: _Loose) -> Sample:
        scene = self._scenes.get(item.folder)
        if scene is None:
            scene = self._scenes[item.folder] = Scene(item.folder)
        frame = scene.frame(item.view, item.frame)
        camera = scene.camera(item.view)
        sample: Sample = {
            "scene": scene.name,
            "view": item.view,
            "frame": item.frame,
            "seconds": scene.timeline.seconds(item.frame),
            "time": scene.timeline.unit_time(item.frame),
            "intrinsics": torch.from_numpy(camera.intrinsics),
            "world_from_camera": torch.from_numpy(camera.world_from_camera(item.frame)),
        }
        if "colour" in self.parts:
            sample["colour"] = torch.from_numpy(frame.display())
        if "depth" in self.parts:
            sample["depth_m"] = torch.from_numpy(frame.depth_m)
        if "ids" in self.parts:
            sample["ids"] = torch.from_numpy(frame.id.view(np.int32))
        return sample
