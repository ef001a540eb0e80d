"""The pictures of a ladder: where they go and what is on them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.ladders.climbing import Standing
from validation.ladders.nouns import Body, Errors, Rung
from validation.pictures import ladder as pages
from validation.statement import QUANTITIES

NAN = float("nan")


def draw(at: Standing, folder: Path) -> list[Path]:
    """Write the falling errors, and for every article the way of its inertia, into `folder`; the files.

    Raises
    ------
    OSError : they cannot be written.
    """
    found: list[Path] = []
    name, way = at.path.stem, _way(at)
    if any(one.errors for one in at.ladder.rungs):
        found.append(folder / f"{name}-ladder.png")
        note = "Strong: the way to the rung on which the model stands. Thin: branches. Above: evidence that a rung gained."
        pages.draw_fall(f"{at.path.name}: errors from rung to rung", _drawn(at), found[-1], note)
    for article in dict.fromkeys(body.article for one in way for body in one.bodies):
        seen = [(one, body) for one in way for body in one.bodies if body.article == article]
        found.append(folder / f"{name}-ladder-{article.replace('+', '-')}.png")
        _inertia(at, article, seen, found[-1])
    return found


def _way(at: Standing) -> tuple[Rung, ...]:
    return () if at.below is None else at.ladder.path(at.below.number)


def _drawn(at: Standing) -> list[pages.DrawnRung]:
    way = {one.number for one in _way(at)}
    return [
        pages.DrawnRung(
            number=one.number,
            parent=one.parent,
            title=one.title,
            depth=len(at.ladder.path(one.number)) - 1,
            here=one.number in way,
            errors=_errors(one.errors),
            gain=one.gain,
        )
        for one in at.ladder.rungs
    ]


def _errors(errors: Errors | None) -> dict[str, float]:
    if errors is None:
        return dict.fromkeys((*pages.PERCENT, *pages.FITTED), NAN)
    held_out = NAN if errors.held_out is None else errors.held_out
    figures = (errors.nominal, errors.plain, held_out, errors.chi2_per_dof, errors.z2_over_due)
    seen = (one if one > 0 else NAN for one in figures)  # an error of nothing but noise is 0 and has no place on these axes
    return dict(zip((*pages.PERCENT, *pages.FITTED), seen, strict=True))


def _inertia(at: Standing, article: str, seen: Sequence[tuple[Rung, Body]], path: Path) -> None:
    values, half, reference = (
        np.array([getattr(body, name) for _, body in seen]) for name in ("values", "half_width", "reference")
    )
    quantities = [
        pages.DrawnQuantity(
            label=one.label,
            unit=one.unit,
            identified=one.per_si * values[:, k],
            half_width=one.per_si * half[:, k],
            reference=one.per_si * reference[:, k],
        )
        for k, one in enumerate(QUANTITIES)
    ]
    note = (
        "CoG from the article's own origin; moments and products about the CoG. "
        "The reference is the model with the effects of each rung."
    )
    pages.draw_inertia(
        f"{article}: identified inertia", [f"{one.number}  {one.title}" for one, _ in seen], quantities, path, note
    )
