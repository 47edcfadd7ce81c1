"""Weights for Rust: `python -m l4d_network.export`. One ONNX file, weights in 8 bits, and a description beside it.

The file has two parts that share nothing: pictures to features and pixels, and rows of `pool` to kinds and values.
Weights are rounded first, so that PyTorch on rounded weights and Rust on the file compute the same.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
from pathlib import Path

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from torch import Tensor, nn

from . import segment
from .model import OFFSET_PX, Encoder, Network, pool

SCHEMA = "l4d/perception/2"
LEAST_ROUNDED = 1024
"""Smaller tensors stay in 32 bits."""


def main() -> None:
    """Writes perception.onnx, perception.json and, for the parity test, parity.npz."""
    parser = argparse.ArgumentParser(prog="l4d_network.export", description=__doc__)
    parser.add_argument("--checkpoint", type=Path, required=True)
    parser.add_argument("--card", type=Path, help="JSON with what is told of the training")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    state = torch.load(options.checkpoint, weights_only=False, map_location="cpu")
    size = state["size"]
    network = Network(state["words"], Encoder(size.encoder, pretrained=False), size)
    network.load_state_dict(state["averaged"])
    card = json.loads(options.card.read_text(encoding="utf-8")) if options.card else {}
    write(network, options.out, {"iterations": state["iteration"], **card})


def write(network: Network, out: Path, card: dict) -> None:
    """Writes a network as it is used: normalisation folded into convolutions, weights rounded."""
    out.mkdir(parents=True, exist_ok=True)
    network = network.eval()
    _fold(network)
    rounded = _round(network)
    model = _model(network, rounded)
    onnx.checker.check_model(model)
    data = model.SerializeToString()
    (out / "perception.onnx").write_bytes(data)
    words = network.words
    description = {
        "schema": SCHEMA,
        "sha256": hashlib.sha256(data).hexdigest(),
        "kinds": list(words.kinds),
        "values": [list(pair) for pair in words.values],
        "dense": network.size.dense,
        "widths": list(network.size.widths),
        "parts": network.size.parts,
        "object": network.size.object,
        "offset_px": OFFSET_PX,
        "peak": segment.PEAK,
        "peak_px": segment.PEAK_PX,
        "most": segment.MOST,
        "training": card,
    }
    text = json.dumps(description, indent=1, sort_keys=True)
    (out / "perception.json").write_text(text + "\n", encoding="utf-8")
    _parity(network, out)


def _fold(network: Network) -> None:
    """Batch normalisation becomes part of the convolution before it."""
    for block in getattr(network.encoder, "blocks", ()):
        for conv, norm in (("_expand_conv", "_bn0"), ("_depthwise_conv", "_bn1"), ("_project_conv", "_bn2")):
            if hasattr(block, conv) and hasattr(block, norm):
                _fold_pair(getattr(block, conv), getattr(block, norm))
                setattr(block, norm, nn.Identity())
    if isinstance(getattr(network.encoder, "norm", None), nn.BatchNorm2d):
        _fold_pair(network.encoder.stem, network.encoder.norm)
        network.encoder.norm = nn.Identity()
    for module in list(network.modules()):
        padding = getattr(module, "static_padding", None)
        if isinstance(padding, nn.ZeroPad2d):
            left, right, top, bottom = padding.padding
            if left == right and top == bottom:  # what is uneven stays a layer of its own
                module.padding, module.static_padding = (top, left), nn.Identity()
        if isinstance(module, nn.Sequential) and len(module) == 3 and isinstance(module[1], nn.BatchNorm2d):
            _fold_pair(module[0], module[1])
            module[1] = nn.Identity()


def _fold_pair(conv: nn.Conv2d, norm: nn.BatchNorm2d) -> None:
    scale = (norm.weight / torch.sqrt(norm.running_var + norm.eps)).detach()
    bias = conv.bias.detach() if conv.bias is not None else torch.zeros_like(norm.running_mean)
    conv.weight = nn.Parameter(conv.weight.detach() * scale[:, None, None, None])
    conv.bias = nn.Parameter((bias - norm.running_mean) * scale + norm.bias.detach())


def _round(network: Network) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Rounds large weights to 8 bits a channel, in place; returns the integers and their steps by name."""
    found = {}
    for name, parameter in network.named_parameters():
        if parameter.dim() < 2 or parameter.numel() < LEAST_ROUNDED:
            continue
        weight = parameter.detach().numpy()
        flat = np.abs(weight.reshape(weight.shape[0], -1)).max(1)
        step = np.maximum(flat / 127.0, 1e-12).astype(np.float32)
        shape = (-1,) + (1,) * (weight.ndim - 1)
        whole = np.clip(np.rint(weight / step.reshape(shape)), -127, 127).astype(np.int8)
        parameter.data = torch.from_numpy(whole.astype(np.float32) * step.reshape(shape))
        found[name] = whole, step
    return found


