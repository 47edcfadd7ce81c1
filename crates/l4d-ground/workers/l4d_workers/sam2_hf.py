"""SAM 2 for videos, as in transformers: boxes and points in some frames, followed through all frames in both
directions. The model is in a local folder (``facebook/sam2.1-hiera-large`` and its kin, saved by the user)."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import torch
from transformers import Sam2VideoModel, Sam2VideoProcessor

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


class Sam2:
    """A loaded model."""

    def __init__(self, options: argparse.Namespace) -> None:
        folder = model_folder(options)
        self.device = device_of(options)
        self.dtype = getattr(torch, options.dtype)
        model = Sam2VideoModel.from_pretrained(folder, local_files_only=True, dtype=self.dtype)
        self.model = model.to(self.device).eval()
        self.processor = Sam2VideoProcessor.from_pretrained(folder, local_files_only=True)
        self.weights = weights_of(folder)

    def hello(self) -> dict:
        """Boxes and points; no words."""
        return {
            "name": "sam2-hf",
            "version": __version__,
            "prompts": ["box", "point"],
            "text": None,
            "device": self.device.type,
            "weights": self.weights,
            "deps": versions(),
            "settings": {"dtype": str(self.dtype).removeprefix("torch.")},
        }

    def segment(self, request: Request) -> Iterator[Found]:
        """Masks of all objects in all frames of the range."""
        places = request.places()
        if not places or len(places) < len(request.prompts):
            raise Refusal("bad_prompt", "it takes boxes and points in frames of the range, and at least one")
        with torch.inference_mode():
            session = self.session(request)
            self.prompt(session, places, request.first)
            begin = places[0]["frame"] - request.first
            # The first frame with a prompt is part of the way forward; the way back begins before it.
            seen = set()
            for reverse in (False, True) if begin > 0 else (False,):
                steps = self.model.propagate_in_video_iterator(session, start_frame_idx=begin, reverse=reverse)
                for step in steps:
                    if request.cancelled.is_set():
                        return
                    if step.frame_idx not in seen:
                        seen.add(step.frame_idx)
                        yield from self.masks(step, request)

    def session(self, request: Request):
        """The frames, on the side of the processor: a clip need not fit the accelerator."""
        return self.processor.init_video_session(
            video=read_frames(request),
            inference_device=self.device,
            video_storage_device="cpu",
            dtype=self.dtype,
        )

    def prompt(self, session, places: list[dict], first: int) -> None:
        """Tells the model all places; those of one object in one frame belong together."""
        together: dict[tuple[int, int], list[dict]] = {}
        for place in places:
            together.setdefault((place["frame"], place["obj"]), []).append(place)
        for (frame, obj), group in sorted(together.items()):
            boxes = [place["box_px"] for place in group if "box_px" in place]
            points = [place["point_px"] for place in group if "point_px" in place]
            inputs = {}
            if boxes:
                inputs["input_boxes"] = [[[float(edge) for edge in boxes[0]]]]
            if points:
                inputs["input_points"] = [[[[float(edge) for edge in point] for point in points]]]
                inputs["input_labels"] = [[[1] * len(points)]]
            self.processor.add_inputs_to_inference_session(session, frame - first, obj, **inputs)
            self.model(inference_session=session, frame_idx=frame - first)

    def masks(self, step, request: Request) -> Iterator[Found]:
        """The masks of one frame at the size of the clip."""
        size = (request.height, request.width)
        masks = self.processor.post_process_masks([step.pred_masks], original_sizes=[list(size)], binarize=True)[0]
        scores = step.object_score_logits
        for index, obj in enumerate(step.object_ids):
            score = None if scores is None else float(scores.reshape(-1)[index].float().sigmoid())
            counts = rle.of_array(masks[index, 0].cpu().numpy())
            yield Found(step.frame_idx + request.first, int(obj), size, counts, score)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options."""
    add_model_arguments(parser)


def open_worker(options: argparse.Namespace) -> Sam2:
    """Loads the model."""
    return Sam2(options)
