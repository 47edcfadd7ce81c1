"""What the workers with networks share. torch and transformers are imported here and in those workers alone."""

from __future__ import annotations

import argparse
import hashlib
import os
from pathlib import Path

# Before transformers is imported: nothing is ever fetched, neither weights nor compiled kernels.
os.environ["HF_HUB_OFFLINE"] = "1"
os.environ["TRANSFORMERS_OFFLINE"] = "1"

import numpy
import torch
import transformers
from PIL import Image

from l4d_workers.protocol import Refusal, Request

BLOCK = 1 << 20


def add_model_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of every network."""
    parser.add_argument("--model", required=True, type=Path, help="folder of the model, as `save_pretrained` writes it")
    parser.add_argument("--device", default="auto", help="`auto`, `cpu`, `cuda`, `cuda:1`, `mps` (default: auto)")
    parser.add_argument("--dtype", default="float32", choices=["float32", "bfloat16", "float16"])
    parser.add_argument("--threads", type=int, help="threads on the processor (default: torch's own choice)")


def device_of(options: argparse.Namespace) -> torch.device:
    """The device that is meant; sets the number of threads."""
    if options.threads:
        torch.set_num_threads(options.threads)
    if options.device == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    return torch.device(options.device)


def model_folder(options: argparse.Namespace) -> Path:
    """The model's folder; a missing one is told in time."""
    if not (options.model / "config.json").is_file():
        raise SystemExit(f"{options.model}: no config.json: name a folder that `save_pretrained` wrote")
    return options.model


def weights_of(folder: Path) -> dict:
    """What the model is, wherever it stands: name of the folder and digest of everything in it."""
    digest = hashlib.sha256()
    for path in sorted(path for path in folder.iterdir() if path.is_file() and not path.name.startswith(".")):
        digest.update(path.name.encode() + b"\0")
        digest_file(path, digest)
    return {"id": folder.resolve().name, "sha256": digest.hexdigest()}


def digest_file(path: Path, digest) -> None:
    """Adds a file's length and bytes to a digest."""
    digest.update(path.stat().st_size.to_bytes(8, "big"))
    with path.open("rb") as file:
        while block := file.read(BLOCK):
            digest.update(block)


def versions() -> dict:
    """Libraries that masks depend on."""
    return {"torch": torch.__version__, "transformers": transformers.__version__}


def read_frames(request: Request) -> numpy.ndarray:
    """The frames within the range: time x rows x columns x 3, bytes."""
    frames = []
    for path in request.files[request.first : request.last + 1]:
        try:
            with Image.open(path) as picture:
                frame = numpy.asarray(picture.convert("RGB"))
        except OSError as error:
            raise Refusal("frames", f"{path.name}: {error}") from error
        if frame.shape != (request.height, request.width, 3):
            raise Refusal("frames", f"{path.name} has {frame.shape[1]}x{frame.shape[0]} pixels")
        frames.append(frame)
    return numpy.stack(frames)
