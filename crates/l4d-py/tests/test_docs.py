"""The example and every block of docs/python.md run as they stand."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import l4d


@pytest.fixture
def place(world: Path, tmp_path: Path) -> Path:
    """A working folder like that of a user: scene, benchmark, model and clips where the documentation has them."""
    for folder in ("benchmark", "data", "work"):
        shutil.copytree(world / folder, tmp_path / folder)
    return tmp_path


def run(place: Path, *arguments: str) -> str:
    done = subprocess.run([sys.executable, *arguments], cwd=place, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_example_scores_a_method(root: Path, place: Path) -> None:
    example = str(root / "crates/l4d-py/examples/score_your_method.py")
    arguments = (example, "benchmark", "data/tiny/ball", "results", "scores")
    said = run(place, *arguments)
    table = {line.split()[0]: line.split()[1:] for line in said.splitlines() if line.startswith(("oracle", "whatever"))}
    assert table["oracle"] == ["100.00"] * 4
    miou, _, _, select = map(float, table["whatever-moves"])
    # It finds the ball that rolls (two queries of three), and not the one that lies.
    assert 40 < miou < 66 and select == 66.67
    assert run(place, *arguments).splitlines()[-3:] == said.splitlines()[-3:], "a second run goes on from the first"


def test_the_documentation_runs(root: Path, place: Path) -> None:
    page = (root / "docs/python.md").read_text().replace("tabletop_tea", "ball")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) >= 5
    (place / "page.py").write_text("\n".join(blocks))
    run(place, "page.py")


def test_every_public_name_is_documented(root: Path) -> None:
    page = (root / "docs/python.md").read_text()
    words = set(re.findall(r"\w+", " ".join(re.findall(r"`[^`\n]+`", page))))
    for name in set(l4d.__all__) - {"__version__"}:
        assert name in words, name
        public = getattr(l4d, name)
        members = [member for member in vars(public) if not member.startswith("_")] if isinstance(public, type) else []
        assert not (missing := [member for member in members if member not in words]), f"{name}: {missing}"
