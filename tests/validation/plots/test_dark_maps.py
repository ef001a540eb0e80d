"""Colours of a map of sigmas on a dark page: steps that are told apart, and what is no chance seen from afar."""

from itertools import pairwise

import numpy as np

from validation.report.charts import spec
from validation.report.charts.interactive import SURFACE


def luminance(colour: str) -> float:
    """Relative luminance of WCAG 2.2."""
    share = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    return float(np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722])


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_what_chance_does_not_reach_stands_out_from_a_dark_page_and_every_step_from_the_next() -> None:
    """From 4 to 10 sigma it had 2.2 and 2.8 times the luminance of the page, where shapes need 3."""
    assert min(contrast(one, SURFACE[True]) for one in spec.STRONG[True]) >= 3
    every = (*spec.PALE[True], *spec.STRONG[True])
    assert len(every) == len(spec.BOUNDS)
    assert min(contrast(*two) for two in pairwise(every)) > 1.15
    assert [luminance(one) for one in every] == sorted(luminance(one) for one in every)
