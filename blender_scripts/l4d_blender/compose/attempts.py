"""Draws until one becomes a scene, and writes it: its composition, tracks and plan.

Draws that are thrown away are reported with the reason. A composed scene that fails a check is never written.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from ..scene.scene import Scene
from ..worker import files, plan, tracks, visibility
from . import build, checks
from .errors import Rejected
from .spec import Spec, SpecError
from .stage import Stage

Tell = Callable[[Spec, str], None]


def compose(spec: Spec, recipes: Path, out: Path, limit: int, tell: Tell) -> Spec:
    """Tries `limit` draws from `spec.draw` on; the one that became a scene is in `recipes` and `out`.

    Raises `Rejected` with the last reason if none did.
    """
    reason = "no draw was tried"
    for draw in range(spec.draw, spec.draw + limit):
        attempt = replace(spec, draw=draw)
        try:
            scene, stage = build.build(attempt)
            measured = _measured(scene, stage)
        except SpecError:
            raise
        except Rejected as error:
            reason = str(error)
            tell(attempt, reason)
            continue
        except Exception as error:  # a theme's mistake with these numbers: the draw is lost, not the run
            traceback.print_exc(file=sys.stderr)
            reason = f"{type(error).__name__}: {error}"
            tell(attempt, reason)
            continue
        files.write_bytes(recipes / f"{spec.scene}.json", files.canonical_json(stage.spec.to_json()))
        plan.write_measured(scene, stage.description, measured, out, recipes, usd=False)
        return stage.spec
    raise Rejected(reason)


def _measured(scene: Scene, stage: Stage) -> plan.Measured:
    """Measures a scene and rejects what must not be, the quick checks first."""
    shapes = tracks.measure(scene)
    checks.collisions(stage, shapes)
    seen = visibility.measure(scene)
    test = visibility.choose_test(seen, scene.rng("test view"))
    checks.unseen(seen, test)
    return plan.Measured(seen, test, shapes)
