"""How right a network is on scenes that it has not seen: kinds, attributes, and the masks that it finds itself."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from .batch import LEAST_PX
from .data import Scene
from .model import Network, pool
from .segment import segment

PEOPLE = frozenset({"person", "pedestrian", "woman", "man", "child", "cook", "athlete"})
"""Nouns for people: which of them somebody is called is a matter of the scene."""


def evaluate(network: Network, scenes: list[Scene]) -> dict:
    """Shares in percent: `kind` over all pictures of a scene with true masks (people's nouns as one), `kind_picture`
    in one picture, `attributes`, `found_iou` of the best own segment of each object, and tables by noun and key."""
    words, device = network.words, next(network.parameters()).device
    kinds = {kind: number for number, kind in enumerate(words.kinds)}
    values = {pair: number for number, pair in enumerate(words.values)}
    by_key = words.by_key()
    right, count = defaultdict(int), defaultdict(int)
    by_noun: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    by_attribute: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    mistaken: dict[str, dict[str, int]] = defaultdict(lambda: defaultdict(int))
    overlaps = []
    for scene in scenes:
        votes: dict[int, Tensor] = {}
        value_votes: dict[int, Tensor] = {}
        for colour, ids in zip(scene.colour, scene.ids):
            picture = torch.from_numpy(colour).permute(2, 0, 1).float() / 255.0
            small = torch.from_numpy(ids.astype(np.int64))[::2, ::2]
            seen = [n for n, t in scene.things.items() if t.is_object and int((small == n).sum()) >= 10]
            if not seen:
                continue
            with torch.no_grad():
                picture = picture[None].to(device)
                features, pixels, parts = network(picture)
                masks = torch.stack([(small == n).float() for n in seen])
                half = F.avg_pool2d(picture, 2)
                rows = pool(features, half, parts, masks[None].to(device))[0]
                known = torch.tensor([kinds.get(scene.things[n].kind, 0) for n in seen])
                given = F.one_hot(known, len(words.kinds)).float().to(device)
                of_kinds, of_values = (logits.cpu() for logits in network.describe(rows, given))
            found = segment(pixels[0].cpu())
            for n, mask, kind, value in zip(seen, masks, of_kinds.log_softmax(-1), of_values):
                pixels_seen = float(mask.sum())
                overlaps.append(_best_iou(mask > 0, found) if pixels_seen >= LEAST_PX else np.nan)
                weight = min(pixels_seen, 400.0) ** 0.5
                votes[n] = votes.get(n, 0) + kind * weight
                value_votes[n] = value_votes.get(n, 0) + value * weight
                count["picture"] += 1
                right["picture"] += _same(words.kinds[int(kind[1:].argmax()) + 1], scene.things[n].kind)
        for n, vote in votes.items():
            thing = scene.things[n]
            guess = words.kinds[int(vote[1:].argmax()) + 1]
            is_right = _same(guess, thing.kind)
            by_noun[thing.kind][0] += is_right
            by_noun[thing.kind][1] += 1
            if not is_right:
                mistaken[thing.kind][guess] += 1
            for pair in thing.attributes.items():
                if pair in values:
                    choices = by_key[pair[0]]
                    best = choices[int(value_votes[n][choices].argmax())]
                    by_attribute[pair[0]][0] += best == values[pair]
                    by_attribute[pair[0]][1] += 1
    return {
        "kind": _percent(by_noun),
        "kind_picture": round(100 * right["picture"] / max(count["picture"], 1), 1),
        "attributes": _percent(by_attribute),
        "found_iou": round(100 * float(np.nanmean(overlaps)), 1) if overlaps else None,
        "objects": sum(total for _, total in by_noun.values()),
        "by_noun": dict(sorted(by_noun.items())),
        "by_attribute": dict(sorted(by_attribute.items())),
        "mistaken_for": {noun: dict(table) for noun, table in sorted(mistaken.items())},
    }


def _same(guess: str, kind: str) -> bool:
    return guess == kind or (guess in PEOPLE and kind in PEOPLE)


def _percent(table: dict[str, list[int]]) -> float:
    return round(100 * sum(a for a, _ in table.values()) / max(sum(b for _, b in table.values()), 1), 1)


def _best_iou(mask: Tensor, found: Tensor) -> float:
    best = 0.0
    for number in torch.unique(found[mask]).tolist():
        if number:
            other = found == number
            best = max(best, float((mask & other).sum()) / float((mask | other).sum()))
    return best
