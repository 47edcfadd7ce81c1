"""Files that are whole or absent: temporary file in the same folder, fsync, rename. And canonical JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def atomic(path: Path) -> Iterator[Path]:
    """Yields a temporary path to write to; it becomes `path` when the block ends well, and vanishes if not.

    Temporary names start with a dot, end in .tmp and hold the process id, so that a worker that is being
    replaced can't tear the file of its successor.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield temporary
        descriptor = os.open(temporary, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


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
