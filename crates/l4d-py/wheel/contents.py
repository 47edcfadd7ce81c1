"""What a wheel holds beside the Python package: the program `l4d`, and the folders that it reads.

    python3 contents.py PROGRAM FOLDER

lays it out in FOLDER as a wheel does: `scripts/`, whose files go where programs are, and `data/`, whose files go to the
top of the environment. Installed, the program is `<environment>/bin/l4d` and finds `<environment>/share/l4d`.
"""

import os
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
# What is in `share/l4d`: its name there, where it comes from, what of it (all where nothing is said).
SHARED = {
    "benchmark": (
        "benchmark",
        ["LICENSE", "panoptic-l4d.toml", "vocabulary.txt", "recompute.py"]
        + ["dev", "published", "queries", "scenes", "truth"],
    ),
    "blender_scripts": ("blender_scripts", ["requirements.txt", "l4d_blender", "scenes"]),
    "workers": ("crates/l4d-ground/workers", ["requirements.txt", "l4d_workers"]),
    "licences": (".", ["LICENSE-APACHE", "LICENSE-MIT"]),
}
REMADE = shutil.ignore_patterns("__pycache__", "*.pyc")


def lay_out(program, folder):
    """Fills a folder that is not there yet."""
    program, folder = Path(program), Path(folder)
    scripts, share = folder / "scripts", folder / "data" / "share" / "l4d"
    scripts.mkdir(parents=True)
    copy(program, scripts / program.name)
    for name, (source, parts) in SHARED.items():
        target = share / name
        target.mkdir(parents=True)
        for part in parts:
            path = ROOT / source / part
            if path.is_dir():
                shutil.copytree(path, target / part, ignore=REMADE)
            else:
                shutil.copy(path, target / part)


def copy(source, target):
    """A second name for a large file where the file system has that, or else a copy."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copy(source, target)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    lay_out(*sys.argv[1:])
