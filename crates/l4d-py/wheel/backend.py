"""Builds the wheel: maturin's backend, with the program `l4d` and the folders that it reads beside the Python package.

    pip wheel --no-deps --wheel-dir dist ./crates/l4d-py

Settings (`--config-settings NAME=VALUE`): `profile` of cargo in place of `release`; `program`, the path of an `l4d` that
is built already; and those of maturin. `maturin build` does not call this backend: its wheel is the package alone.
"""

import json
import os
import shutil
import subprocess
import sys

import contents
import maturin
from maturin import (
    build_editable,
    get_requires_for_build_editable,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

PACKAGE = contents.ROOT / "crates" / "l4d-py"
# What is in a folder of the name of the module is put into the wheel.
STAGED = PACKAGE / "l4d._native.data"
# The interface to graphics hardware that comes with the system, where that is not Vulkan.
FEATURES = {"darwin": ["--features", "metal"]}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    settings = dict(config_settings or {})
    profile = settings.pop("profile", "release")
    program = settings.pop("program", None) or build_program(profile)
    arguments = [*maturin.get_maturin_pep517_args(settings), "--profile", profile]
    shutil.rmtree(STAGED, ignore_errors=True)
    try:
        contents.lay_out(program, STAGED)
        return maturin.build_wheel(wheel_directory, {**settings, "build-args": arguments}, metadata_directory)
    finally:
        shutil.rmtree(STAGED, ignore_errors=True)


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("error: the source of l4d is its repository\n\nhint: build a wheel there: python -m build --wheel crates/l4d-py")


def build_program(profile):
    """The path of the program, built without symbols, which are a third of it."""
    cargo = ["cargo", "rustc", "--locked", "--profile", profile, "--package", "l4d", "--bin", "l4d"]
    cargo += [*FEATURES.get(sys.platform, []), "--message-format", "json-render-diagnostics"]
    built = subprocess.run([*cargo, "--", "-C", "strip=symbols"], cwd=contents.ROOT, stdout=subprocess.PIPE, check=False)
    if built.returncode != 0:
        raise SystemExit("error: cargo could not build the program l4d; see above")
    messages = [json.loads(line) for line in built.stdout.splitlines() if line.startswith(b"{")]
    executables = [message["executable"] for message in messages if message.get("executable")]
    return os.fspath(executables[-1])
