"""Finds a recipe by its name, runs it, and says where in it an error is.

A recipe is a module with `SCALE` and `build(scene)`, whose docstring's first paragraph describes the scene;
or a composition, `<scene>.json`, which `compose` turns into one.
"""

from __future__ import annotations

import difflib
import hashlib
import importlib.util
import inspect
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..scene.scene import Scene

PROJECT = Path(__file__).resolve().parents[2]
RECIPES = PROJECT / "scenes"


class WorkerError(Exception):
    """Something the person who started the worker can mend; `hint` says how."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


def names(folder: Path = RECIPES) -> list[str]:
    """The scenes that exist."""
    paths = [*folder.glob("*.py"), *folder.glob("*.json")]
    return sorted(path.stem for path in paths if not path.stem.startswith("_"))


def find(name: str, folder: Path = RECIPES) -> Path:
    """The file of a recipe."""
    known = names(folder)
    if name not in known:
        close = difflib.get_close_matches(name, known, 1)
        guess = f"did you mean {close[0]}? " if close else ""
        raise WorkerError(
            f"unknown scene {name!r}", f"{guess}scenes that exist: {', '.join(known) or 'none'}"
        )
    module = folder / f"{name}.py"
    return module if module.is_file() else module.with_suffix(".json")


def build(name: str, seed: int = 0, folder: Path = RECIPES) -> tuple[Scene, str]:
    """Runs a recipe in a fresh Blender scene: the scene and its one-paragraph description."""
    path = find(name, folder)
    if path.suffix == ".json":
        return _composed(path)
    if str(PROJECT) not in sys.path:
        sys.path.insert(0, str(PROJECT))
    from ..scene.scene import RecipeError, Scene

    try:
        recipe = _load(path)
        scene = Scene(name, recipe.SCALE, seed)
        recipe.build(scene)
        scene.check()
    except RecipeError as error:
        raise WorkerError(f"{_where(error, path)}: {error}", error.hint) from error
    except Exception as error:
        traceback.print_exc(file=sys.stderr)
        raise WorkerError(
            f"{_where(error, path)}: {type(error).__name__}: {error}", "the traceback is in the log"
        ) from error
    return scene, _first_paragraph(recipe)


def _composed(path: Path) -> tuple[Scene, str]:
    from ..compose import build as composer
    from ..compose import spec as specs
    from ..compose.errors import Rejected

    try:
        composition = specs.read(path)
        scene, staged = composer.build(composition)
    except (specs.SpecError, Rejected) as error:
        hint = getattr(error, "hint", "compose it again: its scripts have changed since")
        raise WorkerError(f"{path}: {error}", hint) from error
    return scene, staged.description


def script_digests(folder: Path = RECIPES, also: Sequence[str] = ()) -> dict[str, str]:
    """sha256 of every project file imported so far (and of `also`), by its path in the project."""
    imported = [getattr(module, "__file__", None) for module in list(sys.modules.values())]
    files = {Path(file).resolve() for file in imported if file} | {PROJECT / file for file in also}
    digests: dict[str, str] = {}
    for file in files:
        if file.suffix != ".py" or not file.is_file():
            continue
        for root, prefix in ((folder.resolve(), "scenes/"), (PROJECT, "")):
            if file.is_relative_to(root) and "site-packages" not in file.parts:
                relative = prefix + file.relative_to(root).as_posix()
                digests.setdefault(relative, hashlib.sha256(file.read_bytes()).hexdigest())
                break
    return dict(sorted(digests.items()))


def _load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"scenes.{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def _first_paragraph(module: ModuleType) -> str:
    paragraph = inspect.getdoc(module) or ""
    return " ".join(paragraph.split("\n\n")[0].split())


def _where(error: BaseException, recipe: Path) -> str:
    """file:line of the innermost line of the recipe; of any project file if the recipe isn't involved."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{_relative(Path(error.filename))}:{error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)
    inside = [f for f in frames if Path(f.filename).resolve() == recipe.resolve()]
    project = [f for f in frames if Path(f.filename).resolve().is_relative_to(PROJECT)]
    chosen = (inside or project or frames)[-1]
    return f"{_relative(Path(chosen.filename))}:{chosen.lineno}"


def _relative(path: Path) -> str:
    path = path.resolve()
    return path.relative_to(PROJECT).as_posix() if path.is_relative_to(PROJECT) else str(path)
