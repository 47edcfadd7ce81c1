"""Writes tiny randomly initialised models of the real classes: ``python tiny_models.py FOLDER``.

They have never seen anything and find nonsense, in the same way each time: what loading, prompting, following and
encoding are tried on without any weights. The sizes are about the smallest that the classes take.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

os.environ["HF_HUB_OFFLINE"] = "1"

import torch
from tokenizers import Tokenizer, models, pre_tokenizers, processors
from transformers import (
    PreTrainedTokenizerFast,
    Sam2HieraDetConfig,
    Sam2ImageProcessor,
    Sam2VideoConfig,
    Sam2VideoModel,
    Sam2VideoProcessor,
    Sam2VideoVideoProcessor,
    Sam2VisionConfig,
    Sam3ImageProcessor,
    Sam3VideoConfig,
    Sam3VideoModel,
    Sam3VideoProcessor,
)

# The memory of both trackers has 64 channels, hard-coded; hidden sizes must be a larger multiple of it.
HIDDEN = 128
MEMORY = 64
PICTURE_MEAN = [0.5, 0.5, 0.5]


def tracker_sizes() -> dict:
    """The parts that both trackers have."""
    return {
        "memory_attention_hidden_size": HIDDEN,
        "memory_attention_num_layers": 1,
        "memory_attention_feed_forward_hidden_size": 64,
        "memory_encoder_hidden_size": HIDDEN,
        "memory_encoder_output_channels": MEMORY,
        "mask_downsampler_embed_dim": HIDDEN,
        "memory_fuser_embed_dim": HIDDEN,
        "memory_fuser_intermediate_dim": 64,
    }


def decoder_sizes() -> dict:
    """The mask decoder of both trackers."""
    return {
        "hidden_size": HIDDEN,
        "mlp_dim": 64,
        "num_hidden_layers": 2,
        "num_attention_heads": 4,
        "iou_head_hidden_dim": 32,
    }


def square(side: int) -> dict:
    return {"height": side, "width": side}


def write_sam2(folder: Path, side: int = 128) -> None:
    """SAM 2 for videos, about a million weights."""
    # A block with global attention must not be the first of a stage that pools.
    backbone = Sam2HieraDetConfig(
        hidden_size=8,
        num_attention_heads=1,
        image_size=[side, side],
        blocks_per_stage=[1, 1, 2, 1],
        embed_dim_per_stage=[8, 16, 32, 64],
        num_attention_heads_per_stage=[1, 2, 4, 8],
        window_size_per_stage=[8, 4, 4, 2],
        window_positional_embedding_background_size=[4, 4],
        global_attention_blocks=[3],
    )
    vision = Sam2VisionConfig(
        backbone_config=backbone,
        backbone_channel_list=[64, 32, 16, 8],
        backbone_feature_sizes=[[side // 4] * 2, [side // 8] * 2, [side // 16] * 2],
        fpn_hidden_size=HIDDEN,
        num_feature_levels=3,
    )
    config = Sam2VideoConfig(
        vision_config=vision,
        prompt_encoder_config={"hidden_size": HIDDEN, "image_size": side, "patch_size": 16},
        mask_decoder_config=decoder_sizes(),
        image_size=side,
        memory_attention_rope_feat_sizes=[side // 16] * 2,
        **tracker_sizes(),
    )
    torch.manual_seed(0)
    Sam2VideoModel(config).save_pretrained(folder)
    processor = Sam2VideoProcessor(
        image_processor=Sam2ImageProcessor(size=square(side), mask_size=square(side // 4)),
        video_processor=Sam2VideoVideoProcessor(size=square(side)),
    )
    processor.target_size = side
    processor.save_pretrained(folder)


def write_sam3(folder: Path, grid: int = 8, patch: int = 14) -> None:
    """SAM 3 for videos, about four million weights."""
    side = grid * patch
    vision = {
        "model_type": "sam3_vision_model",
        "backbone_config": {
            "model_type": "sam3_vit_model",
            "hidden_size": 32,
            "intermediate_size": 64,
            "num_hidden_layers": 2,
            "num_attention_heads": 4,
            "image_size": side,
            "patch_size": patch,
            "window_size": 4,
            "global_attn_indexes": [1],
            "pretrain_image_size": side,
        },
        "fpn_hidden_size": HIDDEN,
        "backbone_feature_sizes": [[4 * grid] * 2, [2 * grid] * 2, [grid] * 2],
        "scale_factors": [4.0, 2.0, 1.0, 0.5],
    }
    text = {
        "model_type": "clip_text_model",
        "vocab_size": 300,
        "hidden_size": 32,
        "intermediate_size": 64,
        "projection_dim": 32,
        "num_hidden_layers": 1,
        "num_attention_heads": 4,
        "max_position_embeddings": 32,
        "hidden_act": "gelu",
        "bos_token_id": 256,
        "eos_token_id": 257,
        "pad_token_id": 257,
    }
    layer = {"hidden_size": HIDDEN, "num_layers": 1, "num_attention_heads": 4, "intermediate_size": 64}
    detector = {
        "model_type": "sam3",
        "vision_config": vision,
        "text_config": text,
        "geometry_encoder_config": layer,
        "detr_encoder_config": layer,
        "detr_decoder_config": {**layer, "num_queries": 8},
        "mask_decoder_config": {"hidden_size": HIDDEN, "num_upsampling_stages": 3, "num_attention_heads": 4},
    }
    tracker = {
        "model_type": "sam3_tracker_video",
        "vision_config": vision,
        "prompt_encoder_config": {"hidden_size": HIDDEN, "image_size": side, "patch_size": patch},
        "mask_decoder_config": decoder_sizes(),
        "image_size": side,
        **tracker_sizes(),
    }
    config = Sam3VideoConfig(
        detector_config=detector,
        tracker_config=tracker,
        low_res_mask_size=4 * grid,
        # Frames come out later than they are asked for, as with the real settings.
        hotstart_delay=2,
        hotstart_unmatch_thresh=2,
        hotstart_dup_thresh=2,
        # Random weights are sure of nothing: everything counts as found.
        score_threshold_detection=0.0,
        new_det_thresh=0.0,
        max_num_objects=3,
    )
    # The constructor would put its own default here.
    config.image_size = side
    torch.manual_seed(0)
    Sam3VideoModel(config).save_pretrained(folder)
    Sam3VideoProcessor(
        image_processor=Sam3ImageProcessor(size=square(side), mask_size=square(4 * grid)),
        video_processor=Sam2VideoVideoProcessor(size=square(side), image_mean=PICTURE_MEAN, image_std=PICTURE_MEAN),
        tokenizer=byte_tokenizer(),
    ).save_pretrained(folder)


def byte_tokenizer() -> PreTrainedTokenizerFast:
    """One token a byte, with a mark at each end, as CLIP has them."""
    vocabulary = {letter: index for index, letter in enumerate(sorted(pre_tokenizers.ByteLevel.alphabet()))}
    tokenizer = Tokenizer(models.BPE(vocab=vocabulary, merges=[]))
    tokenizer.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    begin, end = "<|startoftext|>", "<|endoftext|>"
    tokenizer.add_special_tokens([begin, end])
    marks = [(mark, tokenizer.token_to_id(mark)) for mark in (begin, end)]
    tokenizer.post_processor = processors.TemplateProcessing(single=f"{begin} $A {end}", special_tokens=marks)
    return PreTrainedTokenizerFast(tokenizer_object=tokenizer, bos_token=begin, eos_token=end, pad_token=end)


def main(folder: str) -> None:
    write_sam2(Path(folder) / "sam2")
    write_sam3(Path(folder) / "sam3")


if __name__ == "__main__":
    main(*sys.argv[1:])
