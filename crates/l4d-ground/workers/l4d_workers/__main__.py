"""``python -m l4d_workers NAME [options]``: runs a worker until its stdin ends."""

from __future__ import annotations

import argparse
import importlib
import sys

from l4d_workers import protocol

# Imported by name, so that a worker without networks never loads torch.
WORKERS = {
    "null": "l4d_workers.null",
    "box": "l4d_workers.box",
    "sam2-hf": "l4d_workers.sam2_hf",
    "sam3-hf": "l4d_workers.sam3_hf",
    "samwise": "l4d_workers.samwise",
}


def main(arguments: list[str]) -> None:
    """Parses the arguments and serves."""
    names = argparse.ArgumentParser(prog="python -m l4d_workers", description=__doc__)
    names.add_argument("worker", choices=sorted(WORKERS))
    name = names.parse_args(arguments[:1]).worker
    module = importlib.import_module(WORKERS[name])
    parser = argparse.ArgumentParser(prog=f"python -m l4d_workers {name}", description=module.__doc__)
    module.add_arguments(parser)
    options = parser.parse_args(arguments[1:])
    protocol.serve(lambda: module.open_worker(options))


if __name__ == "__main__":
    main(sys.argv[1:])
