"""SAM 3 for videos, as in transformers: a noun phrase, and masks of everything that it names. The model is in a
local folder (``facebook/sam3``, saved by the user; its weights have a licence of their own)."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy
import torch
from transformers import Sam3VideoModel, Sam3VideoProcessor
from transformers.models.sam3_video import modeling_sam3_video

from l4d_workers import __version__, rle
from l4d_workers.protocol import Found, Refusal, Request
from l4d_workers.torch_common import (
    add_model_arguments,
    device_of,
    model_folder,
    read_frames,
    versions,
    weights_of,
)

# Two objects of one phrase that overlap by more than this in a frame are one.
SAME_OBJECT_IOU = 0.7


class Sam3:
    """A loaded model."""

    def __init__(self, options: argparse.Namespace) -> None:
        # Duplicates and specks would be removed by compiled code from the hub, which is never fetched.
        modeling_sam3_video.cv_utils_kernel = False
        folder = model_folder(options)
        self.device = device_of(options)
        self.dtype = getattr(torch, options.dtype)
        model = Sam3VideoModel.from_pretrained(folder, local_files_only=True, dtype=self.dtype)
        self.model = model.to(self.device).eval()
        self.processor = Sam3VideoProcessor.from_pretrained(folder, local_files_only=True)
        self.longest = self.model.config.detector_config.text_config.max_position_embeddings
        self.weights = weights_of(folder)

    def hello(self) -> dict:
        """Short phrases alone: longer text is no noun phrase to it."""
        return {
            "name": "sam3-hf",
            "version": __version__,
            "prompts": ["text"],
            "text": "phrase",
            "text_max_tokens": self.longest,
            "device": self.device.type,
            "weights": self.weights,
            "deps": versions(),
            "settings": {
                "dtype": str(self.dtype).removeprefix("torch."),
                "same_object_iou": SAME_OBJECT_IOU,
            },
        }

    def segment(self, request: Request) -> Iterator[Found]:
        """Masks of everything that the phrase names."""
        texts = request.texts()
        if len(texts) != 1 or len(request.prompts) != 1:
            raise Refusal("bad_prompt", "it takes one phrase")
        self.check_length(texts[0])
        request.skip("the model's own removal of duplicates (done here by overlap) and of specks and holes")
        with torch.inference_mode():
            session = self.processor.init_video_session(
                video=read_frames(request),
                inference_device=self.device,
                video_storage_device="cpu",
                dtype=self.dtype,
            )
            self.processor.add_text_prompt(session, texts[0])
            count = request.last - request.first + 1
            steps = self.model.propagate_in_video_iterator(inference_session=session, max_frame_num_to_track=count)
            for step in steps:
                if request.cancelled.is_set():
                    return
                yield from self.masks(step, session, request)

    def check_length(self, text: str) -> None:
        """Longer text would fail inside the model."""
        count = len(self.processor.tokenizer(text)["input_ids"])
        if count > self.longest:
            raise Refusal("bad_text", f"a text of {count} tokens, where a phrase of {self.longest} is the most")

    def masks(self, step, session, request: Request) -> Iterator[Found]:
        """The masks of one frame, which need not come in the order of time."""
        found = self.processor.postprocess_outputs(session, step)
        masks = found["masks"].cpu().numpy()
        scores = found["scores"].float().cpu().numpy()
        for index in without_duplicates(masks, scores):
            if scores[index] >= request.threshold:
                size = (request.height, request.width)
                frame = step.frame_idx + request.first
                counts = rle.of_array(masks[index])
                yield Found(frame, int(found["object_ids"][index]), size, counts, float(scores[index]))


def without_duplicates(masks: numpy.ndarray, scores: numpy.ndarray) -> list[int]:
    """Indices of the masks that no better one repeats, ascending."""
    kept: list[int] = []
    for index in numpy.argsort(-scores, kind="stable").tolist():
        if all(overlap(masks[index], masks[other]) <= SAME_OBJECT_IOU for other in kept):
            kept.append(index)
    return sorted(kept)


def overlap(a: numpy.ndarray, b: numpy.ndarray) -> float:
    """Intersection over union; 0 for two empty masks."""
    union = int((a | b).sum())
    return int((a & b).sum()) / union if union else 0.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options."""
    add_model_arguments(parser)


def open_worker(options: argparse.Namespace) -> Sam3:
    """Loads the model."""
    return Sam3(options)
