"""Finds nothing, whatever it is asked: the other end of the protocol, for trying things out."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from l4d_workers import __version__
from l4d_workers.protocol import Found, Request


class Null:
    """A worker without an opinion."""

    def hello(self) -> dict:
        """Takes everything."""
        return {"name": "null", "version": __version__, "prompts": ["box", "point", "text"], "text": "sentence"}

    def segment(self, request: Request) -> Iterator[Found]:
        """No masks."""
        return iter(())


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """It has no options."""


def open_worker(options: argparse.Namespace) -> Null:
    """The worker."""
    return Null()
