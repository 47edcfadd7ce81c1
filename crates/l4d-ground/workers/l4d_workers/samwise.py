"""SAMWISE, from the user's own checkout and in the user's own environment (CUDA only): a sentence, and masks of what it
means. The checkout must hold the weights of SAM 2 and RoBERTa in ``pretrain/``; nothing is fetched."""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from l4d_workers import __version__, rle
from l4d_workers.protocol import Found, Refusal, Request

# Files that the checkout would fetch by itself; by version of SAM 2.
SAM2_FILES = {"tiny": "sam2_hiera_tiny.pt", "base": "sam2_hiera_base_plus.pt", "large": "sam2_hiera_large.pt"}
# Frames that the model sees together, as its own demo has it.
WINDOW = 8


class Samwise:
    """A loaded model."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.checkout = options.checkout.resolve()
        self.weights = options.weights.resolve()
        self.version = options.sam2_version
        check(self.checkout, self.weights, self.version)
        os.environ["HF_HUB_OFFLINE"] = "1"
        # The checkout's modules are found, and its relative paths hold, only from inside.
        sys.path.insert(0, str(self.checkout))
        os.chdir(self.checkout)
        import torch

        if not torch.cuda.is_available():
            raise SystemExit("SAMWISE computes on CUDA alone, and torch finds none here")
        self.torch = torch
        self.model, self.args = self.load()

    def load(self):
        """The model, as the checkout's own demo loads it for videos."""
        torch = self.torch
        import opts
        from models.samwise import build_samwise
        from util.misc import on_load_checkpoint

        torch.manual_seed(0)
        torch.backends.cudnn.deterministic = True
        torch.backends.cudnn.benchmark = False
        arguments = ["--HSA", "--sam2_version", self.version, "--resume", str(self.weights)]
        args = argparse.ArgumentParser(parents=[opts.get_args_parser()]).parse_args(arguments)
        args.use_cme_head = False
        model = build_samwise(args).to(torch.device(args.device))
        checkpoint = torch.load(args.resume, map_location="cpu")
        state = checkpoint["model"]
        if next(iter(state)).startswith("module"):
            checkpoint["model"] = {name.replace("module.", ""): value for name, value in state.items()}
        checkpoint = on_load_checkpoint(model, checkpoint)
        model.load_state_dict(checkpoint["model"], strict=False)
        return model.eval(), args

    def hello(self) -> dict:
        """Sentences."""
        return {
            "name": "samwise",
            "version": __version__,
            "prompts": ["text"],
            "text": "sentence",
            "device": "cuda",
            "weights": {"id": self.weights.name, "sha256": digest(self.weights)},
            "deps": {"torch": self.torch.__version__, "checkout": commit(self.checkout)},
            "settings": {"sam2_version": self.version, "window": WINDOW},
        }

    def segment(self, request: Request) -> Iterator[Found]:
        """Masks of what the sentence means, as one object."""
        texts = request.texts()
        if len(texts) != 1 or len(request.prompts) != 1:
            raise Refusal("bad_prompt", "it takes one sentence")
        torch = self.torch
        from datasets.transform_utils import VideoEvalDataset

        files = request.files[request.first : request.last + 1]
        stems, ending = [path.stem for path in files], files[0].suffix
        frames = VideoEvalDataset(str(files[0].parent), stems, ext=ending)
        size = (request.height, request.width)
        for numbers in windows(len(files)):
            if request.cancelled.is_set():
                return
            pictures = torch.stack([frames[number][0] for number in numbers]).to(self.args.device)
            # The model forgets the last clip when it sees number 0.
            target = {"size": torch.as_tensor(pictures.shape[-2:]).to(self.args.device), "frame_ids": numbers}
            with torch.no_grad():
                logits = self.model([pictures], [texts[0]], [target])["pred_masks"].unsqueeze(0)
            logits = torch.nn.functional.interpolate(logits, size=size, mode="bilinear", align_corners=False)
            masks = (logits.sigmoid() > self.args.threshold)[0].cpu().numpy()
            for number, mask in zip(numbers, masks):
                yield Found(number + request.first, 1, size, rle.of_array(mask))


def windows(count: int) -> list[list[int]]:
    """The frames that the model sees together. One frame alone would be taken for a picture and forget the clip, so a
    last one joins those before it: l4d's clips have 9, 49 and 97 frames, each one more than whole windows."""
    numbers = list(range(count))
    parts = [numbers[begin : begin + WINDOW] for begin in range(0, count, WINDOW)]
    if len(parts) > 1 and len(parts[-1]) == 1:
        last = parts.pop()
        parts[-1] += last
    return parts


def check(checkout: Path, weights: Path, version: str) -> None:
    """Everything that would be fetched must be there."""
    needed = [
        checkout / "inference_demo.py",
        checkout / "models" / "samwise.py",
        checkout / "pretrain" / SAM2_FILES[version],
        checkout / "pretrain" / "roberta.base",
        weights,
    ]
    missing = [str(path) for path in needed if not path.exists()]
    if missing:
        raise SystemExit("missing, and never fetched from here: " + ", ".join(missing))


def digest(path: Path) -> str:
    """SHA-256 of a file."""
    running = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            running.update(block)
    return running.hexdigest()


def commit(checkout: Path) -> str:
    """The checkout's commit, if git knows it."""
    command = ["git", "-C", str(checkout), "rev-parse", "HEAD"]
    try:
        told = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return told.stdout.strip()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options."""
    parser.add_argument("--checkout", required=True, type=Path, help="folder of the user's SAMWISE checkout")
    parser.add_argument("--weights", required=True, type=Path, help="checkpoint, e.g. final_model_mevis.pth")
    parser.add_argument("--sam2-version", default="base", choices=sorted(SAM2_FILES))


def open_worker(options: argparse.Namespace) -> Samwise:
    """Loads the model."""
    return Samwise(options)
