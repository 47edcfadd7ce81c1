"""Frame files: what one camera saw at one canonical frame, as one EXR.

One part, ZIP scanlines; `R G B` half (linear), `Z` float (planar metres, +inf where nothing is hit), `id`
uint. The same arrays give the same bytes: no date, no host, no software in the header.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import OpenEXR

from .files import atomic

_HALF_MAX = 65504.0


def frame_path(out: Path, view: str, frame: int) -> Path:
    """Where a frame lives below a scene's folder."""
    return out / "frames" / view / f"{frame:04}.exr"


def write_frame(path: Path, rgb: np.ndarray, depth_m: np.ndarray, ids: np.ndarray) -> None:
    """Writes a frame whole or not at all."""
    colour = np.nan_to_num(rgb, nan=0.0, posinf=_HALF_MAX, neginf=0.0).clip(0.0, _HALF_MAX).astype(np.float16)
    channels = {name: np.ascontiguousarray(colour[..., i]) for i, name in enumerate("RGB")}
    channels["Z"] = np.ascontiguousarray(depth_m, dtype=np.float32)
    channels["id"] = np.ascontiguousarray(ids, dtype=np.uint32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with atomic(path) as temporary:
        try:
            OpenEXR.File(header, channels).write(str(temporary))
        except RuntimeError as error:
            raise _as_os_error(error, path) from error


def read_frame(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """rgb (float16), depth in metres (float32), ids (uint32) of a frame."""
    with OpenEXR.File(str(path), separate_channels=True) as picture:
        channels = {name: channel.pixels for name, channel in picture.channels().items()}
    return np.stack([channels[name] for name in "RGB"], axis=-1), channels["Z"], channels["id"]


def _as_os_error(error: RuntimeError, path: Path) -> OSError:
    """OpenEXR raises one kind of error for everything; ask the disk which it was."""
    import errno

    if not os.access(path.parent, os.W_OK):
        return PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    if shutil.disk_usage(path.parent).free < 1 << 20:
        return OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
    return OSError(errno.EIO, str(error), str(path))
