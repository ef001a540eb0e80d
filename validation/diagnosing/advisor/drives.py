"""Tests of the menu that drive the same otherwise: deeper, higher, or at another level."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from validation.diagnosing.advisor.articles import named
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import SPACING, Template, planned
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE
from validation.identifying.known import above_fmd

LOWEST, HIGHEST = 2.0, 50.0
"""[Hz] that a shaker of the kind can be driven down and up to; above it a model's modes count as computed."""

FINER = 0.05
"""[Hz] between lines at the low end."""

HALF = 0.5


def lower(templates: Sequence[Template]) -> Iterator[Offer]:
    """A slow sweep below what was driven."""
    for of in templates:
        lines = np.arange(LOWEST, of.frequency[0] - FINER / 2, FINER)
        if len(lines):
            words = f"Run {_what(of)} in a slow sweep from {LOWEST:g} to {of.frequency[0]:g} Hz"
            yield Offer(kind="lower", words=words, hours=1.0, test=planned(of, of.tested.campaign, frequency=lines))


def higher(templates: Sequence[Template]) -> Iterator[Offer]:
    """A sweep above what was driven, of what has modes."""
    for of in (one for one in templates if one.tested.carried.standing.modes):
        lines = np.arange(of.frequency[-1] + SPACING, HIGHEST + SPACING / 2, SPACING)
        if len(lines):
            words = f"Run {_what(of)} in a sweep from {of.frequency[-1]:g} to {HIGHEST:g} Hz"
            yield Offer(kind="higher", words=words, hours=1.0, test=planned(of, of.tested.campaign, frequency=lines))


def levels(templates: Sequence[Template], families: Sequence[str]) -> Iterator[Offer]:
    """The same at half the level, where one of the explanations asks for it."""
    if any(FAMILIES[one].side == AMPLITUDE for one in families):
        for of in templates:
            words = f"Run {_what(of)} at half the level"
            yield Offer(kind="level", words=words, hours=1.0, test=planned(of, of.tested.campaign, level=HALF))


def _what(of: Template) -> str:
    return named(above_fmd(of.tested.campaign.article))