class _Pictures(nn.Module):
    """From a picture to features and pixels."""

    def __init__(self, network: Network) -> None:
        super().__init__()
        self.network = network

    def forward(self, picture: Tensor) -> tuple[Tensor, ...]:
        features, pixels, parts = self.network(picture)
        return (pixels, parts, *features)


class _Objects(nn.Module):
    """From rows of `pool` to kinds and values."""

    def __init__(self, network: Network) -> None:
        super().__init__()
        self.network = network

    def forward(self, objects: Tensor) -> tuple[Tensor, Tensor]:
        return self.network.describe(objects)


def _model(network: Network, rounded: dict[str, tuple[np.ndarray, np.ndarray]]) -> onnx.ModelProto:
    levels = [f"level{i}" for i in range(1 + len(network.size.widths))]
    pictures = _exported(
        _Pictures(network), torch.zeros(1, 3, 192, 256), "picture", ["pixels", "parts", *levels], {2: "height", 3: "width"}
    )
    objects = _exported(_Objects(network), torch.zeros(2, network.size.object), "objects", ["kinds", "values"], {0: "count"})
    graph = onnx.compose.merge_graphs(
        onnx.compose.add_prefix_graph(pictures.graph, "p.", rename_inputs=False, rename_outputs=False),
        onnx.compose.add_prefix_graph(objects.graph, "o.", rename_inputs=False, rename_outputs=False),
        io_map=[],
    )
    _pack(graph, rounded)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], producer_name="l4d")
    model.ir_version = 8
    return model


def _exported(
    module: nn.Module, example: Tensor, name: str, outputs: list[str], axes: dict[int, str]
) -> onnx.ModelProto:
    buffer = io.BytesIO()
    dynamic = {name: axes, **{output: axes for output in outputs}}
    torch.onnx.export(
        module.eval(),
        (example,),
        buffer,
        input_names=[name],
        output_names=outputs,
        dynamic_axes=dynamic,
        opset_version=17,
        dynamo=False,
        do_constant_folding=True,
    )
    return onnx.load_model_from_string(buffer.getvalue())


def _pack(graph: onnx.GraphProto, rounded: dict[str, tuple[np.ndarray, np.ndarray]]) -> None:
    """Replaces rounded weights by their integers, with a node that multiplies them out."""
    known = {whole.tobytes(): (whole, step) for whole, step in rounded.values()}
    by_value = {}
    for whole, step in known.values():
        shape = (-1,) + (1,) * (whole.ndim - 1)
        by_value[(whole.astype(np.float32) * step.reshape(shape)).tobytes()] = (whole, step, False)
        if whole.ndim == 2:
            turned = np.ascontiguousarray((whole.astype(np.float32) * step.reshape(shape)).T)
            by_value.setdefault(turned.tobytes(), (np.ascontiguousarray(whole.T), step, True))
    first = []
    for tensor in list(graph.initializer):
        array = numpy_helper.to_array(tensor)
        if array.dtype != np.float32 or array.tobytes() not in by_value:
            continue
        whole, step, turned = by_value[array.tobytes()]
        name = tensor.name
        graph.initializer.remove(tensor)
        zero = np.zeros(step.shape, np.int8)
        for suffix, value in ((".whole", whole), (".step", step), (".zero", zero)):
            graph.initializer.append(numpy_helper.from_array(value, name + suffix))
        inputs = [name + suffix for suffix in (".whole", ".step", ".zero")]
        first.append(helper.make_node("DequantizeLinear", inputs, [name], axis=1 if turned else 0))
    rest = list(graph.node)
    del graph.node[:]
    graph.node.extend([*first, *rest])


def _parity(network: Network, out: Path) -> None:
    """A small picture with two masks, and what PyTorch says of it."""
    generator = torch.Generator().manual_seed(1)
    picture = torch.rand((1, 3, 64, 96), generator=generator)
    picture = (picture + torch.linspace(0, 1, 96)).clamp(0, 2) / 2
    masks = torch.zeros(2, 32, 48)
    masks[0, 4:15, 6:20] = 1.0
    masks[1, 18:31, 25:44] = 1.0
    with torch.no_grad():
        features, pixels, parts = network(picture)
        rows = pool(features, nn.functional.avg_pool2d(picture, 2), parts, masks[None])[0]
        kinds, values = network.describe(rows)
    numbers = {
        "picture": picture[0],
        "masks": masks,
        "pixels": pixels[0],
        "segments": segment.segment(pixels[0]).float(),
        "rows": rows,
        "kinds": kinds,
        "values": values,
    }
    np.savez_compressed(out / "parity.npz", **{key: value.numpy() for key, value in numbers.items()})


if __name__ == "__main__":
    main()
