"""The worker's command line: plan, render, preview, compose. stdout has JSON Lines, all else goes to stderr.

Exit codes: 0 done, 2 failure (the last line on stdout is then an event "error" with a hint).
"""

from __future__ import annotations

import argparse
import errno
import json
import os
import stat
import sys
import tempfile
import threading
from pathlib import Path
from typing import NoReturn

from ..compose import spec as specs
from ..scene.timeline import CAMERA_COUNT, LAST_FRAME
from . import new_scene, recipes
from .recipes import WorkerError


def main(arguments: list[str] | None = None) -> NoReturn:
    """Runs one command and ends the process at once (Blender's own shutdown may hang)."""
    options = _parser().parse_args(arguments)
    events = _Events()
    try:
        options.run(options, events)
        code = 0
    except WorkerError as error:
        events.send("error", message=str(error), hint=error.hint)
        code = 2
    except OSError as error:
        events.send("error", message=_os_message(error), hint=_os_hint(error))
        code = 2
    events.close()
    sys.stderr.flush()
    os._exit(code)


def _follow_parent() -> None:
    """Ends this process as soon as the one that started it has gone, whatever is being computed.

    That one holds the other end of stdin, if it is a pipe. The parent's process id would not do: it may have
    changed while Python started. Nor prctl's death signal: that follows the thread that started the worker,
    which may end long before its process does.
    """
    if sys.stdin is None or not stat.S_ISFIFO(os.fstat(0).st_mode):
        return

    def watch() -> None:
        while os.read(0, 4096):
            pass
        print("stdin was closed: the process that started this worker has gone", file=sys.stderr, flush=True)
        os._exit(2)

    threading.Thread(target=watch, daemon=True).start()


class _Events:
    """The real stdout, kept for events.

    Blender's C code prints a hundred lines per image to file descriptor 1: they go nowhere. What Python
    prints goes to stderr.
    """

    def __init__(self) -> None:
        sys.stdout.flush()
        self._stream = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.close(nowhere)
        sys.stdout = sys.stderr

    def send(self, event: str, **fields: object) -> None:
        self._stream.write(json.dumps({"event": event, **fields}) + "\n")
        self._stream.flush()

    def close(self) -> None:
        self._stream.flush()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="l4d_blender", description=__doc__)
    commands = parser.add_subparsers(required=True)

    def recipe_options(command: argparse.ArgumentParser, *, may_be_new: bool = False) -> None:
        which = command.add_mutually_exclusive_group(required=True)
        which.add_argument("--scene")
        if may_be_new:
            which.add_argument("--new", metavar="NAME", help="write the smallest recipe of that name first")
        command.add_argument("--seed", type=int, default=0)
        command.add_argument(
            "--recipes", type=Path, default=recipes.RECIPES, help="folder of <scene>.py files"
        )

    plan = commands.add_parser(
        "plan", help="tracks.json, scene.usdc and plan.json of a scene: no picture yet"
    )
    recipe_options(plan)
    plan.add_argument("--out", type=Path, required=True, help="folder of the scene")
    plan.add_argument("--without-usd", action="store_true", help="tracks.json and plan.json only")
    plan.set_defaults(run=_plan)

    compose = commands.add_parser("compose", help="a new scene from a seed: its composition and its tracks")
    compose.add_argument("--scene", required=True, help="what it is called")
    compose.add_argument("--seed", type=int, required=True)
    compose.add_argument("--scale", required=True, choices=specs.SCALES)
    compose.add_argument("--first-draw", type=int, default=0, help="draws before it were thrown away")
    compose.add_argument("--draws", type=int, default=12, help="how many are tried (12)")
    compose.add_argument("--place")
    compose.add_argument("--theme")
    compose.add_argument("--category", action="append", default=[], help="demanded; may be repeated")
    compose.add_argument("--verb", action="append", default=[], help="demanded; may be repeated")
    compose.add_argument("--recipes", type=Path, required=True, help="receives <scene>.json")
    compose.add_argument("--out", type=Path, required=True, help="receives tracks.json and plan.json")
    compose.set_defaults(run=_compose)

    arrange = commands.add_parser(
        "arrange", help="pictures of furnished places filled with drawn things, one arrangement a seed"
    )
    arrange.add_argument("--first", type=int, required=True, help="the first seed")
    arrange.add_argument("--count", type=int, required=True, help="how many seeds")
    arrange.add_argument("--every", type=int, default=1, help="take every n-th of these seeds (1)")
    arrange.add_argument("--views", type=int, default=3, help="pictures of each (3)")
    arrange.add_argument("--samples", type=int, default=4, help="light samples a pixel (4)")
    arrange.add_argument("--threads", type=int, default=1, help="threads of the renderer (1)")
    arrange.add_argument("--out", type=Path, required=True, help="receives a folder for each")
    arrange.set_defaults(run=_arrange)

    listed = commands.add_parser("compositions", help="themes and places that compositions draw from")
    listed.set_defaults(run=_compositions)

    render = commands.add_parser("render", help="the images that a job lists, one EXR each")
    render.add_argument("job", type=Path, metavar="JOB.json")
    render.set_defaults(run=_render)

    preview = commands.add_parser("preview", help="one PNG of some frames and views, for people")
    recipe_options(preview, may_be_new=True)
    preview.add_argument("--out", type=Path, default=Path("preview"), help="folder of the PNG (preview)")
    preview.add_argument("--name", help="file name without .png (default: the scene's name)")
    preview.add_argument("--frames", type=_numbers(LAST_FRAME), default=[0, 48, 96])
    views = preview.add_mutually_exclusive_group()
    views.add_argument("--cameras", type=_numbers(CAMERA_COUNT - 1), help="such as 0,8")
    views.add_argument("--views", type=int, default=2, help="so many cameras spread over the rig")
    preview.add_argument("--size", type=_size, default=(256, 192))
    preview.add_argument("--samples", type=int, default=4)
    preview.add_argument("--ids", action="store_true", help="add a row of colour-coded ids below each view")
    preview.set_defaults(run=_preview)
    return parser


