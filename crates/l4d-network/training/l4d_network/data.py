"""Pictures with their truth: what was rendered for learning, as arrays of 8 and 16 bits.

A folder holds arrangements (`arrangement.json` in each) or built scenes (`frames/<view>/<frame>.exr`, described by
the tracks of a benchmark folder). A pack holds the same in one file, a tenth of the size, to carry to another machine:
`python -m l4d_network.data --data FOLDER --out FILE.zip`.
"""

from __future__ import annotations

import argparse
import io
import json
import zipfile
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from .model import Vocabulary

QUALITY = 80
"""Of the WebP pictures in a pack."""


@dataclass(frozen=True)
class Thing:
    """An instance: its noun, whether queries may mean it, its properties."""

    kind: str
    is_object: bool
    attributes: dict[str, str]


@dataclass
class Scene:
    """Pictures of one scene: display colour (n, h, w, 3) and ids (n, h, w)."""

    name: str
    colour: np.ndarray
    ids: np.ndarray
    things: dict[int, Thing]


def read(path: Path, bench: Path | None = None) -> list[Scene]:
    """All scenes of a pack or below a folder, by name; those of built scenes are described in `bench`."""
    if path.is_file():
        return _unpacked(path)
    if bench is not None:
        built = sorted({file.parents[2] for file in path.glob("*/frames/*/*.exr")})
        return [_built(folder, json.loads((bench / "scenes" / f"{folder.name}.json").read_text())) for folder in built]
    return list(_arrangements(sorted(path.glob("*/arrangement.json"))))


def vocabulary(scenes: Sequence[Scene]) -> Vocabulary:
    """The words of training scenes."""
    things = [thing for scene in scenes for thing in scene.things.values()]
    kinds = sorted({thing.kind for thing in things})
    pairs = {pair for thing in things if thing.is_object for pair in thing.attributes.items()}
    several = {key for key, _ in pairs if len({value for k, value in pairs if k == key}) > 1}
    return Vocabulary(("", *kinds), tuple(sorted(pair for pair in pairs if pair[0] in several)))


def display(linear: np.ndarray, exposure: float) -> np.ndarray:
    """8-bit display colour, as `l4d-frames` makes it."""
    x = np.nan_to_num(linear.astype(np.float32) * exposure).clip(0.0, 1.0)
    y = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    return (y * 255.0 + 0.5).astype(np.uint8)


def _arrangements(files: Sequence[Path]) -> Iterable[Scene]:
    for file in files:
        content = json.loads(file.read_text(encoding="utf-8"))
        if "rejected" in content:
            continue
        frames = [
            file.parent / "frames" / camera["name"] / f"{content['frame']:04}.exr" for camera in content["cameras"]
        ]
        yield _scene(content["name"], frames, content["exposure"], content["instances"])


def _built(folder: Path, tracks: dict) -> Scene:
    frames = sorted(folder.glob("frames/*/*.exr"))
    return _scene(folder.name, frames, tracks["exposure"], tracks["instances"])


def _scene(name: str, frames: Sequence[Path], exposure: float, instances: list[dict]) -> Scene:
    import OpenEXR  # a machine that learns from packs has no need of it

    colours, ids = [], []
    for path in frames:
        with OpenEXR.File(str(path), separate_channels=True) as picture:
            channels = {key: channel.pixels for key, channel in picture.channels().items()}
        colours.append(display(np.stack([channels[c] for c in "RGB"], -1), exposure))
        ids.append(channels["id"].astype(np.uint16))
    things = {
        entry["id"]: Thing(entry["category"], entry["role"] == "object", entry["attributes"])
        for entry in instances
    }
    return Scene(name, np.stack(colours), np.stack(ids), things)


def pack(scenes: Sequence[Scene], out: Path) -> None:
    """Writes scenes into one file: colour as WebP, ids as PNG of 16 bits, words as JSON."""
    from PIL import Image

    index = []
    with zipfile.ZipFile(out, "w") as archive:
        for scene in scenes:
            things = {number: asdict(thing) for number, thing in scene.things.items()}
            index.append({"name": scene.name, "pictures": len(scene.colour), "things": things})
            for number, (colour, ids) in enumerate(zip(scene.colour, scene.ids)):
                for picture, suffix, settings in (
                    (Image.fromarray(colour), "webp", {"quality": QUALITY}),
                    (Image.fromarray(ids), "png", {"optimize": True}),
                ):
                    content = io.BytesIO()
                    picture.save(content, format=suffix.upper(), **settings)
                    archive.writestr(f"{scene.name}/{number}.{suffix}", content.getvalue())
        archive.writestr("scenes.json", json.dumps(index), zipfile.ZIP_DEFLATED)


def _unpacked(path: Path) -> list[Scene]:
    from PIL import Image

    scenes = []
    with zipfile.ZipFile(path) as archive:
        for entry in json.loads(archive.read("scenes.json")):
            colour, ids = (
                np.stack([
                    np.asarray(Image.open(io.BytesIO(archive.read(f"{entry['name']}/{number}.{suffix}"))))
                    for number in range(entry["pictures"])
                ])
                for suffix in ("webp", "png")
            )
            things = {int(number): Thing(**thing) for number, thing in entry["things"].items()}
            scenes.append(Scene(entry["name"], colour, ids.astype(np.uint16), things))
    return scenes


def main() -> None:
    """Packs a folder."""
    parser = argparse.ArgumentParser(prog="l4d_network.data", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="a folder of arrangements or of built scenes")
    parser.add_argument("--bench", type=Path, help="the benchmark folder that describes built scenes")
    parser.add_argument("--out", type=Path, required=True, help="the pack")
    options = parser.parse_args()
    pack(read(options.data, options.bench), options.out)


if __name__ == "__main__":
    main()
