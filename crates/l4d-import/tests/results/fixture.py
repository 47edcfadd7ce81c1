"""Makes relevancy.npz: latents, an autoencoder and sentences with the masks that the originals' evaluation finds.

    python crates/l4d-import/tests/results/fixture.py

The evaluation is written anew from its definition, with numpy and torch: LangSplat's mirrored box of 30 with the
majority that leaves out the last row and column, and the pools of 29 and 7 of LangSplatV2 and 4D LangSplat. A map
whose values lie so near the threshold that rounding decides would make the masks of a fixture a matter of luck; the
file says how near the nearest is.
"""

from pathlib import Path

import numpy as np
import torch

HERE = Path(__file__).resolve().parent
WIDTHS = [3, 16, 32, 64, 48]
HEIGHT, WIDTH = 44, 58
LEVELS, SENTENCES, PHRASES = 3, 5, 4


def main() -> None:
    """Draws everything from one seed and writes it."""
    random = np.random.default_rng(7)
    weights = [(random.normal(size=(b, a)) / np.sqrt(a), 0.1 * random.normal(size=b)) for a, b in zip(WIDTHS, WIDTHS[1:])]
    weights = [(w.astype("f4"), b.astype("f4")) for w, b in weights]
    positives, negatives = unit(random.normal(size=(SENTENCES, WIDTHS[-1]))), unit(random.normal(size=(PHRASES, WIDTHS[-1])))
    levels = [smooth_field(random) for _ in range(LEVELS)]
    maps = np.stack([relevancy(decode(level, weights), positives, negatives) for level in levels])
    arrays = {"levels": np.stack(levels), "positives": positives, "negatives": negatives}
    for index, (weight, bias) in enumerate(weights):
        arrays[f"decoder.{2 * index}.weight"], arrays[f"decoder.{2 * index}.bias"] = weight, bias
    for name, blend, majority in [("box30", box30, majority_of_langsplat), ("pool29", pool29, majority_of_pool)]:
        smoothed = 0.5 * (np.stack([[blend(m) for m in level] for level in maps]) + maps)
        chosen = smoothed.max(axis=(2, 3)).argmax(axis=0)
        best = np.stack([smoothed[level, sentence] for sentence, level in enumerate(chosen)])
        arrays[f"{name}.range"] = np.stack([best.min(axis=(1, 2)), best.max(axis=(1, 2))], -1).astype("f4")
        stretched = np.stack([[stretch(m) for m in level] for level in smoothed])
        raw = stretched > 0.4
        best = np.stack([raw[level, sentence] for sentence, level in enumerate(chosen)])
        masks = np.stack([majority(mask) for mask in best])
        visible = np.roll(masks, (2, -3), axis=(1, 2))
        arrays |= {f"{name}.level": chosen, f"{name}.unsmoothed": best, f"{name}.mask": masks, f"{name}.truth": visible}
        union = (masks | visible).sum(axis=(1, 2))
        arrays[f"{name}.iou"] = ((masks & visible).sum(axis=(1, 2)) / union).astype("f8")
        print(name, "levels", chosen, "nearest to the threshold", np.abs(stretched - 0.4).min(), "iou", arrays[f"{name}.iou"])
    np.savez_compressed(HERE / "fixtures" / "relevancy.npz", **arrays)


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length 1."""
    return (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).astype("f4")


def smooth_field(random: np.random.Generator) -> np.ndarray:
    """Latents that vary slowly, no longer than 1, with a corner where nothing was rendered."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    waves = [np.sin(random.uniform(0.05, 0.3) * x + random.uniform(0.05, 0.3) * y + random.uniform(0, 6)) for _ in range(3)]
    field = np.stack(waves, -1) + 0.2 * random.normal(size=(HEIGHT, WIDTH, 3))
    field /= np.linalg.norm(field, axis=-1, keepdims=True) * random.uniform(1, 1.2, (HEIGHT, WIDTH, 1))
    field[:6, :9] = 0
    return field.astype("f4")


def decode(latents: np.ndarray, weights: list) -> np.ndarray:
    """Embeddings of length 1."""
    values = torch.from_numpy(latents).double()
    for index, (weight, bias) in enumerate(weights):
        values = values @ torch.from_numpy(weight).double().T + torch.from_numpy(bias).double()
        if index + 1 < len(weights):
            values = torch.relu(values)
    return (values / values.norm(dim=-1, keepdim=True)).numpy()


def relevancy(embeddings: np.ndarray, positives: np.ndarray, negatives: np.ndarray) -> np.ndarray:
    """Smallest probability of a sentence beside each phrase."""
    positive, negative = embeddings @ positives.T.astype("f8"), embeddings @ negatives.T.astype("f8")
    pairs = np.stack(np.broadcast_arrays(positive[..., None], negative[..., None, :]), -1)
    shares = np.exp(10 * pairs) / np.exp(10 * pairs).sum(-1, keepdims=True)
    return np.moveaxis(shares[..., 0].min(-1), -1, 0)


def box30(values: np.ndarray) -> np.ndarray:
    """Mean of rows y-15 to y+14 and columns alike, mirrored without the edge."""
    padded = np.pad(values, ((15, 14), (15, 14)), mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, (30, 30))
    return windows.mean(axis=(2, 3))


def pool29(values: np.ndarray) -> np.ndarray:
    """Mean of the pixels at most 14 away that there are."""
    pool = torch.nn.AvgPool2d(29, 1, 14, count_include_pad=False)
    return pool(torch.from_numpy(values)[None, None])[0, 0].numpy()


def stretch(values: np.ndarray) -> np.ndarray:
    """Over its own range, the upper half."""
    values = values - values.min()
    return np.clip(values / (values.max() + 1e-9) * 2 - 1, 0, 1)


def majority_of_langsplat(mask: np.ndarray) -> np.ndarray:
    """The more frequent value of at most 7 x 7; the last row and column never vote, ties are outside."""
    height, width = mask.shape
    kept = np.zeros_like(mask)
    for row in range(height):
        for col in range(width):
            near = mask[max(0, row - 3) : min(row + 4, height - 1), max(0, col - 3) : min(col + 4, width - 1)]
            kept[row, col] = np.argmax(np.bincount(near.reshape(-1).astype(int)))
    return kept


def majority_of_pool(mask: np.ndarray) -> np.ndarray:
    """Mean of at most 7 x 7 above one half."""
    pool = torch.nn.AvgPool2d(7, 1, 3, count_include_pad=False)
    return (pool(torch.from_numpy(mask).float()[None, None]) > 0.5)[0, 0].numpy()


if __name__ == "__main__":
    main()
