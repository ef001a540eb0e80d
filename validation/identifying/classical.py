"""Weighing, CoG and pendulum results as data of an identification, the combined approach of the paper's conclusions.

A result is reduced as `massline weigh`, `cog` and `pendulum` do it and carried into the frame of the campaign. Its tolerance is
taken for the half-width of a 95 % interval, as everywhere in massline; results of one file count as independent.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.frames import Pose
from identification.campaign import Campaign
from identification.quality import NORMAL_95
from identification.request import Fact
from validation import crane_cog, pendulum_file, results_file, weighing
from validation.identifying.known import above_fmd, stated
from validation.measurement_file import Fields, read
from validation.reduction import Reduction

REDUCED: dict[str, Callable[[Fields], Reduction]] = {
    "weighing": weighing.reduce,
    "crane-cog": crane_cog.reduce,
    "pendulum": pendulum_file.reduce,
    "results": results_file.reduce,
}
"""What reduces a file of each kind."""

ALONG = 1e-9
"""How far an axis of the article may lie off one of the campaign's and still be it."""


def facts(files: Iterable[str], campaign: Campaign, *, tared: bool) -> tuple[tuple[Fact, ...], tuple[str, ...]]:
    """What the measurement `files` say about the article of `campaign`, in its frame, the CoG from F; and what was assumed.

    `tared` says whether a tare takes the FMD off: what was measured must be what is identified.

    Raises
    ------
    BadInput : a file that cannot be used, is about another article, or says nothing that can be carried into that frame.
    """
    found: list[Fact] = []
    words: list[str] = []
    for name in files:
        reduction = _reduced(name)
        words += _about(reduction, name, campaign, above_fmd(campaign.article) if tared else campaign.article)
        found += [fact for key, value in reduction.results.items() for fact in _facts(key, value, name, campaign)]
    return tuple(found), tuple(words)


def _reduced(name: str) -> Reduction:
    file = read(name, tuple(REDUCED))
    return REDUCED[file.text("kind")](file)


def _about(reduction: Reduction, name: str, campaign: Campaign, article: str) -> list[str]:
    """Refuse a result about another body than the `article` identified; say what is assumed about it."""
    words = [f"{name}: its tolerances are assumed, and so is its weight in the result"] if reduction.assumed else []
    if not reduction.article:
        return [*words, f"{name}: it does not say which article it is about; {article} is taken"]
    if reduction.article == article:
        return words
    raise BadInput(
        source=name,
        field="article.name",
        problem=f"it is about {reduction.article}, what is identified from {campaign.source} is {article}",
        remedy="A tare takes the FMD off: --tare CAMPAIGN" if article == f"fmd+{reduction.article}" else "Leave the file out",
    )


def _facts(key: str, value: object, name: str, campaign: Campaign) -> list[Fact]:
    """One result, SI in the frame of the article, as a fact in that of the campaign; none of a quantity that is no inertia."""
    size, sd = float(value.nominal_value), float(value.std_dev) / NORMAL_95  # type: ignore[attr-defined]
    if key == "mass":
        return [Fact(quantity="mass_kg", value=size, sd=sd, source=name)]
    if key.startswith("cog_"):
        pose = _pose(campaign, name)
        axis, sign = _axis("xyz".index(key[-1]), pose, name, key)
        origin = float(pose.position[axis])
        return [Fact(quantity=f"cog_{'xyz'[axis]}_mm", value=sign * size + origin, sd=sd, source=name)]
    if key.startswith("I"):
        pose = campaign.mounting or Pose()
        pair = [_axis("xyz".index(letter), pose, name, key) for letter in key[1:]]
        letters = "".join(sorted("xyz"[axis] for axis, _ in pair))
        kind = "moi" if letters[0] == letters[1] else "poi"
        return [Fact(quantity=f"{kind}_{letters}_cog_kgm2", value=pair[0][1] * pair[1][1] * size, sd=sd, source=name)]
    return []


def _pose(campaign: Campaign, name: str) -> Pose:
    pose = stated(campaign)
    if pose is None:
        raise BadInput(
            source=f"{campaign.source}/campaign.toml",
            field="mounting",
            problem=f"is missing, and {name} states the CoG from the article's own origin",
            remedy="State where that origin is mounted, [mounting] with origin",
        )
    return pose


def _axis(k: int, pose: Pose, name: str, key: str) -> tuple[int, float]:
    """Along which axis of the campaign, and with which sign, axis `k` of the article lies."""
    along: Array = pose.rotation[:, k]
    axis = int(np.argmax(np.abs(along)))
    if abs(along[axis]) < 1 - ALONG:
        raise BadInput(
            source=name,
            field=key,
            problem=f"axis {'xyz'[k]} of the article lies askew in the campaign, along {np.round(along, 4).tolist()}",
            remedy="Use results about the turning axis, or a mounting turned by a multiple of 90 deg",
        )
    return axis, float(np.sign(along[axis]))