def _plan(options: argparse.Namespace, events: _Events) -> None:
    _follow_parent()
    recipes.find(options.scene, options.recipes)
    _make_folder(options.out)
    scene, description = recipes.build(options.scene, options.seed, options.recipes)
    from . import plan

    for message, numbers in plan.write(
        scene, description, options.out, options.recipes, usd=not options.without_usd
    ):
        events.send("warning", message=message, numbers=numbers)
    events.send("done")


def _compose(options: argparse.Namespace, events: _Events) -> None:
    _follow_parent()
    _make_folder(options.out)
    _make_folder(options.recipes)
    from ..compose import attempts
    from ..compose.errors import Rejected

    spec = specs.Spec(
        options.scene,
        options.scale,
        options.seed,
        options.first_draw,
        options.place,
        options.theme,
        tuple(options.category),
        tuple(options.verb),
    )
    try:
        made = attempts.compose(
            spec,
            options.recipes,
            options.out,
            options.draws,
            lambda attempt, reason: events.send("rejected", draw=attempt.draw, reason=reason),
        )
    except specs.SpecError as error:
        raise WorkerError(str(error), error.hint) from error
    except Rejected:
        events.send("exhausted", draws=options.draws)
    else:
        events.send("composed", draw=made.draw)
    events.send("done")


def _arrange(options: argparse.Namespace, events: _Events) -> None:
    _follow_parent()
    _make_folder(options.out)
    from ..compose.arrangements import pictures

    for seed in range(options.first, options.first + options.count, options.every):
        made = pictures.render(options.out, seed, options.views, options.samples, options.threads)
        events.send("arranged", seed=seed, made=made)
    events.send("done")


def _compositions(options: argparse.Namespace, events: _Events) -> None:
    from ..compose import build

    for scale in specs.SCALES:
        for theme, fitting in build.settings(scale):
            events.send(
                "theme",
                scale=scale,
                name=theme.name,
                places=[place.name for place in fitting],
                categories=sorted(theme.categories),
                verbs=sorted(theme.verbs),
            )
    events.send("done")


def _render(options: argparse.Namespace, events: _Events) -> None:
    _follow_parent()
    from . import render

    job = render.read_job(options.job)
    recipes.find(job.scene, job.recipes)
    _make_folder(job.out)
    render.run(job, events.send)


def _preview(options: argparse.Namespace, events: _Events) -> None:
    if options.new:
        events.send("written", path=str(new_scene.write(options.new, options.recipes)))
        options.scene = options.new
    scene, _ = recipes.build(options.scene, options.seed, options.recipes)
    from . import preview

    count = max(options.views, 1)
    spread = [round((i + 0.5) * CAMERA_COUNT / count - 0.5) for i in range(count)]
    views = [scene.camera_rig[i].name for i in options.cameras or spread]
    path = preview.write_sheet(
        scene,
        options.out,
        options.frames,
        views,
        options.size,
        options.samples,
        ids=options.ids,
        name=options.name,
    )
    events.send("preview", path=str(path), frames=options.frames, views=views)


def _make_folder(folder: Path) -> None:
    """Finds out now, not after an hour, that nothing can be written there."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


def _numbers(largest: int):
    def parse(text: str) -> list[int]:
        numbers = [int(part) for part in text.split(",")]
        if any(not 0 <= number <= largest for number in numbers):
            raise argparse.ArgumentTypeError(f"numbers from 0 to {largest}, separated by commas")
        return numbers

    return parse


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    return int(width), int(height)


def _os_message(error: OSError) -> str:
    return f"{error.filename}: {error.strerror}" if error.filename else str(error)


def _os_hint(error: OSError) -> str:
    if error.errno == errno.ENOSPC:
        return "the disk is full: free some space and start again, finished frames are kept"
    if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        return "choose a folder that you may write to"
    return "check the path and the disk, then run the command again"
