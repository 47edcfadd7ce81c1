"""Agreement statistics once more, by other means than the crate: exact fractions over explicit pairs of answers.

Reads {"cases": [{"units": [[label or null, ...], ...], "labels": q}, ...],
       "bootstrap": {"units": [[scene, right, answers], ...], "draws": n} or null} from stdin,
writes {"cases": [{"raw", "alpha", "ac1"}, ...], "bootstrap": [low, high] or null}; null stands for undefined.
Standard library only.
"""

import json
import random
import sys
from collections import Counter, defaultdict
from fractions import Fraction
from itertools import permutations


def answered(units):
    return [[label for label in unit if label is not None] for unit in units]


def raw(units):
    shares = []
    for unit in answered(units):
        pairs = list(permutations(unit, 2))
        if pairs:
            shares.append(Fraction(sum(a == b for a, b in pairs), len(pairs)))
    return sum(shares) / len(shares) if shares else None


def alpha(units):
    """From the coincidence matrix: each ordered pair within a unit counts 1 / (answers - 1)."""
    coincidences = defaultdict(Fraction)
    for unit in answered(units):
        for a, b in permutations(unit, 2):
            coincidences[a, b] += Fraction(1, len(unit) - 1)
    margins = Counter()
    for (a, _), weight in coincidences.items():
        margins[a] += weight
    n = sum(margins.values())
    expected = sum(margins[a] * margins[b] for a, b in permutations(margins, 2))
    if not n or not expected:
        return None
    observed = sum(weight for (a, b), weight in coincidences.items() if a != b)
    return 1 - (n - 1) * observed / expected


def ac1(units, labels):
    agreement = raw(units)
    if agreement is None or labels < 2:
        return None
    rated = [unit for unit in answered(units) if unit]
    prevalence = Counter()
    for unit in rated:
        for label in unit:
            prevalence[label] += Fraction(1, len(unit) * len(rated))
    chance = sum(p * (1 - p) for p in prevalence.values()) / (labels - 1)
    return (agreement - chance) / (1 - chance)


def bootstrap(units, draws):
    scenes = defaultdict(list)
    for scene, right, answers in units:
        scenes[scene].append((right, answers))
    groups = list(scenes.values())
    rng = random.Random(20261121)
    values = []
    for _ in range(draws):
        drawn = [pair for group in rng.choices(groups, k=len(groups)) for pair in group]
        values.append(sum(right for right, _ in drawn) / sum(answers for _, answers in drawn))
    values.sort()
    return [values[int(0.025 * draws)], values[int(0.975 * draws) - 1]]


def main():
    asked = json.load(sys.stdin)
    number = lambda value: None if value is None else float(value)
    cases = [
        {
            "raw": number(raw(case["units"])),
            "alpha": number(alpha(case["units"])),
            "ac1": number(ac1(case["units"], case["labels"])),
        }
        for case in asked["cases"]
    ]
    interval = asked["bootstrap"] and bootstrap(asked["bootstrap"]["units"], asked["bootstrap"]["draws"])
    json.dump({"cases": cases, "bootstrap": interval}, sys.stdout)


main()
