"""COCO's compressed run lengths: down the columns, outside first, differences from the fourth run on."""

from __future__ import annotations

from collections.abc import Iterable


def counts(runs: Iterable[int]) -> str:
    """The text of alternating run lengths, the first of them outside."""
    runs = list(runs)
    text = []
    for index, run in enumerate(runs):
        value = run - runs[index - 2] if index > 2 else run
        while True:
            group = value & 0x1F
            value >>= 5
            is_last = value == -1 if group & 0x10 else value == 0
            text.append(chr(48 + group + (0 if is_last else 0x20)))
            if is_last:
                break
    return "".join(text)


def of_box(box: tuple[int, int, int, int], width: int, height: int) -> str:
    """A filled box of the columns ``box[0]..box[2]`` and the rows ``box[1]..box[3]``, ends excluded."""
    left, top, right, bottom = box
    if left >= right or top >= bottom:
        return counts([width * height])
    inside, between = bottom - top, height - (bottom - top)
    if between == 0:
        runs = [left * height, inside * (right - left)]
    else:
        runs = [left * height + top, inside]
        runs += [between, inside] * (right - left - 1)
    after = width * height - sum(runs)
    return counts([*runs, after] if after else runs)


def of_array(mask) -> str:
    """A mask as a numpy array of bools, rows by columns."""
    import numpy

    flat = numpy.asarray(mask, dtype=bool).ravel(order="F")
    changes = numpy.flatnonzero(flat[1:] != flat[:-1]) + 1
    edges = numpy.concatenate([[0], changes, [flat.size]])
    runs = numpy.diff(edges).tolist()
    return counts([0, *runs] if flat.size and flat[0] else runs)
