"""A worker in a child process, as l4d runs it, and pictures to show it."""

import json
import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1]


def png(width: int, height: int, colour=(90, 120, 60), square=None) -> bytes:
    """A picture of one colour, perhaps with a white square at a column and row."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = []
    for row in range(height):
        pixels = bytearray(bytes(colour) * width)
        if square and square[1] <= row < square[1] + 8:
            pixels[square[0] * 3 : (square[0] + 8) * 3] = b"\xff" * 24
        rows.append(b"\0" + bytes(pixels))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"".join(rows))) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


class Running:
    """A worker's process."""

    def __init__(self, *arguments: str) -> None:
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "OMP_NUM_THREADS": "1"}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "l4d_workers", *arguments],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def say(self, line: dict) -> None:
        self.process.stdin.write(json.dumps(line) + "\n")
        self.process.stdin.flush()

    def hear(self) -> dict:
        while True:
            line = json.loads(self.process.stdout.readline())
            if line != {"alive": True}:
                return line

    def hello(self) -> dict:
        return self.hear()["hello"]

    def answer(self, request: dict) -> tuple[list[dict], dict]:
        """The masks and the end of an answer."""
        self.say(request)
        masks = []
        while True:
            line = self.hear()
            assert line["id"] == request["id"]
            if "rle" not in line:
                return masks, line
            masks.append(line)

    def close(self) -> int:
        self.process.stdin.close()
        return self.process.wait(20)


@pytest.fixture
def running():
    started = []

    def start(*arguments: str) -> Running:
        started.append(Running(*arguments))
        return started[-1]

    yield start
    for worker in started:
        worker.process.kill()
        worker.process.wait()


@pytest.fixture
def clip(tmp_path):
    """Eight frames of 64x48 with a square that moves to the right, as a request without prompts."""
    folder = tmp_path / "clip"
    folder.mkdir()
    files = [f"{index * 12:04}.png" for index in range(8)]
    for index, name in enumerate(files):
        (folder / name).write_bytes(png(64, 48, square=(4 + index * 6, 20)))

    def request(prompts: list[dict], span=(0, 7), number=1) -> dict:
        frames = {"dir": str(folder), "files": files, "width": 64, "height": 48}
        return {
            "op": "segment",
            "id": number,
            "frames": frames,
            "prompts": prompts,
            "range": list(span),
            "threshold": 0.0,
        }

    return request
