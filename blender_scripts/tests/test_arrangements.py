"""Arrangements: what they are filled with, and that a seed is always the same one."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from l4d_blender.compose.arrangements import arrange, pictures, stock
from l4d_blender.compose.errors import Rejected
from l4d_blender.scene import catalogue


def test_every_noun_can_be_drawn_in_words_that_its_asset_takes() -> None:
    for noun in stock.kinds_by_noun():
        for seed in range(5):
            item = stock.draw(random.Random(f"{noun}/{seed}"), noun)
            assert item.radius_m > 0.0
            entry = catalogue.find(item.look.kind)
            entry.arguments(**{**item.look.words, **item.words})
            assert noun in ("duck", "bird") or entry.category == noun
            assert "mark" not in item.look.attributes


def test_composed_nouns_are_in_stock() -> None:
    assert {"cup", "dog", "duck", "laptop", "teddy", "top"} <= set(stock.cast_nouns())
    assert "woman" not in stock.cast_nouns()


def test_a_seed_is_always_the_same_and_is_kept(tmp_path: Path) -> None:
    seed = next(seed for seed in range(100_000, 100_010) if _fits(seed))
    digests = []
    for name in ("a", "b"):
        assert pictures.render(tmp_path / name, seed, 1, 1, 1)
        files = sorted((tmp_path / name).glob("*/arrangement.json"))
        assert len(files) == 3
        digests.append([json.loads(file.read_bytes())["depth_and_id_sha256"] for file in files])
    assert digests[0] == digests[1]
    assert not pictures.render(tmp_path / "a", seed, 1, 1, 1)
    described = json.loads(files[0].read_bytes())
    kinds = {instance["category"] for instance in described["instances"] if instance["role"] == "object"}
    assert len(kinds) >= 3
    # A layout that is lost is rendered again, the others are kept.
    again = sorted((tmp_path / "a").glob("*/arrangement.json"))
    before = again[2].stat().st_mtime_ns
    lost = again[1].read_bytes()
    again[1].unlink()
    assert pictures.render(tmp_path / "a", seed, 1, 1, 1)
    assert again[1].read_bytes() == lost
    assert again[2].stat().st_mtime_ns == before


def test_a_seed_without_room_says_so_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(name: str, seed: int) -> arrange.Arrangement:
        raise Rejected("no room")

    monkeypatch.setattr(arrange, "build", full)
    assert pictures.render(tmp_path, 100_000, 1, 1, 1)
    file = tmp_path / pictures.name_of(100_000, 0) / "arrangement.json"
    assert json.loads(file.read_bytes())["rejected"] == "no room"
    assert not pictures.render(tmp_path, 100_000, 1, 1, 1)


def _fits(seed: int) -> bool:
    """Whether a seed is a tabletop, which is quick, and has room."""
    try:
        return arrange.build("probe", seed).place.scale == "tabletop"
    except Rejected:
        return False
