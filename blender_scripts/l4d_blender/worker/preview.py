"""Pictures for people: some frames and views of a scene in one PNG, while a recipe is being written."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

from ..scene.scene import Scene
from .passes import Renderer

_MARGIN = 2


def write_sheet(
    scene: Scene,
    folder: Path,
    frames: Sequence[int],
    views: Sequence[str],
    size: tuple[int, int],
    samples: int,
    *,
    ids: bool = False,
    name: str | None = None,
) -> Path:
    """Renders views x frames and writes one PNG: a row per view, a column per frame (ids in a second row)."""
    width, height = size
    renderer = Renderer(width, height, samples, exact=ids)
    rows: dict[str, list[np.ndarray]] = {view: [] for view in views}
    id_rows: dict[str, list[np.ndarray]] = {view: [] for view in views}
    for frame in frames:
        for view in views:
            rows[view].append(display(renderer.beauty(view, frame), scene.exposure))
        if ids:
            for view, (_, numbers) in renderer.exact(views, frame).items():
                id_rows[view].append(id_colours(numbers))
    renderer.close()
    tiles = []
    for view in views:
        tiles.append(rows[view])
        if ids:
            tiles.append(id_rows[view])
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name or scene.name}.png"
    write_png(path, _tile(tiles))
    return path


def display(linear: np.ndarray, exposure: float) -> np.ndarray:
    """Display colour 0..1: clamp(sRGB_OETF(exposure * linear))."""
    x = np.clip(linear * exposure, 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.power(x, 1 / 2.4) - 0.055)


def id_colours(ids: np.ndarray) -> np.ndarray:
    """A colour per id: black for nothing, vivid for objects, pale for landmarks."""
    picture = np.zeros((*ids.shape, 3))
    for value in np.unique(ids):
        if value > 0:
            saturation = 0.9 if value < 1000 else 0.35
            picture[ids == value] = colorsys.hsv_to_rgb((int(value) * 0.618034) % 1.0, saturation, 1.0)
    return picture


def write_png(path: Path, picture: np.ndarray) -> None:
    """Writes display colours (height x width x 3, 0..1) as an 8-bit PNG."""
    height, width, _ = picture.shape
    image = bpy.data.images.new("sheet", width, height, alpha=False)
    rgba = np.ones((height, width, 4), dtype=np.float32)
    rgba[..., :3] = picture[::-1]
    image.pixels.foreach_set(rgba.ravel())
    image.file_format, image.filepath_raw = "PNG", str(path)
    image.save()
    bpy.data.images.remove(image)


def _tile(rows: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    height, width, _ = rows[0][0].shape
    step_y, step_x = height + _MARGIN, width + _MARGIN
    sheet = np.ones((len(rows) * step_y - _MARGIN, len(rows[0]) * step_x - _MARGIN, 3))
    for j, row in enumerate(rows):
        for i, picture in enumerate(row):
            sheet[j * step_y : j * step_y + height, i * step_x : i * step_x + width] = picture
    return sheet
