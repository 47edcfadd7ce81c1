"""The worker's side of the protocol: lines in, lines out, one request at a time, nothing else on stdout."""

from __future__ import annotations

import json
import os
import queue
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

PROTOCOL = 1
# A line at least this often while something is worked on, seconds: l4d takes silence for a hang.
HEARTBEAT = 10.0


class Refusal(Exception):
    """A request that cannot be answered; the worker goes on. Kinds: bad_text, bad_prompt, frames, oom, internal."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


@dataclass(frozen=True)
class Found:
    """A mask of one object in one frame; the frame is an index into the request's files."""

    frame: int
    obj: int
    size: tuple[int, int]
    counts: str
    score: float | None = None


@dataclass
class Request:
    """A request for masks."""

    id: int
    files: list[Path]
    width: int
    height: int
    prompts: list[dict]
    first: int
    last: int
    threshold: float
    cancelled: threading.Event = field(default_factory=threading.Event)
    skipped: list[str] = field(default_factory=list)

    def skip(self, step: str) -> None:
        """Notes a step that had to be left out, so that people hear of it."""
        if step not in self.skipped:
            self.skipped.append(step)

    def texts(self) -> list[str]:
        """The prompts that are words."""
        return [prompt["text"] for prompt in self.prompts if "text" in prompt]

    def places(self) -> list[dict]:
        """The prompts that are boxes or points within the range, by frame."""
        places = [prompt for prompt in self.prompts if "frame" in prompt]
        inside = [prompt for prompt in places if self.first <= prompt["frame"] <= self.last]
        return sorted(inside, key=lambda prompt: prompt["frame"])


class Worker(Protocol):
    """What a worker is."""

    def hello(self) -> dict:
        """Who it is, without the version of the protocol."""

    def segment(self, request: Request) -> Iterator[Found]:
        """Masks, in any order; a frame without one does not show the object."""


def read_request(line: dict) -> Request:
    """A request from its line."""
    frames = line["frames"]
    folder = Path(frames["dir"])
    files = [folder / name for name in frames["files"]]
    first, last = line["range"]
    if not 0 <= first <= last < len(files):
        raise Refusal("bad_prompt", f"the range {first} to {last} leaves the {len(files)} frames")
    return Request(
        id=line["id"],
        files=files,
        width=frames["width"],
        height=frames["height"],
        prompts=line["prompts"],
        first=first,
        last=last,
        threshold=line["threshold"],
    )


class Wire:
    """Writes lines where l4d reads them. Whatever else prints goes to stderr."""

    def __init__(self) -> None:
        # Libraries print, also from C: stdout becomes stderr, and the real one is known here alone.
        self._out = os.fdopen(os.dup(1), "w", encoding="utf-8")
        os.dup2(2, 1)
        sys.stdout = sys.stderr
        self._lock = threading.Lock()

    def say(self, line: dict) -> None:
        """Writes one line, whole."""
        text = json.dumps(line, allow_nan=False, separators=(",", ":"))
        with self._lock:
            self._out.write(text + "\n")
            self._out.flush()


class Inbox:
    """What l4d asks, read on a thread of its own so that a cancel or the end is heard during work."""

    def __init__(self) -> None:
        self.orders: queue.Queue[dict | None] = queue.Queue()
        self._current: Request | None = None
        self._cancelled: set[int] = set()
        self._lock = threading.Lock()
        threading.Thread(target=self._read, daemon=True).start()

    def begin(self, request: Request) -> None:
        """Notes what is worked on now."""
        with self._lock:
            self._current = request
            if request.id in self._cancelled:
                request.cancelled.set()

    def _read(self) -> None:
        for line in sys.stdin:
            order = json.loads(line)
            if order["op"] == "cancel":
                with self._lock:
                    self._cancelled.add(order["id"])
                    if self._current is not None and self._current.id == order["id"]:
                        self._current.cancelled.set()
            elif order["op"] == "shutdown":
                break
            else:
                self.orders.put(order)
        # l4d is gone or done: no one reads what is still worked on, and a network may not be interruptible.
        os._exit(0)


def beat(wire: Wire) -> None:
    """Tells again and again that this process lives."""
    pause = threading.Event()
    while not pause.wait(HEARTBEAT):
        wire.say({"alive": True})


def answer(worker: Worker, request: Request, wire: Wire) -> None:
    """Answers one request; whatever goes wrong is told."""
    try:
        for found in worker.segment(request):
            if request.cancelled.is_set():
                break
            line = {"id": request.id, "frame": found.frame, "obj": found.obj}
            line["rle"] = {"size": list(found.size), "counts": found.counts}
            if found.score is not None:
                line["score"] = found.score
            wire.say(line)
        wire.say({"id": request.id, "done": True, "skipped": request.skipped})
    except Refusal as refusal:
        wire.say({"id": request.id, "error": {"kind": refusal.kind, "msg": str(refusal)}})
    except (OSError, ValueError, KeyError, RuntimeError, MemoryError) as error:
        traceback.print_exc()
        kind = "oom" if is_out_of_memory(error) else "internal"
        wire.say({"id": request.id, "error": {"kind": kind, "msg": f"{type(error).__name__}: {error}"}})


def is_out_of_memory(error: BaseException) -> bool:
    """Whether memory ran out, here or on an accelerator."""
    return isinstance(error, MemoryError) or type(error).__name__ == "OutOfMemoryError"


def opened(open_worker: Callable[[], Worker]) -> Worker:
    """The loaded worker; if that fails, the reason goes to the log and the process ends."""
    try:
        return open_worker()
    except SystemExit as refusal:
        print(refusal, file=sys.stderr)
    except Exception:
        traceback.print_exc()
    sys.stderr.flush()
    # Not by the usual way out, which would wait for the thread that reads stdin.
    os._exit(1)


def serve(open_worker: Callable[[], Worker]) -> None:
    """Loads a worker, says hello and answers until stdin ends."""
    wire = Wire()
    inbox = Inbox()
    threading.Thread(target=beat, args=(wire,), daemon=True).start()
    worker = opened(open_worker)
    wire.say({"hello": {"protocol": PROTOCOL, **worker.hello()}})
    while True:
        order = inbox.orders.get()
        try:
            request = read_request(order)
        except Refusal as refusal:
            wire.say({"id": order["id"], "error": {"kind": refusal.kind, "msg": str(refusal)}})
            continue
        inbox.begin(request)
        answer(worker, request, wire)
