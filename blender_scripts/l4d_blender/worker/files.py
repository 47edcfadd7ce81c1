"""Files that are whole or absent: temporary file in the same folder, fsync, rename. And canonical JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import count
from pathlib import Path

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

_NUMBERS = count()


@contextmanager
def atomic(path: Path) -> Iterator[Path]:
    """Yields a temporary path to write to; it becomes `path` when the block ends well, and vanishes if not.

    Its name is like those of the binary, and it is locked: by that the binary knows what killed workers left,
    and removes it, together with files that differ in their suffix alone.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".l4d-{os.getpid()}-{next(_NUMBERS)}.tmp")
    try:
        with _locked(temporary):
            yield temporary
        # Libraries may have put another file there.
        with _locked(temporary) as descriptor:
            os.fsync(descriptor)
            os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


@contextmanager
def _locked(path: Path) -> Iterator[int]:
    """The open file, which is made if it is missing; its lock goes with the process."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        if fcntl:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield descriptor
    finally:
        os.close(descriptor)


def write_bytes(path: Path, data: bytes) -> None:
    """Writes a whole file."""
    with atomic(path) as temporary:
        temporary.write_bytes(data)


def canonical_json(value: Mapping[str, object]) -> bytes:
    """The one way in which a JSON object is written: a line per field, and per entry of a list of objects.

    Floats must already be rounded; NaN and infinity are refused.
    """
    lines = []
    for key, field in value.items():
        if isinstance(field, list) and field and all(isinstance(entry, Mapping) for entry in field):
            entries = ",\n".join(f"    {_compact(entry)}" for entry in field)
            lines.append(f"  {json.dumps(key)}: [\n{entries}\n  ]")
        else:
            lines.append(f"  {json.dumps(key)}: {_compact(field)}")
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def _compact(value: object) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)
