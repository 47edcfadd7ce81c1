"""The statistics done again with statsmodels and SciPy: what `l4d-score` is held against.

    python crates/l4d-score/tests/statistics/reference.py > crates/l4d-score/tests/statistics/reference.json

Needs numpy, scipy and statsmodels. Prints made-up studies, values of three methods for the queries of some scenes, with
what others make of them. It shares nothing with the Rust code: standard errors are those of a regression on a constant
with clustered errors, p values of SciPy's permutation test, corrections of statsmodels. Intervals are either Student's or
drawn by a plain bootstrap with its own numbers: then the reference says between what an end lies that comes from few draws.
"""

import json
import sys

import numpy as np
import scipy.stats
import statsmodels.api as sm
from statsmodels.stats.multitest import multipletests

SEED = 8
DRAWS = 200_000
DRAWS_OF_RUST = 4000
METHODS = 3
FEW_SCENES = 8


def make_study(rng, scenes):
    """Scene of each query, and values like IoUs in percent: scenes are hard or easy, some values are zero."""
    sizes = rng.integers(2, 20, scenes)
    scene = np.repeat(np.arange(scenes), sizes)
    ease = rng.normal(0, 12, scenes)[scene] + rng.normal(0, 15, len(scene))
    values = []
    for method in range(METHODS):
        taste = rng.normal(0, 4, scenes)[scene]
        value = np.clip(50 + 9 * method + ease + taste + rng.normal(0, 10, len(scene)), 0, 100)
        values.append(np.round(np.where(rng.random(len(scene)) < 0.15, 0, value), 3))
    return scene, values


def freedom(scene):
    sizes = np.bincount(scene)
    return max(1, sizes.sum() ** 2 / np.sum(sizes**2) - 1)


def standard_error(scene, values):
    """Of the constant of a regression on nothing else; its small-sample factor is G / (G - 1) here."""
    fitted = sm.OLS(values, np.ones(len(values))).fit(cov_type="cluster", cov_kwds={"groups": scene})
    return float(fitted.bse[0])


def drawn_interval(rng, scene, values):
    """Bootstrap-t: whole scenes are drawn, and each draw is studentized by an error of its own."""
    sizes = np.bincount(scene).astype(float)
    totals = np.bincount(scene, weights=values)
    count, mean, error = len(sizes), values.mean(), standard_error(scene, values)
    drawn = rng.integers(0, count, (DRAWS, count))
    sizes, totals = sizes[drawn], totals[drawn]
    means = totals.sum(1) / sizes.sum(1)
    residuals = totals - means[:, None] * sizes
    errors = np.sqrt(count / (count - 1) * np.sum(residuals**2, 1)) / sizes.sum(1)
    # A share of so few draws is off by this standard error; ends are looked for within five of them.
    off = 5 * np.sqrt(0.025 * 0.975 / DRAWS_OF_RUST)
    ends = np.quantile((means - mean) / errors, [0.975 + off, 0.975 - off, 0.025 + off, 0.025 - off])
    return [float(mean - end * error) for end in ends]


def estimate(rng, scene, values):
    value, error = float(values.mean()), standard_error(scene, values)
    if scene.max() + 1 < FEW_SCENES:
        reach = scipy.stats.t.ppf(0.975, freedom(scene)) * error
        ends = [value - reach] * 2 + [value + reach] * 2
    else:
        ends = drawn_interval(rng, scene, values)
    return {"value": value, "standard_error": error, "low": ends[:2], "high": ends[2:]}


def sign_flip(scene, differences):
    """p of SciPy's permutation test of one sample, which flips signs: two-sided, all ways counted."""
    sizes = np.bincount(scene)

    def clearness(totals, axis=-1):
        totals = np.moveaxis(totals, axis, -1)
        means = totals.sum(-1) / sizes.sum()
        spread = np.sum((totals - means[..., None] * sizes) ** 2, -1)
        return means / np.sqrt(spread)

    totals = np.bincount(scene, weights=differences)
    found = scipy.stats.permutation_test(
        (totals,), clearness, permutation_type="samples", n_resamples=np.inf, vectorized=True
    )
    return float(found.pvalue)


def compare(rng, scene, first, second):
    differences = first - second
    reach = scipy.stats.t.ppf(0.975, freedom(scene)) + scipy.stats.t.ppf(0.8, freedom(scene))
    return {
        "difference": estimate(rng, scene, differences),
        "p": sign_flip(scene, differences),
        "detectable": float(reach * standard_error(scene, differences)),
    }


def rounded(document):
    """To what another machine's order of additions leaves alone."""
    if isinstance(document, dict):
        return {key: rounded(value) for key, value in document.items()}
    if isinstance(document, list):
        return [rounded(value) for value in document]
    return round(float(document), 9) if isinstance(document, float) else document


def main():
    rng = np.random.default_rng(SEED)
    studies = []
    for scenes in (2, 3, 5, 7, 9, 13):
        scene, values = make_study(rng, scenes)
        pairs = [(first, second) for first in range(METHODS) for second in range(first + 1, METHODS)]
        compared = [compare(rng, scene, values[first], values[second]) for first, second in pairs]
        corrected = multipletests([pair["p"] for pair in compared], method="holm")[1]
        studies.append(
            {
                "scenes": scene.tolist(),
                "values": [one.tolist() for one in values],
                "estimates": [estimate(rng, scene, one) for one in values],
                "pairs": [
                    {"first": first, "second": second, **pair, "holm_p": float(holm)}
                    for (first, second), pair, holm in zip(pairs, compared, corrected)
                ],
            }
        )
    json.dump(rounded(studies), sys.stdout, separators=(",", ":"))
    print()


if __name__ == "__main__":
    main()
